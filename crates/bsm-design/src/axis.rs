//! Loads and speeds of a nut that is installed in an axis, and the quantities that the design rules
//! check. This module is used by the design procedure, the catalog search and the axis report.
//!
//! Theory: `docs/theory/18-axis.md`.

use std::f64::consts::TAU;

use bsm_dyn::DrivenPart;

use crate::Screw;
use crate::life::{Duty, Life, life, life_factor, modified_life, pair_loads, viscosity_ratio};
use crate::motion::{Phase, PhasePoint};
use crate::shaft::{Bore, BucklingSection, EndFixity, PERMITTED_STRESS, Shaft};

/// Default overrun of the thread at each end, beyond the stroke and the nut, as a multiple of the
/// lead.
const OVERRUN_LEADS: f64 = 1.0;

/// Load factors that catalogs recommend: upper limit of the feed speed \[m/s\], and range of the
/// load factor up to this speed.
///
/// Source: THK general catalog, table 19.
const LOAD_FACTORS: [(f64, [f64; 2]); 4] =
    [(0.25, [1.0, 1.2]), (1.0, [1.2, 1.5]), (2.0, [1.5, 2.0]), (f64::INFINITY, [2.0, 3.5])];

/// End supports, length, shaft diameter and bore of a screw.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mount {
    /// End supports of the screw.
    pub support: EndFixity,
    /// Unsupported length \[m\]; defaults to the length of the thread.
    pub length: Option<f64>,
    /// Overrun of the thread beyond stroke and nut at each end \[m\]; defaults to one lead.
    pub overrun: Option<f64>,
    /// Shaft diameter for bending and buckling \[m\]; defaults to the core diameter of the thread.
    pub diameter: Option<f64>,
    /// Bore of the screw.
    pub bore: Bore,
    /// End supports of the section that may buckle; defaults to [`EndFixity::of_buckling`].
    pub buckling_support: Option<EndFixity>,
    /// Length of the section that may buckle \[m\]; defaults to the length of the shaft.
    pub buckling_length: Option<f64>,
}

impl Mount {
    /// Returns the overrun of the thread beyond stroke and nut at each end \[m\].
    pub fn overrun_of(&self, lead: f64) -> f64 {
        self.overrun.unwrap_or(OVERRUN_LEADS * lead)
    }

    /// Returns the length of the thread \[m\]: the sum of the stroke, the nut length and the
    /// overruns at both ends.
    ///
    /// * `lead`, `nut_length`, `stroke`: lead, nut length and stroke \[m\].
    pub fn thread_length(&self, lead: f64, nut_length: f64, stroke: f64) -> f64 {
        stroke + nut_length + 2.0 * self.overrun_of(lead)
    }

    /// Returns true if the load on the screw may be unguided, as in a jack. This is assumed if one
    /// end of the screw is free and no end supports are given for the section that may buckle.
    pub fn may_be_unguided(&self) -> bool {
        self.support == EndFixity::FixedFree && self.buckling_support.is_none()
    }

    /// Returns the shaft between the bearings, or `None` if its length is not known.
    ///
    /// * `nut_length`, `stroke`: nut length and stroke \[m\].
    pub fn shaft(&self, screw: &Screw, nut_length: f64, stroke: Option<f64>) -> Option<Shaft> {
        let thread = stroke.map(|stroke| self.thread_length(screw.lead, nut_length, stroke));
        let length = self.length.or(thread)?;
        let buckling = BucklingSection {
            support: self.buckling_support.unwrap_or(self.support.of_buckling()),
            length: self.buckling_length.unwrap_or(length),
        };
        Some(Shaft {
            support: self.support,
            length,
            bore: self.bore,
            buckling,
            diameter: self.diameter.unwrap_or(screw.core),
            youngs_modulus: screw.youngs_modulus,
        })
    }
}

/// A nut installed in an axis, with its screw, shaft and duty cycle.
#[derive(Debug, Clone)]
pub struct Axis {
    /// Dimensions of the screw.
    pub screw: Screw,
    /// Shaft between the bearings; `None` if its length is not known.
    pub shaft: Option<Shaft>,
    /// Phases of the duty cycle.
    pub phases: Vec<Phase>,
    /// Modified dynamic load rating `$C_{am}$` \[N\], from the calculated rating or the
    /// manufacturer's rating (Z36).
    pub dynamic_rating: f64,
    /// Modified static load rating `$C_{0am}$` \[N\] (Z36).
    pub static_rating: f64,
    /// Preload of a nut pair \[N\]; `None` without a preload.
    pub preload: Option<f64>,
    /// Part that the motor drives, either the screw or the nut.
    pub driven: DrivenPart,
    /// Compressive force due to thermal expansion in a screw between two fixed bearings \[N\].
    pub compression: f64,
    /// Ratio of the life at the required reliability to the life at a reliability of 90 % (Z14).
    pub reliability: f64,
}

impl Axis {
    /// Returns the point of the cycle with the largest absolute load. If several points have this
    /// load, the point with the largest speed is returned.
    pub fn heaviest(&self) -> Option<PhasePoint> {
        self.phases.iter().map(Phase::heavier_end).reduce(PhasePoint::heavier)
    }

    /// Returns the point of the cycle with the largest load among the phases with motion.
    pub fn heaviest_moving(&self) -> Option<PhasePoint> {
        let moving = self.phases.iter().filter(|phase| phase.moves());
        moving.map(Phase::heavier_end).reduce(PhasePoint::heavier)
    }

    /// Returns the largest absolute axial load \[N\].
    pub fn largest_load(&self) -> f64 {
        self.heaviest().map_or(0.0, |point| point.load.abs())
    }

    /// Returns the largest load on a single nut \[N\]. For a pair, this is the load on the more
    /// heavily loaded nut.
    pub fn larger_nut_load(&self) -> f64 {
        let largest = self.largest_load();
        self.preload.map_or(largest, |preload| pair_loads(preload, largest).0)
    }

    /// Returns the largest relative speed between screw and nut \[rad/s\].
    pub fn fastest(&self) -> f64 {
        self.phases.iter().map(Phase::fastest).fold(0.0, f64::max)
    }

    /// Returns the time average of the absolute relative speed over the whole cycle, including
    /// standstill \[rad/s\].
    pub fn mean_speed(&self) -> f64 {
        let duty = self.duty();
        let time: f64 = duty.iter().map(|duty| duty.time).sum();
        duty.iter().map(|duty| duty.speed.abs() * duty.time).sum::<f64>() / time
    }

    /// Returns the life under the duty cycle at the required reliability, or `None` if nothing
    /// rotates.
    pub fn life(&self) -> Option<Life> {
        let life = life(self.dynamic_rating, self.preload, &self.duty())?;
        let (revolutions, time) = (life.revolutions, life.time);
        Some(Life {
            revolutions: self.reliability * revolutions,
            time: self.reliability * time,
            ..life
        })
    }

    /// Returns the life \[s\] at the required reliability, modified for the lubricant and its
    /// cleanliness (Z40). Returns `None` if nothing rotates, or if the viscosity ratio of a phase
    /// is below 0.1.
    ///
    /// * `viscosity_ratio`: viscosity ratio as a function of the screw speed \[rad/s\] and the load
    ///   on a nut \[N\].
    /// * `clean_limit`: product of contamination factor and fatigue load limit \[N\].
    pub fn modified_life(
        &self,
        viscosity_ratio: impl Fn(f64, f64) -> f64,
        clean_limit: f64,
    ) -> Option<f64> {
        let factor = |speed, load| life_factor(viscosity_ratio(speed, load), clean_limit / load);
        let revolutions = modified_life(self.dynamic_rating, self.preload, &self.duty(), factor)?;
        Some(self.reliability * revolutions * TAU / self.life()?.mean_speed)
    }

    /// Returns the viscosity ratio at a given screw speed \[rad/s\] (Z38).
    pub fn viscosity_ratio(&self, viscosity: f64, speed: f64) -> f64 {
        viscosity_ratio(viscosity, speed, self.screw.pitch_diameter)
    }

    /// Returns the range of load factors that catalogs recommend for the speed of the fastest
    /// phase.
    pub fn advised_load_factors(&self) -> [f64; 2] {
        let feed = self.screw.lead / TAU * self.fastest();
        let found = LOAD_FACTORS.iter().find(|(fastest, _)| feed <= *fastest);
        found.map_or([1.0; 2], |(_, factors)| *factors)
    }

    /// Returns the load, speed and duration of each phase. The loads include the load factors.
    pub fn duty(&self) -> Vec<Duty> {
        self.phases.iter().flat_map(|phase| phase.duty(self.preload)).collect()
    }

    /// Returns the largest speed number \[m·rad/s\] (Z15). The speed number is a measure of the
    /// loads on the ball return. Manufacturers permit 50 000 to 220 000 mm/min, depending on the
    /// type of ball return.
    ///
    /// Source: ISO 3408-1; catalogs of manufacturers such as HIWIN BS-08-2, F 3.29, which use the
    /// nominal diameter.
    pub fn speed_number(&self) -> f64 {
        // D_N = D_pw Ω                                                    (Z15)
        self.screw.pitch_diameter * self.fastest()
    }

    /// Returns the static safety factor based on the static load rating (Z16). For a preloaded
    /// pair, the safety factor of the more heavily loaded nut is returned.
    ///
    /// Source: ISO 3408-5; THK requires 2 without impact and 5 with impact.
    pub fn static_safety(&self) -> f64 {
        // f_s = C_0a/F                                                    (Z16)
        self.static_rating / self.larger_nut_load()
    }

    /// Returns the ratio of the largest speed to the critical speed of the screw. Compression due
    /// to constrained thermal expansion lowers the critical speed. Returns `None` if the screw does
    /// not rotate and therefore cannot whirl.
    pub fn critical_speed_ratio(&self) -> Option<f64> {
        let shaft = self.shaft.as_ref().filter(|_| self.driven == DrivenPart::Screw)?;
        Some(self.fastest() / shaft.critical_speed_under(-self.compression))
    }

    /// Returns the ratio of the largest speed of a driven nut to the critical speed of its screw,
    /// or `None` if the motor drives the screw.
    pub fn nut_resonance_ratio(&self) -> Option<f64> {
        let shaft = self.shaft.as_ref().filter(|_| self.driven == DrivenPart::Nut)?;
        Some(self.fastest() / shaft.critical_speed())
    }

    /// Returns the ratio of the buckling load to the sum of the largest load and the compressive
    /// force due to thermal expansion.
    pub fn buckling_safety(&self) -> Option<f64> {
        let pressed = self.largest_load() + self.compression;
        Some(self.shaft.as_ref()?.buckling_load() / pressed)
    }

    /// Returns the ratio [`buckling_safety`](Self::buckling_safety) for a section that buckles with
    /// the end supports of the whole screw.
    pub fn buckling_safety_of_support(&self) -> Option<f64> {
        let shaft = self.shaft.as_ref()?;
        let ratio = shaft.with_buckling_of_support().buckling_load() / shaft.buckling_load();
        Some(ratio * self.buckling_safety()?)
    }

    /// Returns the axial load \[N\] at which the stress in the core of the screw reaches
    /// [`PERMITTED_STRESS`].
    pub fn yield_load(&self) -> Option<f64> {
        Some(self.shaft.as_ref()?.yield_load(PERMITTED_STRESS))
    }
}
