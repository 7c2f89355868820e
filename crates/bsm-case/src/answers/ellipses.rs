//! Pressure, slip and friction over the contact ellipses of a solved ball.

use bsm_dyn::{
    ContactFilm, Coulomb, EllipseSlip, FrictionLaw, MixedFriction, Model, Quadrature, Sliding,
    Solution,
};
use bsm_kin::{BallFrame, Site};
use serde_json::{Value, json};

use crate::answers::analysis::{MovingBall, MovingContact};
use crate::answers::slip::integration;
use crate::vocabulary::units::{DEG, MM, MPA};
use crate::{CaseError, Scales, Scene, Settings};

/// The two ellipses of a ball as JSON: grids of slip and friction, what stands still, and what follows from them.
#[derive(Debug, Clone, PartialEq)]
pub struct EllipseFields(Vec<Value>);

/// Friction at a point: of one coefficient, or of a lubricant.
#[derive(Debug, Clone, Copy)]
enum Law {
    Dry(Coulomb<f64>),
    Oiled(MixedFriction),
}

impl FrictionLaw<f64> for Law {
    fn coefficient(&self, pressure: f64, speed: f64) -> f64 {
        match self {
            Self::Dry(law) => law.coefficient(pressure, speed),
            Self::Oiled(law) => law.coefficient(pressure, speed),
        }
    }

    fn bend(&self) -> Option<bsm_dyn::Transition> {
        match self {
            Self::Dry(law) => FrictionLaw::<f64>::bend(law),
            Self::Oiled(law) => law.bend(),
        }
    }
}

impl EllipseFields {
    /// Of a solution with a motion of the ball.
    ///
    /// * `settings`: those that it was found with. * `points`: of the grid on each semi-axis.
    ///
    /// # Errors
    ///
    /// [`CaseError::NoMotion`] if the model has none, [`CaseError::NotRated`] if there is no solution.
    pub fn of(
        scene: &Scene,
        settings: &Settings,
        solution: &Solution,
        points: u32,
    ) -> Result<Self, CaseError> {
        let moving = MovingBall::read(scene, solution)?;
        let film = solution.solved().and_then(|solved| solved.film);
        let case = scene.reader().operating_point();
        let law = |film: Option<ContactFilm>| match film {
            Some(film) => Law::Oiled(film.law),
            None => Law::Dry(case.friction),
        };
        let (accuracy, creep) = integration(settings, solution);
        let creep = creep * case.ball.radius * case.drive.relative_speed().abs();
        let quadrature = Quadrature::of(accuracy);
        let laws = [law(film.map(|film| film.nut)), law(film.map(|film| film.screw))];
        // Next to the rotation of the ball a spin may be rounding.
        let scales = Scales::of([("rad/s", moving.ball.motion.omega.norm())].into_iter());
        let mut fields = Vec::new();
        for (contact, law) in moving.contacts.iter().flatten().zip(laws) {
            let Some(semi_axes) = contact.semi_axes else { continue };
            let MovingContact { touch, load, .. } = contact;
            let pressed_radius = scene.pressed_radius(touch.site);
            // Models of saturated friction have one direction for all points.
            let sliding = match solution.model {
                Model::Rigid | Model::Elastic => Sliding::Point,
                _ => Sliding::Ellipse { semi_axes, pressed_radius, creep, quadrature: &quadrature },
            };
            let ball = &moving.ball;
            let wrench = ball.friction(touch, *load, &law, sliding);
            let wrench = wrench.map_err(|error| CaseError::NotRated(error.to_string()))?;
            let across = BallFrame::tangent().cross(&ball.contact(touch).normal);
            let force = [wrench.force.dot(&across), wrench.force.x];
            let slip = ball.ellipse_slip(touch, semi_axes, pressed_radius, creep);
            let pressed = solution.contact(touch.site).and_then(|contact| contact.pressed);
            let max_pressure = pressed.map_or(f64::NAN, |pressed| pressed.max_pressure / MPA);
            let grid = Grid::of(&slip, (&law, max_pressure), points);
            fields.push(json!({
                "contact": if touch.site == Site::Screw { "screw" } else { "nut" },
                "contact_angle_deg": touch.angle / DEG,
                "normal_load_N": load,
                "semi_axes_mm": [semi_axes.0 / MM, semi_axes.1 / MM],
                "max_pressure_MPa": max_pressure,
                "friction_force_N": force,
                "friction_over_load": force[0].hypot(force[1]) / load,
                "spin_rad_s": scales.clean("rad/s", ball.spin(touch)),
                "creep_speed_m_s": creep,
                "saturated": matches!(sliding, Sliding::Point),
                "rolling_lines": slip.rolling_lines(),
                "spin_poles": slip.spin_poles(),
                "places": grid.places,
                "pressure_MPa": grid.pressure,
                "slip_across_m_s": grid.slip[0],
                "slip_along_m_s": grid.slip[1],
                "friction_across": grid.friction[0],
                "friction_along": grid.friction[1],
                "sticking_share": grid.sticking,
            }));
        }
        Ok(Self(fields))
    }

    /// JSON list, nut and screw: coordinates over the semi-axes, the first across the groove; friction over the
    /// normal pressure; fields by rows along the groove, null outside the ellipse.
    pub fn into_json(self) -> Value {
        Value::Array(self.0)
    }
}

/// Six digits, for fields, which are drawn and not read: a third of the text.
fn few_digits(value: f64) -> f64 {
    let scale = 10.0_f64.powi(5 - exponent(value));
    let rounded = (value * scale).round() / scale;
    if rounded.is_finite() { rounded } else { value }
}

/// Decimal exponent of a number.
fn exponent(value: f64) -> i32 {
    #[expect(
        clippy::cast_possible_truncation,
        reason = "a few hundred at most; of zero it does not matter"
    )]
    let exponent = value.abs().max(1e-200).log10().floor() as i32;
    exponent
}

/// Values at the points of a grid over an ellipse.
struct Grid {
    places: Vec<f64>,
    pressure: Vec<Option<f64>>,
    slip: [Vec<Option<f64>>; 2],
    friction: [Vec<Option<f64>>; 2],
    /// Part of the points that creep: slower than the creep speed.
    sticking: f64,
}

impl Grid {
    fn of(slip: &EllipseSlip<f64>, (law, max_pressure): (&Law, f64), points: u32) -> Self {
        let places: Vec<_> =
            (0..=2 * points).map(|i| f64::from(i) / f64::from(points) - 1.0).collect();
        let mut pressures = Vec::new();
        let mut lists: [Vec<_>; 4] = <_>::default();
        let (mut inside, mut sticking) = (0.0, 0.0);
        for (upsilon, xi) in places.iter().flat_map(|y| places.iter().map(move |x| (*y, *x))) {
            let within = xi.hypot(upsilon) <= 1.0;
            let [along, across] = slip.at(xi, upsilon);
            // p = p_max √(1 − ξ² − υ²), Hertz
            let pressure = max_pressure * (1.0 - xi * xi - upsilon * upsilon).max(0.0).sqrt();
            pressures.push(within.then(|| few_digits(pressure)));
            let [pull_along, pull_across] = slip.friction(xi, upsilon, law);
            for (list, value) in lists.iter_mut().zip([across, along, pull_across, pull_along]) {
                list.push(within.then(|| few_digits(value)));
            }
            if within {
                inside += 1.0;
                sticking += f64::from(u8::from(slip.creeps(xi, upsilon)));
            }
        }
        let [across, along, pull_across, pull_along] = lists;
        Self {
            places,
            pressure: pressures,
            slip: [across, along],
            friction: [pull_across, pull_along],
            sticking: sticking / inside,
        }
    }
}
