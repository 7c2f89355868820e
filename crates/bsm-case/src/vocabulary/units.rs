//! Conversion factors from the units of inputs and outputs to SI units, and alternative units with
//! which the names of inputs may end.

use std::f64::consts::PI;

use bsm_kin::{Drive, Real};

/// Meters per millimeter.
pub const MM: f64 = 1e-3;
/// Meters per micrometer.
pub const UM: f64 = 1e-6;
/// Pascal seconds per millipascal second.
pub const MILLI: f64 = 1e-3;
/// Square meters per square millimeter.
pub const MM2: f64 = 1e-6;
/// Radians per degree.
pub const DEG: f64 = PI / 180.0;
/// Factor that converts revolutions per minute to radians per second.
pub const RPM: f64 = PI / 30.0;
/// Pascals per gigapascal.
pub const GPA: f64 = 1e9;
/// Pascals per megapascal.
pub const MPA: f64 = 1e6;

/// Converts the speeds of screw and nut from revolutions per minute to SI units, for one point or
/// for several points in SIMD lanes.
#[inline(always)]
pub fn drive_of_rpm<F: Real>(screw: F, nut: F) -> Drive<F> {
    Drive { screw_speed: screw * RPM, nut_speed: nut * RPM }
}

/// Returns the label of a quantity: the words of its name, a comma and the unit. For example,
/// `axial_load_N` becomes "axial load, N".
pub fn label(name: &str, unit: &str) -> String {
    let stem = &name[..name.len() - unit_suffix(name, unit).len()];
    let words = stem.replace('_', " ");
    if unit.is_empty() { words } else { format!("{words}, {unit}") }
}

/// Returns the part of a name that represents its unit, including the underscore. The result is
/// empty if the unit is empty.
pub(crate) fn unit_suffix<'a>(name: &'a str, unit: &str) -> &'a str {
    let unit = if unit == "%" { "percent" } else { unit };
    let by = unit.replace('/', "_");
    let with_exponent = unit.replacen('/', "_", 1).replace(['^', '.', '(', ')', '/', ' '], "");
    let apart = by.replace(['(', ')'], "").replace(' ', "_");
    let spellings = [by.replace(' ', ""), apart, unit.replace(['/', ' '], ""), with_exponent];
    let ends = |spelling: &String| Some(&name[stem(name, spelling)?.len()..]);
    spellings.iter().filter(|_| !unit.is_empty()).find_map(ends).unwrap_or_default()
}

/// Tolerance within which a direction near -180 deg is converted to 180 deg \[deg\]. Without the
/// tolerance, rounding errors would determine on which side of this discontinuity a solution lies.
const TURN_ROUNDING: f64 = 1e-9;

/// Converts an angle \[rad\] to a direction in (-180, 180\] deg.
#[inline(always)]
pub fn direction_deg<F: Real>(angle: F) -> F {
    let (degrees, half) = (angle / DEG, angle.constant(180.0));
    F::select((degrees + 180.0).below(TURN_ROUNDING), half, degrees)
}

/// Conversion from an alternative unit to the unit of the vocabulary: `factor * (value - zero)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UnitChange {
    /// Factor that converts a value from the alternative unit to the unit of the vocabulary.
    pub factor: f64,
    /// Value in the alternative unit that corresponds to zero in the unit of the vocabulary. It is
    /// 0 except for temperatures.
    pub zero: f64,
}

impl UnitChange {
    /// Conversion that leaves all values unchanged.
    pub const NONE: Self = Self { factor: 1.0, zero: 0.0 };

    /// Converts a value to the unit of the vocabulary.
    pub fn value(self, value: f64) -> f64 {
        self.factor * (value - self.zero)
    }

    /// Converts a difference or a standard deviation to the unit of the vocabulary, without the
    /// offset of a temperature scale.
    pub fn difference(self, difference: f64) -> f64 {
        self.factor * difference
    }

    /// Converts a value from the unit of the vocabulary to the alternative unit. Without an offset,
    /// the result keeps the sign of zero.
    pub fn back(self, value: f64) -> f64 {
        let scaled = value / self.factor;
        if self.zero == 0.0 { scaled } else { scaled + self.zero }
    }
}

/// A unit, with its suffix in names, its printed text and its size.
#[derive(Debug)]
struct Unit {
    /// Suffix of the unit in the names of quantities.
    suffix: &'static str,
    /// Text of the unit, as printed after a number.
    text: &'static str,
    /// Size of the unit in SI units.
    size: f64,
}

/// A physical quantity with its units of measurement.
struct Dimension {
    name: &'static str,
    /// Units that the vocabulary uses for this physical quantity.
    own: &'static [&'static str],
    units: &'static [Unit],
}

/// Units of each physical quantity. The name of a value determines its physical quantity, so `g`
/// can be a unit of mass or of acceleration.
const DIMENSIONS: &[Dimension] = {
    const INCH: f64 = 0.0254;
    const FOOT: f64 = 12.0 * INCH;
    const POUND: f64 = 0.453_592_37;
    const OUNCE: f64 = POUND / 16.0;
    const GRAVITY: f64 = 9.806_65;
    const POUND_FORCE: f64 = POUND * GRAVITY;
    const OUNCE_FORCE: f64 = OUNCE * GRAVITY;
    const GALLON: f64 = 231.0 * INCH * INCH * INCH;
    const PSI: f64 = POUND_FORCE / (INCH * INCH);
    const MINUTE: f64 = 60.0;
    const HOUR: f64 = 60.0 * MINUTE;
    const FAHRENHEIT: f64 = 5.0 / 9.0;
    /// British thermal unit of the International Table.
    const BTU: f64 = 1_055.055_852_62;
    const HORSEPOWER: f64 = 550.0 * POUND_FORCE * FOOT;
    macro_rules! dimensions {
        ($($name:literal of $($own:literal)+: $($suffix:literal $(as $text:literal)? $size:expr),+;)+) => {
            &[$(Dimension {
                name: $name,
                own: &[$($own),+],
                units: &[$(Unit { suffix: $suffix, text: dimensions!(@text $suffix $($text)?), size: $size }),+],
            }),+]
        };
        (@text $suffix:literal) => { $suffix };
        (@text $suffix:literal $text:literal) => { $text };
    }
    dimensions! {
        "length" of "mm" "um" "m" "km": "m" 1.0, "cm" 1e-2, "mm" MM, "um" UM, "nm" 1e-9, "km" 1e3, "in" INCH,
            "inch" as "in" INCH, "ft" FOOT, "million_in" as "million in" 1e6 * INCH, "mil" 1e-3 * INCH, "uin" 1e-6 * INCH,
            "mi" 5280.0 * FOOT, "yd" 3.0 * FOOT;
        "area" of "m2" "mm2": "m2" 1.0, "cm2" 1e-4, "mm2" MM2, "in2" INCH * INCH, "ft2" FOOT * FOOT;
        "volume flow" of "l_min": "l_min" as "l/min" 1e-3 / MINUTE, "l_s" as "l/s" 1e-3, "m3_h" as "m3/h" 1.0 / HOUR,
            "gal_min" as "gal/min" GALLON / MINUTE;
        "angle" of "deg" "urad": "rad" 1.0, "mrad" 1e-3, "urad" 1e-6, "deg" DEG, "arcmin" DEG / 60.0, "arcsec" DEG / 3600.0;
        "rotary speed" of "rpm" "rad_s": "rad_s" as "rad/s" 1.0, "rpm" RPM, "1_min" as "1/min" RPM, "1_s" as "1/s" 2.0 * PI,
            "rps" 2.0 * PI, "deg_s" as "deg/s" DEG;
        "velocity" of "m_s" "m_min" "mm_s": "m_s" as "m/s" 1.0, "mm_s" as "mm/s" MM, "m_min" as "m/min" 1.0 / MINUTE,
            "mm_min" as "mm/min" MM / MINUTE, "in_s" as "in/s" INCH, "inch_s" as "in/s" INCH,
            "in_min" as "in/min" INCH / MINUTE, "inch_min" as "in/min" INCH / MINUTE, "ipm" as "in/min" INCH / MINUTE,
            "ft_s" as "ft/s" FOOT, "ft_min" as "ft/min" FOOT / MINUTE;
        "speed number" of "mm_min": "mm_min" as "mm/min" MM / MINUTE, "in_min" as "in/min" INCH / MINUTE;
        "acceleration" of "m_s2": "m_s2" as "m/s2" 1.0, "mm_s2" as "mm/s2" MM, "cm_s2" as "cm/s2" 1e-2, "g" GRAVITY,
            "in_s2" as "in/s2" INCH, "ft_s2" as "ft/s2" FOOT;
        "force" of "N": "N" 1.0, "kN" 1e3, "MN" 1e6, "daN" 10.0, "kgf" GRAVITY, "tf" 1e3 * GRAVITY, "lbf" POUND_FORCE,
            "klbf" 1e3 * POUND_FORCE, "ozf" OUNCE_FORCE;
        "torque" of "Nm" "Nmm": "Nm" as "N m" 1.0, "Nmm" as "N mm" MM, "Ncm" as "N cm" 1e-2, "mNm" as "mN m" 1e-3,
            "kNm" as "kN m" 1e3, "kgf_cm" as "kgf cm" GRAVITY * 1e-2, "kgf_m" as "kgf m" GRAVITY,
            "lbf_in" as "lbf in" POUND_FORCE * INCH, "in_lbf" as "lbf in" POUND_FORCE * INCH,
            "lbf_ft" as "lbf ft" POUND_FORCE * FOOT, "ft_lbf" as "lbf ft" POUND_FORCE * FOOT,
            "ozf_in" as "ozf in" OUNCE_FORCE * INCH, "oz_in" as "ozf in" OUNCE_FORCE * INCH;
        "pressure" of "MPa" "GPa" "N_mm2": "Pa" 1.0, "MPa" MPA, "GPa" GPA, "N_mm2" as "N/mm2" MPA, "bar" 1e5, "psi" PSI,
            "ksi" 1e3 * PSI, "Mpsi" 1e6 * PSI, "kgf_mm2" as "kgf/mm2" GRAVITY / MM2;
        "mass" of "kg": "kg" 1.0, "g" 1e-3, "t" 1e3, "lb" POUND, "oz" OUNCE, "slug" POUND_FORCE / FOOT;
        "mass per length" of "kg_m": "kg_m" as "kg/m" 1.0, "g_mm" as "g/mm" 1.0, "lb_ft" as "lb/ft" POUND / FOOT,
            "lb_in" as "lb/in" POUND / INCH;
        "density" of "kg_m3": "kg_m3" as "kg/m3" 1.0, "g_cm3" as "g/cm3" 1e3,
            "lb_in3" as "lb/in3" POUND / (INCH * INCH * INCH);
        "inertia" of "kg_m2": "kg_m2" as "kg m2" 1.0, "kg_cm2" as "kg cm2" 1e-4, "kg_mm2" as "kg mm2" 1e-6,
            "g_cm2" as "g cm2" 1e-7, "lb_in2" as "lb in2" POUND * INCH * INCH, "lb_ft2" as "lb ft2" POUND * FOOT * FOOT,
            "lbf_in_s2" as "lbf in s2" POUND_FORCE * INCH, "ozf_in_s2" as "ozf in s2" OUNCE_FORCE * INCH,
            "ozf_in2" as "oz in2" OUNCE * INCH * INCH;
        "inertia per length" of "kg_m2_m": "kg_m2_m" as "kg m2/m" 1.0;
        "stiffness" of "N_um": "N_m" as "N/m" 1.0, "N_mm" as "N/mm" 1e3, "N_um" as "N/um" 1e6, "kN_mm" as "kN/mm" 1e6,
            "kgf_um" as "kgf/um" GRAVITY / UM, "kgf_mm" as "kgf/mm" GRAVITY / MM, "lbf_in" as "lbf/in" POUND_FORCE / INCH,
            "lbf_uin" as "lbf/uin" POUND_FORCE / (1e-6 * INCH);
        "power" of "W": "W" 1.0, "kW" 1e3, "hp" HORSEPOWER, "PS" 75.0 * GRAVITY;
        "energy" of "J": "J" 1.0, "kJ" 1e3, "Wh" HOUR;
        "time" of "s" "h": "s" 1.0, "ms" 1e-3, "min" MINUTE, "h" HOUR, "d" 24.0 * HOUR;
        "temperature" of "C": "C" 1.0, "degC" as "C" 1.0, "degF" FAHRENHEIT, "K" 1.0;
        "temperature difference" of "K": "K" 1.0, "degC" as "C" 1.0, "degF" FAHRENHEIT;
        "thermal conductance" of "W_K": "W_K" as "W/K" 1.0, "Btu_h_F" as "Btu/(h degF)" BTU / HOUR / FAHRENHEIT;
        "film coefficient" of "W_m2K": "W_m2K" as "W/(m2 K)" 1.0,
            "Btu_h_ft2_F" as "Btu/(h ft2 degF)" BTU / HOUR / (FOOT * FOOT * FAHRENHEIT);
        "thermal expansion" of "um_m_K": "um_m_K" as "um/(m K)" 1e-6, "1_K" as "1/K" 1.0,
            "uin_in_F" as "uin/(in degF)" 1e-6 / FAHRENHEIT;
        "viscosity" of "mm2_s": "m2_s" as "m2/s" 1.0, "mm2_s" as "mm2/s" 1e-6, "cSt" 1e-6;
    }
};

/// Values that correspond to 0 °C in temperature units with a different zero point.
const ZEROS: [(&str, &str, f64); 2] = [("temperature", "degF", 32.0), ("temperature", "K", 273.15)];

/// Returns the units of all physical quantities.
fn units() -> impl Iterator<Item = &'static Unit> {
    DIMENSIONS.iter().flat_map(|dimension| dimension.units)
}

/// Short forms of input names, without units.
const SHORT_NAMES: [(&str, &str); 2] = [("speed", "screw_speed"), ("load", "axial_load")];

/// Returns the long form of a short name, or `None` if the short name is unknown.
pub(crate) fn long_name(short: &str) -> Option<&'static str> {
    SHORT_NAMES.iter().find(|(known, _)| *known == short).map(|(_, long)| *long)
}

/// Returns true if the text is the suffix of a known unit.
pub(crate) fn is_unit(text: &str) -> bool {
    units().any(|unit| unit.suffix == text)
}

/// Returns the name in `known` that differs from `name` only in its unit, and the conversion to the
/// unit of the known name. For example, `axial_load_kN` gives `axial_load_N` and a factor of 1000.
pub(crate) fn convert<'a>(
    name: &str,
    known: impl IntoIterator<Item = &'a str>,
) -> Option<(&'a str, UnitChange)> {
    convert_with_text(name, known).map(|(other, change, _)| (other, change))
}

/// Works like [`convert`], and also returns the unit of `name` as text.
pub(crate) fn convert_with_text<'a>(
    name: &str,
    known: impl IntoIterator<Item = &'a str>,
) -> Option<(&'a str, UnitChange, &'static str)> {
    known.into_iter().find_map(|other| {
        let (stem, own, dimension) = own_unit(other)?;
        let unit = suffix(name, stem).or_else(|| {
            let (short, _) = SHORT_NAMES.iter().find(|(_, long)| *long == stem)?;
            suffix(name, short)
        })?;
        let [unit, own] = [dimension.unit(unit)?, dimension.unit(own)?];
        Some((other, dimension.change(unit, own), unit.text))
    })
}

/// Suffix of a unit of the vocabulary, suffix of another unit of the same quantity, and the
/// conversion from the other unit to the unit of the vocabulary.
pub(crate) type Counterpart = (&'static str, &'static str, UnitChange);

/// Returns the suffixes of two units of the same quantity, and the conversion from the second unit
/// to the first. The units are given as text; the first is a unit of the vocabulary.
pub(crate) fn counterpart(own: &str, other: &str) -> Option<Counterpart> {
    let of = |dimension: &'static Dimension, unit: Option<&'static Unit>| {
        // If several suffixes have the same text, the first one is the preferred suffix.
        let other = dimension.units.iter().find(|unit| unit.text == other)?;
        Some((unit?.suffix, other.suffix, dimension.change(other, unit?)))
    };
    let of_vocabulary = |dimension: &'static Dimension| {
        let mut units = dimension.own.iter().filter_map(|suffix| dimension.unit(suffix));
        of(dimension, units.find(|unit| unit.text == own))
    };
    let any = |dimension: &'static Dimension| {
        of(dimension, dimension.units.iter().find(|unit| unit.text == own))
    };
    // Units of the vocabulary are searched first, because several quantities can have a unit with
    // the same text, such as K.
    DIMENSIONS.iter().find_map(of_vocabulary).or_else(|| DIMENSIONS.iter().find_map(any))
}

impl Dimension {
    /// Returns the unit with the given suffix.
    fn unit(&self, suffix: &str) -> Option<&Unit> {
        self.units.iter().find(|unit| unit.suffix == suffix)
    }

    /// Returns the conversion from one unit of this quantity to another.
    fn change(&self, from: &Unit, to: &Unit) -> UnitChange {
        let zero = ZEROS.iter().find(|(name, unit, _)| *name == self.name && *unit == from.suffix);
        UnitChange {
            factor: digits(from.size / to.size),
            zero: zero.map_or(0.0, |(.., zero)| *zero),
        }
    }
}

/// Splits a name of the vocabulary into its stem and its unit, and also returns the physical
/// quantity. If several units match the end of the name, the longest one is used.
fn own_unit(name: &str) -> Option<(&str, &'static str, &'static Dimension)> {
    let units = DIMENSIONS
        .iter()
        .flat_map(|dimension| dimension.own.iter().map(move |own| (*own, dimension)));
    let ends = units.filter_map(|(own, dimension)| Some((stem(name, own)?, own, dimension)));
    ends.max_by_key(|(_, own, _)| own.len())
}

/// Returns the suffixes of alternative units for a name, each with the conversion to the unit of
/// the name. The list is empty if the unit has no alternatives.
pub fn other_units(name: &str) -> Vec<(&'static str, UnitChange)> {
    let Some((_, own, dimension)) = own_unit(name) else { return Vec::new() };
    let Some(own) = dimension.unit(own) else { return Vec::new() };
    let others = dimension.units.iter().filter(|unit| unit.suffix != own.suffix);
    others.map(|unit| (unit.suffix, dimension.change(unit, own))).collect()
}

/// Returns the suffixes of all units that the name `known` can have, beginning with its own unit.
/// Returns `None` if the stems of `name` and `known` differ.
pub(crate) fn units_of_stem(name: &str, known: &str) -> Option<Vec<&'static str>> {
    let (stem, own, _) = own_unit(known)?;
    suffix(name, stem)?;
    Some([own].into_iter().chain(other_units(known).into_iter().map(|(unit, _)| unit)).collect())
}

/// Returns each physical quantity with the suffixes of its units, beginning with the units of the
/// vocabulary.
pub fn units_by_quantity() -> impl Iterator<Item = (&'static str, Vec<&'static str>)> {
    DIMENSIONS.iter().map(|dimension| {
        let all = dimension.units.iter().map(|unit| unit.suffix);
        let others = all.filter(|unit| !dimension.own.contains(unit));
        (dimension.name, dimension.own.iter().copied().chain(others).collect())
    })
}

/// Returns the name without its unit suffix, or `None` if the name does not end with this suffix.
fn stem<'a>(name: &'a str, unit: &str) -> Option<&'a str> {
    name.strip_suffix(unit)?.strip_suffix('_')
}

/// Returns the part of a name that follows the stem and an underscore.
fn suffix<'a>(name: &'a str, stem: &str) -> Option<&'a str> {
    name.strip_prefix(stem)?.strip_prefix('_')
}

/// Rounds a conversion factor to 15 digits, unless the rounded factor differs by more than the
/// rounding error of a division.
fn digits(factor: f64) -> f64 {
    let rounded = format!("{factor:.14e}").parse().unwrap_or(factor);
    if (rounded - factor).abs() <= 2.0 * f64::EPSILON * factor { rounded } else { factor }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::INPUTS;

    fn known() -> impl Iterator<Item = &'static str> + Clone {
        INPUTS.iter().map(|input| input.name)
    }

    /// The expected values were calculated by hand. Factors are exact if the definitions of the
    /// units are exact.
    #[test]
    fn inputs_named_with_another_unit_are_converted_to_the_standard_unit() {
        for (name, own, factor) in [
            ("axial_load_kN", "axial_load_N", 1e3),
            ("axial_load_lbf", "axial_load_N", 4.448_221_615_260_5),
            ("load_kN", "axial_load_N", 1e3),
            ("lead_inch", "lead_mm", 25.4),
            ("lead_m", "lead_mm", 1e3),
            ("speed_1_min", "screw_speed_rpm", 1.0),
            ("screw_speed_rad_s", "screw_speed_rpm", 9.549_296_585_513_72),
            ("lead_angle_rad", "lead_angle_deg", 57.295_779_513_082_3),
            ("youngs_modulus_psi", "youngs_modulus_GPa", 6.894_757_293_168_36e-6),
            ("moment_x_lbf_in", "moment_x_Nm", 0.112_984_829_027_617),
            ("guide_x_N_mm", "guide_x_N_um", 1e-3),
            ("density_g_cm3", "density_kg_m3", 1e3),
            ("preload_offset_nm", "preload_offset_um", 1e-3),
        ] {
            let (found, change) = convert(name, known()).expect(name);
            // The conversion factors have fifteen digits.
            assert!(
                found == own && (change.factor / factor - 1.0).abs() < 1e-14,
                "{name}: {found} {change:?}"
            );
            assert!(change.zero == 0.0, "{name}");
        }
        for name in ["axial_load_mm", "axial_load", "lead", "lead_mm_mm", "speed", "kN", "_kN"] {
            assert_eq!(convert(name, known()), None, "{name}");
        }
    }

    /// Units of temperature have different zero points, but units of temperature rise do not.
    #[test]
    fn only_absolute_temperatures_are_converted_with_an_offset() {
        let value = |name: &str, value: f64| {
            let (own, change) = convert(name, known()).expect(name);
            assert!((change.back(change.value(value)) - value).abs() < 1e-12, "{name}");
            (own, change.value(value))
        };
        // The tolerance allows for one rounding error per value.
        for (name, given, own, expected) in [
            ("lubricant_temperature_degF", 68.0, "lubricant_temperature_C", 20.0),
            ("lubricant_temperature_K", 293.15, "lubricant_temperature_C", 20.0),
            ("pretension_degF", 9.0, "pretension_K", 5.0),
        ] {
            let (found, number) = value(name, given);
            assert!(found == own && (number - expected).abs() < 1e-13, "{name}: {number}");
        }
    }

    /// The expected values are published conversion factors.
    #[test]
    fn conversion_factors_match_published_values() {
        for (name, given, expected) in [
            ("motor_peak_torque_ozf_in", 100.0, 0.706_155_2),
            ("motor_rated_power_hp", 1.5, 1_118.550),
            ("rated_rigidity_kgf_um", 32.0, 313.812_8),
        ] {
            let (_, change) = convert(name, known()).expect(name);
            // The tolerance corresponds to the number of printed digits.
            assert!((change.value(given) / expected - 1.0).abs() < 1e-6, "{name}");
        }
    }

    /// An input name with any of its alternative units is parsed, and the conversion has the factor
    /// of this unit.
    #[test]
    fn input_names_with_every_alternative_unit_are_parsed() {
        let mut offered = 0;
        for input in INPUTS {
            for (unit, change) in other_units(input.name) {
                let (stem, ..) = own_unit(input.name).expect("a unit");
                let name = format!("{stem}_{unit}");
                assert_eq!(convert(&name, known()), Some((input.name, change)), "{name}");
                offered += 1;
            }
        }
        // The inputs have more than 300 names in alternative units. A smaller number would mean
        // that the test does not construct the names correctly.
        assert!(offered > 300, "{offered}");
    }

    /// The table contains the unit suffix of every input, except for units that only one quantity
    /// has.
    #[test]
    fn unit_table_contains_every_unit_of_the_inputs() {
        let own = ["N/um^1.5", "N m/mrad", "h/day", "%", "", "1/GPa", "W/(m K)", "HRC", "HV10"];
        for input in INPUTS.iter().filter(|input| !own.contains(&input.unit)) {
            assert!(own_unit(input.name).is_some(), "{}", input.name);
        }
    }

    /// Plot axes have labels with words and units instead of column names.
    #[test]
    fn labels_consist_of_words_and_a_unit() {
        for (name, unit, expected) in [
            ("axial_load_N", "N", "axial load, N"),
            ("efficiency", "", "efficiency"),
            ("nut_slip_velocity_m_s", "m/s", "nut slip velocity, m/s"),
            ("ball_torque_Nm", "N m", "ball torque, N m"),
            ("thermal_expansion_um_m_K", "um/(m K)", "thermal expansion, um/(m K)"),
            ("return_stiffness_N_um15", "N/um^1.5", "return stiffness, N/um^1.5"),
        ] {
            assert_eq!(label(name, unit), expected);
        }
        for input in INPUTS {
            let label = label(input.name, input.unit);
            let unit = input.unit.chars().next().filter(|first| first.is_alphanumeric());
            let twice =
                unit.is_some() && label.replace(' ', "_").starts_with(&format!("{},", input.name));
            assert!(!twice, "{label}");
        }
    }

    /// Each unit has a single positive conversion factor, so that the conversions in both
    /// directions are consistent.
    #[test]
    fn each_unit_has_exactly_one_positive_conversion_factor() {
        for dimension in DIMENSIONS {
            for (i, Unit { suffix, size, .. }) in dimension.units.iter().enumerate() {
                assert!(*size > 0.0);
                let same = dimension.units[..i].iter().any(|other| other.suffix == *suffix);
                assert!(!same, "{suffix}");
            }
        }
    }
}
