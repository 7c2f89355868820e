//! Conversion of the inputs of a case to an axis in SI units.

use std::f64::consts::TAU;

use bsm_design::drive::{DriveTrain, MachineTable, MotorCurve};
use bsm_design::life::{Life, RequiredLife};
use bsm_design::motion::{CycleTravel, Phase, phases};
use bsm_design::shaft::{EndFixity, Shaft};
use bsm_design::{Axis, Grade, Nut, NutBody, Screw, Thread};
use bsm_dyn::DrivenPart;

use crate::case::axis_inputs::{
    AXIAL_LOAD, carriage, driven_part, motor_curve, mount, preload, rated_dynamic_load,
    rating_factors, reliability, required_life, screws_per_motor, stroke,
};
use crate::case::cycle::Cycle;
use crate::case::nut::NutTurns;
use crate::case::rated_nut;
use crate::case::rated_screw::RatedScrew;
use crate::vocabulary::error::invalid_input;
use crate::vocabulary::number::format_trimmed;
use crate::vocabulary::units::{MM, UM};
use crate::{Case, CaseError, InputKey};

/// Shortest stroke for which a fatigue life is calculated, in turns of the screw.
pub(crate) const MIN_STROKE_TURNS: f64 = 0.5;

/// Largest permitted ratio of the bore diameter to the core diameter of the screw.
const MAX_BORE_RATIO: f64 = 0.8;

/// The axis that a case describes, with its rotating parts and its moving masses.
#[derive(Debug, Clone)]
pub(crate) struct AxisModel {
    pub(crate) axis: Axis,
    /// Load ratings without modifying factors.
    pub(crate) ratings: Ratings,
    /// Nut and thread; `None` if only the ratings of the screw are known.
    pub(crate) groove: Option<(Nut, Thread)>,
    pub(crate) body: NutBody,
    pub(crate) carriage: MachineTable,
    pub(crate) drive: DriveTrain,
    /// The screw as a rotating part; `None` if its length is unknown.
    pub(crate) screw: Option<RotatingScrew>,
    /// Mass of the nut \[kg\], given or calculated from its groove.
    pub(crate) nut_mass: Option<f64>,
    /// Moment of inertia of a driven nut \[kg·m²\]; `None` if the screw is driven.
    pub(crate) nut_inertia: Option<f64>,
    /// Length of the thread \[m\]; `None` if the length cannot be determined because the stroke is
    /// unknown.
    pub(crate) thread: Option<f64>,
    /// Stroke \[m\], either given or taken from the range of the cycle.
    pub(crate) stroke: Option<f64>,
    /// Duration \[s\] and travel of the cycle; `None` for a single operating point and for a cycle
    /// that is given by time shares.
    pub(crate) cycle: Option<(f64, CycleTravel)>,
    /// Required life, if it is given.
    pub(crate) required_life: Option<RequiredLife>,
    /// Torque-speed curve of the motor, if one is given.
    pub(crate) motor_curve: Option<MotorCurve>,
    /// Axial load on the screw at standstill \[N\]. It is positive if it acts against a positive
    /// feed.
    pub(crate) rest_load: f64,
    /// Screw between two fixed bearings; `None` for other supports.
    pub(crate) held: Option<FixedEnds>,
    /// Notes on estimated dimensions of the screw and the nut.
    pub(crate) assumed: Vec<String>,
    /// Warning if the manufacturer's ratings do not match the groove.
    pub(crate) warning: Option<String>,
}

/// Load ratings of a nut, either calculated or stated by the manufacturer. Unknown ratings are NaN.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ratings {
    /// Dynamic load rating \[N\].
    pub(crate) dynamic: f64,
    /// Static load rating \[N\].
    pub(crate) static_: f64,
}

/// Mass and moment of inertia of the screw between its bearings.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RotatingScrew {
    /// Mass \[kg\].
    pub(crate) mass: f64,
    /// Moment of inertia about the axis \[kg·m²\].
    pub(crate) inertia: f64,
}

/// Properties of a screw between two fixed bearings, which prevent its thermal expansion.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FixedEnds {
    pub(crate) shaft: Shaft,
    /// Stiffness of each bearing \[N/m\].
    pub(crate) bearing: f64,
    /// Thermal expansion of the screw per kelvin if its ends are free \[m/K\].
    growth: f64,
    /// Temperature rise \[K\] at which the thermal expansion exactly cancels the pretension.
    pub(crate) stretched: f64,
}

impl FixedEnds {
    /// Returns the screw between two fixed bearings, or `None` for other supports.
    fn of(case: &Case, shaft: &Shaft) -> Result<Option<Self>, CaseError> {
        let pretension = [InputKey::pretension_N, InputKey::pretension_K];
        if shaft.support != EndFixity::FixedFixed {
            let given = pretension.into_iter().find(|key| case[*key].is_some());
            return given.map_or(Ok(None), |key| {
                Err(invalid_input(key.name(), "needs support fixed-fixed"))
            });
        }
        if pretension.iter().all(|key| case[*key].is_some()) {
            return Err(CaseError::given_twice(pretension.map(InputKey::name)));
        }
        let bearing = case.support_bearing_stiffness_N_um.map_or(f64::INFINITY, |k| k / UM);
        let growth = case.number(InputKey::thermal_expansion_um_m_K) * UM * shaft.length;
        let by_force = |force| shaft.stretched_by(growth, bearing, force);
        let stretched = case.pretension_N.map(by_force).or(case.pretension_K).unwrap_or(0.0);
        Ok(Some(Self { shaft: *shaft, bearing, growth, stretched }))
    }

    /// Returns the tension of the screw \[N\] if its temperature exceeds the temperature of the
    /// machine bed by `rise` \[K\].
    pub(crate) fn tension(&self, rise: f64) -> f64 {
        self.shaft.tension(self.growth, self.bearing, self.stretched, rise)
    }
}

/// Rejects a screw bore that leaves a wall thinner than half a ball diameter.
///
/// * `core`: core diameter \[m\].
/// * `ball`: ball diameter \[m\]; 0 if unknown.
fn check_bore(case: &Case, core: f64, ball: f64) -> Result<(), CaseError> {
    let most = (MAX_BORE_RATIO * core).min(core - ball);
    match case.screw_bore_mm.filter(|bore| bore * MM > most) {
        None => Ok(()),
        Some(bore) => {
            let rule = format!(
                "<= {:.3} mm, which is at most {MAX_BORE_RATIO} of the core diameter and leaves a wall of half a ball diameter",
                most / MM
            );
            Err(CaseError::out_of_range("screw_bore_mm".to_owned(), bore, rule))
        }
    }
}

/// Rejects a case in which no load acts on the screw.
fn check_loaded(case: &Case, phases: &[Phase], carriage: &MachineTable) -> Result<(), CaseError> {
    let is_loaded = phases.iter().flat_map(|phase| phase.load).any(|load| load != 0.0);
    if is_loaded || carriage.is_loaded() || case.is_preloaded() {
        return Ok(());
    }
    if case.entries.cycle.is_some() && case.axial_load_N.is_some() {
        return Err(invalid_input(
            "axial_load_N",
            "has no effect beside a cycle, and no other load acts on the screw; give force_N in the entries of the cycle",
        ));
    }
    Err(CaseError::Invalid(
        "no load acts on the screw; give axial_load_N, a cycle with force_N, moved_mass_kg, guide_force_N, \
         or a preload"
            .to_owned(),
    ))
}

/// Returns the drive train between the motor and the driven part.
///
/// * `driven_inertia`: moment of inertia of the rotating part without the coupling \[kg·m²\].
fn drive_train(
    case: &Case,
    lead: f64,
    driven_inertia: f64,
    carriage: &MachineTable,
) -> Result<DriveTrain, CaseError> {
    Ok(DriveTrain {
        lead,
        driven_inertia: driven_inertia + case.number(InputKey::coupling_inertia_kg_m2),
        mass: carriage.share * carriage.moved_mass(),
        gear_ratio: case.number(InputKey::gear_ratio),
        gear_efficiency: case.number(InputKey::gear_efficiency),
        motor_inertia: case.number(InputKey::motor_inertia_kg_m2),
        gear_inertia: case.number(InputKey::gear_inertia_kg_m2),
        screws: screws_per_motor(case)?,
        brake_at_rest: case.entries.brake_at_rest == Some(true),
    })
}

/// A screw and its nut.
struct ScrewAndNut {
    /// Nut and thread; `None` if only the ratings of the screw are known.
    groove: Option<(Nut, Thread)>,
    /// Dimensions of the screw and the nut body.
    size: RatedScrew,
    /// Warning if the given ratings do not match the groove.
    warning: Option<String>,
}

impl ScrewAndNut {
    /// Determines the screw and the nut of a case.
    fn of(case: &Case) -> Result<Self, CaseError> {
        if case.lacks_groove() {
            let size = RatedScrew::without_groove(case)?;
            return Ok(Self { groove: None, size, warning: None });
        }
        let nut = rated_nut::nut(case)?;
        let thread = rated_nut::thread(case, &nut)?;
        if case.has_estimated_groove() {
            // Catalog lists and rules give more accurate values for the core diameter and the nut
            // body than an estimated groove.
            let pitch_circle_diameter_mm = case.pitch_circle_diameter_mm;
            let line = Case { pitch_circle_diameter_mm, ..case.without_estimates() };
            let size = RatedScrew::of(&line, NutTurns::of(case).turns)?;
            return Ok(Self { groove: Some((nut, thread)), size, warning: None });
        }
        let body = rated_nut::body(case, &nut, &thread)?;
        let warning = rated_nut::compared(case, &nut)?;
        let size = RatedScrew { screw: nut.screw(&thread), body, assumed: Vec::new() };
        Ok(Self { groove: Some((nut, thread)), size, warning })
    }

    /// Returns the load ratings without modifying factors. Stated ratings take precedence over
    /// calculated ratings.
    fn ratings(&self, case: &Case) -> Result<Ratings, CaseError> {
        // The ratings of an estimated groove contain no information beyond the catalog ratings from
        // which the groove was estimated.
        let known = self.groove.as_ref().filter(|_| !case.has_estimated_groove());
        let dynamic = || known.map(|(nut, _)| nut.dynamic_rating().rating);
        let static_ = || known.map(|(nut, _)| nut.static_rating().rating);
        Ok(Ratings {
            dynamic: rated_dynamic_load(case)?.or_else(dynamic).unwrap_or(f64::NAN),
            static_: case.rated_static_load_N.or_else(static_).unwrap_or(f64::NAN),
        })
    }

    /// Returns the mass of the nut \[kg\]. It is either given or follows from the groove, even if the
    /// groove is estimated. Returns `None` if the groove is unknown.
    fn nut_mass(&self, case: &Case) -> Result<Option<f64>, CaseError> {
        match (case.nut_mass_kg, &self.groove) {
            (Some(given), _) => Ok(Some(given)),
            (None, Some((nut, thread))) => {
                Ok(Some(rated_nut::body(case, nut, thread)?.mass(nut, thread)))
            }
            (None, None) => Ok(None),
        }
    }
}

/// Returns the screw as a rotating part, or `None` if its mass is unknown.
fn rotating_screw(case: &Case, size: &Screw, shaft: &Shaft) -> Option<RotatingScrew> {
    let (bore, length) = (shaft.bore.diameter, shaft.length);
    let mass = size.mass(bore, length);
    let stated = case.screw_inertia_kg_m2_m.map(|inertia| inertia * length);
    let inertia = stated.unwrap_or(size.inertia(bore, length));
    (!mass.is_nan()).then_some(RotatingScrew { mass, inertia })
}

/// Returns the given or estimated moment of inertia of a driven nut \[kg·m²\]. If the value is
/// estimated, adds a note to `assumed`.
fn nut_inertia(case: &Case, size: &Screw, body: &NutBody, assumed: &mut Vec<String>) -> f64 {
    case.nut_inertia_kg_m2.unwrap_or_else(|| {
        let tube = body.tube_inertia(size.pitch_diameter);
        let what = "of a steel tube from the pitch circle to nut_outer_diameter_mm (BB10)";
        assumed.push(format!(
            "nut_inertia_kg_m2 = {} is estimated as the value {what}.",
            format_trimmed(tube)
        ));
        tube
    })
}

/// Returns the duration \[s\] and the travel of the cycle, or `None` if the cycle has no durations.
///
/// * `lead`: lead of the screw \[m\].
fn cycle_travel(motion: &Cycle, lead: f64) -> Result<Option<(f64, CycleTravel)>, CaseError> {
    let cycle = motion.time.zip(motion.travel(lead));
    let is_finite =
        |(time, travel): (f64, CycleTravel)| time.is_finite() && travel.distance.is_finite();
    if cycle.is_none_or(is_finite) {
        return Ok(cycle);
    }
    Err(invalid_input("cycle", "results in a travel that is too large; give shorter times"))
}

impl AxisModel {
    /// Calculates the axis of a case. The preload is not included, because it is determined by the
    /// nut.
    pub(crate) fn of(case: &Case) -> Result<Self, CaseError> {
        // The process force may be zero or act in the direction of the feed, so the rule that
        // `axial_load_N` must be positive is not checked.
        case.check_but(case.speeds_at_rest().union(AXIAL_LOAD))?;
        let driven = driven_part(case)?;
        let parts = ScrewAndNut::of(case)?;
        let ratings = parts.ratings(case)?;
        let nut_mass = parts.nut_mass(case)?;
        let ScrewAndNut { groove, size, warning } = parts;
        let RatedScrew { screw: size, body, mut assumed } = size;
        let factors = rating_factors(case);
        let stroke = stroke(case)?;
        let shaft = mount(case).shaft(&size, body.length, stroke);
        // The default length depends on the lead. Without a lead, it is NaN.
        let shaft = shaft.filter(|shaft| !shaft.length.is_nan());
        let core = shaft.map_or(size.core, |shaft| shaft.diameter);
        check_bore(case, core, groove.as_ref().map_or(0.0, |(nut, _)| nut.ball_diameter))?;
        let held = shaft.as_ref().map_or(Ok(None), |shaft| FixedEnds::of(case, shaft))?;
        let carriage = carriage(case)?;
        let motion = Cycle::of(case)?;
        assumed.extend(motion.notes.iter().cloned());
        if let (None, Some(stroke)) = (case.stroke_mm, stroke) {
            assumed.push(format!(
                "stroke_mm is not given. The stroke is the range of the cycle, {} mm.",
                format_trimmed(stroke / MM)
            ));
        }
        let screw = shaft.as_ref().and_then(|shaft| rotating_screw(case, &size, shaft));
        let nut_inertia =
            (driven == DrivenPart::Nut).then(|| nut_inertia(case, &size, &body, &mut assumed));
        let of_driven = nut_inertia.or(screw.map(|screw| screw.inertia)).unwrap_or(0.0);
        let drive = drive_train(case, size.lead, of_driven, &carriage)?;
        let cycle = cycle_travel(&motion, size.lead)?;
        let phases = phases(&motion.segments, &carriage, size.lead);
        let is_rated = groove.is_some() || !ratings.dynamic.is_nan() || !ratings.static_.is_nan();
        if is_rated {
            check_loaded(case, &phases, &carriage)?;
        }
        let axis = Axis {
            screw: size,
            shaft,
            phases,
            dynamic_rating: factors.dynamic_rating * ratings.dynamic,
            static_rating: factors.static_rating * ratings.static_,
            preload: None,
            driven,
            compression: -case.screw_tension_N.unwrap_or(0.0).min(0.0),
            reliability: reliability(case),
        };
        let required_life = required_life(case, motion.time, stroke)?;
        let motor_curve = motor_curve(case, axis.fastest() * drive.gear_ratio)?;
        let thread = stroke.map(|stroke| mount(case).thread_length(size.lead, body.length, stroke));
        let rest_load = carriage.rest_load(motion.rest_force);
        Ok(Self {
            axis,
            ratings,
            groove,
            body,
            carriage,
            drive,
            screw,
            nut_mass,
            nut_inertia,
            thread,
            stroke,
            cycle,
            required_life,
            motor_curve,
            rest_load,
            held,
            assumed,
            warning,
        })
    }

    /// Returns the sum of the stroke and the length of the nut set \[m\], or `None` if the stroke
    /// is not known.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError`] if the thread is longer than the unsupported length.
    pub(crate) fn travel(&self, case: &Case) -> Result<Option<f64>, CaseError> {
        let Some((stroke, thread)) = self.stroke.zip(self.thread) else { return Ok(None) };
        let length = self.axis.shaft.map_or(f64::INFINITY, |shaft| shaft.length);
        // The comparison allows for rounding errors of decimal lengths in millimeters.
        if thread > length * (1.0 + 1e-12) {
            let (nut, is_estimated) = (self.body.length / MM, case.nut_length_mm.is_none());
            let overrun = mount(case).overrun_of(self.axis.screw.lead) / MM;
            return Err(invalid_input(
                "unsupported_length_mm",
                format!(
                    "is {} mm, but the thread is {} mm long (stroke {} mm, {}nut {} mm, overrun {} mm at each end), so the nut would \
                     run into the bearings. Increase unsupported_length_mm, or give a smaller {}overrun_mm",
                    format_trimmed(length / MM),
                    format_trimmed(thread / MM),
                    format_trimmed(stroke / MM),
                    if is_estimated { "estimated " } else { "" },
                    format_trimmed(nut),
                    format_trimmed(overrun),
                    if is_estimated { "nut_length_mm or " } else { "" }
                ),
            ));
        }
        Ok(Some(stroke + self.body.length))
    }

    /// Returns the travel \[m\] over which the accuracy grade limits the travel error. It defaults
    /// to the stroke.
    pub(crate) fn useful_travel(&self, case: &Case) -> Option<f64> {
        case.useful_travel_mm.map(|mm| mm * MM).or(self.stroke)
    }

    /// Returns the length of the screw section over which the nut moves \[m\]. It is the stroke
    /// plus the length of the nut set or, without a stroke, the unsupported length minus the
    /// overrun at both ends. Returns `None` if the nut does not fit between the overruns.
    pub(crate) fn covered(&self, case: &Case) -> Result<Option<f64>, CaseError> {
        let by_length = || {
            let overrun = mount(case).overrun_of(self.axis.screw.lead);
            let covered = self.axis.shaft?.length - 2.0 * overrun;
            (covered > self.body.length).then_some(covered)
        };
        Ok(self.travel(case)?.or_else(by_length))
    }

    /// Returns the nominal diameter of the screw \[m\], or its outer diameter if the nominal
    /// diameter is unknown.
    pub(crate) fn nominal(&self, case: &Case) -> f64 {
        case.nominal_diameter_mm.map_or(self.axis.screw.outer, |mm| mm * MM)
    }

    /// Returns true if the moment of inertia of the driven part is known.
    pub(crate) fn has_inertia(&self) -> bool {
        self.nut_inertia.is_some() || self.screw.is_some()
    }

    /// Returns the life under the duty cycle, or `None` if the life is unknown. For a stroke of
    /// less than half a turn, `None` is returned as well, because the groove then fails by false
    /// brinelling.
    pub(crate) fn life(&self) -> Option<Life> {
        let turns = self.stroke.map(|stroke| stroke / self.axis.screw.lead);
        self.axis.life().filter(|_| turns.is_none_or(|turns| turns >= MIN_STROKE_TURNS))
    }

    /// Returns the travel per radian of screw rotation \[m\].
    pub(crate) fn advance(&self) -> f64 {
        self.axis.screw.lead / TAU
    }
}

/// Data that determine the tolerance of the friction torque due to preload. The accuracy grade and
/// the thread length may be unknown.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TorqueTolerance {
    /// Accuracy grade of the screw.
    pub(crate) grade: Option<&'static Grade>,
    /// Length of the thread \[m\].
    pub(crate) length: Option<f64>,
    /// Outer diameter of the screw \[m\].
    pub(crate) diameter: f64,
}

impl TorqueTolerance {
    /// Returns the permitted variation of a torque \[N·m\] as a ± value \[%\].
    pub(crate) fn percent(&self, torque: f64) -> Option<f64> {
        self.grade?.torque_variation(torque, self.length?, self.diameter)
    }

    /// Returns the lower limit (`side` is -1) or the upper limit (`side` is 1) of a torque \[N·m\].
    pub(crate) fn end(&self, torque: f64, side: f64) -> Option<f64> {
        Some(torque * (1.0 + side * 0.01 * self.percent(torque)?))
    }
}

impl Case {
    /// Returns a copy of the case in which the preload class is replaced by a preload force or an
    /// axial play.
    pub(crate) fn with_preload(&self) -> Result<Self, CaseError> {
        let mut case = self.clone();
        if case.entries.preload_class.take().is_none() {
            return Ok(case);
        }
        let (preload, play) = preload(self)?;
        case.axial_play_um = case.axial_play_um.or(play.map(|play| play / UM));
        if let Some(preload) = preload {
            // The axis is needed only if the preload depends on the load.
            let axis = AxisModel::of(&case)?.axis;
            case.preload_N = Some(preload.force(axis.largest_load(), axis.dynamic_rating));
        }
        Ok(case)
    }
}
