//! Life of a nut under varying loads, and its modification for hardness, accuracy, lubrication and
//! contamination.

use std::f64::consts::TAU;

pub use crate::modified::{
    Contamination, Hardness, RatingFactors, life_factor, usual_fatigue_limit, viscosity_ratio,
    viscosity_ratio_by_film,
};

/// Ratio of load to preload at which the relieved nut of a pair loses contact, `$2^{3/2}$` (D14).
pub const UNLOADING_RATIO: f64 = 2.0 * std::f64::consts::SQRT_2;

/// Number of revolutions for which the dynamic load rating is defined.
const MILLION: f64 = 1e6;

/// A section of the duty cycle of a screw.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Duty {
    /// Axial load \[N\], whose sign gives the direction.
    pub load: f64,
    /// Relative speed between screw and nut \[rad/s\]. Only its absolute value matters.
    pub speed: f64,
    /// Duration in any unit.
    pub time: f64,
}

/// Life that 90 % of all nuts reach, together with the equivalent load and speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Life {
    /// Equivalent load on the more heavily loaded flank of a nut, or on the more heavily loaded nut
    /// of a pair \[N\].
    pub mean_load: f64,
    /// Equivalent load on the less heavily loaded flank of a nut, or on the less heavily loaded nut
    /// of a pair \[N\]; 0 if this flank or nut carries no load.
    pub other_mean_load: f64,
    /// Equivalent speed \[rad/s\].
    pub mean_speed: f64,
    /// Rating life `$L_{10}$` in revolutions.
    pub revolutions: f64,
    /// Rating life `$L_{10}$` \[s\].
    pub time: f64,
}

/// A required life in one of the units in which it may be specified.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RequiredLife {
    /// Operating time including standstill \[s\].
    Time(f64),
    /// Total travel in both directions \[m\].
    Travel(f64),
    /// Total revolutions in both directions.
    Revolutions(f64),
}

impl RequiredLife {
    /// Returns the required number of revolutions.
    ///
    /// * `lead`: lead of the screw \[m\].
    /// * `mean_speed`: time average of the absolute speed, including standstill \[rad/s\].
    pub fn revolutions(self, lead: f64, mean_speed: f64) -> f64 {
        match self {
            Self::Time(time) => time * mean_speed / TAU,
            Self::Travel(travel) => travel / lead,
            Self::Revolutions(revolutions) => revolutions,
        }
    }

    /// Returns the required operating time \[s\]. The arguments are the same as for
    /// [`revolutions`](Self::revolutions).
    pub fn time(self, lead: f64, mean_speed: f64) -> f64 {
        match self {
            Self::Time(time) => time,
            _ => self.revolutions(lead, mean_speed) * TAU / mean_speed,
        }
    }
}

/// Travel to which a manufacturer's dynamic load rating refers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RatingBasis {
    /// The rating refers to a million revolutions, as in ISO 3408-5.
    Revolutions,
    /// The rating refers to a travel of 100 km.
    Kilometers,
    /// The rating refers to a travel of a million inches.
    MillionInches,
}

impl RatingBasis {
    /// Returns the dynamic load rating for a million revolutions, divided by the manufacturer's
    /// rating (BB8).
    ///
    /// * `lead`: lead of the screw \[m\].
    pub fn factor(self, lead: f64) -> f64 {
        let travel = match self {
            Self::Revolutions => return 1.0,
            Self::Kilometers => 1e5,
            Self::MillionInches => 25_400.0,
        };
        // C_a = C_b [L_b/(10⁶ P_h)]^⅓                                     (BB8)
        (travel / (MILLION * lead)).cbrt()
    }
}

/// Returns the life of a single nut or of a preloaded pair by (D12) to (D15), from the dynamic load
/// rating of one nut `rating` \[N\] and the preload \[N\]. Returns `None` if nothing rotates.
///
/// ```math
/// L_{10} = 10^6\,(C_a/F_m)^3, \qquad F_m^3 = \frac{\sum F_j^3 n_j t_j}{\sum n_j t_j}
/// ```
///
/// Loads in the two directions act on different flanks of a nut, or on different nuts of a pair.
/// Each flank has its own equivalent load and life, averaged over all revolutions. Source: ISO
/// 3408-5, 7.2.
pub fn life(rating: f64, preload: Option<f64>, duty: &[Duty]) -> Option<Life> {
    let angle: f64 = duty.iter().map(|d| d.speed.abs() * d.time).sum();
    let time: f64 = duty.iter().map(|d| d.time).sum();
    if !(angle > 0.0 && time > 0.0) {
        return None;
    }
    let mean = |load: &dyn Fn(&Duty) -> f64| {
        // F_m = [Σ F_j³ n_j t_j / Σ n_j t_j]^⅓                            (D12)
        let cubes = duty.iter().map(|d| load(d).powi(3) * d.speed.abs() * d.time).sum::<f64>();
        (cubes / angle).cbrt()
    };
    // L = 10⁶ (C_a/F_m)³                                                  (D13)
    let of = |load: f64| MILLION * (rating / load).powi(3);
    let flanks = |d: &Duty| pair_loads(preload.unwrap_or(0.0), d.load);
    let (one, other) = (mean(&|d| flanks(d).0), mean(&|d| flanks(d).1));
    let (mean_load, other_mean_load) = (one.max(other), one.min(other));
    let revolutions = of_flanks([one, other].map(of));
    let mean_speed = angle / time;
    let time = revolutions * TAU / mean_speed;
    Some(Life { mean_load, other_mean_load, mean_speed, revolutions, time })
}

/// Returns the life of a nut from the lives of its two flanks.
fn of_flanks([one, other]: [f64; 2]) -> f64 {
    if one.max(other).is_infinite() {
        return one.min(other);
    }
    // L = (L₁^(−10/9) + L₂^(−10/9))^(−9/10)                               (D15)
    (one.powf(-10.0 / 9.0) + other.powf(-10.0 / 9.0)).powf(-0.9)
}

/// Returns the [`life`] in revolutions with a separate life factor for each flank load (Z40).
/// Returns `None` if nothing rotates, or if `factor` returns `None` for a load that acts during
/// rotation.
///
/// ```math
/// \frac1{L_k} = \frac{\sum_j n_j t_j\,(P_{k,j}/C_{am})^3/a_{k,j}}{10^6\sum_j n_j t_j}
/// ```
///
/// * `factor`: life factor as a function of speed \[rad/s\] and flank load \[N\], both positive.
///
/// Source: linear accumulation of damage; ISO 281 for each load.
pub fn modified_life(
    rating: f64,
    preload: Option<f64>,
    duty: &[Duty],
    factor: impl Fn(f64, f64) -> Option<f64>,
) -> Option<f64> {
    let (mut angle, mut taken) = (0.0, [0.0; 2]);
    for d in duty.iter().filter(|d| d.speed != 0.0 && d.time > 0.0) {
        let turned = d.speed.abs() * d.time;
        angle += turned;
        let loads = pair_loads(preload.unwrap_or(0.0), d.load);
        for (taken, load) in taken.iter_mut().zip([loads.0, loads.1]) {
            if load > 0.0 {
                // 1/L_k = Σ n_j t_j (P_kj/C_am)³/a_kj / (10⁶ Σ n_j t_j)   (Z40)
                *taken += turned * (load / rating).powi(3) / factor(d.speed.abs(), load)?;
            }
        }
    }
    (angle > 0.0).then(|| of_flanks(taken.map(|taken| MILLION * angle / taken)))
}

/// Reliabilities \[%\], each with the ratio of the life at this reliability to the life at 90 %
/// (Z14) (ISO 3408-5).
const RELIABILITY: [(f64, f64); 6] =
    [(90.0, 1.0), (95.0, 0.62), (96.0, 0.53), (97.0, 0.44), (98.0, 0.33), (99.0, 0.21)];

/// Returns the life that a given percentage of all nuts reaches, divided by the life that 90 %
/// reach (Z14). Between the values of the standard, the factor is calculated from the Weibull
/// distribution. The values of the standard are rounded values of this distribution.
///
/// * `percent`: reliability, limited to the range from 90 to 99.
///
/// Source: ISO 3408-5, as printed by manufacturers (HIWIN BS-08-2, table 3.17, states 0.63 instead
/// for 95 %).
pub fn reliability_factor(percent: f64) -> f64 {
    let percent = percent.clamp(90.0, 99.0);
    let stated = RELIABILITY.iter().find(|(known, _)| (percent - known).abs() < 1e-9);
    // a_1 = [ln(100/R)/ln(100/90)]^⅔                                      (Z14)
    let weibull = || ((100.0 / percent).ln() / (100.0_f64 / 90.0).ln()).powf(2.0 / 3.0);
    stated.map_or_else(weibull, |(_, factor)| *factor)
}

/// Returns the loads on both nuts of a preloaded pair under an axial load (D14). The first value is
/// the load on the nut whose load increases under a positive axial load, and the second value is
/// the load on the other nut.
///
/// Under loads above `$2^{3/2}$` times the preload, one nut is unloaded. Assumes that the
/// displacement is proportional to the load up to this limit, as in ISO 3408-5.
pub fn pair_loads(preload: f64, load: f64) -> (f64, f64) {
    let free = UNLOADING_RATIO * preload;
    let size = load.abs();
    // F₁ = F_w [1 + F/(2^{3/2} F_w)]^{3/2},  F₂ = F₁ − F                  (D14)
    let (more, less) = if size < free {
        let more = preload * (1.0 + size / free).powf(1.5);
        (more, (more - size).max(0.0))
    } else {
        (size, 0.0)
    };
    if load < 0.0 { (less, more) } else { (more, less) }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    fn duty(load: f64, speed: f64, time: f64) -> Duty {
        Duty { load, speed, time }
    }

    /// Hand calculation: under a load of one tenth of the rating, the life is 10⁹ revolutions,
    /// which is 10⁷ s at 100 revolutions per second.
    #[test]
    fn life_is_inversely_proportional_to_the_cube_of_the_load() {
        let life = life(20e3, None, &[duty(-2e3, 100.0 * TAU, 3.0)]).expect("turns");
        assert_relative_eq!(life.revolutions, 1e9, max_relative = 1e-12);
        assert_relative_eq!(life.time, 1e7, max_relative = 1e-12);
    }

    /// Hand calculation: if half of all revolutions are without load, the life doubles. Standstill
    /// does not add revolutions.
    #[test]
    fn equivalent_load_is_weighted_by_revolutions() {
        let (load, idle, rest) = (duty(2e3, 10.0, 1.0), duty(0.0, 5.0, 2.0), duty(9e3, 0.0, 7.0));
        let life = life(20e3, None, &[load, idle, rest]).expect("turns");
        assert_relative_eq!(life.revolutions, 2e9, max_relative = 1e-12);
        assert_relative_eq!(life.mean_speed, 2.0, max_relative = 1e-12);
    }

    /// The factors match the values of the standard, an intermediate value calculated by hand, and
    /// the constant values outside the range of the table. The Weibull distribution matches the
    /// values of the standard to two digits.
    #[test]
    fn reliability_factors_match_the_standard() {
        for (percent, factor) in
            [(90.0, 1.0), (95.0, 0.62), (99.0, 0.21), (80.0, 1.0), (99.9, 0.21)]
        {
            assert_relative_eq!(reliability_factor(percent), factor, max_relative = 1e-12);
        }
        // ln(100/92)/ln(100/90) = 0.79139.
        assert_relative_eq!(reliability_factor(92.0), 0.8556, max_relative = 1e-4);
        for (percent, factor) in RELIABILITY {
            let beside = reliability_factor((percent - 1e-6).max(90.0 + 1e-6));
            assert!((beside - factor).abs() < 0.005, "{percent} {beside} {factor}");
        }
    }

    /// Worked examples: the MISUMI economy series states 24 824 h for a nut with a rating of 4400 N
    /// under 250 N with a load factor of 1.2 at 2118 rpm. A MITCalc sheet states a rating of 17
    /// 073.1 N for 20 000 h at 2400 rpm under 1000 N with a load factor of 1.2.
    #[test]
    fn lives_match_worked_examples_of_catalogs() {
        let rpm = TAU / 60.0;
        let of = life(4400.0, None, &[duty(1.2 * 250.0, 2118.0 * rpm, 1.0)]).expect("turns");
        // The exact result is 24 826.6 h. MISUMI rounds intermediate results, which causes a
        // relative error of 1e-4.
        assert_relative_eq!(of.time / 3600.0, 24_824.0, max_relative = 1.5e-4);
        let of = life(17_073.1, None, &[duty(1.2 * 1000.0, 2400.0 * rpm, 1.0)]).expect("turns");
        // The rating has six digits, so its error is up to 6e-6, and the error of the life is three
        // times as large.
        assert_relative_eq!(of.time / 3600.0, 20_000.0, max_relative = 2e-5);
    }

    /// Without an external load, both nuts of a pair carry the preload. Under a load of 2^{3/2}
    /// times the preload, one nut is just unloaded, and the pair has the life of a single nut under
    /// this load. If the load changes direction, the nuts exchange their roles.
    #[test]
    fn a_pair_without_remaining_preload_has_the_life_of_one_nut() {
        let pair = |load| life(20e3, Some(1e3), &[duty(load, 1.0, 1.0)]).expect("turns");
        assert_relative_eq!(pair(0.0).revolutions, 8e9 * 2.0_f64.powf(-0.9), max_relative = 1e-12);
        let free = 2.0_f64.powf(1.5) * 1e3;
        let one = life(20e3, None, &[duty(free, 1.0, 1.0)]).expect("turns");
        for load in [free * (1.0 - 1e-9), free * (1.0 + 1e-9)] {
            assert_relative_eq!(pair(load).revolutions, one.revolutions, max_relative = 1e-8);
            assert_relative_eq!(pair(-load).revolutions, one.revolutions, max_relative = 1e-8);
        }
        let both = [duty(1e3, 1.0, 1.0), duty(-1e3, 1.0, 1.0)];
        let shared = life(20e3, Some(1e3), &both).expect("turns");
        // Each nut is the more heavily loaded nut during half of all revolutions.
        assert!(shared.revolutions > pair(1e3).revolutions, "{shared:?}");
        assert!(life(20e3, None, &[duty(1e3, 0.0, 1.0)]).is_none());
    }

    /// A factor of 1 gives the unmodified life, and a factor of 4 multiplies the life by four. Each
    /// load has its own factor. The hand calculation is for a rating of 20 kN, with 3 kN and a
    /// factor of 2 for half of all revolutions, and 6 kN and a factor of 1 for the other half:
    /// 2/(0.5·0.15³/2 + ...).
    #[test]
    fn each_load_has_its_own_life_factor() {
        let turned = [duty(3e3, 1.0, 1.0), duty(-6e3, 1.0, 1.0), duty(9e3, 0.0, 1.0)];
        for preload in [None, Some(2e3)] {
            let plain = life(20e3, preload, &turned).expect("turns").revolutions;
            let of = |factor| modified_life(20e3, preload, &turned, |_, _| factor);
            assert_relative_eq!(of(Some(1.0)).expect("turns"), plain, max_relative = 1e-12);
            assert_relative_eq!(of(Some(4.0)).expect("turns"), 4.0 * plain, max_relative = 1e-12);
            assert_eq!(of(None), None);
        }
        let one_way = [duty(3e3, 1.0, 1.0), duty(6e3, 1.0, 1.0)];
        let own = |_, load: f64| Some(if load < 4e3 { 2.0 } else { 1.0 });
        let by_hand = 1e6 / (0.5 * 0.15_f64.powi(3) / 2.0 + 0.5 * 0.3_f64.powi(3));
        let ours = modified_life(20e3, None, &one_way, own).expect("turns");
        assert_relative_eq!(ours, by_hand, max_relative = 1e-12);
    }

    /// In an earlier version, loads in both directions were combined on one flank. The hand
    /// calculation is for a nut with a rating of 20 kN under 3 kN in each direction for half of all
    /// revolutions. Each flank has an equivalent load of 2^(-1/3) · 3 kN. The life is 2^(-0.9)
    /// times the life of one flank, which is twice the life under a constant load of 3 kN.
    #[test]
    fn loads_in_opposite_directions_act_on_separate_flanks() {
        let turned = |loads: [f64; 2]| {
            life(20e3, None, &loads.map(|load| duty(load, 1.0, 1.0))).expect("turns")
        };
        let both = turned([3e3, -3e3]);
        let lumped = turned([3e3, 3e3]);
        assert_relative_eq!(lumped.revolutions, 2.962_963e8, max_relative = 1e-6);
        let by_hand = 2.0_f64.powf(0.1) * lumped.revolutions;
        assert_relative_eq!(both.revolutions, by_hand, max_relative = 1e-12);
        assert_relative_eq!(both.mean_load, 3e3 / 2.0_f64.cbrt(), max_relative = 1e-12);
        assert_relative_eq!(both.other_mean_load, both.mean_load, max_relative = 1e-12);
        // An unloaded flank does not reduce the life.
        let one = turned([3e3, 0.0]);
        assert_relative_eq!(one.revolutions, 2.0 * lumped.revolutions, max_relative = 1e-12);
    }
}
