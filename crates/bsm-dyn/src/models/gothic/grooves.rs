//! Gothic arches of the nut and the screw around one ball: arc centers, elastic approaches and
//! normal loads.
//!
//! Theory: `docs/theory/22-third-contact.md`, equations (AC1) to (AC4).

use bsm_kin::{Over, Scalar, Site};
use bsm_newton::{Convergence, EvalError, Options, Scales, Workspace, solve};

use crate::contact::Hertz;
use crate::models::ball::{
    ElasticPoint, Reason, SolveFailure, domain_error, equations, far_flank_play,
};

/// Number of contacts of a ball in two gothic arches. The order of the contacts is nut +, nut −,
/// screw +, screw −. The + flanks carry a positive axial load.
pub const FLANKS: usize = 4;

/// Fit of a ball between the gothic-arch grooves of nut and screw: axial play, radial gap and
/// oversize of the ball.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ArchFit<D = f64> {
    /// Axial play `$s$` of one nut with a ball of nominal diameter \[m\], not negative. Half of the
    /// play shifts the far flank of each groove, and the contact angle at first contact remains
    /// `$\beta_0$`. If the play is infinite, no ball touches a far flank.
    pub axial_play: D,
    /// Radial gap `$g$` between nut and screw grooves \[m\], which increases the contact angle at
    /// first contact.
    pub radial_gap: D,
    /// Excess `$\Delta r$` of the ball radius over the nominal radius \[m\].
    pub oversize: D,
}

/// Condition that determines the axial position of the nut.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AxialCondition<D = f64> {
    /// Axial force of the nut on the ball \[N\], not negative.
    Force(D),
    /// Axial displacement of the nut \[m\] from its middle position, which is midway between
    /// contact with the + flanks and contact with the − flanks.
    Displacement(D),
}

/// The gothic arches of the nut and the screw around a ball, in SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grooves<D = f64> {
    /// Distances `$l_0$` from the arc centers to the ball center at first contact, at the nut and
    /// the screw.
    pub offsets: [D; 2],
    /// Hertz stiffness of the contacts at the nut and the screw \[N/m^1.5\].
    pub stiffness: [D; 2],
    radial_gap: D,
    pub(super) oversize: D,
    /// Distances `$l_0\sin\beta_0$` between the arc center and the ball center along the binormal,
    /// at the nut and the screw.
    across: [D; 2],
    /// Distances `$y$` of the arc centers from the pitch circle.
    outward: [D; 2],
    /// Shift of an arc center toward the middle of the groove due to play, `$s\cos\alpha/4$`.
    shift: D,
    hertz: [Hertz<D>; 2],
    /// Sine and cosine of the lead angle.
    pub(super) lead: (D, D),
}

/// Maximum shift of an arc center due to play, divided by `$l_0\sin\beta_0$`. At this shift, the
/// arc of the far flank ends beside the ball and the gap is largest. Additional play does not
/// increase the gap.
const MAX_SHIFT_RATIO: f64 = 0.5;

impl ArchFit {
    /// Ball fit with infinite axial play, for which no ball touches a far flank.
    pub const WIDE: Self = Self { axial_play: f64::INFINITY, radial_gap: 0.0, oversize: 0.0 };
}

impl<D: Scalar> ArchFit<D> {
    /// Returns a copy of the play, gap and oversize as plain numbers, without derivatives.
    pub(crate) fn values(&self) -> ArchFit {
        ArchFit {
            axial_play: self.axial_play.re(),
            radial_gap: self.radial_gap.re(),
            oversize: self.oversize.re(),
        }
    }
}

/// Approach and normal at one contact for a given position of the ball.
#[derive(Debug, Clone, Copy)]
pub struct FlankApproach<D = f64> {
    /// Elastic approach \[m\]; a negative approach is a gap.
    pub approach: D,
    /// Distance from the ball center to the arc center \[m\].
    pub length: D,
    /// Unit vector from the ball center to the arc center, with components along the binormal and
    /// the principal normal.
    pub normal: [D; 2],
}

/// Number of coordinates that describe the positions \[m\]: two for the ball (along the binormal
/// and the principal normal) and one for the nut (along the binormal).
pub(super) const POSITIONS: usize = 3;

/// Returns the body (nut or screw) to which a flank belongs.
pub(super) fn site(flank: usize) -> Site {
    if flank < 2 { Site::Nut } else { Site::Screw }
}

impl<P: Scalar> Grooves<P> {
    /// Creates the gothic arches of a ball with nominal radius, without play (AC1).
    ///
    /// # Errors
    ///
    /// Returns [`Reason::CurvaturesNotHertzian`] if a contact ellipse is not longer across the
    /// groove than along it.
    pub fn without_play(at: &ElasticPoint<P>) -> Result<Self, Reason> {
        Ok(Self::with_hertz(at, at.hertz()?))
    }

    /// Returns the gothic arches with a different ball radius and with a radial gap. The contact
    /// stiffness remains unchanged.
    #[must_use]
    pub fn fitted(&self, radial_gap: P, oversize: P) -> Self {
        Self { radial_gap, oversize, ..*self }
    }

    fn with_hertz(at: &ElasticPoint<P>, hertz: [Hertz<P>; 2]) -> Self {
        let offsets = at.grooves().map(|groove| groove.offset(at.point.ball.radius));
        let (sin, cos) = at.point.contact_angle.sin_cos();
        let zero = P::from(0.0);
        Self {
            offsets,
            stiffness: hertz.map(|hertz| hertz.stiffness()),
            radial_gap: zero,
            oversize: zero,
            across: offsets.map(|l| l * sin),
            outward: offsets.map(|l| l * cos),
            shift: zero,
            hertz,
            lead: at.point.helix.lead_angle.sin_cos(),
        }
    }

    /// Creates the gothic arches of the nut and the screw around a ball with the given axial play,
    /// radial gap and oversize.
    ///
    /// # Errors
    ///
    /// Returns [`SolveFailure`] if the play is negative, or if the ball cannot touch the grooves at
    /// contact angles between 0 and 90 degrees.
    pub(super) fn of(at: &ElasticPoint<P>, fit: &ArchFit<P>) -> Result<Self, SolveFailure> {
        let ArchFit { axial_play, radial_gap, oversize } = *fit;
        // The curvatures are calculated for a ball of nominal diameter at first contact.
        let hertz = at.fitted(radial_gap, P::from(0.0)).hertz().map_err(SolveFailure::invalid)?;
        let nominal = Self::with_hertz(at, hertz);
        let [nut, screw] = nominal.across;
        let widest = if nut.re() < screw.re() { nut } else { screw } * MAX_SHIFT_RATIO;
        // e = l₀ sinβ₀ − s cosα/4                                         (AC2)
        let shift = axial_play * nominal.lead.1 * 0.25;
        let shift = if shift.re() < widest.re() { shift } else { widest };
        let grooves = Self { radial_gap, oversize, shift, ..nominal };
        if axial_play.re().is_nan() || axial_play.re() < 0.0 {
            return Err(invalid_input("axial play [m]", axial_play.re(), "must not be negative"));
        }
        let height = grooves.height().re();
        if !(height > 0.0 && grooves.center_distance().re() > height) {
            let requirement =
                "the ball must touch the grooves at contact angles between 0 and 90 degrees";
            return Err(invalid_input("radial groove gap [m]", radial_gap.re(), requirement));
        }
        Ok(grooves)
    }

    /// Returns the distance `$L$` \[m\] between the arc centers of the + flanks of the nut and the
    /// screw at first contact. The − flanks have the same distance.
    fn center_distance(&self) -> P {
        self.offsets[0] + self.offsets[1] - self.oversize * 2.0
    }

    /// Returns the distance \[m\] between the arc centers of the + flanks of the nut and the screw,
    /// measured along the principal normal.
    fn height(&self) -> P {
        self.outward[0] + self.outward[1] - self.radial_gap
    }

    /// Returns the distance `$e$` \[m\] between the middle of the groove and its arc center, at the
    /// nut (0) or the screw (1).
    #[inline(always)]
    fn center(&self, body: usize) -> P {
        self.across[body] - self.shift
    }

    /// Calculates the approach and the normal at one flank for a given position of the ball and the
    /// nut \[m\] (AC4).
    #[inline(always)]
    pub fn flank<D: Over<P>>(
        &self,
        flank: usize,
        [x_b, x_n, w_b]: &[D; POSITIONS],
    ) -> FlankApproach<D> {
        let (body, far) = (flank / 2, flank % 2 == 1);
        let (side, other) = ([1.0, -1.0][body], if far { -1.0 } else { 1.0 });
        // N± = (±e_A + w_b, y_A + w_n),  S± = (∓e_B, −y_B),  w_n = −g     (AC1)
        let c = [self.center(body) * (side * other), self.outward[body] * side];
        let moved = if body == 0 { [*w_b - *x_b, -*x_n - self.radial_gap] } else { [-*x_b, -*x_n] };
        let v = [moved[0] + c[0], moved[1] + c[1]];
        let length = (v[0].square() + v[1].square()).sqrt();
        // `by_play` is the part of |C₀|² − l₀² that results from the shift of the arc centers due
        // to play.
        let by_play = self.shift * (self.across[body] * 2.0 - self.shift);
        let by_motion =
            moved[0] * (moved[0] + c[0] * 2.0) + moved[1] * (moved[1] + c[1] * 2.0) - by_play;
        // δ = l − l₀ + Δr,  l − l₀ = (|C₀|² − l₀² + 2 C₀·D + D·D)/(l + l₀)  (AC4)
        let approach = by_motion / (length + self.offsets[body]) + self.oversize;
        let per_length = length.recip();
        FlankApproach { approach, length, normal: [v[0] * per_length, v[1] * per_length] }
    }

    /// Returns the normal load \[N\] for a given approach; the load is zero for a gap (H9).
    #[inline(always)]
    pub fn load<D: Over<P>>(&self, flank: usize, approach: D) -> D {
        if approach.re() <= 0.0 {
            return approach.constant(0.0);
        }
        approach * approach.sqrt() * self.stiffness[flank / 2]
    }

    /// Returns the semi-axes of the contact ellipse \[m\] for a positive approach. The calculation
    /// avoids the cube root of the load, whose slope is infinite at zero load.
    #[inline(always)]
    pub(super) fn semi_axes<D: Over<P>>(&self, flank: usize, approach: D) -> (D, D) {
        let Hertz { semi_axis, flatness, .. } = self.hertz[flank / 2];
        let a = approach.sqrt() * (semi_axis * self.stiffness[flank / 2].cbrt());
        (a, a * flatness)
    }
}

impl Grooves {
    /// Returns the distance \[m\] between the arc centers of the + flanks of the nut and the screw,
    /// measured along the binormal, for the middle position of the nut.
    fn width(&self) -> f64 {
        self.across[0] + self.across[1] - 2.0 * self.shift
    }

    /// Returns the displacement of the nut along the binormal at which the + flanks touch the ball
    /// \[m\]. The displacement is negative if the ball is already clamped in the middle position of
    /// the nut.
    pub(super) fn first_touch(&self) -> f64 {
        // w_t = √(L² − (y_A + y_B + w_n)²) − e_A − e_B                    (AC3)
        let (l, y) = (self.center_distance(), self.height());
        ((l - y) * (l + y)).sqrt() - self.width()
    }

    /// Returns the position of the ball and the nut \[m\] for given approaches \[m\] and contact
    /// angles \[rad\] at the + flanks.
    pub fn position_for(&self, approaches: [f64; 2], angles: [f64; 2]) -> [f64; POSITIONS] {
        let length = |i: usize| self.offsets[i] - self.oversize + approaches[i];
        let [(sin_a, _), (sin_b, cos_b)] = angles.map(f64::sin_cos);
        let x_b = length(1) * sin_b - self.center(1);
        let w_b = x_b + length(0) * sin_a - self.center(0);
        [x_b, length(1) * cos_b - self.outward[1], w_b]
    }

    /// Returns the axial force of the nut on a ball at rest \[N\].
    pub(super) fn axial_force(&self, positions: &[f64; POSITIONS]) -> f64 {
        self.normal_forces(positions).1[0] * self.lead.1
    }

    /// Returns the axial play \[m\] below which a ball with two contacts also touches a far flank,
    /// or zero if the ball does not touch a far flank even without play.
    ///
    /// * `approaches`, `angles`: approaches \[m\] and contact angles \[rad\] at the nut and the
    ///   screw.
    pub(super) fn threshold_play(&self, approaches: [f64; 2], angles: [f64; 2]) -> f64 {
        let play = |i: usize| {
            let offset = self.offsets[i] - self.oversize;
            let (length, angle) = (offset + approaches[i], angles[i].sin_cos());
            far_flank_play((self.across[i], offset), length, angle, self.lead.1)
        };
        play(0).max(play(1))
    }

    /// Returns the elastic approaches at the nut and the screw \[m\] under a normal load \[N\].
    pub(super) fn approaches(&self, load: f64) -> [f64; 2] {
        self.hertz.map(|hertz| hertz.approach(load))
    }

    /// Returns the cosine of the contact angle at first contact for a ball of nominal diameter.
    pub(super) fn cos_first_contact(&self) -> f64 {
        self.height() / (self.offsets[0] + self.offsets[1])
    }

    /// Returns the sum of all normal forces on the ball, and the sum of the normal forces of the
    /// nut \[N\].
    fn normal_forces<D: Over<f64>>(&self, positions: &[D; POSITIONS]) -> ([D; 2], [D; 2]) {
        let zero = D::from(0.0);
        let (mut ball, mut nut) = ([zero; 2], [zero; 2]);
        for flank in 0..FLANKS {
            let FlankApproach { approach, normal, .. } = self.flank(flank, positions);
            let load = self.load(flank, approach);
            for i in 0..2 {
                ball[i] += normal[i] * load;
                if flank < 2 {
                    nut[i] += normal[i] * load;
                }
            }
        }
        (ball, nut)
    }

    /// Returns the largest normal load \[N\] for given positions of the ball and the nut, together
    /// with the approach at this contact \[m\].
    pub(super) fn largest_load(&self, positions: &[f64; POSITIONS]) -> (f64, f64) {
        let loads = (0..FLANKS).map(|flank| {
            let approach = self.flank(flank, positions).approach;
            (self.load(flank, approach), approach)
        });
        loads.fold((0.0, 0.0), |most, one| if one.0 > most.0 { one } else { most })
    }

    /// Returns the positions of the ball and the nut at rest \[m\], that is, without friction and
    /// inertia.
    ///
    /// # Errors
    ///
    /// Returns [`Reason::Refused`] if no flank touches the ball or the flanks cannot carry the
    /// force.
    pub(super) fn at_rest(
        &self,
        condition: AxialCondition,
        newton: &mut Workspace<POSITIONS>,
    ) -> Result<[f64; POSITIONS], SolveFailure> {
        let stiffness = (self.hertz[0].compliance + self.hertz[1].compliance).powf(-1.5);
        let touch = self.first_touch();
        let (w, axial) = match condition {
            AxialCondition::Displacement(u) => (u * self.lead.1, 0.0),
            AxialCondition::Force(axial) => {
                if !(axial >= 0.0 && (axial > 0.0 || touch < 0.0)) {
                    return Err(not_pressed("axial force on the ball [N]", axial));
                }
                let sin = (1.0 - self.cos_first_contact().powi(2)).sqrt();
                let load = axial / (sin * self.lead.1);
                ((load / stiffness).cbrt().powi(2) / sin + touch.max(0.0), axial)
            }
        };
        // The ball lies on the line between the arc centers of the more heavily loaded pair of
        // flanks.
        let sign = if w < 0.0 { -1.0 } else { 1.0 };
        let (g_b, g_n) = (sign * self.width() + w, self.height());
        let length = g_b.hypot(g_n);
        let both = length - self.center_distance();
        if both <= 0.0 {
            return Err(not_pressed("axial displacement of the nut [m]", w / self.lead.1));
        }
        let share =
            self.hertz[1].compliance / (self.hertz[0].compliance + self.hertz[1].compliance);
        let from_screw = self.offsets[1] - self.oversize + share * both;
        let y = [
            -sign * self.center(1) + g_b / length * from_screw,
            -self.outward[1] + g_n / length * from_screw,
            w,
        ];
        let (load, approach) = self.largest_load(&y);
        let units = (load.max(axial), approach);
        self.equilibrium_position(condition, &FixedForces::default(), (&y, units), newton)
    }

    /// Returns the positions of the ball and the nut \[m\] at which the normal loads and the given
    /// fixed forces are in equilibrium.
    ///
    /// * `near`: starting values of the positions \[m\].
    /// * `units`: units of force \[N\] and length \[m\].
    pub(super) fn equilibrium_position(
        &self,
        condition: AxialCondition,
        forces: &FixedForces,
        (near, (force, length)): (&[f64; POSITIONS], (f64, f64)),
        newton: &mut Workspace<POSITIONS>,
    ) -> Result<[f64; POSITIONS], SolveFailure> {
        let balance = ForceBalance { grooves: self, condition, forces, force, length };
        let mut y = near.map(|y| y / length);
        let scales = Scales { x: &[1.0; POSITIONS], f: &[1.0; POSITIONS] };
        let convergence =
            Convergence { residual_tol: 1e-9, max_steps: 100, ..Convergence::default() };
        let options = Options { convergence, ..Options::default() };
        let report = solve(&balance, &mut y, &scales, &options, newton).report;
        if !report.converged() {
            return Err(SolveFailure::not_converged(Reason::from(report)));
        }
        Ok(y.map(|y| y * length))
    }
}

fn invalid_input(quantity: &'static str, value: f64, requirement: &'static str) -> SolveFailure {
    SolveFailure::invalid(Reason::Refused { error: EvalError { quantity, value, requirement } })
}

fn not_pressed(quantity: &'static str, value: f64) -> SolveFailure {
    domain_error(EvalError {
        quantity,
        value,
        requirement: "must press the ball against the loaded flanks of the grooves",
    })
}

/// Forces that do not depend on the position of the ball \[N\].
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct FixedForces {
    /// Forces on the ball along the binormal and along the principal normal \[N\].
    pub(super) ball: [f64; 2],
    /// Axial force of the nut on the ball \[N\], in addition to the normal loads.
    pub(super) of_nut: f64,
}

/// Force balance of a ball under normal loads and fixed forces. Lengths are divided by a reference
/// approach.
struct ForceBalance<'a> {
    grooves: &'a Grooves,
    condition: AxialCondition,
    forces: &'a FixedForces,
    /// Unit of force \[N\].
    force: f64,
    /// Unit of length \[m\].
    length: f64,
}

impl ForceBalance<'_> {
    #[expect(
        clippy::unnecessary_wraps,
        reason = "the macro `equations!` requires this return type"
    )]
    fn residual<D: Over<f64>>(&self, y: &[D; POSITIONS]) -> Result<[D; POSITIONS], EvalError> {
        let (ball, nut) = self.grooves.normal_forces(&y.map(|y| y * self.length));
        let position = match self.condition {
            AxialCondition::Force(axial) => {
                (nut[0] * self.grooves.lead.1 + (self.forces.of_nut - axial)) * self.force.recip()
            }
            AxialCondition::Displacement(u) => y[2] - u * self.grooves.lead.1 / self.length,
        };
        let [along_b, along_n] =
            [0, 1].map(|i| (ball[i] + self.forces.ball[i]) * self.force.recip());
        Ok([along_b, along_n, position])
    }
}

equations!(
    ForceBalance<'_>,
    POSITIONS,
    ForceBalance::residual,
    ["force along b", "force along n", "position of the nut"]
);
