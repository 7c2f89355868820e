//! Results for an axis: screw, bearings, life, stiffness and heat.

use std::cell::{OnceCell, RefCell};
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::f64::consts::TAU;

use bsm_design::life::{Duty, Life, life, pair_loads};
use bsm_design::motion::Phase;
use bsm_design::shaft::{PERMITTED_STRESS, Shaft, lost_motion, natural_frequency};
use bsm_design::{Axis, Grade, Mount, in_series};
use bsm_dyn::ModelWorkspace;

use super::StiffnessOrigin;
use super::contacts::{Contacts, contacts, nut_at, viscosity_ratio};
use super::drive::PowerLoss;
use super::heat::{Heating, Powers};
use super::lubrication::Lubrication;
use super::torques::{PhaseTorques, Preload, Torques};
use crate::case::axis::{AxisModel, FixedEnds};
use crate::case::axis_inputs::mount;
use crate::case::warm::{Warm, WarmState};
use crate::vocabulary::entries::{KappaBy, Named};
use crate::vocabulary::units::UM;
use crate::{Case, CaseError, InputKey, NutReport, OutputName, Settings, output};

/// Reason why the contacts of a lubricated screw have no friction.
const NO_SPEED: &str =
    "no torque: friction from the lubricant depends on the speed, which is not given";

/// Intermediate results from which the axis sheet is calculated.
pub(crate) struct AxisState<'a> {
    pub(super) case: &'a Case,
    pub(super) settings: &'a Settings,
    pub(super) machine: AxisModel,
    /// Nut with all its balls under the largest load. If there is no solution for the nut, `no_nut`
    /// contains the reason.
    pub(super) nut: Option<NutReport>,
    pub(super) no_nut: Option<CaseError>,
    pub(super) preload: Option<Preload>,
    pub(super) torques: Vec<PhaseTorques>,
    /// Life \[s\], calculated from the loads of all balls.
    pub(super) life_by_balls: Option<f64>,
    /// Effect of the load at standstill after a loss of motor power, calculated on demand.
    pub(super) power_loss: OnceCell<Option<PowerLoss>>,
    /// Steady-state temperatures, if friction and screw length are known.
    pub(super) heating: Option<Heating>,
    /// Warm steady state, if it is requested.
    pub(super) warm: Option<Warm>,
    /// Lubrication for the modified life, if lubricant and contamination are given.
    pub(super) lubrication: Option<Lubrication>,
    /// Cache of viscosity ratios from the film thickness. The key consists of the bit patterns of
    /// load and speed.
    by_film: RefCell<HashMap<[u64; 2], Option<f64>>>,
}

impl<'a> AxisState<'a> {
    pub(super) fn of(
        case: &'a Case,
        settings: &'a Settings,
        warm: Option<Warm>,
    ) -> Result<Self, CaseError> {
        let mut machine = AxisModel::of(case)?;
        // `travel` fails if the thread that stroke and nut require is longer than the unsupported
        // length.
        machine.travel(case)?;
        let (axis, advance) = (&machine.axis, machine.advance());
        let mut work = ModelWorkspace::default();
        let fastest = axis.fastest();
        // The balls of a preloaded nut carry loads even without an axial load.
        let pressed = axis.heaviest().filter(|phase| phase.load != 0.0 || case.is_preloaded());
        let pressed = pressed.filter(|_| machine.groove.is_some());
        let largest = pressed.map(|phase| {
            let speed = if phase.speed == 0.0 { fastest } else { phase.speed };
            (phase.load, speed)
        });
        let found = largest.map(|(load, speed)| nut_at(case, settings, load, speed));
        let (nut, no_nut) = match found {
            Some(Ok(nut)) => (Some(nut), None),
            Some(Err(why)) => (None, Some(why)),
            None => (None, None),
        };
        let preload = Preload::of(case, settings, &machine, nut.as_ref(), fastest)?;
        let drag = preload.as_ref().map_or(0.0, |preload| preload.drag_beyond_contacts);
        let warm_preload = preload.as_ref().map(|preload| preload.warm);
        // The case is copied for every moment of the cycle. The copies do not need the cycle, so it
        // is removed first.
        let mut of_a_moment = case.clone();
        of_a_moment.entries.cycle = None;
        // Contact friction depends only on load and speed, so it is calculated only once for
        // moments with equal load and speed.
        let mut solved: HashMap<[u64; 2], Contacts> = HashMap::new();
        let is_friction_known = case.has_speed() || !case.given().is_lubricated();
        let torque = |phase: &Phase| {
            PhaseTorques::of(phase, &machine.drive, warm_preload, |point| {
                let contacts = match solved.entry(at_bits(point.load, point.friction_speed)) {
                    Entry::Occupied(known) => known.get().clone(),
                    Entry::Vacant(first) if !is_friction_known => {
                        first.insert(Contacts::none(NO_SPEED.to_owned())).clone()
                    }
                    Entry::Vacant(first) => {
                        let found = contacts(&of_a_moment, settings, advance, point, &mut work)?;
                        first.insert(found).clone()
                    }
                };
                Ok(Torques::of(case, (advance, drag), point, contacts))
            })
        };
        let torques = axis.phases.iter().map(torque).collect::<Result<Vec<_>, _>>()?;
        let known = largest.zip(nut.as_ref());
        let life_by_balls = machine
            .groove
            .as_ref()
            .and_then(|_| life_by_balls(&of_a_moment, settings, axis, known));
        machine.axis.preload = warm_preload;
        let lubrication = Lubrication::of(case, &machine)?;
        let expansion = case.number(InputKey::thermal_expansion_um_m_K) * UM;
        let heating = match warm.as_ref().and_then(|warm| warm.state.as_ref()) {
            Some(state) => Heating::of_warm(case, &machine, state, expansion),
            None => Heating::of(case, settings, &machine, &torques, expansion)?,
        };
        let mut state = Self {
            case,
            settings,
            machine,
            nut,
            no_nut,
            preload,
            torques,
            life_by_balls,
            power_loss: OnceCell::new(),
            heating,
            warm,
            lubrication,
            by_film: RefCell::default(),
        };
        state.machine.axis.compression = -state.tension().unwrap_or(0.0).min(0.0);
        Ok(state)
    }

    pub(super) fn axis(&self) -> &Axis {
        &self.machine.axis
    }

    pub(super) fn warm_state(&self) -> Option<&WarmState> {
        self.warm.as_ref()?.state.as_ref()
    }

    pub(super) fn shaft(&self) -> Option<&Shaft> {
        self.machine.axis.shaft.as_ref()
    }

    /// Returns the life under the duty cycle.
    pub(super) fn life(&self) -> Option<Life> {
        self.machine.life()
    }

    /// Returns the data of a screw between two fixed bearings, if the screw is pretensioned.
    pub(super) fn pretension(&self) -> Option<FixedEnds> {
        self.machine.held.filter(|held| held.stretched > 0.0)
    }

    /// Returns the coefficient of thermal expansion of the screw \[1/K\].
    pub(super) fn expansion(&self) -> Option<f64> {
        Some(self.case.value_or_default(InputKey::thermal_expansion_um_m_K)? * UM)
    }

    /// Returns the temperature rise of the screw above the machine bed \[K\], which is either given
    /// or calculated from the steady state.
    pub(super) fn rise(&self) -> Option<f64> {
        self.given_rise().or(self.heating.map(|heating| heating.over_bed))
    }

    /// Returns the given temperature rise of the screw \[K\], or `None` if a warm state calculates
    /// it.
    fn given_rise(&self) -> Option<f64> {
        let given = self.case.screw_temperature_rise_K.filter(|rise| *rise != 0.0);
        given.filter(|_| self.warm.is_none())
    }

    /// Returns the tension of the screw \[N\], which is given, taken from the warm state, or
    /// calculated as the pretension that remains after the temperature rise.
    pub(super) fn tension(&self) -> Option<f64> {
        let by_rise = || Some(self.machine.held?.tension(self.rise()?));
        self.case.screw_tension_N.or_else(by_rise)
    }

    /// Returns an output of the nut under the largest load.
    pub(super) fn of_nut(&self, name: OutputName) -> Option<f64> {
        self.nut.as_ref()?.number(name)
    }

    /// Returns an output of the preloaded nut without external load.
    pub(super) fn of_unloaded_nut(&self, name: OutputName) -> Option<f64> {
        self.preload.as_ref()?.unloaded.as_ref()?.number(name)
    }

    /// Returns the static safety factor, which is the smaller of two values: one based on the
    /// static load rating, and one based on the most heavily loaded ball. If the manufacturer's
    /// rating is given, the second value is scaled to this rating.
    pub(super) fn static_safety(&self) -> f64 {
        let axis = self.axis();
        let given = self.machine.groove.as_ref().filter(|_| !self.case.has_estimated_groove());
        let of_balls = given.and_then(|(nut, _)| {
            let stated = axis.static_rating / nut.static_rating().rating;
            Some(self.of_nut(output!(static_safety_by_balls))? * stated)
        });
        axis.static_safety().min(of_balls.unwrap_or(f64::INFINITY))
    }

    /// Returns the modified life for the typical, smallest or largest contamination factor \[h\].
    pub(super) fn modified_life(&self, place: usize) -> Option<f64> {
        self.life()?;
        let Lubrication { fatigue_limit, contamination, .. } = self.lubrication.as_ref()?;
        let ratio = |speed, load| {
            let [by_film, by_viscosity] = self.viscosity_ratios(speed, load);
            by_film.or(by_viscosity).unwrap_or(f64::NAN)
        };
        let life = self.axis().modified_life(ratio, contamination[place] * fatigue_limit);
        life.map(|time| time / 3600.0)
    }

    /// Returns the two viscosity ratios, based on the film thickness and on the viscosity, if they
    /// are known and requested.
    ///
    /// * `speed`: speed of the screw relative to the nut \[rad/s\].
    /// * `load`: axial load of one nut \[N\].
    fn viscosity_ratios(&self, speed: f64, load: f64) -> [Option<f64>; 2] {
        let Some(Lubrication { viscosity, .. }) = self.lubrication else { return [None; 2] };
        let by_viscosity = Some(self.axis().viscosity_ratio(viscosity, speed));
        if self.case.entries.kappa_by == Some(Named(KappaBy::Viscosity)) {
            return [None, by_viscosity];
        }
        let by_film = || {
            let mut work = ModelWorkspace::default();
            viscosity_ratio(self.case, self.settings, (load, speed), &mut work)
        };
        let mut known = self.by_film.borrow_mut();
        let known = known.entry(at_bits(load.abs(), speed.abs()));
        [*known.or_insert_with(by_film), by_viscosity]
    }

    /// Returns the viscosity ratios for the more heavily loaded nut in a phase with motion.
    pub(super) fn viscosity_ratios_of(&self, phase: &Phase) -> [Option<f64>; 2] {
        if !phase.moves() {
            return [None; 2];
        }
        let load = phase.load_factor * phase.heavier_end().load;
        let preload = self.axis().preload;
        let load = preload.map_or(load, |preload| pair_loads(preload, load.abs()).0);
        self.viscosity_ratios(phase.mean_speed(), load)
    }

    pub(super) fn grade(&self) -> Option<&'static Grade> {
        Some(self.case.entries.accuracy_grade?.grade)
    }

    /// Returns the useful travel \[m\], for which the accuracy grade limits the travel error.
    pub(super) fn travel(&self) -> Option<f64> {
        self.machine.useful_travel(self.case)
    }

    /// Returns the load on the support bearings in the cold and in the warm state \[N\] (BB7). Each
    /// load is the sum of the largest axial load and the tensile or compressive force of a screw
    /// between two fixed bearings. The warm load is `None` if the temperature is unknown.
    pub(super) fn bearing_loads(&self) -> Option<[Option<f64>; 2]> {
        let held = self.machine.held?;
        let load = |tension: f64| tension.abs() + self.axis().largest_load();
        // F_b = max(|F_v(0)|, |F_v(ΔT)|) + |F|_max                        (BB7)
        Some([Some(load(held.tension(0.0))), self.tension().map(load)])
    }

    /// Returns the larger of the cold and warm loads of the support bearings \[N\].
    pub(super) fn bearing_load(&self) -> f64 {
        let loads = self.bearing_loads().into_iter().flatten().flatten();
        loads.fold(self.axis().largest_load(), f64::max)
    }

    /// Returns the mean power of each heat source over the cycle \[W\], or `None` if friction is
    /// unknown.
    pub(super) fn powers(&self) -> Option<Powers> {
        Powers::of(self.case, &self.machine, &self.torques)
    }

    /// Returns the temperature rise of a network node above the surroundings \[K\].
    pub(super) fn node_rise(&self, node: usize) -> Option<f64> {
        Some(self.heating?.nodes?.0[node])
    }

    /// Returns the steady-state temperature rise of the screw above its surroundings \[K\].
    pub(super) fn steady_rise(&self) -> Option<f64> {
        Some(self.heating?.mean)
    }

    /// Returns the thermal expansion of the screw \[µm\].
    pub(super) fn growth(&self) -> Option<f64> {
        if let Some(state) = self.warm_state() {
            return Some(state.growth / UM);
        }
        let left = self.machine.held.map_or(1.0, |held| held.shaft.growth_left(held.bearing));
        Some(left * self.free_growth()? / UM)
    }

    /// Returns the thermal expansion that the screw would have if its ends were free \[m\].
    pub(super) fn free_growth(&self) -> Option<f64> {
        match self.given_rise() {
            Some(rise) => Some(self.shaft()?.growth(self.expansion()?, rise)),
            None => Some(self.heating?.growth),
        }
    }

    /// Returns true if the catalog states a stiffness that cannot be used, because it applies to one
    /// nut under a load and the nut is preloaded.
    pub(super) fn has_unused_rigidity(&self) -> bool {
        self.case.rigidity_of_one_nut().is_some() && self.axis().preload.is_some()
    }

    /// Returns the stiffness of the nut under the largest load \[N/µm\].
    pub(super) fn nut_stiffness(&self) -> Option<f64> {
        Some(self.nut_stiffness_and_origin()?.0)
    }

    /// Returns whether the stiffness of the nut is calculated or follows from the catalog.
    pub(super) fn stiffness_origin(&self) -> Option<StiffnessOrigin> {
        Some(self.nut_stiffness_and_origin()?.1)
    }

    /// Returns the stiffness of the nut under the largest load \[N/µm\], calculated from all balls
    /// or taken from the catalog.
    fn nut_stiffness_and_origin(&self) -> Option<(f64, StiffnessOrigin)> {
        let axis = self.axis();
        let by_catalog = || {
            let stated = self.case.rated_rigidity_N_um?;
            let Named(at) = self.case.entries.rated_rigidity_at?;
            let rating = self.machine.ratings.dynamic;
            let stiffness = at.stiffness(stated, axis.largest_load(), axis.preload, rating);
            Some((stiffness?, StiffnessOrigin::Catalog))
        };
        let calculated = || {
            let stiffness = self.of_nut(output!(nut_stiffness_N_um))?;
            Some((stiffness, StiffnessOrigin::Calculated))
        };
        // A catalog stiffness is more accurate than the stiffness of an estimated groove.
        match (&self.machine.groove, self.case.has_estimated_groove()) {
            (Some(_), false) => calculated(),
            (Some(_), true) => by_catalog().or_else(calculated),
            (None, _) => by_catalog(),
        }
    }

    /// Returns the stiffness of screw, nut, bearings and housings in series \[N/m\].
    pub(super) fn stiffness(&self) -> Option<f64> {
        let Case { support_bearing_stiffness_N_um, housing_stiffness_N_um, .. } = self.case;
        // Two fixed bearings share the load equally if the nut is in the middle.
        let bearings = if self.machine.held.is_some() { 2.0 } else { 1.0 };
        let bearings = support_bearing_stiffness_N_um.map(|each| bearings * each);
        let others = [bearings, *housing_stiffness_N_um].into_iter().flatten();
        let (screw, nut) = (self.shaft()?.least_stiffness(), self.nut_stiffness()? / UM);
        Some(others.map(|stiffness| stiffness / UM).fold(in_series(screw, nut), in_series))
    }

    /// Returns the axial stiffness due to the torsion of the screw \[N/m\] (BB9).
    pub(super) fn torsional_stiffness(&self) -> Option<f64> {
        let poisson = self.case.value_or_default(InputKey::poisson_ratio)?;
        Some(self.shaft()?.torsional_stiffness(self.machine.advance(), poisson))
    }

    /// Returns the natural frequency of an axis with the given stiffness and with the moving mass
    /// per screw \[Hz\], or `None` without a moving mass.
    pub(super) fn natural_frequency(&self, stiffness: f64) -> Option<f64> {
        let mass = Some(self.machine.drive.mass).filter(|mass| *mass > 0.0)?;
        Some(natural_frequency(stiffness, mass))
    }

    /// Returns the number of revolutions per cycle, added up over both directions.
    pub(super) fn revolutions_per_cycle(&self) -> Option<f64> {
        Some(self.machine.cycle?.1.distance / self.axis().screw.lead)
    }

    /// Returns the required life in revolutions.
    pub(super) fn required_revolutions(&self) -> Option<f64> {
        let (lead, mean_speed) = (self.axis().screw.lead, self.axis().mean_speed());
        Some(self.machine.required_life?.revolutions(lead, mean_speed))
    }

    /// Returns the dynamic load rating \[N\] that is necessary for the required life. The rating
    /// includes its modifying factors.
    pub(super) fn required_rating(&self) -> Option<f64> {
        let share = self.required_revolutions()? / self.life()?.revolutions;
        Some(self.axis().dynamic_rating * share.cbrt())
    }

    /// Returns the required dynamic load rating in the form in which manufacturers state it \[N\]:
    /// for the travel of `rating_basis`, and without modifying factors.
    pub(super) fn required_rating_in_basis(&self) -> Option<f64> {
        let Named(basis) = self.case.entries.rating_basis?;
        let factors = self.axis().dynamic_rating / self.machine.ratings.dynamic;
        Some(self.required_rating()? / factors / basis.factor(self.axis().screw.lead))
    }

    /// Returns the axial load at which the core reaches the permitted stress \[N\] (Z3). This load
    /// does not depend on the length.
    pub(super) fn yield_load(&self) -> Option<f64> {
        let bar = Mount { length: Some(1.0), ..mount(self.case) };
        Some(bar.shaft(&self.axis().screw, 0.0, None)?.yield_load(PERMITTED_STRESS))
    }

    /// Returns the lost motion on reversal \[m\]: elastic deflection plus the axial play of a nut
    /// without preload (Z6).
    pub(super) fn lost_motion(&self) -> Option<f64> {
        let given = self.case.axial_play_um.filter(|_| self.preload.is_none());
        let play = given.map(|play| play * UM);
        let friction = self.machine.carriage.guide_friction();
        if friction > 0.0 {
            return Some(lost_motion(friction, self.stiffness()?) + play.unwrap_or(0.0));
        }
        play
    }

    /// Returns the phase with motion that has the largest load.
    pub(super) fn heaviest_phase(&self) -> Option<&PhaseTorques> {
        let moving = self.torques.iter().filter(|torques| torques.phase.moves());
        moving.reduce(|one, other| {
            let [a, b] = [one, other].map(|torques| torques.heavier().point);
            if a.heavier(b) == a { one } else { other }
        })
    }

    /// Returns the torques at the largest load during motion.
    pub(super) fn heaviest(&self) -> Option<&Torques> {
        self.heaviest_phase().map(PhaseTorques::heavier)
    }

    /// Returns the largest screw torque that occurs at the largest load \[N·m\]. All starts and
    /// ends of phases with motion that have this load are considered. The torque is positive if it
    /// acts against the load.
    pub(super) fn torque_at_largest_load(&self) -> Option<f64> {
        let largest = self.heaviest()?.point;
        let moving = self.torques.iter().filter(|torques| torques.phase.moves());
        let ends = moving.flat_map(|torques| &torques.ends);
        let torques = ends.filter(|end| end.point.has_load_of(&largest)).map(Torques::against_load);
        let torques = torques.collect::<Option<Vec<_>>>()?;
        torques.into_iter().max_by(|a, b| a.abs().total_cmp(&b.abs()))
    }

    /// Returns the time average of a quantity over the cycle.
    pub(super) fn mean(&self, of: impl Fn(&PhaseTorques) -> Option<f64>) -> Option<f64> {
        self.torques.iter().map(|torques| Some(torques.phase.time * of(torques)?)).sum()
    }

    /// Returns the mean heat generation of contacts, preload drag, seals and support bearings over
    /// the cycle \[W\].
    pub(super) fn mean_heat(&self) -> Option<f64> {
        self.mean(|torques| Some(torques.means?.heat))
    }
}

/// Calculates the life under the duty cycle from the loads of all balls \[s\]. Linear damage
/// accumulation is assumed: each phase consumes a fraction of the life that the nut would have if
/// it ran permanently under the conditions of this phase.
///
/// * `known`: a nut that is already solved, with its load \[N\] and speed \[rad/s\].
fn life_by_balls(
    case: &Case,
    settings: &Settings,
    axis: &Axis,
    known: Option<((f64, f64), &NutReport)>,
) -> Option<f64> {
    let revolutions = |load: f64, speed: f64| -> Option<f64> {
        let is_known =
            |(point, _): &((f64, f64), _)| at_bits(point.0, point.1) == at_bits(load, speed);
        let solved;
        let nut = if let Some((_, nut)) = known.filter(is_known) {
            nut
        } else {
            solved = nut_at(case, settings, load, speed).ok()?;
            &solved
        };
        let ours = nut.number(output!(life_by_balls_revolutions))?;
        let rated = nut.number(output!(iso_life_revolutions))?;
        // The ball model contributes only the ratio of two lives: the life calculated from the
        // loads of all balls, and the life according to ISO 3408-5. The load rating itself may come
        // from the manufacturer.
        let preload = nut.number(output!(warm_preload_N)).filter(|_| case.is_preloaded());
        let duty = Duty { load, speed: 1.0, time: 1.0 };
        let stated = life(axis.dynamic_rating, preload, &[duty])?.revolutions;
        Some(stated * ours / rated)
    };
    let (mut taken, mut time) = (0.0, 0.0);
    let mut lives = HashMap::new();
    for Duty { load, speed, time: part } in axis.duty() {
        time += part;
        let moves = speed != 0.0 && (load != 0.0 || case.is_preloaded());
        if moves {
            let life = lives.entry(at_bits(load, speed));
            let life = (*life.or_insert_with(|| revolutions(load, speed)))?;
            let turns = speed.abs() * part / TAU;
            taken += turns / life;
        }
    }
    (taken > 0.0).then(|| time / taken)
}

/// Returns a map key that consists of the bit patterns of load and speed. Phases with the same key
/// have equal ball loads and friction.
fn at_bits(load: f64, speed: f64) -> [u64; 2] {
    [load, speed].map(f64::to_bits)
}
