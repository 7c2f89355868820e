//! The figures of the report: those of Lin, Velinsky and Ravani (1994), drawn again from our
//! solution, the way from rolling to gross skid, those of Sobolewski (2002), and the sweeps of slip and jamming.

use bsm_case::{Scene, Settings};
use bsm_design::search::minimum_of;
use bsm_dyn::{Angles, Control, Direction, Model, ModelWorkspace, Optimum, Solution};
use bsm_kin::Site;
use bsm_report::{Axis, Curve, Figure, Stroke};

use crate::{Published, ValidateError, catalogue_figures, dong2020, elastic, xu2015};

/// All figures.
///
/// # Errors
///
/// [`ValidateError`] if the data cannot be used.
pub fn figures(published: &Published) -> Result<Vec<Figure>, ValidateError> {
    let lin = published.lin_case.scene()?;
    let mut figures = vec![
        lead_angle(&lin)?,
        contact_angle(&lin)?,
        normal_loads(&lin)?,
        slip_angles(&lin)?,
        optimum_angle(&lin)?,
        self_locking(),
        transition(&elastic::lin(published)?)?,
    ];
    figures.extend(xu2015::study(published, Control::Nut)?.figures);
    let parkon = published.parkon.catalogue()?;
    figures.extend(catalogue_figures(&parkon, &parkon.places()));
    figures.extend(dong2020::study(published, Model::RacewayControl)?.figures);
    Ok(figures)
}

const LEAD: (&str, &str) = ("lead_angle_deg", "lead angle, deg");
const CONTACT: (&str, &str) = ("contact_angle_deg", "contact angle, deg");

/// An output; a missing one is a gap.
type Read = fn(&Solution) -> Option<f64>;

/// An output over an input.
fn points(
    scene: &Scene,
    settings: &Settings,
    input: &str,
    values: &[f64],
    read: Read,
) -> Result<Vec<(f64, f64)>, ValidateError> {
    let mut work = ModelWorkspace::default();
    let mut scene = scene.clone();
    let point = |value: &f64| {
        scene.set(input, *value)?;
        let solution = scene.problem(settings)?.solve(&mut work);
        Ok((*value, read(&solution).unwrap_or(f64::NAN)))
    };
    values.iter().map(point).collect()
}

/// Whole degrees.
fn degrees(range: std::ops::RangeInclusive<i32>) -> Vec<f64> {
    range.map(f64::from).collect()
}

/// The exact equations as circles, every third of them; the closed form as lines.
const KINDS: [(Model, &str, Stroke, usize); 2] =
    [(Model::ClosedForm, "closed", Stroke::Solid, 1), (Model::Rigid, "exact", Stroke::Circles, 3)];

/// The exact equations and the closed form, a colour for each value of `other`.
fn exact_and_closed(
    lin: &Scene,
    (input, values): (&str, &[f64]),
    (other, others): (&str, &[f64]),
    read: Read,
) -> Result<Vec<Curve>, ValidateError> {
    let mut curves = Vec::new();
    for (color, value) in others.iter().enumerate() {
        let mut scene = lin.clone();
        scene.set(other, *value)?;
        for (model, words, stroke, step) in KINDS {
            let values: Vec<_> = values.iter().copied().step_by(step).collect();
            curves.push(Curve::new(
                format!("{value} deg, {words}"),
                color,
                stroke,
                points(&scene, &model.into(), input, &values, read)?,
            ));
        }
    }
    Ok(curves)
}

/// Efficiency where the screw moves: none where it locks.
fn moving(solution: &Solution) -> Option<f64> {
    solution.efficiency().filter(|eta| *eta > 0.0)
}

fn lead_angle(lin: &Scene) -> Result<Figure, ValidateError> {
    let contacts = [30.0, 45.0, 60.0];
    let over = (LEAD.0, &degrees(1..=60)[..]);
    Ok(Figure {
        key: "lin-efficiency-lead-angle".into(),
        title: "Efficiency against lead angle".into(),
        caption:
            "Lin's screw, 2000 rpm, 2113 N on one ball, f = 0.075, contact angles of 30, 45 and 60 deg. The exact equations have no \
                  root at small lead angles, where the ball would roll."
                .into(),
        x: Axis::linear(LEAD.1),
        y: Axis::linear("efficiency"),
        curves: exact_and_closed(lin, over, (CONTACT.0, &contacts), moving)?,
    })
}

fn contact_angle(lin: &Scene) -> Result<Figure, ValidateError> {
    let leads = [10.0, 20.0, 30.0];
    let over = (CONTACT.0, &degrees(5..=85)[..]);
    Ok(Figure {
        key: "lin-efficiency-contact-angle".into(),
        title: "Efficiency against contact angle".into(),
        caption:
            "Lead angles of 10, 20 and 30 deg. The best efficiency is the same for each: 86.1 %."
                .into(),
        x: Axis::linear(CONTACT.1),
        y: Axis::linear("efficiency"),
        curves: exact_and_closed(lin, over, (LEAD.0, &leads), moving)?,
    })
}

fn normal_loads(lin: &Scene) -> Result<Figure, ValidateError> {
    let load = lin.axial_load_N.unwrap_or(1.0);
    let reads: [(&str, Model, Stroke, Read); 4] = [
        ("nut and screw, closed form", Model::ClosedForm, Stroke::Solid, |o| {
            o.contact(Site::Nut)?.load
        }),
        ("nut, exact", Model::Rigid, Stroke::Circles, |o| o.contact(Site::Nut)?.load),
        ("screw, exact", Model::Rigid, Stroke::Triangles, |o| o.contact(Site::Screw)?.load),
        ("minor contact, exact", Model::Rigid, Stroke::Circles, |o| {
            o.contact(Site::NutMinor)?.load
        }),
    ];
    let mut curves = Vec::new();
    for (i, (label, model, stroke, read)) in reads.into_iter().enumerate() {
        // Marks that would lie on each other take turns.
        let values: Vec<_> = match stroke {
            Stroke::Solid => degrees(5..=85),
            _ => degrees(5..=85).into_iter().skip(2 * i).step_by(4).collect(),
        };
        let mut points = points(lin, &model.into(), CONTACT.0, &values, read)?;
        for (_, normal) in &mut points {
            *normal /= load;
        }
        curves.push(Curve::new(label.to_owned(), i, stroke, points));
    }
    Ok(Figure {
        key: "lin-normal-loads".into(),
        title: "Normal loads against contact angle".into(),
        caption: "The minor contact carries hundreds to thousands of times less than the two that \
                  are loaded, which are nearly equal."
            .into(),
        x: Axis::linear(CONTACT.1),
        y: Axis::log("normal over axial load"),
        curves,
    })
}

fn slip_angles(lin: &Scene) -> Result<Figure, ValidateError> {
    let contacts = [30.0, 45.0, 60.0];
    let over = (LEAD.0, &degrees(1..=60)[..]);
    let read: Read = |o| o.contact(Site::Screw)?.slip_angle.map(f64::to_degrees);
    Ok(Figure {
        key: "lin-slip-angle".into(),
        title: "Direction of friction at the screw against lead angle".into(),
        caption:
            "At contact angles of 30, 45 and 60 deg: from across the groove (0 deg) towards along it. At the nut it is turned by half a \
                  turn."
                .into(),
        x: Axis::linear(LEAD.1),
        y: Axis::linear("slip angle, deg"),
        curves: exact_and_closed(lin, over, (CONTACT.0, &contacts), read)?,
    })
}

const DIRECTIONS: [(Direction, &str, Stroke); 2] = [
    (Direction::RotaryToLinear, "rotary to linear", Stroke::Solid),
    (Direction::LinearToRotary, "linear to rotary", Stroke::Dashed),
];

fn optimum_angle(lin: &Scene) -> Result<Figure, ValidateError> {
    let mut curves = Vec::new();
    for (color, friction) in [0.025, 0.075, 0.15].into_iter().enumerate() {
        for (direction, words, stroke) in DIRECTIONS {
            let best = |lead: &f64| {
                let best = Optimum::of(direction, lead.to_radians(), friction);
                (*lead, best.map_or(f64::NAN, |best| best.contact_angle.to_degrees()))
            };
            curves.push(Curve::new(
                format!("f {friction}, {words}"),
                color,
                stroke,
                degrees(0..=50).iter().map(best).collect(),
            ));
        }
    }
    for ((direction, words, _), stroke) in
        DIRECTIONS.into_iter().zip([Stroke::Circles, Stroke::Triangles])
    {
        curves.push(Curve::new(
            format!("exact, {words}"),
            3,
            stroke,
            exact_optimum(lin, direction)?,
        ));
    }
    Ok(Figure {
        key: "lin-optimum-angle".into(),
        title: "Contact angle of best efficiency against lead angle".into(),
        caption:
            "In closed form for three friction coefficients f; marks: the maximum of the exact \
                  efficiency at f = 0.075, 2000 rpm. Curves end where no contact angle reaches the \
                  optimum."
                .into(),
        x: Axis::linear(LEAD.1),
        y: Axis::linear("optimum contact angle, deg"),
        curves,
    })
}

/// Contact angle of the best efficiency of the exact equations, searched for.
fn exact_optimum(lin: &Scene, direction: Direction) -> Result<Vec<(f64, f64)>, ValidateError> {
    let mut points = Vec::new();
    for lead in degrees(12..=44).into_iter().step_by(4) {
        let scene = Scene {
            lead_angle_deg: Some(lead),
            screw_speed_rpm: lin.screw_speed_rpm.map(|rpm| direction.sign() * rpm),
            ..lin.clone()
        };
        let loss = |contact: f64| {
            let scene = Scene { contact_angle_deg: Some(contact), ..scene.clone() };
            let solution =
                scene.problem(&Model::Rigid.into())?.solve(&mut ModelWorkspace::default());
            // Without a root nothing moves: all is lost.
            Ok::<_, ValidateError>(1.0 - solution.efficiency().unwrap_or(0.0))
        };
        let (low, high) = (30.0, 85.0);
        let best = minimum_of(loss, low, high)?;
        // The best of the range is no maximum.
        let inside = best > low + 0.1 && best < high - 0.1;
        points.push((lead, if inside { best } else { f64::NAN }));
    }
    Ok(points)
}

fn self_locking() -> Figure {
    let mut curves = Vec::new();
    for (color, friction) in [0.05, 0.1, 0.2, 0.4].into_iter().enumerate() {
        for (direction, words, stroke) in DIRECTIONS {
            let limit = |lead: &f64| {
                let limit = Angles::locking_contact_angle(direction, lead.to_radians(), friction);
                (*lead, limit.map_or(f64::NAN, f64::to_degrees))
            };
            curves.push(Curve::new(
                format!("f {friction}, {words}"),
                color,
                stroke,
                (0..=120).map(|half| limit(&(0.5 * f64::from(half)))).collect(),
            ));
        }
    }
    Figure {
        key: "lin-self-locking".into(),
        title: "Limits of self-locking of the screw".into(),
        caption:
            "Below a solid line the screw cannot be turned against the load; above a dashed line \
                  the load cannot turn the screw."
                .into(),
        x: Axis::linear(LEAD.1),
        y: Axis::linear("contact angle, deg"),
        curves,
    }
}

/// Efficiency against speed from rolling to gross skid: three models at three loads.
fn transition(lin: &Scene) -> Result<Figure, ValidateError> {
    let speeds: Vec<_> = (0..=60).map(|i| 300.0 * 100.0_f64.powf(f64::from(i) / 60.0)).collect();
    let mut curves = Vec::new();
    for (model, stroke) in [
        (Model::RacewayControl, Stroke::Dashed),
        (Model::Traction, Stroke::Solid),
        (Model::Elastic, Stroke::Dotted),
    ] {
        let settings = Settings { control: Some(Control::Nut), ..model.into() };
        for (color, load) in [2113.0, 100.0, 20.0].into_iter().enumerate() {
            let scene = Scene { axial_load_N: Some(load), ..lin.clone() };
            curves.push(Curve::new(
                format!("{}, {load} N", model.name()),
                color,
                stroke,
                points(&scene, &settings, "screw_speed_rpm", &speeds, Solution::efficiency)?,
            ));
        }
    }
    Ok(Figure {
        key: "transition".into(),
        title: "From rolling to gross skid: Lin's screw, one ball".into(),
        caption: "Traction (solid) leaves raceway control (dashed) and joins saturated friction \
                  (dotted) where friction gives way to the gyroscopic moment; under 2113 N it \
                  holds."
            .into(),
        x: Axis::log("screw speed, rpm"),
        y: Axis::linear("efficiency"),
        curves,
    })
}
