//! The ball train of a nut: the ball advance, and the pushes if a gap is given.

use std::borrow::Cow;

use bsm_dyn::{BallState, Model, ModelWorkspace, Problem};
use bsm_nut::{
    Advance, CircuitAdvance, CircuitTrain, FreeMotion, LARGEST_PUSH, Rolling, Train, TrainError,
};
use serde_json::json;

use super::{BallFriction, NutProblem, NutReport};
use crate::case::nut::{NutAtRest, room};
use crate::vocabulary::number::count;
use crate::vocabulary::quantity::quantities;
use crate::vocabulary::units::MM;
use crate::{Column, ModelChoice, Table, exact};

quantities! { pub(crate) CIRCUITS, read_circuit(&OneCircuit<'_>);
    "circuits" {
        circuit [""] Scalar(|c| Some(c.number)), "number of the circuit";
        needed_gap_mm ["mm"] Scalar(|c| Some(c.needed / MM)), "gaps between its balls, all together, from which no balls touch";
        train_rate [""] Scalar(|c| Some(c.train.rate)), "precession of the balls that touch, relative to the nut, over the relative speed";
        flux_1_s ["1/s"] Scalar(|c| Some(c.train.flux)), "balls that pass in a second";
        exit_push_N ["N"] Scalar(|c| Some(c.train.ends[0])), "force of the return on the last ball in the loaded part";
        entry_push_N ["N"] Scalar(|c| Some(c.train.ends[1])), "force of the first ball on those of the return";
    }
}

/// A circuit whose balls flow.
struct OneCircuit<'a> {
    number: f64,
    needed: f64,
    train: &'a CircuitTrain,
}

/// The pushes of the balls, or why there are none.
pub(super) type TrainResult = Result<Train, String>;

/// A push above [`LARGEST_PUSH`].
///
/// * `push`: in words. * `of`: the load that it is a part of.
fn too_large(push: &str, part: f64, of: &str) -> String {
    format!(
        "a push of {push} between balls is {:.1} % of their {of} load: above {:.0} % loads and contact angles are \
         no longer those without pushes",
        100.0 * part,
        100.0 * LARGEST_PUSH
    )
}

/// Why there is no friction torque.
pub(super) fn not_pushed(why: &str) -> String {
    format!("no friction torque with pushes of the balls: {why}")
}

/// Whether a model has the free speeds that balls push from.
fn pushes(model: ModelChoice) -> bool {
    matches!(model, ModelChoice::Auto | ModelChoice::Fixed(Model::Traction))
}

impl NutProblem {
    /// The same with friction by the model that its balls push from.
    pub(super) fn with_free_balls(&self) -> Cow<'_, Self> {
        let is_pushed = self.gaps.train.is_some() && self.settings.model == ModelChoice::Auto;
        if is_pushed { Cow::Owned(self.by_traction()) } else { Cow::Borrowed(self) }
    }

    /// The same with friction by model traction.
    fn by_traction(&self) -> Self {
        let mut traction = self.clone();
        traction.settings.model = ModelChoice::Fixed(Model::Traction);
        traction
    }
}

impl NutReport {
    /// Advance of the balls, by their free motions of model traction unless raceway control is asked for.
    pub(super) fn advance_of(&self, ball_friction: &BallFriction) -> Option<Advance> {
        let (problem, NutAtRest { nut, found, .. }) = (&self.problem, &self.made);
        let (source, drive) = problem.friction.as_ref()?;
        let of = |motions: &[Option<FreeMotion>]| {
            nut.advance(found, motions, drive, problem.gaps.spacer)
        };
        let rolls_alone = ball_friction.models.iter().any(|model| *model != Model::Traction.name());
        if problem.settings.model != ModelChoice::Fixed(Model::RacewayControl) && rolls_alone {
            // Free speeds of two models differ by more than those of neighbours, and nothing stops the spin of a ball of
            // model elastic.
            let (traction, balls) = (problem.by_traction(), super::loaded_balls(found));
            let work = &mut ModelWorkspace::default();
            let solve = |at| traction.of_ball(source, balls, at).solve(work);
            return of(&nut.free_motions(found, source.coefficient(), drive, solve)?);
        }
        of(&ball_friction.friction.motions)
    }

    /// The pushes of the balls where a gap is given.
    ///
    /// * `motions`: without pushes.
    pub(super) fn pushed_of(&self, motions: &[Option<FreeMotion>]) -> Option<TrainResult> {
        let (problem, NutAtRest { nut, found, .. }) = (&self.problem, &self.made);
        let (inputs, (source, drive)) = (problem.gaps.train.as_ref()?, problem.friction.as_ref()?);
        if !pushes(problem.settings.model) {
            let model = problem.settings.model.name();
            return Some(Err(format!("pushes of the balls need model traction, not {model}")));
        }
        if problem.scatters() || !nut.errors.balls.is_empty() {
            return Some(Err(
                "the push of balls of unequal size is not calculated: a slow one gathers a queue \
                 whatever the gap"
                    .to_owned(),
            ));
        }
        let (traction, balls) = (problem.by_traction(), super::loaded_balls(found));
        let friction = inputs.contact_friction;
        let in_train = |at, free: &BallState, work: &mut ModelWorkspace| match traction
            .of_ball(source, balls, at)
        {
            Problem::Traction(ball) => ball.in_train(free, friction, work),
            Problem::Lubricated(ball) => ball.in_train(free, friction, work),
            _ => None,
        };
        let train = nut.train(found, motions, source.coefficient(), drive, inputs, in_train);
        Some(match train {
            Ok(train) if train.largest_push > LARGEST_PUSH * found.max_load() => {
                let (push, part) = (train.largest_push, train.largest_push / found.max_load());
                Err(too_large(&format!("{push:.3} N"), part, "largest"))
            }
            Err(TrainError::LargePush { push, part }) => {
                Err(too_large(&format!("at least {push:.3} N"), part, "largest"))
            }
            other => other.map_err(|why| why.to_string()),
        })
    }
    /// Whether the balls touch, in one line; `None` where no gap is given.
    pub(crate) fn touch_note(&self) -> Option<String> {
        let inputs = self.problem.gaps.train.as_ref()?;
        let train = match self.pushed()? {
            Ok(train) => train,
            Err(why) => return Some(not_pushed(why)),
        };
        let touch = if train.touching > 0 { "touch" } else { "do not touch" };
        let needed = self.advance()?.circuits.iter().map(|circuit| circuit.needed_gap);
        // Of the circuit that has least of what it needs.
        let part = |gaps: &(f64, f64)| gaps.0 / gaps.1;
        let gaps = needed.zip(inputs.gaps.iter().copied());
        let (needed, gap) = gaps.max_by(|a, b| part(a).total_cmp(&part(b)))?;
        let (needed, gap) = (needed / MM, exact(gap / MM));
        Some(format!("the balls {touch}: {needed:.3} mm needed, {gap} mm there"))
    }

    /// The circuits where a gap is given, a row each.
    pub(super) fn circuits(&self) -> Option<Table> {
        let (train, advance) = (self.train()?, self.advance()?);
        let row = |(number, (train, advance)): (usize, (&CircuitTrain, &CircuitAdvance))| {
            let of = OneCircuit { number: count(number), needed: advance.needed_gap, train };
            read_circuit(&of, |_| true).columns().map(|(_, value)| json!(value)).collect()
        };
        Some(Table {
            columns: CIRCUITS.iter().map(|of| Column::of(of.name)).collect(),
            rows: train.circuits.iter().zip(&advance.circuits).enumerate().map(row).collect(),
            ..Table::default()
        })
    }

    /// Circuits whose balls would lie on each other, and what is beyond the range of the ball train.
    pub(super) fn train_warnings(&self) -> Vec<String> {
        let nut = &self.made.nut;
        let spacer = self.problem.gaps.spacer;
        let circuits = nut.circuits.iter().enumerate();
        // One ball may enter the loaded arc while another one leaves it.
        let crowded =
            circuits.filter(|(i, circuit)| count(circuit.balls) > nut.room(*i, spacer) + 1.0);
        let mut warnings: Vec<_> = crowded
            .map(|(i, circuit)| {
                format!("{} balls are too many: {}", circuit.balls, room(nut, i, spacer))
            })
            .collect();
        let Some(train) = self.train() else { return warnings };
        let part = train.largest_push / self.found().mean_load();
        if part > LARGEST_PUSH {
            let beyond = too_large(&format!("{:.3} N", train.largest_push), part, "mean");
            warnings.push(format!("{beyond}, and the torque is an estimate"));
        }
        match train.number_of(Rolling::Blocked) {
            0 => {}
            blocked => warnings.push(format!(
                "{blocked} balls do not roll: friction of their neighbours stops them"
            )),
        }
        warnings
    }
}
