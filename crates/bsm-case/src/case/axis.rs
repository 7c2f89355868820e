//! Conversion of the inputs of a case to an axis in SI units.

use std::f64::consts::TAU;

use bsm_design::drive::{DriveTrain, MachineTable, MotorCurve, MotorPoint};
use bsm_design::life::{
    Hardness, Life, RatingBasis, RatingFactors, RequiredLife, reliability_factor,
};
use bsm_design::motion::{CycleTravel, Phase, phases};
use bsm_design::shaft::{Bore, EndFixity, Shaft};
use bsm_design::{
    Axis, Grade, Make, Mount, Nut, NutBody, NutSet, PreloadClass, PreloadMethod, PreloadSize,
    Thread,
};
use bsm_dyn::DrivenPart;

use crate::case::cycle::Cycle;
use crate::case::nut::balls_and_turns;
use crate::case::rated_nut;
use crate::case::rated_screw::RatedScrew;
use crate::vocabulary::entries::{MotorCurveRow, Named, SteelFactor};
use crate::vocabulary::error::invalid_input;
use crate::vocabulary::input_set::inputs;
use crate::vocabulary::number::format_trimmed;
use crate::vocabulary::units::{DEG, MM, RPM, UM};
use crate::{Case, CaseError, InputKey, InputSet};

/// Shortest stroke for which a fatigue life is calculated, in turns of the screw.
pub(crate) const MIN_STROKE_TURNS: f64 = 0.5;

/// Largest permitted ratio of the bore diameter to the core diameter of the screw.
const MAX_BORE_RATIO: f64 = 0.8;

/// The axis that a case describes, with its rotating parts and its moving masses.
#[derive(Debug, Clone)]
pub(crate) struct AxisModel {
    pub(crate) axis: Axis,
    /// Dynamic and static load rating without modifying factors \[N\], either calculated or stated
    /// by the manufacturer.
    pub(crate) ratings: [f64; 2],
    /// Nut and thread; `None` if only the ratings of the screw are known.
    pub(crate) groove: Option<(Nut, Thread)>,
    pub(crate) body: NutBody,
    pub(crate) carriage: MachineTable,
    pub(crate) drive: DriveTrain,
    /// Mass \[kg\] and moment of inertia \[kg·m²\] of the screw; `None` if the length is unknown.
    pub(crate) screw: Option<(f64, f64)>,
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

/// Nut and thread, dimensions of the screw and the nut body, and a warning if the given ratings do
/// not match the groove.
type ScrewAndNut = (Option<(Nut, Thread)>, RatedScrew, Option<String>);

/// Returns the nut and thread of a case, the dimensions of its screw and nut body, and a warning if
/// the given ratings do not match the groove.
fn screw_and_nut(case: &Case) -> Result<ScrewAndNut, CaseError> {
    if case.lacks_groove() {
        return Ok((None, RatedScrew::without_groove(case)?, None));
    }
    let nut = rated_nut::nut(case)?;
    let thread = rated_nut::thread(case, &nut)?;
    if case.has_estimated_groove() {
        // Catalog lists and rules give more accurate values for the core diameter and the nut body
        // than an estimated groove.
        let pitch_circle_diameter_mm = case.pitch_circle_diameter_mm;
        let line = Case { pitch_circle_diameter_mm, ..case.without_estimates() };
        return Ok((Some((nut, thread)), RatedScrew::of(&line, balls_and_turns(case).1)?, None));
    }
    let body = rated_nut::body(case, &nut, &thread)?;
    let warning = rated_nut::compared(case, &nut)?;
    let size = RatedScrew { screw: nut.screw(&thread), body, assumed: Vec::new() };
    Ok((Some((nut, thread)), size, warning))
}

impl AxisModel {
    /// Calculates the axis of a case. The preload is not included, because it is determined by the
    /// nut.
    pub(crate) fn of(case: &Case) -> Result<Self, CaseError> {
        // The process force may be zero or act in the direction of the feed, so the rule that
        // `axial_load_N` must be positive is not checked.
        case.check_but(case.speeds_at_rest().union(AXIAL_LOAD))?;
        let driven = driven_part(case)?;
        let (groove, RatedScrew { screw: size, body, mut assumed }, warning) = screw_and_nut(case)?;
        let calculated = groove.as_ref().map(|(nut, _)| nut);
        // The ratings of an estimated groove contain no information beyond the catalog ratings from
        // which the groove was estimated.
        let known = calculated.filter(|_| !case.has_estimated_groove());
        let dynamic = || known.map(|nut| nut.dynamic_rating().rating);
        let rated = || known.map(|nut| nut.static_rating().rating);
        let ratings = [
            rated_dynamic_load(case)?.or_else(dynamic).unwrap_or(f64::NAN),
            case.rated_static_load_N.or_else(rated).unwrap_or(f64::NAN),
        ];
        let factors = rating_factors(case);
        let stroke = stroke(case)?;
        let shaft = mount(case).shaft(&size, body.length, stroke);
        // The default length depends on the lead. Without a lead, it is NaN.
        let shaft = shaft.filter(|shaft| !shaft.length.is_nan());
        let core = shaft.map_or(size.core, |shaft| shaft.diameter);
        check_bore(case, core, calculated.map_or(0.0, |nut| nut.ball_diameter))?;
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
        let screw = shaft.as_ref().map(|shaft| {
            let (bore, length) = (shaft.bore.diameter, shaft.length);
            let stated = case.screw_inertia_kg_m2_m.map(|inertia| inertia * length);
            (size.mass(bore, length), stated.unwrap_or(size.inertia(bore, length)))
        });
        let screw = screw.filter(|(mass, _)| !mass.is_nan());
        // The mass of the nut follows from its groove, even if the groove is estimated.
        let nut_mass = match (case.nut_mass_kg, &groove) {
            (Some(given), _) => Some(given),
            (None, Some((nut, thread))) => {
                Some(rated_nut::body(case, nut, thread)?.mass(nut, thread))
            }
            (None, None) => None,
        };
        let nut_inertia = (driven == DrivenPart::Nut).then(|| {
            case.nut_inertia_kg_m2.unwrap_or_else(|| {
                let tube = body.tube_inertia(size.pitch_diameter);
                let what = "of a steel tube from the pitch circle to nut_outer_diameter_mm (BB10)";
                assumed.push(format!(
                    "nut_inertia_kg_m2 = {} is estimated as the value {what}.",
                    format_trimmed(tube)
                ));
                tube
            })
        });
        let of_driven = nut_inertia.or(screw.map(|(_, inertia)| inertia)).unwrap_or(0.0);
        let drive = drive_train(case, size.lead, of_driven, &carriage)?;
        let cycle = motion.time.zip(motion.travel(size.lead));
        let is_finite =
            |(time, travel): (f64, CycleTravel)| time.is_finite() && travel.distance.is_finite();
        if !cycle.is_none_or(is_finite) {
            return Err(invalid_input(
                "cycle",
                "results in a travel that is too large; give shorter times",
            ));
        }
        let phases = phases(&motion.segments, &carriage, size.lead);
        let is_rated = groove.is_some() || ratings.iter().any(|rating| !rating.is_nan());
        if is_rated {
            check_loaded(case, &phases, &carriage)?;
        }
        let axis = Axis {
            screw: size,
            shaft,
            phases,
            dynamic_rating: factors.dynamic_rating * ratings[0],
            static_rating: factors.static_rating * ratings[1],
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
        self.nut_inertia.or(self.screw.map(|(_, inertia)| inertia)).is_some()
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

/// The input for the axial load, which may be positive, negative or zero for an axis.
pub(crate) const AXIAL_LOAD: InputSet = inputs! { axial_load_N };

/// Returns the loads that act on the axis in addition to the process force.
pub(crate) fn carriage(case: &Case) -> Result<MachineTable, CaseError> {
    let equal = case.number(InputKey::screws_count).recip();
    let share = case.load_share.unwrap_or(equal);
    // The comparison allows for load shares that are rounded to two or three digits.
    if share < 0.99 * equal {
        let what = format!(
            "is {share}, but the most heavily loaded screw carries at least 1 / screws_count = {}",
            format_trimmed(equal)
        );
        return Err(invalid_input("load_share", what));
    }
    Ok(MachineTable {
        mass: case.number(InputKey::moved_mass_kg),
        inclination: case.number(InputKey::inclination_deg) * DEG,
        friction: case.number(InputKey::guide_friction),
        resistance: case.number(InputKey::guide_force_N),
        counterweight: case.number(InputKey::counterweight_kg),
        counterbalance: case.number(InputKey::counterbalance_N),
        share,
    })
}

/// Returns the number of screws that each motor drives.
fn screws_per_motor(case: &Case) -> Result<f64, CaseError> {
    let [screws, driven] =
        [InputKey::screws_count, InputKey::screws_per_motor].map(|key| case.number(key));
    if driven > screws {
        let what = format!("is {driven}, but screws_count is {screws}");
        return Err(invalid_input("screws_per_motor", what));
    }
    Ok(driven)
}

/// Returns the stroke of a case \[m\], either given or taken from the range of its cycle.
///
/// # Errors
///
/// Returns [`CaseError`] if the cycle is invalid or exceeds the given stroke.
pub(crate) fn stroke(case: &Case) -> Result<Option<f64>, CaseError> {
    // Differences below a millionth of the stroke are rounding errors.
    const ROUNDING: f64 = 1e-6;
    let given = case.stroke_mm.map(|mm| mm * MM);
    if case.entries.cycle.is_none() {
        return Ok(given);
    }
    let cycle = Cycle::of(case)?;
    // If the cycle states all its speeds as feed rates, its travel does not depend on the lead.
    let is_known = case.lead().is_some() || cycle.has_only_feeds();
    let travel = is_known.then(|| cycle.travel(case.lead().map_or(1.0, |lead| lead * MM)));
    let range = travel.flatten().map(|travel| travel.range).filter(|range| *range > 0.0);
    if let (Some(stroke), Some(range)) = (given, range)
        && range > stroke * (1.0 + ROUNDING)
    {
        let what = format!(
            "is {}, but the cycle moves over {} mm (cycle_range_mm). Shorten the phases, \
             add the return moves, or, in a cycle without acceleration, replace time_s by share",
            format_trimmed(stroke / MM),
            format_trimmed(range / MM)
        );
        return Err(invalid_input("stroke_mm", what));
    }
    Ok(given.or(range))
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

/// Returns the part that the motor turns, which by default is the nut if only the nut turns, and
/// the screw otherwise.
///
/// # Errors
/// Returns [`CaseError`] if both parts turn, or if the part that turns is not the given driven
/// part.
pub(crate) fn driven_part(case: &Case) -> Result<DrivenPart, CaseError> {
    let turns = |speed: Option<f64>| speed.is_some_and(|speed| speed != 0.0);
    let (screw, nut) = (turns(case.screw_speed_rpm), turns(case.nut_speed_rpm));
    let given = case.entries.driven_part.map(|Named(part)| part);
    match (given, screw, nut) {
        (_, true, true) => {
            let what = "and screw_speed_rpm are both given, but an axis has one driven part. Give \
                        the relative speed and driven_part";
            Err(invalid_input("nut_speed_rpm", what))
        }
        (Some(DrivenPart::Screw), _, true) => {
            Err(invalid_input("nut_speed_rpm", "turns the nut, but driven_part is screw"))
        }
        (Some(DrivenPart::Nut), true, _) => {
            let what = "turns the screw, but driven_part is nut. Give nut_speed_rpm or feed_m_min";
            Err(invalid_input("screw_speed_rpm", what))
        }
        (Some(part), ..) => Ok(part),
        (None, _, true) => Ok(DrivenPart::Nut),
        (None, ..) => Ok(DrivenPart::Screw),
    }
}

/// Returns the nut set. If circuits are listed, the nut set follows from their nut bodies;
/// otherwise, it follows from the preload method.
pub(crate) fn nut_set(case: &Case) -> NutSet {
    let method = match &case.entries.circuits {
        Some(circuits) if circuits.iter().any(|circuit| circuit.body > 0) => {
            Some(PreloadMethod::DoubleNut)
        }
        Some(_) => case.entries.preload_by.map(|Named(method)| method),
        None => case.is_preloaded().then(|| preload_method(case)),
    };
    NutSet::of(method, case.nut_gap_mm.map(|mm| mm * MM))
}

/// Returns the length of the thread \[m\]. If the stroke is unknown, the result is the unsupported
/// length. Returns `None` if both inputs are unknown.
///
/// * `lead`, `nut_length`: lead and length of the nut \[m\].
pub(crate) fn thread_length(case: &Case, lead: f64, nut_length: f64) -> Option<f64> {
    let mount = mount(case);
    let thread = |mm: f64| mount.thread_length(lead, nut_length, mm * MM);
    case.stroke_mm.map(thread).or(mount.length)
}

/// Returns the end conditions and the length of the screw.
pub(crate) fn mount(case: &Case) -> Mount {
    Mount {
        support: case.entries.support.map_or(EndFixity::FixedSupported, |Named(support)| support),
        length: case.unsupported_length_mm.map(|mm| mm * MM),
        overrun: case.overrun_mm.map(|mm| mm * MM),
        diameter: case.shaft_diameter_mm.map(|mm| mm * MM),
        bore: Bore {
            diameter: case.screw_bore_mm.unwrap_or(0.0) * MM,
            filling_density: case.number(InputKey::coolant_density_kg_m3),
        },
        buckling_support: case.entries.buckling_support.map(|Named(support)| support),
        buckling_length: case.buckling_length_mm.map(|mm| mm * MM),
    }
}

/// Returns the manufacturer's dynamic load rating \[N\], converted to one million revolutions
/// (BB8).
///
/// # Errors
///
/// Returns [`CaseError`] if the rating basis is given without a rating, or if the basis is a travel
/// and the lead is missing.
pub(crate) fn rated_dynamic_load(case: &Case) -> Result<Option<f64>, CaseError> {
    let Some(Named(basis)) = case.entries.rating_basis else {
        return Ok(case.rated_dynamic_load_N);
    };
    let Some(stated) = case.rated_dynamic_load_N else {
        return Err(invalid_input(
            "rating_basis",
            "needs rated_dynamic_load_N, because it states the basis of this rating",
        ));
    };
    match case.lead() {
        Some(lead) => Ok(Some(basis.factor(lead * MM) * stated)),
        None if basis == RatingBasis::Revolutions => Ok(Some(stated)),
        None => {
            Err(invalid_input("rating_basis", "needs lead_mm to convert a travel to revolutions"))
        }
    }
}

/// Returns the required life, which a case may state as a time, a travel, or a number of
/// revolutions, cycles or strokes.
///
/// * `cycle`: duration of the cycle \[s\].
/// * `stroke`: stroke \[m\].
///
/// # Errors
///
/// Returns [`CaseError`] in three cases: the life is given in cycles, but the cycle has no
/// durations; the life is given in strokes, but the stroke is unknown; or the life is given in
/// years, but the hours or days of operation are missing.
pub(crate) fn required_life(
    case: &Case,
    cycle: Option<f64>,
    stroke: Option<f64>,
) -> Result<Option<RequiredLife>, CaseError> {
    const HOUR: f64 = 3600.0;
    if let Some(hours) = case.required_life_h {
        return Ok(Some(RequiredLife::Time(HOUR * hours)));
    }
    if let Some(revolutions) = case.required_life_revolutions {
        return Ok(Some(RequiredLife::Revolutions(revolutions)));
    }
    if let Some(km) = case.required_life_km {
        return Ok(Some(RequiredLife::Travel(1e3 * km)));
    }
    if let Some(cycles) = case.required_life_cycles {
        let time = cycle.ok_or_else(|| {
            invalid_input("required_life_cycles", "needs a cycle whose entries have times")
        })?;
        return Ok(Some(RequiredLife::Time(cycles * time)));
    }
    if let Some(strokes) = case.required_life_strokes {
        let stroke =
            stroke.ok_or_else(|| invalid_input("required_life_strokes", "needs stroke_mm"))?;
        return Ok(Some(RequiredLife::Travel(strokes * stroke)));
    }
    let Some(years) = case.required_life_years else { return Ok(None) };
    let hours = operating_hours_per_year(case).ok_or_else(|| {
        invalid_input("required_life_years", "needs operating_h_day and operating_days_year")
    })?;
    Ok(Some(RequiredLife::Time(HOUR * years * hours)))
}

/// Returns the operating hours per year, if they are given.
pub(crate) fn operating_hours_per_year(case: &Case) -> Option<f64> {
    Some(case.operating_h_day? * case.operating_days_year?)
}

/// Returns the torque-speed curve of the motor, if the case contains one.
///
/// * `fastest`: largest speed of the motor \[rad/s\].
///
/// # Errors
/// Returns [`CaseError`] if motor torques are given in addition to the curve, if the speeds of the
/// curve do not increase, or if the motor speed exceeds the last speed of the curve.
fn motor_curve(case: &Case, fastest: f64) -> Result<Option<MotorCurve>, CaseError> {
    const NAME: &str = "motor_curve";
    let Some(rows) = &case.entries.motor_curve else { return Ok(None) };
    for key in [InputKey::motor_peak_torque_Nm, InputKey::motor_rated_torque_Nm] {
        if case[key].is_some() {
            return Err(CaseError::given_twice([NAME, key.name()]));
        }
    }
    let is_positive = |row: &MotorCurveRow| {
        let all = [Some(row.speed_rpm), Some(row.peak_torque_Nm), row.continuous_torque_Nm];
        all.iter().flatten().all(|number| number.is_finite() && *number >= 0.0)
    };
    if !rows.iter().all(is_positive) {
        return Err(invalid_input(NAME, "contains a number that is negative or not finite"));
    }
    let points = rows.iter().map(|row| MotorPoint {
        speed: row.speed_rpm * RPM,
        peak: row.peak_torque_Nm,
        continuous: row.continuous_torque_Nm,
    });
    let curve = MotorCurve::new(points.collect())
        .ok_or_else(|| invalid_input(NAME, "needs rows in order of increasing speed_rpm"))?;
    if fastest > curve.fastest() * (1.0 + 1e-12) {
        let what = format!(
            "ends at {} rpm, but the motor turns at {} rpm",
            format_trimmed(curve.fastest() / RPM),
            format_trimmed(fastest / RPM)
        );
        return Err(invalid_input(NAME, what));
    }
    Ok(Some(curve))
}

/// Returns the factors that modify the load ratings. A manufacturer's rating is multiplied by the
/// accuracy factor only if the factor is given, because catalogs state ratings for the accuracy
/// grade of the product.
pub(crate) fn rating_factors(case: &Case) -> RatingFactors {
    let own = case.rated_dynamic_load_N.or(case.rated_static_load_N).is_none();
    let grade = case.entries.accuracy_grade.filter(|_| own);
    let by_grade = grade.map_or(1.0, |word| word.grade.rating_factor());
    let hardness = case.hardness_HRC.map(Hardness::Rockwell);
    let hardness = hardness.or(case.hardness_HV10.map(Hardness::Vickers));
    let steel = case.entries.steel.map_or(1.0, |Named(SteelFactor(factor))| factor);
    RatingFactors::of(hardness, case.accuracy_factor.unwrap_or(by_grade), steel)
}

/// Returns the largest permitted speed number of the ball return \[mm/min\].
///
/// * `lead`, `land`: lead and outer diameter of the screw \[m\].
pub(crate) fn speed_number_limit(case: &Case, lead: f64, land: f64) -> f64 {
    let by_make = || make(case).speed_number(lead, land) / (MM * RPM);
    case.speed_number_limit_mm_min.unwrap_or_else(by_make)
}

/// Returns the largest speed of the motor \[rpm\].
pub(crate) fn motor_speed(case: &Case) -> Option<f64> {
    case.motor_max_speed_rpm.or(case.motor_rated_speed_rpm)
}

/// Returns the preload method of the case. The default is oversize balls if `ball_oversize_um` is
/// given, and a double nut otherwise.
pub(crate) fn preload_method(case: &Case) -> PreloadMethod {
    let oversize = case.ball_oversize_um.is_some_and(|um| um != 0.0);
    let usual = if oversize { PreloadMethod::Oversize } else { PreloadMethod::DoubleNut };
    case.entries.preload_by.map_or(usual, |Named(method)| method)
}

/// Returns the preload of a case. If the preload class permits play instead of a preload, also
/// returns the axial play \[m\].
pub(crate) fn preload(case: &Case) -> Result<(Option<PreloadSize>, Option<f64>), CaseError> {
    let force = case.preload_N.map(PreloadSize::Force);
    let Some(word) = case.entries.preload_class else { return Ok((force, None)) };
    let others = [InputKey::preload_N, InputKey::preload_offset_um, InputKey::ball_oversize_um];
    if let Some(other) = others.into_iter().find(|key| case[*key].is_some()) {
        return Err(CaseError::given_twice(["preload_class", other.name()]));
    }
    Ok(match word.class() {
        PreloadClass::Preload(preload) => (Some(preload), None),
        PreloadClass::Play(play) => (None, play),
    })
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

/// Returns the manufacturing method of the screw.
pub(crate) fn make(case: &Case) -> Make {
    case.entries.screw_make.map_or(Make::Ground, |Named(make)| make)
}

/// Returns the ratio of the life at the given reliability to the life at a reliability of 90 %.
pub(crate) fn reliability(case: &Case) -> f64 {
    case.value_or_default(InputKey::reliability_percent).map_or(1.0, reliability_factor)
}
