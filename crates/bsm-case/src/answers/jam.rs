//! Ball-jamming analysis. The results are named quantities with units.

use std::f64::consts::FRAC_PI_2;

use bsm_dyn::{
    Direction, Reason, Solution,
    angles::Angles,
    hertz::flat_stiffness,
    lubrication::{FrictionLaw, viscous_drag},
    model::{PermanentSet, centrifugal_force},
    solution::SteadyBall,
    train::{
        EntryStep, Wedge, apex_thrust, impact_force, linear_impact_force, step_thrust,
        track_friction,
    },
};

use crate::answers::motion::{MovingBall, MovingContact, lacks_ellipses, motion_answer};
use crate::answers::record::message;
use crate::vocabulary::error::invalid_input;
use crate::vocabulary::members::number_tables;
use crate::vocabulary::number::format_number;
use crate::vocabulary::quantity::quantities;
use crate::vocabulary::units::{DEG, MM, MPA, UM};
use crate::{Answer, Case, CaseError, InputKey, output};

number_tables! {
    /// Results of a jamming analysis.
    pub(crate) JamNumbers = QUANTITIES.iter();
}

quantities! { pub(crate) QUANTITIES, read(&Jam) of Jam;
    "elastic deformation and permanent set of the contacts" {
        load_with_permanent_set_N ["N"] Contacts(|j| Some(j.permanent.as_ref()?.set.loads)) needs [nut_conformity, screw_conformity], "normal load per ball";
        angle_with_permanent_set_deg ["deg"] Contacts(|j| Some(j.permanent.as_ref()?.set.angles.map(|a| a / DEG))) needs [nut_conformity, screw_conformity], "contact angle";
        elastic_approach_um ["um"] Contacts(|j| Some(j.permanent.as_ref()?.set.elastic.map(|d| d / UM))) needs [nut_conformity, screw_conformity], "elastic approach";
        permanent_approach_um ["um"] Contacts(|j| Some(j.permanent.as_ref()?.set.permanent.map(|d| d / UM))) needs [nut_conformity, screw_conformity], "permanent approach";
        total_approach_um ["um"] Contacts(|j| {
            let set = &j.permanent.as_ref()?.set;
            Some([0, 1].map(|i| (set.elastic[i] + set.permanent[i]) / UM))
        }) needs [nut_conformity, screw_conformity], "total approach";
        elastic_pressure_MPa ["MPa"] Contacts(|j| Some(j.permanent.as_ref()?.pressures.map(|p| p / MPA))) needs [nut_conformity, screw_conformity],
            "largest contact pressure (elastic)";
        yield_ratio [""] Contacts(|j| j.yield_ratios) needs [nut_conformity, screw_conformity, raceway_yield_strength_MPa, ball_yield_strength_MPa], "pressure / pressure at first yield";
        contacts_yield [""] Statement(|j| Some(j.yield_ratios?.iter().any(|ratio| *ratio > 1.0))) needs [nut_conformity, screw_conformity, raceway_yield_strength_MPa, ball_yield_strength_MPa],
            "true if the steel yields below the surface of a contact";
    }
    "inertia and drag forces, per ball" {
        orbital_speed_rad_s ["rad/s"] Scalar(Jam::orbital_speed), "orbital speed of the ball in the nut";
        ball_omega_rad_s ["rad/s"] Scalar(|j| j.ball.motion.omega.norm()), "rotation of the ball";
        centrifugal_force_N ["N"] Scalar(|j| j.wedge.centrifugal), "centrifugal force";
        centrifugal_over_load [""] Scalar(|j| j.wedge.centrifugal / j.least_load()), "centrifugal force / normal load";
        drag_force_N ["N"] Scalar(|j| j.drag) needs [lubricant_density_kg_m3, drag_coefficient], "drag of the lubricant";
        drag_over_load [""] Scalar(|j| Some(j.drag? / j.least_load())) needs [lubricant_density_kg_m3, drag_coefficient],
            "drag / normal load";
    }
    "wedge between the raceways" {
        wedge_angle_deg ["deg"] Scalar(|j| j.wedge.wedge_angle() / DEG), "wedge angle: contact angle at the screw minus contact angle at the nut";
        friction_across_N ["N"] Contacts(|j| j.wedge.across()), "friction force across the groove";
        holding_force_N ["N"] Scalar(|j| j.wedge.holding_force()), "force that holds the ball in the wedge";
        expelling_force_N ["N"] Scalar(|j| j.wedge.expelling_force()), "force that pushes the ball out of the wedge";
        locking_ratio [""] Scalar(|j| {
            let (holding, expelling) = (j.wedge.holding_force(), j.wedge.expelling_force());
            (expelling > ROUNDING * holding).then(|| holding / expelling)
        }), "holding force / expelling force";
        critical_friction_coefficient [""] Scalar(|j| finite(clean(j.wedge.critical_friction()))),
            "critical friction coefficient, above which friction holds the ball in this wedge";
        critical_friction_printed [""] Contacts(|j| j.wedge.critical_friction_printed().map(clean)),
            "critical friction coefficient according to Dong et al., Eq 16";
        critical_friction_simplified [""] Scalar(|j| clean(j.wedge.critical_friction_simplified())),
            "critical friction coefficient according to Dong et al., Eq 17, the simplification for a slip angle of 90 deg";
        critical_friction_corrected [""] Scalar(|j| finite(clean(j.wedge.critical_friction_corrected()))),
            "critical friction coefficient with the corrected formula, without centrifugal force";
        widest_wedge_deg ["deg"] Scalar(|j| j.wedge.widest_opening() / DEG), "widest wedge in which friction can hold a ball";
    }
    "self-locking" {
        locking_friction_coefficient [""] Scalar(|j| Some(j.locking()?.1)),
            "friction coefficient for self-locking in the drive direction, at the contact angles under load";
        locking_margin [""] Scalar(|j| Some(j.locking()?.1 / j.friction.rest).filter(|x| x.is_finite())),
            "self-locking margin: friction coefficient for self-locking / friction coefficient";
        self_locking_under_load [""] Statement(|j| {
            let (direction, _) = j.locking()?;
            Some(j.angles().self_locking(direction, j.friction.rest))
        }), "true if the screw is self-locking in its drive direction, at the contact angles under load";
    }
    "ball return" {
        approach_speed_m_s ["m/s"] Scalar(|j| j.ball_return.speed), "speed of the ball at the ball return";
        impact_force_N ["N"] Scalar(|j| j.ball_return.impact), "impact force of the ball on the ball return";
        apex_thrust_N ["N"] Scalar(|j| j.ball_return.apex) needs [apex_half_angle_deg], "thrust at the apex of the return curve";
        step_force_N ["N"] Scalar(|j| Some(j.ball_return.step?.0)) needs [return_angle_deg], "normal force that the step exerts on the ball";
        step_thrust_N ["N"] Scalar(|j| Some(j.ball_return.step?.1)) needs [return_angle_deg], "thrust at the step into the screw";
        highest_step_mm ["mm"] Scalar(|j| j.ball_return.highest / MM), "critical height of a step into the return";
        entry_thrust_ratio [""] Scalar(|j| j.ball_return.entered.filter(|ratio| ratio.is_finite())) needs [step_height_mm, return_angle_deg],
            "thrust from the ball behind / thrust from the balls ahead, for a ball at the step into the return";
        entry_thrust_N ["N"] Scalar(|j| j.ball_return.entry_thrust()) needs [step_height_mm, return_angle_deg, apex_half_angle_deg],
            "thrust that pushes a ball over the step into the return while the ball ahead is at the apex of the return curve";
        screw_track_friction_N ["N"] Scalar(|j| Some(j.track?.screw)) needs [loaded_balls_per_turn],
            "friction force along the track between the screw and the balls of one turn, in steady motion (published formula)";
        weaker_track_friction_N ["N"] Scalar(|j| Some(j.track?.weaker)) needs [loaded_balls_per_turn],
            "friction force along the track on the balls of one turn in steady motion, at the contact with less friction";
        stopped_friction_coefficient [""] Scalar(|j| j.friction.stopped), "friction coefficient of a stopped ball at the screw";
        stopped_track_friction_N ["N"] Scalar(|j| Some(j.track?.stopped)) needs [loaded_balls_per_turn],
            "friction force along the track between the screw and the stationary balls of one turn";
        ball_return_margin [""] Scalar(|j| Some(j.track?.stopped / j.positive_thrust()?)) needs [loaded_balls_per_turn, apex_half_angle_deg | return_angle_deg], "ball-return margin: friction of stationary balls / thrust";
        published_margin [""] Scalar(|j| Some(j.track?.screw / j.positive_thrust()?)) needs [loaded_balls_per_turn, apex_half_angle_deg | return_angle_deg],
            "friction of moving balls at the screw / thrust (published criterion)";
        weaker_contact_margin [""] Scalar(|j| Some(j.track?.weaker / j.positive_thrust()?)) needs [loaded_balls_per_turn, apex_half_angle_deg | return_angle_deg],
            "friction of moving balls at the contact with less friction / thrust";
        jams [""] Statement(|j| {
            let track = j.track?;
            if j.ball_return.is_blocked() { Some(true) } else { Some(j.ball_return.thrust()? >= track.stopped) }
        }) needs [loaded_balls_per_turn, apex_half_angle_deg | return_angle_deg], "true if the balls jam in the return, because the thrust is at least as large as the friction of stationary balls";
    }
}

/// Magnitude below which a critical friction coefficient, or the sine of a slip angle, is treated
/// as a rounding error. Both quantities are exactly zero for a rolling ball.
const ROUNDING: f64 = 1e-9;

/// Factor that converts a contact stiffness from N/µm^1.5 to N/m^1.5.
const PER_UM15: f64 = 1e9;

/// Returns a critical friction coefficient, or zero if the coefficient is only a rounding error.
fn clean(critical: f64) -> f64 {
    if critical < ROUNDING { 0.0 } else { critical }
}

/// Returns a critical friction coefficient, or `None` if the coefficient is infinite. Without slip
/// across the grooves, the coefficient is infinite, because no friction can hold the ball.
fn finite(critical: f64) -> Option<f64> {
    Some(critical).filter(|x| *x < f64::INFINITY)
}

/// Intermediate results of the jamming analysis.
struct Jam {
    ball: SteadyBall<f64>,
    permanent: Option<PermanentContacts>,
    /// Ratio of maximum pressure to pressure at first yield, at nut and screw.
    yield_ratios: Option<[f64; 2]>,
    /// Drag force of the lubricant on the ball \[N\].
    drag: Option<f64>,
    friction: Friction,
    wedge: Wedge<f64>,
    ball_return: BallReturn,
    track: Option<Track>,
}

/// Contacts with permanent deformation, and their maximum pressures \[Pa\].
struct PermanentContacts {
    set: PermanentSet,
    pressures: [f64; 2],
}

/// Friction coefficients in different states of motion. Without a lubricant, they are all equal.
struct Friction {
    /// Friction coefficients at nut and screw in steady motion.
    moving: [f64; 2],
    /// Friction coefficient at the screw for a ball that does not move relative to the nut.
    stopped: f64,
    /// Friction coefficient without a lubricant film: at rest, between balls that roll against each
    /// other, and in the ball return.
    rest: f64,
}

/// Forces on a ball in the ball return.
struct BallReturn {
    /// Speed of the ball at the entry to the return \[m/s\].
    speed: f64,
    /// Force of the ball's impact on the ball return \[N\].
    impact: f64,
    /// Push force on the ball at the apex of the return curve \[N\].
    apex: Option<f64>,
    /// Normal force and push force on the ball at the step from the ball return into the screw
    /// \[N\].
    step: Option<(f64, f64)>,
    /// Critical height of the step at the entry to the ball return \[m\]. No push force lifts a
    /// ball over a higher step.
    highest: f64,
    /// Ratio of the push force behind a ball to the push force ahead of it, at the step at the
    /// entry to the ball return. The ratio is infinite if no push force can lift the ball over the
    /// step.
    entered: Option<f64>,
}

/// Friction forces that act along the track on the balls of one turn \[N\].
#[derive(Clone, Copy)]
struct Track {
    /// Friction force at the screw in steady motion.
    screw: f64,
    /// Smaller of the friction forces at the nut and at the screw in steady motion.
    weaker: f64,
    /// Friction force that the screw exerts on the balls of one turn while the balls stand still.
    stopped: f64,
}

/// Calculates the permanent deformation of the contacts, the centrifugal and drag forces, the
/// wedging of the ball between the raceways, and the push forces in the ball return. The push
/// forces are compared with the friction that drives the balls through the return.
///
/// # Errors
/// Returns [`CaseError::Invalid`] if the model does not calculate the motion of the ball, if the
/// calculation of the permanent deformation has no solution, or if a number exceeds the range of
/// double precision.
pub fn jam(case: &Case, solution: &Solution) -> Result<Answer, CaseError> {
    let jam = Jam::of(case, solution)?;
    let lacks = match jam.permanent {
        Some(_) => Vec::new(),
        None => vec![lacks_ellipses("deformation of the contacts and wedge angle", solution.model)],
    };
    let numbers = read(&jam, |_| true).finite()?;
    let words = [
        (output!(contacts_yield), jam.yield_text()),
        (output!(self_locking_under_load), jam.locking_text()),
        (output!(jams), jam.return_text(case)),
    ];
    let verdicts = words.into_iter().filter_map(|(name, words)| Some((name, words?))).collect();
    let mut answer = motion_answer::<JamNumbers>(case, solution, numbers, verdicts, lacks);
    answer.notes.extend(case.given().is_lubricated().then(|| jam.friction.words()));
    Ok(answer)
}

impl Jam {
    fn of(case: &Case, solution: &Solution) -> Result<Self, CaseError> {
        let solved = MovingBall::of(case, solution)?;
        if case.running_angles().is_some() {
            return Err(invalid_input(
                InputKey::nut_running_contact_angle_deg.name(),
                "is an input of the analysis `bsm solve --show slip`; jamming needs contact angles in equilibrium with the load",
            ));
        }
        let [Some(nut), Some(screw), _] = solved.contacts else {
            unreachable!(
                "every model that calculates a motion also calculates loads and angles of both contacts"
            )
        };
        let (point, ball) = (case.reader().operating_point(), solved.ball);
        let friction = Friction::of(case, solution, (&ball, &screw), point.friction.0);
        let mut wedge = Wedge {
            loads: [nut.load, screw.load],
            angles: [nut.touch.angle, screw.touch.angle],
            slip_angles: [nut.slip_angle, screw.slip_angle],
            friction: friction.moving,
            centrifugal: centrifugal_force(
                point.ball.mass,
                point.helix.radius,
                ball.motion.precession,
            ),
        };
        let permanent = nut.semi_axes.map(|_| PermanentContacts::of(case, &wedge)).transpose()?;
        if let Some(PermanentContacts { set, .. }) = &permanent {
            (wedge.loads, wedge.angles) = (set.loads, set.angles);
        }
        let strengths = case.raceway_yield_strength_MPa.zip(case.ball_yield_strength_MPa);
        let yield_ratios = permanent.as_ref().zip(strengths).map(|(permanent, strengths)| {
            permanent.pressures.map(|p| bsm_dyn::hertz::yield_ratio(p / MPA, strengths))
        });
        let drag = case.lubricant_density_kg_m3.zip(case.drag_coefficient);
        let drag = drag.map(|(density, coefficient)| {
            let speed =
                2.0 * ball.helix.radius * (ball.motion.precession - ball.drive.nut_speed).abs();
            viscous_drag(coefficient, density, 2.0 * ball.radius, speed)
        });
        let track = case.loaded_balls_per_turn.map(|balls| Track::of(balls, &wedge, &friction));
        let ball_return = BallReturn::of(case, &ball, friction.rest);
        Ok(Self { ball, permanent, yield_ratios, drag, friction, wedge, ball_return, track })
    }

    fn orbital_speed(&self) -> f64 {
        self.ball.motion.precession - self.ball.drive.nut_speed
    }

    fn least_load(&self) -> f64 {
        self.wedge.loads[0].min(self.wedge.loads[1])
    }

    /// Returns the lead angle and the mean contact angle under load. The mean is used because
    /// friction changes the contact angles at nut and screw, but not the direction of the force
    /// between nut and screw.
    fn angles(&self) -> Angles<f64> {
        Angles { lead: self.ball.helix.lead_angle, contact: self.wedge.mean_angle() }
    }

    /// Returns the direction of drive and the friction coefficient above which the screw is
    /// self-locking in this direction (C6), (C7).
    fn locking(&self) -> Option<(Direction, f64)> {
        let direction = Direction::of(self.ball.drive.relative_speed())?;
        Some((direction, self.angles().locking_friction(direction)))
    }

    /// Returns the largest push force that the balls must overcome in the ball return, or `None` if
    /// no push force is needed or a step blocks the balls.
    fn positive_thrust(&self) -> Option<f64> {
        self.ball_return.thrust().filter(|thrust| *thrust > 0.0 && !self.ball_return.is_blocked())
    }

    fn yield_text(&self) -> Option<String> {
        let [nut, screw] = self.yield_ratios?;
        Some(format!(
            "The largest pressure is {nut:.2} (nut) and {screw:.2} (screw) times the pressure at which \
             the steel first yields below the surface."
        ))
    }

    fn locking_text(&self) -> Option<String> {
        let (_, locking) = self.locking()?;
        Some(format!(
            "The screw is self-locking in this direction above a friction coefficient of {locking:.3}, at \
             the contact angle of {:.2} deg under load; its friction coefficient is {}.",
            self.angles().contact / DEG,
            self.friction.rest
        ))
    }

    fn return_text(&self, case: &Case) -> Option<String> {
        let Track { screw, stopped, .. } = self.track?;
        if self.ball_return.is_blocked() {
            return Some(format!(
                "No thrust lifts a ball over the step of {} mm into the return; the step must be at most {:.3} mm high.",
                case.step_height_mm.unwrap_or(f64::NAN),
                self.ball_return.highest / MM
            ));
        }
        let thrust = self.ball_return.thrust()?;
        Some(format!(
            "The thrust on a ball is {thrust:.3} N. If the balls of one turn stand still, friction can push them against this thrust with up to {stopped:.3} N; in steady motion, their friction along the track is {screw:.3} N, which is the value in the published criterion."
        ))
    }
}

impl Friction {
    /// Returns the friction coefficients of a lubricated or dry ball.
    ///
    /// * `screw`: screw contact of the moving ball.
    /// * `dry`: friction coefficient without a lubricant.
    fn of(
        case: &Case,
        solution: &Solution,
        (ball, screw): (&SteadyBall<f64>, &MovingContact),
        dry: f64,
    ) -> Self {
        let Some(film) = solution.steady_state().and_then(|solved| solved.film) else {
            return Self { moving: [dry; 2], stopped: dry, rest: dry };
        };
        // μ_s = μ(¾ p_max, |V_s|)                                         (M23)
        let stopped = film.screw.law.coefficient(0.75, ball.stopped_slip(&screw.touch));
        let rest = case.value_or_default(InputKey::boundary_friction_coefficient);
        let moving = [film.nut.friction, film.screw.friction];
        Self { moving, stopped, rest: rest.unwrap_or(f64::NAN) }
    }

    /// Returns a note that states the friction coefficients of a lubricated ball.
    fn words(&self) -> String {
        let Self { moving: [nut, screw], stopped, rest } = *self;
        let [nut, screw, stopped, rest] = [nut, screw, stopped, rest].map(format_number);
        format!(
            "Friction coefficients: {nut} at the nut and {screw} at the screw during motion; {stopped} at the screw for a stopped ball, with the same lubricant film as during motion; {rest} at rest, between balls and in the ball return."
        )
    }
}

impl PermanentContacts {
    fn of(case: &Case, wedge: &Wedge<f64>) -> Result<Self, CaseError> {
        let screw = case.reader().elastic_point();
        let failed = |reason: &Reason| CaseError::Invalid(message(reason));
        let set =
            screw.permanent_set(wedge.loads, wedge.angles).map_err(|none| failed(none.reason()))?;
        let hertz = screw.hertz().map_err(|reason| failed(&reason))?;
        Ok(Self { pressures: [0, 1].map(|i| hertz[i].max_pressure(set.loads[i])), set })
    }
}

impl Track {
    fn of(balls: f64, wedge: &Wedge<f64>, friction: &Friction) -> Self {
        let stopped = track_friction(balls, friction.stopped, wedge.loads[1], FRAC_PI_2);
        let clean = |force: f64| if force < ROUNDING * stopped { 0.0 } else { force };
        let along = |i: usize| {
            track_friction(balls, wedge.friction[i], wedge.loads[i], wedge.slip_angles[i])
        };
        let [nut, screw] = [0, 1].map(|i| clean(along(i)));
        Self { screw, weaker: nut.min(screw), stopped }
    }
}

impl BallReturn {
    fn of(case: &Case, ball: &SteadyBall<f64>, friction: f64) -> Self {
        let point = case.reader().operating_point();
        let speed = case.return_approach_speed_m_s.unwrap_or_else(|| {
            let to_nut = ball.motion.precession - ball.drive.nut_speed;
            ball.helix.arc_length_per_radian() * to_nut.abs()
        });
        let stiffness = case.return_stiffness_N_um15.map_or_else(
            || flat_stiffness(case.reader().materials().contact_modulus(), ball.radius),
            |k| k * PER_UM15,
        );
        let mass = point.ball.mass;
        let impact = match case.return_linear_stiffness_N_um {
            Some(linear) => linear_impact_force(mass, speed, linear / UM),
            None => impact_force(mass, speed, stiffness),
        };
        let step = case.return_angle_deg.map(|angle| {
            let normal = case.step_normal_force_N.unwrap_or(impact);
            (normal, step_thrust(normal, friction, angle * DEG))
        });
        let entry = entry_step(case, ball.radius);
        Self {
            speed,
            impact,
            apex: case.apex_half_angle_deg.map(|angle| apex_thrust(impact, angle * DEG, friction)),
            step,
            highest: entry.max_step_height() * ball.radius,
            entered: case
                .step_height_mm
                .and(case.return_angle_deg)
                .map(|_| entry.thrust_ratio().unwrap_or(f64::INFINITY)),
        }
    }

    /// Returns the push force that is needed to lift a ball over the step at the entry to the ball
    /// return while the ball ahead is at the apex.
    fn entry_thrust(&self) -> Option<f64> {
        Some(self.entered.filter(|ratio| ratio.is_finite())? * self.apex?)
    }

    /// Returns true if no push force can lift a ball over the step at the entry to the ball return.
    fn is_blocked(&self) -> bool {
        self.entered.is_some_and(f64::is_infinite)
    }

    /// Returns the largest push force in the ball return.
    fn thrust(&self) -> Option<f64> {
        let thrusts = [self.apex, self.step.map(|(_, thrust)| thrust), self.entry_thrust()];
        thrusts.into_iter().flatten().reduce(f64::max)
    }
}

/// Returns the step at the entry to the ball return. Its height defaults to zero.
fn entry_step(case: &Case, ball_radius: f64) -> EntryStep {
    EntryStep {
        height: case.step_height_mm.unwrap_or(0.0) * MM / ball_radius,
        angle: case.return_angle_deg.unwrap_or(0.0) * DEG,
        rolling: case.rolling_friction_mm.unwrap_or(0.0) * MM / ball_radius,
    }
}
