//! Sweeps of Xu and Tang (2015), Figs 7-9: slip of a ball that rolls at given contact angles or
//! moves as calculated by a model.

use bsm_case::units::RPM;
use bsm_case::{Answer, Case, CaseError, OutputName, Settings, output};
use bsm_dyn::{Control, Direction, Model, ModelWorkspace, Solution, angles::Angles};
use bsm_kin::Site;

use super::study::{Study, line};
use crate::{Figure, PlotAxis, ReportError, Stroke};

/// Smallest and largest ratio of pitch circle diameter to ball diameter in the sweep: 7 and 90 mm
/// divided by 6 mm.
const PITCH: [f64; 2] = [7.0 / 6.0, 15.0];

/// A slip formula that is drawn as a curve: name, kind of slip, line style for the source of the
/// formula, label, and outputs at nut and screw. The formulas printed in the paper use, for each
/// contact, the contact angle of the opposite contact.
type Slip = (&'static str, usize, Stroke, &'static str, [OutputName; 2]);

const PRINTED: Stroke = Stroke::Solid;
const CORRECTED: Stroke = Stroke::Dotted;
const EXACT: Stroke = Stroke::Dashed;

/// Index of the slip between neighboring balls, which does not belong to a contact.
const BETWEEN_BALLS: usize = 1;

/// All slip formulas. The differential slip has a single entry, because its printed and exact
/// formulas are the same.
const SLIPS: [Slip; 9] = [
    (
        "differential",
        0,
        PRINTED,
        "differential",
        [output!(nut_differential_slip_m_s), output!(screw_differential_slip_m_s)],
    ),
    (
        "ball-printed",
        BETWEEN_BALLS,
        PRINTED,
        "between balls, printed",
        [output!(ball_slip_printed_m_s), output!(ball_slip_printed_m_s)],
    ),
    (
        "ball-exact",
        BETWEEN_BALLS,
        EXACT,
        "between balls, exact",
        [output!(ball_slip_m_s), output!(ball_slip_m_s)],
    ),
    (
        "spin-printed",
        2,
        PRINTED,
        "spin, printed",
        [output!(nut_spin_slip_printed_m_s), output!(screw_spin_slip_printed_m_s)],
    ),
    (
        "spin-corrected",
        2,
        CORRECTED,
        "spin, corrected",
        [output!(nut_spin_slip_corrected_m_s), output!(screw_spin_slip_corrected_m_s)],
    ),
    (
        "spin-exact",
        2,
        EXACT,
        "spin, exact",
        [output!(nut_spin_slip_m_s), output!(screw_spin_slip_m_s)],
    ),
    (
        "orbit-printed",
        3,
        PRINTED,
        "orbit, printed",
        [output!(nut_orbit_slip_printed_m_s), output!(screw_orbit_slip_printed_m_s)],
    ),
    (
        "orbit-corrected",
        3,
        CORRECTED,
        "orbit, corrected",
        [output!(nut_orbit_slip_corrected_m_s), output!(screw_orbit_slip_corrected_m_s)],
    ),
    (
        "orbit-exact",
        3,
        EXACT,
        "spin due to the orbital motion, exact",
        [output!(nut_orbit_slip_m_s), output!(screw_orbit_slip_m_s)],
    ),
];

/// A varied quantity: its name in the keys of figures, and its axis label.
type Sweep = (&'static str, &'static str);

const LEAD_ANGLE: Sweep = ("lead-angle", "lead angle, deg");
const PITCH_CIRCLE: Sweep = ("pitch-circle", "pitch circle diameter, mm");
const ROLLING: [Sweep; 4] = [
    ("nut-angle", "contact angle at the nut, deg"),
    ("screw-angle", "contact angle at the screw, deg"),
    LEAD_ANGLE,
    PITCH_CIRCLE,
];
const SOLVED: [Sweep; 3] = [("contact-angle", "contact angle, deg"), LEAD_ANGLE, PITCH_CIRCLE];

/// Returns the values of a sweep: diameters for the pitch circle, and whole degrees for angles. The
/// ends of the angle range are left out, because the formulas would divide by zero.
fn values(sweep: Sweep, case: &Case) -> Vec<f64> {
    if sweep == PITCH_CIRCLE {
        let [low, high] = PITCH.map(|ratio| case.ball_diameter_mm.unwrap_or(f64::NAN) * ratio);
        return (0..=83).map(|i| low + (high - low) * f64::from(i) / 83.0).collect();
    }
    (1..=89).map(f64::from).collect()
}

/// Returns the case with the varied quantity set to a value of the sweep.
fn at(case: &Case, (name, _): Sweep, value: f64) -> Result<Case, CaseError> {
    let mut varied = case.clone();
    let own = case.contact_angle_deg;
    let mut running = |nut, screw| {
        varied.nut_running_contact_angle_deg = nut;
        varied.screw_running_contact_angle_deg = screw;
    };
    match name {
        "nut-angle" => running(Some(value), own),
        "screw-angle" => running(own, Some(value)),
        "pitch-circle" => {
            // The lead angle is kept constant instead of the lead.
            let lead = case.lead_angle().map_or(f64::NAN, f64::to_degrees);
            varied.set("lead_angle_deg", lead)?;
            varied.set("pitch_circle_diameter_mm", value)?;
            return Ok(varied);
        }
        _ => {}
    }
    varied.set(if name == "lead-angle" { "lead_angle_deg" } else { "contact_angle_deg" }, value)?;
    Ok(varied)
}

/// Slips and efficiency at a point of a sweep. The efficiency is calculated by the model or, for a
/// rolling ball, with Lin's closed-form solution.
type State = (Answer, f64);

/// A point of a sweep: value of the varied quantity, and results if there is a solution.
type Point = (f64, Option<State>);

/// Calculates the slips of a rolling ball with the contact ellipses of `solution`. Because the
/// ellipses do not change, a curve shows only the effect of the motion and not of the load.
fn rolling(case: &Case, settings: &Settings, solution: &Solution) -> Option<State> {
    let report = bsm_case::slip(case, settings, solution).ok()?;
    let (screw, nut) = case.speeds_rpm()?;
    let direction = Direction::of(screw - nut).unwrap_or(Direction::RotaryToLinear);
    let angles = Angles { lead: case.lead_angle()?, contact: case.contact_angle_deg?.to_radians() };
    Some((report, angles.efficiency(direction, case.friction_coefficient?)))
}

/// Solves a case with a model and calculates the slips. Returns `None` if the case has no solution
/// or is not permitted, for example because the pitch circle is too small.
fn solved(case: &Case, settings: &Settings, work: &mut ModelWorkspace) -> Option<State> {
    let solution = case.problem(settings).ok()?.solve(work);
    let report = bsm_case::slip(case, settings, &solution).ok()?;
    Some((report, solution.efficiency()?))
}

impl Study {
    /// Performs sweeps over contact angle, lead angle, pitch circle and speed around a case.
    ///
    /// With raceway control, the ball rolls at given contact angles without a force balance, and
    /// the nut is the controlling raceway unless the settings state otherwise. The contact angle at
    /// the nut and the contact angle at the screw are varied one at a time, while the other angle
    /// is the contact angle of the case. With any other model, each point is solved with a
    /// different contact angle, which is the unloaded contact angle for models with elastic
    /// contacts. `solution` determines the model, which must calculate the motion of the ball and,
    /// for raceway control, also the contact ellipses.
    ///
    /// # Errors
    ///
    /// Returns [`ReportError::Case`] if the case is incomplete.
    pub fn slip(
        case: &Case,
        settings: &Settings,
        solution: &Solution,
    ) -> Result<Self, ReportError> {
        let settings = &Settings { model: solution.model.into(), ..*settings };
        let rolls = solution.model == Model::RacewayControl;
        let mut base = case.clone();
        let [nut, screw] =
            [&mut base.nut_running_contact_angle_deg, &mut base.screw_running_contact_angle_deg];
        let (sweeps, prefix, basis) = if rolls {
            *nut = nut.or(case.contact_angle_deg);
            *screw = screw.or(case.contact_angle_deg);
            let raceway = settings.control.unwrap_or(Control::Nut).name();
            let basis =
                format!("a ball that rolls at given contact angles under {raceway} control");
            (&ROLLING[..], String::new(), basis)
        } else {
            (*nut, *screw) = (None, None);
            let model = solution.model.name();
            (&SOLVED[..], format!("{model}-"), format!("the balls of model {model}"))
        };
        let mut study = Self::default();
        let work = &mut ModelWorkspace::default();
        for sweep in sweeps {
            let mut point = |value: f64| {
                let case = at(&base, *sweep, value)?;
                let state = if rolls {
                    rolling(&case, settings, solution)
                } else {
                    solved(&case, settings, work)
                };
                Ok((value, state))
            };
            let points = values(*sweep, &base).into_iter().map(&mut point);
            let points: Vec<Point> = points.collect::<Result<_, ReportError>>()?;
            for place in ["nut", "screw"] {
                study.draw(&base, (&prefix, &basis), *sweep, &points, place);
            }
            let efficiency = |(x, state): &Point| (*x, state.as_ref().map_or(f64::NAN, |s| s.1));
            let points: Vec<_> = points.iter().map(efficiency).collect();
            let name = format!("{}-efficiency", sweep.0);
            study.add_curve(name, "efficiency".to_owned(), &points, 1e-9);
        }
        if solution.model != Model::Rigid {
            study.speeds(case, settings, work)?;
        }
        Ok(study)
    }

    /// Plots the slip speeds at one contact as a function of the varied quantity.
    fn draw(
        &mut self,
        case: &Case,
        (prefix, basis): (&str, &str),
        (sweep, axis): Sweep,
        points: &[Point],
        place: &str,
    ) {
        // The rounding error of a slip is about 1e-9 of the surface speed of the ball.
        let (screw, nut) = case.speeds_rpm().unwrap_or_default();
        let rim = 0.5e-3 * case.ball_diameter_mm.unwrap_or(f64::NAN) * RPM * (screw - nut).abs();
        let rounding = 1e-9 * rim;
        let mut curves = Vec::new();
        for (name, kind, stroke, label, numbers) in SLIPS {
            let between = kind == BETWEEN_BALLS;
            let number = numbers[usize::from(place == "screw")];
            let read = |(x, state): &Point| {
                let slip = state.as_ref().and_then(|(report, _)| report.number(number));
                (*x, slip.unwrap_or(f64::NAN))
            };
            let points: Vec<_> = points.iter().map(read).collect();
            let name = format!("{sweep}-{name}");
            if !between {
                self.add_curve(
                    format!("{name}-{place}"),
                    format!("{label} {place}"),
                    &points,
                    rounding,
                );
            } else if place == "nut" {
                self.add_curve(name, label.to_owned(), &points, rounding);
            }
            // Values that consist only of rounding errors are left out, because a logarithmic axis
            // cannot show zero.
            curves.extend(line(label, kind, stroke, points, rounding));
        }
        let against = axis.split(',').next().unwrap_or_default();
        self.figures.push(Figure::new(
            [
                &format!("slip-{prefix}{sweep}-{place}"),
                &format!("Slip at the {place} against {against}"),
                &format!(
                    "Xu and Tang (2015), Figs 7 to 9: as printed (solid), with the angles of the contact itself \
                     (dotted), and exact (dashed) for {basis}. Slips that are zero have no line."
                ),
            ],
            [PlotAxis::linear(axis), PlotAxis::log("slip, m/s")],
            curves,
        ));
    }

    /// Plots the contact angles against the speed. The paper assumes 50 deg at the nut and 40 deg
    /// at the screw.
    fn speeds(
        &mut self,
        case: &Case,
        settings: &Settings,
        work: &mut ModelWorkspace,
    ) -> Result<(), ReportError> {
        let Some((screw, nut)) = case.speeds_rpm() else { return Ok(()) };
        let mut angles = [Vec::new(), Vec::new()];
        // The speeds range from one fiftieth of the speed of the case to twice this speed.
        for i in 0..=40 {
            let factor = 0.02 * 100.0_f64.powf(f64::from(i) / 40.0);
            let case = Case {
                screw_speed_rpm: Some(factor * screw),
                nut_speed_rpm: Some(factor * nut),
                ..case.clone()
            };
            let solution = case.problem(settings)?.solve(work);
            for (points, site) in angles.iter_mut().zip([Site::Nut, Site::Screw]) {
                let angle = solution.contact(site).map_or(f64::NAN, |c| c.angle.to_degrees());
                points.push((factor * (screw - nut).abs(), angle));
            }
        }
        let mut curves = Vec::new();
        for (color, (place, points)) in ["nut", "screw"].into_iter().zip(angles).enumerate() {
            let label = format!("at the {place}");
            self.add_curve(
                format!("speed-{place}"),
                format!("contact angle {label}"),
                &points,
                1e-9,
            );
            curves.extend(line(&label, color, Stroke::Solid, points, f64::NEG_INFINITY));
        }
        let caption = format!(
            "Xu and Tang (2015) assume 50 deg at the nut and 40 deg at the screw, as if the centrifugal force increased \
             the angle at the nut, but it decreases this angle. Model {}.",
            settings.model.name()
        );
        self.figures.push(Figure::new(
            ["slip-speed-angles", "Contact angles against speed", &caption],
            [PlotAxis::log("speed, rpm"), PlotAxis::linear("contact angle, deg")],
            curves,
        ));
        Ok(())
    }
}
