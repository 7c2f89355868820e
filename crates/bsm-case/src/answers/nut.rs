//! Results for a nut under load: named quantities, notes, the loads of all balls, and the
//! load-displacement curve.

use std::cell::OnceCell;
use std::f64::consts::TAU;

use bsm_design::drive::drag_torque;
use bsm_design::groove::FEW_DRAWS;
use bsm_design::in_series;
use bsm_design::life::{Duty, life};
use bsm_dyn::{
    ElasticPoint, Model, ModelWorkspace, Problem, SolveFailure, hertz::Hertz,
    lubrication::Temperature,
};
use bsm_kin::Drive;
use bsm_nut::friction::{BallModel, FrictionSum, NutFriction, ThirdContacts};
use bsm_nut::thermal::HeldFriction;
use bsm_nut::train::{Advance, BallAdvance, BallOfTrain, Rolling, Train};
use bsm_nut::{
    BallInGrooves, BallNut, BallPosition, Circuit, EqualShare, Equilibrium, Flanks, Freedom,
    NutError, PreloadKind, Support,
};
use schemars::JsonSchema;
use serde::Serialize;

use crate::answers::record::{MARKS_ABOVE, message, skid_warning};
use crate::answers::section::beyond_the_flanks;
use crate::case::axis::TorqueTolerance;
use crate::case::nut::{FrictionSource, NutAtRest, NutPreload};
use crate::case::reader::{GothicArches, in_grooves};
use crate::case::warm::Warm;
use crate::vocabulary::members::{
    Data, Label, Maybe, NumberCells, NumbersOf, Rows, Word, answer, number_tables, row,
};
use crate::vocabulary::number::count;
use crate::vocabulary::quantity::quantities;
use crate::vocabulary::units::{DEG, MM, MPA, UM};
use crate::{
    Answer, Case, InputSet, MissingInput, ModelChoice, Numbers, NutProblem, Output, OutputName,
    OutputType, Quantity, Settings, format_trimmed, output,
};

mod train;

pub(crate) use train::CIRCUITS;
use train::{TrainResult, not_pushed};

/// Typical ratio of catalog stiffness to calculated stiffness. The ratio is below 1 because of
/// manufacturing errors (HIWIN BS-08-2).
const CATALOG_STIFFNESS_RATIO: f64 = 0.8;

/// Smallest and largest value of the preload torque coefficient `$K_p$` in catalogs, based on
/// measurements (HIWIN BS-08-2, eq. 3.2).
const RULE_FACTORS: [f64; 2] = [0.1, 0.3];

/// Two limits for the ratio of the neglected centrifugal force to the mean ball load. A note is
/// given above the first limit, and a warning above the second limit.
const CENTRIFUGAL: [f64; 2] = [0.01, 0.1];

/// Number of intervals of the load-displacement curve.
const POINTS: u32 = 60;

/// Results for a nut under load. Results that take a long time to calculate are calculated on
/// demand.
#[derive(Debug)]
pub struct NutReport {
    problem: NutProblem,
    at_rest: NutAtRest,
    ball_friction: OnceCell<Option<BallFriction>>,
    reverse_torque: OnceCell<Option<f64>>,
    /// Friction of the nut without external load, for both directions of travel.
    unloaded_friction: [OnceCell<Option<NutFriction>>; 2],
    /// Friction and preload of the running nut pair, for both directions of travel.
    running_pair: [OnceCell<Option<Result<PairDrag, SolveFailure>>>; 2],
    advance: OnceCell<Option<Advance>>,
    limit_load: OnceCell<Option<f64>>,
}

/// Results for a nut pair that carries no external load while the screw turns.
#[derive(Debug, Clone, Copy)]
struct PairDrag {
    /// Friction torque of the contacts \[N·m\].
    torque: f64,
    /// Force between the two nuts \[N\].
    preload: f64,
}

/// Direction in which the nut travels along the screw.
#[derive(Debug, Clone, Copy)]
enum Travel {
    /// Direction of travel that results from the screw and nut speeds of the case.
    Given,
    /// Direction opposite to [`Travel::Given`].
    Reverse,
}

impl Travel {
    /// Returns the speeds of screw and nut for this direction of travel.
    fn of(self, drive: &Drive<f64>) -> Drive<f64> {
        let Drive { screw_speed, nut_speed } = *drive;
        match self {
            Self::Given => *drive,
            Self::Reverse => Drive { screw_speed: -screw_speed, nut_speed: -nut_speed },
        }
    }
}

/// Friction of all balls in a nut, and details of the calculation.
#[derive(Debug)]
struct BallFriction {
    friction: NutFriction,
    /// Names of the models that solved the balls with two contacts.
    models: Vec<&'static str>,
    /// Largest skid onset number of all balls that obey raceway control.
    onset: Option<f64>,
    /// Reason why the model has no solution for one of the balls.
    why: Option<String>,
    /// Push forces between the balls; `None` if no ball gap is given.
    pushed: Option<TrainResult>,
}

impl NutReport {
    pub(crate) fn new(problem: NutProblem, at_rest: NutAtRest) -> Self {
        Self {
            problem,
            at_rest,
            ball_friction: OnceCell::new(),
            reverse_torque: OnceCell::new(),
            unloaded_friction: Default::default(),
            running_pair: Default::default(),
            advance: OnceCell::new(),
            limit_load: OnceCell::new(),
        }
    }

    fn ball_friction(&self) -> Option<&BallFriction> {
        let work_out = || {
            let (problem, NutAtRest { nut, found, .. }) = (&self.problem, &self.at_rest);
            let mut ball_friction =
                problem.with_free_balls().friction_of(nut, found, Travel::Given)?;
            ball_friction.pushed = self.pushed_of(&ball_friction.friction.motions);
            if let (Some(pushed), Some((_, drive))) = (&ball_friction.pushed, &problem.friction) {
                let drag = ball_friction.friction.parts.map(|parts| parts.drag);
                let balls = pushed.as_ref().ok().map(Train::torque).zip(drag);
                let balls = balls.map(|(balls, drag)| balls + drag);
                let (friction, seal) = (&mut ball_friction.friction, problem.seal_torque);
                nut.with_torque(friction, found, drive, seal, balls);
            }
            Some(ball_friction)
        };
        self.ball_friction.get_or_init(work_out).as_ref()
    }

    fn friction(&self) -> Option<&NutFriction> {
        self.ball_friction().map(|ball_friction| &ball_friction.friction)
    }

    /// Returns the distance that each ball advances relative to the other balls, or `None` if the
    /// free motions of the balls are unknown.
    fn advance(&self) -> Option<&Advance> {
        self.advance.get_or_init(|| self.advance_of(self.ball_friction()?)).as_ref()
    }

    /// Returns the push forces between the balls, or `None` if no ball gap is given.
    fn pushed(&self) -> Option<&TrainResult> {
        self.ball_friction()?.pushed.as_ref()
    }

    fn train(&self) -> Option<&Train> {
        self.pushed()?.as_ref().ok()
    }

    /// Returns the friction torque of the balls in the opposite direction of travel \[N·m\], or
    /// `None` if push forces between the balls are calculated.
    fn reverse_torque(&self) -> Option<f64> {
        let work_out = || {
            let (problem, NutAtRest { nut, found, .. }) = (&self.problem, &self.at_rest);
            let is_free = problem.gaps.train.is_none();
            is_free.then(|| problem.friction_of(nut, found, Travel::Reverse)?.friction.torque)?
        };
        *self.reverse_torque.get_or_init(work_out)
    }

    /// Returns the friction of the preloaded nut without external load.
    fn unloaded_friction(&self, direction: Travel) -> Option<&NutFriction> {
        let work_out = || {
            self.at_rest.preload.as_ref()?;
            let found = self.at_rest.nut.solve(&Support::guided(0.0)).ok()?;
            Some(self.problem.friction_of(&self.at_rest.nut, &found, direction)?.friction)
        };
        self.unloaded_friction[direction as usize].get_or_init(work_out).as_ref()
    }

    /// Returns the friction torque that the preload causes without external load \[N·m\].
    fn drag(&self, direction: Travel) -> Option<f64> {
        self.unloaded_friction(direction)?.torque
    }

    /// Returns the friction torque due to contact between balls \[N·m\], assuming that each ball
    /// pushes its neighbor with a force of 3 % of the ball load. Returns 0 if the balls do not
    /// touch.
    fn contact_torque_bound(&self) -> Option<f64> {
        let (advance, friction) = (self.advance()?, self.problem.gaps.friction?);
        let is_apart = self.train().is_some_and(|train| train.touching_contacts == 0);
        let touch = !is_apart && advance.largest_gap() > 0.0;
        Some(if touch { advance.contact_torque * friction } else { 0.0 })
    }

    /// Returns the friction torque due to preload according to the manufacturers' rule \[N·m\].
    fn drag_by_rule(&self) -> Option<f64> {
        let (design, preload) = (&self.problem.design, self.at_rest.preload.as_ref()?);
        positive_finite(drag_torque(preload.warm, design.lead, design.lead_angle()))
    }

    /// Returns the preload torque coefficient of the running nut pair for zero play, or `None` if
    /// the play is given.
    fn factor_without_play(&self) -> Option<f64> {
        let is_given = self.at_rest.nut.errors.axial_play.is_some();
        let pair = self.pair_drag(Some(0.0), Travel::Given).filter(|_| !is_given)?.ok()?;
        Some(pair.torque / self.rule_torque()?)
    }

    /// Returns the friction torque and the preload of the nut pair while the screw turns, or the
    /// reason why no steady motion was found. Returns `None` if the nut is not such a pair, or if
    /// the model does not integrate friction over the contacts.
    fn solved_pair(&self, direction: Travel) -> Option<&Result<PairDrag, SolveFailure>> {
        let play = self.at_rest.nut.errors.axial_play;
        let work_out = || self.pair_drag(play, direction);
        self.running_pair[direction as usize].get_or_init(work_out).as_ref()
    }

    /// Returns the friction torque and the preload of the nut pair while the screw turns, or `None`
    /// if they are not calculated.
    fn running_pair(&self, direction: Travel) -> Option<PairDrag> {
        self.solved_pair(direction)?.as_ref().ok().copied()
    }

    /// Returns one sentence for each direction of travel in which the calculation of the running
    /// nut pair has failed. A direction that has not been calculated yet is omitted.
    fn pair_failures(&self) -> impl Iterator<Item = String> {
        [(Travel::Given, ""), (Travel::Reverse, " in the opposite direction of travel")]
            .into_iter()
            .filter_map(|(direction, words)| {
                let solved = self.running_pair[direction as usize].get()?.as_ref()?;
                let failure = solved.as_ref().err()?;
                Some(format!(
                    "The friction torque due to the running preload{words} is not calculated: {}.",
                    message(failure.reason())
                ))
            })
    }

    /// Calculates the running nut pair in both directions of travel, and returns one note for each
    /// direction in which the calculation fails.
    pub(crate) fn pair_notes(&self) -> Vec<String> {
        for direction in [Travel::Given, Travel::Reverse] {
            self.solved_pair(direction);
        }
        self.pair_failures().collect()
    }

    /// Calculates the torque and the preload of a nut pair without external load while the screw
    /// turns. All balls of a nut are assumed to be equal.
    ///
    /// * `play`: play of each nut \[m\]. If `None`, the play is assumed to be so large that no ball
    ///   touches a far flank.
    fn pair_drag(
        &self,
        play: Option<f64>,
        direction: Travel,
    ) -> Option<Result<PairDrag, SolveFailure>> {
        let NutAtRest { nut, preload, .. } = &self.at_rest;
        let NutPreload { by: PreloadKind::Offset, warm, .. } = (*preload)? else { return None };
        let integrates = matches!(
            self.problem.settings.model,
            ModelChoice::Auto | ModelChoice::Fixed(Model::Traction)
        );
        let (source, drive) = self.problem.friction.as_ref().filter(|_| integrates)?;
        let balls = count(nut.balls_of_a_pair()?);
        let (mut friction, drive) = (self.problem.flank_friction(source), direction.of(drive));
        if friction.loaded.is_none() {
            friction.loaded = self.unloaded_friction(direction)?.mean_friction;
        }
        let running = nut.running_pair(warm, friction, &drive, play)?;
        Some(running.map(|running| PairDrag {
            torque: running.friction_torque * balls,
            preload: running.force() * balls,
        }))
    }

    fn third_contacts(&self) -> Option<&ThirdContacts> {
        let looks =
            self.at_rest.nut.errors.axial_play.is_some() || self.at_rest.nut.errors.oversize > 0.0;
        looks.then(|| self.friction().map(|friction| &friction.third_contacts))?
    }

    /// Returns the fraction of the friction torque that the third contacts of all balls cause. Push
    /// forces between the balls are neglected.
    fn third_contact_share(&self) -> Option<f64> {
        let torque = self.third_contacts()?.torque;
        Some(torque / positive_finite(self.friction()?.parts?.torque)?)
    }

    /// Returns the friction torque that the third contacts cause \[N·m\].
    pub(crate) fn third_contact_torque(&self) -> Option<f64> {
        Some(self.third_contacts()?.torque)
    }

    fn is_lubricated(&self) -> bool {
        matches!(self.problem.friction, Some((FrictionSource::Lubricant(_), _)))
    }

    /// Returns the contribution of a lubricant effect to the friction of all balls, or `None` if
    /// the contacts are dry.
    fn of_lubricant(&self, part: impl Fn(&FrictionSum) -> f64) -> Option<f64> {
        self.is_lubricated().then(|| self.friction()?.parts.as_ref().map(part))?
    }

    /// Returns the friction torques of the nut contacts and the screw contacts \[N·m\], if the
    /// motion of every ball is known.
    pub(crate) fn raceway_torques(&self) -> Option<[f64; 2]> {
        Some(self.friction()?.parts?.contacts)
    }

    fn contact_torque(&self) -> Option<f64> {
        let friction = self.friction()?;
        let balls = friction.torque?;
        match self.train() {
            Some(train) => Some(train.raceway_torque),
            None => friction.parts.map(|parts| balls - parts.ball_contact - parts.drag),
        }
    }

    fn ball_contact_torque(&self) -> Option<f64> {
        match self.train() {
            Some(train) => Some(train.contact_torque),
            None => self.of_lubricant(|parts| parts.ball_contact),
        }
    }
}

/// Inputs required to calculate the friction of all balls.
const FRICTION: &[InputSet] =
    quantities!(@needs [screw_speed_rpm, friction_coefficient | lubricant_temperature_C]);

/// Inputs required to calculate the push forces in the ball train.
const TRAIN: &[InputSet] = quantities!(@needs [ball_gap_mm, screw_speed_rpm, friction_coefficient | lubricant_temperature_C]);

quantities! { pub(crate) QUANTITIES, read(&NutReport) of Nut;
    "displacement" {
        nut_displacement_um ["um"] Scalar(|n| Some(n.at_rest.found.displacement[0] / UM)), "axial displacement of the nut";
        nut_side_displacement_um ["um"] Scalar(|n| {
        let [_, x, y, ..] = n.at_rest.found.displacement;
        Some(x.hypot(y) / UM)
    }), "side displacement of the nut";
        nut_tilt_urad ["urad"] Scalar(|n| {
        let [.., x, y] = n.at_rest.found.displacement;
        Some(x.hypot(y) * 1e6)
    }), "tilt of the nut";
    }
    "load sharing" {
        max_contact_load_N ["N"] Scalar(|n| Some(n.at_rest.found.max_load())), "largest contact load";
        max_over_mean [""] Scalar(|n| Some(n.at_rest.found.concentration())), "load concentration: largest contact load / mean contact load";
        unloaded_balls [""] Scalar(|n| Some(count(n.at_rest.found.unloaded()))), "unloaded balls";
        max_pressure_MPa ["MPa"] Scalar(|n| Some(n.max_pressure()? / MPA)), "largest Hertz pressure";
        equal_load_N ["N"] Scalar(|n| Some(n.equal_share()?.load)), "load of each ball if all balls shared the axial load equally";
        load_bound_N ["N"] Scalar(|n| n.load_bound()), "upper bound of the largest contact load (guided nut)";
    }
    "stiffness along the axis" {
        nut_stiffness_N_um ["N/um"] Scalar(|n| Some(n.at_rest.found.axial_stiffness(&n.problem.support) * UM)), "tangent stiffness of the nut at this load, all balls";
        nut_secant_stiffness_N_um ["N/um"] Scalar(|n| n.secant().map(|k| k * UM)), "secant stiffness of the nut from no load to this load, all balls";
        nut_equal_stiffness_N_um ["N/um"] Scalar(|n| Some(n.equal_share()?.stiffness * UM)), "tangent stiffness if all balls shared the axial load equally and the bodies were rigid";
        preload_stiffness_2_N_um ["N/um"] Scalar(|n| n.preload_stiffness(2.0)), "preload stiffness 2 F_pr/delta_pr: two nuts in parallel";
        preload_stiffness_2_83_N_um ["N/um"] Scalar(|n| n.preload_stiffness(2.0_f64.powf(1.5))), "preload stiffness 2^1.5 F_pr/delta_pr: secant to the limit load";
        preload_stiffness_3_N_um ["N/um"] Scalar(|n| n.preload_stiffness(3.0)), "preload stiffness 3 F_pr/delta_pr: tangent without load";
        iso_stiffness_N_um ["N/um" "R_nu"] Scalar(|n| Some(n.iso_stiffness()? * UM)), "stiffness according to ISO 3408-4: stiffness of a pair at its preload, or secant stiffness of one nut at its load";
        catalog_stiffness_N_um ["N/um"] Scalar(|n| Some(CATALOG_STIFFNESS_RATIO * n.iso_stiffness()? * UM)), "catalog stiffness, 80 % of ISO 3408-4";
    }
    "preload" {
        cold_preload_N ["N"] Scalar(|n| Some(n.at_rest.preload.as_ref()?.cold)), "cold preload, without external load or temperature rises";
        warm_preload_N ["N" "F_pr"] Scalar(|n| Some(n.at_rest.preload.as_ref()?.warm)), "warm preload, without external load and with the temperature rises";
        preload_approach_um ["um"] Scalar(|n| Some(n.at_rest.preload.as_ref()?.approach / UM)), "preload displacement of each nut, delta_p, all balls";
        preload_setting_um ["um"] Scalar(|n| Some(n.at_rest.preload.as_ref()?.setting / UM)), "offset of the pair (below 0 in O arrangement) or ball oversize that sets the preload";
        preload_left_N ["N"] Scalar(|n| {
        let NutPreload { by, .. } = n.at_rest.preload.as_ref()?;
        Some(n.at_rest.found.preload(&n.at_rest.nut, *by))
    }), "remaining preload at this load";
        limit_load_N ["N" "F_lim"] Scalar(|n| n.limit_load()), "limit load, at which one side of the nut is fully unloaded and the preload is lost";
    }
    "life and safety" {
        life_by_balls_revolutions [""] Scalar(|n| positive_finite(n.at_rest.found.life(&n.at_rest.nut, &n.problem.ratings))), "life from the loads of all balls, revolutions";
        iso_life_revolutions [""] Scalar(|n| n.iso_life()), "life according to ISO 3408-5, revolutions";
        life_ratio [""] Scalar(|n| {
        let ours = positive_finite(n.at_rest.found.life(&n.at_rest.nut, &n.problem.ratings))?;
        Some(ours / n.iso_life()?)
    }), "life from the loads of all balls / life according to ISO 3408-5";
        static_safety_by_balls [""] Scalar(|n| {
        positive_finite(n.at_rest.found.static_safety(&n.at_rest.nut, n.problem.static_rating.rating))
    }), "static safety of the most loaded ball";
    }
    "friction" {
        friction_torque_Nm ["N m"] Scalar(|n| n.friction()?.torque) needs FRICTION, "friction torque of the balls";
        contact_torque_Nm ["N m"] Scalar(|n| n.contact_torque()) needs FRICTION, "  contacts with nut and screw";
        third_contact_torque_Nm ["N m"] Scalar(|n| positive_finite(n.third_contact_torque()?)) needs FRICTION,
            "    friction torque due to third contacts";
        ball_contact_torque_Nm ["N m"] Scalar(|n| n.ball_contact_torque()) needs FRICTION, "  ball-to-ball contact, from ball_gap_mm or ball_contact_force_N";
        return_push_torque_Nm ["N m"] Scalar(|n| Some(n.train()?.return_torque)) needs TRAIN, "  balls pushed through the returns";
        catching_torque_Nm ["N m"] Scalar(|n| Some(n.train()?.catching_torque)) needs TRAIN, "  balls that catch up with a slower ball";
        drag_torque_Nm ["N m"] Scalar(|n| n.of_lubricant(|parts| parts.drag)) needs [screw_speed_rpm, lubricant_temperature_C], "  drag of the balls in the lubricant";
        third_contact_balls [""] Scalar(|n| n.third_contacts().map(|third| count(third.count))) needs FRICTION,
            "number of balls with a third contact, because friction presses them against a far flank (with axial_play_um or oversize balls)";
        largest_third_contact_load_N ["N"] Scalar(|n| positive_finite(n.third_contacts()?.largest_load)) needs FRICTION,
            "largest normal load on any third contact";
        third_contact_torque_share [""] Scalar(NutReport::third_contact_share) needs FRICTION,
            "share of the friction torque of the balls that is due to third contacts";
        friction_torque_reverse_Nm ["N m"] Scalar(NutReport::reverse_torque) needs FRICTION,
            "friction torque of the balls in the opposite direction of travel, at the same axial load";
        return_torque_Nm ["N m"] Scalar(|n| n.of_lubricant(|parts| parts.ball_returns)) needs [screw_speed_rpm, lubricant_temperature_C], "torque of the ball returns, from return_circuits and return_loss_coefficient";
        nut_seal_torque_Nm ["N m"] Scalar(|n| positive_finite(n.problem.seal_torque)), "torque of the seals, seal_torque_Nm";
        drive_torque_Nm ["N m"] Scalar(|n| n.friction()?.drive_torque) needs FRICTION, "torque of the nut, from axial load, balls, returns and seals";
        nut_efficiency [""] Scalar(|n| n.friction()?.efficiency) needs FRICTION, "efficiency, including returns and seals";
        friction_heat_W ["W"] Scalar(|n| n.friction()?.heat) needs FRICTION, "friction heat of balls, returns and seals";
        preload_torque_Nm ["N m"] Scalar(|n| n.drag(Travel::Given)) needs FRICTION,
            "friction torque due to preload, ball contacts only";
        preload_torque_reverse_Nm ["N m"] Scalar(|n| n.drag(Travel::Reverse)) needs FRICTION,
            "friction torque due to preload in the opposite direction of travel, ball contacts only";
        preload_torque_factor [""] Scalar(|n| Some(n.drag(Travel::Given)? / n.rule_torque()?)) needs FRICTION,
            "drag torque coefficient K_p of the preload, in T = K_p F_p lead/(2 pi), ball contacts only";
        preload_torque_factor_rule [""] Scalar(|n| Some(n.drag_by_rule()? / n.rule_torque()?)),
            "drag torque coefficient K_p of the preload according to the manufacturers' rule, 0.05/sqrt(tan lead angle)";
        running_preload_N ["N"] Scalar(|n| Some(n.running_pair(Travel::Given)?.preload)) needs FRICTION,
            "preload of a pair while the screw turns, including the effect of friction";
        running_preload_torque_Nm ["N m"] Scalar(|n| Some(n.running_pair(Travel::Given)?.torque)) needs FRICTION,
            "friction torque due to the running preload, which includes only sliding friction of the ball contacts, without the rolling resistance of a film";
        running_preload_torque_reverse_Nm ["N m"] Scalar(|n| Some(n.running_pair(Travel::Reverse)?.torque)) needs FRICTION,
            "friction torque due to the running preload in the opposite direction of travel";
        running_preload_torque_factor [""] Scalar(|n| Some(n.running_pair(Travel::Given)?.torque / n.rule_torque()?)) needs FRICTION,
            "drag torque coefficient K_p of the running pair, based on the preload at rest";
        running_preload_torque_over_rule [""] Scalar(|n| {
            Some(n.running_pair(Travel::Given)?.torque / n.drag_by_rule()?)
        }) needs FRICTION,
            "friction torque due to the running preload / friction torque according to the manufacturers' rule";
        running_preload_torque_factor_without_play [""] Scalar(|n| n.factor_without_play()) needs FRICTION,
            "drag torque coefficient K_p of the running pair if neither nut has play";
        rule_torque_low_Nm ["N m"] Scalar(|n| Some(RULE_FACTORS[0] * n.rule_torque()?)),
            "friction torque due to preload, catalog estimate with K_p = 0.1";
        rule_torque_high_Nm ["N m"] Scalar(|n| Some(RULE_FACTORS[1] * n.rule_torque()?)),
            "friction torque due to preload, catalog estimate with K_p = 0.3";
    }
    "ball train" {
        advance_spread [""] Scalar(|n| Some(n.advance()?.spread)) needs FRICTION, "spread of the speeds of freely rolling balls: (largest - smallest) / mean";
        needed_gap_mm ["mm"] Scalar(|n| Some(n.advance()?.largest_gap() / MM)) needs FRICTION,
            "needed gap: smallest sum of the gaps in the loaded part of a circuit at which no balls touch";
        ball_contact_band_Nm ["N m"] Scalar(|n| n.contact_torque_bound()) needs FRICTION,
            "torque due to ball-to-ball contact if every contact transmits a force of 3 % of the ball load; 0 if the gaps are sufficient";
        contact_torque_free_Nm ["N m"] Scalar(|n| Some(n.train()?.free_torque)) needs TRAIN, "friction torque of the contacts with nut and screw, without forces between balls";
        touching_contacts [""] Scalar(|n| Some(count(n.train()?.touching_contacts))) needs TRAIN, "number of ball-to-ball contacts that transmit a force";
        max_push_N ["N"] Scalar(|n| Some(n.train()?.largest_push)) needs TRAIN, "largest force between balls";
        idle_balls [""] Scalar(|n| Some(count(n.train()?.number_of(Rolling::Idle)))) needs TRAIN, "number of idle balls, which move without a load";
        blocked_balls [""] Scalar(|n| Some(count(n.train()?.number_of(Rolling::Blocked)))) needs TRAIN, "number of blocked balls, whose rotation neighboring balls stop";
    }
}

quantities! { pub(crate) BALLS, read_ball(&OneBall<'_>);
    "balls" {
        circuit [""] Scalar(|b| count(b.position.circuit)), "index of the circuit";
        body [""] Scalar(|b| count(b.body)), "index of the nut body";
        theta_deg ["deg"] Scalar(|b| b.position.theta / DEG), "position along the helix";
        z_mm ["mm"] Scalar(|b| b.position.z / MM), "position along the axis";
        nut_plus_N ["N"] Scalar(|b| b.ball.loads[0]), "load on the + flank of the nut, where balls push the nut along +z";
        nut_minus_N ["N"] Scalar(|b| b.ball.loads[1]), "load on the - flank of the nut, where balls push the nut along -z";
        screw_plus_N ["N"] Scalar(|b| b.ball.loads[2]), "load on the + flank of the screw, where balls push the nut along +z";
        screw_minus_N ["N"] Scalar(|b| b.ball.loads[3]), "load on the - flank of the screw, where balls push the nut along -z";
        nut_plus_deg ["deg"] Scalar(|b| b.angle(0)), "contact angle at the + flank of the nut, where balls push the nut along +z";
        nut_minus_deg ["deg"] Scalar(|b| b.angle(1)), "contact angle at the - flank of the nut, where balls push the nut along -z";
        screw_plus_deg ["deg"] Scalar(|b| b.angle(2)), "contact angle at the + flank of the screw, where balls push the nut along +z";
        screw_minus_deg ["deg"] Scalar(|b| b.angle(3)), "contact angle at the - flank of the screw, where balls push the nut along -z";
        max_pressure_MPa ["MPa"] Scalar(|b| Some(pressure(b.hertz?, b.ball) / MPA)), "largest Hertz pressure";
        outwards_um ["um"] Scalar(|b| b.outwards / UM), "radial displacement of the ball, positive away from the axis";
        friction_torque_Nm ["N m"] Scalar(|b| b.torque), "friction torque, without forces from other balls";
        free_rate [""] Scalar(|b| Some(b.advance?.rate)), "precession relative to the nut / relative speed, without forces from other balls";
        rate [""] Scalar(|b| Some(b.pushed?.rate)), "precession relative to the nut / relative speed";
        advance_mm ["mm"] Scalar(|b| Some(b.advance?.advance / MM)), "advance of the free ball relative to a uniformly turning cage";
        gap_to_next_mm ["mm"] Scalar(|b| Some(b.pushed?.gap / MM)), "gap to the next ball in the direction of travel";
        front_push_N ["N"] Scalar(|b| Some(b.pushed?.pushes[0])), "push force from the next ball in the direction of travel";
        back_push_N ["N"] Scalar(|b| Some(b.pushed?.pushes[1])), "push force from the ball behind";
        idle [""] Scalar(|b| b.is(Rolling::Idle)), "1 if the ball moves without a load, else 0";
        blocked [""] Scalar(|b| b.is(Rolling::Blocked)), "1 if neighboring balls stop the rotation of the ball, else 0";
    }
}

/// Displacements, loads of all balls and stiffness of a nut. The names are the same as in the
/// published comparison cases.
#[derive(Serialize, JsonSchema)]
#[expect(non_snake_case, reason = "the names end with unit symbols")]
pub(crate) struct NutVectors {
    nut_plus_N: Vec<Option<f64>>,
    nut_minus_N: Vec<Option<f64>>,
    screw_plus_N: Vec<Option<f64>>,
    screw_minus_N: Vec<Option<f64>>,
    nut_plus_deg: Vec<Option<f64>>,
    nut_minus_deg: Vec<Option<f64>>,
    screw_plus_deg: Vec<Option<f64>>,
    screw_minus_deg: Vec<Option<f64>>,
    status: &'static str,
    message: Option<String>,
    /// Displacement along the axis and in two directions across it \[µm\].
    displacement_um: [f64; 3],
    /// Tilt about two directions across the axis \[µrad\].
    tilt_urad: [f64; 2],
    /// Forces and moments that the nut carries.
    reaction_SI: Vec<f64>,
    /// Stiffness matrix, row by row.
    stiffness_SI: Vec<f64>,
    /// Axial force of each nut body.
    body_axial_N: Vec<f64>,
    /// Series stiffness of the two contacts of a ball.
    #[serde(skip_serializing_if = "Option::is_none")]
    K_series_SI: Option<f64>,
    /// Stiffness of the contact between ball and nut.
    #[serde(skip_serializing_if = "Option::is_none")]
    K_nut_SI: Option<f64>,
    /// Stiffness of the contact between ball and screw.
    #[serde(skip_serializing_if = "Option::is_none")]
    K_screw_SI: Option<f64>,
    /// Number of Newton steps.
    iterations: usize,
}

number_tables! {
    /// Results for a nut.
    pub(crate) NutNumbers = QUANTITIES.iter();
    /// Results for a circuit.
    pub(crate) CircuitNumbers = CIRCUITS.iter();
}

row! {
    /// A circuit of the ball train.
    pub(crate) struct CircuitRow {
        [flatten] numbers: NumberCells<CircuitNumbers>;
    }
}

answer! {
    /// A nut under load.
    pub(crate) struct NutMembers {
        [flatten] numbers: NumbersOf<NutNumbers>;
        [flatten] vectors: Data<NutVectors>;
        /// Models that solved the friction of the balls.
        model: Label;
        [skip_serializing_if = "Maybe::is_none"] circuits: Maybe<Rows<CircuitRow>>;
    }
}

answer! {
    /// A nut without equilibrium.
    pub(crate) struct UnsolvedNut {
        status: Word;
        /// Reason why there is no result.
        message: Word;
    }
}

/// A ball in a nut under load.
pub(crate) struct OneBall<'a> {
    position: &'a BallPosition,
    ball: &'a BallInGrooves,
    body: usize,
    hertz: Option<&'a [Hertz; 2]>,
    outwards: f64,
    torque: Option<f64>,
    advance: Option<BallAdvance>,
    pushed: Option<&'a BallOfTrain>,
}

impl OneBall<'_> {
    /// Returns 1 if the state of the ball (rolling, idle or blocked) equals `rolling`, and 0
    /// otherwise.
    fn is(&self, rolling: Rolling) -> Option<f64> {
        Some(f64::from(u8::from(self.pushed?.rolling == rolling)))
    }

    fn angle(&self, flank: usize) -> Option<f64> {
        angle_at(self.ball, flank)
    }
}

/// Returns the contact angle at a flank \[deg\], or `None` if the flank is not loaded.
fn angle_at(ball: &BallInGrooves, flank: usize) -> Option<f64> {
    (ball.loads[flank] > 0.0).then(|| ball.angles[flank] / DEG)
}

/// Columns of the load-displacement curve that follow the column of the load.
const CURVE: [OutputName; 6] = [
    output!(nut_displacement_um),
    output!(nut_stiffness_N_um),
    output!(preload_left_N),
    output!(max_contact_load_N),
    output!(max_over_mean),
    output!(unloaded_balls),
];

/// Returns the number of loaded balls, or 1 if no ball is loaded.
fn loaded_balls(found: &Equilibrium) -> f64 {
    count(found.balls.len() - found.unloaded()).max(1.0)
}

/// Returns a note that states the cold and the warm preload.
pub(crate) fn preload_note(cold: f64, warm: f64) -> String {
    format!(
        "The preload is specified for the cold nut. It is {cold:.0} N if the nut is cold, and {warm:.0} N at the operating temperatures."
    )
}

/// Returns a sentence that states the drag torque to be measured when the preload is verified, and
/// the tolerance of this torque.
///
/// * `torque`: friction torque according to the manufacturers' rule \[N·m\].
/// * `seal`: torque of the seals \[N·m\].
pub(crate) fn torque_to_measure(torque: f64, seal: f64, within: &TorqueTolerance) -> String {
    let ends = [-1.0, 1.0].map(|side| within.end(torque, side));
    let tolerance = match (within.grade, ends, within.percent(torque)) {
        (Some(grade), [Some(low), Some(high)], Some(percent)) => {
            format!("{low:.3} to {high:.3}, +-{percent:.0} % according to {}", grade.name)
        }
        _ if within.length.is_none() => {
            "the tolerance follows from accuracy_grade and stroke_mm".to_owned()
        }
        (None, ..) => "the tolerance follows from accuracy_grade".to_owned(),
        _ => "no tolerance is specified for this torque, length and accuracy_grade".to_owned(),
    };
    let with_seals = if seal > 0.0 {
        format!("; with the seals {:.3} N m", torque + seal)
    } else {
        String::new()
    };
    let [least, most] = [1.5, 2.0].map(|factor| factor * torque);
    format!(
        "According to the manufacturers' rule, a measurement of the preload gives a friction torque of {torque:.3} N m ({tolerance}) at 100 rpm with oil of ISO VG 68, without wipers{with_seals}. The starting torque is usually \
         1.5 to 2 times this torque, {least:.3} to {most:.3} N m."
    )
}

/// Returns the value of a life, a safety factor or a rating, or `None` if the value is not positive
/// and finite.
fn positive_finite(value: f64) -> Option<f64> {
    (value > 0.0 && value.is_finite()).then_some(value)
}

/// Returns the maximum contact pressure on a ball \[Pa\].
///
/// * `hertz`: Hertzian contacts of the balls with nut and screw.
fn pressure([at_nut, at_screw]: &[Hertz; 2], ball: &BallInGrooves) -> f64 {
    let [a, b, c, d] = ball.loads;
    at_nut.max_pressure(a.max(b)).max(at_screw.max_pressure(c.max(d)))
}

impl NutReport {
    fn max_pressure(&self) -> Option<f64> {
        let hertz = self.at_rest.nut.hertz().ok()?;
        Some(self.found().balls.iter().map(|ball| pressure(&hertz, ball)).fold(0.0, f64::max))
    }

    /// Returns the results for a ball that carries an equal share of the load. Returns `None` for a
    /// preloaded nut, because its two bodies carry different loads.
    fn equal_share(&self) -> Option<EqualShare> {
        let axial = self.problem.axial();
        let single = self.at_rest.preload.is_none() && axial != 0.0;
        single.then(|| self.at_rest.nut.equal(axial).ok())?
    }

    /// Returns the torque that is needed, without friction, to move a force equal to the preload
    /// along the lead, `$F_p P_h/2\pi$` \[N·m\].
    fn rule_torque(&self) -> Option<f64> {
        let force = self.at_rest.preload.as_ref()?.warm;
        positive_finite(force * self.at_rest.nut.helix.lead() / TAU)
    }

    /// Returns an upper bound of the largest contact load. The bound holds only for a guided nut in
    /// which every circuit can carry the load, and no ball is loaded on the opposite flank.
    fn load_bound(&self) -> Option<f64> {
        let NutAtRest { nut, preload, found } = &self.at_rest;
        let axial = self.problem.axial();
        let guided = self.problem.support == Support::guided(axial);
        let one_side = preload.is_none() && nut.ring.is_none() && nut.precession == 0.0;
        let level = nut.errors.gap == 0.0;
        let [near, far] =
            if axial > 0.0 { [Flanks::Plus, Flanks::Minus] } else { [Flanks::Minus, Flanks::Plus] };
        let carries = |circuit: &Circuit| [near, Flanks::Both].contains(&circuit.flanks);
        let pressed =
            |ball: &BallInGrooves| ball.flanks_pressed()[usize::from(far == Flanks::Minus)];
        let one_flank = nut.circuits.iter().all(carries) && !found.balls.iter().any(pressed);
        (guided && one_side && level && one_flank && axial != 0.0)
            .then(|| nut.load_bound(axial).ok())?
    }

    /// Returns the secant stiffness \[N/m\]: the axial load divided by the displacement due to this
    /// load.
    fn secant(&self) -> Option<f64> {
        let axial = self.problem.axial();
        // The reference is the displacement without axial load if preload, misalignment or side
        // loads press the balls against the grooves. Otherwise, the reference is the position at
        // which the first ball touches the grooves.
        let without = self.at_rest.nut.solve(&self.problem.support.with_axial(0.0)).ok();
        let pressed = without.filter(|found| found.max_load() > 0.0);
        let from = pressed.map_or(0.0, |found| found.displacement[0]);
        (axial != 0.0).then(|| axial / (self.found().displacement[0] - from))
    }

    /// Returns the stiffness of a preloaded nut in the form in which manufacturers state it
    /// \[N/um\]: the ratio of the preload to the displacement that it causes, multiplied by
    /// `factor`.
    fn preload_stiffness(&self, factor: f64) -> Option<f64> {
        let NutPreload { cold, approach, .. } = self.at_rest.preload.as_ref()?;
        Some(factor * cold / approach * UM)
    }

    /// Returns the stiffness according to ISO 3408-4 \[N/m\], for a pair at its preload or a single
    /// nut at its load.
    fn iso_stiffness(&self) -> Option<f64> {
        let NutProblem { design, body, .. } = &self.problem;
        let elasticity = design.elasticity(body).ok()?;
        positive_finite(match &self.at_rest.preload {
            Some(set) => elasticity.preloaded_pair(positive_finite(set.cold)?),
            None => in_series(
                elasticity.secant(positive_finite(self.problem.axial().abs())?),
                elasticity.body,
            ),
        })
    }

    /// Returns the magnitude of the limit load in the direction of the axial load \[N\].
    fn limit_load(&self) -> Option<f64> {
        let work_out = || {
            let NutProblem { support, .. } = &self.problem;
            let way = if self.problem.axial() < 0.0 { -1.0 } else { 1.0 };
            self.at_rest
                .nut
                .limit_load(self.at_rest.preload.as_ref()?.by, support, way)
                .ok()
                .map(f64::abs)
        };
        *self.limit_load.get_or_init(work_out)
    }

    fn iso_life(&self) -> Option<f64> {
        let preload = self.at_rest.preload.as_ref().map(|set| set.warm);
        // The life in revolutions does not depend on speed and time.
        let duty = Duty { load: self.problem.axial(), speed: 1.0, time: 1.0 };
        positive_finite(life(self.problem.rating.rating, preload, &[duty])?.revolutions)
    }

    /// Returns the values of the results with the given names.
    pub(crate) fn values_of(&self, names: &[OutputName]) -> Vec<Option<f64>> {
        let is_wanted = |quantity: &Quantity| names.iter().any(|name| name.name() == quantity.name);
        let found = read(self, is_wanted).where_finite();
        names.iter().map(|name| found.number(*name)).collect()
    }
}

impl NutProblem {
    /// Returns the axial load \[N\].
    pub(crate) fn axial(&self) -> f64 {
        match self.support.0[0] {
            Freedom::Loaded(load) => load,
            Freedom::Held(_) | Freedom::Sprung { .. } => 0.0,
        }
    }

    /// Calculates the friction of all balls of a nut. Returns `None` if the speeds are missing, or
    /// if neither a friction coefficient nor a lubricant is given.
    fn friction_of(
        &self,
        nut: &BallNut,
        found: &Equilibrium,
        direction: Travel,
    ) -> Option<BallFriction> {
        let (source, drive) = self.friction.as_ref()?;
        let drive = &direction.of(drive);
        let mut work = ModelWorkspace::default();
        let (mut models, mut onset, mut why) = (Vec::new(), None, None);
        let (coefficients, balls) = (self.flank_friction(source), loaded_balls(found));
        let friction = nut.friction(found, coefficients, drive, self.seal_torque, |screw| {
            let solution = self.ball_problem(source, balls, screw).solve(&mut work);
            models.push(solution.model.name());
            if solution.model == Model::RacewayControl {
                let skid = solution.steady_state().and_then(|solved| solved.skid);
                let ball_onset = skid.and_then(|skid| skid.onset_number());
                onset = onset.into_iter().chain(ball_onset).reduce(f64::max);
            }
            if let Some(reason) = solution.reason() {
                why = Some(message(reason));
            }
            solution
        });
        models.sort_unstable();
        models.dedup();
        Some(BallFriction { friction, models, onset, why, pushed: None })
    }

    /// Returns the friction data of the balls at an oil temperature \[K\].
    fn source_at(&self, oil: f64) -> Option<FrictionSource> {
        let mut source = self.friction.as_ref()?.0;
        if let FrictionSource::Lubricant(lubricant) = &mut source {
            lubricant.temperature = Temperature::Known(oil);
        }
        Some(source)
    }

    /// Returns true if the model or the controlling raceway can differ from ball to ball.
    fn decides(&self, source: &FrictionSource) -> bool {
        let Settings { model, control, .. } = self.settings;
        let is_dry = matches!(source, FrictionSource::Coefficient(_));
        model == ModelChoice::Auto && is_dry
            || model == Model::RacewayControl.into() && control.is_none()
    }

    /// Returns the problem of one ball. The problem includes the ball's share of the losses in the
    /// ball returns.
    fn ball_problem(&self, source: &FrictionSource, balls: f64, screw: ElasticPoint) -> Problem {
        self.ball_problem_with_model(source, balls, screw, None)
    }

    /// Returns the problem of one ball. If `prescribed` is given, the problem uses the model that
    /// `prescribed` prescribes.
    fn ball_problem_with_model(
        &self,
        source: &FrictionSource,
        balls: f64,
        screw: ElasticPoint,
        prescribed: Option<BallModel>,
    ) -> Problem {
        let lubricant = match source {
            FrictionSource::Coefficient(_) => None,
            FrictionSource::Lubricant(lubricant) => {
                let mut lubricant = *lubricant;
                lubricant.losses.return_circuits /= balls;
                Some(lubricant)
            }
        };
        let settings =
            prescribed.map_or(self.settings, |BallModel { model, control, accuracy }| Settings {
                model: model.into(),
                control,
                accuracy: accuracy.unwrap_or(self.settings.accuracy),
                ..self.settings
            });
        in_grooves(screw, lubricant, (settings.model, GothicArches::default()), &settings)
    }

    /// Returns the answer for a nut that has no solution. The answer states the reason.
    pub fn unsolved(case: &Case, none: &NutError) -> Answer {
        let status = none.status().name().to_owned();
        let of = Answer { fails: true, warnings: case.warnings(), ..Answer::default() };
        of.with_members(UnsolvedNut {
            status: Word("status ", status),
            message: Word("message", none.to_string()),
        })
    }

    /// Calculates the loads of all balls and all results that depend on them.
    ///
    /// # Errors
    ///
    /// Returns [`NutError`] if no ball can carry the load, or if no displacement produces the
    /// preload.
    pub fn solve(self) -> Result<NutReport, NutError> {
        let at_rest = self.solve_at_rest()?;
        Ok(NutReport::new(self, at_rest))
    }
}

/// Calculates the friction of all balls of a given nut with the inputs of this problem. The nut may
/// be warm or strained.
impl HeldFriction for NutProblem {
    fn sum(
        &self,
        nut: &BallNut,
        found: &Equilibrium,
        drive: &Drive<f64>,
        oil: f64,
        between_loads: f64,
        held: &[Option<BallModel>],
    ) -> Option<FrictionSum> {
        let (source, mut work) = (self.source_at(oil)?, ModelWorkspace::default());
        let balls = loaded_balls(found);
        let solve = |screw: ElasticPoint, held: Option<BallModel>| {
            self.ball_problem_with_model(&source, balls, screw, held).solve(&mut work)
        };
        nut.friction_sum(found, self.flank_friction(&source), drive, between_loads, held, solve)
    }

    fn models(
        &self,
        nut: &BallNut,
        found: &Equilibrium,
        drive: &Drive<f64>,
        oil: f64,
    ) -> Option<Vec<Option<BallModel>>> {
        let (source, mut work) = (self.source_at(oil)?, ModelWorkspace::default());
        if !self.decides(&source) {
            return Some(Vec::new());
        }
        let balls = loaded_balls(found);
        let solve = |screw: ElasticPoint| self.ball_problem(&source, balls, screw).solve(&mut work);
        nut.ball_models(found, self.flank_friction(&source), drive, solve)
    }
}

/// A table of numbers with named columns. Missing values are NaN.
#[derive(Debug, Clone)]
pub struct Columns {
    /// Outputs that define the name and the unit of each column.
    pub heads: Vec<&'static Output>,
    /// Rows of the table, each with one value per column.
    pub rows: Vec<Vec<f64>>,
}

impl Columns {
    /// Returns the cell of a row in the column with the given name.
    pub fn cell(&self, row: &[f64], name: &str) -> f64 {
        let place = self.heads.iter().position(|head| head.name == name);
        place.and_then(|place| row.get(place)).copied().unwrap_or(f64::NAN)
    }
}

impl NutReport {
    fn found(&self) -> &Equilibrium {
        &self.at_rest.found
    }

    /// Returns the requested results that exist for this nut.
    pub fn numbers(&self, wanted: impl Fn(&Quantity) -> bool) -> Numbers {
        let numbers = read(self, wanted).where_finite();
        // Friction is already calculated at this point if a requested result depends on it.
        let friction = self.ball_friction.get().and_then(Option::as_ref);
        let why = friction.and_then(|of_balls| of_balls.pushed.as_ref()?.as_ref().err());
        let reasons: Vec<_> =
            why.map(|why| not_pushed(why)).into_iter().chain(self.pair_failures()).collect();
        numbers.with_reason((!reasons.is_empty()).then(|| reasons.join(" ")))
    }

    /// Returns the result with the given name, or `None` if it does not exist.
    pub fn number(&self, name: OutputName) -> Option<f64> {
        self.numbers(|quantity| quantity.name == name.name()).number(name)
    }

    /// Returns notes on the meaning of the results and on neglected effects.
    pub fn notes(&self) -> Vec<String> {
        let mut notes = self.problem.notes.clone();
        if self.at_rest.nut.shares_equally(&self.problem.support) {
            notes
                .push("All balls share the load equally, as in the single-ball models.".to_owned());
        }
        notes.extend(self.preload_notes());
        notes.extend(self.centrifugal_note(CENTRIFUGAL[0]..CENTRIFUGAL[1]));
        notes.extend(self.touch_note());
        let ball_friction = self.ball_friction();
        match ball_friction.map(|ball_friction| &ball_friction.friction) {
            None if self.problem.warm.is_some() => notes.push(
                "Torque, efficiency and heat need a screw_speed_rpm other than 0. For the speeds of the cycle, use `bsm axis`."
                    .to_owned(),
            ),
            None => notes.push(
                "Torque, efficiency and heat need a screw_speed_rpm other than 0, and friction_coefficient or a lubricant with \
                 lubricant_temperature_C."
                    .to_owned(),
            ),
            Some(friction)
                if friction.balls_on_both_flanks > 0 && self.is_lubricated() =>
            {
                notes.push(format!(
                    "The torque is not calculated, because {} of {} balls press against both \
                     flanks, where friction from a lubricant is unknown. Give friction_coefficient.",
                    friction.balls_on_both_flanks,
                    self.found().balls.len()
                ));
            }
            Some(_) if matches!(self.pushed(), Some(Err(_))) => {}
            Some(friction) if friction.torque.is_none() => {
                let why = ball_friction.and_then(|ball_friction| ball_friction.why.as_deref());
                notes.push(format!(
                    "The torque is not calculated, because ball {} has no solution with model {}: {}",
                    friction.balls.len(),
                    self.problem.settings.model.name(),
                    why.unwrap_or("no equilibrium of the ball was found")
                ));
            }
            Some(friction) => {
                let far = friction.balls_on_both_flanks + friction.third_contacts.count;
                if far > 0 {
                    notes.push(format!(
                        "{far} of {} balls touch a far flank. For these balls, every model integrates the friction over all contacts, and the \
                         friction changes the position of the balls in the grooves.",
                        friction.balls.len(),
                    ));
                }
                if self.is_lubricated() && self.at_rest.nut.errors.axial_play.is_some() {
                    notes.push(
                        "Friction of third contacts is calculated without a film: all flanks have the mean friction coefficient of the \
                         lubricated contacts, unless far_flank_friction_coefficient is given for the far flanks."
                            .to_owned(),
                    );
                }
                notes.extend(self.assumed_play());
                if self.is_lubricated() {
                    notes.push(
                        "Friction from the lubricant is uncertain by about 25 % while the balls roll, and by more if \
                         rolling resistance dominates. `bsm solve` prints the 90 % interval for one ball, and `bsm axis` prints it for the axis."
                            .to_owned(),
                    );
                }
                let scope = match (self.is_lubricated(), self.problem.gaps.train.is_some()) {
                    (true, true) => {
                        "includes ball-to-ball contact according to ball_gap_mm, and includes returns and wipers only through \
                         return_circuits and seal_torque_Nm"
                    }
                    (true, false) => {
                        "includes returns, ball-to-ball contact and wipers only through return_circuits, ball_contact_force_N \
                         and seal_torque_Nm"
                    }
                    (false, true) => {
                        "includes ball-to-ball contact according to ball_gap_mm and wipers through seal_torque_Nm, but excludes \
                         lubricant and impacts in the returns"
                    }
                    (false, false) => {
                        "excludes returns, ball-to-ball contact and lubricant, and includes wipers only through seal_torque_Nm"
                    }
                };
                if let Some(eta) = friction.efficiency.filter(|eta| *eta <= 0.0) {
                    notes.push(format!(
                        "The efficiency of {eta:.4} is not positive: the nut is self-locking, because friction exceeds this \
                         load."
                    ));
                }
                notes.push(format!(
                    "The torque {scope}. Catalogs state drag torque coefficients K_p of 0.1 to 0.3 in \
                     T = K_p F_p lead/(2 pi). Two contacts per ball cause about 15 to 40 % of the drag torque that the manufacturers' rule \
                     predicts; with little play (axial_play_um), a third contact can cause the rest."
                ));
            }
        }
        notes.extend(self.pair_notes());
        notes
    }

    /// Returns a note on the assumed play if friction depends on the play but no play is given.
    pub(crate) fn assumed_play(&self) -> Option<String> {
        let NutAtRest { nut, preload, .. } = &self.at_rest;
        if nut.errors.axial_play.is_some() || self.problem.friction.is_none() {
            return None;
        }
        let assumed = "Neither axial_play_um nor radial_gap_um is given.";
        Some(match preload.map(|preload| preload.by) {
            Some(PreloadKind::Oversize) => {
                format!(
                    "{assumed} Oversize balls have no play, because all four flanks press against \
                     them."
                )
            }
            Some(PreloadKind::Offset) => format!(
                "{assumed} The balls of the pair are assumed to have two contacts, as with a large \
                 play, because no published source states the play of the nuts of a pair. \
                 running_preload_torque_factor_without_play is the value without play."
            ),
            None => format!(
                "{assumed} The balls are assumed to have two contacts, as with a large play, \
                 because no published source states a typical play. THK limits the axial play to 5 \
                 um (class GT) to 50 um (class G3)."
            ),
        })
    }

    /// Returns notes on the cold and the warm preload, and on the drag torque that is measured to
    /// verify the preload.
    fn preload_notes(&self) -> Vec<String> {
        let Some(NutPreload { cold, warm, .. }) = self.at_rest.preload else {
            return Vec::new();
        };
        let (NutProblem { design, seal_torque, tolerance, .. }, mut notes) =
            (&self.problem, Vec::new());
        if (cold - warm).abs() > 0.0 {
            notes.push(preload_note(cold, warm));
        }
        if cold > 0.0 {
            let torque = drag_torque(cold, design.lead, design.lead_angle());
            notes.push(torque_to_measure(torque, *seal_torque, tolerance));
        }
        notes
    }

    /// Returns warnings about the nut.
    pub fn warnings(&self) -> Vec<String> {
        self.beyond_the_flanks().into_iter().chain(self.warnings_besides_flanks()).collect()
    }

    /// Returns the warnings about the nut, except for warnings about contact ellipses that extend
    /// beyond their flanks.
    pub(crate) fn warnings_besides_flanks(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        if let Some(pressure) = self.max_pressure().filter(|p| *p > MARKS_ABOVE) {
            warnings.push(format!(
                "The pressure is {:.0} MPa. Above {:.0} MPa, balls leave permanent marks (ISO 76).",
                pressure / MPA,
                MARKS_ABOVE / MPA
            ));
        }
        warnings.extend(self.loose_balls());
        warnings.extend(self.centrifugal_note(CENTRIFUGAL[1]..f64::INFINITY));
        // If raceway control replaced model traction in the warm state, another warning already
        // states that the balls skid.
        let is_stated = self.problem.warm.as_ref().is_some_and(|warm| warm.replaced.is_some());
        let skid = self.ball_friction().and_then(|found| skid_warning(found.onset?));
        warnings.extend(skid.filter(|_| !is_stated));
        warnings.extend(self.train_warnings());
        if let Some(NutPreload { cold, warm, .. }) = &self.at_rest.preload
            && *cold > 0.0
            && *warm <= 0.0
        {
            warnings.push(
                "The preload is lost at these temperature rises, so the nut has play.".to_owned(),
            );
        }
        let set = self.at_rest.preload.as_ref().is_some_and(|preload| preload.cold > 0.0);
        let lost = set && self.number(output!(preload_left_N)).is_some_and(|left| left <= 0.0);
        if let (true, Some(limit)) = (lost, self.number(output!(limit_load_N))) {
            warnings.push(format!(
                "The preload is lost: the load of {} N exceeds the limit load of {limit:.0} N in its direction.",
                format_trimmed(self.problem.axial().abs())
            ));
        }
        warnings
    }

    /// Returns warnings for nut and screw if the ellipse of the most heavily loaded contact extends
    /// beyond its flank.
    fn beyond_the_flanks(&self) -> Vec<String> {
        let Ok(hertz) = self.at_rest.nut.hertz() else { return Vec::new() };
        let contacts = [[0, 1], [2, 3]].map(|flanks| {
            let contacts =
                self.found().balls.iter().flat_map(|ball| {
                    flanks.map(|flank| (ball.loads[flank], ball.angles[flank].abs()))
                });
            contacts.max_by(|a, b| a.0.total_cmp(&b.0))
        });
        beyond_the_flanks(&self.problem.thread, &hertz, contacts)
    }

    /// Returns a warning if the given offset or ball oversize does not produce a preload.
    fn loose_balls(&self) -> Option<String> {
        let is_loose =
            self.problem.sets_preload_by_displacement() && self.at_rest.preload.is_none();
        is_loose.then(|| {
            "The balls are loose without load in spite of preload_offset_um or ball_oversize_um, so the nut has no preload. Check the \
             sign and axial_play_um."
                .to_owned()
        })
    }

    /// Returns a note on the neglected centrifugal force if the ratio of this force to the mean
    /// ball load is in the range `part`.
    fn centrifugal_note(&self, part: std::ops::Range<f64>) -> Option<String> {
        let (NutAtRest { nut, found, .. }, (_, drive)) =
            (&self.at_rest, self.problem.friction.as_ref()?);
        // A ball that rolls on both raceways orbits at half the sum of screw speed and nut speed.
        let precession = 0.5 * (drive.screw_speed + drive.nut_speed);
        let force = nut.ball.mass * nut.helix.radius * precession * precession;
        let mean = found.mean_load();
        (nut.precession == 0.0 && part.contains(&(force / mean))).then(|| {
            format!(
                "The centrifugal force of a ball is about {:.0} % of the mean load and is neglected. To include it, set \
                 ball_precession_rad_s = {precession:.0}.",
                100.0 * force / mean
            )
        })
    }

    /// Returns the names of the models that solved the friction of the balls, or `None` if no model
    /// was used.
    pub fn model(&self) -> Option<String> {
        let models = &self.ball_friction()?.models;
        (!models.is_empty()).then(|| models.join(" and "))
    }

    /// Returns the columns of the ball table.
    pub fn ball_columns() -> Vec<&'static Output> {
        BALLS.iter().flat_map(|quantity| quantity.columns).collect()
    }

    /// Returns the columns of the load-displacement curve.
    pub fn curve_columns() -> Vec<&'static Output> {
        const LOAD: Output =
            Output::of_table("axial_load_N", "N", OutputType::Number, "axial load", None);
        let of_a_nut =
            |name: OutputName| QUANTITIES.iter().find(move |quantity| quantity.name == name.name());
        let rest = CURVE.into_iter().filter_map(of_a_nut).flat_map(|quantity| quantity.columns);
        std::iter::once(&LOAD).chain(rest).collect()
    }

    /// Returns a table with one row per ball. Missing values are NaN.
    pub fn balls(&self) -> Columns {
        let NutAtRest { nut, found, .. } = &self.at_rest;
        let (friction, hertz) = (self.friction(), nut.hertz().ok());
        let advances: Vec<_> = self
            .advance()
            .into_iter()
            .flat_map(|advance| &advance.circuits)
            .flat_map(|circuit| circuit.balls.iter().copied())
            .collect();
        let pushed: Vec<_> = self
            .train()
            .into_iter()
            .flat_map(|train| &train.circuits)
            .flat_map(|circuit| &circuit.balls)
            .collect();
        let row = |(number, (position, ball)): (usize, (&BallPosition, &BallInGrooves))| {
            let one = OneBall {
                position,
                ball,
                body: nut.circuits[position.circuit].body,
                hertz: hertz.as_ref(),
                outwards: -found.grooves[number][1],
                torque: friction.and_then(|friction| friction.balls.get(number).copied()),
                advance: advances.get(number).copied().flatten(),
                pushed: pushed.get(number).copied(),
            };
            let numbers = read_ball(&one, |_| true);
            numbers.columns().map(|(_, value)| value.unwrap_or(f64::NAN)).collect()
        };
        let rows = found.positions.iter().zip(&found.balls).enumerate().map(row).collect();
        Columns { heads: Self::ball_columns(), rows }
    }

    /// Returns the load-displacement curve, which extends beyond the axial load and the limit load.
    /// For a preloaded nut, the curve begins at zero load. Values without a solution are NaN.
    pub fn curve(&self) -> Columns {
        let axial = self.problem.axial();
        let limit = self.limit_load().unwrap_or(0.0);
        let far = f64::max(1.5 * axial.abs(), 1.25 * limit.abs());
        let far = if far > 0.0 { far } else { 0.1 * self.problem.rating.rating };
        let far = if axial < 0.0 { -far } else { far };
        let mut loads: Vec<f64> =
            (0..=POINTS).map(|i| far * f64::from(i) / f64::from(POINTS)).collect();
        loads.extend([axial, limit].into_iter().filter(|load| *load != 0.0));
        loads.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
        loads.dedup_by(|a, b| (*a - *b).abs() <= 1e-12 * far.abs());
        // Without preload, a nut has no definite axial position at zero load, so this point is
        // omitted.
        let start = usize::from(self.at_rest.preload.is_none());
        let rows = loads[start..].iter().map(|load| self.on_curve(*load)).collect();
        Columns { heads: Self::curve_columns(), rows }
    }

    fn on_curve(&self, load: f64) -> Vec<f64> {
        let mut problem = self.problem.clone();
        problem.support = problem.support.with_axial(load);
        let numbers = match self.at_rest.nut.solve(&problem.support) {
            Ok(found) => {
                Self::new(problem, NutAtRest { found, ..self.at_rest.clone() }).values_of(&CURVE)
            }
            Err(_) => vec![None; CURVE.len()],
        };
        std::iter::once(Some(load)).chain(numbers).map(|x| x.unwrap_or(f64::NAN)).collect()
    }

    /// Adds the 90 % intervals of all results to the answer for a nut, if the groove is estimated.
    ///
    /// * `settings`: the [settings](NutProblem::settings) of the problem.
    pub fn with_groove_intervals(answer: Answer, case: &Case, settings: &Settings) -> Answer {
        answer.with_groove_intervals(case, FEW_DRAWS, |possible| {
            Some(NutProblem::of(possible, settings).ok()?.solve().ok()?.answer())
        })
    }

    /// Returns the answer with the results for the nut. The answer also contains the displacements,
    /// the stiffness and the loads of all balls, under the names that the reference cases use.
    pub fn answer(&self) -> Answer {
        let (found, nut) = (self.found(), &self.at_rest.nut);
        let [z, x, y, px, py] = found.displacement;
        let of_balls = |number: &dyn Fn(&BallInGrooves) -> Option<f64>| {
            found.balls.iter().map(number).collect()
        };
        let ball = nut.ball_in_grooves().ok();
        let vectors = NutVectors {
            nut_plus_N: of_balls(&|ball| Some(ball.loads[0])),
            nut_minus_N: of_balls(&|ball| Some(ball.loads[1])),
            screw_plus_N: of_balls(&|ball| Some(ball.loads[2])),
            screw_minus_N: of_balls(&|ball| Some(ball.loads[3])),
            nut_plus_deg: of_balls(&|ball| angle_at(ball, 0)),
            nut_minus_deg: of_balls(&|ball| angle_at(ball, 1)),
            screw_plus_deg: of_balls(&|ball| angle_at(ball, 2)),
            screw_minus_deg: of_balls(&|ball| angle_at(ball, 3)),
            status: "converged",
            message: None,
            displacement_um: [z / UM, x / UM, y / UM],
            tilt_urad: [px * 1e6, py * 1e6],
            reaction_SI: found.carried.to_vec(),
            stiffness_SI: found.stiffness.concat(),
            body_axial_N: found.bodies.clone(),
            K_series_SI: ball.as_ref().map(|ball| ball.series.stiffness),
            K_nut_SI: ball.as_ref().map(|ball| ball.grooves.stiffness[0]),
            K_screw_SI: ball.as_ref().map(|ball| ball.grooves.stiffness[1]),
            iterations: found.steps,
        };
        let warm = self.problem.warm.as_deref();
        let notes = warm.map_or_else(Vec::new, Warm::notes).into_iter().chain(self.notes());
        let mut warnings = self.problem.warnings.clone();
        warnings.extend(warm.and_then(Warm::warning).into_iter().chain(self.warnings()));
        let cold = self.problem.cold_lubricant.iter().cloned();
        let not_given = cold.map(|text| MissingInput { number: "drive_torque_Nm", text }).collect();
        let of = Answer { notes: notes.collect(), warnings, not_given, ..Answer::default() };
        let answer = of.with_members(NutMembers {
            numbers: NumbersOf::new(self.numbers(|_| true), "nut"),
            vectors: Data(vectors),
            model: Label("model ", self.model()),
            circuits: Maybe(self.circuits()),
        });
        Warm::add_to(warm, answer)
    }
}
