//! Tests of limiting cases, identities and expected errors of the nut model.

use crate::nuts;

use std::f64::consts::{PI, TAU};

use approx::assert_relative_eq;
use bsm_dyn::{
    Ball, Conformities, Material, Materials, ModelWorkspace, Problem, model::RacewayControl,
};
use bsm_kin::{Drive, Helix};
use bsm_nut::friction::FlankFriction;
use bsm_nut::{
    BallNut, Bar, Circuit, Errors, Flanks, Freedom, LeadError, NutError, PreloadKind, Ring, Support,
};
use nuts::with_circuits;
use proptest::prelude::*;

fn circuit(start_deg: f64, arc_deg: f64, balls: usize, flanks: Flanks) -> Circuit {
    let (start, arc) = (start_deg.to_radians(), arc_deg.to_radians());
    Circuit { start, arc, balls, thread: 0, body: 0, flanks, offset: 0.0 }
}

/// Returns a nut with 98 balls in 4.81 turns. The balls can carry load on both flanks.
fn nut_with_98_balls() -> BallNut {
    with_circuits(vec![circuit(0.0, 1731.6, 98, Flanks::Both)])
}

/// Returns a pair of nut bodies that are loaded on opposite flanks, without an offset between the
/// bodies.
fn pair() -> BallNut {
    let second = Circuit { body: 1, ..circuit(1440.0, 1080.0, 60, Flanks::Minus) };
    with_circuits(vec![circuit(0.0, 1080.0, 60, Flanks::Plus), second])
}

/// Returns a support that prescribes the displacement in every degree of freedom.
fn prescribed_displacements(at: [f64; 5]) -> Support {
    Support(at.map(Freedom::Held))
}

/// In a rigid, guided nut, all balls carry the same load, which matches the closed-form solution.
#[test]
fn balls_of_a_guided_rigid_nut_carry_equal_loads() {
    let nut = nut_with_98_balls();
    let equal = nut.equal(6340.0).expect("load");
    let found = nut.solve(&Support::guided(6340.0)).expect("load");
    for ball in &found.balls {
        // The nut solver and the calculation for equal load sharing both balance the forces to
        // 1e-12.
        assert_relative_eq!(ball.max_load(), equal.load, max_relative = 1e-11);
    }
    assert_relative_eq!(found.stiffness[0][0], equal.stiffness, max_relative = 1e-11);
    // The search starts from equal ball loads, which are the solution in this case, so at most one
    // step is needed.
    assert!(found.steps <= 1, "{}", found.steps);
    assert!(!nut.shares_equally(&Support::free(6340.0)));
    let one_flank = with_circuits(vec![circuit(0.0, 1731.6, 98, Flanks::Plus)]);
    assert!(one_flank.shares_equally(&Support::guided(6340.0)));
}

/// The stiffness equals the slope of the forces as functions of the prescribed displacements, even
/// if all bodies are elastic.
#[test]
fn stiffness_matches_the_slope_of_the_forces() {
    let mut nut = nut_with_98_balls();
    nut.nut_bar = Some(Bar { stiffness: 453e6, anchor: -0.01 });
    nut.screw_bar = Some(Bar { stiffness: 219.7e6, anchor: 0.07 });
    nut.ring =
        Some(Ring { outer_diameter: 70e-3, inner_diameter: 45.826e-3, youngs_modulus: 206e9 });
    nut.errors.lead = vec![LeadError::Wave { amplitude: 1e-6, order: 1.0, phase: 0.3 }];
    let at = [12e-6, 2e-6, -1e-6, 60e-6, -30e-6];
    let found = nut.solve(&prescribed_displacements(at)).expect("pressed");
    for k in 0..5 {
        let step = 1e-9 * if k < 3 { 1.0 } else { 50.0 };
        let carried = |sign: f64| {
            let mut at = at;
            at[k] += sign * step;
            nut.solve(&prescribed_displacements(at)).expect("pressed").carried
        };
        let (above, below) = (carried(1.0), carried(-1.0));
        for i in 0..5 {
            let slope = (above[i] - below[i]) / (2.0 * step);
            let size = (found.stiffness[i][i] * found.stiffness[k][k]).sqrt();
            // The tolerance includes two errors of the finite difference: the rounding error of
            // forces of 1e4 N divided by a step of 1 nm, and the truncation error due to the third
            // derivative of the energy.
            let allowed = 1e-6 * size;
            assert!((slope - found.stiffness[i][k]).abs() < allowed, "{i} {k}");
        }
    }
}

/// The sum of the ball forces equals the load except for rounding errors, and the stiffness matrix
/// is symmetric.
#[test]
fn ball_forces_add_up_to_the_load() {
    let load = [8000.0, 300.0, -500.0, 20.0, 40.0];
    let found = nut_with_98_balls().solve(&Support(load.map(Freedom::Loaded))).expect("carried");
    for (carried, load) in found.carried.iter().zip(load) {
        // The iteration stops when the residual is below 1e-12 times the sum of all forces.
        assert!((carried - load).abs() < 1e-8, "{carried} {load}");
    }
    for i in 0..5 {
        for k in 0..i {
            let size = (found.stiffness[i][i] * found.stiffness[k][k]).sqrt();
            assert!((found.stiffness[i][k] - found.stiffness[k][i]).abs() < 1e-12 * size);
        }
        assert!(found.stiffness[i][i] > 0.0);
    }
}

/// If stiff bars are anchored on the same side, the ball loads decrease with the distance from the
/// anchors, as first-order theory predicts.
#[test]
fn axial_elasticity_of_nut_and_screw_increases_the_load_on_the_ball_nearest_to_the_supports() {
    let mut nut = nut_with_98_balls();
    let positions = nut.positions();
    let (first, last) = (positions[0].z, positions[positions.len() - 1].z);
    let equal = nut.equal(10e3).expect("load");
    let stiffness = 2e11;
    for bar in [&mut nut.nut_bar, &mut nut.screw_bar] {
        *bar = Some(Bar { stiffness, anchor: first });
    }
    let found = nut.solve(&Support::guided(10e3)).expect("carried");
    // According to the theory, μ² l² = k_u l (1/EA_n + 1/EA_s) and max/mean = 1 + (μl)²/3.
    // Second-order terms and the finite spacing of the balls change the increase (μl)²/3 by about
    // 1e-3.
    let small = equal.stiffness * (last - first) * 2.0 / stiffness;
    let axial = |i: usize| found.balls[i].force[0];
    let mean = (0..98).map(axial).sum::<f64>() / 98.0;
    assert_relative_eq!(axial(0) / mean - 1.0, small / 3.0, max_relative = 0.03);
}

/// In a free nut, the radial components of the ball forces cause a moment, which only a tilt can
/// balance.
#[test]
fn a_free_nut_tilts_under_a_central_load() {
    let found = nut_with_98_balls().solve(&Support::free(6340.0)).expect("carried");
    // An independent solution gives a load concentration of 1.2536 at one tenth of the load rating.
    assert_relative_eq!(found.concentration(), 1.2536, epsilon = 6e-5);
    let tilt = found.displacement[3].hypot(found.displacement[4]);
    assert!((14e-6..220e-6).contains(&tilt), "{tilt:e}");
}

/// The load concentrations match all digits that an independent implementation prints.
#[test]
fn load_concentrations_match_an_independent_solution() {
    let stacked = |i: i32| circuit(360.0 * f64::from(i), 330.0, 19, Flanks::Both);
    let returns = with_circuits((0..5).map(stacked).collect());
    let mut bars = nut_with_98_balls();
    let first = bars.positions()[0].z;
    bars.nut_bar = Some(Bar { stiffness: 453e6, anchor: first });
    bars.screw_bar = Some(Bar { stiffness: 219.7e6, anchor: first });
    for (nut, support, exact) in
        [(returns, Support::free(6340.0), 1.3876), (bars, Support::guided(19020.0), 1.2157)]
    {
        let found = nut.solve(&support).expect("carried");
        assert_relative_eq!(found.concentration(), exact, epsilon = 6e-5);
    }
}

/// Torsion of the screw increases its axial compliance by the factor 1 + 4 (1 + ν) (h/r)²,
/// according to the closed-form expression for a solid shaft.
#[test]
fn torsion_reduces_the_stiffness_of_the_screw() {
    let nut = nut_with_98_balls();
    let ratio = nut.screw_stiffness(false) / nut.screw_stiffness(true);
    let radius = 0.5 * nut.groove_diameters()[0];
    let per_radian = nut.helix.lead() / TAU;
    // The calculated ratio and the closed-form expression differ only by rounding errors.
    assert_relative_eq!(ratio, 1.0 + 5.2 * (per_radian / radius).powi(2), max_relative = 1e-14);
    assert!((1.03..1.05).contains(&ratio), "{ratio}");
}

/// A nut with zero lead represents a deep-groove ball bearing. Its results match those of a
/// commercial program for bearing calculations according to ISO/TS 16281.
#[test]
fn nut_with_zero_lead_matches_a_ball_bearing() {
    let radius = 5.75e-3;
    let steel = Material { youngs_modulus: 210e9, poisson_ratio: 0.3 };
    let bearing = |gap: f64| BallNut {
        helix: Helix { radius: 21.75e-3, lead_angle: 0.0 },
        ball: Ball { radius, mass: 4.0 / 3.0 * PI * radius.powi(3) * 7800.0 },
        contact_angle: 0.0,
        conformity: Conformities { nut: 0.53, screw: 0.52 },
        material: Materials::alike(steel),
        errors: Errors { gap, ..Errors::default() },
        ..with_circuits(vec![circuit(-180.0 / 7.0, 360.0, 7, Flanks::Plus)])
    };
    let at = |gap: f64, load: [f64; 5], free: [bool; 5]| {
        let freedom = |i: usize| {
            if free[i] { Freedom::Loaded(load[i]) } else { Freedom::Held(0.0) }
        };
        let support = Support(std::array::from_fn(freedom));
        bearing(gap).solve(&support).expect("carried").displacement
    };
    let radial = [false, true, true, false, false];
    let force = [0.0, -1000.0, 0.0, 0.0, 0.0];
    // The published values have five or six digits.
    assert_relative_eq!(-at(0.0, force, radial)[1], 15.1101e-6, max_relative = 1e-5);
    assert_relative_eq!(-at(5e-6, force, radial)[1], 21.223e-6, max_relative = 1e-5);
    let axial = [1000.0, 0.0, 0.0, 0.0, 0.0];
    let found = at(0.0, axial, [true, false, false, false, false])[0];
    assert_relative_eq!(found, 133.5381e-6, max_relative = 1e-5);
}

/// If the preload approaches zero, the limit load approaches 2√2 times the preload, and the
/// stiffness approaches 3 F_p/δ_p.
#[test]
fn limit_load_and_stiffness_at_small_preload_match_hertzian_theory() {
    let pair = pair();
    let support = Support::guided(0.0);
    let force = 1.0;
    let offset = pair.preload_displacement(PreloadKind::Offset, force, &support).expect("reached");
    let nut = pair.preloaded(PreloadKind::Offset, offset);
    let found = nut.solve(&support).expect("at rest");
    // The offset is calculated with a relative error of 1e-13.
    assert_relative_eq!(found.preload(&nut, PreloadKind::Offset), force, max_relative = 1e-9);
    // A preload of 1 N changes the contact angles by 2e-4 rad.
    let stiffness = 3.0 * force / (0.5 * offset);
    assert_relative_eq!(found.stiffness[0][0], stiffness, max_relative = 1e-3);
    let limit = nut.limit_load(PreloadKind::Offset, &support, 1.0).expect("a limit");
    assert_relative_eq!(limit, 8.0_f64.sqrt() * force, max_relative = 1e-3);
    let other = nut.limit_load(PreloadKind::Offset, &support, -1.0).expect("a limit");
    assert_relative_eq!(other, -limit, max_relative = 1e-6);
}

/// The displacement that causes a given preload is found for a pair and for oversize balls.
#[test]
fn displacement_for_a_given_preload_is_found() {
    let pair = pair();
    let support = Support::guided(0.0);
    let offset = pair.preload_displacement(PreloadKind::Offset, 3000.0, &support).expect("reached");
    // The reference value is 11.7229564202 um.
    assert_relative_eq!(offset, 11.722_956_420_2e-6, max_relative = 1e-10);
    let single = nut_with_98_balls();
    let found =
        single.preload_displacement(PreloadKind::Oversize, 2000.0, &support).expect("reached");
    let tight = single.preloaded(PreloadKind::Oversize, found);
    let at_rest = tight.solve(&support).expect("at rest");
    assert_relative_eq!(
        at_rest.preload(&tight, PreloadKind::Oversize),
        2000.0,
        max_relative = 1e-9
    );
    // At rest, both flanks of every ball carry equal loads.
    let ball = at_rest.balls[17];
    assert_relative_eq!(ball.loads[0], ball.loads[1], max_relative = 1e-9);
}

/// Returns a pair in X or O arrangement with a preload of 2500 N at the assembly temperature.
fn cold_pair(x: bool) -> BallNut {
    let steel = Material { youngs_modulus: 207e9, poisson_ratio: 0.3 };
    let (pitch, lead) = (41.336e-3, 12e-3);
    let [first, second] =
        if x { [Flanks::Plus, Flanks::Minus] } else { [Flanks::Minus, Flanks::Plus] };
    let of_body =
        |start_deg, body, flanks| Circuit { body, ..circuit(start_deg, 1080.0, 57, flanks) };
    let nut = BallNut {
        helix: Helix { radius: 0.5 * pitch, lead_angle: (lead / (PI * pitch)).atan() },
        ball: Ball::of_density(3.175e-3, 7800.0),
        conformity: Conformities::alike(0.53),
        material: Materials::alike(steel),
        ..with_circuits(vec![of_body(0.0, 0, first), of_body(1440.0, 1, second)])
    };
    let force = if x { 2500.0 } else { -2500.0 };
    let offset = nut.preload_displacement(PreloadKind::Offset, force, &Support::guided(0.0));
    let offset = offset.expect("a preload");
    // The reference value is ∓11.784697 um, printed with eight digits.
    assert_relative_eq!(offset, force.signum() * 11.784_697e-6, max_relative = 1e-7);
    nut.preloaded(PreloadKind::Offset, offset)
}

/// The preload is set at the assembly temperature. In an earlier version, the preload was set again
/// in the warm nut, and a uniformly warm nut lost its preload by thermal expansion. The reference
/// values have ten digits and come from an independent solution.
#[test]
fn preload_is_set_at_assembly_and_changes_with_temperature() {
    let table = [
        ([0.0, 0.0, 0.0], 2500.0, 2500.0),
        ([0.0, 2.0, 0.0], 3_110.702_842, 2_378.952_327),
        ([0.0, 5.0, 0.0], 4_111.339_823, 2_210.411_218),
        ([0.0, 10.0, 0.0], 5_982.464_007, 1_965.005_531),
        ([5.0, 0.0, 0.0], 955.244_065, 2_497.221_455),
        ([0.0, 0.0, 5.0], 2_835.338_200, 2_835.338_200),
        ([20.0, 20.0, 20.0], 2500.0, 2500.0),
        ([3.0, 8.0, 6.0], 4_345.731_024, 2_400.960_259),
    ];
    let [x, o] = [true, false].map(cold_pair);
    for (rises, of_x, of_o) in table {
        for (pair, expected) in [(&x, of_x), (&o, of_o)] {
            let warm = pair.warmed(rises, 11.5e-6);
            let found = warm.solve(&Support::guided(0.0)).expect("at rest");
            let left = found.preload(&warm, PreloadKind::Offset);
            // The solver finds the offset with a relative error of 1e-13. The tolerance is the
            // rounding error of the digits printed in the reference.
            assert_relative_eq!(left, expected, max_relative = 2e-9);
        }
    }
}

/// A uniform temperature rise of nut, screw and balls does not change the ball loads. This is true
/// for nut pairs in both arrangements and for a nut with oversize balls and an elastic body.
#[test]
fn a_uniform_temperature_rise_does_not_change_the_ball_loads() {
    let mut single = nut_with_98_balls().preloaded(PreloadKind::Oversize, 8e-6);
    single.nut_bar = Some(Bar { stiffness: 453e6, anchor: 0.0 });
    for nut in [cold_pair(true), cold_pair(false), single] {
        let at = |nut: &BallNut| nut.solve(&Support::guided(900.0)).expect("carried").balls;
        assert_eq!(at(&nut), at(&nut.warmed([20.0; 3], 11.5e-6)));
    }
}

/// The contact lines of a free pair resist tilting much better in an O arrangement than in an X
/// arrangement.
#[test]
fn o_arrangement_is_stiffer_against_tilting_than_x_arrangement() {
    let tilt =
        |x: bool| cold_pair(x).solve(&Support::guided(0.0)).expect("at rest").stiffness[3][3];
    let ratio = tilt(false) / tilt(true);
    // In the reference solution, the tilt of a pair in O arrangement is one fifteenth of the tilt
    // of a pair in X arrangement.
    assert!((10.0..20.0).contains(&ratio), "{ratio}");
}

/// A ball leaves its flank if the radial gap is larger than the groove, or if a tilt presses balls
/// out of the groove. In an earlier version, such nuts had contact angles beyond 90 deg.
#[test]
fn a_ball_that_leaves_its_flank_is_rejected() {
    let mut nut = nut_with_98_balls();
    nut.errors.gap = 500e-6;
    let refused = nut.solve(&Support::guided(19e3)).expect_err("out of its groove");
    assert!(matches!(refused, NutError::BallLeavesFlank { angle, .. } if angle > 1.6), "{refused}");
    let tilted = prescribed_displacements([20e-6, 0.0, 0.0, 10e-3, 0.0]);
    assert!(matches!(nut_with_98_balls().solve(&tilted), Err(NutError::BallLeavesFlank { .. })));
}

/// The balls can be loaded on only one flank, and no flank supports the opposite load, so the nut
/// would move without limit.
#[test]
fn load_that_pulls_the_balls_off_their_only_flank_is_rejected() {
    let nut = with_circuits(vec![circuit(0.0, 1731.6, 98, Flanks::Plus)]);
    let refused = nut.solve(&Support::guided(-500.0));
    assert!(matches!(refused, Err(NutError::NothingCarries { .. })));
    let empty = with_circuits(Vec::new()).solve(&Support::guided(1.0));
    assert_eq!(empty.expect_err("no balls"), NutError::NoBalls);
}

/// A screw whose anchor is meters away from the nut elongates by more than the depth of a groove,
/// but it still carries its load.
#[test]
fn screw_that_elongates_by_more_than_the_groove_depth_carries_its_load() {
    let mut nut = nut_with_98_balls();
    nut.screw_bar = Some(Bar { stiffness: 219.7e6, anchor: 5.0 });
    let found = nut.solve(&Support::guided(100e3)).expect("carried");
    // The elongation F l/EA is 2.3 mm for a length of 5 m.
    assert!((2.2e-3..2.4e-3).contains(&found.displacement[0]), "{}", found.displacement[0]);
    let one_flank = BallNut { circuits: vec![circuit(0.0, 1731.6, 98, Flanks::Plus)], ..nut };
    let refused = one_flank.solve(&Support::guided(-500.0));
    assert!(matches!(refused, Err(NutError::NothingCarries { .. })));
}

/// If the nut is displaced far from the undeformed screw, the bodies deform. An earlier version of
/// the solver reported that no ball carries the load.
#[test]
fn large_prescribed_displacement_of_the_nut_is_taken_up_by_deformation_of_the_screw() {
    let mut nut = nut_with_98_balls();
    nut.screw_bar = Some(Bar { stiffness: 219.7e6, anchor: 5.0 });
    let loaded = nut.solve(&Support::guided(100e3)).expect("carried");
    let again = nut.solve(&prescribed_displacements(loaded.displacement)).expect("held");
    // The solver balances the forces to 1e-12 of their sum.
    assert_relative_eq!(again.carried[0], 100e3, max_relative = 1e-9);
}

/// A nut on soft guides behaves like a free nut, and a nut on stiff guides behaves like a rigidly
/// guided nut.
#[test]
fn soft_guides_act_like_no_guides_and_stiff_guides_like_rigid_guides() {
    let nut = nut_with_98_balls();
    let sprung = |stiffness: f64| {
        let mut support = Support::free(6340.0);
        for (i, freedom) in support.0.iter_mut().enumerate().skip(1) {
            let stiffness = if i < 3 { stiffness } else { stiffness * 1e-3 };
            *freedom = Freedom::Sprung { stiffness, load: 0.0 };
        }
        nut.solve(&support).expect("carried").concentration()
    };
    let free = nut.solve(&Support::free(6340.0)).expect("carried").concentration();
    // The guide stiffness is 1e-6 or 1e6 times the stiffness of the nut, which is 1e9 N/m.
    assert_relative_eq!(sprung(1e3), free, max_relative = 1e-4);
    assert_relative_eq!(sprung(1e15), 1.0, max_relative = 1e-4);
    let between = sprung(1e9);
    assert!(1.01 < between && between < free, "{between}");
}

/// If all balls are equally loaded, the total friction is the friction of one ball multiplied by
/// the number of balls. Without external load, the torque of a pair is caused by friction alone.
#[test]
fn friction_of_equally_loaded_balls_is_proportional_to_their_number() {
    let drive = Drive { screw_speed: 500.0 * PI / 30.0, nut_speed: 0.0 };
    let mut work = ModelWorkspace::default();
    let nut = with_circuits(vec![circuit(0.0, 1731.6, 98, Flanks::Plus)]);
    let found = nut.solve(&Support::guided(6340.0)).expect("carried");
    let mut rolling =
        |screw| Problem::RacewayControl(RacewayControl { screw, control: None }).solve(&mut work);
    let all = nut.friction(&found, FlankFriction::equal(0.06), &drive, 0.0, &mut rolling);
    // `solves` counts how many balls are solved. All balls carry the same load, so only one of them
    // is solved.
    let mut solves = 0;
    let counted = nut.friction(&found, FlankFriction::equal(0.06), &drive, 0.0, |screw| {
        solves += 1;
        rolling(screw)
    });
    assert_eq!((solves, &counted), (1, &all));
    let one = nut.ball_alone(&found, 0, 0.06, &drive).expect("one flank");
    let whole = bsm_dyn::ElasticPoint {
        point: bsm_dyn::OperatingPoint {
            load: bsm_dyn::Load { axial: 6340.0, balls: 98.0 },
            ..one.point
        },
        ..one
    };
    let single = rolling(whole);
    let expected = single.efficiency().expect("solved");
    // The ball loads are accurate to 1e-12, and the ball models converge to 1e-10.
    assert_relative_eq!(all.efficiency.expect("a load"), expected, max_relative = 1e-9);
    let heat = single.steady_state().expect("solved").transmission.power.expect("speed").dissipated;
    assert_relative_eq!(all.heat.expect("all balls"), heat, max_relative = 1e-7);

    let pair = pair();
    let support = Support::guided(0.0);
    let nut = pair.preloaded(PreloadKind::Offset, 11.722_956_420_2e-6);
    let found = nut.solve(&support).expect("at rest");
    let all = nut.friction(&found, FlankFriction::equal(0.06), &drive, 0.0, &mut rolling);
    assert_eq!(all.efficiency, None);
    let (drag, drive_torque) = (all.torque.expect("all"), all.drive_torque.expect("all"));
    // The torques h F of the two bodies cancel, except for rounding errors of forces of 3000 N.
    assert_relative_eq!(drag, drive_torque, max_relative = 1e-6);
    // For a dry friction coefficient of 0.06, K_p = T 2π/(F_p P_h) is 0.033. This value is known to
    // two digits.
    let factor = drag * TAU / (3000.0 * 10e-3);
    assert!((0.028..0.038).contains(&factor), "{factor}");
}

/// Oversize balls touch both flanks and cause a drag torque, which is integrated over four contact
/// ellipses per ball.
#[test]
fn oversize_balls_cause_a_drag_torque() {
    let tight = nut_with_98_balls().preloaded(PreloadKind::Oversize, 8e-6);
    let found = tight.solve(&Support::guided(0.0)).expect("at rest");
    let drag = |screw_speed: f64, friction: f64| {
        let drive = Drive { screw_speed, nut_speed: 0.0 };
        let unused = |_: bsm_dyn::ElasticPoint| unreachable!("all balls are on both flanks");
        let all = tight.friction(&found, FlankFriction::equal(friction), &drive, 0.0, unused);
        assert_eq!(all.balls_on_both_flanks, 98);
        all.torque.expect("all balls")
    };
    let torque = drag(50.0, 0.06);
    // Except for the influence of inertia and creep speed, the friction of a ball with four sliding
    // contacts is proportional to the friction coefficient.
    assert_relative_eq!(drag(50.0, 0.12), 2.0 * torque, max_relative = 1e-3);
    assert_relative_eq!(drag(-50.0, 0.06), torque, max_relative = 1e-3);
    // In a nut pair with the same preload as this nut with oversize balls, the balls roll instead
    // of sliding, and K_p is only 0.033.
    let preload = found.preload(&tight, PreloadKind::Oversize);
    let factor = torque * TAU / (preload * 10e-3);
    assert!((0.04..0.4).contains(&factor), "{factor}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    /// Shifting the nut along the screw by whole turns does not change the ball loads.
    #[test]
    fn shifting_the_nut_by_whole_turns_does_not_change_ball_loads(axial in 100.0..40e3_f64, side in -2e3..2e3_f64) {
        let load = Support([axial, side, 0.0, 0.0, 0.0].map(Freedom::Loaded));
        let here = nut_with_98_balls().solve(&load).expect("carried");
        let there = with_circuits(vec![circuit(720.0, 1731.6, 98, Flanks::Both)]);
        let there = there.solve(&load).expect("carried");
        // After a shift by two turns, helix angles have rounding errors of 1e-15 relative to their
        // value. The elastic approach is only 1e-4 of the radius, so the relative errors of the
        // loads are larger.
        prop_assert!((here.max_load() / there.max_load() - 1.0).abs() < 1e-9);
    }

    /// No ball load exceeds the bound (U27), regardless of manufacturing errors and elastic bars.
    #[test]
    fn no_ball_load_exceeds_its_upper_bound(
        axial in 500.0..40e3_f64,
        amplitude in 0.0..4e-6_f64,
        phase in 0.0..TAU,
        stiffness in 1e8..1e10_f64,
        opposite in any::<bool>(),
        scatter in prop::collection::vec(-1e-6..1e-6_f64, 98),
    ) {
        let mut nut = with_circuits(vec![circuit(0.0, 1731.6, 98, Flanks::Plus)]);
        nut.errors.balls = scatter;
        nut.errors.lead = vec![LeadError::Wave { amplitude, order: 1.0, phase }];
        nut.nut_bar = Some(Bar { stiffness, anchor: -0.005 });
        nut.screw_bar = Some(Bar { stiffness, anchor: if opposite { 0.06 } else { -0.005 } });
        let found = nut.solve(&Support::guided(axial)).expect("carried");
        let bound = nut.load_bound(axial).expect("a bound");
        // The bound (U27) is linear in the excess of the ball radius. This linearization causes an
        // error of up to 1 %.
        prop_assert!(found.max_load() <= 1.01 * bound, "{} {}", found.max_load(), bound);
    }

    /// A nut whose balls can be loaded on both flanks can carry any load. The solver balances the
    /// forces to 1e-12.
    #[test]
    fn nut_with_balls_in_contact_on_both_flanks_carries_loads_in_any_direction(
        load in prop::array::uniform5(-1.0..1.0_f64),
        size in -1.0..5.0_f64,
        gap in 0.0..20e-6_f64,
        oversize in -5e-6..5e-6_f64,
    ) {
        let mut nut = nut_with_98_balls();
        nut.errors.gap = gap;
        nut.errors.oversize = oversize;
        let size = 10f64.powf(size);
        let arms = [1.0, 1.0, 1.0, 0.02, 0.02];
        let support = Support(std::array::from_fn(|i| Freedom::Loaded(load[i] * size * arms[i])));
        let found = nut.solve(&support);
        prop_assert!(found.is_ok(), "{:?}", found.err());
        prop_assert!(found.is_ok_and(|found| found.residual <= 1e-12));
    }
}

/// In a single nut, the thermal expansion of the balls first reduces the play. The balls press
/// against both flanks only after the play is closed. After that, the preload equals the preload of
/// a nut whose balls are oversize by the remaining expansion.
#[test]
fn thermal_expansion_of_balls_takes_up_the_play_first() {
    let rises = [0.0, 0.0, 10.0];
    // The expansion of the ball radius is Δr = r_b α_T ΔT, and `taken` is the play that this
    // expansion closes.
    let growth = nut_with_98_balls().ball.radius * 11.5e-6 * 10.0;
    let taken = 4.0 * growth
        / (nut_with_98_balls().contact_angle.sin() * nut_with_98_balls().helix.lead_angle.cos());
    let preload = |play: Option<f64>| {
        let mut nut = nut_with_98_balls();
        nut.errors.axial_play = play;
        let warm = nut.warmed(rises, 11.5e-6);
        let found = warm.solve(&Support::guided(0.0)).expect("at rest");
        (found.preload(&warm, PreloadKind::Oversize), warm.errors)
    };
    for play in [None, Some(1.001 * taken)] {
        assert!(preload(play).0.abs() <= 0.0, "{play:?}");
    }
    let (_, errors) = preload(Some(3.0 * taken));
    // The tolerance is the rounding error of a difference between two values of play.
    assert_relative_eq!(errors.axial_play.expect("a play"), 2.0 * taken, max_relative = 1e-12);
    let (half, _) = preload(Some(0.5 * taken));
    let oversize = nut_with_98_balls().preloaded(PreloadKind::Oversize, growth);
    let found = oversize.solve(&Support::guided(0.0)).expect("at rest");
    let expected = found.preload(&oversize, PreloadKind::Oversize);
    // The tolerance is larger than the residual of the solver, which is 1e-12 of the loads.
    assert!(expected > 0.0);
    assert_relative_eq!(half, expected, max_relative = 1e-9);
}
