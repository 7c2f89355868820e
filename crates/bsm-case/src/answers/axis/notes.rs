//! Notes and warnings on the axis sheet: assumptions, practical recommendations, and uncertainties.

use bsm_design::motion::{Phase, speed_jumps};
use bsm_design::{Axis, Grade};
use bsm_dyn::ModelWorkspace;

use super::rules::{NO_LOAD, at_least, is_unloaded};
use super::state::AxisState;
use super::torques::{Preload, Torques};
use super::{contacts, no_balls};
use crate::answers::nut::{preload_note, torque_to_measure};
use crate::case::axis::MIN_STROKE_TURNS;
use crate::case::axis_inputs::make;
use crate::case::rated_screw::LEFT_OUT;
use crate::case::warm::Warm;
use crate::vocabulary::units::{MM, RPM};
use crate::vocabulary::warning::{SelectionLimit, Warning};
use crate::{
    CaseError, InputKey, MissingInput, NutReport, PhaseEntry, format_digits, format_trimmed,
};

/// Ratio of stroke to nut length below which the stroke is short, and the smallest load factor for
/// short strokes (HIWIN BS-08-2, F 3.10).
const SHORT_STROKE: (f64, f64) = (3.0, 3.0);

/// Speed number \[mm/min\] above which the manufacturer must approve the grease (common practice).
const GREASE_SPEED_NUMBER_MM_MIN: f64 = 100e3;

/// Steady-state temperature rise \[K\] above which cooling is recommended (common practice).
const HIGH_RISE_K: f64 = 40.0;

/// Range of the ratio of nut speed to critical screw speed in which a driven nut can excite the
/// screw (common recommendation).
const RESONANCE_RATIOS: std::ops::RangeInclusive<f64> = 0.8..=1.25;

/// Upper limit for the ratio of two viscosity ratios, one based on the film thickness and one based
/// on the viscosity. Above this limit, a note states both viscosity ratios.
const VISCOSITY_RATIO_FACTOR: f64 = 3.0;

impl AxisState<'_> {
    /// Returns notes on the assumptions and default values of the axis sheet.
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
        notes.extend(self.nut.as_ref().and_then(NutReport::assumed_play));
        let unloaded = self.preload.as_ref().and_then(|preload| preload.unloaded.as_ref());
        notes.extend(unloaded.into_iter().flat_map(NutReport::pair_notes));
        notes.extend(self.machine.assumed.iter().cloned());
        notes.extend(self.by_catalog());
        notes.extend(self.heaviest().and_then(Torques::costs));
        notes.extend(self.about_life());
        if is_unloaded(self.case, self.axis()) {
            notes.push(NO_LOAD.to_owned());
        }
        let films = self.machine.groove.is_some();
        notes.extend(self.case.assumed_roughness().filter(|_| films));
        notes.extend(self.to_measure());
        notes.extend(self.about_heat());
        let mut note = |text: &str| notes.push(text.to_owned());
        if let Some(word) = self.case.entries.accuracy_grade {
            note(&word.describe());
            let Grade { name, .. } = word.grade;
            match self.travel() {
                Some(travel) if word.grade.worst_error(travel).is_none() => {
                    let what = if word.grade.deviation(travel).is_some() { "v_up" } else { "e_p" };
                    note(&format!(
                        "{name} specifies no {what} for a travel of {:.0} mm.",
                        travel / MM
                    ));
                }
                _ => {}
            }
        }
        let speed_number = self.axis().speed_number() / (MM * RPM);
        if speed_number > GREASE_SPEED_NUMBER_MM_MIN {
            note(
                "Above a speed number (pitch circle diameter times speed) of about 100 000 mm/min, oil or a high-speed grease is normally used. Ask the manufacturer which grease is suitable.",
            );
        }
        if let Some(short) = self.short_stroke() {
            note(&short);
        }
        for left_out in self.left_out() {
            note(&left_out);
        }
        if self.machine.axis.shaft.is_none() {
            return notes;
        }
        if self.case.screw_inertia_kg_m2_m.is_some() {
            note(
                "screw_inertia_kg_m2_m is used as given. Catalogs often state the moment of inertia of a solid rod with the nominal diameter, which \
                 is 1.15 to 1.87 times the value that corresponds to their mass per meter.",
            );
        }
        if self.case.entries.support.is_none() {
            note("support is not given, so fixed-supported is assumed.");
        }
        if self.case.unsupported_length_mm.is_none() {
            note(
                "unsupported_length_mm is not given, so the length of the thread is used (stroke, nut, and overrun at both ends).",
            );
        }
        notes
    }

    /// Returns warnings about a high temperature rise and about a screw that is longer than the
    /// screws that manufacturers offer.
    pub(super) fn warnings(&self) -> Vec<Warning> {
        let rises = [self.steady_rise(), self.node_rise(0), self.node_rise(1)];
        let rise = rises.into_iter().flatten().fold(f64::NEG_INFINITY, f64::max);
        let held = self.case.lubricant_temperature_C.filter(|_| self.warm.is_none());
        let held = held.map_or_else(String::new, |celsius| {
            format!(
                " The friction that causes this rise is calculated with the lubricant at lubricant_temperature_C = {}, \
                 not at the temperature of the warm nut.",
                format_trimmed(celsius)
            )
        });
        let hot = (rise > HIGH_RISE_K).then(|| {
            format!(
                "The steady-state temperature rise of {rise:.0} K exceeds {HIGH_RISE_K:.0} K, which \
                 damages the grease and changes the preload. Cool the nut or the screw.{held}"
            )
        });
        let grade = self.grade().filter(|grade| !make(self.case).is_offered_in(grade));
        let grade = grade.map(|grade| {
            format!(
                "Manufacturers offer rolled screws only in grades 5 to 10, but accuracy_grade is {}. Ask the manufacturer, or choose a ground screw.",
                grade.name
            )
        });
        let longest = make(self.case).longest(self.grade(), self.axis().screw.outer);
        let thread = self.shaft().map(|shaft| shaft.length);
        let long = thread.zip(longest).filter(|(thread, longest)| thread > longest);
        let long = long.map(|(thread, longest)| {
            format!(
                "A screw of {:.0} mm is longer than the screws in manufacturers' lists, which are at most {:.0} mm long for this diameter, manufacturing method and accuracy grade.",
                thread / MM,
                longest / MM
            )
        });
        let ratios = self.heaviest_phase().map(|torques| self.viscosity_ratios_of(&torques.phase));
        let uncertain = ratios.and_then(|[by_film, by_viscosity]| {
            let (by_film, by_viscosity) = (by_film?, by_viscosity?);
            let apart = (by_film / by_viscosity).max(by_viscosity / by_film);
            (apart > VISCOSITY_RATIO_FACTOR).then(|| {
                format!(
                    "The viscosity ratio is {by_film:.2} if it is calculated from the film ratio, as in the modified life, and \
                     {by_viscosity:.2} if it is calculated from the viscosity alone."
                )
            })
        });
        let hot = hot.map(|text| Warning::limit(SelectionLimit::TemperatureRise, text));
        let long = long.map(|text| Warning::limit(SelectionLimit::ScrewLength, text));
        let resonance =
            self.resonance().map(|text| Warning::limit(SelectionLimit::NutResonance, text));
        let others = self.hindered_growth().into_iter().chain(uncertain);
        let others = others.chain(self.about_cycle()).chain(self.buckles_by_support());
        let others = others.chain(grade).map(Warning::advice);
        hot.into_iter().chain(long).chain(resonance).chain(others).collect()
    }

    /// Returns warnings about a cycle that does not return to its starting position or that
    /// contains speed jumps.
    fn about_cycle(&self) -> impl Iterator<Item = String> + use<> {
        // Differences below a millionth of the travel range are rounding errors.
        const ROUNDING: f64 = 1e-6;
        let open =
            self.machine.cycle.filter(|(_, travel)| travel.end.abs() > ROUNDING * travel.range);
        let open = open.map(|(_, travel)| {
            format!(
                "The cycle does not return to its start, but ends {} mm away.",
                format_trimmed(travel.end.abs() / MM)
            )
        });
        let jumps = speed_jumps(&self.axis().phases);
        let size = |[before, after]: &[Phase; 2]| (after.speed[0] - before.speed[1]).abs();
        let largest = jumps.iter().rev().max_by(|one, other| size(one).total_cmp(&size(other)));
        let starts_at_rest =
            self.case.entries.cycle.iter().flatten().any(PhaseEntry::starts_at_rest);
        let warning = largest.map(|[before, after]| {
            let feed = |speed: f64| format_trimmed(speed * self.machine.advance() * 60.0);
            let (from, to) = (feed(before.speed[1]), feed(after.speed[0]));
            let jumps = match jumps.len() {
                1 => format!("The speed jumps once in the cycle, from {from} to {to} m/min."),
                count => format!(
                    "The speed jumps {count} times in the cycle. The largest jump is from {from} to {to} m/min."
                ),
            };
            let hint = if starts_at_rest {
                " An entry with acceleration_m_s2 but without a speed starts at rest; give start_feed_m_min and end_feed_m_min for another start."
            } else {
                ""
            };
            format!(
                "{jumps} The acceleration torque of a jump is not included. To include it, replace the jump by a move or a ramp.{hint}"
            )
        });
        open.into_iter().chain(warning)
    }

    /// Returns a warning if a driven nut can excite its screw near the critical speed.
    fn resonance(&self) -> Option<String> {
        let (shaft, ratio) = (self.shaft()?, self.axis().nut_resonance_ratio()?);
        let critical = self.axis().fastest() / ratio;
        let speeds = self.axis().phases.iter().flat_map(|phase| phase.speed);
        let ratios = speeds.map(|speed| speed.abs() / critical);
        let near = ratios.into_iter().find(|ratio| RESONANCE_RATIOS.contains(ratio))?;
        Some(format!(
            "The driven nut turns at {near:.2} times the critical speed of its screw ({:.0} rpm) \
             and can excite the screw. Ask the manufacturer for a damper.",
            shaft.critical_speed() / RPM
        ))
    }

    /// Returns a warning if constrained thermal expansion compresses a screw between two fixed
    /// bearings and no rule checks the bearings.
    fn hindered_growth(&self) -> Option<String> {
        let tension = self.tension().filter(|tension| *tension < 0.0)?;
        self.machine.held.filter(|_| self.case.support_bearing_axial_load_N.is_none())?;
        let remedy = self.rise().map_or_else(String::new, |kelvin| {
            format!("; pretension_K = {} would keep it in tension", at_least(kelvin, 1))
        });
        Some(format!(
            "Constrained thermal expansion compresses the screw with a force of {:.1} kN{remedy}. \
             support_bearing_axial_load_N is not given, so no rule checks the support bearings.",
            -tension / 1e3
        ))
    }

    /// Returns notes on the uncertainty of the temperature rise and the assumptions behind it.
    fn about_heat(&self) -> Vec<String> {
        if self.powers().is_none() {
            let needs = self.machine.held.filter(|_| self.tension().is_none());
            let cold = "The load on the support bearings is calculated for the cold screw, because temperatures are unknown without friction.";
            return needs.map(|_| cold.to_owned()).into_iter().collect();
        }
        let mut notes = Vec::new();
        let band =
            self.heating.and_then(|heating| Some((heating.mean, heating.band?, heating.nodes?.0)));
        if let Some((mean, [low, high], [nut, screw, ..])) = band {
            let missing = self.powers().map(|powers| powers.missing.total());
            let usual = missing.filter(|heat| *heat > 0.0).map_or_else(String::new, |heat| {
                format!(
                    "; the upper end includes {heat:.0} W for typical values of the missing seal and support bearing torques"
                )
            });
            notes.push(format!(
                "The steady-state temperature rise of the screw is {mean:.0} K ({low:.0} to {high:.0} K{usual}; nut {nut:.0} K, screw along \
                 its travel {screw:.0} K). It is calculated with a thermal network whose conductances are estimated, and without the effect of the temperatures on the preload. To include this effect, set warm_state to true."
            ));
            if self.machine.groove.is_none() {
                let link = "The thermal conductance of the balls between nut and screw is estimated from the pitch circle diameter. The estimate is accurate to a factor of 2.";
                notes.push(link.to_owned());
            }
            if self.machine.stroke.is_none() {
                let what = "stroke_mm is not given, so the temperatures assume that the nut travels along the whole screw except for the overrun at both ends.";
                notes.push(what.to_owned());
            }
        }
        notes
    }

    /// Returns notes on the factors used for ratings and life.
    pub(super) fn about_life(&self) -> Vec<String> {
        let case = self.case;
        let mut notes = Vec::new();
        if let Some(grade) = self.grade()
            && case.rated_dynamic_load_N.is_some()
            && case.accuracy_factor.is_none()
        {
            notes
                .push(format!("rated_dynamic_load_N is used without an accuracy factor, because it is assumed to be the catalog value for grade {}.", grade.name));
        }
        let contaminated =
            case.contamination_factor.is_some() || case.entries.contamination.is_some();
        let lubricated = case.given().is_lubricated();
        notes.extend(match (&self.lubrication, self.modified_life(0)) {
            (Some(_), None) => {
                Some("The modified life is not calculated, because a viscosity ratio is below 0.1, which is outside the range of ISO 281.".to_owned())
            }
            (None, _) if contaminated => Some(
                "The modified life is not calculated, because viscosity and lubricant_temperature_C are not given."
                    .to_owned(),
            ),
            (None, _) if lubricated => {
                Some("The modified life is not calculated, because contamination is not given.".to_owned())
            }
            _ => None,
        });
        notes
    }

    /// Returns a description of each result that is incomplete because an input is missing.
    pub(super) fn not_given(&self) -> Vec<MissingInput> {
        let mut all = Vec::new();
        let mut lack = |numbers: &[&'static str], text: String| {
            all.extend(numbers.iter().map(|number| MissingInput { number, text: text.clone() }));
        };
        let drags = [InputKey::seal_torque_Nm, InputKey::support_bearing_torque_Nm];
        let drags: Vec<_> = drags.into_iter().filter(|key| self.case[*key].is_none()).collect();
        if !drags.is_empty() && self.mean_heat().is_some() {
            let names = drags.iter().map(|key| key.name()).collect::<Vec<_>>().join(" and ");
            let verb =
                if drags.len() == 1 { "is not given and is" } else { "are not given and are" };
            let text = format!("{names} {verb} assumed to be 0");
            let numbers = [
                "peak_motor_torque_Nm",
                "screw_torque_Nm",
                "mean_heat_W",
                "steady_temperature_rise_K",
            ];
            lack(&numbers, text);
        }
        if let Some(text) = self.undecided_load_factor() {
            lack(&["cycle_life_h"], text);
        }
        let plays = self.preload.is_none() && self.lost_motion().is_some();
        if plays && self.case.axial_play_um.is_none() {
            lack(
                &["lost_motion_um"],
                "axial_play_um is not given, so the lost motion does not include the axial play"
                    .to_owned(),
            );
        }
        if let Some(text) = self.case.cold_lubricant() {
            lack(&["screw_torque_Nm"], text);
        }
        all
    }

    /// If no load factor is given, returns a note on the life at the load factors that catalogs
    /// recommend.
    fn undecided_load_factor(&self) -> Option<String> {
        let (axis, case) = (self.axis(), self.case);
        let mut phases = case.entries.cycle.iter().flatten();
        let is_given =
            case.load_factor.is_some() || phases.any(|phase| phase.load_factor.is_some());
        let [low, high] = axis.advised_load_factors();
        if is_given || high <= 1.0 {
            return None;
        }
        let life = |load_factor| {
            let phases = axis.phases.iter().map(|phase| Phase { load_factor, ..*phase });
            self.life()?;
            Some(Axis { phases: phases.collect(), ..axis.clone() }.life()?.time / 3600.0)
        };
        let (long, short) = (life(low)?, life(high)?);
        if !(long.is_finite() && short.is_finite()) {
            return None;
        }
        Some(format!(
            "load_factor is not given and is assumed to be 1; catalogs recommend {low} to {high} at this speed, which gives lives of {} to {} h",
            format_digits(short, 3),
            format_digits(long, 3)
        ))
    }

    /// Returns a warning if the screw is safe against buckling only with the end conditions that
    /// are assumed by default for the section that may buckle.
    fn buckles_by_support(&self) -> Option<String> {
        let required = self.case.value_or_default(InputKey::required_buckling_safety)?;
        let (safety, of_support) =
            (self.axis().buckling_safety()?, self.axis().buckling_safety_of_support()?);
        let by_default = self.case.entries.buckling_support.is_none();
        (by_default && safety >= required && of_support < required).then(|| {
            format!(
                "The buckling safety factor of {safety:.2} is valid if a guided table clamps the nut (the default end \
                 condition); with the end conditions of the input support, it is {of_support:.2}. Set buckling_support to the actual end conditions."
            )
        })
    }

    /// Returns a note on the life for a stroke that is only a few nut lengths long.
    pub(super) fn short_stroke(&self) -> Option<String> {
        let stroke = self.machine.stroke?;
        let (lengths, factor) = SHORT_STROKE;
        if stroke < MIN_STROKE_TURNS * self.axis().screw.lead {
            return Some(
                "No fatigue life is calculated for a stroke of less than half a turn, because false brinelling limits the life."
                    .to_owned(),
            );
        }
        let circuits = self.case.value_or_default(InputKey::circuits_count)?;
        // While the nut moves by a distance, the balls advance along the thread by (1 − γ)/2 of
        // this distance.
        let round = self.machine.groove.as_ref().map(|(nut, _)| {
            2.0 * nut.turns / circuits * nut.lead / (1.0 - nut.dynamic_rating().gamma)
        });
        if let Some(round) = round.filter(|round| stroke < *round) {
            return Some(format!(
                "A stroke of less than {:.0} mm does not circulate the balls, so the same balls always carry the load. Make a stroke of two nut lengths every few thousand strokes (common recommendation).",
                round / MM
            ));
        }
        let life = self.life()?.time / 3600.0 / factor.powi(3);
        (stroke < lengths * self.machine.body.length).then(|| {
            format!(
                "The stroke is less than three nut lengths. HIWIN recommends a load factor of 3 to 5; with a load factor of {factor}, the life is {life:.0} h."
            )
        })
    }

    /// Returns notes on the results that the axis sheet omits without groove data, and on the
    /// uncertainty of the torque.
    pub(super) fn by_catalog(&self) -> Vec<String> {
        let by_catalog = contacts::takes_catalog_efficiency(self.case, self.settings);
        let at = self.heaviest().filter(|_| by_catalog).and_then(|heaviest| {
            let torque = heaviest.against_load()?;
            let drives = heaviest.point.load * heaviest.point.direction() < 0.0;
            let friction = contacts::by_catalog(self.case).friction(heaviest.ideal, drives);
            let frictions = contacts::usual_frictions(heaviest.ideal, drives);
            // Friction increases the torque if the drive moves the load, and reduces the torque if
            // the load drives the screw.
            let usual = frictions.map(|usual| if drives { friction - usual } else { usual - friction });
            let [one, other] = usual.map(|more| torque + more);
            let (low, high) = (one.min(other), one.max(other));
            // Without a lead, the torque is not known.
            torque.is_finite().then(|| format!(
                "The torque of {torque:.3} N m at the largest load during motion is calculated from the catalog efficiency; typical efficiencies give {low:.3} to {high:.3} N m."
            ))
        });
        let left_out = self.machine.groove.is_none().then(|| LEFT_OUT.to_owned());
        at.into_iter().chain(left_out).collect()
    }

    /// Returns a note on the uncertainty of the torque if friction is calculated from lubricant
    /// data.
    pub(super) fn uncertainty_note(&self) -> Option<String> {
        let heaviest = self.heaviest()?;
        let point = &heaviest.point;
        let work = &mut ModelWorkspace::default();
        let [low, high] = contacts::band(self.case, self.settings, point, work)?;
        let friction = heaviest.contacts.friction?;
        Some(format!(
            "Friction calculated from the lubricant: at an axial load of {:.0} N and a screw speed of {:.0} rpm, the friction torque of the contacts has a 90 % interval of {:.3} to {:.3} N m due to uncertain inputs; the calculated value is {friction:.3} N m.",
            point.load,
            point.friction_speed / RPM,
            low * friction,
            high * friction
        ))
    }

    /// Returns a note that states the drag torque to be measured when the preload is verified, and
    /// the tolerance of this torque.
    pub(super) fn to_measure(&self) -> Option<String> {
        let torque = self.preload.as_ref()?.by_rule;
        let seal = self.case.seal_torque_Nm.unwrap_or(0.0);
        Some(torque_to_measure(torque, seal, &self.torque_tolerance()))
    }
}
