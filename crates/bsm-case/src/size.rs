//! The axis around a screw: loads of its cycle, torque, and every rule with its value, limit and source.

mod axis;
mod contacts;
mod cycle;
mod rules;

use std::f64::consts::TAU;

use bsm_design::{
    Axis, Motion, Nut, Pace, Phase, drag_torque, in_series, life, lost_motion, root_mean_square,
    steady_rise,
};
use bsm_dyn::ModelWorkspace;
use serde_json::{Map, Value, json};

use self::axis::Machine;
pub(crate) use self::axis::{carriage, motions, mount, reliability};
use self::contacts::{Contacts, contacts, is_preloaded, nut_at};
pub use self::cycle::{PhaseWords, decimal_number};
pub use self::rules::SizeRule;
use crate::nut::preload_note;
use crate::quantity::{Whole, quantities};
use crate::scene::RISES;
use crate::units::{DEG, MM, RPM, UM};
use crate::{
    AnalysisKind, CapacityReport, CaseError, InputKey, Numbers, NutReport, Output, Scene, Settings,
    capacity,
};

/// What an axis is sized from: its nut, and a load and a speed or a cycle.
pub(crate) const NEEDS: crate::problem::Needs = capacity::NEEDS;

quantities! { Size;
    "the cycle" {
        largest_load_N ["N"] Whole, "largest axial load of the screw";
        largest_speed_rpm ["rpm"] Whole, "largest speed of the screw";
        largest_feed_m_min ["m/min"] Whole, "largest feed";
        equivalent_load_N ["N"] Whole, "load that takes the same life if it stays; of a pair, that of the busier nut";
        equivalent_speed_rpm ["rpm"] Whole, "mean speed";
    }
    "screw and bearings" {
        screw_length_between_bearings_mm ["mm"] Whole, "unsupported length";
        bending_diameter_mm ["mm"] Whole, "diameter that bends and strains";
        critical_speed_rpm ["rpm"] Whole, "critical speed";
        critical_speed_ratio [""] Whole, "largest speed over the critical one";
        buckling_load_N ["N"] Whole, "buckling load";
        buckling_safety [""] Whole, "buckling load over the largest load";
        yield_load_N ["N"] Whole, "load that strains the core to 147 N/mm2";
        cycle_speed_number_mm_min ["mm/min"] Whole, "largest speed number";
        screw_mass_kg ["kg"] Whole, "mass of the screw between its bearings";
        steady_temperature_rise_K ["K"] Whole needs [axis_heat_transfer_W_K], "rise of temperature at which the axis gives away its mean heat";
        screw_growth_um ["um"] Whole, "growth of the screw between its bearings, warmer by screw_temperature_rise_K or the steady rise";
        travel_variation_300_um ["um"] Whole, "permitted variation of travel within any 300 mm, of accuracy_grade";
    }
    "nut and life" {
        static_safety_factor [""] Whole, "static safety by the rating and by the most loaded ball, the smaller one";
        cycle_life_revolutions [""] Whole, "life of the cycle by ISO 3408-5";
        cycle_life_h ["h"] Whole, "life of the cycle by ISO 3408-5";
        cycle_life_by_balls_h ["h"] Whole, "life of the cycle by the loads of all balls";
        opening_load_N ["N"] Whole, "load at which the preload is lost";
    }
    "rigidity" {
        screw_rigidity_N_um ["N/um"] Whole, "rigidity of the screw where it is least";
        nut_rigidity_N_um ["N/um"] Whole, "tangent rigidity of the nut at the largest load, all balls";
        axis_rigidity_N_um ["N/um"] Whole, "rigidity of screw, nut, bearings and housings in series";
        lost_motion_um ["um"] Whole, "elastic lost motion where the friction of the guides turns round";
    }
    "drive" {
        peak_motor_torque_Nm ["N m"] Whole needs [friction_coefficient | lubricant_temperature_C], "largest torque of the motor";
        rms_motor_torque_Nm ["N m"] Whole needs [friction_coefficient | lubricant_temperature_C], "root of the mean square of the torque of the motor";
        peak_motor_power_W ["W"] Whole needs [friction_coefficient | lubricant_temperature_C], "largest power of the motor";
        mean_heat_W ["W"] Whole needs [friction_coefficient | lubricant_temperature_C], "mean heat of nut, seals and support bearings";
        preload_drag_Nm ["N m"] Whole, "drag of the preload by the rule of makers";
        screw_efficiency [""] Whole needs [friction_coefficient | lubricant_temperature_C], "efficiency of the screw at the largest load that moves, with preload, seals and support bearings";
        contact_drag_Nm ["N m"] Whole needs [friction_coefficient | lubricant_temperature_C], "drag of the preload by its contacts alone";
        holding_torque_Nm ["N m"] Whole needs [friction_coefficient | lubricant_temperature_C], "torque on the screw that keeps the load from driving it, contacts alone";
        inertia_of_screw_kg_m2 ["kg m2"] Whole, "moment of inertia of the screw";
        inertia_of_mass_kg_m2 ["kg m2"] Whole, "moment of inertia of the moved mass at the screw";
        inertia_at_motor_kg_m2 ["kg m2"] Whole, "moment of inertia of the load at the motor";
        inertia_ratio [""] Whole, "moment of inertia of the load at the motor over that of the motor";
    }
}

/// The parts of the torque in a phase, and what follows.
#[derive(Debug, Clone, PartialEq)]
pub struct SizePhase {
    /// Name, unit and value of each.
    pub numbers: Vec<(&'static str, &'static str, Option<f64>)>,
    /// The model of the contacts.
    pub contacts: String,
}

impl SizePhase {
    /// A number by name.
    pub fn number(&self, name: &str) -> Option<f64> {
        self.numbers.iter().find(|(own, ..)| *own == name).and_then(|(.., value)| *value)
    }

    /// JSON object.
    pub fn to_json(&self) -> Value {
        let entry = |(name, _, value): &(&'static str, &'static str, Option<f64>)| {
            ((*name).to_owned(), json!(value))
        };
        let mut map: Map<_, _> = self.numbers.iter().map(entry).collect();
        map.insert("contacts".to_owned(), json!(self.contacts));
        Value::Object(map)
    }
}

/// An axis: its numbers, its rules, its cycle.
#[derive(Debug, Clone, PartialEq)]
pub struct SizeReport {
    /// What was asked.
    pub scene: Scene,
    /// The numbers.
    pub numbers: Numbers,
    /// Each rule, in the order of the sheet.
    pub rules: Vec<SizeRule>,
    /// Each phase of the cycle.
    pub phases: Vec<SizePhase>,
    /// The screw and its nut: name, unit and value, given or by rule.
    pub sizes: Vec<(&'static str, &'static str, f64)>,
    /// What was taken where nothing was given.
    pub notes: Vec<String>,
    /// What an engineer should know before using the numbers.
    pub warnings: Vec<String>,
}

/// The numbers of a sheet that tell nuts apart, in tables of them.
pub fn sheet_columns() -> impl Iterator<Item = &'static Output> + Clone {
    const NAMES: [&str; 10] = [
        "cycle_life_h",
        "critical_speed_ratio",
        "buckling_safety",
        "static_safety_factor",
        "axis_rigidity_N_um",
        "peak_motor_torque_Nm",
        "screw_efficiency",
        "mean_heat_W",
        "screw_mass_kg",
        "inertia_of_screw_kg_m2",
    ];
    NAMES.into_iter().filter_map(|name| {
        QUANTITIES.iter().flat_map(|quantity| quantity.columns).find(|column| column.name == name)
    })
}

/// What the torque of an axis leaves out.
pub const NOT_MODELLED: [&str; 6] = [
    "lubricant, unless its inputs are given: contacts are dry then, with one friction coefficient; the drag of the preload is that of makers' rule, which holds to some 50 %",
    "returns of the balls and balls that touch each other: only in makers' rule for the drag",
    "temperatures of nut, screw and balls: their rises are inputs, which the preload follows; axis_heat_transfer_W_K gives the growth of the screw alone",
    "vibration of the axis, its control, and shocks: multiply the loads by the factor of your machine",
    "bending of the screw by its weight, and of the frame; misalignment unless it is given",
    "brackets of motor and bearings beyond housing_rigidity_N_um",
];

/// The torque of a phase.
struct Torques {
    phase: Phase,
    ideal: f64,
    contacts: Contacts,
    /// Of returns and lubricant, beyond the contacts of the preload, with its sign.
    drag: f64,
    seal: f64,
    bearing: f64,
}

impl Torques {
    /// * `advance`: for a radian of the screw \[m\]. * `drag`: of the preload beyond its contacts \[N·m\].
    fn of(
        scene: &Scene,
        settings: &Settings,
        (advance, drag): (f64, f64),
        phase: &Phase,
        work: &mut ModelWorkspace,
    ) -> Result<Self, CaseError> {
        let moves = f64::from(u8::from(phase.speed != 0.0));
        let value = |key| moves * scene.value_or_default(key).unwrap_or(0.0);
        Ok(Self {
            phase: *phase,
            ideal: advance * phase.load,
            contacts: contacts(scene, settings, advance, phase, work)?,
            drag: moves * drag,
            seal: value(InputKey::seal_torque_Nm),
            bearing: value(InputKey::support_bearing_torque_Nm),
        })
    }

    /// What acts against the motion, without its sign \[N·m\].
    fn friction(&self) -> Option<f64> {
        Some(self.contacts.friction? + self.drag + self.seal + self.bearing)
    }

    /// Torque that the screw takes \[N·m\].
    fn at_screw(&self) -> Option<f64> {
        let way = if self.phase.speed == 0.0 { 0.0 } else { self.phase.speed.signum() };
        Some(self.ideal + way * self.friction()?)
    }

    fn heat(&self) -> Option<f64> {
        Some(self.friction()? * self.phase.speed.abs())
    }

    /// Power out over power in, of the screw with all its parts; `None` if nothing is done.
    fn efficiency(&self) -> Option<f64> {
        let output = self.ideal * self.phase.speed;
        let input = self.at_screw()? * self.phase.speed;
        let efficiency = if output > 0.0 { output / input } else { input / output };
        (output != 0.0).then_some(efficiency)
    }

    /// The torque on the screw by its parts, and what follows.
    fn parts(&self) -> Vec<(&'static str, &'static str, Option<f64>)> {
        vec![
            ("ideal_torque_Nm", "N m", Some(self.ideal)),
            ("contact_friction_torque_Nm", "N m", self.contacts.friction),
            ("preload_drag_beyond_contacts_Nm", "N m", Some(self.drag)),
            ("seal_torque_Nm", "N m", Some(self.seal)),
            ("support_bearing_torque_Nm", "N m", Some(self.bearing)),
            ("whole_screw_torque_Nm", "N m", self.at_screw()),
            ("screw_efficiency", "", self.efficiency()),
        ]
    }
}

/// The preload of a nut, and its drag on the screw \[N·m\].
struct Preload {
    /// As it is set, at no rise of temperature \[N\].
    cold: f64,
    /// With the rises of temperature \[N\].
    warm: f64,
    /// By the rule of makers.
    by_rule: f64,
    /// Of its contacts alone; `None` without friction.
    of_contacts: Option<f64>,
}

impl Preload {
    /// That of a nut, if it is preloaded, at a speed \[rad/s\].
    fn of(
        scene: &Scene,
        settings: &Settings,
        axis: &Axis,
        nut: &NutReport,
        speed: f64,
    ) -> Result<Option<Self>, CaseError> {
        let forces = nut.number("preload_set_N").zip(nut.number("warm_preload_N"));
        let Some((cold, warm)) = forces.filter(|_| is_preloaded(scene)) else { return Ok(None) };
        let of_contacts = if speed > 0.0 && scene.given().has_friction() {
            let unloaded = nut_at(scene, settings, 0.0, speed)?;
            unloaded.number("friction_heat_W").map(|heat| heat / speed)
        } else {
            None
        };
        let by_rule = drag_torque(warm, axis.nut.lead, axis.nut.lead_angle());
        Ok(Some(Self { cold, warm, by_rule, of_contacts }))
    }

    /// Drag of returns and lubricant, beyond the contacts.
    fn beyond(&self) -> f64 {
        (self.by_rule - self.of_contacts.unwrap_or(0.0)).max(0.0)
    }
}

/// The torque of the whole screw at the operating point of its scene by its parts, where it has more than the contacts
/// of its balls: weight and guides of what it moves, preload, seals, support bearings. `None` where there are none.
///
/// # Errors
///
/// [`CaseError`] if the nut or its point has no solution.
pub fn torque_parts(scene: &Scene, settings: &Settings) -> Result<Option<SizePhase>, CaseError> {
    let given = |key: InputKey| scene[key].is_some_and(|value| value != 0.0);
    let preloaded = is_preloaded(scene) && NEEDS.are_met(scene.given());
    let more =
        [InputKey::moved_mass_kg, InputKey::seal_torque_Nm, InputKey::support_bearing_torque_Nm];
    let point = scene.speeds_rpm().zip(scene.axial_load_N).zip(scene.lead());
    let (true, Some((((screw, turned), force), lead)), true) =
        (preloaded || more.into_iter().any(given), point, scene.given().has_friction())
    else {
        return Ok(None);
    };
    let pace = Pace::Turns((screw - turned) * RPM);
    let motion = Motion { time: 1.0, force, pace, acceleration: 0.0 };
    let phase = motion.phase(&carriage(scene), lead * MM);
    let drag = if preloaded {
        let axis = Machine::of(scene)?.axis;
        let nut = nut_at(scene, settings, phase.load, phase.speed)?;
        let preload = Preload::of(scene, settings, &axis, &nut, phase.speed.abs())?;
        preload.map_or(0.0, |preload| preload.beyond())
    } else {
        0.0
    };
    let (advance, work) = (lead * MM / TAU, &mut ModelWorkspace::default());
    let torques = Torques::of(scene, settings, (advance, drag), &phase, work)?;
    let load = ("screw_load_N", "N", Some(phase.load));
    let numbers = std::iter::once(load).chain(torques.parts()).collect();
    Ok(Some(SizePhase { numbers, contacts: torques.contacts.words }))
}

/// Efficiency of the whole screw in a phase for a search over screws, which has no time for all balls of a preloaded
/// nut: one ball under its equal share, and the drag of the preload by the rule of makers.
///
/// * `nut`: that of the scene.
pub(crate) fn quick_efficiency(
    scene: &Scene,
    settings: &Settings,
    nut: &Nut,
    phase: &Phase,
    work: &mut ModelWorkspace,
) -> Option<f64> {
    let preload = scene.preload_N.unwrap_or(0.0);
    let single = Scene { preload_N: None, ..scene.clone() };
    let drag = drag_torque(preload, nut.lead, nut.lead_angle());
    let torques = Torques::of(&single, settings, (nut.lead / TAU, drag), phase, work).ok()?;
    torques.efficiency()
}

impl SizeReport {
    /// The axis of a scene.
    ///
    /// * `settings`: the model that friction is calculated with.
    ///
    /// # Errors
    ///
    /// [`CaseError`] if an input is missing or breaks its rule.
    pub fn of(scene: &Scene, settings: &Settings) -> Result<Self, CaseError> {
        let worked = Worked::of(scene, settings)?;
        let of_nut = CapacityReport::of(&at_largest(scene, &worked.machine.axis), None)?;
        let mut warnings = of_nut.warnings().to_vec();
        warnings.extend(worked.nut.as_ref().map(NutReport::warnings).unwrap_or_default());
        if let Some(why @ CaseError::Nut(_)) = &worked.no_nut {
            warnings.push(format!("{}; the rules of the preload are not judged", no_balls(why)));
        }
        warnings.sort();
        warnings.dedup();
        let (machine, numbers) = (&worked.machine, worked.numbers());
        let preload = worked.preload.as_ref();
        Ok(Self {
            scene: scene.clone(),
            rules: rules::rules(scene, &machine.axis, &numbers, &of_nut, preload),
            phases: worked.torques.iter().map(|torques| worked.phase_numbers(torques)).collect(),
            sizes: sizes(scene, machine, &of_nut, preload),
            notes: worked.notes().into_iter().chain(worked.how_sure(settings)).collect(),
            warnings,
            numbers,
        })
    }

    /// True if every rule holds.
    pub fn passes(&self) -> bool {
        self.rules.iter().all(SizeRule::passes)
    }

    /// A number by name.
    pub fn number(&self, name: &str) -> Option<f64> {
        self.numbers.number(name)
    }

    /// JSON object of requirement, screw, numbers, rules and cycle.
    pub fn to_json(&self) -> Value {
        let numbers: Map<_, _> = self
            .numbers
            .entries()
            .map(|(column, value)| (column.name.to_owned(), json!(value)))
            .collect();
        let sizes: Map<_, _> =
            self.sizes.iter().map(|(name, _, value)| ((*name).to_owned(), json!(value))).collect();
        json!({
            "passes": self.passes(),
            "inputs": self.scene.to_json(),
            "screw": sizes,
            "results": numbers,
            "rules": self.rules.iter().map(SizeRule::to_json).collect::<Vec<_>>(),
            "phases": self.phases.iter().map(SizePhase::to_json).collect::<Vec<_>>(),
            "not_modelled": NOT_MODELLED,
            "notes": self.notes,
            "warnings": self.warnings,
        })
    }

    /// Points of the speed-force diagram: for a speed \[rpm\] the load that gives the required life \[N\].
    pub fn load_of_life(&self, rpm: f64) -> Option<f64> {
        let hours = self.scene.required_life_h?;
        let rating = self.sizes.iter().find(|(name, ..)| *name == "dynamic_load_rating_N")?.2;
        Some(rating * (1e6 / (60.0 * rpm * hours)).cbrt())
    }
}

/// Why there are no numbers of the nut with all its balls.
fn no_balls(why: &CaseError) -> String {
    format!("no numbers of all balls: {why}")
}

/// What the numbers of an axis are made from.
struct Worked<'a> {
    scene: &'a Scene,
    machine: Machine,
    /// The nut under the largest load, with all its balls; or why there is none.
    nut: Option<NutReport>,
    no_nut: Option<CaseError>,
    preload: Option<Preload>,
    torques: Vec<Torques>,
    holding: Option<f64>,
    /// Life by the loads of all balls \[s\].
    life_by_balls: Option<f64>,
}

/// Takes a number of the axis.
type Put<'a> = &'a mut dyn FnMut(Whole, Option<f64>);

impl<'a> Worked<'a> {
    fn of(scene: &'a Scene, settings: &Settings) -> Result<Self, CaseError> {
        let mut machine = Machine::of(scene)?;
        let (axis, advance) = (&machine.axis, machine.advance());
        let mut work = ModelWorkspace::default();
        let heaviest = axis.heaviest().filter(|phase| phase.load != 0.0).copied();
        let fastest = axis.fastest();
        let found = heaviest.map(|phase| {
            let speed = if phase.speed == 0.0 { fastest } else { phase.speed };
            nut_at(scene, settings, phase.load, speed)
        });
        let (nut, no_nut) = match found {
            Some(Ok(nut)) => (Some(nut), None),
            Some(Err(why)) => (None, Some(why)),
            None => (None, None),
        };
        let preload = match &nut {
            Some(nut) => Preload::of(scene, settings, axis, nut, fastest)?,
            None => None,
        };
        let drag = preload.as_ref().map_or(0.0, Preload::beyond);
        let torque =
            |phase: &Phase| Torques::of(scene, settings, (advance, drag), phase, &mut work);
        let torques = axis.phases.iter().map(torque).collect::<Result<_, _>>()?;
        // The load drives: its sign against the speed.
        let back =
            heaviest.map(|phase| Phase { speed: -phase.load.signum() * fastest.max(RPM), ..phase });
        let back = back.map(|back| contacts(scene, settings, advance, &back, &mut work));
        let holding = back
            .transpose()?
            .and_then(|found| Some((advance * axis.largest_load() - found.friction?).max(0.0)));
        let life_by_balls = life_by_balls(scene, settings, axis);
        machine.axis.preload = preload.as_ref().map(|preload| preload.warm);
        Ok(Self { scene, machine, nut, no_nut, preload, torques, holding, life_by_balls })
    }

    fn numbers(&self) -> Numbers {
        let mut numbers = Numbers::new(AnalysisKind::Size);
        let mut put = |place: Whole, value: Option<f64>| {
            numbers.whole(place, value.filter(|value| value.is_finite()));
        };
        self.of_life(&mut put);
        self.of_screw(&mut put);
        self.of_drive(&mut put);
        numbers
    }

    /// A number of the nut under the largest load.
    fn of_nut(&self, name: &str) -> Option<f64> {
        self.nut.as_ref()?.number(name)
    }

    /// The cycle, and what the nut lasts under it.
    fn of_life(&self, put: Put<'_>) {
        let axis = &self.machine.axis;
        let (largest, fastest, lived) = (axis.largest_load(), axis.fastest(), axis.life());
        put(largest_load_N, Some(largest));
        put(largest_speed_rpm, Some(fastest / RPM));
        put(largest_feed_m_min, Some(fastest * self.machine.advance() * 60.0));
        put(equivalent_load_N, lived.map(|life| life.mean_load));
        put(equivalent_speed_rpm, lived.map(|life| life.mean_speed / RPM));
        put(cycle_life_revolutions, lived.map(|life| life.revolutions));
        put(cycle_life_h, lived.map(|life| life.time / 3600.0));
        put(cycle_life_by_balls_h, self.life_by_balls.map(|time| axis.reliability * time / 3600.0));
        // By the rating of the maker too, which is of the same ball.
        let stated = axis.static_rating.rating / axis.nut.static_rating().rating;
        let of_balls = self.of_nut("static_safety").map_or(f64::INFINITY, |safety| safety * stated);
        put(static_safety_factor, Some(axis.static_safety().min(of_balls)));
        put(opening_load_N, self.of_nut("limit_load_N"));
    }

    /// The screw between its bearings, and the rigidity of the axis.
    fn of_screw(&self, put: Put<'_>) {
        let Self { scene, machine, .. } = self;
        let axis = &machine.axis;
        put(cycle_speed_number_mm_min, Some(axis.speed_number() / (MM * RPM)));
        let grade = scene.nut.accuracy_grade.map(|grade| grade.grade);
        put(travel_variation_300_um, grade.map(|grade| grade.variation / UM));
        let nut_stiffness = self.of_nut("nut_stiffness_N_um");
        put(nut_rigidity_N_um, nut_stiffness);
        let Some(shaft) = &axis.shaft else { return };
        put(screw_length_between_bearings_mm, Some(shaft.length / MM));
        put(bending_diameter_mm, Some(shaft.diameter / MM));
        put(critical_speed_rpm, Some(shaft.critical_speed() / RPM));
        put(critical_speed_ratio, axis.critical_speed_ratio());
        put(buckling_load_N, Some(shaft.buckling_load()));
        put(buckling_safety, axis.buckling_safety());
        put(yield_load_N, axis.yield_load());
        put(screw_mass_kg, machine.screw.map(|(mass, _)| mass));
        let transfer = scene.axis_heat_transfer_W_K;
        let steady = self.mean_heat().zip(transfer).map(|(heat, by)| steady_rise(heat, by));
        put(steady_temperature_rise_K, steady);
        let rise = scene.screw_temperature_rise_K.filter(|rise| *rise != 0.0).or(steady);
        let expansion = scene.value_or_default(InputKey::thermal_expansion_um_m_K);
        let growth = rise.zip(expansion).map(|(rise, by)| shaft.growth(by * UM, rise) / UM);
        put(screw_growth_um, growth);
        put(screw_rigidity_N_um, Some(shaft.least_stiffness() * UM));
        let Some(nut_stiffness) = nut_stiffness else { return };
        let others = [scene.support_bearing_rigidity_N_um, scene.housing_rigidity_N_um];
        let springs = others.into_iter().flatten().map(|rigidity| rigidity / UM);
        let stiffness =
            springs.fold(in_series(shaft.least_stiffness(), nut_stiffness / UM), in_series);
        put(axis_rigidity_N_um, Some(stiffness * UM));
        let friction = Some(machine.carriage.guide_friction()).filter(|friction| *friction > 0.0);
        put(lost_motion_um, friction.map(|friction| lost_motion(friction, stiffness) / UM));
    }

    /// Torque, power, heat and inertia.
    fn of_drive(&self, put: Put<'_>) {
        let (drive, screw) = (&self.machine.drive, self.machine.screw);
        let all = |number: &dyn Fn(&Torques) -> Option<f64>| -> Option<Vec<f64>> {
            self.torques.iter().map(number).collect()
        };
        let peak = |values: Vec<f64>| values.into_iter().map(f64::abs).fold(0.0, f64::max);
        let times = || self.torques.iter().map(|torques| torques.phase.time);
        let torque = all(&|torques| self.motor_torque(torques));
        put(peak_motor_torque_Nm, torque.clone().map(peak));
        let mean_square = |values: Vec<f64>| root_mean_square(values.into_iter().zip(times()));
        put(rms_motor_torque_Nm, torque.and_then(mean_square));
        put(peak_motor_power_W, all(&|torques| self.motor_power(torques)).map(peak));
        put(mean_heat_W, self.mean_heat());
        put(screw_efficiency, self.heaviest().and_then(Torques::efficiency));
        let preload = self.preload.as_ref();
        put(preload_drag_Nm, preload.map(|preload| preload.by_rule));
        put(contact_drag_Nm, preload.and_then(|preload| preload.of_contacts));
        put(holding_torque_Nm, self.holding);
        put(inertia_of_screw_kg_m2, screw.map(|(_, inertia)| inertia));
        put(inertia_of_mass_kg_m2, Some(drive.mass_inertia()));
        let at_motor = screw.map(|_| drive.load_inertia());
        put(inertia_at_motor_kg_m2, at_motor);
        let motor = Some(drive.motor_inertia).filter(|inertia| *inertia > 0.0);
        put(inertia_ratio, at_motor.zip(motor).map(|(load, motor)| load / motor));
    }

    /// The phase of the largest load that moves.
    fn heaviest(&self) -> Option<&Torques> {
        let load = |torques: &&Torques| torques.phase.load.abs();
        let moving = self.torques.iter().filter(|torques| torques.phase.speed != 0.0);
        moving.max_by(|a, b| load(a).total_cmp(&load(b)))
    }

    /// Heat over the cycle \[W\].
    fn mean_heat(&self) -> Option<f64> {
        let time: f64 = self.torques.iter().map(|torques| torques.phase.time).sum();
        let heats = self.torques.iter().map(|torques| Some(torques.heat()? * torques.phase.time));
        heats.sum::<Option<f64>>().map(|heat| heat / time)
    }

    fn motor_torque(&self, torques: &Torques) -> Option<f64> {
        Some(self.machine.drive.motor_torque(torques.at_screw()?, torques.phase.acceleration))
    }

    fn motor_power(&self, torques: &Torques) -> Option<f64> {
        let speed = torques.phase.speed * self.machine.drive.gear_ratio;
        Some(self.motor_torque(torques)? * speed)
    }

    /// What was taken where nothing was given.
    fn notes(&self) -> Vec<String> {
        let no_input = self.no_nut.as_ref().filter(|why| !matches!(why, CaseError::Nut(_)));
        let mut notes: Vec<_> = no_input.map(no_balls).into_iter().collect();
        if let Some(Preload { cold, warm, .. }) = self.preload
            && (cold - warm).abs() > 0.0
        {
            notes.push(preload_note(cold, warm));
        }
        let mut note = |words: &str| notes.push(words.to_owned());
        if let Some(grade) = self.scene.nut.accuracy_grade {
            note(&grade.describe());
        }
        if self.machine.axis.shaft.is_none() {
            note(
                "without stroke_mm or unsupported_length_mm there is no critical speed, buckling load and inertia of the screw",
            );
            return notes;
        }
        if self.scene.nut.support.is_none() {
            note("support is not given: fixed-supported is taken");
        }
        if self.scene.unsupported_length_mm.is_none() {
            note("unsupported_length_mm is stroke, length of the nut and two leads");
        }
        notes
    }

    /// How sure the torque is where friction comes from a lubricant.
    fn how_sure(&self, settings: &Settings) -> Option<String> {
        let heaviest = self.heaviest()?;
        let phase = &heaviest.phase;
        let work = &mut ModelWorkspace::default();
        let [low, high] = contacts::band(self.scene, settings, phase, work)?;
        let friction = heaviest.contacts.friction?;
        Some(format!(
            "friction from the lubricant: at {:.0} N and {:.0} rpm nine of ten draws of what nobody knows exactly lie \
             between {:.3} and {:.3} N m, of {friction:.3} N m of the contacts",
            phase.load,
            phase.speed / RPM,
            low * friction,
            high * friction
        ))
    }

    fn phase_numbers(&self, torques: &Torques) -> SizePhase {
        let phase = &torques.phase;
        let share =
            phase.time / self.machine.axis.phases.iter().map(|phase| phase.time).sum::<f64>();
        let mut numbers = vec![
            ("time_share", "", Some(share)),
            ("screw_load_N", "N", Some(phase.load)),
            ("screw_speed_rpm", "rpm", Some(phase.speed / RPM)),
            ("feed_m_min", "m/min", Some(phase.speed * self.machine.advance() * 60.0)),
            ("acceleration_m_s2", "m/s2", Some(phase.acceleration)),
        ];
        numbers.extend(torques.parts());
        numbers.extend([
            ("motor_torque_Nm", "N m", self.motor_torque(torques)),
            ("motor_power_W", "W", self.motor_power(torques)),
            ("heat_W", "W", torques.heat()),
        ]);
        SizePhase { numbers, contacts: torques.contacts.words.clone() }
    }
}

/// A scene at the largest load and speed of its axis, for the ratings.
fn at_largest(scene: &Scene, axis: &Axis) -> Scene {
    let mut scene = scene.clone();
    let load = axis.largest_load();
    (scene.axial_load_N, scene.feed_m_min) = (Some(load).filter(|load| *load > 0.0), None);
    let rpm = axis.fastest() / RPM;
    (scene.screw_speed_rpm, scene.nut_speed_rpm) = (Some(rpm).filter(|rpm| *rpm > 0.0), None);
    // The load has the mass, and the warm preload is judged by itself.
    scene.moved_mass_kg = None;
    for key in RISES {
        scene[key] = None;
    }
    scene
}

/// Life of the cycle by the loads of all balls \[s\]: each phase takes its share of the life that it has alone.
fn life_by_balls(scene: &Scene, settings: &Settings, axis: &Axis) -> Option<f64> {
    let (mut taken, mut time) = (0.0, 0.0);
    for phase in &axis.phases {
        time += phase.time;
        let moves = phase.speed != 0.0 && (phase.load != 0.0 || is_preloaded(scene));
        if moves {
            let nut = nut_at(scene, settings, phase.load, phase.speed).ok()?;
            let ours = nut.number("life_revolutions")?;
            let rated = nut.number("iso_life_revolutions")?;
            // The ratio is of the model, the rating may be of the maker.
            let preload = nut.number("warm_preload_N").filter(|_| is_preloaded(scene));
            let duty = bsm_design::Duty { load: phase.load, speed: 1.0, time: 1.0 };
            let stated = life(axis.dynamic_rating, preload, &[duty])?.revolutions;
            let turns = phase.speed.abs() * phase.time / TAU;
            taken += turns / (stated * ours / rated);
        }
    }
    (taken > 0.0).then(|| time / taken)
}

/// The screw and its nut as they were used.
fn sizes(
    scene: &Scene,
    Machine { axis, thread, body, .. }: &Machine,
    of_nut: &CapacityReport,
    preload: Option<&Preload>,
) -> Vec<(&'static str, &'static str, f64)> {
    let nut = &axis.nut;
    let mut sizes = vec![
        ("pitch_circle_diameter_mm", "mm", nut.pitch_diameter / MM),
        ("lead_mm", "mm", nut.lead / MM),
        ("lead_angle_deg", "deg", nut.lead_angle() / DEG),
        ("ball_diameter_mm", "mm", nut.ball_diameter / MM),
        ("contact_angle_deg", "deg", nut.contact_angle / DEG),
        ("nut_conformity", "", nut.conformity.0),
        ("screw_conformity", "", nut.conformity.1),
        ("loaded_balls_per_turn", "", nut.balls_per_turn),
        ("loaded_turns", "", nut.turns),
        ("nut_outer_diameter_mm", "mm", body.outer / MM),
        ("nut_length_mm", "mm", body.length / MM),
        ("screw_outer_diameter_mm", "mm", thread.screw.land / MM),
        ("screw_core_diameter_mm", "mm", thread.screw.core / MM),
        ("dynamic_load_rating_N", "N", axis.dynamic_rating),
        ("static_load_rating_N", "N", axis.static_rating.rating),
    ];
    let of_capacity = ["edge_load_N", "mass_kg"];
    let rows = of_nut.rows();
    sizes.extend(rows.iter().filter(|(name, ..)| of_capacity.contains(name)));
    if let Some(Preload { cold, warm, .. }) = preload {
        sizes.extend([("preload_set_N", "N", *cold), ("warm_preload_N", "N", *warm)]);
    }
    sizes.extend(scene.friction_coefficient.map(|f| ("friction_coefficient", "", f)));
    sizes
}
