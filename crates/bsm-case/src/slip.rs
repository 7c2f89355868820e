//! Slip of a solved ball in the vocabulary.

use bsm_dyn::{
    Basis, Coulomb, Model, Quadrature, RacewayControl, Sliding, SlipPower, Solution, Traction,
    pressed_radius, rim_speed,
};
use bsm_kin::Site;

use crate::analysis::{MovingBall, MovingContact};
use crate::{Analysis, Block, CaseError, Scene, Settings};

/// Relative difference of friction power and dissipated power that rounding explains: the motion is
/// read back from outputs, whose largest speeds may be a million times the slip.
const POWERS_AGREE: f64 = 1e-6;

impl Analysis {
    /// Differential slip, slip between balls, spin and orbit slip in published and in exact form,
    /// and the power that each part of the slip takes.
    ///
    /// * `settings`: those that `solution` was found with.
    ///
    /// # Errors
    ///
    /// [`CaseError::NoMotion`] if the model has no motion of the ball.
    pub fn slip(
        scene: &Scene,
        settings: &Settings,
        solution: &Solution,
    ) -> Result<Self, CaseError> {
        let solved = MovingBall::of(scene, solution)?;
        let mut report = Self::of(scene, solution);
        report.blocks = vec![between(&solved), at_contacts(&solved)];
        if solved.contacts[0].is_some_and(|c| c.semi_axes.is_none()) {
            report.lacks.push(
                "spin slip at the ends of the contact ellipses: nut_conformity, \
                 screw_conformity and a model with elastic contacts"
                    .to_owned(),
            );
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
        report.blocks.push(powers.block(dissipated, difference));
        report.finite()
    }
}

fn between(solved: &MovingBall) -> Block {
    let ball = &solved.ball;
    let mut block = Block::new("slip between neighbouring balls");
    block.whole("ball_slip_published_m_s", "m/s", "as published", ball.ball_slip_published());
    block.whole("ball_slip_m_s", "m/s", "slip speed of their surfaces", ball.ball_slip());
    block
}

fn at_contacts(solved: &MovingBall) -> Block {
    let ball = &solved.ball;
    let mut block = Block::new("slip at the contacts");
    let mut line = |key, unit, about, number: &dyn Fn(&MovingContact) -> f64| {
        block.contacts(key, unit, about, solved.each(number));
    };
    line("differential_slip_m_s", "m/s", "differential slip, at the centre", &|c| {
        ball.differential_slip(&c.touch)
    });
    line("slide_roll_ratio", "", "differential slip over rolling speed", &|c| {
        ball.slide_roll_ratio(&c.touch)
    });
    line("rolling_speed_m_s", "m/s", "rolling speed", &|c| ball.rolling_speed(&c.touch));
    line("spin_slip_published_m_s", "m/s", "spin slip as published", &|c| {
        ball.spin_slip_published(&c.touch)
    });
    line("spin_rad_s", "rad/s", "spin about the normal", &|c| ball.spin(&c.touch));
    line("orbit_slip_published_m_s", "m/s", "orbit slip as published", &|c| {
        ball.orbit_slip_published(&c.touch)
    });
    line("orbit_spin_rad_s", "rad/s", "part of the spin from the orbit", &|c| {
        ball.orbit_spin(&c.touch)
    });
    let rim = |rate: &dyn Fn(&MovingContact) -> f64| {
        solved.contacts.map(|c| {
            let contact = c?;
            Some(rim_speed(rate(&contact), contact.semi_axes?.0))
        })
    };
    let spin = rim(&|c| ball.spin(&c.touch));
    let orbit = rim(&|c| ball.orbit_spin(&c.touch));
    block.contacts("spin_slip_m_s", "m/s", "spin at the end of the ellipse", spin);
    block.contacts("orbit_slip_m_s", "m/s", "part of it from the orbit", orbit);
    block
}

/// Powers of the parts of the slip at each contact, all balls \[W\].
struct Powers([Option<SlipPower<f64>>; 3]);

impl Powers {
    fn of(
        scene: &Scene,
        settings: &Settings,
        solution: &Solution,
        solved: &MovingBall,
    ) -> Result<Self, CaseError> {
        let case = scene.reader().rigid();
        let unit = case.ball.radius * case.drive.relative_speed().abs();
        let (accuracy, creep) = match (solution.model, solution.choice.map(|c| c.basis)) {
            (Model::Traction, Some(Basis::Integrated { accuracy })) => (accuracy, Traction::CREEP),
            (Model::Traction, _) => (settings.accuracy, settings.creep),
            _ => (RacewayControl::ACCURACY, RacewayControl::CREEP),
        };
        let quadrature = &Quadrature::of(accuracy);
        let saturated = matches!(solution.model, Model::Rigid | Model::Elastic);
        let power = |contact: &MovingContact| {
            let sliding = match contact.semi_axes {
                Some(semi_axes) if !saturated => {
                    let conformity = match contact.touch.site {
                        Site::Screw => scene.screw_conformity,
                        Site::Nut | Site::NutMinor => scene.nut_conformity,
                    };
                    let pressed_radius =
                        pressed_radius(conformity.unwrap_or(f64::NAN), case.ball.radius);
                    let creep = creep * unit;
                    Sliding::Ellipse { semi_axes, pressed_radius, creep, quadrature }
                }
                _ => Sliding::Point,
            };
            let ball = &solved.ball;
            let law = Coulomb(case.friction);
            let wrench = ball.friction(&contact.touch, contact.load, &law, sliding);
            let wrench = wrench.map_err(|e| CaseError::NotRated(e.to_string()))?;
            let SlipPower { centre, spin, curvature } = ball.power(&contact.touch, &wrench);
            let balls = case.load.balls;
            Ok(SlipPower {
                centre: centre * balls,
                spin: spin * balls,
                curvature: curvature * balls,
            })
        };
        let [nut, screw, minor] = solved.contacts.each_ref();
        let power = |contact: &Option<MovingContact>| contact.as_ref().map(power).transpose();
        Ok(Self([power(nut)?, power(screw)?, power(minor)?]))
    }

    fn total(&self) -> f64 {
        self.0.iter().flatten().map(SlipPower::total).sum()
    }

    fn block(&self, dissipated: f64, difference: f64) -> Block {
        let mut block = Block::new("friction power, all balls");
        let mut line = |key, about, number: fn(&SlipPower<f64>) -> f64| {
            block.contacts(key, "W", about, self.0.map(|p| p.as_ref().map(number)));
        };
        line("centre_power_W", "on the slip at the centre", |p| p.centre);
        line("spin_power_W", "on the spin", |p| p.spin);
        line("curvature_power_W", "on the slip of the curved surface", |p| p.curvature);
        line("friction_power_W", "friction power", SlipPower::total);
        block.whole("friction_power_W", "W", "all contacts", self.total());
        block.whole("dissipated_power_W", "W", "dissipated by the model", dissipated);
        if difference.is_finite() {
            block.whole("power_difference", "", "relative difference", difference);
        }
        block
    }
}
