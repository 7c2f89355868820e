//! Loads, constraints and preload of a nut.

use std::array::from_fn;

use bsm_design::PreloadMethod;
use bsm_nut::{BallNut, Flanks, Freedom, PreloadKind, Support};

use crate::vocabulary::entries::{Arrangement, Guidance, Named};
use crate::vocabulary::error::invalid_input;
use crate::vocabulary::units::UM;
use crate::{Case, CaseError, InputKey};

/// Transverse degrees of freedom of the nut. For each degree of freedom, the table lists the inputs
/// for load, displacement and spring stiffness, and the factors that convert these inputs to SI
/// units.
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

/// Magnitude of a preload, which is either a force or a displacement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Amount {
    /// Axial force \[N\]. It is negative if the nut bodies are pushed apart.
    Force(f64),
    /// Offset between the nut bodies, or oversize of the ball diameter \[m\].
    Displacement(f64),
}

/// Returns the kind of preload that a preload method produces.
pub(super) fn preload_of_bodies(Named(method): Named<PreloadMethod>) -> PreloadKind {
    match method {
        PreloadMethod::DoubleNut | PreloadMethod::Offset => PreloadKind::Offset,
        PreloadMethod::Oversize => PreloadKind::Oversize,
    }
}

/// Returns true if a preload or an offset between two nut bodies is given.
pub(super) fn is_preloaded(case: &Case) -> bool {
    case.preload_N.is_some() || case.preload_offset_um.is_some()
}

/// Default arrangement of a nut pair, used if neither an input nor the flanks of the circuits
/// determine the arrangement.
pub(super) const DEFAULT_ARRANGEMENT: Arrangement = Arrangement::O;

/// Returns the arrangement of a nut pair, either given by name or derived from the sign of the
/// offset.
pub(super) fn arrangement(case: &Case) -> Result<Option<Arrangement>, CaseError> {
    let offset = case.preload_offset_um.filter(|offset| *offset != 0.0);
    let by_offset = offset.map(|o| if o > 0.0 { Arrangement::X } else { Arrangement::O });
    match (case.entries.preload_arrangement.map(|Named(own)| own), by_offset) {
        (Some(word), Some(sign)) if word != sign => Err(invalid_input(
            "preload_arrangement",
            "contradicts preload_offset_um, which is above 0 for X and below 0 for O",
        )),
        (word, sign) => Ok(word.or(sign)),
    }
}

/// Returns the arrangement of a nut pair. The arrangement is determined by the loaded flanks of the
/// circuits, unless every circuit can carry load on both flanks.
fn arrangement_of(nut: &BallNut, given: Option<Arrangement>) -> Result<Arrangement, CaseError> {
    let one_flank = nut.circuits.iter().find(|circuit| circuit.flanks != Flanks::Both);
    let by_flanks = one_flank.map(|circuit| {
        let pushed = (circuit.body == 0) == (circuit.flanks == Flanks::Plus);
        if pushed { Arrangement::X } else { Arrangement::O }
    });
    match (given, by_flanks) {
        (Some(word), Some(flanks)) if word != flanks => Err(invalid_input(
            "preload_arrangement",
            "contradicts the flanks that are given in circuits",
        )),
        (word, flanks) => Ok(word.or(flanks).unwrap_or(DEFAULT_ARRANGEMENT)),
    }
}

/// Returns the kind and the amount of the preload.
pub(super) fn preload(
    case: &Case,
    nut: &BallNut,
    way: PreloadKind,
) -> Result<Option<(PreloadKind, Amount)>, CaseError> {
    use InputKey as K;
    let amounts = [K::preload_N, K::preload_offset_um, K::ball_oversize_um];
    let given: Vec<_> = amounts.into_iter().filter(|key| case[*key].is_some()).collect();
    let key = match given[..] {
        [] => return Ok(None),
        [key] => key,
        [one, other, ..] => return Err(CaseError::given_twice([one.name(), other.name()])),
    };
    let value = case[key].unwrap_or(f64::NAN);
    let by = if key == K::ball_oversize_um { PreloadKind::Oversize } else { way };
    if key == K::preload_offset_um && way == PreloadKind::Oversize {
        return Err(invalid_input(
            key.name(),
            "applies to a pair of nuts; for oversize balls, give ball_oversize_um",
        ));
    }
    let bodies = 1 + nut.circuits.iter().map(|circuit| circuit.body).max().unwrap_or(0);
    if by == PreloadKind::Offset && bodies != 2 {
        let what = format!("needs a pair with two nut bodies, but the circuits have {bodies}");
        return Err(invalid_input(key.name(), what));
    }
    let both = nut.circuits.iter().all(|circuit| circuit.flanks == Flanks::Both);
    if by == PreloadKind::Oversize && key == K::preload_N && !both {
        let what = "needs two flanks in every circuit for oversize balls, but a circuit has only one flank";
        return Err(invalid_input(key.name(), what));
    }
    if by == PreloadKind::Oversize && case.entries.preload_arrangement.is_some() {
        return Err(invalid_input("preload_arrangement", "applies only to a pair of nuts"));
    }
    let amount = match (key, by) {
        (K::preload_N, PreloadKind::Oversize) => Amount::Force(value),
        (K::preload_N, PreloadKind::Offset) => match arrangement_of(nut, arrangement(case)?)? {
            Arrangement::X => Amount::Force(value),
            Arrangement::O => Amount::Force(-value),
        },
        _ => Amount::Displacement(value * UM),
    };
    Ok(Some((by, amount)))
}

/// Returns the loads and the constraints of the nut.
pub(super) fn support(case: &Case) -> Result<Support, CaseError> {
    let free = case.entries.nut_guidance == Some(Named(Guidance::Free));
    let mut support = Support::guided(case.axial_load_N.unwrap_or(0.0));
    for (freedom, (keys, units)) in support.0[1..].iter_mut().zip(ACROSS) {
        let given: [Option<f64>; 3] = from_fn(|i| Some(case[keys[i]]? * units[i]));
        *freedom = match given {
            [_, Some(_), Some(_)] => {
                return Err(CaseError::given_twice([keys[1].name(), keys[2].name()]));
            }
            [Some(_), Some(_), _] => {
                return Err(CaseError::given_twice([keys[0].name(), keys[1].name()]));
            }
            [load, None, Some(stiffness)] => {
                Freedom::Sprung { stiffness, load: load.unwrap_or(0.0) }
            }
            [None, Some(displacement), None] => Freedom::Held(displacement),
            [load, None, None] if free => Freedom::Loaded(load.unwrap_or(0.0)),
            [Some(load), None, None] if load != 0.0 => {
                let what = format!(
                    "has no effect, because the guides prevent the displacement; set nut_guidance to free, or give {}",
                    keys[2].name()
                );
                return Err(invalid_input(keys[0].name(), what));
            }
            [_, None, None] => Freedom::Held(0.0),
        };
    }
    Ok(support)
}
