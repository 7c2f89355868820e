//! Factors from the units of inputs and outputs to SI units, and alternative units that a name may
//! have.

use std::f64::consts::PI;

use bsm_kin::{Drive, Field};
use bsm_simd::Compare;

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
/// Radians per second per revolution per minute.
pub const RPM: f64 = PI / 30.0;
/// Pascals per gigapascal.
pub const GPA: f64 = 1e9;
/// Pascals per megapascal.
pub const MPA: f64 = 1e6;

/// Converts the speeds of screw and nut from revolutions per minute, for one point or several
/// points side by side.
#[inline(always)]
pub fn drive_of_rpm<F: Field>(screw: F, nut: F) -> Drive<F> {
    Drive { screw_speed: screw * RPM, nut_speed: nut * RPM }
}

/// Returns the label for a name, followed by a comma and the unit: `axial_load_N` becomes "axial
/// load, N".
pub fn label(name: &str, unit: &str) -> String {
    let written = unit
        .replace("(m K)", "m_K")
        .replace("(m2 K)", "m2K")
        .replace([' ', '^', '.'], "")
        .replace('/', "_");
    let ends = |unit: &str| if unit.is_empty() { None } else { stem(name, unit) };
    let stem = ends(&written).or_else(|| ends(&unit.replace([' ', '/'], "_")));
    let words = stem.unwrap_or(name).replace('_', " ");
    if unit.is_empty() { words } else { format!("{words}, {unit}") }
}

/// Tolerance within which a direction near -180 deg becomes 180 deg \[deg\]. Rounding determines on
/// which side of this discontinuity a solve ends.
const TURN_ROUNDING: f64 = 1e-9;

/// Converts an angle \[rad\] to a direction in (-180, 180\] deg.
#[inline(always)]
pub fn direction_deg<F: Compare>(angle: F) -> F {
    let (degrees, half) = (angle / DEG, angle.constant(180.0));
    F::select((degrees + 180.0).lt(angle.constant(TURN_ROUNDING)), half, degrees)
}

/// Suffix of a unit in names, and its size in SI units.
type Unit = (&'static str, f64);

/// Units, grouped by dimension.
const UNITS: &[&[Unit]] = {
    const INCH: f64 = 0.0254;
    const POUND: f64 = 0.453_592_37;
    const GRAVITY: f64 = 9.806_65;
    const POUND_FORCE: f64 = POUND * GRAVITY;
    const MINUTE: f64 = 60.0;
    macro_rules! units {
        ($($dimension:ident: $($unit:literal $size:expr),+;)+) => {
            &[$(&[$(($unit, $size)),+]),+]
        };
    }
    units! {
        length: "m" 1.0, "cm" 1e-2, "mm" MM, "um" UM, "nm" 1e-9, "inch" INCH, "in" INCH, "ft" 12.0 * INCH;
        angle: "rad" 1.0, "mrad" 1e-3, "urad" 1e-6, "deg" DEG, "arcmin" DEG / 60.0, "arcsec" DEG / 3600.0;
        speed: "rad_s" 1.0, "rpm" RPM, "1_min" RPM, "1_s" 2.0 * PI, "deg_s" DEG;
        velocity: "m_s" 1.0, "mm_s" MM, "m_min" 1.0 / MINUTE, "mm_min" MM / MINUTE, "inch_s" INCH, "in_s" INCH,
            "inch_min" INCH / MINUTE, "in_min" INCH / MINUTE;
        acceleration: "m_s2" 1.0, "mm_s2" MM, "g" GRAVITY;
        force: "N" 1.0, "kN" 1e3, "MN" 1e6, "daN" 10.0, "kgf" GRAVITY, "lbf" POUND_FORCE;
        torque: "Nm" 1.0, "Nmm" MM, "Ncm" 1e-2, "kNm" 1e3, "lbf_in" POUND_FORCE * INCH,
            "lbf_ft" POUND_FORCE * 12.0 * INCH;
        pressure: "Pa" 1.0, "MPa" MPA, "GPa" GPA, "N_mm2" MPA, "bar" 1e5, "psi" POUND_FORCE / (INCH * INCH),
            "ksi" 1e3 * POUND_FORCE / (INCH * INCH);
        mass: "kg" 1.0, "g" 1e-3, "t" 1e3, "lb" POUND;
        density: "kg_m3" 1.0, "g_cm3" 1e3, "lb_in3" POUND / (INCH * INCH * INCH);
        inertia: "kg_m2" 1.0, "kg_cm2" 1e-4, "kg_mm2" 1e-6, "g_cm2" 1e-7, "lb_in2" POUND * INCH * INCH;
        linear_inertia: "kg_m2_m" 1.0;
        stiffness: "N_m" 1.0, "N_mm" 1e3, "N_um" 1e6, "kN_mm" 1e6, "lbf_in" POUND_FORCE / INCH;
        time: "s" 1.0, "min" MINUTE, "h" 60.0 * MINUTE;
        rise: "K" 1.0;
        expansion: "um_m_K" 1e-6, "1_K" 1.0;
        viscosity: "m2_s" 1.0, "mm2_s" 1e-6, "cSt" 1e-6;
    }
};

/// Returns all units with their size and the units of the same dimension.
fn units() -> impl Iterator<Item = (&'static str, f64, &'static [Unit])> {
    UNITS.iter().flat_map(|alike| alike.iter().map(|(unit, size)| (*unit, *size, *alike)))
}

/// Short names without units that stand for names of inputs.
const SHORT_NAMES: [(&str, &str); 2] = [("speed", "screw_speed"), ("load", "axial_load")];

/// Returns the long form of a short name.
pub(crate) fn long_name(short: &str) -> Option<&'static str> {
    SHORT_NAMES.iter().find(|(known, _)| *known == short).map(|(_, long)| *long)
}

/// Returns true if the text is the suffix of a unit.
pub(crate) fn is_unit(text: &str) -> bool {
    units().any(|(unit, ..)| unit == text)
}

/// Returns the name among `known` that differs from `name` in its unit only, and the factor by
/// which a value must be multiplied. For example, `axial_load_kN` gives `axial_load_N` and 1000.
pub(crate) fn convert<'a>(
    name: &str,
    known: &(impl Iterator<Item = &'a str> + Clone),
) -> Option<(&'a str, f64)> {
    units().find_map(|(unit, size, alike)| {
        let stem = stem(name, unit)?;
        let stem = long_name(stem).unwrap_or(stem);
        let same = |other: &'a str| {
            // The suffix must be the complete unit, because N_um also ends with um.
            let own = own_unit(other)?.0;
            let unit = other.strip_prefix(stem)?.strip_prefix('_')?;
            let (_, own) =
                alike.iter().find(|(known, _)| *known == unit && known.len() == own.len())?;
            Some((other, digits(size / own)))
        };
        known.clone().find_map(same)
    })
}

/// Returns the longest unit suffix of a name.
fn own_unit(name: &str) -> Option<(&'static str, f64, &'static [Unit])> {
    units().filter(|(unit, ..)| stem(name, unit).is_some()).max_by_key(|(unit, ..)| unit.len())
}

/// Returns the alternative unit suffixes of a name, with the factor to the unit of the name. The
/// list is empty for a unit without alternatives.
pub fn other_units(name: &str) -> Vec<(&'static str, f64)> {
    let Some((own, size, alike)) = own_unit(name) else { return Vec::new() };
    let others = alike.iter().filter(|(unit, _)| *unit != own);
    others.map(|(unit, other)| (*unit, digits(other / size))).collect()
}

/// Returns a name without its unit suffix, if it has this suffix.
fn stem<'a>(name: &'a str, unit: &str) -> Option<&'a str> {
    name.strip_suffix(unit)?.strip_suffix('_')
}

/// Rounds a factor to 15 digits, which removes the rounding error of the division.
fn digits(factor: f64) -> f64 {
    format!("{factor:.14e}").parse().unwrap_or(factor)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::INPUTS;

    fn known() -> impl Iterator<Item = &'static str> + Clone {
        INPUTS.iter().map(|input| input.name)
    }

    /// Expected values are calculated by hand. Factors are exact if the units are.
    #[test]
    fn names_in_other_units_are_converted() {
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
            let (found, by) = convert(name, &known()).expect(name);
            // Factors have fifteen digits.
            assert!(found == own && (by / factor - 1.0).abs() < 1e-14, "{name}: {found} {by}");
        }
        for name in ["axial_load_mm", "axial_load", "lead", "lead_mm_mm", "speed", "kN", "_kN"] {
            assert_eq!(convert(name, &known()), None, "{name}");
        }
    }

    /// Every offered unit can be read, with the same factor.
    #[test]
    fn other_units_are_read_back() {
        let mut offered = 0;
        for input in INPUTS {
            for (unit, factor) in other_units(input.name) {
                let (own, ..) = own_unit(input.name).expect("a unit");
                let name = format!("{}_{unit}", stem(input.name, own).expect("its unit"));
                if let Some((found, by)) = convert(&name, &known()) {
                    assert!(
                        found == input.name && by.to_bits() == factor.to_bits(),
                        "{name}: {found} {by} {factor}"
                    );
                    offered += 1;
                }
            }
        }
        // A smaller number would mean that this test builds wrong names.
        assert!(offered > 300, "{offered}");
    }

    /// Every unit suffix of an input is in the table, except for units that only one quantity has.
    #[test]
    fn the_table_contains_the_units_of_all_inputs() {
        // Degrees Celsius cannot be converted by a factor alone.
        let own = [
            "N/um^1.5", "um/(m K)", "N m/mrad", "%", "", "C", "mm2/s", "1/GPa", "W/K", "W/(m2 K)",
            "W/(m K)", "W", "m2", "l/min", "HRC", "HV10",
        ];
        for input in INPUTS.iter().filter(|input| !own.contains(&input.unit)) {
            assert!(own_unit(input.name).is_some(), "{}", input.name);
        }
    }

    /// Labels of plot axes are texts with units, not column names.
    #[test]
    fn labels_are_texts_with_units() {
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
            assert!(!twice || input.unit == "%", "{label}");
        }
    }

    /// Each unit has one positive size, so conversions in both directions are consistent.
    #[test]
    fn each_unit_has_one_size() {
        for alike in UNITS {
            for (i, (unit, size)) in alike.iter().enumerate() {
                assert!(*size > 0.0);
                assert!(!alike[..i].iter().any(|(other, _)| other == unit), "{unit}");
            }
        }
    }
}
