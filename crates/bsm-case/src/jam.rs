//! Jamming of the balls in the vocabulary.

use std::f64::consts::FRAC_PI_2;

use bsm_dyn::{
    Angles, Direction, ElasticPoint, EntryStep, Reason, Solution, SteadyBall, Wedge, apex_thrust,
    centrifugal_force, contact_modulus, flat_stiffness, impact_force, linear_impact_force,
    step_thrust, track_friction, viscous_drag,
};

use crate::analysis::{MovingBall, MovingContact};
use crate::quantity::quantities;
use crate::record::message;
use crate::units::{DEG, MM, MPA, UM};
use crate::{Analysis, AnalysisKind, CaseError, InputKey, Scene};

quantities! { Jam;
    "contact state, elastic and permanent" {
        settled_load_N ["N"] Contacts needs [nut_conformity, screw_conformity],
            "normal load per ball";
        settled_angle_deg ["deg"] Contacts needs [nut_conformity, screw_conformity],
            "contact angle";
        elastic_approach_um ["um"] Contacts needs [nut_conformity, screw_conformity],
            "elastic approach";
        permanent_approach_um ["um"] Contacts needs [nut_conformity, screw_conformity],
            "permanent approach";
        total_approach_um ["um"] Contacts needs [nut_conformity, screw_conformity],
            "total approach";
        settled_pressure_MPa ["MPa"] Contacts needs [nut_conformity, screw_conformity],
            "largest pressure, elastic";
        yield_ratio [""] Contacts
            needs [nut_conformity, screw_conformity, race_yield_strength_MPa, ball_yield_strength_MPa],
            "pressure over that of first yield";
        contacts_yield [""] Statement
            needs [nut_conformity, screw_conformity, race_yield_strength_MPa, ball_yield_strength_MPa],
            "true if the steel yields below the surface of a contact";
    }
    "inertia and drag forces, per ball" {
        orbit_rate_rad_s ["rad/s"] Whole, "orbital speed of the ball in the nut";
        ball_omega_rad_s ["rad/s"] Whole, "rotation of the ball";
        centrifugal_force_N ["N"] Whole, "centrifugal force";
        centrifugal_over_load [""] Whole, "centrifugal force over the normal load";
        drag_force_N ["N"] Whole needs [lubricant_density_kg_m3, drag_coefficient],
            "drag of the lubricant";
        drag_over_load [""] Whole needs [lubricant_density_kg_m3, drag_coefficient],
            "drag over the normal load";
    }
    "wedge between the races" {
        wedge_angle_deg ["deg"] Whole, "contact angle, screw minus nut";
        friction_across_N ["N"] Contacts, "friction across the groove";
        holding_force_N ["N"] Whole, "force that holds the ball";
        expelling_force_N ["N"] Whole, "force that pushes the ball out";
        locking_ratio [""] Whole, "holding over expelling force";
        critical_friction_coefficient [""] Whole,
            "friction coefficient from which friction holds the ball in this wedge";
        critical_friction_printed [""] Contacts,
            "critical friction coefficient as printed by Dong et al., Eq 16";
        critical_friction_simplified [""] Whole,
            "critical friction coefficient as simplified by Dong et al., Eq 17: slip angle of 90 deg";
        critical_friction_corrected [""] Whole,
            "critical friction coefficient as corrected, without centrifugal force";
        widest_wedge_deg ["deg"] Whole, "widest wedge in which friction can hold a ball";
    }
    "self-locking" {
        locking_friction_coefficient [""] Whole,
            "friction coefficient from which the screw is self-locking in its direction of drive, contact angles under load";
        locking_margin [""] Whole, "margin, locking friction coefficient over the one of the scene";
        self_locking_under_load [""] Statement,
            "true if the screw is self-locking in its direction of drive, contact angles under load";
    }
    "ball return" {
        approach_speed_m_s ["m/s"] Whole, "speed of the ball at the ball return";
        impact_force_N ["N"] Whole, "force of the impact";
        apex_thrust_N ["N"] Whole needs [apex_half_angle_deg],
            "thrust at the apex of the return curve";
        step_force_N ["N"] Whole needs [return_angle_deg], "normal force of the step";
        step_thrust_N ["N"] Whole needs [return_angle_deg], "thrust at the step into the screw";
        highest_step_mm ["mm"] Whole, "height of a step into the return that no thrust overcomes";
        entry_thrust_ratio [""] Whole needs [step_height_mm, return_angle_deg],
            "thrust behind over thrust ahead of a ball at the step into the return";
        entry_thrust_N ["N"] Whole needs [step_height_mm, return_angle_deg, apex_half_angle_deg],
            "thrust at the step into the return, with a ball at the apex ahead";
        screw_track_friction_N ["N"] Whole needs [loaded_balls_per_turn],
            "friction along the track, balls of one turn: steady motion, screw (as published)";
        weaker_track_friction_N ["N"] Whole needs [loaded_balls_per_turn],
            "friction along the track, balls of one turn: steady motion, weaker contact";
        stopped_track_friction_N ["N"] Whole needs [loaded_balls_per_turn],
            "friction along the track, balls of one turn: stopped balls, screw";
        returner_margin [""] Whole
            needs [loaded_balls_per_turn, apex_half_angle_deg | return_angle_deg],
            "margin, friction over thrust: stopped balls";
        published_margin [""] Whole
            needs [loaded_balls_per_turn, apex_half_angle_deg | return_angle_deg],
            "friction over thrust: steady motion, screw (as published)";
        weaker_contact_margin [""] Whole
            needs [loaded_balls_per_turn, apex_half_angle_deg | return_angle_deg],
            "friction over thrust: steady motion, weaker contact";
        jams [""] Statement
            needs [loaded_balls_per_turn, apex_half_angle_deg | return_angle_deg],
            "true if the thrust is at least the friction of balls that are stopped";
    }
}

/// Below this a critical friction coefficient, and the sine of a slip angle, is rounding: the
/// balance of a ball that grips has neither.
const ROUNDING: f64 = 1e-9;

/// Stiffness in N/m^1.5 of one in N/µm^1.5.
const PER_UM15: f64 = 1e9;

impl Analysis {
    /// Contact state with permanent approach, centrifugal force and drag, the wedge between the
    /// races, and thrust in the ball return against the friction that pushes the balls through it.
    ///
    /// # Errors
    ///
    /// [`CaseError::NoMotion`] if the model has no motion of the ball, [`CaseError::NotRated`] if
    /// the contacts have no state with permanent approach, [`CaseError::BeyondDouble`] for a number
    /// that no double holds.
    pub fn jam(scene: &Scene, solution: &Solution) -> Result<Self, CaseError> {
        let solved = MovingBall::of(scene, solution)?;
        if scene.running_angles().is_some() {
            return Err(CaseError::BadEntry {
                key: InputKey::nut_running_contact_angle_deg.name().to_owned(),
                what: "is an input of slip: jamming needs angles in balance with the load"
                    .to_owned(),
            });
        }
        let mut report = Self::of(AnalysisKind::Jam, scene, solution);
        let [Some(nut), Some(screw), _] = solved.contacts else {
            unreachable!("every model with a motion has loads and angles of both contacts")
        };
        let case = scene.reader().operating_point();
        let precession = solved.ball.motion.precession;
        let mut wedge = Wedge {
            loads: [nut.load, screw.load],
            angles: [nut.touch.angle, screw.touch.angle],
            slip_angles: [nut.slip_angle, screw.slip_angle],
            friction: case.friction.0,
            centrifugal: centrifugal_force(case.ball.mass, case.helix.radius, precession),
        };
        if nut.semi_axes.is_some() {
            report.contact_state(scene, &mut wedge)?;
        } else {
            report.lacks_ellipses("contact state and wedge angle");
        }
        report.inertia_and_drag(scene, &solved, &wedge);
        report.wedge(&wedge);
        report.locking(&solved, &wedge);
        let [nut_load, screw_load] = wedge.loads;
        let contacts =
            [MovingContact { load: nut_load, ..nut }, MovingContact { load: screw_load, ..screw }];
        report.returner(scene, &solved, contacts);
        report.finite()
    }

    /// Loads, angles and approaches with permanent approach, which `wedge` takes over.
    fn contact_state(&mut self, scene: &Scene, wedge: &mut Wedge<f64>) -> Result<(), CaseError> {
        let screw = scene.reader().elastic_point();
        let failed = |reason: &Reason| CaseError::NotRated(message(reason));
        let settled =
            screw.permanent_set(wedge.loads, wedge.angles).map_err(|none| failed(none.reason()))?;
        (wedge.loads, wedge.angles) = (settled.loads, settled.angles);
        let numbers = &mut self.numbers;
        numbers.both(settled_load_N, settled.loads);
        numbers.both(settled_angle_deg, settled.angles.map(|a| a / DEG));
        numbers.both(elastic_approach_um, settled.elastic.map(|d| d / UM));
        numbers.both(permanent_approach_um, settled.permanent.map(|d| d / UM));
        let total = [0, 1].map(|i| (settled.elastic[i] + settled.permanent[i]) / UM);
        numbers.both(total_approach_um, total);
        let pressures = pressures(&screw, settled.loads).map_err(|reason| failed(&reason))?;
        numbers.both(settled_pressure_MPa, pressures.map(|p| p / MPA));
        if let (Some(races), Some(balls)) =
            (scene.race_yield_strength_MPa, scene.ball_yield_strength_MPa)
        {
            let ratios = pressures.map(|p| bsm_dyn::yield_ratio(p / MPA, (races, balls)));
            self.numbers.both(yield_ratio, ratios);
            let words = format!(
                "the largest pressure is {:.2} (nut) and {:.2} (screw) times the pressure at which \
                 the steel first yields below the surface",
                ratios[0], ratios[1]
            );
            self.state(contacts_yield, ratios.iter().any(|ratio| *ratio > 1.0), words);
        }
        Ok(())
    }

    fn inertia_and_drag(&mut self, scene: &Scene, solved: &MovingBall, wedge: &Wedge<f64>) {
        let numbers = &mut self.numbers;
        let (ball, load) = (&solved.ball, wedge.loads[0].min(wedge.loads[1]));
        let to_nut = ball.motion.precession - ball.drive.nut_speed;
        numbers.whole(orbit_rate_rad_s, to_nut);
        numbers.whole(ball_omega_rad_s, ball.motion.omega.norm());
        numbers.whole(centrifugal_force_N, wedge.centrifugal);
        numbers.whole(centrifugal_over_load, wedge.centrifugal / load);
        if let (Some(density), Some(coefficient)) =
            (scene.lubricant_density_kg_m3, scene.drag_coefficient)
        {
            let speed = 2.0 * ball.helix.radius * to_nut.abs();
            let drag = viscous_drag(coefficient, density, 2.0 * ball.radius, speed);
            numbers.whole(drag_force_N, drag);
            numbers.whole(drag_over_load, drag / load);
        }
    }

    fn wedge(&mut self, wedge: &Wedge<f64>) {
        let numbers = &mut self.numbers;
        let clean = |critical: f64| if critical < ROUNDING { 0.0 } else { critical };
        let (critical, corrected) =
            (clean(wedge.critical_friction()), clean(wedge.critical_friction_corrected()));
        let (holding, expelling) = (wedge.holding(), wedge.expelling());
        numbers.whole(wedge_angle_deg, wedge.opening() / DEG);
        numbers.both(friction_across_N, wedge.across());
        numbers.whole(holding_force_N, holding);
        numbers.whole(expelling_force_N, expelling);
        if expelling > ROUNDING * holding {
            numbers.whole(locking_ratio, holding / expelling);
        }
        // Without slip across the grooves no friction holds the ball, and there is no such number.
        let finite = |number: f64| Some(number).filter(|x| *x < f64::INFINITY);
        numbers.whole(critical_friction_coefficient, finite(critical));
        numbers.both(critical_friction_printed, wedge.critical_friction_printed().map(clean));
        numbers.whole(critical_friction_simplified, clean(wedge.critical_friction_simplified()));
        numbers.whole(critical_friction_corrected, finite(corrected));
        numbers.whole(widest_wedge_deg, wedge.widest_opening() / DEG);
    }

    /// Self-locking (C6), (C7) with the mean contact angle under load: friction turns the angles of nut and
    /// screw apart, not the direction of the force between them.
    fn locking(&mut self, solved: &MovingBall, wedge: &Wedge<f64>) {
        let numbers = &mut self.numbers;
        let SteadyBall { helix, drive, .. } = solved.ball;
        let Some(direction) = Direction::of(drive.relative_speed()) else { return };
        let angles = Angles { lead: helix.lead_angle, contact: wedge.mean_angle() };
        let locking = angles.locking_friction(direction);
        numbers.whole(locking_friction_coefficient, locking);
        let margin = locking / wedge.friction;
        numbers.whole(locking_margin, Some(margin).filter(|x| x.is_finite()));
        let words = format!(
            "the screw is self-locking in this direction from a friction coefficient of {locking:.3} on, at \
             the contact angle of {:.2} deg under load; its friction coefficient is {}",
            angles.contact / DEG,
            wedge.friction
        );
        self.state(self_locking_under_load, angles.self_locking(direction, wedge.friction), words);
    }

    fn returner(&mut self, scene: &Scene, solved: &MovingBall, contacts: [MovingContact; 2]) {
        let numbers = &mut self.numbers;
        let case = scene.reader().operating_point();
        let ball = &solved.ball;
        let speed = scene.return_approach_speed_m_s.unwrap_or_else(|| {
            let to_nut = ball.motion.precession - ball.drive.nut_speed;
            ball.helix.arc_length_per_radian() * to_nut.abs()
        });
        let stiffness = scene.return_stiffness_N_um15.map_or_else(
            || {
                let (races, balls) = scene.reader().materials();
                flat_stiffness(contact_modulus(&races, &balls), ball.radius)
            },
            |k| k * PER_UM15,
        );
        let mass = case.ball.mass;
        let impact = match scene.return_linear_stiffness_N_um {
            Some(linear) => linear_impact_force(mass, speed, linear / UM),
            None => impact_force(mass, speed, stiffness),
        };
        numbers.whole(approach_speed_m_s, speed);
        numbers.whole(impact_force_N, impact);
        let apex = scene
            .apex_half_angle_deg
            .map(|angle| apex_thrust(impact, angle * DEG, case.friction.0));
        numbers.whole(apex_thrust_N, apex);
        let step = scene.return_angle_deg.map(|angle| {
            let normal = scene.step_normal_force_N.unwrap_or(impact);
            (normal, step_thrust(normal, case.friction.0, angle * DEG))
        });
        numbers.whole(step_force_N, step.map(|(normal, _)| normal));
        numbers.whole(step_thrust_N, step.map(|(_, thrust)| thrust));
        let entry = entry_step(scene, ball.radius);
        numbers.whole(highest_step_mm, entry.highest() * ball.radius / MM);
        // Without a ratio no thrust is enough.
        let entered =
            scene.step_height_mm.and(scene.return_angle_deg).map(|_| entry.thrust_ratio());
        numbers.whole(entry_thrust_ratio, entered.flatten());
        let into = entered.zip(apex).map(|(ratio, apex)| ratio.map(|ratio| ratio * apex));
        numbers.whole(entry_thrust_N, into.flatten());
        let Some(balls) = scene.loaded_balls_per_turn else { return };
        let friction = |c: &MovingContact, slip_angle: f64| {
            track_friction(balls, case.friction.0, c.load, slip_angle)
        };
        let stopped = friction(&contacts[1], FRAC_PI_2);
        let clean = |force: f64| if force < ROUNDING * stopped { 0.0 } else { force };
        let [nut, screw] = contacts.map(|c| clean(friction(&c, c.slip_angle)));
        numbers.whole(screw_track_friction_N, screw);
        numbers.whole(weaker_track_friction_N, nut.min(screw));
        numbers.whole(stopped_track_friction_N, stopped);
        if let Some(None) = entered {
            let words = format!(
                "no thrust lifts a ball over the step of {} mm into the return; it may be {:.3} mm high",
                scene.step_height_mm.unwrap_or(f64::NAN),
                entry.highest() * ball.radius / MM
            );
            self.state(jams, true, words);
            return;
        }
        let thrusts = [apex, step.map(|(_, thrust)| thrust), into.flatten()];
        let Some(thrust) = thrusts.into_iter().flatten().reduce(f64::max) else { return };
        if thrust > 0.0 {
            numbers.whole(returner_margin, stopped / thrust);
            numbers.whole(published_margin, screw / thrust);
            numbers.whole(weaker_contact_margin, nut.min(screw) / thrust);
        }
        let words = format!(
            "balls of one turn that are stopped push with a friction of up to {stopped:.3} N against a \
             thrust of {thrust:.3} N; in the steady motion their friction along the track is \
             {screw:.3} N, which the published criterion takes"
        );
        self.state(jams, thrust >= stopped, words);
    }
}

/// The step into the ball return; of no height unless given.
fn entry_step(scene: &Scene, ball_radius: f64) -> EntryStep {
    EntryStep {
        height: scene.step_height_mm.unwrap_or(0.0) * MM / ball_radius,
        angle: scene.return_angle_deg.unwrap_or(0.0) * DEG,
        rolling: scene.rolling_friction_mm.unwrap_or(0.0) * MM / ball_radius,
    }
}

/// Largest pressures at nut and screw \[Pa\].
fn pressures(screw: &ElasticPoint, loads: [f64; 2]) -> Result<[f64; 2], bsm_dyn::Reason> {
    let hertz = screw.hertz()?;
    Ok([0, 1].map(|i| hertz[i].max_pressure(loads[i])))
}
