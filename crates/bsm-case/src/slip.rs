//! Slip of a solved ball in the vocabulary.

use bsm_dyn::{
    Basis, Model, Quadrature, RacewayControl, Sliding, SlipPower, Solution, Traction,
    pressed_radius, rim_speed,
};
use bsm_kin::Site;

use crate::analysis::{MovingBall, MovingContact};
use crate::quantity::{Contacts, quantities};
use crate::units::{DEG, MM};
use crate::{Analysis, AnalysisKind, CaseError, Numbers, Scene, Settings};

quantities! { Slip;
    "rotation of the ball relative to the nut" {
        gyroscopic_angle_deg ["deg"] Whole, "gyroscopic angle: axis of rotation out of the plane of t and b";
        gyroscopic_yaw_angle_deg ["deg"] Whole, "gyroscopic angle in that plane, from -b towards t";
    }
    "slip between neighbouring balls" {
        ball_slip_printed_m_s ["m/s"] Whole, "slip speed between neighbouring balls as printed";
        ball_slip_m_s ["m/s"] Whole, "slip speed of the surfaces of neighbouring balls";
    }
    "slip at the contacts" {
        differential_slip_m_s ["m/s"] Contacts, "differential slip, at the centre";
        slide_roll_ratio [""] Contacts, "differential slip over rolling speed";
        rolling_speed_m_s ["m/s"] Contacts, "rolling speed";
        spin_slip_printed_m_s ["m/s"] Contacts, "spin slip as printed";
        spin_slip_corrected_m_s ["m/s"] Contacts, "spin slip as corrected";
        spin_rad_s ["rad/s"] Contacts, "spin about the normal";
        orbit_slip_printed_m_s ["m/s"] Contacts, "orbit slip as printed";
        orbit_slip_corrected_m_s ["m/s"] Contacts, "orbit slip as corrected";
        orbit_spin_rad_s ["rad/s"] Contacts, "part of the spin from the orbit";
        spin_slip_m_s ["m/s"] Contacts needs [nut_conformity, screw_conformity],
            "spin slip at the end of the ellipse";
        orbit_slip_m_s ["m/s"] Contacts needs [nut_conformity, screw_conformity],
            "part of the spin slip at the end of the ellipse from the orbit";
    }
    "friction at the contacts" {
        used_friction_coefficient [""] Contacts,
            "friction force over normal load: the friction coefficient that the motion takes";
    }
    "moments about the tangent" {
        tangent_friction_moment_Nmm ["N mm"] Contacts, "moment of friction on the ball about the tangent";
        gyroscopic_moment_Nmm ["N mm"] Whole, "gyroscopic moment about the tangent, the sum of those of friction";
    }
    "friction power, all balls" {
        centre_power_W ["W"] Contacts, "friction power on the slip at the centre";
        spin_power_W ["W"] Contacts, "friction power on the spin";
        curvature_power_W ["W"] Contacts, "friction power on the slip of the curved surface";
        friction_power_W ["W"] Contacts, "friction power";
        total_friction_power_W ["W"] Whole, "friction power of all contacts";
        dissipated_power_W ["W"] Whole, "power dissipated by the model";
        power_difference [""] Whole, "relative difference of friction power and dissipated power";
    }
}

/// Relative difference of friction power and dissipated power that rounding explains: the motion is
/// read back from outputs, whose largest speeds may be a million times the slip.
const POWERS_AGREE: f64 = 1e-6;

impl Analysis {
    /// Gyroscopic angles, differential slip, slip between balls, spin and orbit slip as printed, as
    /// corrected and in exact form, and the power that each part of the slip takes.
    ///
    /// Where the scene gives the contact angles in motion, the ball rolls at these, and there is neither
    /// friction nor power: the loads are in balance at other angles.
    ///
    /// * `settings`: those that `solution` was found with.
    ///
    /// # Errors
    ///
    /// [`CaseError::NoMotion`] if the model has no motion of the ball, [`CaseError::NotCovered`] if the
    /// scene gives the contact angles in motion and the model is not raceway control,
    /// [`CaseError::DryAnalysis`] with a lubricant.
    pub fn slip(
        scene: &Scene,
        settings: &Settings,
        solution: &Solution,
    ) -> Result<Self, CaseError> {
        let (solved, given) =
            MovingBall::of(scene, solution)?.at_given_angles(scene, settings, solution.model)?;
        let mut report = Self::of(AnalysisKind::Slip, scene, solution);
        between(&mut report.numbers, &solved);
        at_contacts(&mut report.numbers, &solved);
        if solved.contacts[0].is_some_and(|c| c.semi_axes.is_none()) {
            report.lacks_ellipses("spin slip at the ends of the contact ellipses");
        }
        if given {
            report.lacks.push(
                "friction and its power: contact angles in balance with the load, in place of given ones"
                    .to_owned(),
            );
            return report.finite();
        }
        let powers = Powers::of(scene, settings, solution, &solved)?;
        let dissipated = solution
            .solved()
            .and_then(|solved| solved.transmission.power)
            .map_or(f64::NAN, |power| power.dissipated);
        let difference = powers.total() / dissipated - 1.0;
        if difference.abs() > POWERS_AGREE {
            report.warnings.push(format!(
                "the friction power of the contacts is {:.6e} W, but the model dissipates \
                 {dissipated:.6e} W: the parts do not add up here",
                powers.total()
            ));
        }
        powers.enter(&mut report.numbers, dissipated, difference);
        let inertia = scene.reader().operating_point().ball.inertia();
        let moment = solved.ball.gyroscopic_moment(inertia) / MM;
        report.numbers.whole(gyroscopic_moment_Nmm, moment);
        report.finite()
    }
}

fn between(numbers: &mut Numbers, solved: &MovingBall) {
    let [angle, yaw] = solved.ball.gyroscopic_angles();
    numbers.whole(gyroscopic_angle_deg, angle / DEG);
    numbers.whole(gyroscopic_yaw_angle_deg, yaw / DEG);
    numbers.whole(ball_slip_printed_m_s, solved.ball.ball_slip_published());
    numbers.whole(ball_slip_m_s, solved.ball.ball_slip());
}

fn at_contacts(numbers: &mut Numbers, solved: &MovingBall) {
    let ball = &solved.ball;
    let mut line = |place, number: &dyn Fn(&MovingContact) -> f64| {
        numbers.contacts(place, solved.each(number));
    };
    line(differential_slip_m_s, &|c| ball.differential_slip(&c.touch));
    line(slide_roll_ratio, &|c| ball.slide_roll_ratio(&c.touch));
    line(rolling_speed_m_s, &|c| ball.rolling_speed(&c.touch));
    line(spin_slip_corrected_m_s, &|c| ball.spin_slip_published(c.touch.angle));
    line(spin_rad_s, &|c| ball.spin(&c.touch));
    line(orbit_slip_corrected_m_s, &|c| ball.orbit_slip_published(c.touch.site, c.touch.angle));
    line(orbit_spin_rad_s, &|c| ball.orbit_spin(&c.touch));
    // As printed a contact takes the angle of the other loaded one; the minor contact has no formula.
    let [nut, screw, _] = solved.contacts.map(|c| c.map(|c| c.touch.angle));
    let others = [(Site::Nut, screw), (Site::Screw, nut)];
    let printed = |form: &dyn Fn(Site, f64) -> f64| {
        let [at_nut, at_screw] = others.map(|(site, angle)| angle.map(|angle| form(site, angle)));
        [at_nut, at_screw, None]
    };
    numbers.contacts(spin_slip_printed_m_s, printed(&|_, angle| ball.spin_slip_published(angle)));
    numbers
        .contacts(orbit_slip_printed_m_s, printed(&|site, b| ball.orbit_slip_published(site, b)));
    let rim = |rate: &dyn Fn(&MovingContact) -> f64| {
        solved.contacts.map(|c| {
            let contact = c?;
            Some(rim_speed(rate(&contact), contact.semi_axes?.0))
        })
    };
    numbers.contacts(spin_slip_m_s, rim(&|c| ball.spin(&c.touch)));
    numbers.contacts(orbit_slip_m_s, rim(&|c| ball.orbit_spin(&c.touch)));
}

impl Scene {
    /// Radius of the surface that ball and groove press each other to \[m\].
    pub(crate) fn pressed_radius(&self, site: Site) -> f64 {
        let conformity = match site {
            Site::Screw => self.screw_conformity,
            Site::Nut | Site::NutMinor => self.nut_conformity,
        };
        let radius = 0.5 * MM * self.ball_diameter_mm.unwrap_or(f64::NAN);
        pressed_radius(conformity.unwrap_or(f64::NAN), radius)
    }
}

/// Accuracy of the integration over the ellipses that a solution was found with, and its creep speed over `$r_b |W|$`.
pub(crate) fn integration(settings: &Settings, solution: &Solution) -> (f64, f64) {
    match (solution.model, solution.choice.map(|c| c.basis)) {
        (Model::Traction, Some(Basis::Integrated { accuracy })) => (accuracy, Traction::CREEP),
        (Model::Traction, _) => (settings.accuracy, settings.creep),
        _ => (RacewayControl::ACCURACY, RacewayControl::CREEP),
    }
}

/// Friction at each contact.
struct Powers([Option<ContactFriction>; 3]);

#[derive(Debug, Clone, Copy)]
struct ContactFriction {
    /// Powers of the parts of the slip, all balls \[W\].
    power: SlipPower<f64>,
    /// Friction over normal load.
    used: f64,
    /// Moment on the ball about the tangent \[N·m\].
    moment: f64,
}

impl Powers {
    fn of(
        scene: &Scene,
        settings: &Settings,
        solution: &Solution,
        solved: &MovingBall,
    ) -> Result<Self, CaseError> {
        let case = scene.reader().operating_point();
        let unit = case.ball.radius * case.drive.relative_speed().abs();
        let (accuracy, creep) = integration(settings, solution);
        let quadrature = &Quadrature::of(accuracy);
        let saturated = matches!(solution.model, Model::Rigid | Model::Elastic);
        let power = |contact: &MovingContact| {
            let sliding = match contact.semi_axes {
                Some(semi_axes) if !saturated => {
                    let pressed_radius = scene.pressed_radius(contact.touch.site);
                    let creep = creep * unit;
                    Sliding::Ellipse { semi_axes, pressed_radius, creep, quadrature }
                }
                _ => Sliding::Point,
            };
            let ball = &solved.ball;
            let law = case.friction;
            let wrench = ball.friction(&contact.touch, contact.load, &law, sliding);
            let wrench = wrench.map_err(|e| CaseError::NotRated(e.to_string()))?;
            let SlipPower { centre, spin, curvature } = ball.power(&contact.touch, &wrench);
            let balls = case.load.balls;
            let power = SlipPower {
                centre: centre * balls,
                spin: spin * balls,
                curvature: curvature * balls,
            };
            // f_used = |F|/Q                                                  (X15)
            let used = wrench.force.norm() / contact.load;
            Ok(ContactFriction { power, used, moment: wrench.moment.x })
        };
        let [nut, screw, minor] = solved.contacts.each_ref();
        let power = |contact: &Option<MovingContact>| contact.as_ref().map(power).transpose();
        Ok(Self([power(nut)?, power(screw)?, power(minor)?]))
    }

    fn total(&self) -> f64 {
        self.0.iter().flatten().map(|friction| friction.power.total()).sum()
    }

    fn enter(&self, numbers: &mut Numbers, dissipated: f64, difference: f64) {
        let mut line = |place: Contacts, number: fn(&ContactFriction) -> f64| {
            numbers.contacts(place, self.0.map(|contact| contact.as_ref().map(number)));
        };
        line(used_friction_coefficient, |friction| friction.used);
        line(tangent_friction_moment_Nmm, |friction| friction.moment / MM);
        line(centre_power_W, |friction| friction.power.centre);
        line(spin_power_W, |friction| friction.power.spin);
        line(curvature_power_W, |friction| friction.power.curvature);
        line(friction_power_W, |friction| friction.power.total());
        numbers.whole(total_friction_power_W, self.total());
        numbers.whole(dissipated_power_W, dissipated);
        numbers.whole(power_difference, Some(difference).filter(|x| x.is_finite()));
    }
}
