//! The axis: worked examples and factors of makers' catalogues, as far as their text is public.

use std::f64::consts::TAU;

use bsm_case::units::{MM, RPM};
use bsm_design::{
    BUCKLING_SAFETY, CRITICAL_SPEED_RATIO, Carriage, Duty, OPENS_AT, PERMITTED_STRESS, Shaft,
    Support, life,
};

use crate::Check;

/// Young's modulus of the catalogues \[Pa\].
const STEEL: f64 = 206e9;

/// Metres in an inch.
const INCH: f64 = 25.4e-3;

const HOUR: f64 = 3600.0;

fn shaft(support: Support, length: f64, diameter: f64) -> Shaft {
    Shaft { support, length, diameter, youngs_modulus: STEEL }
}

/// All checks of these sources.
pub(crate) fn checks() -> Vec<Check> {
    let mut checks = vec![buckling_example(), yield_factor(), speed_example(), rating_example()];
    checks.extend(buckling_factors());
    checks.extend(frequencies());
    checks.extend(guides());
    checks.push(opening());
    checks
}

/// A screw of 15 mm and lead 5 mm.
fn buckling_example() -> Check {
    let permitted =
        shaft(Support::FixedSupported, 820.0 * MM, 12.5 * MM).buckling_load() / BUCKLING_SAFETY;
    let source =
        "MISUMI, technical data, Selection of Ball Screws 2, example of the allowable axial load";
    Check::new(
        "makers/buckling-example",
        source,
        "core 12.5 mm, 820 mm fixed-supported: 3630 N are allowed",
    )
    .measured(permitted, "N")
    .equals(3630.0, 0.025 * 3630.0, "its factor is 10 for 10.2: two digits, and 2 for 2.046")
}

/// `m` of `F = m d⁴/l² 10³ kgf`, a half of the buckling load.
fn buckling_factors() -> Vec<Check> {
    /// Newtons in a kilogram-force.
    const KGF: f64 = 9.806_65;
    let source = "HSK, ball screw technical description, 2. Buckling load (E = 2.1e4 kgf/mm²)";
    let claims = [
        (Support::FixedFree, 1.3),
        (Support::SupportedSupported, 5.1),
        (Support::FixedSupported, 10.2),
        (Support::FixedFixed, 20.3),
    ];
    let check = |(support, claimed): (Support, f64)| {
        let mut unit = shaft(support, MM, MM);
        unit.youngs_modulus = 2.1e4 * KGF / MM.powi(2);
        let ours = unit.buckling_load() / BUCKLING_SAFETY / KGF / 1e3;
        Check::new(
            &format!("makers/buckling-factor-{}", support.name()),
            source,
            format!("{} screws: m = {claimed}", support.name()),
        )
        .measured(ours, "")
        .equals(
            claimed,
            0.025 * claimed,
            "two or three digits, and 2 for 2.046 with one fixed end",
        )
    };
    claims.map(check).into()
}

fn yield_factor() -> Check {
    let ours = shaft(Support::FixedFree, 1.0, MM).yield_load(PERMITTED_STRESS);
    Check::new(
        "makers/yield-factor",
        "THK 514E, A15-30, eq. 6",
        "116 N for a core of 1 mm at 147 N/mm²",
    )
    .measured(ours, "N")
    .equals(116.0, 0.6, "three digits, the last one rounded up")
}

/// A servo axis at 3000 rpm.
fn speed_example() -> Check {
    let whirls = shaft(Support::FixedSupported, 850.0 * MM, 14.4 * MM).critical_speed();
    let source = "DENSO, engineering design of servo mechanism, p. 15, equation (1)";
    Check::new(
        "makers/critical-speed-example",
        source,
        "850 mm fixed-supported: a core of 14.4 mm permits 3000 rpm",
    )
    .measured(CRITICAL_SPEED_RATIO * whirls / RPM, "rpm")
    .equals(3000.0, 15.0, "three digits of the diameter and of the factor 15.1")
}

/// Natural frequencies of a long screw.
fn frequencies() -> [Check; 2] {
    let source = "White paper: 10 steps to achieve optimal ball screw selection, step 7";
    [(Support::FixedFixed, 18.0), (Support::SupportedSupported, 8.0)].map(|(support, claimed)| {
        let ours = shaft(support, 100.0 * INCH, INCH).critical_speed() / TAU;
        Check::new(
            &format!("makers/frequency-{}", support.name()),
            source,
            format!("core of 1 inch, 100 inch {}: about {claimed} Hz", support.name()),
        )
        .measured(ours, "Hz")
        .equals(claimed, 0.5, "whole numbers")
    })
}

/// A load rating for a life.
fn rating_example() -> Check {
    let duty = Duty { load: 1.2 * 1000.0, speed: 2400.0 * RPM, time: 1.0 };
    let hours = life(17_073.1, None, &[duty]).map_or(f64::NAN, |life| life.time / HOUR);
    let source = "MITCalc, ball screws, rows 1.9 to 1.13 of the shown example";
    Check::new(
        "makers/rating-example",
        source,
        "1000 N with load factor 1.2 at 2400 rpm for 20 000 h need C_a = 17 073.1 N",
    )
    .measured(hours, "h")
    .equals(20_000.0, 1.0, "six digits of the rating, three times")
}

/// Loads of a carriage that moves steadily.
fn guides() -> [Check; 2] {
    let moving =
        |mass, process| Carriage { mass, inclination: 0.0, friction: 0.02 }.load(process, 1.0, 0.0);
    [
        Check::new(
            "makers/guide-example",
            "MISUMI, Selection of Ball Screws, example of the axial load",
            "50 kg on rolling guides of 0.02: about 10 N",
        )
        .measured(moving(50.0, 0.0), "N")
        .equals(10.0, 0.5, "a whole number"),
        Check::new(
            "makers/guide-and-seal-example",
            "Industrial Monitor Direct, sizing ball screws for linear actuation",
            "100 kg on guides of 0.02 with 28 N of seals: about 48 N",
        )
        .measured(moving(100.0, 28.0), "N")
        .equals(48.0, 0.5, "a whole number"),
    ]
}

/// The load that opens a preloaded pair.
fn opening() -> Check {
    Check::new(
        "makers/opening-load",
        "THK, preload of double nuts",
        "a preload is effective up to about three times itself",
    )
    .measured(OPENS_AT, "")
    .equals(3.0, 0.2, "`about`; Hertz gives 2 to the power 1.5")
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    /// By a second implementation, from the sources' own numbers and tables of beams.
    #[test]
    fn examples_by_hand() {
        let found = |key: &str| {
            let all = checks();
            all.iter().find(|check| check.key == key).map_or(f64::NAN, |check| check.measured)
        };
        // λ² from tables of beams: 15.418; ρ 7850.
        let rpm = 0.8 * 60.0 / (2.0 * PI) * 15.418 / 0.85_f64.powi(2)
            * (206e9 * 0.0144_f64.powi(2) / 16.0 / 7850.0).sqrt();
        // Five digits of 15.418.
        assert!((found("makers/critical-speed-example") / rpm - 1.0).abs() < 1e-4, "{rpm}");
        let near = |key: &str, by_hand: f64, reason: &str| {
            let ours = found(key);
            // Five digits of the factors below.
            assert!(
                (ours / by_hand - 1.0).abs() < 1e-4,
                "{key}: {ours}, by hand {by_hand}: {reason}"
            );
        };
        // A bar of 1 mm² bears 147 N.
        near("makers/yield-factor", 147.0 * PI / 4.0, "area of a circle of 1 mm");
        // P = κ π² E I/l² over a half, in kgf and mm, E = 21 000 kgf/mm².
        for (support, kappa) in [
            ("fixed-free", 0.25),
            ("supported-supported", 1.0),
            ("fixed-supported", 2.0457),
            ("fixed-fixed", 4.0),
        ] {
            let factor = kappa * 9.8696 * 21_000.0 * (PI / 64.0) / 2.0 / 1000.0;
            near(&format!("makers/buckling-factor-{support}"), factor, "Euler");
        }
        // f = λ²/(2π l²) (d/4) √(E/ρ), inches: 101.6 mm are 4 in.
        let sound = (206e9_f64 / 7850.0).sqrt();
        for (support, root) in [("fixed-fixed", 22.373), ("supported-supported", 9.8696)] {
            let hertz = root / (2.0 * PI * 2.54 * 2.54) * (0.0254 / 4.0) * sound;
            near(&format!("makers/frequency-{support}"), hertz, "beam tables");
        }
        // 10⁶ (C/F)³ revolutions at 2400 a minute.
        let hours = (17_073.1_f64 / 1200.0).powi(3) * 1e6 / (2400.0 * 60.0);
        near("makers/rating-example", hours, "cubic life");
        near("makers/guide-example", 0.02 * 50.0 * 9.806_65, "Coulomb");
        near("makers/guide-and-seal-example", 28.0 + 0.02 * 100.0 * 9.806_65, "Coulomb and seals");
        near("makers/opening-load", 8.0_f64.sqrt(), "2 to the power 3/2");
        let buckles = 2.0457 * PI.powi(3) * 206e9 * 0.0125_f64.powi(4) / (64.0 * 0.82 * 0.82) / 2.0;
        // Five digits of 2.0457.
        assert!((found("makers/buckling-example") / buckles - 1.0).abs() < 1e-4, "{buckles}");
    }
}
