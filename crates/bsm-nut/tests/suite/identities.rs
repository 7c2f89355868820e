//! Limits, identities and expected errors of the nut.

use crate::nuts;

use std::f64::consts::{PI, TAU};

use approx::assert_relative_eq;
use bsm_dyn::{Ball, Material, ModelWorkspace, Problem, model::RacewayControl};
use bsm_kin::{Drive, Helix};
use bsm_nut::{
    BallNut, Bar, Circuit, Errors, FlankFriction, Flanks, Freedom, LeadError, NutError,
    PreloadKind, Ring, Support,
};
use nuts::with_circuits;
use proptest::prelude::*;

fn circuit(start_deg: f64, arc_deg: f64, balls: usize, flanks: Flanks) -> Circuit {
    let (start, arc) = (start_deg.to_radians(), arc_deg.to_radians());
    Circuit { start, arc, balls, thread: 0, body: 0, flanks, offset: 0.0 }
}

/// Returns a nut with 98 balls on 4.81 turns and both flanks.
fn nut_a() -> BallNut {
    with_circuits(vec![circuit(0.0, 1731.6, 98, Flanks::Both)])
}

/// Returns two nut bodies pressed against each other, without offset.
fn pair() -> BallNut {
    let second = Circuit { body: 1, ..circuit(1440.0, 1080.0, 60, Flanks::Minus) };
    with_circuits(vec![circuit(0.0, 1080.0, 60, Flanks::Plus), second])
}

/// Returns a support that prescribes all displacements.
fn prescribed_displacements(at: [f64; 5]) -> Support {
    Support(at.map(Freedom::Held))
}

/// In a rigid, guided nut every ball carries an equal share, which the closed form gives.
#[test]
fn a_guided_rigid_nut_shares_equally() {
    let nut = nut_a();
    let equal = nut.equal(6340.0).expect("load");
    let found = nut.solve(&Support::guided(6340.0)).expect("load");
    for ball in &found.balls {
        // Both searches end at a balance of forces to 1e-12.
        assert_relative_eq!(ball.max_load(), equal.load, max_relative = 1e-11);
    }
    assert_relative_eq!(found.stiffness[0][0], equal.stiffness, max_relative = 1e-11);
    // The search starts from this solution.
    assert!(found.steps <= 1, "{}", found.steps);
    assert!(!nut.shares_equally(&Support::free(6340.0)));
    let one_flank = with_circuits(vec![circuit(0.0, 1731.6, 98, Flanks::Plus)]);
    assert!(one_flank.shares_equally(&Support::guided(6340.0)));
}

/// The stiffness is the slope of the forces under prescribed displacements, with all bodies.
#[test]
fn stiffness_is_the_slope_of_the_forces() {
    let mut nut = nut_a();
    nut.nut_bar = Some(Bar { stiffness: 453e6, anchor: -0.01 });
    nut.screw_bar = Some(Bar { stiffness: 219.7e6, anchor: 0.07 });
    nut.ring = Some(Ring { outer: 70e-3, inner: 45.826e-3, youngs_modulus: 206e9 });
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
            // The tolerance allows for rounding of forces of 1e4 N over steps of a nanometer and
            // for the third derivative.
            let allowed = 1e-6 * size;
            assert!((slope - found.stiffness[i][k]).abs() < allowed, "{i} {k}");
        }
    }
}

/// The forces carry the load up to rounding, and the stiffness matrix is symmetric.
#[test]
fn forces_add_up_to_the_load() {
    let load = [8000.0, 300.0, -500.0, 20.0, 40.0];
    let found = nut_a().solve(&Support(load.map(Freedom::Loaded))).expect("carried");
    for (carried, load) in found.carried.iter().zip(load) {
        // The iteration ends at 1e-12 of the sum of all forces.
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

/// With stiff bars, the load decreases from the anchors according to the first-order theory of the
/// chain.
#[test]
fn stiff_bars_of_one_side_raise_the_first_ball() {
    let mut nut = nut_a();
    let positions = nut.positions();
    let (first, last) = (positions[0].z, positions[positions.len() - 1].z);
    let equal = nut.equal(10e3).expect("load");
    let stiffness = 2e11;
    for bar in [&mut nut.nut_bar, &mut nut.screw_bar] {
        *bar = Some(Bar { stiffness, anchor: first });
    }
    let found = nut.solve(&Support::guided(10e3)).expect("carried");
    // μ² l² = k_u l (1/EA_n + 1/EA_s), max/mean = 1 + (μl)²/3. The next order and the spacing of a
    // hundred balls contribute 1e-3 of this increase.
    let small = equal.stiffness * (last - first) * 2.0 / stiffness;
    let axial = |i: usize| found.balls[i].force[0];
    let mean = (0..98).map(axial).sum::<f64>() / 98.0;
    assert_relative_eq!(axial(0) / mean - 1.0, small / 3.0, max_relative = 0.03);
}

/// The radial components of the forces in a free nut cause a moment, which a tilt must balance.
#[test]
fn a_free_nut_tilts_under_a_central_load() {
    let found = nut_a().solve(&Support::free(6340.0)).expect("carried");
    // An independent solution prints max/mean = 1.2536 at a tenth of the rating.
    assert_relative_eq!(found.concentration(), 1.2536, epsilon = 6e-5);
    let tilt = found.displacement[3].hypot(found.displacement[4]);
    assert!((14e-6..220e-6).contains(&tilt), "{tilt:e}");
}

/// Load concentrations agree with an independent implementation to the printed digits.
#[test]
fn load_concentrations_match_an_independent_solution() {
    let stacked = |i: i32| circuit(360.0 * f64::from(i), 330.0, 19, Flanks::Both);
    let returns = with_circuits((0..5).map(stacked).collect());
    let mut bars = nut_a();
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

/// Torsion of the screw increases its compliance by 4 (1 + ν) (h/r)², according to the closed form
/// for a solid shaft.
#[test]
fn torsion_reduces_the_stiffness_of_the_screw() {
    let nut = nut_a();
    let ratio = nut.screw_stiffness(false) / nut.screw_stiffness(true);
    let radius = 0.5 * nut.groove_diameters()[0];
    let per_radian = nut.helix.lead() / TAU;
    // The values differ by rounding only.
    assert_relative_eq!(ratio, 1.0 + 5.2 * (per_radian / radius).powi(2), max_relative = 1e-14);
    assert!((1.03..1.05).contains(&ratio), "{ratio}");
}

/// A deep-groove ball bearing, modeled as a nut with zero lead, agrees with a commercial program
/// for ISO/TS 16281.
#[test]
fn a_nut_of_zero_lead_is_a_ball_bearing() {
    let radius = 5.75e-3;
    let steel = Material { youngs_modulus: 210e9, poisson_ratio: 0.3 };
    let bearing = |gap: f64| BallNut {
        helix: Helix { radius: 21.75e-3, lead_angle: 0.0 },
        ball: Ball { radius, mass: 4.0 / 3.0 * PI * radius.powi(3) * 7800.0 },
        contact_angle: 0.0,
        conformity: (0.53, 0.52),
        material: (steel, steel),
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
    // The values are published with five or six digits.
    assert_relative_eq!(-at(0.0, force, radial)[1], 15.1101e-6, max_relative = 1e-5);
    assert_relative_eq!(-at(5e-6, force, radial)[1], 21.223e-6, max_relative = 1e-5);
    let axial = [1000.0, 0.0, 0.0, 0.0, 0.0];
    let found = at(0.0, axial, [true, false, false, false, false])[0];
    assert_relative_eq!(found, 133.5381e-6, max_relative = 1e-5);
}

/// In the limit of zero preload, the limit load is 2√2 times the preload, and the stiffness is 3
/// F_p/δ_p.
#[test]
fn limit_load_and_stiffness_of_small_preloads_follow_hertz() {
    let pair = pair();
    let support = Support::guided(0.0);
    let force = 1.0;
    let offset = pair.preload_displacement(PreloadKind::Offset, force, &support).expect("reached");
    let nut = pair.preloaded(PreloadKind::Offset, offset);
    let found = nut.solve(&support).expect("at rest");
    // The root is found to 1e-13 of the offset.
    assert_relative_eq!(found.preload(&nut, PreloadKind::Offset), force, max_relative = 1e-9);
    // Contact angles change by 2e-4 under one newton.
    let stiffness = 3.0 * force / (0.5 * offset);
    assert_relative_eq!(found.stiffness[0][0], stiffness, max_relative = 1e-3);
    let limit = nut.limit_load(PreloadKind::Offset, &support, 1.0).expect("a limit");
    assert_relative_eq!(limit, 8.0_f64.sqrt() * force, max_relative = 1e-3);
    let other = nut.limit_load(PreloadKind::Offset, &support, -1.0).expect("a limit");
    assert_relative_eq!(other, -limit, max_relative = 1e-6);
}

/// The displacement that causes a given preload is found for a pair and for oversize balls.
#[test]
fn displacement_of_a_given_preload_is_found() {
    let pair = pair();
    let support = Support::guided(0.0);
    let offset = pair.preload_displacement(PreloadKind::Offset, 3000.0, &support).expect("reached");
    // The reference value is 11.7229564202 um.
    assert_relative_eq!(offset, 11.722_956_420_2e-6, max_relative = 1e-10);
    let single = nut_a();
    let found =
        single.preload_displacement(PreloadKind::Oversize, 2000.0, &support).expect("reached");
    let tight = single.preloaded(PreloadKind::Oversize, found);
    let at_rest = tight.solve(&support).expect("at rest");
    assert_relative_eq!(
        at_rest.preload(&tight, PreloadKind::Oversize),
        2000.0,
        max_relative = 1e-9
    );
    // At rest, both flanks of every ball carry the same load.
    let ball = at_rest.balls[17];
    assert_relative_eq!(ball.loads[0], ball.loads[1], max_relative = 1e-9);
}

/// Returns a pair with nut bodies pressed against each other by 2500 N without temperature rise, in
/// X or O arrangement.
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
        conformity: (0.53, 0.53),
        material: (steel, steel),
        ..with_circuits(vec![of_body(0.0, 0, first), of_body(1440.0, 1, second)])
    };
    let force = if x { 2500.0 } else { -2500.0 };
    let offset = nut.preload_displacement(PreloadKind::Offset, force, &Support::guided(0.0));
    let offset = offset.expect("a preload");
    // The reference value is ∓11.784697 um, printed with eight digits.
    assert_relative_eq!(offset, force.signum() * 11.784_697e-6, max_relative = 1e-7);
    nut.preloaded(PreloadKind::Offset, offset)
}

/// A preload force used to be set again in the warm nut, and a uniformly warm nut lost its preload
/// by growth. The reference values come from an independent solution with ten digits.
#[test]
fn a_preload_is_set_cold_and_changes_with_the_temperatures() {
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
            // The preload is found to 1e-13 of the offset. The tolerance allows for the printed
            // digits.
            assert_relative_eq!(left, expected, max_relative = 2e-9);
        }
    }
}

/// A uniform temperature of nut, screw and balls does not change the fit, in any arrangement, with
/// oversize balls and bars.
#[test]
fn a_uniform_temperature_rise_does_not_change_the_ball_loads() {
    let mut single = nut_a().preloaded(PreloadKind::Oversize, 8e-6);
    single.nut_bar = Some(Bar { stiffness: 453e6, anchor: 0.0 });
    for nut in [cold_pair(true), cold_pair(false), single] {
        let at = |nut: &BallNut| nut.solve(&Support::guided(900.0)).expect("carried").balls;
        assert_eq!(at(&nut), at(&nut.warmed([20.0; 3], 11.5e-6)));
    }
}

/// In an O arrangement, the contact lines of a free pair resist tilting much better than in an X
/// arrangement.
#[test]
fn a_pair_pushed_apart_is_stiffer_against_tilt() {
    let tilt =
        |x: bool| cold_pair(x).solve(&Support::guided(0.0)).expect("at rest").stiffness[3][3];
    let ratio = tilt(false) / tilt(true);
    // The reference states that one tilt is a fifteenth of the other.
    assert!((10.0..20.0).contains(&ratio), "{ratio}");
}

/// A play larger than the groove, or a load that presses the balls out of the groove, used to give
/// contact angles beyond 90 deg.
#[test]
fn a_ball_that_leaves_its_flank_is_rejected() {
    let mut nut = nut_a();
    nut.errors.gap = 500e-6;
    let refused = nut.solve(&Support::guided(19e3)).expect_err("out of its groove");
    assert!(matches!(refused, NutError::BallLeavesFlank { angle, .. } if angle > 1.6), "{refused}");
    let tilted = prescribed_displacements([20e-6, 0.0, 0.0, 10e-3, 0.0]);
    assert!(matches!(nut_a().solve(&tilted), Err(NutError::BallLeavesFlank { .. })));
}

/// A load in the direction away from the only flank would move the nut without limit, so it is
/// rejected.
#[test]
fn a_load_away_from_the_only_flank_is_rejected() {
    let nut = with_circuits(vec![circuit(0.0, 1731.6, 98, Flanks::Plus)]);
    let refused = nut.solve(&Support::guided(-500.0));
    assert!(matches!(refused, Err(NutError::NothingCarries { .. })));
    let empty = with_circuits(Vec::new()).solve(&Support::guided(1.0));
    assert_eq!(empty.expect_err("no balls"), NutError::NoBalls);
}

/// A screw whose anchor is meters away deforms by more than the depth of a groove, but still
/// carries its load.
#[test]
fn a_long_screw_deforms_but_carries_its_load() {
    let mut nut = nut_a();
    nut.screw_bar = Some(Bar { stiffness: 219.7e6, anchor: 5.0 });
    let found = nut.solve(&Support::guided(100e3)).expect("carried");
    // F l/EA is 2.3 mm for 5 m.
    assert!((2.2e-3..2.4e-3).contains(&found.displacement[0]), "{}", found.displacement[0]);
    let one_flank = BallNut { circuits: vec![circuit(0.0, 1731.6, 98, Flanks::Plus)], ..nut };
    let refused = one_flank.solve(&Support::guided(-500.0));
    assert!(matches!(refused, Err(NutError::NothingCarries { .. })));
}

/// A prescribed nut displacement far from the screw deforms the bodies. The message used to say
/// that nothing carries the load.
#[test]
fn a_large_prescribed_displacement_deforms_the_bodies() {
    let mut nut = nut_a();
    nut.screw_bar = Some(Bar { stiffness: 219.7e6, anchor: 5.0 });
    let loaded = nut.solve(&Support::guided(100e3)).expect("carried");
    let again = nut.solve(&prescribed_displacements(loaded.displacement)).expect("held");
    // Forces balance to 1e-12 of their sum.
    assert_relative_eq!(again.carried[0], 100e3, max_relative = 1e-9);
}

/// A soft guide acts like a free nut, and a stiff guide like a guided nut.
#[test]
fn guide_springs_range_from_free_to_guided() {
    let nut = nut_a();
    let sprung = |stiffness: f64| {
        let mut support = Support::free(6340.0);
        for (i, freedom) in support.0.iter_mut().enumerate().skip(1) {
            let stiffness = if i < 3 { stiffness } else { stiffness * 1e-3 };
            *freedom = Freedom::Sprung { stiffness, load: 0.0 };
        }
        nut.solve(&support).expect("carried").concentration()
    };
    let free = nut.solve(&Support::free(6340.0)).expect("carried").concentration();
    // The guide stiffness is 1e-6 or 1e6 times the stiffness of the nut, 1e9 N/m.
    assert_relative_eq!(sprung(1e3), free, max_relative = 1e-4);
    assert_relative_eq!(sprung(1e15), 1.0, max_relative = 1e-4);
    let between = sprung(1e9);
    assert!(1.01 < between && between < free, "{between}");
}

/// The friction of equal balls is the friction of one ball times their number. A pair without
/// external load has a drag due to friction alone.
#[test]
fn friction_of_equal_balls_adds_up() {
    let drive = Drive { screw_speed: 500.0 * PI / 30.0, nut_speed: 0.0 };
    let mut work = ModelWorkspace::default();
    let nut = with_circuits(vec![circuit(0.0, 1731.6, 98, Flanks::Plus)]);
    let found = nut.solve(&Support::guided(6340.0)).expect("carried");
    let mut rolling = |screw| {
        Problem::RacewayControl(RacewayControl { at: screw, control: None }).solve(&mut work)
    };
    let all = nut.friction(&found, FlankFriction::equal(0.06), &drive, 0.0, &mut rolling);
    // Equal balls are solved once.
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
    // The share of a ball is found to 1e-12 of the load, and the models converge to 1e-10.
    assert_relative_eq!(all.efficiency.expect("a load"), expected, max_relative = 1e-9);
    let heat = single.solved().expect("solved").transmission.power.expect("speed").dissipated;
    assert_relative_eq!(all.heat.expect("all balls"), heat, max_relative = 1e-7);

    let pair = pair();
    let support = Support::guided(0.0);
    let nut = pair.preloaded(PreloadKind::Offset, 11.722_956_420_2e-6);
    let found = nut.solve(&support).expect("at rest");
    let all = nut.friction(&found, FlankFriction::equal(0.06), &drive, 0.0, &mut rolling);
    assert_eq!(all.efficiency, None);
    let (drag, drive_torque) = (all.torque.expect("all"), all.drive_torque.expect("all"));
    // The terms h F of the two bodies cancel to the rounding of 3000 N.
    assert_relative_eq!(drag, drive_torque, max_relative = 1e-6);
    // K_p = T 2π/(F_p P_h): a dry friction coefficient of 0.06 gives 0.033 (spec 11.8, two digits).
    let factor = drag * TAU / (3000.0 * 10e-3);
    assert!((0.028..0.038).contains(&factor), "{factor}");
}

/// Oversize balls on both flanks cause a drag. Their friction is integrated over four ellipses.
#[test]
fn oversize_balls_cause_a_drag_torque() {
    let tight = nut_a().preloaded(PreloadKind::Oversize, 8e-6);
    let found = tight.solve(&Support::guided(0.0)).expect("at rest");
    let drag = |screw_speed: f64, friction: f64| {
        let drive = Drive { screw_speed, nut_speed: 0.0 };
        let unused = |_: bsm_dyn::ElasticPoint| unreachable!("all balls are on both flanks");
        let all = tight.friction(&found, FlankFriction::equal(friction), &drive, 0.0, unused);
        assert_eq!(all.on_both_flanks, 98);
        all.torque.expect("all balls")
    };
    let torque = drag(50.0, 0.06);
    // Apart from the effects of inertia and creep speed, the sliding friction of a ball with four
    // contacts is proportional to the friction coefficient.
    assert_relative_eq!(drag(50.0, 0.12), 2.0 * torque, max_relative = 1e-3);
    assert_relative_eq!(drag(-50.0, 0.06), torque, max_relative = 1e-3);
    // The drag is larger than the drag of a pair with the same preload, whose balls roll with a K_p
    // of 0.033.
    let preload = found.preload(&tight, PreloadKind::Oversize);
    let factor = torque * TAU / (preload * 10e-3);
    assert!((0.04..0.4).contains(&factor), "{factor}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    /// A shift by whole turns along the screw does not change the loads.
    #[test]
    fn a_shift_by_whole_turns_does_not_change_the_loads(axial in 100.0..40e3_f64, side in -2e3..2e3_f64) {
        let load = Support([axial, side, 0.0, 0.0, 0.0].map(Freedom::Loaded));
        let here = nut_a().solve(&load).expect("carried");
        let there = with_circuits(vec![circuit(720.0, 1731.6, 98, Flanks::Both)]);
        let there = there.solve(&load).expect("carried");
        // Angles of two turns are rounded to 1e-15, and approaches are 1e-4 of the radius.
        prop_assert!((here.max_load() / there.max_load() - 1.0).abs() < 1e-9);
    }

    /// No ball carries more than the bound, whatever the errors and the bars are.
    #[test]
    fn no_ball_carries_more_than_the_bound(
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
        // (U27) is of first order in the excess of the balls, with an error of 1 %.
        prop_assert!(found.max_load() <= 1.01 * bound, "{} {}", found.max_load(), bound);
    }

    /// A nut with both flanks carries any load. The forces balance to 1e-12.
    #[test]
    fn every_load_is_carried(
        load in prop::array::uniform5(-1.0..1.0_f64),
        size in -1.0..5.0_f64,
        gap in 0.0..20e-6_f64,
        oversize in -5e-6..5e-6_f64,
    ) {
        let mut nut = nut_a();
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

/// Warm balls take up the play of a single nut, and press on both flanks only if they close it. At
/// this point, a nut without oversize has the preload of balls with the remaining excess.
#[test]
fn warm_balls_of_a_single_nut_grow_into_its_play() {
    let rises = [0.0, 0.0, 10.0];
    // Δr = r_b α_T ΔT, and the play that it takes up
    let growth = nut_a().ball.radius * 11.5e-6 * 10.0;
    let taken = 4.0 * growth / (nut_a().contact_angle.sin() * nut_a().helix.lead_angle.cos());
    let preload = |play: Option<f64>| {
        let mut nut = nut_a();
        nut.errors.axial_play = play;
        let warm = nut.warmed(rises, 11.5e-6);
        let found = warm.solve(&Support::guided(0.0)).expect("at rest");
        (found.preload(&warm, PreloadKind::Oversize), warm.errors)
    };
    for play in [None, Some(1.001 * taken)] {
        assert!(preload(play).0.abs() <= 0.0, "{play:?}");
    }
    let (_, errors) = preload(Some(3.0 * taken));
    // Relative rounding error of a difference of two plays.
    assert_relative_eq!(errors.axial_play.expect("a play"), 2.0 * taken, max_relative = 1e-12);
    let (half, _) = preload(Some(0.5 * taken));
    let oversize = nut_a().preloaded(PreloadKind::Oversize, growth);
    let found = oversize.solve(&Support::guided(0.0)).expect("at rest");
    let expected = found.preload(&oversize, PreloadKind::Oversize);
    // The solver finds equilibria to 1e-12 of the loads.
    assert!(expected > 0.0);
    assert_relative_eq!(half, expected, max_relative = 1e-9);
}
