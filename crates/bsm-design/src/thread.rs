//! Geometry of the thread: arcs, bottoms and lands of the grooves in nut and screw.
//!
//! Theory: `docs/theory/11-ratings.md`, equations (G1) to (G9). The profile lies in a section
//! perpendicular to the groove, and the lead is neglected.

use bsm_dyn::hertz::{Hertz, Raceway};

use crate::Nut;

/// Difference between each land diameter and the pitch circle diameter \[m\] (Sobolewski 2002), and
/// upper limit of the ratio of this difference to the ball diameter.
const LAND_GAP: (f64, f64) = (1.5e-3, 0.5);

/// Groove profile of the nut or of the screw. It consists of two arcs (gothic arch), or of a single
/// arc if the centers of both arcs coincide.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Profile {
    /// Radius `$R$` of the arcs \[m\].
    pub radius: f64,
    /// Distance `$k$` of the arc centers from the center plane of the groove \[m\] (G1).
    pub offset: f64,
    /// Radial distance of the arc centers from the pitch circle, on the side away from the groove
    /// \[m\].
    pub height: f64,
    /// Diameter at the bottom of the complete arcs, called the calculated core diameter \[m\] (G3).
    pub core: f64,
    /// Diameter at which the two arcs meet, called the root diameter \[m\] (G5).
    pub root: f64,
    /// Diameter of the land, which is the bore of the nut or the outer diameter of the screw \[m\].
    pub land: f64,
    /// Radial distance of the land from the pitch circle, on the side of the groove \[m\].
    pub land_height: f64,
    /// Angle between the radial direction and the end of the arc at the land \[rad\] (G7).
    pub edge: f64,
}

impl Profile {
    /// Returns points on one flank, from the root (where the arcs meet) to the land. Each point
    /// consists of the axial distance from the center plane of the groove and the radial distance
    /// from the pitch circle, positive toward the groove \[m\].
    ///
    /// * `steps`: number of intervals between the points, at least 1.
    pub fn flank(&self, steps: u32) -> Vec<(f64, f64)> {
        let [meet, edge] = self.ends();
        let point = |i: u32| {
            let angle = meet + (edge - meet) * f64::from(i) / f64::from(steps);
            (self.radius * angle.sin() - self.offset, self.radius * angle.cos() - self.height)
        };
        (0..=steps).map(point).collect()
    }

    /// Returns the angles between the radial direction and the two ends of a flank \[rad\], at the
    /// root and at the land.
    pub fn ends(&self) -> [f64; 2] {
        [(self.offset / self.radius).clamp(-1.0, 1.0).asin(), self.edge]
    }
}

/// Groove profiles of a nut and its screw.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Thread {
    /// Groove profile of the nut.
    pub nut: Profile,
    /// Groove profile of the screw.
    pub screw: Profile,
    /// Axial play of a single nut without preload, from flank to flank \[m\].
    pub play: f64,
}

impl Nut {
    /// Returns the typical land diameters \[m\], which are the bore of the nut and the outer
    /// diameter of the screw (G6).
    ///
    /// Source: Sobolewski (2002), `$D_{pw} \pm 1.5$` mm for balls of 3 mm or more. For smaller
    /// balls, half the ball diameter is used, so that the lands can hold the balls.
    pub fn usual_lands(&self) -> (f64, f64) {
        // D_b = D_pw + min(1.5 mm, D_w/2),  d_s = D_pw − min(1.5 mm, D_w/2)  (G6)
        let gap = LAND_GAP.0.min(LAND_GAP.1 * self.ball_diameter);
        (self.pitch_diameter + gap, self.pitch_diameter - gap)
    }

    /// Returns the axial play of a thread with single-arc grooves \[m\] (G2). This is the largest
    /// possible play for the given contact angle.
    pub fn monoarc_play(&self) -> f64 {
        // s_m = 2 (R_n + R_s − D_w) sinβ                                  (G2)
        2.0 * (self.conformity.sum() - 1.0) * self.ball_diameter * self.contact_angle.sin()
    }

    /// Returns the contact angle of a thread \[rad\] from the radial distance between the bottoms
    /// of the arcs in nut and screw, `$(D_{ro} - d_{ro})/2$` \[m\] (G4). Returns `None` unless this
    /// distance is between one ball diameter and the sum of the groove radii.
    ///
    /// Source: Sobolewski (2002), eq. 1, whose printed denominator lacks the ball diameter.
    pub fn contact_angle_of(&self, bottoms: f64) -> Option<f64> {
        let radii = self.conformity.sum() * self.ball_diameter;
        // cosβ = [R_n + R_s − (D_ro − d_ro)/2] / (R_n + R_s − D_w)        (G4)
        let cos = (radii - bottoms) / (radii - self.ball_diameter);
        (cos > 0.0 && cos < 1.0).then(|| cos.acos())
    }

    /// Creates the thread geometry for which the balls touch the grooves at the contact angle when
    /// the axial play is taken up, (G1) to (G7).
    ///
    /// ```math
    /// k = (R - \tfrac12 D_w)\sin\beta\,\Big(1 - \frac{s}{s_m}\Big)
    /// ```
    ///
    /// * `play`: axial play `$s$` \[m\], from 0 (gothic arch with four-point contact) to the play
    ///   of single-arc grooves ([`monoarc_play`](Self::monoarc_play)).
    /// * `lands`: bore diameter of the nut and outer diameter of the screw \[m\].
    ///
    /// Source: Sobolewski (2002), eq. 1 for a thread without play.
    pub fn thread(&self, play: f64, lands: (f64, f64)) -> Thread {
        let share = 1.0 - play / self.monoarc_play();
        let profile = |side: f64, conformity: f64, land: f64| {
            let radius = conformity * self.ball_diameter;
            let center_distance = radius - 0.5 * self.ball_diameter;
            let height = center_distance * self.contact_angle.cos();
            // k = (R − D_w/2) sinβ (1 − s/s_m)                            (G1)
            let offset = center_distance * self.contact_angle.sin() * share;
            // D_ro, d_ro = D_pw ± 2 [R − (R − D_w/2) cosβ]                (G3)
            let core = self.pitch_diameter + 2.0 * side * (radius - height);
            // D_r, d_r = D_pw ± 2 [√(R² − k²) − (R − D_w/2) cosβ]         (G5)
            let root = self.pitch_diameter
                + 2.0 * side * ((radius.powi(2) - offset.powi(2)).sqrt() - height);
            let land_height = 0.5 * side * (land - self.pitch_diameter);
            // cosθ = [h + (R − D_w/2) cosβ] / R                           (G7)
            let edge = ((land_height + height) / radius).clamp(-1.0, 1.0).acos();
            Profile { radius, offset, height, core, root, land, land_height, edge }
        };
        Thread {
            nut: profile(1.0, self.conformity.nut, lands.0),
            screw: profile(-1.0, self.conformity.screw, lands.1),
            play,
        }
    }

    /// Returns the axial load on one nut at which a contact ellipse reaches the end of its flank,
    /// at the land or at the bottom of the groove \[N\]. Returns 0 if the unloaded contact point is
    /// not on the flank.
    ///
    /// * `hertz`: Hertzian contacts of the ball with nut and screw.
    pub fn edge_load(&self, thread: &Thread, hertz: &[Hertz; 2]) -> f64 {
        let direction = self.contact_angle.sin() * self.lead_angle().cos();
        let load = |(profile, hertz): (&Profile, &Hertz)| {
            // F_e = n i sinβ cosα [R min(θ − β, β − asin(k/R)) / a₁]³     (G8)
            let room = profile.radius * profile.room(self.contact_angle).max(0.0);
            self.balls_per_turn * self.turns * direction * (room / hertz.semi_axis).powi(3)
        };
        [&thread.nut, &thread.screw].into_iter().zip(hertz).map(load).fold(f64::INFINITY, f64::min)
    }
}

impl Thread {
    /// Returns the groove profile of nut or screw.
    pub fn profile(&self, member: Raceway) -> &Profile {
        match member {
            Raceway::Nut => &self.nut,
            Raceway::Screw => &self.screw,
        }
    }
}

impl Profile {
    /// Returns the angle between the contact point and the nearer end of its flank \[rad\] (G8).
    fn room(&self, contact_angle: f64) -> f64 {
        let [meet, edge] = self.ends();
        (edge - contact_angle).min(contact_angle - meet)
    }

    /// Returns the cross-sectional area of the groove below the land \[m²\] (G9).
    ///
    /// Assumes that the land cuts off the arcs. If the land lies beyond the widest point of the
    /// arcs, the arcs end at this point.
    pub fn section(&self) -> f64 {
        let cut = (self.land_height + self.height).max(0.0);
        let end = (self.radius.powi(2) - cut.powi(2)).max(0.0).sqrt();
        if end <= self.offset {
            return 0.0;
        }
        // A_g = u √(R² − u²) + R² asin(u/R) − 2 u (h + c) from u = k to √(R² − (h + c)²)  (G9)
        let integral = |u: f64| {
            let arc = (self.radius.powi(2) - u.powi(2)).sqrt();
            u * arc + self.radius.powi(2) * (u / self.radius).asin() - 2.0 * u * cut
        };
        integral(end) - integral(self.offset)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

    use approx::assert_relative_eq;
    use bsm_dyn::{Conformities, Material, Materials};

    use super::*;

    const STEEL: Material = Material { youngs_modulus: 206e9, poisson_ratio: 0.3 };

    fn nut() -> Nut {
        Nut {
            ball_diameter: 6.35e-3,
            pitch_diameter: 64.61e-3,
            lead: 10e-3,
            contact_angle: 0.9 * FRAC_PI_4,
            conformity: Conformities { nut: 0.55, screw: 0.53 },
            material: Materials::alike(STEEL),
            starts: 1.0,
            balls_per_turn: 28.0,
            turns: 6.0,
        }
    }

    fn thread(nut: &Nut, play: f64) -> Thread {
        nut.thread(play, nut.usual_lands())
    }

    /// Without play, the formulas match the printed formulas of eq. 1 and of the core diameters.
    /// The contact angle can be recovered from the core diameters.
    #[test]
    fn groove_dimensions_without_play_match_the_formulas_printed_in_the_paper() {
        let nut = nut();
        let tan = nut.contact_angle.tan();
        let Thread { nut: n, screw: s, .. } = thread(&nut, 0.0);
        let k = |r: f64| 0.5 * (2.0 * r - nut.ball_diameter) * nut.contact_angle.sin();
        assert_relative_eq!(n.offset, k(n.radius), max_relative = 1e-14);
        assert_relative_eq!(s.offset, k(s.radius), max_relative = 1e-14);
        let core_nut = nut.pitch_diameter + 2.0 * n.radius - 2.0 * n.offset / tan;
        let core_screw = nut.pitch_diameter - 2.0 * s.radius + 2.0 * s.offset / tan;
        assert_relative_eq!(n.core, core_nut, max_relative = 1e-14);
        assert_relative_eq!(s.core, core_screw, max_relative = 1e-14);
        let angle = nut.contact_angle_of(0.5 * (n.core - s.core)).expect("a thread");
        // The cosine is the ratio of a length difference to a length. The subtracted lengths are
        // thirty times as large as their difference, which amplifies rounding errors.
        assert_relative_eq!(angle, nut.contact_angle, max_relative = 1e-12);
        assert_eq!(nut.contact_angle_of(nut.ball_diameter - 1e-9), None);
        assert_eq!(nut.contact_angle_of(n.radius + s.radius + 1e-9), None);
    }

    /// When the play is taken up, the ball touches both arcs at the contact angle. The angle
    /// between the radial direction and the line through both arc centers is then equal to the
    /// contact angle.
    #[test]
    fn ball_touches_both_arcs_at_the_contact_angle_without_play() {
        let nut = nut();
        for share in [0.0, 0.3, 1.0] {
            let Thread { nut: n, screw: s, play } = thread(&nut, share * nut.monoarc_play());
            // The contact angle determines the radial positions of the arc centers. When the play
            // is taken up, the arc centers move axially by half of the play.
            let along = n.offset + s.offset + 0.5 * play;
            let across = n.height + s.height;
            assert_relative_eq!(along.atan2(across), nut.contact_angle, max_relative = 1e-12);
            let center_distance = n.radius + s.radius - nut.ball_diameter;
            assert_relative_eq!(along.hypot(across), center_distance, max_relative = 1e-12);
        }
        let single = thread(&nut, nut.monoarc_play());
        // In a single-arc groove, the root is at the bottom of the arc.
        assert_relative_eq!(single.nut.root, single.nut.core, max_relative = 1e-14);
        assert_relative_eq!(single.screw.root, single.screw.core, max_relative = 1e-14);
    }

    /// Without an offset of the arc centers, the cross section of the groove is a semicircle. If
    /// the land is at the root, the cross-sectional area is zero. In between, the area of a gothic
    /// arch matches the sum of many strips.
    #[test]
    fn groove_section_matches_a_sum_of_strips() {
        let profile = thread(&nut(), 0.0).nut;
        let radius = profile.radius;
        let half = Profile { offset: 0.0, height: 0.0, land_height: 0.0, ..profile };
        assert_relative_eq!(half.section(), 0.5 * PI * radius.powi(2), max_relative = 1e-14);
        assert!(Profile { land_height: radius, ..profile }.section() <= 0.0);
        let floor = profile.land_height + profile.height;
        let (steps, width) = (100_000, radius / 1e5);
        let strips = (0..steps).map(|i| {
            let x = width * (f64::from(i) + 0.5);
            let arc = radius.powi(2) - (x + profile.offset).powi(2);
            2.0 * width * (arc.max(0.0).sqrt() - floor).max(0.0)
        });
        // The error of the midpoint rule is the area of the last strip, whose width is 1e-5 of the
        // total.
        assert_relative_eq!(strips.sum::<f64>(), profile.section(), max_relative = 1e-5);
    }

    /// The flanks extend well beyond a contact angle of 45 deg for all ball sizes. In an earlier
    /// version, the lands of all ball sizes differed from the pitch circle diameter by 1.5 mm, so
    /// the bore of 17 255 nuts in the catalog was larger than the circle around the balls.
    #[test]
    fn flanks_extend_beyond_the_contact_angle_for_all_ball_sizes() {
        for ball in [0.8e-3, 1e-3, 2e-3, 3e-3, 10e-3] {
            let nut = Nut { ball_diameter: ball, contact_angle: FRAC_PI_4, ..nut() };
            let Thread { nut: n, screw: s, .. } = thread(&nut, 0.0);
            assert!(n.edge > 1.3 * FRAC_PI_4 && n.edge < FRAC_PI_2, "{ball}: {}", n.edge);
            assert!(s.edge > 1.3 * FRAC_PI_4 && s.land < nut.pitch_diameter, "{ball}");
        }
        let wide = nut().thread(0.0, (70.96e-3, 58.26e-3));
        let hertz = nut().hertz().expect("ellipses");
        assert!(nut().edge_load(&wide, &hertz) <= 0.0);
    }
}
