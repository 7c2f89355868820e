//! Pressure, slip and friction over the contact ellipses of a solved ball.

use bsm_dyn::{
    Model, Solution,
    hertz::{EllipseSlip, Quadrature},
    model::Sliding,
};
use bsm_kin::{BallFrame, Site};
use serde_json::{Value, json};

use crate::answers::moving::{MovingBall, MovingContact};
use crate::answers::nut::Columns;
use crate::answers::slip::{Law, integration};
use crate::vocabulary::units::{DEG, MM, MPA};
use crate::{Answer, Case, CaseError, Content, Output, Record, Scales, Settings, Table};

/// Pressure, slip and friction on a grid over the two contact ellipses of a ball, with the sticking
/// share and integrated results.
#[derive(Debug, Clone)]
pub struct EllipseFields {
    model: Model,
    /// Nut and screw contacts, with the columns of [`CONTACT`].
    contacts: Table,
    /// Warnings about the solution.
    warnings: Vec<String>,
}

/// Columns of a contact. Coordinates are relative to the semi-axes, with the first coordinate
/// across the groove. Friction is relative to the normal pressure. Fields are stored row by row,
/// with rows along the groove and null outside the ellipse.
pub(crate) const CONTACT: &str = "contact:string | -contact_angle_deg | normal_load_N=load, N | -semi_axes_mm:numbers \
    | max_pressure_MPa=pressure, MPa | -friction_force_N:numbers | friction_over_load=friction / load \
    | spin_rad_s=spin, rad/s | -creep_speed_m_s | -saturated:boolean | -rolling_lines:numbers | -spin_poles:[numbers] \
    | -places:numbers | -pressure_MPa:[number?] | -slip_across_m_s:[number?] | -slip_along_m_s:[number?] \
    | -friction_across:[number?] | -friction_along:[number?] | sticking_share=sticking share";

/// Fields that are calculated at each grid point of a contact.
const FIELDS: [&str; 5] =
    ["pressure_MPa", "slip_across_m_s", "slip_along_m_s", "friction_across", "friction_along"];

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
    Output::of_table(name, unit, "number", "", None)
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
            let mut row = vec![
                json!(name),
                json!(touch.angle / DEG),
                json!(load),
                json!([semi_axes.0 / MM, semi_axes.1 / MM]),
                json!(max_pressure),
                json!(force),
                json!(force[0].hypot(force[1]) / load),
                json!(scales.clean("rad/s", ball.spin(touch))),
                json!(creep),
                json!(matches!(sliding, Sliding::Point)),
                json!(slip.rolling_lines()),
                json!(slip.spin_poles()),
            ];
            row.extend(over_the_ellipse(&slip, (&law, max_pressure), points));
            contacts.push(row);
        }
        let contacts = Table::of(CONTACT, contacts);
        let warnings = Record::new(solution.clone()).all_warnings(case);
        Ok(Self { model: solution.model, contacts, warnings })
    }

    /// Returns the answer. It contains the fields for programs, and a table of the integrated
    /// quantities for the terminal.
    pub fn answer(&self) -> Answer {
        let model = self.model.name();
        let warnings = self.warnings.clone();
        let mut answer = Answer { warnings, ..Answer::default() }
            .with("model", Content::Text("model ", Some(model.to_owned())))
            .with("contacts", Content::Table(self.contacts.clone()));
        if self.contacts.rows.is_empty() {
            answer.notes.push(format!("Model {model} has contact points without ellipses."));
        }
        answer
    }

    /// Returns the fields as a table with one row for each grid point inside the ellipses.
    pub fn columns(&self) -> Columns {
        let Table { columns, rows: contacts, .. } = &self.contacts;
        let list = |contact: &[Value], name: &str| -> Vec<f64> {
            let cells = columns.iter().zip(contact).filter(|(column, _)| column.name == name);
            let values = cells.flat_map(|(_, cell)| cell.as_array().into_iter().flatten());
            values.map(|value| value.as_f64().unwrap_or(f64::NAN)).collect()
        };
        let places = contacts.first().map_or_else(Vec::new, |first| list(first, "places"));
        let points = places.iter().flat_map(|y| places.iter().map(move |x| vec![*x, *y]));
        let mut rows: Vec<_> = points.collect();
        for contact in contacts {
            for values in FIELDS.map(|name| list(contact, name)) {
                rows.iter_mut().zip(values).for_each(|(row, value)| row.push(value));
            }
        }
        rows.retain(|row| row.get(2).is_some_and(|pressure| pressure.is_finite()));
        Columns { heads: HEADS.iter().collect(), rows }
    }
}

/// Returns the coordinates of a grid over an ellipse, the fields at the grid points, and the
/// fraction of points whose slip speed is below the creep speed.
fn over_the_ellipse(
    slip: &EllipseSlip<f64>,
    (law, max_pressure): (&Law, f64),
    points: u32,
) -> impl Iterator<Item = Value> + use<> {
    let places: Vec<_> = (0..=2 * points).map(|i| f64::from(i) / f64::from(points) - 1.0).collect();
    let mut lists: [Vec<_>; FIELDS.len()] = <_>::default();
    let (mut inside, mut sticking) = (0.0, 0.0);
    for (upsilon, xi) in places.iter().flat_map(|y| places.iter().map(move |x| (*y, *x))) {
        let within = xi.hypot(upsilon) <= 1.0;
        let [along, across] = slip.at(xi, upsilon);
        // p = p_max √(1 − ξ² − υ²), Hertz
        let pressure = max_pressure * (1.0 - xi * xi - upsilon * upsilon).max(0.0).sqrt();
        let [pull_along, pull_across] = slip.friction(xi, upsilon, law);
        let values = [pressure, across, along, pull_across, pull_along];
        for (list, value) in lists.iter_mut().zip(values) {
            list.push(within.then_some(value));
        }
        if within {
            inside += 1.0;
            sticking += f64::from(u8::from(slip.creeps(xi, upsilon)));
        }
    }
    let fields = lists.into_iter().map(|list| json!(list));
    std::iter::once(json!(places)).chain(fields).chain([json!(sticking / inside)])
}
