//! The sweeps of Xu and Tang (2015), Figs 7-9: slips of a ball that rolls at given angles.

use std::f64::consts::PI;

use bsm_case::{Scene, Settings};
use bsm_dyn::{Control, Problem, Solution, SteadyBall, Touch, rim_speed};
use bsm_kin::{Drive, Helix, Site};
use bsm_report::{Axis, Figure, Stroke};

use super::{Claim, Study, Trend, line};
use crate::ValidateError;

/// What the sweeps keep.
#[derive(Debug, Clone, Copy)]
struct Screw {
    helix: Helix<f64>,
    ball_radius: f64,
    drive: Drive<f64>,
    contact_angle: f64,
    /// Semi-axes across the grooves of nut and screw at the scene's own point: they stay, so that
    /// a curve shows the motion and not the load.
    semi_axes: [Option<f64>; 2],
    control: Control,
}

/// Half the difference of the contact angles in the sweeps that do not vary them \[rad\]: 50 and
/// 40 deg about the 45 deg of the paper.
const APART: f64 = 5.0 * PI / 180.0;

/// Pitch circle over ball diameter at the ends of its sweep: 7 and 90 mm over 6 mm.
const PITCH: [f64; 2] = [7.0 / 6.0, 15.0];

/// What varies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Sweep {
    NutAngle,
    ScrewAngle,
    LeadAngle,
    PitchCircle,
}

impl Sweep {
    const ALL: [Self; 4] = [Self::NutAngle, Self::ScrewAngle, Self::LeadAngle, Self::PitchCircle];

    /// Name in keys, axis, and what stays.
    fn words(self) -> (&'static str, &'static str) {
        match self {
            Self::NutAngle => ("nut-angle", "contact angle at the nut, deg"),
            Self::ScrewAngle => ("screw-angle", "contact angle at the screw, deg"),
            Self::LeadAngle => ("lead-angle", "lead angle, deg"),
            Self::PitchCircle => ("pitch-circle", "pitch circle diameter, mm"),
        }
    }

    /// The published trend and the end of the range that it is claimed for.
    fn claim(self) -> (Claim, f64) {
        match self {
            Self::NutAngle | Self::ScrewAngle => (Claim::Falls, f64::INFINITY),
            Self::LeadAngle => (Claim::Falls, 75.0),
            Self::PitchCircle => (Claim::Rises, f64::INFINITY),
        }
    }

    /// Whole degrees; the ends of the range, where the formulas divide by zero, are left out.
    fn values(self, screw: &Screw) -> Vec<f64> {
        if self == Self::PitchCircle {
            let [low, high] = PITCH.map(|ratio| 2e3 * screw.ball_radius * ratio);
            return (0..=83).map(|i| low + (high - low) * f64::from(i) / 83.0).collect();
        }
        (1..=89).map(f64::from).collect()
    }

    /// The rolling ball at a value, and its contact angles.
    fn at(self, screw: &Screw, value: f64) -> (SteadyBall<f64>, [f64; 2]) {
        let (mut helix, beta) = (screw.helix, screw.contact_angle);
        let mut angles = [beta + APART, beta - APART];
        match self {
            Self::NutAngle => angles = [value.to_radians(), beta],
            Self::ScrewAngle => angles = [beta, value.to_radians()],
            Self::LeadAngle => helix.lead_angle = value.to_radians(),
            Self::PitchCircle => helix.radius = 0.5e-3 * value,
        }
        let ball =
            SteadyBall::rolling(screw.control, helix, screw.ball_radius, screw.drive, angles);
        (ball, angles)
    }
}

/// A slip at a contact whose ellipse has this semi-axis.
type Read = fn(&SteadyBall<f64>, &Touch<f64>, Option<f64>) -> Option<f64>;

/// Key, label, colour, published form, slip; the differential slip has one form only.
const SLIPS: [(&str, &str, usize, bool, Read); 7] = [
    ("differential", "differential", 0, true, |b, t, _| Some(b.differential_slip(t))),
    ("ball-published", "between balls, published", 1, true, |b, _, _| {
        Some(b.ball_slip_published())
    }),
    ("ball-exact", "between balls, exact", 1, false, |b, _, _| Some(b.ball_slip())),
    ("spin-published", "spin, published", 2, true, |b, t, _| Some(b.spin_slip_published(t))),
    ("spin-exact", "spin, exact", 2, false, |b, t, a| Some(rim_speed(b.spin(t), a?))),
    ("orbit-published", "orbit, published", 3, true, |b, t, _| Some(b.orbit_slip_published(t))),
    ("orbit-exact", "orbit's part of spin, exact", 3, false, |b, t, a| {
        Some(rim_speed(b.orbit_spin(t), a?))
    }),
];

impl Study {
    /// Sweeps over contact angles, lead angle and pitch circle around a scene.
    ///
    /// The ball rolls at given contact angles (raceway control without a balance of forces); the nut
    /// controls unless the settings say otherwise. `solution` gives the contact ellipses; its model has
    /// a motion of the ball.
    ///
    /// # Errors
    ///
    /// [`ValidateError::Point`] if the scene is incomplete.
    pub fn slip(
        scene: &Scene,
        settings: &Settings,
        solution: &Solution,
    ) -> Result<Self, ValidateError> {
        let control = settings.control.unwrap_or(Control::Nut);
        let axes =
            [Site::Nut, Site::Screw].map(|site| Some(solution.contact(site)?.pressed?.semi_axes.0));
        let (helix, ball_radius, drive, contact_angle) =
            match scene.problem(&solution.model.into())? {
                Problem::Rigid(p) => (p.helix, p.ball.radius, p.drive, p.contact_angle),
                Problem::RacewayControl(p) => kept(&p.screw),
                Problem::Elastic(p) => kept(&p.screw),
                Problem::Traction(p) => kept(&p.screw),
                other => unreachable!("{other:?} has no motion, and so no analysis"),
            };
        let screw = Screw { helix, ball_radius, drive, contact_angle, semi_axes: axes, control };
        let basis = match control {
            Control::Nut => "a ball that rolls at given contact angles, the nut controls",
            Control::Screw => "a ball that rolls at given contact angles, the screw controls",
        };
        let mut study = Self { basis: basis.to_owned(), figures: Vec::new(), trends: Vec::new() };
        for sweep in Sweep::ALL {
            for (i, site) in [Site::Nut, Site::Screw].into_iter().enumerate() {
                study.sweep(&screw, sweep, (i, site));
            }
        }
        Ok(study)
    }

    fn sweep(&mut self, screw: &Screw, sweep: Sweep, (i, site): (usize, Site)) {
        let place = ["nut", "screw"][i];
        let (key, axis) = sweep.words();
        let (claim, until) = sweep.claim();
        // What a slip may change by rounding.
        let rounding = 1e-9 * screw.ball_radius * screw.drive.relative_speed().abs();
        let mut curves = Vec::new();
        for (name, label, color, published, read) in SLIPS {
            let points: Vec<_> = sweep
                .values(screw)
                .into_iter()
                .map(|value| {
                    let (ball, angles) = sweep.at(screw, value);
                    let touch = Touch { site, angle: angles[i] };
                    (value, read(&ball, &touch, screw.semi_axes[i]).unwrap_or(f64::NAN))
                })
                .collect();
            let until = points.iter().copied().filter(|(x, _)| *x <= until).collect::<Vec<_>>();
            // Slip between balls has no contact: once is enough.
            if i == 0 || !name.starts_with("ball") {
                let at = if name.starts_with("ball") { "" } else { place };
                let curve = format!("{label} {at}").trim_end().to_owned();
                let names = (format!("{key}-{name}"), curve, axis);
                self.trends.extend(Trend::of(names, claim, &until, rounding));
            }
            // A logarithm has no zero.
            let gap = |(x, y): (f64, f64)| (x, if y > rounding { y } else { f64::NAN });
            let points = points.into_iter().map(gap).collect();
            let stroke = if published { Stroke::Solid } else { Stroke::Dashed };
            curves.extend(line(label, color, stroke, points));
        }
        self.figures.push(Figure {
            key: format!("slip-{key}-{place}"),
            title: format!("Slips at the {place} against {}", axis.split(',').next().unwrap_or("")),
            caption: format!(
                "Forms of Xu and Tang (2015) (solid) and exact ones (dashed) for {}; what is zero has \
                 no line.",
                self.basis
            ),
            x: Axis::linear(axis),
            y: Axis::log("slip, m/s"),
            curves,
        });
    }
}

fn kept(screw: &bsm_dyn::ElasticScrew) -> (Helix<f64>, f64, Drive<f64>, f64) {
    (screw.helix, screw.ball.radius, screw.drive, screw.contact_angle)
}
