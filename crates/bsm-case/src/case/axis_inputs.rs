//! Inputs of an axis in SI units, with their defaults and checks.

use bsm_design::drive::{MachineTable, MotorCurve, MotorPoint};
use bsm_design::life::{Hardness, RatingBasis, RatingFactors, RequiredLife, reliability_factor};
use bsm_design::shaft::{Bore, EndFixity};
use bsm_design::{Make, Mount, NutSet, PreloadClass, PreloadMethod, PreloadSize};
use bsm_dyn::DrivenPart;

use crate::case::cycle::Cycle;
use crate::vocabulary::entries::{MotorCurveRow, Named, SteelFactor};
use crate::vocabulary::error::invalid_input;
use crate::vocabulary::input_set::inputs;
use crate::vocabulary::number::format_trimmed;
use crate::vocabulary::units::{DEG, MM, RPM};
use crate::{Case, CaseError, InputKey, InputSet};

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
pub(crate) fn screws_per_motor(case: &Case) -> Result<f64, CaseError> {
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
pub(crate) fn motor_curve(case: &Case, fastest: f64) -> Result<Option<MotorCurve>, CaseError> {
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

/// Returns the manufacturing method of the screw.
pub(crate) fn make(case: &Case) -> Make {
    given_make(case).unwrap_or(Make::Ground)
}

/// Returns the manufacturing method of the screw, or `None` if the case does not state it.
pub(crate) fn given_make(case: &Case) -> Option<Make> {
    case.entries.screw_make.map(|Named(make)| make)
}

/// Returns the ratio of the life at the given reliability to the life at a reliability of 90 %.
pub(crate) fn reliability(case: &Case) -> f64 {
    case.value_or_default(InputKey::reliability_percent).map_or(1.0, reliability_factor)
}
