//! Gothic arches of nut and screw around one ball: arc centers, approaches and loads.
//!
//! Theory: `docs/theory/22-third-contact.md`, equations (AC1) to (AC4).

use bsm_kin::{Scalar, Site};
use bsm_newton::{Convergence, EvalError, Options, Scales, Workspace, solve};

use crate::contact::Hertz;
use crate::models::ball::{
    ContactState, ElasticPoint, NoAnswer, Reason, SteadyState, domain_error, equations,
    far_flank_play,
};

/// Nut +, nut −, screw +, screw −: the contacts of a ball in two gothic arches. The flanks + carry a positive axial load.
pub const FLANKS: usize = 4;

/// How a ball fits into its gothic arches.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ArchFit<D = f64> {
    /// Axial play `$s$` of one nut at the nominal ball diameter \[m\], not negative, infinite if no ball is to touch a
    /// far flank. Half of it moves the far flank of each groove; the contact angle at first touch stays `$\beta_0$`.
    pub axial_play: D,
    /// Radial gap `$g$` between nut and screw grooves \[m\]. It increases the contact angle at first touch.
    pub radial_gap: D,
    /// Excess `$\Delta r$` of the ball radius \[m\].
    pub oversize: D,
}

/// What determines the axial position of the nut.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AxialCondition {
    /// Axial force of the nut on the ball \[N\], not negative.
    Force(f64),
    /// Axial displacement of the nut from the position in which both diagonals have the same distance \[m\].
    Displacement(f64),
}

/// The two gothic arches around a ball \[SI\], with the ball radius as it was made.
#[derive(Debug, Clone, Copy)]
pub(super) struct Grooves {
    /// Offsets `$l_0$` of the arc centers at nut and screw.
    pub(super) offsets: [f64; 2],
    /// `$l_0\sin\beta_0$` at nut and screw.
    across: [f64; 2],
    /// Distances `$y$` of the arc centers from the pitch circle.
    outward: [f64; 2],
    /// By how much play moves an arc center towards the middle, `$s\cos\alpha/4$`.
    shift: f64,
    radial_gap: f64,
    pub(super) oversize: f64,
    pub(super) hertz: [Hertz; 2],
    pub(super) cos_lead: f64,
}

/// Largest shift of an arc center by play over `$l_0\sin\beta_0$`. The arc of the far flank then ends beside the ball,
/// and its gap is the largest; more play only moves the end away.
const WIDE: f64 = 0.5;

impl ArchFit {
    /// So much play that no ball touches a far flank.
    pub const WIDE: Self = Self { axial_play: f64::INFINITY, radial_gap: 0.0, oversize: 0.0 };
}

/// A contact at a position of the ball.
#[derive(Debug, Clone, Copy)]
pub(super) struct FlankApproach<D> {
    /// Negative where there is a gap \[m\].
    pub(super) approach: D,
    /// Unit normal into the ball along the binormal and along the principal normal.
    pub(super) normal: [D; 2],
}

/// Position of the ball along the binormal and the principal normal, and of the nut along the binormal \[m\].
pub(super) const PLACE: usize = 3;

/// Body of a contact.
pub(super) fn site(flank: usize) -> Site {
    if flank < 2 { Site::Nut } else { Site::Screw }
}

impl Grooves {
    pub(super) fn of(at: &ElasticPoint, fit: &ArchFit) -> Result<Self, NoAnswer> {
        let hertz = at.hertz().map_err(NoAnswer::invalid)?;
        let offsets = at.grooves().map(|groove| groove.offset(at.point.ball.radius));
        let (sin, cos) = at.point.contact_angle.sin_cos();
        let cos_lead = at.point.helix.lead_angle.cos();
        let across = offsets.map(|l| l * sin);
        let widest = WIDE * across[0].min(across[1]);
        let grooves = Self {
            offsets,
            across,
            outward: offsets.map(|l| l * cos),
            // e = l₀ sinβ₀ − s cosα/4                                     (AC2)
            shift: (0.25 * fit.axial_play * cos_lead).min(widest),
            radial_gap: fit.radial_gap,
            oversize: fit.oversize,
            hertz,
            cos_lead,
        };
        if fit.axial_play.is_nan() || fit.axial_play < 0.0 {
            return Err(refused("axial play [m]", fit.axial_play, "not negative"));
        }
        if !(grooves.height() > 0.0 && grooves.diagonal() > grooves.height()) {
            let requirement = "such that balls touch at contact angles between 0 and 90 degrees";
            return Err(refused("radial gap of a ball [m]", fit.radial_gap, requirement));
        }
        Ok(grooves)
    }

    /// Distance `$L$` of the arc centers of a diagonal at first touch.
    fn diagonal(&self) -> f64 {
        self.offsets[0] + self.offsets[1] - 2.0 * self.oversize
    }

    /// Distance of the arc centers of a diagonal along the principal normal.
    fn height(&self) -> f64 {
        self.outward[0] + self.outward[1] - self.radial_gap
    }

    /// Distance of the arc centers of a diagonal along the binormal, the nut in the middle.
    fn width(&self) -> f64 {
        self.across[0] + self.across[1] - 2.0 * self.shift
    }

    /// Displacement of the nut along the binormal at which the flanks + touch the ball \[m\]; negative if the ball is
    /// clamped in the middle.
    pub(super) fn first_touch(&self) -> f64 {
        // w_t = √(L² − (y_A + y_B + w_n)²) − e_A − e_B                    (AC3)
        let (l, y) = (self.diagonal(), self.height());
        ((l - y) * (l + y)).sqrt() - self.width()
    }

    /// Distance of the arc center of nut or screw from the middle of the groove, `$e$`.
    pub(super) fn center(&self, body: usize) -> f64 {
        self.across[body] - self.shift
    }

    /// Position of a ball that the flanks + press by these approaches at these contact angles.
    pub(super) fn between(&self, approaches: [f64; 2], angles: [f64; 2]) -> [f64; PLACE] {
        let length = |i: usize| self.offsets[i] - self.oversize + approaches[i];
        let [(sin_a, _), (sin_b, cos_b)] = angles.map(f64::sin_cos);
        let x_b = length(1) * sin_b - self.center(1);
        let w_b = x_b + length(0) * sin_a - self.center(0);
        [x_b, length(1) * cos_b - self.outward[1], w_b]
    }

    /// Axial force of the nut on a ball at rest.
    pub(super) fn axial_force(&self, place: &[f64; PLACE]) -> f64 {
        self.normal_forces(place).1[0] * self.cos_lead
    }

    /// Axial play below which the far flank of nut or screw touches a ball on two contacts \[m\], zero if no play does.
    pub(super) fn threshold_play(&self, found: &SteadyState) -> Option<f64> {
        let play = |i: usize, contact: &ContactState| {
            let offset = self.offsets[i] - self.oversize;
            let length = offset + contact.pressed?.approach;
            let angle = contact.angle.sin_cos();
            Some(far_flank_play((self.across[i], offset), length, angle, self.cos_lead))
        };
        Some(play(0, &found.ball.nut)?.max(play(1, &found.ball.screw)?))
    }

    /// Cosine of the contact angle at which the flanks + touch a ball of nominal diameter.
    pub(super) fn cos_first_contact(&self) -> f64 {
        self.height() / (self.offsets[0] + self.offsets[1])
    }

    /// A contact of the ball at `place`.
    pub(super) fn flank<D: Scalar>(
        &self,
        flank: usize,
        [x_b, x_n, w_b]: &[D; PLACE],
    ) -> FlankApproach<D> {
        let (body, far) = (flank / 2, flank % 2 == 1);
        let (side, other) = ([1.0, -1.0][body], if far { -1.0 } else { 1.0 });
        // N± = (±e_A + w_b, y_A + w_n),  S± = (∓e_B, −y_B),  w_n = −g     (AC1)
        let c = [side * other * self.center(body), side * self.outward[body]];
        let moved = if body == 0 { [*w_b - *x_b, -*x_n - self.radial_gap] } else { [-*x_b, -*x_n] };
        let v = [moved[0] + c[0], moved[1] + c[1]];
        let length = (v[0].square() + v[1].square()).sqrt();
        // |C₀|² − l₀², of the shift by play alone
        let by_play = -self.shift * (2.0 * self.across[body] - self.shift);
        let by_motion =
            moved[0] * (moved[0] + 2.0 * c[0]) + moved[1] * (moved[1] + 2.0 * c[1]) + by_play;
        // δ = l − l₀ + Δr,  l − l₀ = (|C₀|² − l₀² + 2 C₀·D + D·D)/(l + l₀)  (AC4)
        let approach = by_motion / (length + self.offsets[body]) + self.oversize;
        FlankApproach { approach, normal: v.map(|v| v / length) }
    }

    /// Normal load of an approach \[N\], zero of a gap (H9).
    pub(super) fn load<D: Scalar>(&self, flank: usize, approach: D) -> D {
        if approach.re() <= 0.0 {
            return D::from(0.0);
        }
        approach * approach.sqrt() * self.hertz[flank / 2].stiffness()
    }

    /// Semi-axes of a positive approach \[m\]: the cube root of the load without its infinite slope at zero.
    pub(super) fn semi_axes<D: Scalar>(&self, flank: usize, approach: D) -> (D, D) {
        let Hertz { semi_axis, flatness, .. } = self.hertz[flank / 2];
        let a = approach.sqrt() * (semi_axis * self.hertz[flank / 2].stiffness().cbrt());
        (a, a * flatness)
    }

    /// Forces of all contacts on the ball and of the nut on the ball, without friction.
    fn normal_forces<D: Scalar>(&self, place: &[D; PLACE]) -> ([D; 2], [D; 2]) {
        let zero = D::from(0.0);
        let (mut ball, mut nut) = ([zero; 2], [zero; 2]);
        for flank in 0..FLANKS {
            let FlankApproach { approach, normal } = self.flank(flank, place);
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

    /// The largest load of a position, and its approach.
    pub(super) fn largest(&self, place: &[f64; PLACE]) -> (f64, f64) {
        let loads = (0..FLANKS).map(|flank| {
            let approach = self.flank(flank, place).approach;
            (self.load(flank, approach), approach)
        });
        loads.fold((0.0, 0.0), |most, one| if one.0 > most.0 { one } else { most })
    }

    /// Position of ball and nut without friction and inertia.
    ///
    /// # Errors
    ///
    /// [`Reason::Refused`] if no flank touches the ball, or the flanks cannot carry the force.
    pub(super) fn at_rest(
        &self,
        condition: AxialCondition,
        newton: &mut Workspace<PLACE>,
    ) -> Result<[f64; PLACE], NoAnswer> {
        let stiffness = (self.hertz[0].compliance + self.hertz[1].compliance).powf(-1.5);
        let touch = self.first_touch();
        let (w, axial) = match condition {
            AxialCondition::Displacement(u) => (u * self.cos_lead, 0.0),
            AxialCondition::Force(axial) => {
                if !(axial >= 0.0 && (axial > 0.0 || touch < 0.0)) {
                    return Err(loose("axial force on the ball [N]", axial));
                }
                let sin = (1.0 - self.cos_first_contact().powi(2)).sqrt();
                let load = axial / (sin * self.cos_lead);
                ((load / stiffness).cbrt().powi(2) / sin + touch.max(0.0), axial)
            }
        };
        // The ball lies between the arc centers of the diagonal that is pressed more.
        let sign = if w < 0.0 { -1.0 } else { 1.0 };
        let (g_b, g_n) = (sign * self.width() + w, self.height());
        let length = g_b.hypot(g_n);
        let both = length - self.diagonal();
        if both <= 0.0 {
            return Err(loose("axial displacement of the nut [m]", w / self.cos_lead));
        }
        let share =
            self.hertz[1].compliance / (self.hertz[0].compliance + self.hertz[1].compliance);
        let from_screw = self.offsets[1] - self.oversize + share * both;
        let mut y = [
            -sign * self.center(1) + g_b / length * from_screw,
            -self.outward[1] + g_n / length * from_screw,
            w,
        ];
        let (load, approach) = self.largest(&y);
        let force = load.max(axial);
        let rest = Rest { grooves: self, condition, force, length: approach };
        for y in &mut y {
            *y /= approach;
        }
        let scales = Scales { x: &[1.0; PLACE], f: &[1.0; PLACE] };
        let convergence =
            Convergence { residual_tol: 1e-9, max_steps: 100, ..Convergence::default() };
        let options = Options { convergence, ..Options::default() };
        let report = solve(&rest, &mut y, &scales, &options, newton).report;
        if !report.converged() {
            return Err(NoAnswer::not_converged(Reason::from(report)));
        }
        Ok(y.map(|y| y * approach))
    }
}

fn refused(quantity: &'static str, value: f64, requirement: &'static str) -> NoAnswer {
    NoAnswer::invalid(Reason::Refused { error: EvalError { quantity, value, requirement } })
}

fn loose(quantity: &'static str, value: f64) -> NoAnswer {
    domain_error(EvalError {
        quantity,
        value,
        requirement: "such that the flanks + or an oversize ball carry it",
    })
}

/// The balance of a ball without friction and inertia; lengths over an approach.
struct Rest<'a> {
    grooves: &'a Grooves,
    condition: AxialCondition,
    /// Units of force and length.
    force: f64,
    length: f64,
}

impl Rest<'_> {
    #[expect(clippy::unnecessary_wraps, reason = "the form that `equations!` takes")]
    fn residual<D: Scalar>(&self, y: &[D; PLACE]) -> Result<[D; PLACE], EvalError> {
        let (ball, nut) = self.grooves.normal_forces(&y.map(|y| y * self.length));
        let position = match self.condition {
            AxialCondition::Force(axial) => {
                (nut[0] * self.grooves.cos_lead - axial) * self.force.recip()
            }
            AxialCondition::Displacement(u) => y[2] - u * self.grooves.cos_lead / self.length,
        };
        Ok([ball[0] * self.force.recip(), ball[1] * self.force.recip(), position])
    }
}

equations!(
    Rest<'_>,
    PLACE,
    Rest::residual,
    ["force along b", "force along n", "position of the nut"]
);
