//! Starting points spread over the possible states of a ball, for roots to which no path leads.

use std::f64::consts::FRAC_PI_2;

use bsm_newton::Continuation;

use super::equations::{OMEGA, SlipBall};
use super::root::SlipRoot;
use crate::cost::searched;
use crate::models::ball::unknown::{NUT_LOAD, PRECESSION, SCREW_LOAD, TILT};
use crate::models::ball::{BALL, Workspace, weyl_point};

/// Starts of a point, and of one whose path says little.
pub(super) const STARTS: u32 = 200;
pub(super) const MANY: u32 = 800;

impl SlipBall<'_> {
    /// A start: one of three kinds of contact angles, with one of four kinds of rates.
    fn sampled(&self, number: u32) -> [f64; BALL] {
        let contacts = self.contacts;
        let [nut_angle, screw_angle, nut_load, screw_load, rate, slow, along, radial, around] =
            weyl_point(number);
        let unloaded = contacts.contact_angle;
        // Angles apart as inertia turns them, or as friction does.
        let angles = match number % 3 {
            0 => {
                let beyond = (FRAC_PI_2 - unloaded) * screw_angle;
                [unloaded * (1.0 - nut_angle), unloaded + beyond]
            }
            1 => [FRAC_PI_2 * nut_angle, FRAC_PI_2 * screw_angle],
            _ => {
                let spread = 0.4 * (nut_angle - 0.5) * contacts.friction.min(1.0);
                [unloaded - spread, unloaded + spread]
            }
        };
        let cos = contacts.helix.lead_angle.cos();
        let load = |angle: f64, part: f64| (2.0 * part - 1.0).exp() / (angle.sin().max(1e-6) * cos);
        // Rates between those of both members, or so slow that inertia is of the size of load or
        // friction.
        // Drawn over |W|: each direction has its own.
        let (mu, way) = (contacts.inertia_ratio(), contacts.direction.sign());
        let rate = match number / 3 % 4 {
            0 => contacts.scaled.nut_speed + 2.0 * rate - 0.5,
            kind => {
                let size = if kind == 1 { contacts.friction / mu } else { mu.recip().sqrt() };
                (size * (2.0 - 8.0 * slow).exp()).min(1.0).copysign((rate - 0.5) * way)
            }
        };
        let mut y = [0.0; BALL];
        (y[NUT_LOAD], y[SCREW_LOAD]) = (load(angles[0], nut_load), load(angles[1], screw_load));
        y[TILT] = 0.5 * (angles[1] - angles[0]);
        y[PRECESSION] = rate - self.offset();
        // Rolling, more or less.
        y[OMEGA[0]] = (contacts.scaled.nut_speed - rate) * contacts.scaled.arc * 1.5 * along;
        y[OMEGA[1]] = contacts.scaled.arc * 6.0 * (radial - 0.5) * way;
        y[OMEGA[2]] = (around - 0.5) * way;
        y
    }

    /// A root on the flanks from one of the starts.
    pub(super) fn multistart(
        &self,
        starts: u32,
        newton: &mut Workspace,
        steps: &mut usize,
    ) -> Option<SlipRoot> {
        if starts > 0 {
            searched();
        }
        let control = Continuation { first: 2.0, shortest: 0.2 };
        let end = self.creep.ln();
        (0..starts).find_map(|number| {
            let y = self.sampled(number);
            // From friction nearly proportional to the slip on, or as it is.
            let begin = if number / 12 % 2 == 0 { end } else { self.lever(&y).ln().max(end) };
            let root = self.by_falling_creep(y, begin, control, newton, steps)?;
            self.is_balanced(&root).then_some(root)
        })
    }
}
