//! The sweeps of Xu and Tang (2015), Figs 7-9: slips of a ball that rolls at given angles, or of the
//! balls of a model.

use bsm_case::{Scene, Settings};
use bsm_dyn::{
    Angles, Control, Direction, Model, ModelWorkspace, OperatingPoint, Problem, Solution,
    SteadyBall, Touch, rim_speed,
};
use bsm_kin::{Drive, Helix, Site};
use bsm_report::{Axis, Figure, Stroke};

use super::{Claim, Study, Trend, line};
use crate::ValidateError;

/// What the sweeps keep.
#[derive(Debug, Clone)]
struct Screw<'a> {
    scene: &'a Scene,
    helix: Helix<f64>,
    ball_radius: f64,
    drive: Drive<f64>,
    contact_angle: f64,
    /// Contact angles of nut and screw in the sweeps that do not vary them \[rad\].
    running_angles: [f64; 2],
    friction: f64,
    balls: Balls,
    /// What all curves have in common.
    basis: String,
}

/// Where the motion of the balls is from.
#[derive(Debug, Clone)]
enum Balls {
    /// They roll at given contact angles.
    Rolling {
        control: Control,
        /// Semi-axes across the grooves of nut and screw at the scene's own point: they stay, so that
        /// a curve shows the motion and not the load.
        semi_axes: [Option<f64>; 2],
    },
    /// A model is solved at each point.
    Solved(Settings),
}

impl Balls {
    /// What tells the figures of a model from those of rolling balls.
    fn prefix(&self) -> String {
        match self {
            Self::Rolling { .. } => String::new(),
            Self::Solved(settings) => format!("{}-", settings.model.name()),
        }
    }
}

/// A ball at a point of a sweep.
struct State {
    ball: SteadyBall<f64>,
    /// At nut and screw.
    touch: [Touch<f64>; 2],
    /// Across their grooves \[m\].
    semi_axes: [Option<f64>; 2],
    /// Of the model; of a ball that rolls, that of Lin's closed form.
    efficiency: f64,
}

const SITES: [Site; 2] = [Site::Nut, Site::Screw];

/// Pitch circle over ball diameter at the ends of its sweep: 7 and 90 mm over 6 mm.
const PITCH: [f64; 2] = [7.0 / 6.0, 15.0];

/// From which pitch circle over ball diameter on a screw is said to work as usual: 20 mm over 6 mm.
const USUAL_PITCH: f64 = 20.0 / 6.0;

/// Angles after which the slips are said to fall less, and from which on they are said to rise \[deg\].
const CONTACT_KNEE: f64 = 40.0;
const LEAD_KNEE: f64 = 10.0;
const STEEPEST: f64 = 75.0;

/// What varies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Sweep {
    NutAngle,
    ScrewAngle,
    /// Both, as a model has it.
    ContactAngle,
    LeadAngle,
    PitchCircle,
}

impl Sweep {
    const ROLLING: [Self; 4] =
        [Self::NutAngle, Self::ScrewAngle, Self::LeadAngle, Self::PitchCircle];
    const SOLVED: [Self; 3] = [Self::ContactAngle, Self::LeadAngle, Self::PitchCircle];

    /// Name in keys, axis, and what stays.
    fn words(self) -> (&'static str, &'static str) {
        match self {
            Self::NutAngle => ("nut-angle", "contact angle at the nut, deg"),
            Self::ScrewAngle => ("screw-angle", "contact angle at the screw, deg"),
            Self::ContactAngle => ("contact-angle", "contact angle, deg"),
            Self::LeadAngle => ("lead-angle", "lead angle, deg"),
            Self::PitchCircle => ("pitch-circle", "pitch circle diameter, mm"),
        }
    }

    /// What is published of a slip: name of the claim, claim, and the range that it is claimed for.
    fn claims(self, slip: &Slip, screw: &Screw) -> Vec<(&'static str, Claim, [f64; 2])> {
        const ALL: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];
        let usual = 2e3 * screw.ball_radius * USUAL_PITCH;
        let printed = slip.form == Form::Printed;
        let mut claims = match self {
            Self::NutAngle | Self::ScrewAngle | Self::ContactAngle => {
                vec![("", Claim::Falls, ALL), ("-knee", Claim::Flattens(CONTACT_KNEE), ALL)]
            }
            Self::LeadAngle => {
                let (low, high) = ([0.0, STEEPEST], [STEEPEST, f64::INFINITY]);
                vec![
                    ("", Claim::Falls, low),
                    ("-knee", Claim::Flattens(LEAD_KNEE), low),
                    ("-steep", Claim::Rises, high),
                ]
            }
            Self::PitchCircle if slip.kind == Kind::Differential => {
                vec![
                    ("", Claim::Rises, [usual, f64::INFINITY]),
                    ("-small", Claim::Falls, [0.0, usual]),
                ]
            }
            Self::PitchCircle => vec![("", Claim::Rises, ALL)],
        };
        // What is said in passing is said of the curves of the paper, and the rise of two of them.
        let rising = matches!(slip.kind, Kind::Differential | Kind::Orbit);
        claims.retain(|(name, ..)| match *name {
            "" => true,
            "-steep" => printed && rising,
            _ => printed,
        });
        claims
    }

    /// Whole degrees; the ends of the range, where the formulas divide by zero, are left out.
    fn values(self, screw: &Screw) -> Vec<f64> {
        if self == Self::PitchCircle {
            let [low, high] = PITCH.map(|ratio| 2e3 * screw.ball_radius * ratio);
            return (0..=83).map(|i| low + (high - low) * f64::from(i) / 83.0).collect();
        }
        (1..=89).map(f64::from).collect()
    }

    /// The state at a value; `None` without a solution.
    fn at(
        self,
        screw: &Screw,
        value: f64,
        work: &mut ModelWorkspace,
    ) -> Result<Option<State>, ValidateError> {
        match &screw.balls {
            Balls::Rolling { control, semi_axes } => {
                Ok(Some(self.rolling(screw, value, *control, *semi_axes)))
            }
            Balls::Solved(settings) => self.solved(screw, value, settings, work),
        }
    }

    /// The rolling ball.
    fn rolling(
        self,
        screw: &Screw,
        value: f64,
        control: Control,
        semi_axes: [Option<f64>; 2],
    ) -> State {
        let (mut helix, beta) = (screw.helix, screw.contact_angle);
        let (mut angles, mut equal) = (screw.running_angles, beta);
        match self {
            Self::NutAngle => (angles, equal) = ([value.to_radians(), beta], value.to_radians()),
            Self::ScrewAngle => (angles, equal) = ([beta, value.to_radians()], value.to_radians()),
            Self::ContactAngle => (angles, equal) = ([value.to_radians(); 2], value.to_radians()),
            Self::LeadAngle => helix.lead_angle = value.to_radians(),
            Self::PitchCircle => helix.radius = 0.5e-3 * value,
        }
        let ball = SteadyBall::rolling(control, helix, screw.ball_radius, screw.drive, angles);
        let lin = Angles { lead: helix.lead_angle, contact: equal };
        let direction =
            Direction::of(screw.drive.relative_speed()).unwrap_or(Direction::RotaryToLinear);
        State {
            ball,
            touch: [0, 1].map(|i| Touch { site: SITES[i], angle: angles[i] }),
            semi_axes,
            efficiency: lin.efficiency(direction, screw.friction),
        }
    }

    fn solved(
        self,
        screw: &Screw,
        value: f64,
        settings: &Settings,
        work: &mut ModelWorkspace,
    ) -> Result<Option<State>, ValidateError> {
        let (mut scene, mut helix) = (screw.scene.clone(), screw.helix);
        match self {
            Self::NutAngle | Self::ScrewAngle => unreachable!("a model has one contact angle"),
            Self::ContactAngle => scene.set("contact_angle_deg", value)?,
            Self::LeadAngle => {
                scene.set("lead_angle_deg", value)?;
                helix.lead_angle = value.to_radians();
            }
            Self::PitchCircle => {
                // The lead angle stays, not the lead.
                scene.set("lead_angle_deg", helix.lead_angle.to_degrees())?;
                scene.set("pitch_circle_diameter_mm", value)?;
                helix.radius = 0.5e-3 * value;
            }
        }
        // The scene itself has a problem; a value may break a rule, such as that of the smallest circle.
        let Ok(problem) = scene.problem(settings) else { return Ok(None) };
        let solution = problem.solve(work);
        let Some(solved) = solution.solved() else { return Ok(None) };
        let Some(motion) = solved.ball.motion else { return Ok(None) };
        let state = |i: usize| solution.contact(SITES[i]);
        let (drive, radius) = (screw.drive, screw.ball_radius);
        Ok(Some(State {
            ball: SteadyBall { helix, radius, drive, motion },
            touch: [0, 1].map(|i| Touch {
                site: SITES[i],
                angle: state(i).map_or(f64::NAN, |contact| contact.angle),
            }),
            semi_axes: [0, 1].map(|i| Some(state(i)?.pressed?.semi_axes.0)),
            efficiency: solved.transmission.efficiency,
        }))
    }
}

/// Whose formula it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Form {
    Printed,
    Corrected,
    Exact,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Differential,
    Ball,
    Spin,
    Orbit,
}

/// A slip in one form.
struct Slip {
    kind: Kind,
    form: Form,
    /// Name in keys.
    name: &'static str,
    label: &'static str,
    /// At contact `i`.
    read: fn(&State, usize) -> Option<f64>,
}

impl Slip {
    fn at(&self, state: Option<&State>, i: usize) -> f64 {
        state.and_then(|state| (self.read)(state, i)).unwrap_or(f64::NAN)
    }
}

/// The differential slip has one form only; as printed, the formulas of one contact take the angle of
/// the other.
const SLIPS: [Slip; 9] = [
    Slip {
        kind: Kind::Differential,
        form: Form::Printed,
        name: "differential",
        label: "differential",
        read: |s, i| Some(s.ball.differential_slip(&s.touch[i])),
    },
    Slip {
        kind: Kind::Ball,
        form: Form::Printed,
        name: "ball-printed",
        label: "between balls, printed",
        read: |s, _| Some(s.ball.ball_slip_published()),
    },
    Slip {
        kind: Kind::Ball,
        form: Form::Exact,
        name: "ball-exact",
        label: "between balls, exact",
        read: |s, _| Some(s.ball.ball_slip()),
    },
    Slip {
        kind: Kind::Spin,
        form: Form::Printed,
        name: "spin-printed",
        label: "spin, printed",
        read: |s, i| Some(s.ball.spin_slip_published(s.touch[1 - i].angle)),
    },
    Slip {
        kind: Kind::Spin,
        form: Form::Corrected,
        name: "spin-corrected",
        label: "spin, corrected",
        read: |s, i| Some(s.ball.spin_slip_published(s.touch[i].angle)),
    },
    Slip {
        kind: Kind::Spin,
        form: Form::Exact,
        name: "spin-exact",
        label: "spin, exact",
        read: |s, i| Some(rim_speed(s.ball.spin(&s.touch[i]), s.semi_axes[i]?)),
    },
    Slip {
        kind: Kind::Orbit,
        form: Form::Printed,
        name: "orbit-printed",
        label: "orbit, printed",
        read: |s, i| Some(s.ball.orbit_slip_published(SITES[i], s.touch[1 - i].angle)),
    },
    Slip {
        kind: Kind::Orbit,
        form: Form::Corrected,
        name: "orbit-corrected",
        label: "orbit, corrected",
        read: |s, i| Some(s.ball.orbit_slip_published(SITES[i], s.touch[i].angle)),
    },
    Slip {
        kind: Kind::Orbit,
        form: Form::Exact,
        name: "orbit-exact",
        label: "orbit's part of spin, exact",
        read: |s, i| Some(rim_speed(s.ball.orbit_spin(&s.touch[i]), s.semi_axes[i]?)),
    },
];

fn slip(name: &str) -> &'static Slip {
    SLIPS.iter().find(|slip| slip.name == name).expect("a name of the table")
}

/// A point of a sweep: value, and state if there is a solution.
type Point = (f64, Option<State>);

impl Study {
    /// Sweeps over contact angle, lead angle, pitch circle and speed around a scene.
    ///
    /// With raceway control the ball rolls at given contact angles, without a balance of forces, and the nut
    /// controls unless the settings say otherwise; the angle at the nut and the angle at the screw
    /// vary one by one, and are those of the scene in motion elsewhere. Any other model is solved at each point; its contact angle, unloaded where the
    /// contacts are elastic, is varied. `solution` tells the model, which has a motion of the ball, and for
    /// raceway control the contact ellipses.
    ///
    /// # Errors
    ///
    /// [`ValidateError::Point`] if the scene is incomplete.
    pub fn slip(
        scene: &Scene,
        settings: &Settings,
        solution: &Solution,
    ) -> Result<Self, ValidateError> {
        let model = solution.model;
        let (screw, sweeps) = if model == Model::RacewayControl {
            let control = settings.control.unwrap_or(Control::Nut);
            let semi_axes = [Site::Nut, Site::Screw]
                .map(|site| Some(solution.contact(site)?.pressed?.semi_axes.0));
            let race = control.name();
            let basis = format!("a ball that rolls at given contact angles, the {race} controls");
            let balls = Balls::Rolling { control, semi_axes };
            (Screw::of(scene, model, balls, basis)?, &Sweep::ROLLING[..])
        } else {
            let basis = format!("the balls of model {}", model.name());
            let balls = Balls::Solved(Settings { model: model.into(), ..*settings });
            (Screw::of(scene, model, balls, basis)?, &Sweep::SOLVED[..])
        };
        let mut study = Self { figures: Vec::new(), trends: Vec::new() };
        let work = &mut ModelWorkspace::default();
        let mut swept = Vec::new();
        for sweep in sweeps {
            let at = |value: f64| Ok::<_, ValidateError>((value, sweep.at(&screw, value, work)?));
            let points: Vec<Point> =
                sweep.values(&screw).into_iter().map(at).collect::<Result<_, _>>()?;
            for (i, place) in ["nut", "screw"].into_iter().enumerate() {
                study.draw(&screw, *sweep, &points, (i, place));
            }
            study.trend_of_efficiency(*sweep, &points);
            swept.push((*sweep, points));
        }
        study.comparisons(&swept);
        if !matches!(model, Model::Rigid) {
            study.speeds(scene, &Settings { model: model.into(), ..*settings }, work)?;
        }
        Ok(study)
    }

    fn draw(&mut self, screw: &Screw, sweep: Sweep, points: &[Point], (i, place): (usize, &str)) {
        let (key, axis) = sweep.words();
        // What a slip may change by rounding.
        let rounding = 1e-9 * screw.ball_radius * screw.drive.relative_speed().abs();
        let mut curves = Vec::new();
        for slip in &SLIPS {
            let points: Vec<_> =
                points.iter().map(|(x, state)| (*x, slip.at(state.as_ref(), i))).collect();
            // Slip between balls has no contact: once is enough.
            if i == 0 || slip.kind != Kind::Ball {
                let at = if slip.kind == Kind::Ball { "" } else { place };
                let curve = format!("{} {at}", slip.label).trim_end().to_owned();
                for (name, claim, [low, high]) in sweep.claims(slip, screw) {
                    let within: Vec<_> =
                        points.iter().copied().filter(|(x, _)| (low..=high).contains(x)).collect();
                    let group = format!("{key}-{}{name}", slip.name);
                    self.trends.extend(Trend::of((group, curve.clone()), claim, &within, rounding));
                }
            }
            // A logarithm has no zero.
            let gap = |(x, y): (f64, f64)| (x, if y > rounding { y } else { f64::NAN });
            let points = points.into_iter().map(gap).collect();
            let stroke = match slip.form {
                Form::Printed => Stroke::Solid,
                Form::Corrected => Stroke::Dotted,
                Form::Exact => Stroke::Dashed,
            };
            curves.extend(line(slip.label, slip.kind as usize, stroke, points));
        }
        self.figures.push(Figure {
            key: format!("slip-{}{key}-{place}", screw.balls.prefix()),
            title: format!("Slips at the {place} against {}", axis.split(',').next().unwrap_or("")),
            caption: format!(
                "Xu and Tang (2015), Figs 7 to 9: as printed (solid), with the angles of the contact itself \
                 (dotted), and exact (dashed) for {}; what is zero has no line.",
                screw.basis
            ),
            x: Axis::linear(axis),
            y: Axis::log("slip, m/s"),
            curves,
        });
    }

    /// The efficiency of Lin et al., to whose curve the slips are said to correspond: it must rise where
    /// they fall.
    fn trend_of_efficiency(&mut self, sweep: Sweep, points: &[Point]) {
        let (key, _) = sweep.words();
        let claims: &[(&str, Claim, [f64; 2])] = match sweep {
            Sweep::NutAngle | Sweep::ScrewAngle | Sweep::ContactAngle => {
                &[("", Claim::Rises, [0.0, 90.0])]
            }
            Sweep::LeadAngle => &[
                ("", Claim::Rises, [0.0, STEEPEST]),
                ("-steep", Claim::Falls, [STEEPEST, f64::INFINITY]),
            ],
            Sweep::PitchCircle => &[("", Claim::Falls, [0.0, f64::INFINITY])],
        };
        for (name, claim, [low, high]) in claims {
            let within = points.iter().filter(|(x, _)| (*low..=*high).contains(x));
            let eta = within.map(|(x, s)| (*x, s.as_ref().map_or(f64::NAN, |s| s.efficiency)));
            let group = format!("{key}-efficiency{name}");
            let names = (group, "efficiency".to_owned());
            self.trends.extend(Trend::of(names, *claim, &eta.collect::<Vec<_>>(), 1e-9));
        }
    }

    /// What is said of slips beside each other: which is larger, and which changes more.
    fn comparisons(&mut self, swept: &[(Sweep, Vec<Point>)]) {
        let published = |kind: Kind| {
            SLIPS.iter().find(|s| s.kind == kind && s.form == Form::Printed).expect("in the table")
        };
        let large = [Kind::Differential, Kind::Orbit].map(published);
        let small = [Kind::Ball, Kind::Spin].map(published);
        for (sweep, points) in swept {
            let (key, _) = sweep.words();
            for (i, place) in ["nut", "screw"].into_iter().enumerate() {
                for (large, small) in large.iter().flat_map(|l| small.iter().map(move |s| (l, s))) {
                    let ratio = |(x, state): &Point| {
                        (*x, large.at(state.as_ref(), i) / small.at(state.as_ref(), i))
                    };
                    let ratios: Vec<_> = points.iter().map(ratio).collect();
                    let curve = format!("{} over {} {place}", large.label, small.label);
                    let names = (format!("{key}-small-{}", small.name), curve.clone());
                    self.trends.extend(Trend::of(names, Claim::Exceeds, &ratios, 0.0));
                    if matches!(sweep, Sweep::NutAngle | Sweep::ScrewAngle | Sweep::ContactAngle) {
                        let spread = |slip: &Slip| {
                            let values = points.iter().map(|(_, s)| slip.at(s.as_ref(), i));
                            let values: Vec<_> = values.filter(|v| v.is_finite()).collect();
                            values.iter().copied().fold(0.0, f64::max)
                                - values.iter().copied().fold(f64::INFINITY, f64::min)
                        };
                        let middle = [(45.0, spread(large) / spread(small))];
                        let curve = format!("change of {curve}");
                        let names = (format!("{key}-influence-{}", small.name), curve);
                        self.trends.extend(Trend::of(names, Claim::Exceeds, &middle, 0.0));
                    }
                }
            }
        }
        // Fig 7 has the angle at the nut beside the angle at the screw.
        let of = |wanted: Sweep| swept.iter().find(|(sweep, _)| *sweep == wanted).map(|(_, p)| p);
        let pair = (of(Sweep::NutAngle).or(of(Sweep::ContactAngle)))
            .zip(of(Sweep::ScrewAngle).or(of(Sweep::ContactAngle)));
        let Some((at_nut, at_screw)) = pair else { return };
        for name in ["orbit-printed", "orbit-corrected", "orbit-exact"] {
            let orbit = slip(name);
            let ratio = |(a, b): (&Point, &Point)| {
                (a.0, orbit.at(a.1.as_ref(), 0) / orbit.at(b.1.as_ref(), 1))
            };
            let ratios: Vec<_> = at_nut.iter().zip(at_screw).map(ratio).collect();
            let names =
                (format!("contact-angle-{name}-above"), format!("{} nut over screw", orbit.label));
            self.trends.extend(Trend::of(names, Claim::Exceeds, &ratios, 0.0));
        }
    }

    /// Contact angles against the speed, of which the paper takes 50 deg at the nut and 40 at the screw.
    fn speeds(
        &mut self,
        scene: &Scene,
        settings: &Settings,
        work: &mut ModelWorkspace,
    ) -> Result<(), ValidateError> {
        const AXIS: &str = "speed, rpm";
        let Some((screw, nut)) = scene.speeds_rpm() else { return Ok(()) };
        // From a fiftieth to twice the speed of the scene.
        let factors: Vec<_> =
            (0..=40).map(|i| 0.02 * 100.0_f64.powf(f64::from(i) / 40.0)).collect();
        let mut angles = [Vec::new(), Vec::new()];
        for factor in factors {
            let scene = Scene {
                screw_speed_rpm: Some(factor * screw),
                nut_speed_rpm: Some(factor * nut),
                ..scene.clone()
            };
            let solution = scene.problem(settings)?.solve(work);
            for (points, site) in angles.iter_mut().zip(SITES) {
                let angle = solution.contact(site).map_or(f64::NAN, |c| c.angle.to_degrees());
                points.push((factor * (screw - nut).abs(), angle));
            }
        }
        let mut curves = Vec::new();
        for (i, (points, claim)) in angles.into_iter().zip([Claim::Rises, Claim::Falls]).enumerate()
        {
            let label = ["at the nut", "at the screw"][i];
            let names =
                (format!("speed-{}", ["nut", "screw"][i]), format!("contact angle {label}"));
            self.trends.extend(Trend::of(names, claim, &points, 1e-9));
            curves.extend(line(label, i, Stroke::Solid, points));
        }
        self.figures.push(Figure {
            key: "slip-speed-angles".to_owned(),
            title: "Contact angles against speed".to_owned(),
            caption: format!(
                "Xu and Tang (2015) take 50 deg at the nut and 40 deg at the screw, as if the centrifugal force raised \
                 the angle at the nut. It lowers it. Model {}.",
                settings.model.name()
            ),
            x: Axis::log(AXIS),
            y: Axis::linear("contact angle, deg"),
            curves,
        });
        Ok(())
    }
}

impl<'a> Screw<'a> {
    fn of(
        scene: &'a Scene,
        model: Model,
        balls: Balls,
        basis: String,
    ) -> Result<Self, ValidateError> {
        let OperatingPoint { helix, contact_angle, ball, friction, drive, .. } =
            match scene.problem(&model.into())? {
                Problem::Rigid(p) => p.point,
                Problem::RacewayControl(p) => p.at.point,
                Problem::Elastic(p) => p.at.point,
                Problem::Traction(p) => p.at.point,
                other => unreachable!("{other:?} has no motion, and so no analysis"),
            };
        let (ball_radius, friction) = (ball.radius, friction.0);
        let running_angles = scene.running_angles().unwrap_or([contact_angle; 2]);
        Ok(Self {
            scene,
            helix,
            ball_radius,
            drive,
            contact_angle,
            running_angles,
            friction,
            balls,
            basis,
        })
    }
}
