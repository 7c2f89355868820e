//! Ball train of a nut: the distance that each ball advances and, if a ball gap is given, the push
//! forces between the balls.

use std::borrow::Cow;

use bsm_dyn::{Model, ModelWorkspace, Problem, solution::BallState};
use bsm_nut::friction::FreeMotion;
use bsm_nut::train::{
    Advance, CircuitAdvance, CircuitTrain, MAX_PUSH_RATIO, Rolling, Train, TrainError,
};

use super::{BallFriction, CircuitRow, NutProblem, NutReport};
use crate::case::nut::{NutAtRest, room_message};
use crate::vocabulary::members::{NumberCells, Rows};
use crate::vocabulary::number::count;
use crate::vocabulary::quantity::quantities;
use crate::vocabulary::units::MM;
use crate::{ModelChoice, format_exact};

quantities! { pub(crate) CIRCUITS, read_circuit(&OneCircuit<'_>);
    "circuits" {
        circuit [""] Scalar(|c| Some(c.number)), "number of the circuit";
        needed_gap_mm ["mm"] Scalar(|c| Some(c.needed / MM)), "needed gap: smallest sum of the gaps between the balls at which no balls touch";
        train_rate [""] Scalar(|c| Some(c.train.rate)), "precession of touching balls relative to the nut / relative speed";
        flux_1_s ["1/s"] Scalar(|c| Some(c.train.flux)), "number of balls that pass per second";
        exit_push_N ["N"] Scalar(|c| Some(c.train.end_pushes[0])), "force of the return on the last ball in the loaded part";
        entry_push_N ["N"] Scalar(|c| Some(c.train.end_pushes[1])), "force of the first ball on the balls in the return";
    }
}

/// A circuit of balls in the ball train.
struct OneCircuit<'a> {
    number: f64,
    needed: f64,
    train: &'a CircuitTrain,
}

/// Push forces between the balls, or the reason why they are not calculated.
pub(super) type TrainResult = Result<Train, String>;

/// Returns a message about a push force that exceeds the limit [`MAX_PUSH_RATIO`].
///
/// * `push`: push force as text, with its unit.
/// * `part`: ratio of the push force to the ball load.
/// * `of`: kind of ball load with which the push force is compared, either `largest` or `mean`.
fn too_large(push: &str, part: f64, of: &str) -> String {
    format!(
        "a push force of {push} between balls is {:.1} % of the {of} ball load; above {:.0} %, push forces change loads and contact angles",
        100.0 * part,
        100.0 * MAX_PUSH_RATIO
    )
}

/// Returns a sentence that explains why the friction torque that includes push forces between the
/// balls is missing.
pub(super) fn not_pushed(why: &str) -> String {
    format!("The friction torque with push forces between the balls is not calculated: {why}.")
}

/// Returns true if the model calculates the free speeds of the balls, which determine the push
/// forces between them.
fn pushes(model: ModelChoice) -> bool {
    matches!(model, ModelChoice::Auto | ModelChoice::Fixed(Model::Traction))
}

impl NutProblem {
    /// Returns the problem with the model that the ball train requires: `traction` in place of
    /// `auto` if a gap is given.
    pub(super) fn with_free_balls(&self) -> Cow<'_, Self> {
        let is_pushed = self.gaps.train.is_some() && self.settings.model == ModelChoice::Auto;
        if is_pushed { Cow::Owned(self.by_traction()) } else { Cow::Borrowed(self) }
    }

    /// Returns the problem with the `traction` model.
    fn by_traction(&self) -> Self {
        let mut traction = self.clone();
        traction.settings.model = ModelChoice::Fixed(Model::Traction);
        traction
    }
}

impl NutReport {
    /// Calculates the distance that each ball advances relative to the other balls, based on the
    /// motion of each ball without neighbors. This motion is calculated with the `traction` model
    /// unless raceway control is requested.
    pub(super) fn advance_of(&self, ball_friction: &BallFriction) -> Option<Advance> {
        let (problem, NutAtRest { nut, found, .. }) = (&self.problem, &self.at_rest);
        let (source, drive) = problem.friction.as_ref()?;
        let of = |motions: &[Option<FreeMotion>]| {
            nut.advance(found, motions, drive, problem.gaps.spacer)
        };
        let rolls_alone = ball_friction.models.iter().any(|model| *model != Model::Traction.name());
        if problem.settings.model != ModelChoice::Fixed(Model::RacewayControl) && rolls_alone {
            // All balls are solved with model `traction`, because the difference between two models
            // is larger than the difference between the free speeds of neighboring balls. Model
            // `elastic` does not determine the spin of a ball.
            let (traction, balls) = (problem.by_traction(), super::loaded_balls(found));
            let work = &mut ModelWorkspace::default();
            let solve = |at| traction.ball_problem(source, balls, at).solve(work);
            let friction = problem.flank_friction(source);
            return of(&nut.free_motions(found, friction, drive, solve)?);
        }
        of(&ball_friction.friction.motions)
    }

    /// Calculates the push forces between the balls, or returns `None` if no ball gap is given.
    ///
    /// * `motions`: motions of the balls without push forces.
    pub(super) fn pushed_of(&self, motions: &[Option<FreeMotion>]) -> Option<TrainResult> {
        let (problem, NutAtRest { nut, found, .. }) = (&self.problem, &self.at_rest);
        let (inputs, (source, drive)) = (problem.gaps.train.as_ref()?, problem.friction.as_ref()?);
        if !pushes(problem.settings.model) {
            let model = problem.settings.model.name();
            return Some(Err(format!(
                "push forces between balls require model traction, not {model}"
            )));
        }
        if problem.scatters() || !nut.errors.balls.is_empty() {
            return Some(Err(
                "push forces between balls of unequal size are not calculated, because balls queue \
                 behind a slow ball whatever the gap is"
                    .to_owned(),
            ));
        }
        let (traction, balls) = (problem.by_traction(), super::loaded_balls(found));
        let friction = inputs.contact_friction;
        let in_train = |at, free: &BallState, work: &mut ModelWorkspace| match traction
            .ball_problem(source, balls, at)
        {
            Problem::Traction(ball) => ball.in_train(free, friction, work),
            Problem::Lubricated(ball) => ball.in_train(free, friction, work),
            _ => None,
        };
        let train = nut.train(found, motions, source.coefficient(), drive, inputs, in_train);
        Some(match train {
            Ok(train) if train.largest_push > MAX_PUSH_RATIO * found.max_load() => {
                let (push, part) = (train.largest_push, train.largest_push / found.max_load());
                Err(too_large(&format!("{push:.3} N"), part, "largest"))
            }
            Err(TrainError::LargePush { push, part }) => {
                Err(too_large(&format!("at least {push:.3} N"), part, "largest"))
            }
            other => other.map_err(|why| why.to_string()),
        })
    }
    /// Returns a sentence that states whether the balls touch each other, or `None` if no ball gap
    /// is given.
    pub(crate) fn touch_note(&self) -> Option<String> {
        let inputs = self.problem.gaps.train.as_ref()?;
        let train = match self.pushed()? {
            Ok(train) => train,
            Err(why) => return Some(not_pushed(why)),
        };
        let touch = if train.touching_contacts > 0 { "touch" } else { "do not touch" };
        let needed = self.advance()?.circuits.iter().map(|circuit| circuit.needed_gap);
        // The note reports the circuit with the largest ratio of needed gap to given gap.
        let part = |gaps: &(f64, f64)| gaps.0 / gaps.1;
        let gaps = needed.zip(inputs.gaps.iter().copied());
        let (needed, gap) = gaps.max_by(|a, b| part(a).total_cmp(&part(b)))?;
        let (needed, gap) = (needed / MM, format_exact(gap / MM));
        Some(format!(
            "The balls {touch}: the needed gap is {needed:.3} mm, and the given gap is {gap} mm."
        ))
    }

    /// Returns a table with one row per circuit, or `None` if no gap is given.
    pub(super) fn circuits(&self) -> Option<Rows<CircuitRow>> {
        let (train, advance) = (self.train()?, self.advance()?);
        let row = |(number, (train, advance)): (usize, (&CircuitTrain, &CircuitAdvance))| {
            let of = OneCircuit { number: count(number), needed: advance.needed_gap, train };
            CircuitRow { numbers: NumberCells::of(&read_circuit(&of, |_| true)) }
        };
        let circuits = train.circuits.iter().zip(&advance.circuits).enumerate();
        Some(Rows(circuits.map(row).collect()))
    }

    /// Returns warnings about circuits with too many balls, and about results beyond the range of
    /// the ball train model.
    pub(super) fn train_warnings(&self) -> Vec<String> {
        let nut = &self.at_rest.nut;
        let spacer = self.problem.gaps.spacer;
        let circuits = nut.circuits.iter().enumerate();
        // The loaded arc may temporarily hold one additional ball, because a ball can enter the arc
        // while another ball leaves it.
        let crowded = circuits
            .filter(|(i, circuit)| count(circuit.balls) > nut.ball_capacity(*i, spacer) + 1.0);
        let mut warnings: Vec<_> = crowded
            .map(|(i, circuit)| {
                format!("{} balls are too many: {}.", circuit.balls, room_message(nut, i, spacer))
            })
            .collect();
        let Some(train) = self.train() else { return warnings };
        let part = train.largest_push / self.found().mean_load();
        if part > MAX_PUSH_RATIO {
            let beyond = too_large(&format!("{:.3} N", train.largest_push), part, "mean");
            warnings.push(format!("The torque is an estimate, because {beyond}."));
        }
        match train.number_of(Rolling::Blocked) {
            0 => {}
            blocked => warnings.push(format!(
                "{blocked} balls do not roll, because friction of neighboring balls stops their rotation."
            )),
        }
        warnings
    }
}
