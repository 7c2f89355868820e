//! The sweeps of Dong et al. (2020), Figs 13-19: contact state, wedge, friction, drag and thrust against
//! speed, load, return angle and height of the step.

use bsm_case::{AnalysisKind, Moving, Numbers, Scene, Settings};
use bsm_dyn::{ModelWorkspace, Solution};
use bsm_report::{Axis, Figure, Stroke};

use super::{Claim, Study, Trend, line};
use crate::ValidateError;

/// Load and speed over those of the scene, which are in the middle: 8 to 24 kN about 16 kN, up to
/// 5000 rpm about 2500 rpm; nothing moves at rest.
const LOADS: [f64; 3] = [0.5, 1.0, 1.5];
const SPEEDS: [f64; 3] = [0.2, 1.0, 2.0];

/// What rounding may change of a curve, over its largest value; and the least that a logarithmic
/// axis shows, in its unit.
const ROUNDING: f64 = 1e-9;

const SOLID: Stroke = Stroke::Solid;
const DASHED: Stroke = Stroke::Dashed;

/// What varies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Over {
    Load,
    Speed,
    ReturnAngle,
    StepHeight,
}

impl Over {
    fn key(self) -> &'static str {
        match self {
            Self::Load => "load",
            Self::Speed => "speed",
            Self::ReturnAngle => "return-angle",
            Self::StepHeight => "step-height",
        }
    }

    fn axis(self) -> &'static str {
        match self {
            Self::Load => "axial load, kN",
            Self::Speed => "speed of screw to nut, rpm",
            Self::ReturnAngle => "return angle, deg",
            Self::StepHeight => "height of the step, of the ball diameter",
        }
    }

    /// Factors of load, speed or ball diameter, or degrees.
    fn values(self) -> Vec<f64> {
        match self {
            Self::Load => (0..=20).map(|i| 0.5 + f64::from(i) / 20.0).collect(),
            Self::Speed => (1..=50).map(|i| f64::from(i) / 25.0).collect(),
            Self::ReturnAngle => (1..=80).map(f64::from).collect(),
            // Above half of the ball no thrust lifts it.
            Self::StepHeight => (1..=80).map(|i| f64::from(i) / 200.0).collect(),
        }
    }
}

/// A scene with factors of load and speed.
fn scaled(scene: &Scene, load: f64, speed: f64) -> Scene {
    Scene {
        axial_load_N: scene.axial_load_N.map(|n| n * load),
        screw_speed_rpm: scene.screw_speed_rpm.map(|n| n * speed),
        nut_speed_rpm: scene.nut_speed_rpm.map(|n| n * speed),
        ..scene.clone()
    }
}

/// Speed of the screw against the nut.
fn relative_rpm(scene: &Scene) -> f64 {
    (scene.screw_speed_rpm.unwrap_or(f64::NAN) - scene.nut_speed_rpm.unwrap_or(0.0)).abs()
}

/// The numbers of the analyses of a sweep; none where there is no solution.
type Rows = Vec<(f64, Vec<Numbers>)>;

/// A curve to draw.
struct Wanted<'a> {
    rows: &'a Rows,
    /// Group of its trend; empty if nothing is claimed of it.
    group: &'static str,
    label: String,
    color: usize,
    stroke: Stroke,
    /// Number of the analysis.
    name: &'static str,
}

/// Group of trends, label, colour, stroke and number of a curve.
type Named<'a> = (&'static str, &'a str, usize, Stroke, &'static str);

/// Curves of one sweep.
fn of_sweep<'a>(rows: &'a Rows, named: &[Named<'_>]) -> Vec<Wanted<'a>> {
    let wanted = |&(group, label, color, stroke, name): &Named<'_>| Wanted {
        rows,
        group,
        label: label.to_owned(),
        color,
        stroke,
        name,
    };
    named.iter().map(wanted).collect()
}

/// The same curves of several sweeps, a colour for each; the label of the sweep in front.
fn of_sweeps<'a>(
    sweeps: &'a [(String, Rows)],
    group: &'static str,
    named: &[(&str, Stroke, &'static str)],
) -> Vec<Wanted<'a>> {
    let each = sweeps.iter().enumerate();
    each.flat_map(|(color, (sweep, rows))| {
        named.iter().map(move |(label, stroke, name)| Wanted {
            rows,
            group,
            label: format!("{sweep}{label}"),
            color,
            stroke: *stroke,
            name,
        })
    })
    .collect()
}

/// Solves and analyses the scenes of a study.
struct Solver<'a> {
    settings: &'a Settings,
    work: ModelWorkspace,
}

impl Solver<'_> {
    /// The analyses over a sweep of a scene; none where there is no solution.
    fn run(&mut self, scene: &Scene, over: Over) -> Result<Rows, ValidateError> {
        let mut rows = Vec::new();
        for value in over.values() {
            let (x, scene) = match over {
                Over::Load => {
                    let scene = scaled(scene, value, 1.0);
                    (1e-3 * scene.axial_load_N.unwrap_or(f64::NAN), scene)
                }
                Over::Speed => {
                    let scene = scaled(scene, 1.0, value);
                    (relative_rpm(&scene), scene)
                }
                Over::ReturnAngle => {
                    (value, Scene { return_angle_deg: Some(value), ..scene.clone() })
                }
                Over::StepHeight => {
                    let height = scene.ball_diameter_mm.map(|ball| value * ball);
                    (value, Scene { step_height_mm: height, ..scene.clone() })
                }
            };
            let moving = Moving::of(&scene, self.settings, &mut self.work)?;
            // A point without a solution, or without a contact state, is a gap.
            let kinds = [AnalysisKind::Jam, AnalysisKind::Slip];
            let all = |_: &_| true;
            let numbers = kinds.map(|kind| kind.numbers(&scene, self.settings, Some(&moving), all));
            rows.push((x, numbers.into_iter().flatten().collect()));
        }
        Ok(rows)
    }
}

/// A number of the analyses of a sweep; its size, for a quantity whose sign says a direction.
fn points(rows: &Rows, name: &str) -> Vec<(f64, f64)> {
    let read = |analyses: &Vec<Numbers>| {
        analyses.iter().find_map(|numbers| numbers.number(name)).map_or(f64::NAN, f64::abs)
    };
    rows.iter().map(|(x, analyses)| (*x, read(analyses))).collect()
}

impl Study {
    /// Sweeps over load, speed and return angle around a scene, all with the model of `solution`.
    ///
    /// # Errors
    ///
    /// [`ValidateError::Point`] if the scene is incomplete.
    pub fn jam(
        scene: &Scene,
        settings: &Settings,
        solution: &Solution,
    ) -> Result<Self, ValidateError> {
        let settings = &Settings { model: solution.model.into(), ..*settings };
        let mut solver = Solver { settings, work: ModelWorkspace::default() };
        let mut study = Self { figures: Vec::new(), trends: Vec::new() };
        study.over_load(scene, &mut solver)?;
        study.over_speed(scene, &mut solver)?;
        if scene.return_angle_deg.is_some() {
            let rows = solver.run(scene, Over::ReturnAngle)?;
            let rises = |axis| (Over::ReturnAngle, Axis::linear(axis), Claim::Rises);
            study.add(
                ("jam-thrust-return-angle", "Thrust against the return angle", ""),
                rises("thrust, N"),
                of_sweep(&rows, &[("thrust", "thrust at the step", 0, SOLID, "step_thrust_N")]),
            );
            let ratio = [("entry", "step into the return", 0, SOLID, "entry_thrust_ratio")];
            study.add(
                ("jam-entry-return-angle", "Step into the return against its angle", ""),
                rises("thrust behind over thrust ahead"),
                of_sweep(&rows, &ratio),
            );
            let rows = solver.run(scene, Over::StepHeight)?;
            study.add(
                ("jam-entry-height", "Step into the return against its height", ""),
                (Over::StepHeight, Axis::log("thrust behind over thrust ahead"), Claim::Rises),
                of_sweep(&rows, &ratio),
            );
        }
        Ok(study)
    }

    fn over_load(&mut self, scene: &Scene, solver: &mut Solver<'_>) -> Result<(), ValidateError> {
        let rows = solver.run(scene, Over::Load)?;
        self.add(
            (
                "jam-approach",
                "Approach of ball and race against load",
                "Elastic and permanent approach together (solid), and the elastic part (dashed).",
            ),
            (Over::Load, Axis::linear("approach, um"), Claim::Rises),
            of_sweep(
                &rows,
                &[
                    ("approach", "nut", 0, SOLID, "nut_total_approach_um"),
                    ("approach", "screw", 1, SOLID, "screw_total_approach_um"),
                    ("", "nut, elastic", 0, DASHED, "nut_elastic_approach_um"),
                    ("", "screw, elastic", 1, DASHED, "screw_elastic_approach_um"),
                ],
            ),
        );
        let mut sweeps = Vec::new();
        for speed in SPEEDS {
            let scene = scaled(scene, 1.0, speed);
            sweeps.push((
                format!("{:.0} rpm", relative_rpm(&scene)),
                solver.run(&scene, Over::Load)?,
            ));
        }
        self.add(
            ("jam-wedge-load", "Difference of contact angles against load", ""),
            (Over::Load, Axis::log("angle difference, deg"), Claim::Falls),
            of_sweeps(&sweeps, "wedge", &[("", SOLID, "wedge_angle_deg")]),
        );
        self.angles(Over::Load, [Claim::Rises, Claim::Falls], &sweeps);
        self.used_friction(Over::Load, Claim::Falls, &sweeps);
        Ok(())
    }

    /// Contact angles, with a claim for the nut and one for the screw.
    fn angles(&mut self, over: Over, [nut, screw]: [Claim; 2], sweeps: &[(String, Rows)]) {
        for (member, claim, name) in
            [("nut", nut, "nut_settled_angle_deg"), ("screw", screw, "screw_settled_angle_deg")]
        {
            let group = if member == "nut" { "angle-nut" } else { "angle-screw" };
            let key = format!("jam-{group}-{}", over.key());
            let title = format!("Contact angle at the {member} against {}", over.key());
            self.add(
                (&key, &title, ""),
                (over, Axis::linear("contact angle, deg"), claim),
                of_sweeps(
                    sweeps,
                    group,
                    &[(if member == "nut" { ", nut" } else { ", screw" }, SOLID, name)],
                ),
            );
        }
    }

    /// The friction coefficient that the motion takes.
    fn used_friction(&mut self, over: Over, claim: Claim, sweeps: &[(String, Rows)]) {
        let key = format!("jam-friction-coefficient-{}", over.key());
        let title = format!("Friction coefficient that the motion takes, against {}", over.key());
        self.add(
            (&key, &title, "Friction force over normal load at nut (solid) and screw (dashed)."),
            (over, Axis::linear("friction force over normal load"), claim),
            of_sweeps(
                sweeps,
                "friction",
                &[
                    (", nut", SOLID, "nut_used_friction_coefficient"),
                    (", screw", DASHED, "screw_used_friction_coefficient"),
                ],
            ),
        );
    }

    fn over_speed(&mut self, scene: &Scene, solver: &mut Solver<'_>) -> Result<(), ValidateError> {
        let mut sweeps = Vec::new();
        for load in LOADS {
            let scene = scaled(scene, load, 1.0);
            let label = format!("{} kN", 1e-3 * scene.axial_load_N.unwrap_or(f64::NAN));
            sweeps.push((label, solver.run(&scene, Over::Speed)?));
        }
        let over = |axis| (Over::Speed, axis, Claim::Rises);
        self.add(
            (
                "jam-approach-speed",
                "Approach of ball and race against speed",
                "Elastic and permanent approach together, at nut (solid) and screw (dashed).",
            ),
            over(Axis::linear("approach, um")),
            of_sweeps(
                &sweeps,
                "",
                &[
                    (", nut", SOLID, "nut_total_approach_um"),
                    (", screw", DASHED, "screw_total_approach_um"),
                ],
            ),
        );
        self.angles(Over::Speed, [Claim::Falls, Claim::Rises], &sweeps);
        self.used_friction(Over::Speed, Claim::Rises, &sweeps);
        self.add(
            ("jam-wedge-speed", "Difference of contact angles against speed", ""),
            over(Axis::linear("angle difference, deg")),
            of_sweeps(&sweeps, "wedge", &[("", SOLID, "wedge_angle_deg")]),
        );
        self.add(
            (
                "jam-friction",
                "Forces on a ball in the wedge",
                "Both sides of the criterion of self-locking: the force that holds the ball (solid) \
                 and the force that pushes it out (dashed).",
            ),
            over(Axis::log("force, N")),
            of_sweeps(
                &sweeps,
                "",
                &[
                    (", holds", SOLID, "holding_force_N"),
                    (", pushes out", DASHED, "expelling_force_N"),
                ],
            ),
        );
        let middle = &sweeps[LOADS.len() / 2].1;
        self.add(
            ("jam-angular-velocity", "Angular velocities of a ball against speed", ""),
            over(Axis::linear("angular velocity, rad/s")),
            of_sweep(
                middle,
                &[
                    ("", "rotation", 0, SOLID, "ball_omega_rad_s"),
                    ("", "orbit in the nut", 1, SOLID, "orbit_rate_rad_s"),
                ],
            ),
        );
        self.add(
            ("jam-drag", "Drag and centrifugal force against speed", ""),
            over(Axis::linear("force on a ball, N")),
            of_sweep(
                middle,
                &[
                    ("drag", "drag", 0, SOLID, "drag_force_N"),
                    ("centrifugal", "centrifugal force", 1, SOLID, "centrifugal_force_N"),
                ],
            ),
        );
        self.thrust_over_speed(&sweeps);
        Ok(())
    }

    /// Thrust and friction in the ball return, and their margins.
    fn thrust_over_speed(&mut self, sweeps: &[(String, Rows)]) {
        self.add(
            (
                "jam-thrust-speed",
                "Thrust in the ball return against speed",
                "Friction of the loaded balls of one turn along the track: in the steady motion \
                 (dashed; none where balls roll), and of balls that are stopped (dotted).",
            ),
            (Over::Speed, Axis::log("force, N"), Claim::Rises),
            of_sweeps(sweeps, "thrust", &[(", thrust at the apex", SOLID, "apex_thrust_N")])
                .into_iter()
                .chain(of_sweeps(
                    sweeps,
                    "",
                    &[
                        (", friction along", DASHED, "screw_track_friction_N"),
                        (", friction of stopped balls", Stroke::Dotted, "stopped_track_friction_N"),
                    ],
                ))
                .collect(),
        );
        let falls = |axis| (Over::Speed, axis, Claim::Falls);
        for (key, title, group, name) in [
            (
                "jam-margin-speed",
                "Friction of stopped balls over thrust",
                "margin",
                "returner_margin",
            ),
            (
                "jam-published-margin-speed",
                "Friction in the steady motion over thrust",
                "published-margin",
                "published_margin",
            ),
        ] {
            self.add(
                (key, title, ""),
                falls(Axis::log("friction over thrust")),
                of_sweeps(sweeps, group, &[("", SOLID, name)]),
            );
        }
    }

    /// Adds a figure, and the trends of its curves that have a group.
    fn add(
        &mut self,
        (key, title, caption): (&str, &str, &str),
        (over, y, claim): (Over, Axis, Claim),
        wanted: Vec<Wanted<'_>>,
    ) {
        let mut curves = Vec::new();
        for Wanted { rows, group, label, color, stroke, name } in wanted {
            let points = points(rows, name);
            if !group.is_empty() {
                let size = points.iter().fold(0.0, |most: f64, (_, y)| most.max(*y));
                let quantity = y.label.split(',').next().unwrap_or_default();
                let group = format!("{group}-{}", over.key());
                let names = (group, format!("{quantity}, {label}"));
                self.trends.extend(Trend::of(names, claim, &points, ROUNDING * size));
            }
            // A logarithm has no zero, and what is rounding is nothing.
            let least = if y.log { ROUNDING } else { f64::NEG_INFINITY };
            let gap = |(x, y): (f64, f64)| (x, if y > least { y } else { f64::NAN });
            curves.extend(line(&label, color, stroke, points.into_iter().map(gap).collect()));
        }
        if !curves.is_empty() {
            self.figures.push(Figure {
                key: key.to_owned(),
                title: title.to_owned(),
                caption: caption.to_owned(),
                x: Axis::linear(over.axis()),
                y,
                curves,
            });
        }
    }
}
