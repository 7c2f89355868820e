//! Nut and screw as elastic bodies. Their deformation changes the ball loads.

use bsm_design::NutBody;
use bsm_nut::{BallNut, Bar, Ring};

use crate::vocabulary::entries::{End, Named};
use crate::vocabulary::error::invalid_input;
use crate::vocabulary::units::MM;
use crate::{Case, CaseError, InputKey};

/// Adds the elasticity of the bodies to a nut. Nut and screw are treated as bars, and the nut is
/// also treated as a ring.
pub(super) fn bodies(case: &Case, mut nut: BallNut, body: &NutBody) -> Result<BallNut, CaseError> {
    use InputKey as K;
    let entries = &case.entries;
    let ends = ends(&nut);
    let made = nut.nut_stiffness(body.outer);
    let keys = [K::nut_EA_N, K::nut_anchor_z_mm];
    nut.nut_bar = bar(case, (keys, "nut_anchor", entries.nut_anchor), made, ends)?;
    let keys = [K::screw_EA_N, K::screw_anchor_z_mm];
    let twists = entries.screw_torsion == Some(true);
    if twists && case.screw_EA_N.is_some() {
        return Err(CaseError::given_twice(["screw_torsion", K::screw_EA_N.name()]));
    }
    if twists && entries.screw_anchor.is_none() && case.screw_anchor_z_mm.is_none() {
        let what = "needs the position where force and torque leave the screw: screw_anchor or screw_anchor_z_mm";
        return Err(invalid_input("screw_torsion", what));
    }
    let made = nut.screw_stiffness(twists);
    nut.screw_bar = bar(case, (keys, "screw_anchor", entries.screw_anchor), made, ends)?;
    let youngs_modulus = nut.material.raceways.youngs_modulus;
    nut.ring = (entries.ring_expansion == Some(true)).then(|| {
        let [_, inner] = nut.groove_diameters();
        Ring { outer_diameter: body.outer, inner_diameter: inner, youngs_modulus }
    });
    Ok(nut)
}

/// Returns the axial positions of the first and the last ball \[m\].
fn ends(nut: &BallNut) -> [f64; 2] {
    let places = nut.positions();
    let z = || places.iter().map(|place| place.z);
    [z().fold(f64::INFINITY, f64::min), z().fold(f64::NEG_INFINITY, f64::max)]
}

/// Returns the elastic bar of a body, or `None` if no anchor is given.
///
/// * `made`: axial stiffness EA, calculated from the diameters \[N\].
fn bar(
    case: &Case,
    ([stiffness, place], word, end): ([InputKey; 2], &'static str, Option<Named<End>>),
    made: f64,
    ends: [f64; 2],
) -> Result<Option<Bar>, CaseError> {
    let at = |end: End| if end == End::Low { ends[0] } else { ends[1] };
    let anchor = match (end, case[place]) {
        (Some(_), Some(_)) => return Err(CaseError::given_twice([word, place.name()])),
        (Some(Named(end)), None) => at(end),
        (None, Some(z)) => z * MM,
        (None, None) if case[stiffness].is_some() => {
            let what = format!(
                "needs the position at which the force is transmitted: {word} or {}",
                place.name()
            );
            return Err(invalid_input(stiffness.name(), what));
        }
        (None, None) => return Ok(None),
    };
    Ok(Some(Bar { stiffness: case[stiffness].unwrap_or(made), anchor }))
}
