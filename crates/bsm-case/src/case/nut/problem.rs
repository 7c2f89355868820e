//! Conversion of the inputs of a case to a nut in SI units.

use std::f64::consts::PI;
use std::sync::Arc;

use bsm_design::{DynamicRating, Nut, NutBody, PRELOAD, StaticRating, Thread};
use bsm_dyn::{Ball, Conformities, DrivenPart};
use bsm_kin::{Drive, Helix};
use bsm_nut::friction::FlankFriction;
use bsm_nut::{BallNut, Equilibrium, Errors, NutError, PreloadKind, Support, TurnRatings};

use super::bodies::bodies;
use super::circuits::{
    SHORT, deviations, lead_error, listed_circuits, of_circuits, short_circuits,
};
use super::draw::draw;
use super::friction::FrictionSource;
use super::loading::{Amount, arrangement, preload, preload_of_bodies, support};
use super::train::BallGaps;
use crate::case::axis::{AxisModel, TorqueTolerance};
use crate::case::axis_inputs::{carriage, thread_length};
use crate::case::file::RISES;
use crate::case::problem::has_lubricant;
use crate::case::rated_nut::{self, assumed_preload};
use crate::case::reader::has_grooves;
use crate::case::warm::Warm;
use crate::vocabulary::entries::Named;
use crate::vocabulary::error::invalid_input;
use crate::vocabulary::input_set::inputs;
use crate::vocabulary::number::{format_trimmed, whole};
use crate::vocabulary::units::{DEG, MM, RPM, UM};
use crate::{Case, CaseError, InputKey, InputSet, ModelChoice, Rule, Settings};

/// Inputs that have a wider range for a nut than for the models of a single ball. A nut may be
/// pulled or unloaded, and its contact angle may be zero.
const WIDER: [(InputKey, Rule); 3] = [
    (InputKey::axial_load_N, Rule::Any),
    (InputKey::contact_angle_deg, Rule::Within(0.0, 0.0)),
    // A negative gap is rejected later, with a message that states how many balls the circuit has
    // room for.
    (InputKey::ball_gap_mm, Rule::Any),
];

/// A loaded nut, as described by a case.
#[derive(Debug, Clone)]
pub struct NutProblem {
    /// Nut without preload, temperature rises and random errors.
    pub(crate) nut: BallNut,
    /// Temperature rises of nut, screw and balls \[K\], and the coefficient of thermal expansion
    /// \[1/K\].
    rises: Option<([f64; 3], f64)>,
    /// Strain of the screw due to its tension, and Poisson's ratio. The strain is not applied while
    /// the preload is set.
    strain: Option<(f64, f64)>,
    pub(crate) support: Support,
    preload: Option<(PreloadKind, Amount)>,
    /// Standard deviation of the ball radius \[m\].
    scatter: f64,
    pub(crate) seed: u64,
    pub(crate) design: Nut,
    pub(crate) thread: Thread,
    pub(crate) body: NutBody,
    pub(crate) rating: DynamicRating,
    pub(crate) static_rating: StaticRating,
    pub(crate) ratings: TurnRatings,
    /// Friction data of the balls, together with the speeds of screw and nut.
    pub(crate) friction: Option<(FrictionSource, Drive<f64>)>,
    /// Friction coefficient at the far flanks; `None` if it is the same as at the loaded flanks.
    far_friction: Option<f64>,
    /// Gaps between the balls.
    pub(crate) gaps: BallGaps,
    /// Torque of the seals \[N·m\].
    pub(crate) seal_torque: f64,
    /// Data that determine the tolerance of the friction torque due to preload.
    pub(crate) tolerance: TorqueTolerance,
    pub(crate) settings: Settings,
    /// Warm steady state of the nut, if it was requested.
    pub(crate) warm: Option<Arc<Warm>>,
    pub(crate) notes: Vec<String>,
    pub(crate) warnings: Vec<String>,
    /// Note on the torques that are not calculated because the lubricant is cold and too viscous.
    pub(crate) cold_lubricant: Option<String>,
}

/// A preloaded nut in equilibrium with its load.
#[derive(Debug, Clone)]
pub(crate) struct NutAtRest {
    /// Nut including preload, errors and temperature rises.
    pub(crate) nut: BallNut,
    pub(crate) preload: Option<NutPreload>,
    pub(crate) found: Equilibrium,
}

/// Preload of a nut, and the displacement with which it is set.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NutPreload {
    pub(crate) by: PreloadKind,
    /// Preload of the guided nut without external load and without temperature rises \[N\].
    pub(crate) cold: f64,
    /// Preload of the nut without external load, including temperature rises \[N\].
    pub(crate) warm: f64,
    /// Offset or ball oversize that sets the preload \[m\].
    pub(crate) setting: f64,
    /// Axial displacement that the preload causes in the contacts on each side \[m\].
    pub(crate) approach: f64,
}

impl NutProblem {
    /// Prepares the nut of a case. If the case has a duty cycle, the nut is solved under the load
    /// of the phase with the largest load, as for the axis sheet.
    ///
    /// * `settings`: model and solver settings for friction.
    ///
    /// # Errors
    /// Returns [`CaseError`] if an input is missing or violates a rule, or if two inputs specify
    /// the same quantity.
    pub fn of(case: &Case, settings: &Settings) -> Result<Self, CaseError> {
        settings.check()?;
        let case = &case.with_preload()?;
        case.check_for_a_nut()?;
        if let Some(warm) = Warm::state_of(case, settings, false)? {
            let nut = Self::of(&warm.case(case), &warm.settings)?;
            return Ok(Self { warm: Some(Arc::new(warm)), ..nut });
        }
        if let Some((point, note)) = case.at_largest_load()? {
            let mut nut = Self::of(&point, settings)?;
            nut.notes.insert(0, note);
            return Ok(nut);
        }
        let missing = case.missing_for_a_nut(case.given());
        if !missing.is_empty() {
            return Err(CaseError::missing(&missing, &case.given().purpose("for a nut")));
        }
        let loaded = usually_preloaded(case)?;
        let case = loaded.as_ref().unwrap_or(case);
        let (nut, way) = ball_nut(case)?;
        let preload = preload(case, &nut, way)?;
        let design = rated_nut::nut(case)?;
        let thread = rated_nut::thread(case, &design)?;
        let body = rated_nut::body(case, &design, &thread)?;
        // The inputs may give a fractional number of balls, but each circuit has a whole number of
        // balls.
        let design = of_circuits(design, &nut.circuits);
        let (rating, static_rating) = rated_nut::load_ratings(case, &design)?;
        let turns = design.turns.powf(0.86);
        let ratings = TurnRatings {
            screw: case.screw_rating_N.unwrap_or(rating.screw * turns),
            nut: case.nut_rating_N.unwrap_or(rating.screw / rating.ratio * turns),
        };
        let nut = bodies(case, nut, &body)?;
        let drive = case.reader().drive().filter(|drive| drive.relative_speed() != 0.0);
        if let ModelChoice::Fixed(model) = settings.model {
            case.covered_by(model)?;
            if !has_grooves(model) {
                return Err(CaseError::Invalid(format!(
                    "model {} does not calculate the balls of a nut; use auto, raceway-control, elastic or traction for \
                     the friction of the balls",
                    model.name()
                )));
            }
            if case.given().is_lubricated() && !has_lubricant(model) {
                return Err(CaseError::no_lubricant(model));
            }
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "the number is an integer"
        )]
        let seed = case.number(InputKey::seed) as u64;
        let friction = FrictionSource::of(case)?;
        let gaps = BallGaps::of(case, friction, &nut)?;
        let tolerance = TorqueTolerance {
            grade: case.entries.accuracy_grade.map(|name| name.grade),
            length: thread_length(case, design.lead, body.length),
            diameter: thread.screw.land,
        };
        Ok(Self {
            support: support(case)?,
            notes: notes(case, &nut, preload, loaded.as_ref().and_then(|case| case.preload_N)),
            nut,
            rises: rises(case),
            strain: strain(case, &design, &thread),
            preload,
            scatter: 0.5 * UM * case.ball_deviation_sd_um.unwrap_or(0.0),
            seed,
            design,
            thread,
            body,
            rating,
            static_rating,
            ratings,
            gaps,
            friction: friction.zip(drive),
            far_friction: case.far_flank_friction_coefficient,
            seal_torque: case.number(InputKey::seal_torque_Nm),
            tolerance,
            settings: *settings,
            warm: None,
            warnings: case.warnings(),
            cold_lubricant: case.cold_lubricant(),
        })
    }

    /// Returns the model and the settings that were used for friction. They differ from the
    /// requested settings if a warm state exists only with another model.
    pub fn settings(&self) -> Settings {
        self.settings
    }

    /// Returns true if the preload is given as a nonzero offset or ball oversize.
    pub(crate) fn sets_preload_by_displacement(&self) -> bool {
        matches!(self.preload, Some((_, Amount::Displacement(displacement))) if displacement != 0.0)
    }

    /// Returns the friction coefficients at the loaded flanks and at the far flanks.
    pub(crate) fn flank_friction(&self, source: &FrictionSource) -> FlankFriction {
        FlankFriction { loaded: source.coefficient(), far: self.far_friction }
    }

    /// Returns the number of loaded balls.
    pub fn balls(&self) -> usize {
        self.nut.balls()
    }

    /// Preloads and loads the nut, and calculates the loads of all balls. Random errors are drawn
    /// with the seed of the problem.
    ///
    /// # Errors
    ///
    /// Returns [`NutError`] if no ball can carry the load, or if no displacement produces the
    /// preload.
    pub(crate) fn solve_at_rest(&self) -> Result<NutAtRest, NutError> {
        if self.scatter > 0.0 {
            self.with_random_errors(self.seed, 0, &[]).solve_without_errors()
        } else {
            self.solve_without_errors()
        }
    }

    /// Returns a copy of the nut with random ball radii and random phases of its lead errors.
    ///
    /// * `waves`: indices of the lead errors with random phases.
    pub(crate) fn with_random_errors(&self, seed: u64, number: u64, waves: &[usize]) -> Self {
        let mut one = self.clone();
        draw(&mut one.nut, self.scatter, waves, seed, number);
        one
    }

    /// Returns true if the ball diameters are random.
    pub(crate) fn scatters(&self) -> bool {
        self.scatter > 0.0
    }

    /// Preloads and loads the nut without drawing random errors.
    pub(crate) fn solve_without_errors(&self) -> Result<NutAtRest, NutError> {
        let guided = Support::guided(0.0);
        let cold = match self.preload {
            None => self.nut.clone(),
            Some((by, Amount::Displacement(displacement))) => self.nut.preloaded(by, displacement),
            Some((by, Amount::Force(force))) => {
                let displacement = self.nut.preload_displacement(by, force, &guided)?;
                self.nut.preloaded(by, displacement)
            }
        };
        // Temperature rises do not change the offset or oversize that sets the preload (U19).
        let nut = match self.rises {
            Some((rises, expansion)) => cold.warmed(rises, expansion),
            None => cold.clone(),
        };
        let nut = match self.strain {
            Some((strain, poisson_ratio)) => nut.strained(strain, poisson_ratio),
            None => nut,
        };
        let found = nut.solve(&self.support)?;
        let two = nut.circuits.iter().any(|circuit| circuit.body == 1);
        let by = match self.preload {
            Some((by, _)) => Some(by),
            None if two => Some(PreloadKind::Offset),
            None if nut.errors.oversize > 0.0 => Some(PreloadKind::Oversize),
            None => None,
        };
        let preload = by.and_then(|by| {
            let force = |nut: &BallNut| Some(nut.solve(&guided).ok()?.preload(nut, by));
            let before = force(&cold)?;
            let warm =
                if self.rises.is_some() || self.strain.is_some() { force(&nut)? } else { before };
            let (setting, approach) = (cold.preload_offset(by), cold.preload_approach(by));
            (before > 0.0 || warm > 0.0).then_some(NutPreload {
                by,
                cold: before,
                warm,
                setting,
                approach,
            })
        });
        Ok(NutAtRest { nut, preload, found })
    }
}

impl Case {
    /// Returns the case at a given load and speed of its axis, without a cycle. A load of zero is
    /// valid for preloaded nuts. If both the screw and the nut turn in the case, the ratio of their
    /// speeds is kept; otherwise, only the driven part turns.
    ///
    /// * `load`: axial load \[N\].
    /// * `speed`: speed of the screw relative to the nut \[rad/s\].
    pub(crate) fn at_point(&self, load: f64, speed: f64) -> Self {
        let ratio = || self.speeds_rpm().map(|(screw, nut)| nut / (screw - nut));
        let turning = match self.entries.driven_part {
            Some(Named(DrivenPart::Nut)) => Some(-1.0),
            Some(Named(DrivenPart::Screw)) => None,
            None => ratio(),
        };
        let nut = turning.filter(|share| share.is_finite() && *share != 0.0);
        let nut = nut.map(|share| share * speed / RPM);
        let mut case = self.without_carriage();
        (case.axial_load_N, case.feed_m_min, case.entries.cycle) = (Some(load), None, None);
        case.screw_speed_rpm = Some(speed / RPM + nut.unwrap_or(0.0));
        case.nut_speed_rpm = nut;
        case
    }

    /// Returns the case without moving mass, guide force, counterweight and counterbalance, because
    /// the axial load already includes their forces.
    pub(crate) fn without_carriage(&self) -> Self {
        let mut case = self.clone();
        (case.moved_mass_kg, case.guide_force_N) = (None, None);
        (case.counterweight_kg, case.counterbalance_N) = (None, None);
        case
    }

    /// Returns the case under the largest load of its axis, and a note that states the load and the
    /// speed. This load is the largest load in the cycle or, without a cycle, the axial load plus
    /// the forces of moving mass, guides and counterbalance. Returns `None` if no load other than
    /// the axial load acts.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError`] if an input of the axis is missing, or if the nut is loaded neither by
    /// the axis nor by a preload.
    fn at_largest_load(&self) -> Result<Option<(Self, String)>, CaseError> {
        let cycles = self.entries.cycle.is_some();
        if !cycles && !carriage(self)?.is_loaded() {
            return Ok(None);
        }
        let axis = AxisModel::of(self)?.axis;
        let pressed = axis.heaviest().filter(|phase| phase.load != 0.0 || self.is_preloaded());
        let Some(phase) = pressed else {
            let what = "does not load the nut, which has no preload either";
            return Err(if cycles {
                invalid_input("cycle", what)
            } else {
                CaseError::Invalid(format!(
                    "the axis {what}; give axial_load_N, a cycle, or a preload"
                ))
            });
        };
        let speed = if phase.speed == 0.0 { axis.fastest() } else { phase.speed };
        let point = self.at_point(phase.load, speed);
        let at = match (cycles, self.axial_load_N) {
            (true, _) => "in the phase of the cycle with the largest load",
            (false, None) => {
                "under the load that mass, guides and counterbalance of the axis exert"
            }
            (false, Some(_)) => {
                "under the load that axial_load_N, mass, guides and counterbalance of the axis exert"
            }
        };
        let note = format!(
            "The nut is calculated {at}: {} N at {} rpm.",
            format_trimmed(phase.load),
            format_trimmed(speed / RPM)
        );
        Ok(Some((point, note)))
    }

    /// Checks all values against the rules that apply to a nut.
    fn check_for_a_nut(&self) -> Result<(), CaseError> {
        let wider = |&(key, rule): &(InputKey, Rule)| {
            let value = self[key]?;
            (rule.holds(value) && !key.input().rule.holds(value)).then_some(key)
        };
        let wider: InputSet = WIDER.iter().filter_map(wider).collect();
        self.check_but(wider.union(self.speeds_at_rest()))
    }
}

/// Returns the nut without the elasticity of its bodies, and the kind of preload that can be set
/// for the nut.
fn ball_nut(case: &Case) -> Result<(BallNut, PreloadKind), CaseError> {
    let words = &case.entries;
    let radius = 0.5 * MM * case.number(InputKey::ball_diameter_mm);
    let (circuits, way) = if let Some(listed) = &words.circuits {
        if let Some(key) = SHORT.into_iter().find(|key| case[*key].is_some()) {
            return Err(CaseError::given_twice(["circuits", key.name()]));
        }
        let several = listed.iter().any(|circuit| circuit.body > 0);
        let usual = if several { PreloadKind::Offset } else { PreloadKind::Oversize };
        let way = words.preload_by.map_or(usual, preload_of_bodies);
        (listed_circuits(listed, case.number(InputKey::starts), arrangement(case)?)?, way)
    } else {
        let way = words.preload_by.map_or(PreloadKind::Offset, preload_of_bodies);
        (short_circuits(case, way)?, way)
    };
    let lead_errors = words.lead_error.as_deref().unwrap_or_default();
    let errors = Errors {
        balls: deviations(words, case.ball_deviation_sd_um)?,
        oversize: 0.0,
        lead: lead_errors.iter().enumerate().map(lead_error).collect::<Result<_, _>>()?,
        gap: case.radial_gap_um.unwrap_or(0.0) * UM,
        axial_play: case.reader().arch_fit().map(|fit| fit.axial_play),
    };
    let helix = Helix {
        radius: 0.5 * MM * case.number(InputKey::pitch_circle_diameter_mm),
        lead_angle: case.lead_angle().unwrap_or(f64::NAN),
    };
    let precession = words.ball_precession_rad_s.unwrap_or(0.0);
    let nut = BallNut {
        helix,
        starts: whole(case.number(InputKey::starts)),
        ball: Ball::of_density(radius, case.number(InputKey::density_kg_m3)),
        contact_angle: case.number(InputKey::contact_angle_deg) * DEG,
        conformity: Conformities {
            nut: case.number(InputKey::nut_conformity),
            screw: case.number(InputKey::screw_conformity),
        },
        material: case.reader().materials(),
        circuits,
        errors,
        nut_bar: None,
        screw_bar: None,
        ring: None,
        reference: case.reference_z_mm.map(|z| z * MM),
        precession: Rule::Any.checked("ball_precession_rad_s", precession)?,
    };
    let given = nut.errors.balls.len();
    if given > 0 && given != nut.balls() {
        let what = format!("has {given} numbers, but the nut has {} balls", nut.balls());
        return Err(invalid_input("ball_deviation_um", what));
    }
    Ok((nut, way))
}

/// Returns the temperature rises of nut, screw and balls \[K\] and the coefficient of thermal
/// expansion \[1/K\], or `None` if no temperature rise is given.
fn rises(case: &Case) -> Option<([f64; 3], f64)> {
    let given = RISES.iter().any(|key| case[*key].is_some());
    given.then(|| {
        (RISES.map(|key| case.number(key)), case.number(InputKey::thermal_expansion_um_m_K) * UM)
    })
}

/// Returns the strain of the screw due to its tension, and Poisson's ratio, or `None` without a
/// tension.
fn strain(case: &Case, design: &Nut, thread: &Thread) -> Option<(f64, f64)> {
    let tension = case.screw_tension_N.filter(|tension| *tension != 0.0)?;
    let diameter = case.shaft_diameter_mm.map_or(thread.screw.core, |mm| mm * MM);
    let section = section_of_screw(case, diameter);
    let strain = tension / (design.material.raceways.youngs_modulus * section);
    Some((strain, case.value_or_default(InputKey::poisson_ratio)?))
}

/// Returns the cross-sectional area of a screw with the given diameter, minus its bore \[m²\].
fn section_of_screw(case: &Case, diameter: f64) -> f64 {
    let bore = case.screw_bore_mm.unwrap_or(0.0) * MM;
    0.25 * PI * (diameter.powi(2) - bore.powi(2))
}

/// If neither a load nor a preload is given, returns a copy of the case with a nut pair that is
/// preloaded with a typical fraction of the dynamic load rating. Otherwise, returns `None`.
fn usually_preloaded(case: &Case) -> Result<Option<Case>, CaseError> {
    if case.is_loaded() {
        return Ok(None);
    }
    let (dynamic, _) = rated_nut::load_ratings(case, &rated_nut::nut(case)?)?;
    Ok(Some(Case { preload_N: Some(PRELOAD * dynamic.rating), ..case.clone() }))
}

/// Returns notes on the interpretation of ambiguous inputs.
///
/// * `usual`: preload \[N\] that is assumed if neither a load nor a preload is given.
fn notes(
    case: &Case,
    nut: &BallNut,
    preload: Option<(PreloadKind, Amount)>,
    usual: Option<f64>,
) -> Vec<String> {
    let mut notes: Vec<_> = usual.map(assumed_preload).into_iter().collect();
    let by = preload.map(|(by, _)| by);
    if let (Some((PreloadKind::Offset, Amount::Force(force) | Amount::Displacement(force))), None) =
        (preload, &case.entries.circuits)
    {
        let arranged = if force < 0.0 {
            "pushed apart (O arrangement)"
        } else {
            "pulled together (X arrangement)"
        };
        notes.push(format!(
            "The preload is applied to a pair of nuts with {} balls each, one turn apart and {arranged}. For one nut with oversize \
             balls, set preload_by to oversize.",
            nut.balls() / 2
        ));
    }
    if by == Some(PreloadKind::Oversize) && case.preload_N.is_some() {
        notes.push(
            "For a single nut, preload_N is the preload due to oversize balls, which press against \
             both flanks."
                .to_owned(),
        );
    }
    if let Some(balls) = case.loaded_balls
        && whole(balls) != nut.balls()
    {
        notes.push(format!(
            "The circuits have {} balls. loaded_balls = {} applies only to the single-ball models.",
            nut.balls(),
            format_trimmed(balls)
        ));
    }
    notes
}

/// Inputs that only the nut analysis uses. Other commands print a note that they ignore these
/// inputs.
pub(crate) const NUT_ONLY_INPUTS: InputSet = inputs! {
    preload_N preload_offset_um ball_oversize_um radial_load_x_N radial_load_y_N moment_x_Nm
    moment_y_Nm tilt_x_urad tilt_y_urad radial_x_um radial_y_um
};
