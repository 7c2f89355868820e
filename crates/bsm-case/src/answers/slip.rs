//! Slip of a solved ball. The results are named quantities with units.

use bsm_dyn::{
    Coulomb, Model, Solution,
    hertz::{Quadrature, pressed_radius},
    lubrication::{FrictionLaw, MixedFriction},
    model::{Basis, RacewayControl, Sliding, Traction},
    solution::{SlipPower, rim_speed},
};
use bsm_kin::Site;

use crate::answers::motion::{MovingBall, MovingContact, lacks_ellipses, motion_answer};
use crate::vocabulary::members::number_tables;
use crate::vocabulary::quantity::{Values, quantities};
use crate::vocabulary::units::{DEG, MM};
use crate::{Answer, Case, CaseError, Settings};

number_tables! {
    /// Results of a slip analysis.
    pub(crate) SlipNumbers = QUANTITIES.iter();
}

quantities! { pub(crate) QUANTITIES, read(&SlipMotion) of Slip;
    "rotation of the ball relative to the nut" {
        gyroscopic_angle_deg ["deg"] Scalar(|s| s.solved.ball.gyroscopic_angles()[0] / DEG),
            "gyroscopic angle between the axis of rotation and the plane of t (along the helix) and b (binormal)";
        gyroscopic_yaw_angle_deg ["deg"] Scalar(|s| s.solved.ball.gyroscopic_angles()[1] / DEG),
            "gyroscopic angle in the plane of t (along the helix) and b (binormal), from -b towards t";
    }
    "slip between neighboring balls" {
        ball_slip_printed_m_s ["m/s"] Scalar(|s| s.solved.ball.ball_slip_published()), "slip speed between neighboring balls, formula of Xu and Tang";
        ball_slip_m_s ["m/s"] Scalar(|s| s.solved.ball.ball_slip()), "slip speed between neighboring balls, exact";
    }
    "slip at the contacts" {
        differential_slip_m_s ["m/s"] Contacts(|s| s.solved.each(|c| s.solved.ball.differential_slip(&c.touch))), "slip speed at the center of the contact";
        slide_roll_ratio [""] Contacts(|s| s.solved.each(|c| s.solved.ball.slide_roll_ratio(&c.touch))), "slide-roll ratio: slip speed at the center of the contact / rolling speed";
        rolling_speed_m_s ["m/s"] Contacts(|s| s.solved.each(|c| s.solved.ball.rolling_speed(&c.touch))), "rolling speed";
        spin_slip_printed_m_s ["m/s"] Contacts(|s| s.printed(|_, angle| s.solved.ball.spin_slip_published(angle))), "spin slip, formula of Xu and Tang";
        spin_slip_corrected_m_s ["m/s"] Contacts(|s| s.solved.each(|c| s.solved.ball.spin_slip_published(c.touch.angle))), "spin slip, corrected formula";
        spin_rad_s ["rad/s"] Contacts(|s| s.solved.each(|c| s.solved.ball.spin(&c.touch))), "spin about the normal";
        orbit_slip_printed_m_s ["m/s"] Contacts(|s| s.printed(|site, angle| s.solved.ball.orbit_slip_published(site, angle))), "orbit slip, formula of Xu and Tang";
        orbit_slip_corrected_m_s ["m/s"] Contacts(|s| s.solved.each(|c| s.solved.ball.orbit_slip_published(c.touch.site, c.touch.angle))), "orbit slip, corrected formula";
        orbit_spin_rad_s ["rad/s"] Contacts(|s| s.solved.each(|c| s.solved.ball.orbit_spin(&c.touch))), "part of the spin due to the orbital motion";
        spin_slip_m_s ["m/s"] Contacts(|s| s.at_rim(|c| s.solved.ball.spin(&c.touch))) needs [nut_conformity, screw_conformity],
            "spin slip, exact, at the end of the ellipse";
        orbit_slip_m_s ["m/s"] Contacts(|s| s.at_rim(|c| s.solved.ball.orbit_spin(&c.touch))) needs [nut_conformity, screw_conformity],
            "orbit slip, exact: part of the spin slip at the end of the ellipse that is due to the orbital motion";
    }
    "friction at the contacts" {
        used_friction_coefficient [""] Contacts(|s| s.friction(|f| f.used)),
            "utilized friction coefficient: friction force / normal load";
    }
    "moments about the tangent" {
        tangent_friction_moment_Nmm ["N mm"] Contacts(|s| s.friction(|f| f.moment / MM)), "moment of friction on the ball about the tangent";
        gyroscopic_moment_Nmm ["N mm"] Scalar(|s| Some(s.loss.as_ref()?.gyroscopic_moment / MM)),
            "gyroscopic moment about the tangent, which equals the sum of the friction moments";
    }
    "friction power, all balls" {
        center_power_W ["W"] Contacts(|s| s.friction(|f| f.power.center)), "friction power of the slip at the center of the contact";
        spin_power_W ["W"] Contacts(|s| s.friction(|f| f.power.spin)), "friction power of the spin";
        curvature_power_W ["W"] Contacts(|s| s.friction(|f| f.power.curvature)), "friction power of the slip due to the curved surface";
        friction_power_W ["W"] Contacts(|s| s.friction(|f| f.power.total())), "friction power";
        total_friction_power_W ["W"] Scalar(|s| Some(s.loss.as_ref()?.total())), "friction power of all contacts";
        dissipated_power_W ["W"] Scalar(|s| Some(s.loss.as_ref()?.dissipated)), "power dissipation that the model calculates";
        power_difference [""] Scalar(|s| Some(s.loss.as_ref()?.difference()).filter(|x| x.is_finite())),
            "relative difference between friction power and the power that the model dissipates by sliding";
    }
}

/// Largest relative difference between friction power and dissipated power that can be attributed
/// to rounding errors. The motion is reconstructed from outputs, and the largest speeds can be a
/// million times the slip.
const POWERS_AGREE: f64 = 1e-6;

/// Largest permitted relative difference between friction power and dissipated power of a
/// lubricated ball. The friction coefficient of a film varies over the ellipse. Model and analysis
/// integrate it at different points, which causes differences of up to 3e-4.
const POWERS_AGREE_IN_FILMS: f64 = 1e-3;

/// Calculates the gyroscopic angles, the differential slip, the slip between neighboring balls, the
/// spin and the orbit slip. Each formula is evaluated as printed, as corrected and in exact form.
/// The function also calculates the power that each component of the slip dissipates.
///
/// If running contact angles are given, the ball rolls at these angles. Friction and its power are
/// then omitted, because the given angles are not in equilibrium with the load.
///
/// * `settings`: settings with which `solution` was calculated.
///
/// # Errors
///
/// Returns [`CaseError::Invalid`] if the model does not calculate the motion of the ball. Returns
/// [`CaseError::OutOfRange`] if running contact angles are given and the model is not raceway
/// control.
pub fn slip(case: &Case, settings: &Settings, solution: &Solution) -> Result<Answer, CaseError> {
    let (solved, given) =
        MovingBall::of(case, solution)?.at_given_angles(case, settings, solution.model)?;
    let loss = if given { None } else { Some(Loss::of(case, settings, solution, &solved)?) };
    let slipping = SlipMotion { solved, loss };
    let mut lacks = Vec::new();
    if solved.contacts[0].is_some_and(|c| c.semi_axes.is_none()) {
        lacks.push(lacks_ellipses("spin slip at the ends of the contact ellipses", solution.model));
    }
    if given {
        lacks.push(
            "friction and its power: needs contact angles in equilibrium with the load instead of given contact angles"
                .to_owned(),
        );
    }
    let numbers = read(&slipping, |_| true).finite()?;
    let mut answer = motion_answer::<SlipNumbers>(case, solution, numbers, Vec::new(), lacks);
    let agree = if case.given().is_lubricated() { POWERS_AGREE_IN_FILMS } else { POWERS_AGREE };
    if let Some(loss) = slipping.loss.filter(|loss| loss.difference().abs() > agree) {
        answer.warnings.push(format!(
            "The friction power of the contacts is {:.6e} W, but the model dissipates \
             {:.6e} W by sliding, so the parts do not add up here.",
            loss.total(),
            loss.sliding
        ));
    }
    Ok(answer)
}

/// Motion of a ball, and the friction losses at its contacts.
struct SlipMotion {
    solved: MovingBall,
    /// Friction losses; `None` if the contact angles are given.
    loss: Option<Loss>,
}

impl SlipMotion {
    /// Applies a printed formula to the nut and screw contacts. As in the publication, the formula
    /// for each contact uses the contact angle of the other contact. There is no printed formula
    /// for the unloaded flank.
    fn printed(&self, form: impl Fn(Site, f64) -> f64) -> [Option<f64>; 2] {
        let [nut, screw, _] = self.solved.contacts.map(|c| c.map(|c| c.touch.angle));
        [(Site::Nut, screw), (Site::Screw, nut)].map(|(site, angle)| Some(form(site, angle?)))
    }

    /// Returns the slip speed that an angular velocity causes at the ends of each contact ellipse.
    fn at_rim(&self, rate: impl Fn(&MovingContact) -> f64) -> Values {
        self.solved.contacts.map(|c| {
            let contact = c?;
            Some(rim_speed(rate(&contact), contact.semi_axes?.0))
        })
    }

    fn friction(&self, number: fn(&ContactFriction) -> f64) -> Values {
        self.loss.as_ref().map_or([None; 3], |loss| loss.contacts.map(|c| c.as_ref().map(number)))
    }
}

impl Case {
    /// Returns the radius of the deformed contact surface \[m\].
    pub(crate) fn pressed_radius(&self, site: Site) -> f64 {
        let conformity = match site {
            Site::Screw => self.screw_conformity,
            Site::Nut | Site::NutUnloaded => self.nut_conformity,
        };
        let radius = 0.5 * MM * self.ball_diameter_mm.unwrap_or(f64::NAN);
        pressed_radius(conformity.unwrap_or(f64::NAN), radius)
    }
}

/// Returns the accuracy with which the friction over the contact ellipses of a solution was
/// integrated, and the creep speed of the solution relative to `$r_b |W|$`.
pub(crate) fn integration(settings: &Settings, solution: &Solution) -> (f64, f64) {
    match (solution.model, solution.choice.map(|c| c.basis)) {
        (Model::Traction, Some(Basis::Integrated { accuracy })) => (accuracy, Traction::CREEP),
        (Model::Traction, _) => (settings.accuracy, settings.creep),
        _ => (RacewayControl::ACCURACY, RacewayControl::CREEP),
    }
}

/// Local friction law: a constant friction coefficient, or a lubricant film.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Law {
    Dry(Coulomb<f64>),
    Lubricated(MixedFriction),
}

impl FrictionLaw<f64> for Law {
    fn coefficient(&self, pressure: f64, speed: f64) -> f64 {
        match self {
            Self::Dry(law) => law.coefficient(pressure, speed),
            Self::Lubricated(law) => law.coefficient(pressure, speed),
        }
    }

    fn bend(&self) -> Option<bsm_dyn::lubrication::Transition> {
        match self {
            Self::Dry(law) => FrictionLaw::<f64>::bend(law),
            Self::Lubricated(law) => law.bend(),
        }
    }
}

impl Law {
    /// Returns the friction law at a contact of a solution. The unloaded flank uses the film of the
    /// loaded nut contact.
    ///
    /// * `dry`: friction law of dry contacts.
    pub(crate) fn of(site: Site, dry: Coulomb<f64>, solution: &Solution) -> Self {
        match solution.steady_state().and_then(|solved| solved.film) {
            Some(film) if site == Site::Screw => Self::Lubricated(film.screw.law),
            Some(film) => Self::Lubricated(film.nut.law),
            None => Self::Dry(dry),
        }
    }
}

/// Friction power at each contact, and the power that the model dissipates.
struct Loss {
    contacts: [Option<ContactFriction>; 3],
    /// Power that the model dissipates \[W\].
    dissipated: f64,
    /// Part of the dissipated power that is due to sliding at the contacts \[W\]. Without a
    /// lubricant, this part equals `dissipated`.
    sliding: f64,
    /// Gyroscopic moment \[N·m\].
    gyroscopic_moment: f64,
}

#[derive(Debug, Clone, Copy)]
struct ContactFriction {
    /// Powers of the slip components, summed over all balls \[W\].
    power: SlipPower<f64>,
    /// Ratio of friction force to normal load.
    used: f64,
    /// Friction moment on the ball about the tangent \[N·m\].
    moment: f64,
}

impl Loss {
    fn of(
        case: &Case,
        settings: &Settings,
        solution: &Solution,
        solved: &MovingBall,
    ) -> Result<Self, CaseError> {
        let point = case.reader().operating_point();
        let unit = point.ball.radius * point.drive.relative_speed().abs();
        let (accuracy, creep) = integration(settings, solution);
        let quadrature = &Quadrature::of(accuracy);
        let saturated = matches!(solution.model, Model::Rigid | Model::Elastic);
        let power = |contact: &MovingContact| {
            let sliding = match contact.semi_axes {
                Some(semi_axes) if !saturated => {
                    let pressed_radius = case.pressed_radius(contact.touch.site);
                    let creep = creep * unit;
                    Sliding::Ellipse { semi_axes, pressed_radius, creep, quadrature }
                }
                _ => Sliding::Point,
            };
            let ball = &solved.ball;
            let law = Law::of(contact.touch.site, point.friction, solution);
            let wrench = ball.friction(&contact.touch, contact.load, &law, sliding);
            let wrench = wrench.map_err(|e| CaseError::Invalid(e.to_string()))?;
            let SlipPower { center, spin, curvature } = ball.power(&contact.touch, &wrench);
            let balls = point.load.balls;
            let power = SlipPower {
                center: center * balls,
                spin: spin * balls,
                curvature: curvature * balls,
            };
            // f_used = |F|/Q                                                  (X15)
            let used = wrench.force.norm() / contact.load;
            Ok(ContactFriction { power, used, moment: wrench.moment.x })
        };
        let [nut, screw, unloaded] = solved.contacts.each_ref();
        let power = |contact: &Option<MovingContact>| contact.as_ref().map(power).transpose();
        let dissipated = solution
            .steady_state()
            .and_then(|solved| solved.transmission.power)
            .map_or(f64::NAN, |power| power.dissipated);
        let film = solution.steady_state().and_then(|solved| solved.film);
        let sliding = film.map_or(dissipated, |film| film.sliding_power);
        let gyroscopic_moment = solved.ball.gyroscopic_moment(point.ball.inertia());
        let contacts = [power(nut)?, power(screw)?, power(unloaded)?];
        Ok(Self { contacts, dissipated, sliding, gyroscopic_moment })
    }

    fn total(&self) -> f64 {
        self.contacts.iter().flatten().map(|friction| friction.power.total()).sum()
    }

    /// Returns the relative difference between the friction power of the contacts and the sliding
    /// power of the model.
    fn difference(&self) -> f64 {
        self.total() / self.sliding - 1.0
    }
}
