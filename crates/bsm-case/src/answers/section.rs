//! Cross section of the nut and screw grooves for a drawing.

use bsm_design::{Profile, Thread};
use bsm_dyn::hertz::Hertz;
use serde_json::{Value, json};

use crate::case::rated_nut;
use crate::vocabulary::units::{DEG, MM};
use crate::{Case, CaseError, InputKey, OutputName, Record, output};

/// Cross section of the nut and screw grooves. The origin is the ball center. The first coordinate
/// is the axial position, and the second coordinate increases with the distance from the screw axis
/// \[mm\].
#[derive(Debug, Clone, PartialEq)]
pub struct GrooveSection {
    /// Radius of the ball \[mm\].
    pub ball_radius: f64,
    /// Contact angle without load \[rad\].
    pub contact_angle: f64,
    /// Outline of the screw: groove and lands.
    pub screw: Vec<(f64, f64)>,
    /// Outline of the nut: groove and lands.
    pub nut: Vec<(f64, f64)>,
    /// Angles around the ball center at which the flanks of nut and screw begin and end \[deg\].
    pub flanks: [[f64; 2]; 2],
    /// Radii of the groove arcs of nut and screw \[mm\].
    pub radii: [f64; 2],
    /// Distances from the ball center to the centers of the groove arcs \[mm\], in the axial
    /// direction and in the radial direction away from the groove.
    pub centers: [(f64, f64); 2],
}

impl GrooveSection {
    /// Calculates the cross section of the grooves that a case describes. The number of balls and
    /// turns is not required.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError`] if an input is missing or a value violates a rule.
    pub fn of(case: &Case) -> Result<Self, CaseError> {
        /// Number of chords that approximate a flank.
        const STEPS: u32 = 40;
        case.check()?;
        let mut one = case.clone();
        for key in [InputKey::loaded_balls_per_turn, InputKey::loaded_turns] {
            one[key] = one[key].or(Some(1.0));
        }
        let nut = rated_nut::nut_for(&one, || "for the cross section of the grooves".to_owned())?;
        let thread = rated_nut::thread(case, &nut)?;
        // If the pitch is large, the lands are drawn only up to one ball diameter from the center.
        let half = (0.5 * nut.pitch()).min(nut.ball_diameter);
        let line = |profile: &Profile, up: f64| {
            let mut flank = profile.flank(STEPS);
            // The outline of the groove continues along the land.
            let land = flank.last().map_or(0.0, |(_, depth)| *depth);
            flank.push((half, land));
            let at = |side: f64| move |(x, depth): &(f64, f64)| (side * x / MM, up * depth / MM);
            flank.iter().rev().map(at(-1.0)).chain(flank.iter().map(at(1.0))).collect()
        };
        let Thread { nut: of_nut, screw: of_screw, .. } = &thread;
        Ok(Self {
            ball_radius: 0.5 * nut.ball_diameter / MM,
            contact_angle: nut.contact_angle,
            screw: line(of_screw, -1.0),
            nut: line(of_nut, 1.0),
            flanks: [of_nut, of_screw].map(|profile| profile.ends().map(|angle| angle / DEG)),
            radii: [of_nut, of_screw].map(|profile| profile.radius / MM),
            centers: [of_nut, of_screw].map(|profile| (profile.offset / MM, profile.height / MM)),
        })
    }

    /// Returns warnings about contact ellipses that extend beyond the ends of their flanks.
    pub fn warnings(&self, record: &Record) -> Vec<String> {
        let warning = |(place, (member, angle, half)): (usize, (&str, OutputName, OutputName))| {
            let (angle, half) = (record.number(angle)?, record.number(half)?);
            beyond_the_flank(member, self.flanks[place], angle, half / self.radii[place] / DEG)
        };
        let contacts = [
            ("nut", output!(nut_contact_angle_deg), output!(nut_ellipse_a_mm)),
            ("screw", output!(screw_contact_angle_deg), output!(screw_ellipse_a_mm)),
        ];
        contacts.into_iter().enumerate().filter_map(warning).collect()
    }

    /// Converts the section to a JSON object.
    pub fn to_json(&self) -> Value {
        json!({
            "ball_radius_mm": self.ball_radius,
            "contact_angle_deg": self.contact_angle / DEG,
            "nut": self.nut,
            "screw": self.screw,
            "nut_flank_deg": self.flanks[0],
            "screw_flank_deg": self.flanks[1],
        })
    }
}

/// Returns warnings about contacts at nut and screw whose ellipses extend beyond their flanks.
///
/// * `hertz`: Hertzian contacts at nut and screw.
/// * `contacts`: load \[N\] and contact angle \[rad\] at nut and screw.
pub(crate) fn beyond_the_flanks(
    thread: &Thread,
    hertz: &[Hertz; 2],
    contacts: [Option<(f64, f64)>; 2],
) -> Vec<String> {
    let members = [("nut", &thread.nut), ("screw", &thread.screw)];
    let mut warnings = Vec::new();
    for (((member, profile), hertz), contact) in members.into_iter().zip(hertz).zip(contacts) {
        let Some((load, angle)) = contact else { continue };
        let half = hertz.semi_axes(load).0 / profile.radius;
        let flank = profile.ends().map(|end| end / DEG);
        warnings.extend(beyond_the_flank(member, flank, angle / DEG, half / DEG));
    }
    warnings
}

/// Returns a warning if a contact ellipse extends beyond the ends of its flank, where Hertz's
/// theory does not apply.
///
/// * `member`: `nut` or `screw`.
/// * `flank`: angles at which the flank begins and ends \[deg\].
/// * `angle`: contact angle \[deg\].
/// * `half`: semi-axis of the ellipse across the groove, expressed as an angle around the center of
///   the groove arc \[deg\].
pub(crate) fn beyond_the_flank(
    member: &str,
    [meet, edge]: [f64; 2],
    angle: f64,
    half: f64,
) -> Option<String> {
    let [from, to] = [angle - half, angle + half];
    let what = if to > edge {
        format!("the land begins at {edge:.1} deg and truncates the ellipse")
    } else if from < meet {
        format!("the two arcs meet at {meet:.1} deg, so the ball also touches the other arc")
    } else {
        return None;
    };
    Some(format!(
        "The contact ellipse covers {from:.1} to {to:.1} deg of the groove profile of the {member}, measured from the radial direction: {what}, \
         and Hertz's theory does not hold there. Reduce the load, or use more or larger balls."
    ))
}
