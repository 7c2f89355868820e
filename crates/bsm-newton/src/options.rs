//! Stopping rules, damping and scales.

/// Stopping rules and damping. Every number is dimensionless.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// A solution when `$\lVert D_F F(x) \rVert_2 \le$` this (N1). Default `1e-10`.
    pub residual_tol: f64,
    /// Once below `residual_tol`, go on with full steps down to this residual as long as each
    /// step at least halves it (N2). Default `1e-10`, which means stop at once.
    pub residual_goal: f64,
    /// Halvings of the step before giving up (N6). Default `20`.
    pub max_halvings: u32,
    /// Newton steps before giving up. Default `50`.
    pub max_steps: usize,
    /// When the Jacobian is evaluated. Default [`JacobianUpdate::EveryStep`].
    pub jacobian: JacobianUpdate,
}

/// When the Jacobian is evaluated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum JacobianUpdate {
    /// At every accepted point: Newton's method.
    EveryStep,
    /// With the residual at every trial, for models whose trials are hardly ever rejected, and which compute both at once.
    EveryTrial {
        /// From a residual below this on, trials have no Jacobian of their own, and the steps keep the last factors as
        /// long as each lowers the residual to a tenth: the chord method. Zero: never.
        chord_below: f64,
    },
}

impl Default for Options {
    fn default() -> Self {
        Self {
            residual_tol: 1e-10,
            residual_goal: 1e-10,
            max_halvings: 20,
            max_steps: 50,
            jacobian: JacobianUpdate::EveryStep,
        }
    }
}

/// Diagonals of the scaling matrices `$D_x$` and `$D_F$`.
///
/// `x[j]` is one over the typical size of unknown `j`, `f[i]` one over the typical size of
/// equation `i`, so that unknowns and equations of different units weigh alike.
#[derive(Debug, Clone, PartialEq)]
pub struct Scales<'a, V> {
    /// Diagonal of `$D_x$`, positive.
    pub x: &'a V,
    /// Diagonal of `$D_F$`, positive.
    pub f: &'a V,
}
