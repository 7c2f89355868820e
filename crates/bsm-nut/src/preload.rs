//! Preload of a nut: required offset, remaining preload under load, and limit load.
//!
//! Theory: `docs/theory/16-nut.md`, equations (U18) to (U20).

use std::iter::successors;

use bsm_newton::Bracket;

use crate::{BallNut, Equilibrium, NutError, Support};

/// Method by which a nut is preloaded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PreloadKind {
    /// The nut consists of two bodies with an axial offset between them, body 0 along +z and body 1
    /// along −z. A positive offset pulls the bodies together (X arrangement), and a negative offset
    /// pushes them apart (O arrangement).
    Offset,
    /// The nut has oversize balls, which press against both flanks of the grooves.
    Oversize,
}

impl Equilibrium {
    /// Returns the remaining preload \[N\] (U20), which is the smaller of the forces on the two nut
    /// bodies. For oversize balls, it is the smaller of the forces on the two flanks.
    pub fn preload(&self, nut: &BallNut, by: PreloadKind) -> f64 {
        match by {
            PreloadKind::Offset => {
                self.bodies.iter().map(|force| force.abs()).fold(f64::MAX, f64::min)
            }
            PreloadKind::Oversize => {
                let inclined = |contact: usize| {
                    let cos = nut.helix.lead_angle.cos();
                    self.balls
                        .iter()
                        .map(|b| b.loads[contact] * b.angles[contact].sin() * cos)
                        .sum()
                };
                // F_p = Σ Q sinβ cosα over one diagonal                   (U20)
                f64::min(inclined(0), inclined(1))
            }
        }
    }
}

impl BallNut {
    /// Returns the nut with a preload that results from a displacement \[m\] (U18). The
    /// displacement is the offset between the bodies, or the excess of the ball diameter over the
    /// nominal diameter.
    #[must_use]
    pub fn preloaded(&self, by: PreloadKind, displacement: f64) -> Self {
        let mut nut = self.clone();
        match by {
            PreloadKind::Offset => {
                for circuit in &mut nut.circuits {
                    // o = ±O/2                                            (U18)
                    let half = 0.5 * displacement;
                    circuit.offset += if circuit.body == 0 { half } else { -half };
                }
            }
            PreloadKind::Oversize => nut.errors.oversize += 0.5 * displacement,
        }
        nut
    }

    /// Returns the displacement \[m\] required for a given preload \[N\] without external load
    /// (U19).
    ///
    /// * `force`: preload \[N\], which has the same sign as the displacement: negative if the
    ///   bodies are pushed apart.
    ///
    /// # Errors
    /// Returns [`NutError::NoPreload`] if the balls cannot produce the requested preload, or any
    /// error that [`solve`](Self::solve) returns.
    pub fn preload_displacement(
        &self,
        by: PreloadKind,
        force: f64,
        support: &Support,
    ) -> Result<f64, NutError> {
        let support = support.with_axial(0.0);
        let (sign, force) = (force.signum(), force.abs());
        let no_preload = || NutError::NoPreload { force };
        let reached = |displacement: f64| -> Result<f64, NutError> {
            let nut = self.preloaded(by, sign * displacement);
            Ok(nut.solve(&support)?.preload(&nut, by))
        };
        // The search starts at the displacement of a guided pair of rigid nuts with equal load
        // sharing, and doubles this displacement until the preload is sufficient.
        let high = 2.0 * self.equal(2.0 * force)?.displacement;
        let places = successors(Some(high), |x| Some(2.0 * x).filter(|x| *x <= self.ball.radius));
        let excess = |x: f64| reached(x).map(|reached| reached - force);
        let bracket =
            Bracket::first_sign_change((0.0, -force), places, excess)?.ok_or_else(no_preload)?;
        let found = Bracket { x_tol: 1e-13, ..bracket }.try_root(excess)?;
        found.root().map(|root| sign * root.x).ok_or_else(no_preload)
    }

    /// Returns the limit load \[N\], which is the axial load at which the last ball of one body or
    /// of one flank loses its load (U20). The limit load has the same sign as `way`.
    ///
    /// # Errors
    /// Returns [`NutError::NoPreload`] if the nut has no preload, or any error that
    /// [`solve`](Self::solve) returns.
    pub fn limit_load(
        &self,
        by: PreloadKind,
        support: &Support,
        way: f64,
    ) -> Result<f64, NutError> {
        let remaining = |load: f64| -> Result<f64, NutError> {
            Ok(self.solve(&support.with_axial(load))?.preload(self, by))
        };
        let preload = remaining(0.0)?;
        let no_preload = || NutError::NoPreload { force: preload };
        if preload <= 0.0 {
            return Err(no_preload());
        }
        // The limit load is 2√2 to 2.91 times the preload, unless elastic bodies or manufacturing
        // errors make the ball loads unequal.
        let most = 1e3 * preload;
        let places =
            successors(Some(3.0 * preload), |load| Some(2.0 * load).filter(|x| *x <= most));
        // Near the limit load F_lim, the preload that remains under a load F is proportional to
        // (F_lim − F)^(3/2). This preload is so small that only its sign is reliable.
        let rest = |load: f64| {
            remaining(way.signum() * load).map(|rest| if rest > 0.0 { 1.0 } else { -1.0 })
        };
        let bracket =
            Bracket::first_sign_change((0.0, 1.0), places, rest)?.ok_or_else(no_preload)?;
        let bracket = Bracket { x_tol: 1e-9, ..bracket };
        let found = bracket.try_root(rest)?;
        let end = found.root().map(|root| root.ends[1]);
        end.map(|load| way.signum() * load).ok_or_else(no_preload)
    }
}
