//! Jamming of the balls in the vocabulary.

use bsm_dyn::{
    ElasticScrew, Reason, Solution, Wedge, apex_thrust, available_friction, centrifugal_force,
    contact_modulus, flat_stiffness, impact_force, step_thrust, viscous_drag, yield_ratio,
};

use crate::analysis::{MovingBall, MovingContact};
use crate::record::message;
use crate::units::{DEG, MPA, UM};
use crate::{Analysis, Block, CaseError, Scene};

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
        let mut report = Self::of(scene, solution);
        let [Some(nut), Some(screw), _] = solved.contacts else {
            unreachable!("every model with a motion has loads and angles of both contacts")
        };
        let case = scene.reader().rigid();
        let precession = solved.ball.motion.precession;
        let mut wedge = Wedge {
            loads: [nut.load, screw.load],
            angles: [nut.touch.angle, screw.touch.angle],
            slip_angles: [nut.slip_angle, screw.slip_angle],
            friction: case.friction,
            centrifugal: centrifugal_force(case.ball.mass, case.helix.radius, precession),
        };
        if nut.semi_axes.is_some() {
            let block = report.contact_state(scene, &mut wedge)?;
            report.blocks.push(block);
        } else {
            report.lacks.push(
                "contact state and wedge angle: nut_conformity, screw_conformity and a model with \
                 elastic contacts; without them the contact angles are equal"
                    .to_owned(),
            );
        }
        report.inertia_and_drag(scene, &solved, &wedge);
        report.locking(&wedge);
        let [nut_load, screw_load] = wedge.loads;
        let contacts =
            [MovingContact { load: nut_load, ..nut }, MovingContact { load: screw_load, ..screw }];
        report.returner(scene, &solved, contacts);
        report.finite()
    }

    /// Loads, angles and approaches with permanent approach, which `wedge` takes over.
    fn contact_state(&mut self, scene: &Scene, wedge: &mut Wedge<f64>) -> Result<Block, CaseError> {
        let screw = scene.reader().elastic_screw();
        let failed = |reason: &Reason| CaseError::NotRated(message(reason));
        let settled =
            screw.permanent_set(wedge.loads, wedge.angles).map_err(|none| failed(none.reason()))?;
        (wedge.loads, wedge.angles) = (settled.loads, settled.angles);
        let mut block = Block::new("contact state, elastic and permanent");
        let mut line = |key, unit, about, values: [f64; 2]| {
            block.contacts(key, unit, about, [Some(values[0]), Some(values[1]), None]);
        };
        line("settled_load_N", "N", "normal load per ball", settled.loads);
        line("settled_angle_deg", "deg", "contact angle", settled.angles.map(|a| a / DEG));
        line("elastic_approach_um", "um", "elastic approach", settled.elastic.map(|d| d / UM));
        line(
            "permanent_approach_um",
            "um",
            "permanent approach",
            settled.permanent.map(|d| d / UM),
        );
        let total = [0, 1].map(|i| (settled.elastic[i] + settled.permanent[i]) / UM);
        line("total_approach_um", "um", "total approach", total);
        let pressures = pressures(&screw, settled.loads).map_err(|reason| failed(&reason))?;
        line(
            "settled_pressure_MPa",
            "MPa",
            "largest pressure, elastic",
            pressures.map(|p| p / MPA),
        );
        let strengths = [
            ("race_yield_strength_MPa", scene.race_yield_strength_MPa),
            ("ball_yield_strength_MPa", scene.ball_yield_strength_MPa),
        ];
        if let Some([races, balls]) = self.need("margin against yield", strengths) {
            let ratios = pressures.map(|p| yield_ratio(p / MPA, (races, balls)));
            line("yield_ratio", "", "pressure over that of first yield", ratios);
            let yields = ratios.iter().any(|ratio| *ratio > 1.0);
            let words = format!(
                "the largest pressure is {:.2} (nut) and {:.2} (screw) times the pressure at which \
                 the steel first yields below the surface",
                ratios[0], ratios[1]
            );
            self.verdicts.push(("contacts_yield", yields, words));
        }
        Ok(block)
    }

    fn inertia_and_drag(&mut self, scene: &Scene, solved: &MovingBall, wedge: &Wedge<f64>) {
        let mut block = Block::new("inertia and drag forces, per ball");
        let (ball, load) = (&solved.ball, wedge.loads[0].min(wedge.loads[1]));
        let to_nut = ball.motion.precession - ball.drive.nut_speed;
        let spin = ball.motion.omega.norm();
        block.whole("orbit_rate_rad_s", "rad/s", "orbital speed of the ball in the nut", to_nut);
        block.whole("ball_omega_rad_s", "rad/s", "rotation of the ball", spin);
        block.whole("centrifugal_force_N", "N", "centrifugal force", wedge.centrifugal);
        let share = wedge.centrifugal / load;
        block.whole("centrifugal_over_load", "", "over the normal load", share);
        let lubricant = [
            ("lubricant_density_kg_m3", scene.lubricant_density_kg_m3),
            ("drag_coefficient", scene.drag_coefficient),
        ];
        if let Some([density, coefficient]) = self.need("drag of the lubricant", lubricant) {
            let speed = 2.0 * ball.helix.radius * to_nut.abs();
            let drag = viscous_drag(coefficient, density, 2.0 * ball.radius, speed);
            block.whole("drag_force_N", "N", "drag of the lubricant", drag);
            block.whole("drag_over_load", "", "over the normal load", drag / load);
        }
        self.blocks.push(block);
    }

    fn locking(&mut self, wedge: &Wedge<f64>) {
        let mut block = Block::new("wedge between the races");
        let clean = |critical: f64| if critical < ROUNDING { 0.0 } else { critical };
        let (critical, published) =
            (clean(wedge.critical_friction()), clean(wedge.critical_friction_published()));
        let (holding, expelling) = (wedge.holding(), wedge.expelling());
        block.whole(
            "wedge_angle_deg",
            "deg",
            "contact angle, screw minus nut",
            wedge.opening() / DEG,
        );
        let [nut, screw] = wedge.across();
        block.contacts(
            "friction_across_N",
            "N",
            "friction across the groove",
            [Some(nut), Some(screw), None],
        );
        block.whole("holding_force_N", "N", "force that holds the ball", holding);
        block.whole("expelling_force_N", "N", "force that pushes it out", expelling);
        if expelling > ROUNDING * holding {
            block.whole("locking_ratio", "", "holding over expelling force", holding / expelling);
        }
        // Without slip across the grooves no friction holds the ball, and there is no such number.
        for (key, about, number) in [
            ("critical_friction_coefficient", "critical friction coefficient", critical),
            ("critical_friction_published", "as published, without centrifugal force", published),
        ] {
            if number < f64::INFINITY {
                block.whole(key, "", about, number);
            }
        }
        self.blocks.push(block);
        let locks = wedge.friction >= critical;
        let words = format!(
            "friction coefficient {} {} the critical one, {}: friction {} the ball in the wedge \
             between the races",
            wedge.friction,
            if locks { "reaches" } else { "is below" },
            match critical {
                0.0 => "0".to_owned(),
                f64::INFINITY => "infinite without slip across the grooves".to_owned(),
                _ => format!("{critical:.2e}"),
            },
            if locks { "holds" } else { "cannot hold" },
        );
        self.verdicts.push(("friction_self_locking", locks, words));
    }

    fn returner(&mut self, scene: &Scene, solved: &MovingBall, contacts: [MovingContact; 2]) {
        let mut block = Block::new("ball return");
        let case = scene.reader().rigid();
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
        let impact = impact_force(case.ball.mass, speed, stiffness);
        block.whole(
            "return_approach_speed_m_s",
            "m/s",
            "speed of the ball at the ball return",
            speed,
        );
        block.whole("impact_force_N", "N", "force of the impact", impact);
        let apex = [("apex_half_angle_deg", scene.apex_half_angle_deg)];
        let apex = self.need("thrust at the apex of the return curve", apex).map(|[angle]| {
            let thrust = apex_thrust(impact, angle * DEG, case.friction);
            block.whole("apex_thrust_N", "N", "thrust at the apex", thrust);
            thrust
        });
        let step = [("return_angle_deg", scene.return_angle_deg)];
        let step = self.need("thrust at the step into the screw", step).map(|[angle]| {
            let normal = scene.step_normal_force_N.unwrap_or(impact);
            let thrust = step_thrust(normal, case.friction, angle * DEG);
            block.whole("step_normal_force_N", "N", "normal force of the step", normal);
            block.whole("step_thrust_N", "N", "thrust at the step", thrust);
            thrust
        });
        let turn = [("loaded_balls_per_turn", scene.loaded_balls_per_turn)];
        if let Some([balls]) = self.need("friction that pushes the balls through the return", turn)
        {
            let at =
                |slip_angle: fn(&MovingContact) -> f64| contacts.map(|c| (c.load, slip_angle(&c)));
            let largest =
                available_friction(balls, case.friction, at(|_| std::f64::consts::FRAC_PI_2));
            let available = available_friction(balls, case.friction, at(|c| c.slip_angle));
            let available = if available < ROUNDING * largest { 0.0 } else { available };
            block.whole(
                "available_friction_N",
                "N",
                "friction along the track, of one turn",
                available,
            );
            block.whole(
                "largest_friction_N",
                "N",
                "if all friction pointed along the track",
                largest,
            );
            if let Some(thrust) = apex.into_iter().chain(step).reduce(f64::max) {
                if thrust > 0.0 {
                    let margins = [available, largest].map(|friction| friction / thrust);
                    block.whole("returner_margin", "", "friction over thrust", margins[0]);
                    block.whole(
                        "largest_margin",
                        "",
                        "if all friction pointed along the track",
                        margins[1],
                    );
                }
                self.jams(thrust, available, largest);
            }
        }
        self.blocks.push(block);
    }

    fn jams(&mut self, thrust: f64, available: f64, largest: f64) {
        let jams = thrust >= available;
        let words = if !jams {
            format!("friction pushes with {available:.3} N against a thrust of {thrust:.3} N")
        } else if thrust >= largest {
            format!(
                "the thrust of {thrust:.3} N is more than all friction of one turn, {largest:.3} N"
            )
        } else {
            format!(
                "by the published criterion: in the steady motion the friction along the track is \
                 {available:.3} N against a thrust of {thrust:.3} N. Balls that are stopped slide \
                 along the track; the friction is then up to {largest:.3} N"
            )
        };
        self.verdicts.push(("jams", jams, words));
        if jams && thrust < largest && available == 0.0 {
            self.warnings.push(format!(
                "the balls of model {} roll: friction along the track is zero at the contact \
                 centres, and the published criterion finds a jam at any thrust; \
                 largest_margin is the margin of balls that are stopped and slide",
                self.model.name()
            ));
        }
    }

    /// The values of some inputs, or a line about what is left out for want of them.
    fn need<const N: usize>(
        &mut self,
        part: &str,
        inputs: [(&str, Option<f64>); N],
    ) -> Option<[f64; N]> {
        let missing: Vec<_> =
            inputs.iter().filter(|(_, value)| value.is_none()).map(|(name, _)| *name).collect();
        if missing.is_empty() {
            return Some(inputs.map(|(_, value)| value.unwrap_or(f64::NAN)));
        }
        self.lacks.push(format!("{part}: {}", missing.join(" and ")));
        None
    }
}

/// Largest pressures at nut and screw \[Pa\].
fn pressures(screw: &ElasticScrew, loads: [f64; 2]) -> Result<[f64; 2], bsm_dyn::Reason> {
    let hertz = screw.hertz()?;
    Ok([0, 1].map(|i| hertz[i].max_pressure(loads[i])))
}
