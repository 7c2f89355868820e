//! Sweeps of Dong et al. (2020), Figs 13-19: contact results, wedge angle, friction, drag and
//! thrust as functions of speed, load, return angle and step height. `jam.json` defines the
//! figures.

use bsm_case::{Case, OutputName, Settings};
use bsm_dyn::{ModelWorkspace, Solution};
use serde::Deserialize;

use super::study::{Rows, Study, analyzed, line, sizes};
use crate::{Figure, PlotAxis, ReportError, Stroke};

/// Factors that multiply the load and the speed of the case. In the paper, the loads range from 8
/// to 24 kN around 16 kN, and the speeds range up to 5000 rpm around 2500 rpm. A speed of zero is
/// omitted.
const LOADS: [f64; 3] = [0.5, 1.0, 1.5];
const SPEEDS: [f64; 3] = [0.2, 1.0, 2.0];

/// Relative rounding error of a curve, based on its largest value. This number is also the smallest
/// value that is shown on a logarithmic axis, in the unit of the axis.
const ROUNDING: f64 = 1e-9;

/// Definition of a figure in `jam.json`.
#[derive(Deserialize)]
struct Drawing {
    key: String,
    title: String,
    caption: String,
    /// Name of the sweeps that the figure shows. Every curve is drawn for each sweep with this
    /// name.
    sweeps: String,
    y: String,
    log: bool,
    /// Groups of curves. Within a group, all curves of one sweep are drawn before the curves of the
    /// next sweep.
    curves: Vec<Vec<PlotLine>>,
}

/// Name, label, color and stroke of a curve, and the quantity that it shows. If there are several
/// sweeps, each sweep has its own color, and its label precedes the label of the curve.
type PlotLine = (String, String, usize, Stroke, OutputName);

/// Reads the definitions of all figures from `jam.json`.
fn drawings() -> Vec<Drawing> {
    serde_json::from_str(include_str!("jam.json")).expect("valid figure definitions")
}

/// Sweeps that vary the same quantity, with their labels.
struct Sweeps {
    name: &'static str,
    axis: &'static str,
    each: Vec<(String, Rows)>,
}

/// Returns the case with its load and speed multiplied by factors.
fn scaled(case: &Case, load: f64, speed: f64) -> Case {
    Case {
        axial_load_N: case.axial_load_N.map(|n| n * load),
        screw_speed_rpm: case.screw_speed_rpm.map(|n| n * speed),
        nut_speed_rpm: case.nut_speed_rpm.map(|n| n * speed),
        ..case.clone()
    }
}

/// Returns the axial load of a case \[kN\].
fn load(case: &Case) -> f64 {
    1e-3 * case.axial_load_N.unwrap_or(f64::NAN)
}

/// Returns the speed of the screw relative to the nut \[rpm\].
fn relative_rpm(case: &Case) -> f64 {
    (case.screw_speed_rpm.unwrap_or(f64::NAN) - case.nut_speed_rpm.unwrap_or(0.0)).abs()
}

/// Performs all sweeps around a case: over loads from half to one and a half times the load of the
/// case, over speeds up to twice its speed and, if the case describes a ball return, over the
/// geometry of the ball return.
fn sweeps(case: &Case, settings: &Settings) -> Result<Vec<Sweeps>, ReportError> {
    let mut work = ModelWorkspace::default();
    let mut run = |cases| analyzed(cases, settings, &mut work);
    let (mut at_speeds, mut at_loads) = (Vec::new(), Vec::new());
    for speed in SPEEDS {
        let own = scaled(case, 1.0, speed);
        let cases = (0..=20).map(|i| scaled(&own, 0.5 + f64::from(i) / 20.0, 1.0));
        let rows = run(cases.map(|case| (load(&case), case)).collect())?;
        at_speeds.push((format!("{:.0} rpm", relative_rpm(&own)), rows));
    }
    for factor in LOADS {
        let own = scaled(case, factor, 1.0);
        let cases = (1..=50).map(|i| scaled(&own, 1.0, f64::from(i) / 25.0));
        let rows = run(cases.map(|case| (relative_rpm(&case), case)).collect())?;
        at_loads.push((format!("{} kN", load(&own)), rows));
    }
    let (by_load, by_speed) = ("axial load, kN", "relative speed of screw and nut, rpm");
    let mut sweeps = vec![
        Sweeps { name: "load", axis: by_load, each: vec![at_speeds[1].clone()] },
        Sweeps { name: "load-at-speeds", axis: by_load, each: at_speeds },
        Sweeps { name: "speed", axis: by_speed, each: vec![at_loads[1].clone()] },
        Sweeps { name: "speed-at-loads", axis: by_speed, each: at_loads },
    ];
    if case.return_angle_deg.is_some() {
        let angle = |i| {
            let angle = f64::from(i);
            (angle, Case { return_angle_deg: Some(angle), ..case.clone() })
        };
        // If the step is higher than the ball radius, no thrust can lift the ball over it.
        let height = |i| {
            let part = f64::from(i) / 200.0;
            let step_height_mm = case.ball_diameter_mm.map(|ball| part * ball);
            (part, Case { step_height_mm, ..case.clone() })
        };
        let axis = "step height / ball diameter";
        let [angles, heights] =
            [run((1..=80).map(angle).collect())?, run((1..=80).map(height).collect())?]
                .map(|rows| vec![(String::new(), rows)]);
        sweeps.push(Sweeps { name: "return-angle", axis: "return angle, deg", each: angles });
        sweeps.push(Sweeps { name: "step-height", axis, each: heights });
    }
    Ok(sweeps)
}

impl Study {
    /// Performs sweeps over load, speed and, if the case describes a ball return, return angle and
    /// step height. All sweeps use the model of `solution`.
    ///
    /// # Errors
    ///
    /// Returns [`ReportError::Case`] if the case is incomplete.
    pub fn jam(case: &Case, settings: &Settings, solution: &Solution) -> Result<Self, ReportError> {
        let sweeps = sweeps(case, &Settings { model: solution.model.into(), ..*settings })?;
        let mut study = Self::default();
        for drawing in &drawings() {
            if let Some(sweeps) = sweeps.iter().find(|sweeps| sweeps.name == drawing.sweeps) {
                study.add(drawing, sweeps);
            }
        }
        Ok(study)
    }

    /// Adds a figure together with the curves that the trend checks use.
    fn add(&mut self, drawing: &Drawing, sweeps: &Sweeps) {
        let Drawing { key, title, caption, y, log, .. } = drawing;
        let single = sweeps.each.len() == 1;
        let mut curves = Vec::new();
        for set in &drawing.curves {
            for (place, (sweep, rows)) in sweeps.each.iter().enumerate() {
                for (name, label, color, stroke, number) in set {
                    let points = sizes(rows, *number);
                    let (label, color) = if single {
                        (label.clone(), *color)
                    } else {
                        (format!("{sweep}{label}"), place)
                    };
                    if !name.is_empty() {
                        let size = points.iter().fold(0.0, |most: f64, (_, y)| most.max(*y));
                        let quantity = y.split(',').next().unwrap_or_default();
                        let label = format!("{quantity}, {label}");
                        self.add_curve(name.clone(), label, &points, ROUNDING * size);
                    }
                    // On a logarithmic axis, zero and values at the level of rounding errors are
                    // omitted.
                    let least = if *log { ROUNDING } else { f64::NEG_INFINITY };
                    curves.extend(line(&label, color, *stroke, points, least));
                }
            }
        }
        if !curves.is_empty() {
            let y = if *log { PlotAxis::log(y) } else { PlotAxis::linear(y) };
            let axes = [PlotAxis::linear(sweeps.axis), y];
            self.figures.push(Figure::new([key, title, caption], axes, curves));
        }
    }
}
