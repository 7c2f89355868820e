//! The figures of Lin, Velinsky and Ravani (1994), drawn for a case.

use std::f64::consts::PI;

use bsm_case::{Case, Settings};
use bsm_design::search::minimum_of;
use bsm_dyn::{
    Direction, Model, ModelWorkspace, Solution,
    angles::{Angles, Optimum},
};
use bsm_kin::Site;

use crate::{Curve, Figure, PlotAxis, ReportError, Stroke, format_short};

const LEAD: (&str, &str) = ("lead_angle_deg", "lead angle, deg");
const CONTACT: (&str, &str) = ("contact_angle_deg", "contact angle, deg");

const DIRECTIONS: [(Direction, &str, Stroke); 2] = [
    (Direction::RotaryToLinear, "rotary to linear", Stroke::Solid),
    (Direction::LinearToRotary, "linear to rotary", Stroke::Dashed),
];

/// A function that returns an output of a solution. `None` leaves a gap in the curve.
pub type Getter = fn(&Solution) -> Option<f64>;

/// Calculates an output as a function of an input. Each returned point contains the values of the
/// input and the output.
///
/// # Errors
///
/// Returns [`ReportError::Case`] if the case is incomplete or a value is not permitted.
pub fn points(
    case: &Case,
    settings: &Settings,
    input: &str,
    values: &[f64],
    getter: Getter,
) -> Result<Vec<(f64, f64)>, ReportError> {
    let mut work = ModelWorkspace::default();
    let mut case = case.clone();
    let point = |value: &f64| {
        case.set(input, *value)?;
        let solution = case.problem(settings)?.solve(&mut work);
        Ok((*value, getter(&solution).unwrap_or(f64::NAN)))
    };
    values.iter().map(point).collect()
}

/// Returns Figs 3 to 7 of Lin, Velinsky and Ravani (1994) for a case, in its display units:
/// efficiency as a function of lead angle and of contact angle, normal loads, efficiency as a
/// function of the slip direction, optimum contact angle, and self-locking limits. Figures and
/// exact solutions for which the case lacks inputs are omitted.
///
/// # Errors
///
/// Returns [`ReportError::Case`] if a value of the case is not permitted.
pub fn lin_figures(case: &Case) -> Result<Vec<Figure>, ReportError> {
    let units = case.display_units();
    Ok(lin_figures_with_fig5_case(case, case)?
        .into_iter()
        .map(|figure| figure.in_units(units))
        .collect())
}

/// Works like [`lin_figures`], but with a separate case for Fig 5, for which the paper uses a
/// smaller ball. The figures are not converted to display units.
///
/// # Errors
///
/// Returns [`ReportError::Case`] if a value of a case is not permitted.
pub fn lin_figures_with_fig5_case(case: &Case, slender: &Case) -> Result<Vec<Figure>, ReportError> {
    let case = &forward(case);
    let mut figures = Vec::new();
    if case.suits(Model::ClosedForm) {
        figures.push(lead_angle(case)?);
        figures.push(contact_angle(case)?);
    }
    if case.suits(Model::Rigid) {
        figures.push(normal_loads(case)?);
        figures.push(slip_angles(case)?);
    }
    figures.extend(slip_direction(slender));
    if let Some(friction) = case.friction_coefficient {
        figures.push(optimum_angle(case, friction)?);
        figures.push(self_locking(friction));
    }
    Ok(figures)
}

/// Returns the case with the direction of rotation in which the motor drives against the load.
fn forward(case: &Case) -> Case {
    let mut case = case.clone();
    if case.speeds_rpm().is_some_and(|(screw, nut)| screw < nut) {
        case.screw_speed_rpm = case.screw_speed_rpm.map(|rpm| -rpm);
        case.nut_speed_rpm = case.nut_speed_rpm.map(|rpm| -rpm);
    }
    case
}

/// Returns the caption that describes the operating point of the exact solution.
fn operating_point(case: &Case) -> String {
    let friction = case.friction_coefficient.unwrap_or(f64::NAN);
    match (case.axial_load_N, case.loaded_balls, case.speeds_rpm()) {
        (Some(load), Some(balls), Some((screw, nut))) if case.suits(Model::Rigid) => format!(
            "f = {friction}; the circles are exact solutions at {} rpm and {} N per ball.",
            screw - nut,
            load / balls
        ),
        _ => format!("f = {friction}; closed-form solution."),
    }
}

/// Returns all integer angles in a range \[deg\].
fn degrees(range: std::ops::RangeInclusive<i32>) -> Vec<f64> {
    range.map(f64::from).collect()
}

/// Draws the closed-form solution as lines and the exact solution at every third point as circles,
/// with one color for each value in `others`. The first value in `others` is the value of the case.
/// For the value of the case, the curve of the other drive direction is drawn as well.
fn exact_and_closed(
    case: &Case,
    (input, values): (&str, &[f64]),
    (other, others): (&str, &[f64]),
    getter: Getter,
) -> Result<Vec<Curve>, ReportError> {
    let mut curves = Vec::new();
    for (color, value) in others.iter().enumerate() {
        let mut case = case.clone();
        case.set(other, *value)?;
        let mut add = |case: &Case, model: Model, words: &str, stroke, step| {
            let values: Vec<_> = values.iter().copied().step_by(step).collect();
            let points = points(case, &model.into(), input, &values, getter)?;
            curves.push(Curve::new(format!("{value} deg, {words}"), color, stroke, points));
            Ok::<_, ReportError>(())
        };
        add(&case, Model::ClosedForm, "closed", Stroke::Solid, 1)?;
        if case.suits(Model::Rigid) {
            add(&case, Model::Rigid, "exact", Stroke::Circles, 3)?;
        }
        if color == 0 {
            let back = Case { screw_speed_rpm: Some(-1.0), nut_speed_rpm: None, ..case };
            add(&back, Model::ClosedForm, "linear to rotary", Stroke::Dashed, 1)?;
        }
    }
    Ok(curves)
}

/// Returns the efficiency, or `None` if the screw is self-locking.
fn moving(solution: &Solution) -> Option<f64> {
    solution.efficiency().filter(|eta| *eta > 0.0)
}

/// Returns `own`, followed by all values within the range that differ from `own` by one of the
/// offsets in `others`.
fn around(own: f64, others: [f64; 2], (low, high): (f64, f64)) -> Vec<f64> {
    let others = others.into_iter().map(|off| own + off).filter(|x| (low..=high).contains(x));
    std::iter::once(own).chain(others).collect()
}

fn lead_angle(case: &Case) -> Result<Figure, ReportError> {
    let own = case.contact_angle_deg.unwrap_or(f64::NAN);
    let contacts = around(own, [-15.0, 15.0], (1.0, 89.0));
    let over = (LEAD.0, &degrees(1..=60)[..]);
    Ok(Figure::new(
        [
            "lin-efficiency-lead-angle",
            "Efficiency against lead angle",
            &format!(
                "Fig 3 of Lin et al. (1994), drawn for a contact angle of {own} deg. {} The exact equations have no root at small lead angles, where the \
             ball would roll.",
                operating_point(case)
            ),
        ],
        [PlotAxis::linear(LEAD.1), PlotAxis::linear("efficiency")],
        exact_and_closed(case, over, (CONTACT.0, &contacts), moving)?,
    ))
}

fn contact_angle(case: &Case) -> Result<Figure, ReportError> {
    // Rounding removes the error of converting the lead angle to radians and back.
    let own = case.lead_angle().map_or(f64::NAN, |lead| (1e9 * lead.to_degrees()).round() * 1e-9);
    let leads = around(own, [10.0, 20.0], (0.1, 60.0));
    let over = (CONTACT.0, &degrees(5..=85)[..]);
    let best = 100.0 * Optimum::best_efficiency(case.friction_coefficient.unwrap_or(f64::NAN));
    Ok(Figure::new(
        [
            "lin-efficiency-contact-angle",
            "Efficiency against contact angle",
            &format!(
                "Fig 3 of Lin et al. (1994), drawn for a lead angle of {own} deg. {} The best efficiency is the same for \
             all curves, {best:.1} %.",
                operating_point(case)
            ),
        ],
        [PlotAxis::linear(CONTACT.1), PlotAxis::linear("efficiency")],
        exact_and_closed(case, over, (LEAD.0, &leads), moving)?,
    ))
}

fn normal_loads(case: &Case) -> Result<Figure, ReportError> {
    let load = case.axial_load_N.unwrap_or(1.0) / case.loaded_balls.unwrap_or(1.0);
    let getters: [(&str, Model, Stroke, Getter); 4] = [
        ("nut and screw, closed form", Model::ClosedForm, Stroke::Solid, |o| {
            o.contact(Site::Nut)?.load
        }),
        ("nut, exact", Model::Rigid, Stroke::Circles, |o| o.contact(Site::Nut)?.load),
        ("screw, exact", Model::Rigid, Stroke::Triangles, |o| o.contact(Site::Screw)?.load),
        ("far flank, exact", Model::Rigid, Stroke::Circles, |o| o.contact(Site::NutUnloaded)?.load),
    ];
    let mut curves = Vec::new();
    for (i, (label, model, stroke, getter)) in getters.into_iter().enumerate() {
        // The curves would coincide, so each curve has its markers at different points.
        let values: Vec<_> = match stroke {
            Stroke::Solid => degrees(5..=85),
            _ => degrees(5..=85).into_iter().skip(2 * i).step_by(4).collect(),
        };
        let mut points = points(case, &model.into(), CONTACT.0, &values, getter)?;
        for (_, normal) in &mut points {
            *normal /= load;
        }
        curves.push(Curve::new(label.to_owned(), i, stroke, points));
    }
    Ok(Figure::new(
        [
            "lin-normal-loads",
            "Normal loads against contact angle",
            &format!(
                "Fig 4 of Lin et al. (1994). {} The far flank carries far less than the two loaded flanks, \
             whose loads are nearly equal.",
                operating_point(case)
            ),
        ],
        [PlotAxis::linear(CONTACT.1), PlotAxis::log("normal load / axial load")],
        curves,
    ))
}

fn slip_angles(case: &Case) -> Result<Figure, ReportError> {
    let own = case.contact_angle_deg.unwrap_or(f64::NAN);
    let contacts = around(own, [-15.0, 15.0], (1.0, 89.0));
    let over = (LEAD.0, &degrees(1..=60)[..]);
    let getter: Getter = |o| o.contact(Site::Screw)?.slip_angle.map(f64::to_degrees);
    let mut curves = exact_and_closed(case, over, (CONTACT.0, &contacts), getter)?;
    // The curves for the other drive direction are removed, because they differ from the remaining
    // curves only by a rotation of 180 degrees.
    curves.retain(|curve| curve.stroke != Stroke::Dashed);
    Ok(Figure::new(
        [
            "lin-slip-angle",
            "Direction of friction at the screw against lead angle",
            &format!(
                "Eq 13 of Lin et al. (1994): angle between the direction across the groove (0 deg) and the direction of friction. {} The \
             direction at the nut is rotated by half a turn.",
                operating_point(case)
            ),
        ],
        [PlotAxis::linear(LEAD.1), PlotAxis::linear("slip angle, deg")],
        curves,
    ))
}

/// Draws the efficiency from Eq 11 of the paper, both as corrected and as printed. Returns `None`
/// if inputs are missing.
fn slip_direction(case: &Case) -> Option<Figure> {
    let (lead, contact) = (case.lead_angle()?, case.contact_angle_deg?.to_radians());
    let (friction, pitch) = (case.friction_coefficient?, case.pitch_circle_diameter_mm?);
    let size = case.ball_diameter_mm? / pitch;
    let angles = Angles { lead, contact };
    let direction = Direction::RotaryToLinear;
    let corrected = |degrees: f64| {
        (degrees, angles.efficiency_at(direction, friction, size, degrees.to_radians()))
    };
    let printed = |degrees: f64| {
        (degrees, efficiency_as_printed(&angles, friction, size, degrees.to_radians()))
    };
    let own = angles.screw_slip_angle(direction).to_degrees();
    let curve = |label: &str, color, stroke, points| Curve::new(label, color, stroke, points);
    let over = degrees(0..=90);
    Some(Figure::new(
        [
            "lin-efficiency-slip-angle",
            "Efficiency against the slip direction at the screw",
            &format!(
                "Fig 5 of Lin et al. (1994), Eq 11: lead angle {:.4} deg, contact angle {:.4} deg, ball radius / pitch \
             radius = {size:.3}, f = {friction}. Slip along the groove (90 deg) loses more power than slip across the groove. As printed, \
             the sign of friction in the numerator gives efficiencies above one.",
                lead.to_degrees(),
                contact.to_degrees(),
            ),
        ],
        [PlotAxis::linear("slip angle at the screw, deg"), PlotAxis::linear("efficiency")],
        vec![
            curve("corrected", 0, Stroke::Solid, over.iter().copied().map(corrected).collect()),
            curve("as printed", 1, Stroke::Dashed, over.iter().copied().map(printed).collect()),
            curve("slip angle of Eq 13", 0, Stroke::Circles, vec![corrected(own)]),
        ],
    ))
}

/// Calculates the efficiency with Eq 11 of the paper as printed and the slip angle at the nut from
/// Eq 10.
pub fn efficiency_as_printed(angles: &Angles<f64>, friction: f64, size: f64, psi: f64) -> f64 {
    let (tan_a, (sin_b, cos_b)) = (angles.lead.tan(), angles.contact.sin_cos());
    let (at_nut, at_screw) = ((psi + PI).sin_cos(), psi.sin_cos());
    let force = sin_b - friction * (cos_b * at_nut.1 + at_nut.0 * tan_a);
    let lever = at_screw.1 * (size - cos_b) + at_screw.0 * (1.0 - size * cos_b) / tan_a;
    force / (sin_b + friction * lever)
}

fn optimum_angle(case: &Case, own: f64) -> Result<Figure, ReportError> {
    let mut curves = Vec::new();
    for (color, friction) in [own, own / 3.0, 2.0 * own].into_iter().enumerate() {
        for (direction, words, stroke) in DIRECTIONS {
            let best = |lead: &f64| {
                let best = Optimum::of(direction, lead.to_radians(), friction);
                (*lead, best.map_or(f64::NAN, |best| best.contact_angle.to_degrees()))
            };
            let points = degrees(0..=50).iter().map(best).collect();
            let label = format!("f {}, {words}", format_short(friction));
            curves.push(Curve::new(label, color, stroke, points));
        }
    }
    if case.suits(Model::Rigid) {
        for ((direction, words, _), stroke) in
            DIRECTIONS.into_iter().zip([Stroke::Circles, Stroke::Triangles])
        {
            let points = exact_optimum(case, direction)?;
            curves.push(Curve::new(format!("exact, {words}"), 3, stroke, points));
        }
    }
    Ok(Figure::new(
        [
            "lin-optimum-angle",
            "Optimum contact angle against lead angle",
            &format!(
                "Fig 6 of Lin et al. (1994), drawn for f = {}. The lines are the closed form, and the marks are the maxima of the exact \
             efficiency. Curves end where no contact angle reaches the optimum.",
                format_short(own)
            ),
        ],
        [PlotAxis::linear(LEAD.1), PlotAxis::linear("optimum contact angle, deg")],
        curves,
    ))
}

/// Searches for the contact angle with the highest efficiency of the exact solution, for several
/// lead angles.
fn exact_optimum(case: &Case, direction: Direction) -> Result<Vec<(f64, f64)>, ReportError> {
    let mut points = Vec::new();
    for lead in degrees(12..=44).into_iter().step_by(4) {
        let mut case = case.clone();
        case.set(LEAD.0, lead)?;
        for speed in [&mut case.screw_speed_rpm, &mut case.nut_speed_rpm] {
            *speed = speed.map(|rpm| direction.sign() * rpm);
        }
        let loss = |contact: f64| {
            let case = Case { contact_angle_deg: Some(contact), ..case.clone() };
            let solution =
                case.problem(&Model::Rigid.into())?.solve(&mut ModelWorkspace::default());
            // If there is no solution, the screw does not move, and the efficiency is zero.
            Ok::<_, ReportError>(1.0 - solution.efficiency().unwrap_or(0.0))
        };
        let (low, high) = (30.0, 85.0);
        let best = minimum_of(loss, low, high)?;
        // If the best angle is at an end of the range, the efficiency has no maximum inside the
        // range.
        let inside = best > low + 0.1 && best < high - 0.1;
        points.push((lead, if inside { best } else { f64::NAN }));
    }
    Ok(points)
}

fn self_locking(own: f64) -> Figure {
    let mut curves = Vec::new();
    for (color, friction) in [own, 2.0 * own, 4.0 * own].into_iter().enumerate() {
        for (direction, words, stroke) in DIRECTIONS {
            let limit = |lead: f64| {
                let limit = Angles::locking_contact_angle(direction, lead.to_radians(), friction);
                (lead, limit.map_or(f64::NAN, f64::to_degrees))
            };
            curves.push(Curve::new(
                format!("f {}, {words}", format_short(friction)),
                color,
                stroke,
                (0..=340).map(|quarter| limit(0.25 * f64::from(quarter))).collect(),
            ));
        }
    }
    Figure::new(
        [
            "lin-self-locking",
            "Self-locking limits of the screw",
            &format!(
                "Fig 7 of Lin et al. (1994), drawn for f = {}. Below a solid line, the screw cannot be turned against the \
             load (a); above a dashed line, the load cannot turn the screw (b).",
                format_short(own)
            ),
        ],
        [PlotAxis::linear(LEAD.1), PlotAxis::linear("contact angle, deg")],
        curves,
    )
}
