//! Conversion of the inputs for a ball train to SI units.

use bsm_nut::BallNut;
use bsm_nut::train::{Exit, ExitPush, TrainInputs};

use super::friction::FrictionSource;
use crate::vocabulary::error::invalid_input;
use crate::vocabulary::units::{DEG, MM};
use crate::{Case, CaseError, InputKey, Rule, format_exact};

/// Spacers, gaps and friction between the balls of a nut.
#[derive(Debug, Clone)]
pub(crate) struct BallGaps {
    /// Thickness of the spacers \[m\].
    pub(crate) spacer: f64,
    /// Friction coefficient between balls; `None` if the case has no friction.
    pub(crate) friction: Option<f64>,
    /// Inputs of the ball train, including the total gap in the loaded part of each circuit; `None`
    /// if no gap is given.
    pub(crate) train: Option<TrainInputs>,
}

/// Returns a message that states how many balls fit into a circuit.
///
/// * `spacer`: thickness of the spacers \[m\].
pub(crate) fn room_message(nut: &BallNut, circuit: usize, spacer: f64) -> String {
    let arc = nut.circuits[circuit].arc;
    format!(
        "circuit {circuit} is {:.0} mm long and has room for {} balls with a diameter of {} mm",
        arc * nut.helix.arc_length_per_radian() / MM,
        nut.ball_capacity(circuit, spacer),
        format_exact(2.0 * nut.ball.radius / MM)
    )
}

impl BallGaps {
    pub(super) fn of(
        case: &Case,
        friction: Option<FrictionSource>,
        nut: &BallNut,
    ) -> Result<Self, CaseError> {
        use InputKey as K;
        let listed = case.entries.circuits.as_deref().unwrap_or_default();
        let own = |circuit: usize| listed.get(circuit).and_then(|words| words.ball_gap_mm);
        let own_path = |circuit: usize| format!("circuits[{circuit}].ball_gap_mm");
        let circuits = nut.circuits.len();
        let spacer = case.number(K::spacer_thickness_mm) * MM;
        let friction = match friction {
            Some(FrictionSource::Coefficient(coefficient)) => {
                Some(case.ball_contact_friction.unwrap_or(coefficient))
            }
            Some(FrictionSource::Lubricant(lubricant)) => {
                Some(lubricant.losses.ball_contact_friction)
            }
            None => None,
        };
        let Some(gap) = case.ball_gap_mm else {
            let Some(circuit) = (0..circuits).find(|circuit| own(*circuit).is_some()) else {
                return Ok(Self { spacer, friction, train: None });
            };
            let what = "also needs the input ball_gap_mm, which applies to the circuits that do not have their own value";
            return Err(invalid_input(own_path(circuit), what));
        };
        let gap_of = |circuit: usize| {
            let gap = own(circuit).unwrap_or(gap);
            let rule = Rule::Above(0.0);
            if rule.holds(gap) {
                return Ok(gap * MM);
            }
            let key = own(circuit).map_or_else(|| "ball_gap_mm".to_owned(), |_| own_path(circuit));
            let (room, rule) = (room_message(nut, circuit, spacer), rule.describe());
            Err(CaseError::out_of_range(key, gap, format!("{rule}: {room}")))
        };
        let gaps = (0..circuits).map(gap_of).collect::<Result<_, _>>()?;
        let of_bends =
            [K::return_entry_force_N, K::return_bend_deg, K::return_friction_coefficient];
        let bends = of_bends.into_iter().find(|key| case[*key].is_some());
        let push = match (case.return_push_N, bends) {
            (Some(_), Some(bends)) => {
                return Err(CaseError::given_twice(["return_push_N", bends.name()]));
            }
            (Some(push), None) => ExitPush::AtExit(push),
            (None, _) => ExitPush::AtEntry(case.number(K::return_entry_force_N)),
        };
        if case.ball_contact_force_N.is_some_and(|force| force > 0.0) {
            let what = "must not be given together with ball_gap_mm, which determines the force between the balls";
            return Err(invalid_input("ball_contact_force_N", what));
        }
        let train = friction.map(|contact_friction| TrainInputs {
            gaps,
            spacer,
            contact_friction,
            exit: Exit {
                push,
                bend_angle: case.number(K::return_bend_deg) * DEG,
                friction: case.number(K::return_friction_coefficient),
            },
            idle_drag: case.number(K::idle_ball_drag_N),
        });
        Ok(Self { spacer, friction, train })
    }
}
