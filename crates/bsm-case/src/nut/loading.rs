//! Loads, what holds a nut, and its preload.

use std::array::from_fn;

use bsm_nut::{BallNut, Flanks, Freedom, Preload, Support};

use super::problem::{bad, twice};
use super::words::{Guidance, PreloadWay};
use crate::units::UM;
use crate::{CaseError, InputKey, Scene};

/// Freedoms across the axis: load, displacement and spring, and what their units are in SI.
const ACROSS: [([InputKey; 3], [f64; 3]); 4] = {
    use InputKey as K;
    const FORCE: [f64; 3] = [1.0, UM, 1.0 / UM];
    const MOMENT: [f64; 3] = [1.0, 1e-6, 1e3];
    [
        ([K::radial_load_x_N, K::radial_x_um, K::guide_x_N_um], FORCE),
        ([K::radial_load_y_N, K::radial_y_um, K::guide_y_N_um], FORCE),
        ([K::moment_x_Nm, K::tilt_x_urad, K::guide_tilt_x_Nm_mrad], MOMENT),
        ([K::moment_y_Nm, K::tilt_y_urad, K::guide_tilt_y_Nm_mrad], MOMENT),
    ]
};

/// How large a preload is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Amount {
    /// Axial force \[N\].
    Force(f64),
    /// Offset of the bodies, or excess of the diameter of the balls \[m\].
    Displacement(f64),
}

impl From<PreloadWay> for Preload {
    fn from(way: PreloadWay) -> Self {
        match way {
            PreloadWay::Pair => Self::Offset,
            PreloadWay::Oversize => Self::Oversize,
        }
    }
}

/// True if an amount of preload between two bodies is given.
pub(super) fn is_preloaded(scene: &Scene) -> bool {
    scene.preload_N.is_some() || scene.preload_offset_um.is_some()
}

/// What preloads the nut, and how much.
pub(super) fn preload(
    scene: &Scene,
    nut: &BallNut,
    way: Preload,
) -> Result<Option<(Preload, Amount)>, CaseError> {
    use InputKey as K;
    let amounts = [K::preload_N, K::preload_offset_um, K::ball_oversize_um];
    let given: Vec<_> = amounts.into_iter().filter(|key| scene[*key].is_some()).collect();
    let key = match given[..] {
        [] => return Ok(None),
        [key] => key,
        [one, other, ..] => return Err(twice(one.name(), other.name())),
    };
    let value = scene[key].unwrap_or(f64::NAN);
    let by = if key == K::ball_oversize_um { Preload::Oversize } else { way };
    if key == K::preload_offset_um && way == Preload::Oversize {
        return Err(bad(
            key.name(),
            "is of a pair of nuts; balls that are too large have ball_oversize_um",
        ));
    }
    let bodies = 1 + nut.circuits.iter().map(|circuit| circuit.body).max().unwrap_or(0);
    if by == Preload::Offset && bodies != 2 {
        let what = format!("a pair has two bodies, but the circuits have {bodies}");
        return Err(bad(key.name(), what));
    }
    let both = nut.circuits.iter().all(|circuit| circuit.flanks == Flanks::Both);
    if by == Preload::Oversize && key == K::preload_N && !both {
        let what = "balls that are too large press both flanks, but a circuit has one flank only";
        return Err(bad(key.name(), what));
    }
    let amount =
        if key == K::preload_N { Amount::Force(value) } else { Amount::Displacement(value * UM) };
    Ok(Some((by, amount)))
}

/// Loads and what holds the nut.
pub(super) fn support(scene: &Scene) -> Result<Support, CaseError> {
    let free = scene.nut.nut_guidance == Some(Guidance::Free);
    let mut support = Support::guided(scene.axial_load_N.unwrap_or(0.0));
    for (freedom, (keys, units)) in support.0[1..].iter_mut().zip(ACROSS) {
        let given: [Option<f64>; 3] = from_fn(|i| Some(scene[keys[i]]? * units[i]));
        *freedom = match given {
            [_, Some(_), Some(_)] => return Err(twice(keys[1].name(), keys[2].name())),
            [Some(_), Some(_), _] => return Err(twice(keys[0].name(), keys[1].name())),
            [load, None, Some(stiffness)] => {
                Freedom::Sprung { stiffness, load: load.unwrap_or(0.0) }
            }
            [None, Some(displacement), None] => Freedom::Held(displacement),
            [load, None, None] if free => Freedom::Loaded(load.unwrap_or(0.0)),
            [Some(load), None, None] if load != 0.0 => {
                let what = format!(
                    "acts on what the guides hold; set nut_guidance to free, or give {}",
                    keys[2].name()
                );
                return Err(bad(keys[0].name(), what));
            }
            [_, None, None] => Freedom::Held(0.0),
        };
    }
    Ok(support)
}
