//! A ball between elastic raceways: inputs, scaled units, and contacts under given loads.
//!
//! Theory: `docs/theory/06-elastic-contact.md`, equations (P1) to (P8).

mod start;

use std::array::from_fn;
use std::f64::consts::FRAC_PI_2;

use bsm_kin::{BallFrame, Contact, Helix, Motion, Over, Scalar, Site};
use bsm_newton::EvalError;

use super::ball_contacts::{ElasticMotion, LoadedContact, ScaledBall};
use super::ball_unknowns::BALL_UNKNOWNS;
use super::operating_point::{OperatingPoint, ScaledPoint};
use super::sensitivity::Performance;
use super::state::{BallState, Transmission};
use crate::contact::{
    Ball, Conformities, Curvatures, Groove, Hertz, Jones, Material, Materials, Raceway, Wrench,
    axial_force, efficiency, newton_euler, torque,
};
use crate::ellipse::{
    Ellipse, Integrate, Patch, Placement, contact_motion, pressed_radius, slip_scale,
};
use crate::models::ball::ball_unknowns;
use crate::outcome::{Direction, Reason, SolveFailure};

/// An operating point of a ball screw whose balls have one elastic contact with the nut and one
/// with the screw.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ElasticPoint<D = f64> {
    /// Geometry, friction, speeds and load.
    pub point: OperatingPoint<D>,
    /// Conformities of the nut and the screw: ratios of groove radius to ball diameter, above 1/2.
    pub conformity: Conformities<D>,
    /// Elastic constants of the raceways and of the ball.
    pub material: Materials<D>,
}

impl<D: Scalar> ElasticPoint<D> {
    /// Returns the Hertz contacts at the nut and the screw.
    ///
    /// # Errors
    ///
    /// Returns [`Reason::CurvaturesNotHertzian`] if a contact ellipse is not longer across the
    /// groove than along it.
    pub fn hertz(&self) -> Result<[Hertz<D>; 2], Reason> {
        let modulus = self.material.contact_modulus();
        Hertz::side_by_side(&self.curvatures(), modulus)
    }

    /// Returns the relative curvatures at the nut and the screw \[1/m\].
    pub(crate) fn curvatures(&self) -> [Curvatures<D>; 2] {
        let (r_m, r_b) = (self.point.helix.radius, self.point.ball.radius);
        let (lead, beta) = (self.point.helix.lead_angle, self.point.contact_angle);
        self.grooves().map(|groove| groove.curvatures(r_m, r_b, lead, beta))
    }

    /// Returns the operating point for a ball with a different radius and with a radial gap between
    /// the grooves. The contact angle at first contact changes accordingly (U34); the groove radii
    /// remain unchanged.
    ///
    /// * `radial_gap`: radial gap between nut and screw grooves \[m\].
    /// * `oversize`: excess of the ball radius over the nominal radius \[m\].
    #[must_use]
    pub fn fitted(&self, radial_gap: D, oversize: D) -> Self {
        let (nominal, one) = (self.point.ball, D::from(1.0));
        let radius = nominal.radius + oversize;
        let ratio = radius / nominal.radius;
        let [nut, screw] = self.grooves().map(|groove| groove.offset(nominal.radius));
        let distance = nut + screw;
        // cosβ₀ⱼ = [(l_A0 + l_B0) cosβ₀ + w_n]/(l_A0 + l_B0 − 2Δrⱼ)        (U34)
        let cos =
            (distance * self.point.contact_angle.cos() - radial_gap) / (distance - oversize * 2.0);
        let sin = ((one - cos) * (one + cos)).sqrt();
        let ball = Ball { radius, mass: nominal.mass * ratio * ratio.square() };
        Self {
            point: OperatingPoint { contact_angle: sin.atan2(cos), ball, ..self.point },
            conformity: Conformities {
                nut: self.conformity.nut / ratio,
                screw: self.conformity.screw / ratio,
            },
            ..*self
        }
    }

    /// Returns a copy of the operating point in plain numbers, without derivatives.
    pub(crate) fn values(&self) -> ElasticPoint {
        let material = |m: &Material<D>| Material {
            youngs_modulus: m.youngs_modulus.re(),
            poisson_ratio: m.poisson_ratio.re(),
        };
        ElasticPoint {
            point: self.point.values(),
            conformity: Conformities {
                nut: self.conformity.nut.re(),
                screw: self.conformity.screw.re(),
            },
            material: Materials {
                raceways: material(&self.material.raceways),
                ball: material(&self.material.ball),
            },
        }
    }

    pub(crate) fn grooves(&self) -> [Groove<D>; 2] {
        [
            Groove { member: Raceway::Nut, conformity: self.conformity.nut },
            Groove { member: Raceway::Screw, conformity: self.conformity.screw },
        ]
    }

    /// Returns the operating point in scaled units, which are based on the ball radius, the axial
    /// load per ball and the relative speed (P1).
    ///
    /// # Errors
    ///
    /// Returns [`SolveFailure`] if the inputs are invalid.
    pub(crate) fn scaled(&self) -> Result<ElasticContacts<D>, SolveFailure> {
        // Lengths are divided by r_b, forces by F_a, and speeds by W (R1)  (P1)
        let ScaledPoint { helix, mass, nut_speed, direction } = self.point.scaled()?;
        let hertz = self.hertz().map_err(SolveFailure::invalid)?;
        let (r_b, load) = (self.point.ball.radius, self.point.load.per_ball());
        let one = D::from(1.0);
        let [nut_offset, screw_offset] = self.grooves().map(|groove| groove.offset(one));
        let scaled = ScaledBall {
            lead: helix.lead_angle.sin_cos(),
            radius: helix.radius,
            arc: helix.arc_length_per_radian(),
            mass,
            nut_speed,
            // A₂ = (l_A0 + l_B0) cosβ₀                                    (J2)
            radial_distance: (nut_offset + screw_offset) * self.point.contact_angle.cos(),
            offsets: [nut_offset, screw_offset],
            approaches: hertz.map(|h| h.approach(load) / r_b),
            semi_axes: hertz.map(|h| {
                let (a, b) = h.semi_axes(load);
                (a / r_b, b / r_b)
            }),
            pressed_radius: [
                pressed_radius(self.conformity.nut, one),
                pressed_radius(self.conformity.screw, one),
            ],
        };
        Ok(ElasticContacts {
            helix,
            contact_angle: self.point.contact_angle,
            friction: self.point.friction.0,
            direction,
            hertz,
            scaled,
        })
    }
}

/// An operating point of a screw with elastic contacts, in scaled units.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ElasticContacts<P = f64> {
    /// Helix of the ball centers, with radius `$r_m/r_b$`.
    pub(crate) helix: Helix<P>,
    /// Ball and contacts in scaled units.
    pub(crate) scaled: ScaledBall<P>,
    /// Unloaded contact angle \[rad\].
    pub(crate) contact_angle: P,
    /// Coulomb friction coefficient.
    pub(crate) friction: P,
    /// Direction of the drive, which determines the sign of `$W$`.
    pub(crate) direction: Direction,
    /// Hertz contacts at the nut and the screw, in SI units.
    pub(crate) hertz: [Hertz<P>; 2],
}

/// Returns the motion relative to the nut together with the motion relative to the screw. All
/// speeds are divided by `$W$`.
pub(crate) fn to_both<D: Scalar>(to_nut: &Motion<D>, frame: &BallFrame<D>) -> [Motion<D>; 2] {
    [*to_nut, to_nut.relative_to(D::from(1.0), frame)]
}

/// Both contacts of a ball for given loads and tilt, in scaled units.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BallLoads<D> {
    /// Normal loads at the nut and the screw.
    pub(crate) loads: [D; 2],
    /// Half the difference between the contact angles at screw and nut \[rad\].
    pub(crate) tilt: D,
    /// Contact angles at the nut and the screw \[rad\].
    pub(crate) angles: [D; 2],
    /// Triad rotated to the mean contact normal, or to the contact normal at the nut (P8).
    pub(crate) frame: BallFrame<D>,
    /// Contacts at the nut and the screw.
    pub(crate) contacts: [Contact<D>; 2],
    /// Axial displacement of the nut in scaled units.
    pub(crate) displacement: D,
}

impl<P: Scalar> ElasticContacts<P> {
    /// Changes the sign of a friction force or power if `$W$` is negative. The change of sign is
    /// necessary if the force or power was calculated from the slip divided by `$W$`.
    pub(crate) fn signed<D: Over<P>>(&self, size: D) -> D {
        size * self.direction.sign()
    }

    /// Returns the friction coefficient with the sign of `$W$`, for use with the slip divided by
    /// `$W$`.
    pub(crate) fn directed_friction(&self) -> P {
        self.friction * self.direction.sign()
    }

    /// Returns the ratio of inertia force to axial load, `$m r_m W^2/F_a$`.
    pub(crate) fn inertia_ratio(&self) -> P {
        self.scaled.inertia_ratio()
    }

    /// Returns the elastic approaches in units of the ball radius, for loads in units of the axial
    /// load per ball (P2).
    pub(crate) fn approaches<D: Over<P>>(&self, loads: [D; 2]) -> [D; 2] {
        // δ = (Q/K_H)^{2/3}, Eq (H9)                                      (P2)
        from_fn(|i| self.approach_of(i, loads[i]))
    }

    /// Returns the elastic approach at the nut (0) or the screw (1) in units of the ball radius,
    /// for a load in units of the axial load per ball (P2).
    pub(crate) fn approach_of<D: Over<P>>(&self, i: usize, load: D) -> D {
        load.cbrt().square() * self.scaled.approaches[i]
    }

    /// Calculates both contacts and the displacement from two loads and a tilt (P2), (P3), (J7),
    /// (J8).
    ///
    /// # Errors
    ///
    /// Returns [`EvalError`] if a contact is lost.
    pub(crate) fn loaded<D: Over<P>>(
        &self,
        loads: [D; 2],
        tilt: D,
    ) -> Result<BallLoads<D>, EvalError> {
        let (jones, approaches) = self.pressed(loads)?;
        let (mean, displacement) = jones.deformed(approaches, tilt)?;
        // β_A = β − ν,  β_B = β + ν                                       (P3)
        let contacts = [Contact::tilted(Site::Nut, -tilt), Contact::tilted(Site::Screw, tilt)];
        let frame = BallFrame::turned(D::from(self.helix.lead_angle), mean);
        let angles = [mean - tilt, mean + tilt];
        Ok(BallLoads { loads, tilt, angles, frame, contacts, displacement })
    }

    /// Calculates both contacts and the displacement from two loads and the contact angle at the
    /// nut (P8).
    ///
    /// # Errors
    ///
    /// Returns [`EvalError`] if a contact is lost.
    pub(crate) fn loaded_by_nut_angle<D: Over<P>>(
        &self,
        loads: [D; 2],
        nut: D,
    ) -> Result<BallLoads<D>, EvalError> {
        let (jones, approaches) = self.pressed(loads)?;
        let (screw, displacement) = jones.screw_angle(approaches, nut)?;
        // The triad is aligned with the normal at A; the normal at B is tilted by β_B − β_A  (P8)
        let frame = BallFrame::turned(D::from(self.helix.lead_angle), nut);
        let contacts =
            [Contact::tilted(Site::Nut, D::from(0.0)), Contact::tilted(Site::Screw, screw - nut)];
        let (tilt, angles) = ((screw - nut) * 0.5, [nut, screw]);
        Ok(BallLoads { loads, tilt, angles, frame, contacts, displacement })
    }

    /// Returns the groove geometry and the elastic approaches for the given loads at the nut and
    /// the screw (P2).
    fn pressed<D: Over<P>>(&self, loads: [D; 2]) -> Result<(Jones<D>, [D; 2]), EvalError> {
        let least = loads[0].re().min(loads[1].re());
        if least.is_nan() || least <= 0.0 {
            return Err(EvalError {
                quantity: "ratio of normal load to axial load at a contact",
                value: least,
                requirement: "must be positive; otherwise the contact is lost",
            });
        }
        let [nut_offset, screw_offset] = self.scaled.offsets.map(D::from);
        let jones = Jones { nut_offset, screw_offset, contact_angle: D::from(self.contact_angle) };
        Ok((jones, self.approaches(loads)))
    }

    /// Returns the operating point with its inertia multiplied by `factor`.
    pub(crate) fn with_inertia(&self, factor: f64) -> Self {
        Self { scaled: ScaledBall { mass: self.scaled.mass * factor, ..self.scaled }, ..*self }
    }

    /// Returns the operating point with a different friction coefficient.
    pub(crate) fn with_friction(&self, friction: P) -> Self {
        Self { friction, ..*self }
    }

    /// Returns the residuals of the seven equations (P5): force and moment balance of the ball in
    /// the triad (t, N, e_x) of the loaded contacts, and axial force balance of the nut.
    ///
    /// * `motion`: absolute motion of the ball.
    /// * `wrenches`: forces and moments that the nut and the screw exert on the ball.
    pub(crate) fn balance<D: Over<P>>(
        &self,
        loaded: &BallLoads<D>,
        motion: &Motion<D>,
        wrenches: &[Wrench<D>; 2],
    ) -> [D; BALL_UNKNOWNS] {
        let ball = Ball { radius: D::from(1.0), mass: D::from(self.scaled.mass) };
        let [nut, screw] = *wrenches;
        let radius = D::from(self.helix.radius);
        let residual = newton_euler(&(nut + screw), &ball, radius, motion, &loaded.frame);
        // Σ F − m r_m P² n = 0,  Σ M − P k × Iω = 0,  F_nut·k − F_a = 0   (P5)
        ball_unknowns::residual_rows(&residual, axial_force(&nut.force, &loaded.frame) - 1.0)
    }

    /// Returns the friction powers of the contact ellipses at the nut and the screw, divided by
    /// `$W$`, for a motion relative to the nut (P7).
    pub(crate) fn friction_powers<D: Integrate<P>>(
        &self,
        loaded: &BallLoads<D>,
        to_nut: &Motion<D>,
        creep: f64,
        nodes: [Placement<'_>; 2],
    ) -> [D; 2] {
        let motions = to_both(to_nut, &loaded.frame);
        let powers = D::powers(&self.patches(loaded, &motions, creep), nodes);
        // P_f = Σ f Q ∫ dP                                                (P7)
        from_fn(|i| loaded.loads[i] * self.directed_friction() * powers[i])
    }

    /// Returns the friction powers at the nut and the screw that would result with a friction
    /// coefficient of one.
    pub(crate) fn unit_powers<D: Integrate<P>>(
        &self,
        loaded: &BallLoads<D>,
        to_nut: &Motion<D>,
        creep: f64,
        nodes: [Placement<'_>; 2],
    ) -> [D; 2] {
        self.with_friction(P::from(1.0)).friction_powers(loaded, to_nut, creep, nodes)
    }

    /// Converts a motion relative to the nut into an absolute motion.
    pub(crate) fn absolute<D: Over<P>>(
        &self,
        to_nut: &Motion<D>,
        frame: &BallFrame<D>,
    ) -> Motion<D> {
        to_nut.relative_to(D::from(-self.scaled.nut_speed), frame)
    }

    /// Returns the largest slip speed, divided by `$r_b W$`, of a ball that rotates at `$W$`
    /// relative to a raceway. The slip is evaluated at the ends of the longer contact ellipse under
    /// the axial load. The result is at least 1 (T9).
    pub(crate) fn slip_scale(&self) -> f64 {
        slip_scale(
            [0, 1].map(|i| self.scaled.semi_axes[i].0.re()),
            self.scaled.pressed_radius.map(|r| r.re()),
        )
    }

    /// Creates the contact patches at the nut and the screw over which friction is integrated (P6).
    ///
    /// * `motions`: motions of the ball relative to the raceways.
    pub(crate) fn patches<D: Over<P>>(
        &self,
        loaded: &BallLoads<D>,
        motions: &[Motion<D>; 2],
        creep: f64,
    ) -> [Patch<D>; 2] {
        from_fn(|i| {
            let local = contact_motion(&motions[i], &loaded.contacts[i], D::from(self.scaled.arc));
            self.ellipse(i, loaded).patch(&local, creep)
        })
    }

    /// Returns the loaded contact ellipse at the nut (0) or the screw (1) (P6).
    pub(crate) fn ellipse<D: Over<P>>(&self, i: usize, loaded: &BallLoads<D>) -> Ellipse<D, P> {
        // a ~ Q^{1/3}                                                     (P6)
        let (load, (a, b)) = (loaded.loads[i], self.scaled.semi_axes[i]);
        let growth = load.cbrt();
        Ellipse {
            contact: loaded.contacts[i],
            load,
            semi_axes: (growth * a, growth * b),
            pressed_radius: self.scaled.pressed_radius[i],
            ball_radius: P::from(1.0),
        }
    }
}

impl<D: Scalar> ElasticPoint<D> {
    /// Calculates the efficiency and the torque from the scaled force and moment of the screw on
    /// the ball.
    pub(crate) fn transmitted(
        &self,
        contacts: &ElasticContacts<D>,
        frame: &BallFrame<D>,
        screw: &Wrench<D>,
    ) -> Performance<D> {
        self.transmitted_torque(contacts, torque(screw, contacts.helix.radius, frame))
    }

    /// Calculates the efficiency and the torque from the scaled torque on the screw.
    pub(crate) fn transmitted_torque(
        &self,
        contacts: &ElasticContacts<D>,
        scaled_torque: D,
    ) -> Performance<D> {
        let torque = scaled_torque * self.point.units().torque;
        let efficiency =
            efficiency(contacts.direction.is_back(), self.point.ideal_torque(), torque);
        Performance { efficiency, screw_torque: Some(torque) }
    }
}

impl ElasticPoint {
    /// Converts the state of the ball from scaled units to SI units.
    ///
    /// * `friction_in_balance`: true if the force balance includes friction across the grooves.
    ///
    /// # Errors
    ///
    /// Returns [`SolveFailure`] if a contact angle is not in \[0, π/2). At an angle of 0, the
    /// contact is at the bottom of the gothic arch, where the ball touches the other flank. At π/2,
    /// the contact normal is axial, and no groove extends beyond this point.
    pub(crate) fn ball_state(
        &self,
        contacts: &ElasticContacts,
        loaded: &BallLoads<f64>,
        to_nut: &Motion<f64>,
        friction_in_balance: bool,
    ) -> Result<BallState, SolveFailure> {
        let angles @ [nut, screw] = loaded.angles;
        if !angles.iter().all(|angle| (0.0..FRAC_PI_2).contains(angle)) {
            return Err(SolveFailure::not_converged(Reason::BallLeavesFlank { nut, screw }));
        }
        let (scaled, motions) = (&contacts.scaled, to_both(to_nut, &loaded.frame));
        let touch = |i: usize| (&motions[i], &loaded.contacts[i]);
        let slip = [0, 1].map(touch).map(|(m, c)| m.slip_velocity(scaled.arc, &c.point(1.0)));
        let sign = contacts.direction.sign();
        let motion = ElasticMotion {
            slip: slip.map(|slip| slip.norm()),
            spin: [0, 1].map(touch).map(|(m, c)| m.spin(c)),
            slip_angles: Some(from_fn(|i| loaded.contacts[i].slip_angle(&(slip[i] * sign)))),
            rate: to_nut.precession + scaled.nut_speed,
            to_nut: loaded.frame.to_frenet(&to_nut.omega).into(),
            friction_in_balance,
        };
        let sides = from_fn(|i| {
            let stiff = (scaled.offsets[i], scaled.approaches[i]);
            LoadedContact::of(stiff, loaded.loads[i], angles[i].sin_cos())
        });
        let (sides, units) = ((angles, &sides), self.point.units());
        Ok(motion.state(scaled, sides, loaded.displacement, &units))
    }

    /// Calculates the torque, the efficiency and the powers from the scaled torque on the screw,
    /// and checks the power balance.
    ///
    /// * `friction_power`: scaled friction power, divided by `$W$`.
    ///
    /// # Errors
    ///
    /// Returns [`SolveFailure`] if the power balance is violated.
    pub(crate) fn transmission_at(
        &self,
        torque: f64,
        friction_power: f64,
    ) -> Result<Transmission, SolveFailure> {
        let ideal = self.point.ideal_torque();
        self.point.units().transmission(ideal, torque, friction_power).balanced()
    }
}
