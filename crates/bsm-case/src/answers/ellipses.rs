//! Pressure, slip and friction over the contact ellipses of a solved ball.

use bsm_dyn::{
    Model, Solution,
    hertz::{EllipseSlip, Quadrature},
    model::Sliding,
};
use bsm_kin::{BallFrame, Site};

use crate::answers::motion::{MovingBall, MovingContact};
use crate::answers::nut::Columns;
use crate::answers::slip::{Law, integration};
use crate::vocabulary::members::{Rows, Word, answer, row};
use crate::vocabulary::units::{DEG, MM, MPA};
use crate::{Answer, Case, CaseError, Output, OutputType, Record, Scales, Settings};

/// Pressure, slip and friction on a grid over the two contact ellipses of a ball, with the fraction
/// of sticking points and the integrated results.
#[derive(Debug, Clone)]
pub struct EllipseFields {
    model: Model,
    /// Nut and screw contacts.
    contacts: Vec<EllipseContact>,
    /// Warnings about the solution.
    warnings: Vec<String>,
}

row! {
    /// A contact and its fields. Coordinates are divided by the semi-axes; the first coordinate is
    /// across the groove. Friction is divided by the normal pressure. Fields are stored row by row,
    /// with rows along the groove and null outside the ellipse.
    #[expect(non_snake_case, reason = "the names end with unit symbols")]
    pub(crate) struct EllipseContact {
        /// `nut` or `screw`.
        contact: &'static str = "contact";
        contact_angle_deg: f64;
        normal_load_N: f64 = "load, N";
        semi_axes_mm: [f64; 2];
        max_pressure_MPa: f64 = "pressure, MPa";
        friction_force_N: [f64; 2];
        friction_over_load: f64 = "friction / load";
        spin_rad_s: f64 = "spin, rad/s";
        /// Slip speed below which a point sticks.
        creep_speed_m_s: f64;
        /// True if the model assumes saturated friction, so that the friction has the same
        /// direction at all points of a contact.
        saturated: bool;
        /// Positions of the lines on which the surfaces roll without slip.
        rolling_lines: Vec<f64>;
        /// Positions of the points at which the slip is pure spin.
        spin_poles: Vec<[f64; 2]>;
        /// Coordinates of the grid.
        places: Vec<f64>;
        pressure_MPa: Field;
        slip_across_m_s: Field;
        slip_along_m_s: Field;
        friction_across: Field;
        friction_along: Field;
        /// Fraction of the grid points whose slip speed is below the creep speed.
        sticking_share: f64 = "share of the ellipse in which the slip speed is below the creep speed";
    }
}

/// Values at the grid points of a contact; `None` outside the ellipse.
type Field = Vec<Option<f64>>;

answer! {
    /// Contacts of a ball with their fields.
    pub(crate) struct EllipseMembers {
        model: Word;
        contacts: Rows<EllipseContact>;
    }
}

impl EllipseContact {
    /// Returns the fields in the order of [`HEADS`].
    fn fields(&self) -> [&Field; 5] {
        [
            &self.pressure_MPa,
            &self.slip_across_m_s,
            &self.slip_along_m_s,
            &self.friction_across,
            &self.friction_along,
        ]
    }
}

/// Columns of the field table: the coordinates divided by the semi-axes, followed by the fields at
/// nut and screw.
const HEADS: &[Output; 12] = &[
    field("across", ""),
    field("along", ""),
    field("nut_pressure_MPa", "MPa"),
    field("nut_slip_across_m_s", "m/s"),
    field("nut_slip_along_m_s", "m/s"),
    field("nut_friction_across", ""),
    field("nut_friction_along", ""),
    field("screw_pressure_MPa", "MPa"),
    field("screw_slip_across_m_s", "m/s"),
    field("screw_slip_along_m_s", "m/s"),
    field("screw_friction_across", ""),
    field("screw_friction_along", ""),
];

const fn field(name: &'static str, unit: &'static str) -> Output {
    Output::of_table(name, unit, OutputType::Number, "", None)
}

impl EllipseFields {
    /// Default number of grid points on each semi-axis.
    pub const POINTS: u32 = 20;

    /// Calculates pressure, slip and friction over the contact ellipses of a solution. The model
    /// must calculate the motion of the ball.
    ///
    /// * `settings`: settings with which the solution was calculated.
    /// * `points`: number of grid points on each semi-axis.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError::Invalid`] if the model does not calculate the motion of the ball or
    /// there is no solution.
    pub fn of(
        case: &Case,
        settings: &Settings,
        solution: &Solution,
        points: u32,
    ) -> Result<Self, CaseError> {
        let moving = MovingBall::of(case, solution)?;
        let point = case.reader().operating_point();
        let (accuracy, creep) = integration(settings, solution);
        let creep = creep * point.ball.radius * point.drive.relative_speed().abs();
        let quadrature = Quadrature::of(accuracy);
        // If the spin is many orders of magnitude smaller than the angular velocity of the ball, it
        // may be a rounding error.
        let scales = Scales::of([("rad/s", moving.ball.motion.omega.norm())].into_iter());
        let mut contacts = Vec::new();
        for contact in moving.contacts.iter().flatten().take(2) {
            let Some(semi_axes) = contact.semi_axes else { continue };
            let MovingContact { touch, load, .. } = contact;
            let law = Law::of(touch.site, point.friction, solution);
            let pressed_radius = case.pressed_radius(touch.site);
            // In models with saturated friction, all points of a contact slide in the same
            // direction.
            let sliding = match solution.model {
                Model::Rigid | Model::Elastic => Sliding::Point,
                _ => Sliding::Ellipse { semi_axes, pressed_radius, creep, quadrature: &quadrature },
            };
            let ball = &moving.ball;
            let wrench = ball.friction(touch, *load, &law, sliding);
            let wrench = wrench.map_err(|error| CaseError::Invalid(error.to_string()))?;
            let across = BallFrame::tangent().cross(&ball.contact(touch).normal);
            let force = [wrench.force.dot(&across), wrench.force.x];
            let slip = ball.ellipse_slip(touch, semi_axes, pressed_radius, creep);
            let pressed = solution.contact(touch.site).and_then(|contact| contact.pressed);
            let max_pressure = pressed.map_or(f64::NAN, |pressed| pressed.max_pressure / MPA);
            let name = if touch.site == Site::Screw { "screw" } else { "nut" };
            let Grid { places, fields, sticking } = Grid::of(&slip, (&law, max_pressure), points);
            let [pressure, across, along, pull_across, pull_along] = fields;
            contacts.push(EllipseContact {
                contact: name,
                contact_angle_deg: touch.angle / DEG,
                normal_load_N: *load,
                semi_axes_mm: [semi_axes.0 / MM, semi_axes.1 / MM],
                max_pressure_MPa: max_pressure,
                friction_force_N: force,
                friction_over_load: force[0].hypot(force[1]) / load,
                spin_rad_s: scales.clean("rad/s", ball.spin(touch)),
                creep_speed_m_s: creep,
                saturated: matches!(sliding, Sliding::Point),
                rolling_lines: slip.rolling_lines(),
                spin_poles: slip.spin_poles(),
                places,
                pressure_MPa: pressure,
                slip_across_m_s: across,
                slip_along_m_s: along,
                friction_across: pull_across,
                friction_along: pull_along,
                sticking_share: sticking,
            });
        }
        let warnings = Record::new(solution.clone()).all_warnings(case);
        Ok(Self { model: solution.model, contacts, warnings })
    }

    /// Returns the answer. It contains the fields for programs, and a table of the integrated
    /// quantities for the terminal.
    pub fn answer(&self) -> Answer {
        let model = self.model.name();
        let warnings = self.warnings.clone();
        let mut answer = Answer { warnings, ..Answer::default() }.with_members(EllipseMembers {
            model: Word("model ", model.to_owned()),
            contacts: Rows(self.contacts.clone()),
        });
        if self.contacts.is_empty() {
            answer.notes.push(format!(
                "Model {model} treats contacts as points, so there are no contact ellipses."
            ));
        }
        answer
    }

    /// Returns the fields as a table with one row for each grid point inside the ellipses.
    pub fn columns(&self) -> Columns {
        let places = self.contacts.first().map_or(&[][..], |first| &first.places);
        let points = places.iter().flat_map(|y| places.iter().map(move |x| vec![*x, *y]));
        let mut rows: Vec<_> = points.collect();
        for field in self.contacts.iter().flat_map(EllipseContact::fields) {
            for (row, value) in rows.iter_mut().zip(field) {
                row.push(value.unwrap_or(f64::NAN));
            }
        }
        rows.retain(|row| row.get(2).is_some_and(|pressure| pressure.is_finite()));
        Columns { heads: HEADS.iter().collect(), rows }
    }
}

/// Fields on a grid over an ellipse.
struct Grid {
    /// Coordinates of the grid.
    places: Vec<f64>,
    /// Pressure, slip and friction at the grid points.
    fields: [Field; 5],
    /// Fraction of the grid points whose slip speed is below the creep speed.
    sticking: f64,
}

impl Grid {
    /// Returns the coordinates of a grid over an ellipse, the fields at the grid points, and the
    /// fraction of points whose slip speed is below the creep speed.
    fn of(slip: &EllipseSlip<f64>, (law, max_pressure): (&Law, f64), points: u32) -> Self {
        let places: Vec<_> =
            (0..=2 * points).map(|i| f64::from(i) / f64::from(points) - 1.0).collect();
        let mut fields: [Field; 5] = <_>::default();
        let (mut inside, mut sticking) = (0.0, 0.0);
        for (upsilon, xi) in places.iter().flat_map(|y| places.iter().map(move |x| (*y, *x))) {
            let within = xi.hypot(upsilon) <= 1.0;
            let [along, across] = slip.at(xi, upsilon);
            // p = p_max √(1 − ξ² − υ²), Hertz
            let pressure = max_pressure * (1.0 - xi * xi - upsilon * upsilon).max(0.0).sqrt();
            let [pull_along, pull_across] = slip.friction(xi, upsilon, law);
            let values = [pressure, across, along, pull_across, pull_along];
            for (field, value) in fields.iter_mut().zip(values) {
                field.push(within.then_some(value));
            }
            if within {
                inside += 1.0;
                sticking += f64::from(u8::from(slip.creeps(xi, upsilon)));
            }
        }
        Self { places, fields, sticking: sticking / inside }
    }
}
