//! Design rules of an axis, each with its value, limit, source and remedy.

use std::borrow::Cow;

use bsm_design::Axis;
use bsm_design::life::{RatingBasis, RequiredLife, UNLOADING_RATIO};
use bsm_design::shaft::{EndFixity, Shaft};

use super::drive::MotorPeak;
use super::{Preload, QUANTITIES, SCREW};
use crate::answers::warm::QUANTITIES as WARM;
use crate::case::axis::AxisModel;
use crate::case::axis_inputs::{motor_speed, mount, preload_method, speed_number_limit};
use crate::vocabulary::entries::{Choice, Named};
use crate::vocabulary::number::{format_number, format_trimmed};
use crate::vocabulary::units::{MM, UM};
use crate::{
    Answer, Case, Criterion, DisplayUnit, INPUTS, InputKey as K, Numbers, OutputName, Quantity,
    output,
};

/// Title of the rule that requires a warm steady state to exist.
const STEADY_STATE: &str = "steady state";

/// Smallest permitted ratio of the speed at which thermal runaway occurs to the speed of the axis.
const FOLD: f64 = 1.25;

/// Quantities that the rules of an axis check.
struct RuleInputs<'a> {
    case: &'a Case,
    axis: &'a Axis,
    numbers: &'a Numbers,
    /// Axial load above which a contact ellipse reaches the edge of its flank \[N\].
    edge_load: Option<f64>,
    preload: Option<&'a Preload>,
    required_life: Option<RequiredLife>,
    /// Travel over which the accuracy grade limits the travel error \[m\].
    useful_travel: Option<f64>,
    /// Largest motor torque, and largest utilization of the torque-speed curve of the motor.
    motor_peaks: [Option<MotorPeak>; 2],
}

impl RuleInputs<'_> {
    /// Returns an output of the axis sheet, or `None` if it is not known.
    fn number(&self, name: OutputName) -> Option<f64> {
        self.numbers.number(name)
    }

    /// Returns the required life \[h\].
    fn required_life(&self) -> Option<f64> {
        let (lead, mean_speed) = (self.axis.screw.lead, self.axis.mean_speed());
        Some(self.required_life?.time(lead, mean_speed) / 3600.0)
    }

    /// Describes the dynamic load rating that would give the required life, stated in the rating
    /// basis of the manufacturer.
    fn needed_rating(&self, margin: f64) -> String {
        let needed = self.axis.dynamic_rating / margin.cbrt();
        let basis = self.case.entries.rating_basis.map(|Named(basis)| basis);
        match basis.filter(|basis| *basis != RatingBasis::Revolutions) {
            Some(basis) => format!(
                "a dynamic load rating of at least {} N for {}",
                at_least(needed / basis.factor(self.axis.screw.lead), 0),
                basis.name()
            ),
            None => format!("a dynamic load rating of at least {} N", at_least(needed, 0)),
        }
    }

    fn input(&self, key: K) -> Option<f64> {
        self.case.value_or_default(key)
    }

    fn length_mm(&self) -> f64 {
        self.number(output!(unsupported_length_mm)).unwrap_or(f64::NAN)
    }

    fn core_mm(&self) -> f64 {
        self.number(output!(shaft_diameter_mm)).unwrap_or(f64::NAN)
    }

    /// Returns an output that must exist if `condition` is not `None`. A missing output is returned
    /// as NaN, which violates the rule that uses the output.
    fn required_if(&self, name: OutputName, condition: Option<f64>) -> Option<f64> {
        condition.map(|_| self.number(name).unwrap_or(f64::NAN))
    }

    /// Returns an output for comparison with its limit. If the limit is given but the output cannot
    /// be calculated, NaN is returned, which violates the rule.
    fn number_or_nan_if_limited(&self, name: OutputName, limit: K) -> Option<f64> {
        self.number(name).or(self.case[limit].map(|_| f64::NAN))
    }

    /// Returns true if no axial load and no preload act on the nut. Life and safety factors are then
    /// unlimited.
    fn is_unloaded(&self) -> bool {
        is_unloaded(self.case, self.axis)
    }

    /// Works like [`number_or_nan_if_limited`](Self::number_or_nan_if_limited) for a safety factor,
    /// which is unlimited if no load acts.
    fn safety_or_nan_if_limited(&self, name: OutputName, limit: K) -> Option<f64> {
        self.number_or_nan_if_limited(name, limit)
            .filter(|safety| !(safety.is_nan() && self.is_unloaded()))
    }

    /// Returns the largest permitted utilization of the motor if its torque-speed curve is given,
    /// and `None` otherwise.
    fn utilization_limit(&self) -> Option<f64> {
        self.case.entries.motor_curve.as_ref().map(|_| 1.0)
    }

    /// Returns the largest permitted ratio of the RMS torque to the continuous torque if every row
    /// of the torque-speed curve states the continuous torque, and `None` otherwise.
    fn continuous_utilization_limit(&self) -> Option<f64> {
        let rows = self.case.entries.motor_curve.as_ref()?;
        rows.iter().all(|row| row.continuous_torque_Nm.is_some()).then_some(1.0)
    }

    /// Returns true if the screw moves at a known speed. Otherwise, life is not checked.
    fn moves(&self) -> bool {
        self.case.has_speed() && self.axis.fastest() > 0.0
    }

    /// Returns the source of the buckling rule. The text names the end conditions, states whether
    /// they are the default, and gives the safety factor for the end conditions in `support` if
    /// these are different.
    fn buckling_source(&self) -> String {
        let Some(shaft) = &self.axis.shaft else { return String::new() };
        let by_default =
            if self.case.entries.buckling_support.is_none() { " (default)" } else { "" };
        let conditions =
            format!("Euler (Z2), end conditions {}{by_default}", shaft.buckling.support.name());
        let of_support = self.number(output!(buckling_safety_of_support));
        match of_support.filter(|_| shaft.support != shaft.buckling.support) {
            Some(safety) => format!(
                "{conditions}. With the end conditions of the input support ({}), the safety factor is {}",
                shaft.support.name(),
                format_number(safety)
            ),
            None => conditions,
        }
    }

    /// Adapts the buckling rule to a load that may be unguided: the rule is then undecided unless
    /// it is also met with the end conditions in `support`.
    fn with_unguided_load(&self, mut rule: Criterion) -> Criterion {
        if rule.name == output!(buckling_safety).name()
            && mount(self.case).may_be_unguided()
            && let Some((of_support, limit)) =
                self.axis.buckling_safety_of_support().zip(rule.limit)
        {
            let margin = of_support / limit;
            rule.margin_without_default = Some(margin);
            if !rule.fails() {
                let remedy = format!(
                    "buckling_support fixed-fixed if a guided table clamps the nut; otherwise {}",
                    self.remedy_of_buckling(margin)
                );
                rule.remedy = (!rule.passes()).then_some(remedy);
            }
        }
        rule
    }

    /// Describes remedies for a buckling safety factor that is too small.
    ///
    /// * `margin`: ratio of the safety factor to the smallest permitted safety factor.
    fn remedy_of_buckling(&self, margin: f64) -> String {
        let is_compressed = self.number(output!(screw_tension_N)).is_some_and(|force| force < 0.0);
        let pretension = if is_compressed {
            ", or a pretension (pretension_K) against the compression due to constrained thermal expansion"
        } else {
            ""
        };
        format!(
            "{}a core diameter of at least {} mm{pretension}",
            self.shorter_screw(self.length_mm() * margin.sqrt()),
            at_least(self.core_mm() * margin.powf(-0.25), 1)
        )
    }

    /// Describes a shorter screw as a remedy, followed by "or". If the thread for the stroke does not
    /// fit into the required length, the text states the stroke that fits, or is empty if no
    /// stroke fits.
    ///
    /// * `length`: required length between the bearings \[mm\].
    fn shorter_screw(&self, length: f64) -> String {
        let thread = self.number(output!(thread_length_mm)).unwrap_or(0.0);
        if thread <= length {
            return format!("unsupported_length_mm of at most {}, or ", at_most(length, 0));
        }
        let stroke = self.case.stroke_mm.map(|stroke| stroke - (thread - length));
        let Some(stroke) = stroke.filter(|stroke| *stroke >= 1.0) else { return String::new() };
        let length = match self.case.unsupported_length_mm {
            Some(_) => format!(" with unsupported_length_mm of at most {}", at_most(length, 0)),
            None => String::new(),
        };
        format!("stroke_mm of at most {}{length}, or ", at_most(stroke, 0))
    }

    /// Describes remedies against whirling that do not change the length or the diameter of the
    /// screw: a stiffer support, unless both ends are already fixed, or a driven nut on a stationary
    /// screw.
    fn other_remedy_of_whirling(&self) -> &'static str {
        let is_fixed = |shaft: &Shaft| shaft.support == EndFixity::FixedFixed;
        if self.axis.shaft.as_ref().is_some_and(is_fixed) {
            "a driven nut (driven_part nut)"
        } else {
            "a stiffer support, or a driven nut (driven_part nut)"
        }
    }

    /// Returns the pretension, expressed as a temperature difference \[K\], at which the tension in
    /// the cold screw equals the compression in the warm screw. Returns `None` if the support
    /// bearings cannot carry the load at this pretension.
    fn balanced_pretension(&self) -> Option<f64> {
        let rise = self.number(output!(pretension_for_no_slack_K)).filter(|rise| *rise > 0.0)?;
        let warm = self.number(output!(screw_tension_N))?;
        let cold = self.number(output!(pretension_N)).unwrap_or(0.0);
        let load = 0.5 * (cold - warm) + self.axis.largest_load();
        (load <= self.case.support_bearing_axial_load_N?).then_some(0.5 * rise)
    }

    /// Describes remedies for a peak motor torque that is too large.
    ///
    /// * `margin`: ratio of the permitted torque to the actual torque.
    fn remedies_of_peak(&self, peak: Option<&MotorPeak>, margin: f64) -> String {
        let accelerates = self.axis.phases.iter().any(|phase| phase.acceleration != 0.0);
        remedies_of_motor(peak, margin, accelerates.then_some("less acceleration"))
    }

    /// Describes remedies for an RMS motor torque that is too large. For a cycle, no permitted load
    /// can be stated, because the RMS torque depends on all phases.
    ///
    /// * `margin`: ratio of the permitted torque to the actual torque.
    fn remedies_of_rms(&self, margin: f64) -> String {
        let has_cycle = self.case.entries.cycle.is_some();
        let peak = self.motor_peaks[0].as_ref().filter(|_| !has_cycle);
        remedies_of_motor(peak, margin, has_cycle.then_some("longer dwells"))
    }

    /// Returns the largest preload that is permitted for the preload method of the nut \[N\].
    fn most_preload(&self) -> f64 {
        preload_method(self.case).share() * self.axis.dynamic_rating
    }

    /// Returns the cold preload at which the warm preload equals the largest permitted preload
    /// \[N\].
    fn preload_to_set(&self) -> f64 {
        let set = |preload: &Preload| self.most_preload() * preload.cold / preload.warm;
        self.preload.map_or(f64::NAN, set)
    }

    /// Returns the coarsest accuracy grade that meets the required travel error.
    fn grade_to_take(&self) -> Option<&'static str> {
        let (word, travel) = (self.case.entries.accuracy_grade?, self.useful_travel?);
        let required = self.case.required_travel_error_um? * UM;
        word.grade.coarsest_within(required, travel).map(|grade| grade.name)
    }
}

/// Describes remedies for a motor torque that is too large.
///
/// * `other`: a further remedy that applies to this axis.
fn remedies_of_motor(peak: Option<&MotorPeak>, margin: f64, other: Option<&str>) -> String {
    let load = peak.and_then(|peak| {
        let most = at_most(peak.load_at(margin)?, 0);
        Some(format!(
            "an axial load of at most {most} N instead of {} N",
            format_trimmed(peak.load.abs())
        ))
    });
    let others = load.into_iter().chain(other.map(str::to_owned)).collect::<Vec<_>>();
    match &others[..] {
        [] => "a larger motor, or a smaller lead".to_owned(),
        others => format!("a larger motor, a smaller lead, or {}", others.join(", or ")),
    }
}

/// Formats `x` rounded down to the given number of decimals, so that a remedy based on an upper
/// limit is sufficient.
fn at_most(x: f64, digits: usize) -> String {
    let size = [1.0, 10.0, 100.0][digits];
    format!("{:.digits$}", (x * size * (1.0 + 1e-12)).floor() / size)
}

/// Formats `x` rounded up to the given number of decimals, so that a remedy based on a lower limit
/// is sufficient.
pub(super) fn at_least(x: f64, digits: usize) -> String {
    let size = [1.0, 10.0, 100.0][digits];
    format!("{:.digits$}", (x * size * (1.0 - 1e-12)).ceil() / size)
}

/// Limit of a rule. The number is `None` if the rule has a value but no limit, and NaN if the limit
/// depends on a missing input.
#[derive(Clone, Copy)]
enum Limit {
    /// The quantity must not be smaller than the number.
    AtLeast(Option<f64>),
    /// The quantity must not be larger than the number.
    AtMost(Option<f64>),
}

/// Creates a rule that limits a quantity. Returns `None` if the value of the quantity is missing, or
/// if the limit depends on a missing input.
///
/// * `remedy`: function that takes the margin of a violated rule and describes a remedy.
fn criterion(
    title: &'static str,
    Quantity { name, symbol, unit, .. }: Quantity,
    source: Cow<'static, str>,
    value: Option<f64>,
    limit: Limit,
    remedy: impl Fn(f64) -> String,
) -> Option<Criterion> {
    let (at_least, limit) = match limit {
        Limit::AtLeast(limit) => (true, limit),
        Limit::AtMost(limit) => (false, limit),
    };
    if limit.is_some_and(f64::is_nan) {
        return None;
    }
    let (value, remedy_of, remedy) = (value?, remedy, None);
    let mut rule = Criterion {
        title,
        name,
        symbol,
        unit: DisplayUnit::unchanged(unit),
        value,
        limit,
        at_least,
        source,
        remedy,
        band: None,
        margins: None,
        margin_without_default: None,
    };
    // No remedy is given for a quantity that cannot be calculated. A note states the reason.
    rule.remedy = rule.margin().filter(|m| !m.is_nan() && rule.fails()).map(remedy_of);
    Some(rule)
}

/// Declares rules in the form `"title" quantity at_most limit, "source", remedy;`. An optional `=
/// value,` after the quantity replaces the value from the axis sheet.
macro_rules! rules {
    ($(#[$doc:meta])* $rules:ident($of:ident, $margin:ident) $titles:ident: $(
        $title:literal $name:ident $(= $value:expr,)? $bound:ident $limit:expr, $source:expr, $remedy:expr;
    )*) => {
        /// Titles of the rules that are declared together.
        const $titles: &[&str] = &[$($title),*];

        $(#[$doc])*
        fn $rules($of: &RuleInputs<'_>) -> impl Iterator<Item = Criterion> {
            let all = [$(criterion(
                $title,
                rules!(@quantity $name),
                Cow::from($source),
                rules!(@value $of $name $($value)?),
                rules!(@$bound $limit),
                |$margin: f64| {
                    let _ = $margin;
                    $remedy.into()
                },
            )),*];
            all.into_iter().flatten()
        }
    };
    (@value $of:ident $name:ident) => { $of.number(output!($name)) };
    (@value $of:ident $name:ident $value:expr) => { $value };
    // A name that is in none of the tables does not compile.
    (@quantity $name:ident) => {
        const { Quantity::of_tables(&[QUANTITIES, SCREW, WARM, INPUTS], stringify!($name)) }
    };
    (@at_least $limit:expr) => { Limit::AtLeast($limit) };
    (@at_most $limit:expr) => { Limit::AtMost($limit) };
}

rules! {
    /// Rules about the screw between its bearings.
    screw_rules(of, margin) SCREW_RULE_TITLES:
    "critical speed" critical_speed_ratio
        // The ratio is infinite if constrained thermal expansion buckles the screw.
        = of.number_or_nan_if_limited(output!(critical_speed_ratio), K::required_critical_speed_ratio),
        at_most of.input(K::required_critical_speed_ratio),
        "manufacturers' catalogs: 0.8 of the critical speed (Z1)",
        format!(
            "{}a core diameter of at least {} mm, or {}",
            of.shorter_screw(of.length_mm() * margin.sqrt()),
            at_least(of.core_mm() / margin, 1),
            of.other_remedy_of_whirling()
        );
    "speed number" largest_speed_number_mm_min
        = of.number_or_nan_if_limited(output!(largest_speed_number_mm_min), K::speed_number_limit_mm_min),
        at_most Some(speed_number_limit(of.case, of.axis.screw.lead, of.axis.screw.outer)),
        "DN limit, THK A-697 (Z15)",
        format!(
            "lead_mm of at least {} at the same feed, or a ball return that permits a higher speed (speed_number_limit_mm_min)",
            at_least(of.axis.screw.lead / MM / margin, 1)
        );
    "buckling" buckling_safety
        = of.safety_or_nan_if_limited(output!(buckling_safety), K::required_buckling_safety),
        at_least of.input(K::required_buckling_safety),
        of.buckling_source(),
        of.remedy_of_buckling(margin);
    "core stress" largest_load_N = Some(of.axis.largest_load()).filter(|load| *load > 0.0),
        at_most of.number(output!(yield_load_N)).or(Some(f64::NAN)),
        "THK and others: 147 N/mm2 (Z3)",
        format!("a core diameter of at least {} mm", at_least(of.core_mm() * margin.powf(-0.5), 1));
    "remaining pretension" pretension_N
        at_least {
            let hindered = of.number(output!(pretension_N)).zip(of.number(output!(screw_tension_N)));
            hindered.map(|(cold, warm)| cold - warm).filter(|force| *force > 0.0)
        },
        "force due to constrained thermal expansion; GY Ballscrew, THK A-715 (AA5)",
        {
            let slack = of.number(output!(pretension_K)).unwrap_or(f64::NAN);
            let needed = at_least(slack / margin, 0);
            format!("pretension_K {needed}, because the screw loses its pretension above a temperature rise of {slack:.1} K")
        };
    "support bearings" support_bearing_load_N
        = of.required_if(output!(support_bearing_load_N), of.case.support_bearing_axial_load_N),
        at_most of.case.support_bearing_axial_load_N,
        "load rating from the bearing manufacturer, for the cold and the warm screw (BB7)",
        match (of.balanced_pretension(), of.number(output!(screw_tension_N))) {
            (Some(kelvin), _) => format!(
                "larger bearings, a floating bearing, or pretension_K {}, with which cold tension and \
                 warm compression are equal",
                at_most(kelvin, 1)
            ),
            (None, Some(warm)) if warm < 0.0 => {
                "larger bearings, or a floating bearing, so that the screw can expand".to_owned()
            }
            _ => "larger bearings, or less pretension".to_owned(),
        };
}

rules! {
    /// Rules about accuracy grade, load ratings, motor and brake.
    rating_and_drive_rules(of, margin) RATING_AND_DRIVE_RULE_TITLES:
    "travel error" travel_error_worst_um
        = of.required_if(output!(travel_error_worst_um), of.case.required_travel_error_um),
        at_most of.case.required_travel_error_um,
        "ISO 3408-3, JIS B 1192: deviation and half of the variation over the useful travel (Z35)",
        of.grade_to_take().map_or_else(
            || "an accuracy_grade and a useful_travel_mm for which the standard has a value".to_owned(),
            |grade| format!("accuracy_grade {grade}"),
        );
    "static safety" static_safety_factor
        = of.safety_or_nan_if_limited(output!(static_safety_factor), K::required_static_safety),
        at_least of.input(K::required_static_safety),
        "ISO 3408-5 (Z16), with the preload (D14); smaller of C_0a/F and the value for the most loaded ball. THK requires 1 to 1.5, or 2 to 7 with impact",
        format!("a static load rating of at least {} N", at_least(of.axis.static_rating / margin, 0));
    "life" cycle_life_h
        = of.required_if(output!(cycle_life_h), of.required_life().filter(|_| of.moves() && !of.is_unloaded())),
        at_least of.required_life(),
        "ISO 3408-5 (D12) to (D15), reliability (Z14)",
        of.needed_rating(margin);
    "modified life" modified_life_h
        = of.required_if(output!(modified_life_h), of.number(output!(fatigue_load_limit_N)).filter(|_| of.moves() && !of.is_unloaded())),
        at_least of.required_life(),
        "ISO 281 with viscosity ratio and contamination (Z37) to (Z40)",
        "a higher viscosity, a cleaner lubricant or a larger dynamic load rating";
    "life from the loads of all balls" cycle_life_by_balls_h at_least of.required_life(),
        "loads of all balls (U24)",
        of.needed_rating(margin);
    "equivalent load" equivalent_load_N at_most Some(of.axis.dynamic_rating),
        "dynamic load rating for a million revolutions (D13)",
        format!("a dynamic load rating of at least {} N", at_least(of.axis.dynamic_rating / margin, 0));
    // The rule for the motor speed is omitted if no speed limit of the motor is given.
    "motor speed" motor_speed_rpm = of.required_if(output!(motor_speed_rpm), motor_speed(of.case)),
        at_most motor_speed(of.case),
        "THK A-719",
        format!(
            "lead_mm of at least {} at the same feed",
            at_least(of.case.lead_mm.unwrap_or(f64::NAN) / margin, 1)
        );
    "peak torque of the motor" peak_motor_torque_Nm
        = of.required_if(output!(peak_motor_torque_Nm), of.case.motor_peak_torque_Nm),
        at_most of.case.motor_peak_torque_Nm,
        "THK A-720",
        of.remedies_of_peak(of.motor_peaks[0].as_ref(), margin);
    "rated torque of the motor" rms_motor_torque_Nm
        = of.required_if(output!(rms_motor_torque_Nm), of.case.motor_rated_torque_Nm),
        at_most of.case.motor_rated_torque_Nm,
        "THK, eq. 48: RMS over the cycle (BB3)",
        of.remedies_of_rms(margin);
    "peak torque on the torque-speed curve of the motor" peak_torque_utilization
        = of.required_if(output!(peak_torque_utilization), of.utilization_limit()),
        at_most of.utilization_limit(),
        "motor_curve: torque at both ends of each phase / peak torque at the same speed",
        of.remedies_of_peak(of.motor_peaks[1].as_ref(), margin);
    "continuous torque on the torque-speed curve of the motor" rms_torque_utilization
        = of.required_if(output!(rms_torque_utilization), of.continuous_utilization_limit()),
        at_most of.continuous_utilization_limit(),
        "motor_curve: RMS torque over the cycle / continuous torque at the mean speed",
        of.remedies_of_rms(margin);
    "power of the motor" peak_motor_power_W
        = of.required_if(output!(peak_motor_power_W), of.case.motor_rated_power_W),
        at_most of.case.motor_rated_power_W,
        "largest motor power in any phase",
        format!("{} times the feed, or a larger motor", at_most(margin, 2));
    "inertia ratio" inertia_ratio at_most of.input(K::largest_inertia_ratio),
        "THK, eq. 49: 3 to 10",
        format!("{} times the gear_ratio, or a larger motor", at_least(margin.powf(-0.5), 2));
    "acceleration time" least_acceleration_time_s
        = of.number(output!(shortest_ramp_s)).and(of.number(output!(least_acceleration_time_s))),
        at_most of.number(output!(shortest_ramp_s)),
        "THK A-720 (AA11)",
        "a motor with a larger peak torque, or less acceleration";
    "brake" brake_torque_Nm
        = of.number(output!(required_brake_torque_Nm)).filter(|torque| *torque > 0.0).and(of.case.brake_torque_Nm),
        at_least of.number(output!(required_brake_torque_Nm)),
        "brake_safety times the torque of the load at rest without friction (BB5)",
        format!(
            "brake_torque_Nm of at least {}",
            at_least(of.number(output!(required_brake_torque_Nm)).unwrap_or(f64::NAN), 2)
        );
}

rules! {
    /// Rules about contacts and preload. Preload rules apply only to preloaded nuts.
    preload_rules(of, margin) PRELOAD_RULE_TITLES:
    "edge load of the contact ellipse" edge_load_N = of.edge_load,
        at_least of.edge_load.map(|_| of.axis.larger_nut_load()),
        "load at which a contact ellipse reaches the end of its flank (G8)",
        "a larger land (a smaller nut_bore_mm or a larger screw_outer_diameter_mm), or more or larger balls";
    "preload" warm_preload_N = of.preload.map(|preload| preload.warm),
        at_most Some(of.most_preload()),
        "THK A-687, HIWIN 3.6: 0.1 of the dynamic load rating in a double nut, else 0.05 (AA6)",
        format!(
            "a dynamic load rating of at least {} N, or preload_N of at most {}, with which one nut unloads above {:.0} N",
            at_least(of.preload.map_or(f64::NAN, |p| p.warm) / preload_method(of.case).share(), 0),
            at_most(of.preload_to_set(), 0),
            UNLOADING_RATIO * of.most_preload()
        );
    "remaining preload" largest_load_N = of.preload.map(|_| of.axis.largest_load()),
        at_most of.preload.map(|preload| of.number(output!(limit_load_N)).unwrap_or(UNLOADING_RATIO * preload.warm)),
        "limit load, about 2.83 times the preload (D14), (U20)",
        format!("preload_N of at least {}", at_least(of.preload.map_or(f64::NAN, |p| p.cold) / margin, 0));
}

/// Note on a screw that carries no load.
pub(crate) const NO_LOAD: &str = "No axial load acts on the screw, so life, static safety and buckling safety are unlimited and are not checked. If guide friction or \
     acceleration loads the axis, give guide_friction or guide_force_N, or a cycle with accelerated moves.";

/// Returns true if no axial load and no preload act on the nut. If the case states neither a load
/// nor a mass, the load is not known, and the result is false.
pub(super) fn is_unloaded(case: &Case, axis: &Axis) -> bool {
    let is_known =
        case.axial_load_N.is_some() || case.moved_mass_kg.is_some() || case.entries.cycle.is_some();
    is_known && axis.larger_nut_load() <= 0.0
}

/// Returns the titles of all rules, in the order of the axis sheet.
pub(crate) fn rule_titles() -> impl Iterator<Item = &'static str> + Clone {
    let parts = [SCREW_RULE_TITLES, RATING_AND_DRIVE_RULE_TITLES, PRELOAD_RULE_TITLES];
    parts.into_iter().flatten().copied().chain([STEADY_STATE])
}

/// Returns the rules of an axis that can be checked.
///
/// * `fold`: ratio of the highest screw speed with a thermal steady state (the fold) to the given
///   speed.
/// * `preload`: cold and warm preload \[N\].
/// * `motor_peaks`: peaks of the motor torque and of the utilization of the torque-speed curve.
pub(super) fn rules(
    case: &Case,
    machine: &AxisModel,
    (numbers, fold): (&Numbers, Option<f64>),
    of_nut: &Answer,
    preload: Option<&Preload>,
    motor_peaks: [Option<MotorPeak>; 2],
) -> Vec<Criterion> {
    let of = &RuleInputs {
        case,
        axis: &machine.axis,
        numbers,
        edge_load: of_nut.number(output!(edge_load_N)),
        preload,
        required_life: machine.required_life,
        useful_travel: machine.useful_travel(case),
        motor_peaks,
    };
    let rest = rating_and_drive_rules(of).chain(preload_rules(of));
    screw_rules(of)
        .map(|rule| of.with_unguided_load(rule))
        .chain(steady_state(fold))
        .chain(rest)
        .collect()
}

/// Returns the rule that requires a warm steady state to exist.
pub(super) fn steady_state(fold: Option<f64>) -> Option<Criterion> {
    let source = "no warm state exists above the fold (I20); the calculated friction heat is accurate to about 25 %";
    let limit = Limit::AtLeast(Some(FOLD));
    criterion(STEADY_STATE, rules!(@quantity fold_speed_factor), source.into(), fold, limit, |_| {
        "a colder screw, a warmer nut, less preload, or O arrangement instead of X".to_owned()
    })
}
