//! What the sheet of an axis says besides its numbers: what was assumed, what is usual, what is uncertain.

use bsm_design::{Axis, Grade, Phase, speed_jumps};
use bsm_dyn::ModelWorkspace;

use super::state::AxisState;
use super::torques::{Preload, Torques};
use super::{contacts, no_balls};
use crate::answers::nut::{preload_note, torque_to_measure};
use crate::case::axis::{LEAST_TURNS, make};
use crate::case::rated_screw::LEFT_OUT;
use crate::case::warm::Warm;
use crate::vocabulary::entries::Choice;
use crate::vocabulary::units::{MM, RPM};
use crate::{CaseError, InputKey, NutReport, trimmed};

/// Lengths of a nut below which a stroke is short (HIWIN BS-08-2, F 3.10), and the load factor there, the least.
const SHORT: (f64, f64) = (3.0, 3.0);

/// Speed number from which the grease is to be asked for \[mm/min\], usual value.
const FAST: f64 = 100e3;

/// Steady-state temperature rise above which an axis is to be cooled \[K\], usual value.
const HOT: f64 = 40.0;

/// Ratio of the viscosity ratios by film and by viscosity above which both are stated.
const UNCERTAIN: f64 = 3.0;

impl AxisState<'_> {
    /// Defaults that were used.
    pub(super) fn notes(&self) -> Vec<String> {
        let no_input = self.no_nut.as_ref().filter(|why| !matches!(why, CaseError::Nut(_)));
        let mut notes: Vec<_> = no_input.map(no_balls).into_iter().collect();
        if let Some(Preload { cold, warm, .. }) = self.preload
            && (cold - warm).abs() > 0.0
        {
            notes.push(preload_note(cold, warm));
        }
        notes.extend(self.warm.iter().flat_map(Warm::notes));
        notes.extend(self.nut.as_ref().and_then(NutReport::touch_note));
        notes.extend(self.machine.assumed.iter().cloned());
        notes.extend(self.by_catalogue());
        notes.extend(self.heaviest().and_then(Torques::costs));
        notes.extend(self.about_life());
        let films = self.machine.groove.is_some();
        notes.extend(self.case.assumed_roughness().filter(|_| films));
        notes.extend(self.to_measure());
        if let (Some(rise), Some([low, high]), None) =
            (self.steady_rise(), self.rise_band(), self.case.axis_heat_transfer_W_K)
        {
            notes.push(format!(
                "steady-state temperature rise estimated within a factor of 2: {rise:.0} K ({low:.0} to {high:.0} K), by the \
                 heat transfer to still air; axis_heat_transfer_W_K replaces it"
            ));
        }
        let mut note = |text: &str| notes.push(text.to_owned());
        if let Some(word) = self.case.nut.accuracy_grade {
            note(&word.describe());
            let Grade { name, .. } = word.grade;
            match self.travel() {
                Some(travel) if word.grade.worst_error(travel).is_none() => {
                    let what = if word.grade.deviation(travel).is_some() { "v_up" } else { "e_p" };
                    note(&format!("{name} has no {what} for a travel of {:.0} mm", travel / MM));
                }
                _ => {}
            }
        }
        let speed_number = self.axis().speed_number() / (MM * RPM);
        if speed_number > FAST {
            note(
                "above a speed number of some 100 000 mm/min oil or a high-speed grease is usual: ask for the grease",
            );
        }
        if let Some(short) = self.short_stroke() {
            note(&short);
        }
        if self.machine.axis.shaft.is_none() {
            note(
                "without stroke_mm or unsupported_length_mm there is no critical speed, buckling load and inertia of the screw",
            );
            return notes;
        }
        if self.case.screw_inertia_kg_m2_m.is_some() {
            note(
                "screw_inertia_kg_m2_m is taken as given; manufacturers print that of a rod of the nominal diameter, 1.15 to 1.87 times \
                 that of their own mass of a metre",
            );
        }
        if self.case.nut.support.is_none() {
            note("support is not given: fixed-supported is taken");
        }
        if let (None, Some(shaft)) = (self.case.nut.buckling_support, self.shaft()) {
            note(&format!(
                "buckling between fixed bearing and nut: {} (default); buckling_support replaces it",
                shaft.buckling.0.name()
            ));
        }
        if self.case.unsupported_length_mm.is_none() {
            note("unsupported_length_mm is stroke, length of the nut and two leads");
        }
        notes
    }

    /// What is unusual: a warm axis, and a screw longer than manufacturers offer.
    pub(super) fn warnings(&self) -> Vec<String> {
        let hot = self.steady_rise().filter(|rise| *rise > HOT).map(|rise| {
            format!(
                "a steady-state temperature rise of {rise:.0} K is above {HOT:.0} K, for the sake of grease and preload: cool the nut \
                 or the screw"
            )
        });
        let longest = make(self.case).longest(self.grade(), self.axis().screw.outer);
        let thread = self.shaft().map(|shaft| shaft.length);
        let long = thread.zip(longest).filter(|(thread, longest)| thread > longest);
        let long = long.map(|(thread, longest)| {
            format!(
                "a screw of {:.0} mm is beyond manufacturers' lists: at most {:.0} mm of this diameter, make and grade",
                thread / MM,
                longest / MM
            )
        });
        let ratios = self.heaviest_phase().map(|torques| self.viscosity_ratios_of(&torques.phase));
        let uncertain = ratios.and_then(|[by_film, by_viscosity]| {
            let (by_film, by_viscosity) = (by_film?, by_viscosity?);
            let apart = (by_film / by_viscosity).max(by_viscosity / by_film);
            (apart > UNCERTAIN).then(|| {
                format!(
                    "viscosity ratio {by_film:.2} by the film ratio, with which the modified life is calculated; {by_viscosity:.2} by \
                     the viscosity alone"
                )
            })
        });
        hot.into_iter().chain(long).chain(uncertain).chain(self.about_cycle()).collect()
    }

    /// Warnings that a cycle does not return or has jumps of the speed.
    fn about_cycle(&self) -> impl Iterator<Item = String> + use<> {
        // A millionth of the range is rounding.
        const ROUNDING: f64 = 1e-6;
        let open =
            self.machine.cycle.filter(|(_, travel)| travel.end.abs() > ROUNDING * travel.range);
        let open = open.map(|(_, travel)| {
            format!(
                "The cycle does not return: it ends {} mm from its start.",
                trimmed(travel.end.abs() / MM)
            )
        });
        let jumps = speed_jumps(&self.axis().phases);
        let first = jumps.first().map(|[before, after]| {
            let feed = |speed: f64| trimmed(speed * self.machine.advance() * 60.0);
            format!(
                "The speed jumps {} in the cycle, first from {} to {} m/min: the torque of such a change is not included. \
                 Moves and ramps include it.",
                if jumps.len() == 1 { "once".to_owned() } else { format!("{} times", jumps.len()) },
                feed(before.speed[1]),
                feed(after.speed[0])
            )
        });
        open.into_iter().chain(first)
    }

    /// What factors of ratings and life were taken, and which are usual.
    pub(super) fn about_life(&self) -> Vec<String> {
        let (axis, case) = (self.axis(), self.case);
        let mut notes = Vec::new();
        if let Some(grade) = self.grade()
            && case.rated_dynamic_load_N.is_some()
            && case.accuracy_factor.is_none()
        {
            notes.push(format!(
                "rated_dynamic_load_N is taken as it is printed for grade {}",
                grade.name
            ));
        }
        let unity = axis.phases.iter().all(|phase| phase.load_factor <= 1.0);
        let lives = axis.advised_load_factors().map(|factor| {
            let phases = axis.phases.iter().map(|phase| Phase { load_factor: factor, ..*phase });
            self.life()?;
            Some(Axis { phases: phases.collect(), ..axis.clone() }.life()?.time / 3600.0)
        });
        if let ([Some(long), Some(short)], true) = (lives, unity) {
            let [low, high] = axis.advised_load_factors();
            notes.push(format!(
                "load factor 1; catalogues advise {low} to {high} at this speed: life {long:.0} to {short:.0} h"
            ));
        }
        let contaminated = case.contamination_factor.is_some() || case.nut.contamination.is_some();
        let lubricated = case.given().is_lubricated();
        notes.extend(match (&self.lubrication, self.modified_life(0)) {
            (Some(_), None) => {
                Some("no modified life: a viscosity ratio is below 0.1, outside ISO 281".to_owned())
            }
            (None, _) if contaminated => Some(
                "no modified life: contamination without viscosity and lubricant_temperature_C"
                    .to_owned(),
            ),
            (None, _) if lubricated => {
                Some("no modified life: contamination is not given".to_owned())
            }
            _ => None,
        });
        notes
    }

    /// What a stroke of a few nut lengths does to the life.
    pub(super) fn short_stroke(&self) -> Option<String> {
        let stroke = self.machine.stroke?;
        let (lengths, factor) = SHORT;
        if stroke < LEAST_TURNS * self.axis().screw.lead {
            return Some(
                "a stroke of less than half a turn has no life by fatigue: false brinelling"
                    .to_owned(),
            );
        }
        let circuits = self.case.value_or_default(InputKey::circuits_count)?;
        // The balls of a circuit advance by (1 − γ)/2 of the nut.
        let round = self.machine.groove.as_ref().map(|(nut, _)| {
            2.0 * nut.turns / circuits * nut.lead / (1.0 - nut.dynamic_rating().gamma)
        });
        if let Some(round) = round.filter(|round| stroke < *round) {
            return Some(format!(
                "a stroke of less than {:.0} mm does not circulate the balls, the same ones carry: make a stroke of two nut \
                 lengths every few thousand strokes (usual advice)",
                round / MM
            ));
        }
        let life = self.life()?.time / 3600.0 / factor.powi(3);
        (stroke < lengths * self.machine.body.length).then(|| {
            format!(
                "a stroke of less than three nut lengths: HIWIN's load factor is 3 to 5, and the life at {factor} is {life:.0} h"
            )
        })
    }

    /// What the sheet of a screw without groove omits, and the band of its torque.
    pub(super) fn by_catalogue(&self) -> Vec<String> {
        if self.machine.groove.is_some() {
            return Vec::new();
        }
        let at = self.heaviest().and_then(|heaviest| {
            let torque = heaviest.at_screw()?;
            let drives = heaviest.point.load * heaviest.point.direction() < 0.0;
            let friction = contacts::by_catalogue(self.case).friction(heaviest.ideal, drives);
            let [high, low] = contacts::usual_frictions(heaviest.ideal, drives)
                .map(|usual| torque + (usual - friction) * heaviest.point.direction());
            Some(format!(
                "torque by catalogue efficiency, {torque:.3} N m at the largest load that moves; usual efficiencies give {low:.3} to \
                 {high:.3} N m"
            ))
        });
        at.into_iter().chain([LEFT_OUT.to_owned()]).collect()
    }

    /// Uncertainty of the torque where friction comes from a lubricant.
    pub(super) fn how_sure(&self) -> Option<String> {
        let heaviest = self.heaviest()?;
        let point = &heaviest.point;
        let work = &mut ModelWorkspace::default();
        let [low, high] = contacts::band(self.case, self.settings, point, work)?;
        let friction = heaviest.contacts.friction?;
        Some(format!(
            "friction from the lubricant: at {:.0} N and {:.0} rpm the 90 % interval over uncertain inputs lies \
             between {:.3} and {:.3} N m, of {friction:.3} N m of the contacts",
            point.load,
            point.friction_speed / RPM,
            low * friction,
            high * friction
        ))
    }

    /// The torque by which the preload is checked, with its tolerance.
    pub(super) fn to_measure(&self) -> Option<String> {
        let torque = self.preload.as_ref()?.by_rule;
        let seal = self.case.seal_torque_Nm.unwrap_or(0.0);
        Some(torque_to_measure(torque, seal, &self.torque_tolerance()))
    }
}
