//! Tests of balls in gothic arches whose force balance includes friction, and tests of preloaded
//! pairs: reference cases, limiting cases and random operating points.

use std::f64::consts::PI;

use bsm_dyn::{
    Ball, Conformities, Coulomb, ElasticPoint, Load, Material, Materials, ModelWorkspace,
    OperatingPoint, Problem,
    gothic::{
        ArchFit, AxialCondition, FLANKS, GothicBall, GothicPair, GothicState, GothicWorkspace,
    },
    model::{Traction, TractionWorkspace},
};
use bsm_kin::{Drive, Helix, Site};
use bsm_nut::friction::FlankFriction;
use bsm_nut::{Circuit, Flanks, Freedom, Support};
use bsm_sample::{Sample, campaign};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::Value;

use crate::nuts::with_circuits;
use crate::public::number;

const CASES: &str = include_str!("../../../../validation/published/nut/third_contact.json");
const STUDY: &str = include_str!("../../../../validation/published/nut/third_contact_study.csv");
const DEG: f64 = PI / 180.0;
const RPM: f64 = PI / 30.0;

/// A screw with a single ball, in the units of the reference cases.
#[derive(Clone, Copy)]
struct Scene {
    ball: f64,
    pitch: f64,
    lead: f64,
    angle: f64,
    conformity: Conformities,
    friction: f64,
    density: f64,
    modulus: f64,
    rpm: (f64, f64),
    fit: ArchFit,
}

impl Scene {
    fn from_reference(case: &Value) -> Self {
        let get = |key: &str| number(case, key);
        let given = |key: &str| get(key).unwrap_or_else(|| panic!("{key}"));
        Self {
            ball: given("ball_diameter_mm"),
            pitch: given("pitch_circle_diameter_mm"),
            lead: given("lead_mm"),
            angle: given("contact_angle_deg"),
            conformity: Conformities {
                nut: given("nut_conformity"),
                screw: given("screw_conformity"),
            },
            friction: given("friction_coefficient"),
            density: given("density_kg_m3"),
            modulus: given("youngs_modulus_GPa"),
            rpm: (given("screw_speed_rpm"), given("nut_speed_rpm")),
            fit: ArchFit {
                axial_play: get("axial_play_um").unwrap_or(0.0) * 1e-6,
                radial_gap: 0.0,
                // The reference cases state the oversize as a difference in ball diameter, but the
                // nut model needs the difference in ball radius.
                oversize: 0.5e-6 * get("ball_oversize_um").unwrap_or(0.0),
            },
        }
    }

    /// Returns the screw that was used in an independent study of third contacts.
    fn from_study(friction: f64, play_um: f64) -> Self {
        Self {
            ball: 6.35,
            pitch: 41.5,
            lead: 10.0,
            angle: 45.0,
            conformity: Conformities::alike(0.53),
            friction,
            density: 7800.0,
            modulus: 207.0,
            rpm: (100.0, 0.0),
            fit: ArchFit { axial_play: play_um * 1e-6, ..ArchFit::default() },
        }
    }

    fn at(&self, axial: f64) -> ElasticPoint {
        let steel = Material { youngs_modulus: self.modulus * 1e9, poisson_ratio: 0.3 };
        let helix = Helix {
            radius: 0.5e-3 * self.pitch,
            lead_angle: (self.lead / (PI * self.pitch)).atan(),
        };
        ElasticPoint {
            point: OperatingPoint {
                helix,
                contact_angle: self.angle * DEG,
                ball: Ball::of_density(0.5e-3 * self.ball, self.density),
                friction: Coulomb(self.friction),
                drive: Drive { screw_speed: self.rpm.0 * RPM, nut_speed: self.rpm.1 * RPM },
                load: Load { axial, balls: 1.0 },
            },
            conformity: self.conformity,
            material: Materials::alike(steel),
        }
    }

    fn gothic(&self) -> GothicBall {
        let (at, fit) = (self.at(1.0), self.fit);
        let far_friction = at.point.friction;
        GothicBall { screw: at, fit, far_friction, accuracy: 1e-8, creep: Traction::<f64>::CREEP }
    }

    fn solve(&self, condition: AxialCondition) -> GothicState {
        self.gothic()
            .solve(condition, None, &mut GothicWorkspace::default())
            .unwrap_or_else(|why| panic!("{why:?}"))
    }

    fn lead_m(&self) -> f64 {
        self.lead * 1e-3
    }
}

/// Checks that two numbers agree. The permitted difference is `tolerance` multiplied by `size`.
#[track_caller]
fn assert_near(name: &str, found: f64, expected: f64, tolerance: f64, size: f64) {
    let error = (found - expected).abs();
    assert!(
        error <= tolerance * size.abs(),
        "{name}: {found:e}, expected {expected:e}, off {error:e}"
    );
}

/// Compares a ball with the reference, using the tolerances that the reference states: for loads,
/// 1e-6 of the largest load; for angles, 1e-5 degrees; for torque, power and speeds, a relative
/// error of 1e-6; for displacements, 1e-5 um.
fn compare_with_reference(name: &str, found: &GothicState, expect: &Value, axis: f64) {
    let loads = found.loads();
    let largest = loads.into_iter().fold(0.0, f64::max);
    let flanks = ["nut_plus", "nut_minus", "screw_plus", "screw_minus"];
    for (i, flank) in flanks.iter().enumerate() {
        let load = number(expect, &format!("{flank}_N")).expect("load");
        assert_near(&format!("{name} {flank}_N"), loads[i], load, 1e-6, largest);
        match (number(expect, &format!("{flank}_deg")), &found.contacts[i]) {
            (Some(angle), Some(contact)) => {
                assert_near(
                    &format!("{name} {flank}_deg"),
                    contact.state.angle / DEG,
                    angle,
                    1e-5,
                    1.0,
                );
            }
            (None, None) => {}
            (angle, contact) => panic!("{name} {flank}: {angle:?} {contact:?}"),
        }
    }
    let scalars = [
        ("axial_force_N", found.axial_force, 1e-6, largest),
        ("axial_displacement_um", found.axial_displacement * 1e6, 1e-5, 1.0),
        ("first_touch_um", found.first_touch * 1e6, 1e-5, 1.0),
        ("screw_torque_Nm", found.screw_torque, 1e-6, found.screw_torque),
        ("dissipated_power_W", found.friction_power(), 1e-6, found.friction_power()),
        ("ball_precession_rad_s", found.motion.precession, 1e-6, found.motion.precession),
        ("ball_omega_t_rad_s", found.motion.omega.x, 1e-6, axis),
        ("ball_omega_n_rad_s", found.motion.omega.y, 1e-6, axis),
        ("ball_omega_b_rad_s", found.motion.omega.z, 1e-6, axis),
    ];
    for (key, value, tolerance, size) in scalars {
        if let Some(expected) = number(expect, key) {
            assert_near(&format!("{name} {key}"), value, expected, tolerance, size);
        }
    }
    if let Some(expected) = number(expect, "efficiency") {
        assert_near(
            &format!("{name} efficiency"),
            found.efficiency.expect("loaded"),
            expected,
            1e-6,
            1.0,
        );
    }
    let third = found.far_contact().filter(|_| found.contacts.iter().flatten().count() == 3);
    assert_eq!(third.is_some(), expect["third_contact"].is_string(), "{name} {third:?}");
    if let Some(third) = third {
        let body = if third.site == Site::Nut { "nut_minus" } else { "screw_minus" };
        assert!(expect["third_contact"] == body, "{name} {third:?}");
        let flank = if third.site == Site::Nut { 1 } else { 3 };
        let contact = found.contacts[flank].expect("a pressed contact").state;
        // The reference contains only the slip component along the groove.
        let along = third.slip * contact.slip_angle.expect("a direction").sin().abs();
        for (key, value) in [
            ("third_contact_load_ratio", third.load / largest),
            ("third_contact_slip_m_s", along),
            ("third_contact_power_share", third.power_share),
        ] {
            // The ratio of two loads has the same relative tolerance as a load.
            let expected = number(expect, key).expect("number");
            assert_near(&format!("{name} {key}"), value, expected, 1e-6, 1.0);
        }
    }
}

fn reference_cases(kind: &str) -> Vec<Value> {
    let cases: Vec<Value> = serde_json::from_str(CASES).expect("JSON");
    assert_eq!(cases.len(), 10);
    cases.into_iter().filter(|case| case["kind"] == kind).collect()
}

#[test]
fn reference_balls_have_the_expected_third_contacts() {
    for case in reference_cases("ball") {
        let name = case["name"].as_str().expect("name");
        let scene = Scene::from_reference(&case["case"]);
        let condition = if let Some(load) = number(&case["case"], "axial_load_N") {
            AxialCondition::Force(load)
        } else {
            let um = number(&case["case"], "axial_displacement_um").expect("a displacement");
            AxialCondition::Displacement(um * 1e-6)
        };
        let found = scene.solve(condition);
        let turning = found.motion.omega.norm();
        compare_with_reference(name, &found, &case["expect"], turning);
        // The solver balances the forces to 1e-10 of the friction force.
        assert!(found.power_balance.abs() <= 1e-9, "{name} {}", found.power_balance);
    }
}

/// A ball that does not touch its far flanks has the same solution as in the `traction` model. Both
/// models balance the forces to 1e-10 of the friction force.
#[test]
fn ball_with_large_play_matches_the_traction_model() {
    let mut rng = ChaCha8Rng::seed_from_u64(68);
    let work = &mut GothicWorkspace::default();
    let mut traction_work = TractionWorkspace::default();
    for _ in 0..20 {
        let (scene, load) = random_scene(&mut rng);
        let scene = Scene { fit: ArchFit::WIDE, ..scene };
        let ball = scene.gothic();
        let traction =
            Traction { screw: scene.at(load), accuracy: ball.accuracy, creep: ball.creep };
        let solution = traction.solve(&mut traction_work);
        let solved = solution.steady_state().expect("a ball on two contacts");
        let found = ball.solve(AxialCondition::Force(load), None, work).expect("a ball");
        assert!(!found.far_flank_carries(), "{:?}", found.approaches);
        let (torque, loads) = (solved.transmission.screw_torque.expect("torque"), found.loads());
        assert_near("torque", found.screw_torque, torque, 2e-8, torque);
        let load = solved.ball.nut.load.expect("load");
        assert_near("load", loads[0], load, 2e-8, load);
        let axial = solved.ball.axial_displacement.expect("elastic");
        assert_near(
            "displacement",
            found.axial_displacement - found.first_touch,
            axial,
            1e-7,
            axial,
        );
    }
}

/// Returns a random screw and a random axial load. Ball diameter, speed and dimensions of the screw
/// are in the practical range.
fn random_scene(rng: &mut ChaCha8Rng) -> (Scene, f64) {
    let ball = rng.log_uniform(2.0, 12.0);
    let pitch = ball * rng.random_range(4.0..9.0);
    let sign = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
    let rpm = sign * rng.log_uniform(1.0, 5000.0);
    let scene = Scene {
        ball,
        pitch,
        lead: pitch * PI * rng.random_range(2.0_f64..20.0).to_radians().tan(),
        angle: rng.random_range(38.0..55.0),
        conformity: Conformities {
            nut: rng.random_range(0.515..0.55),
            screw: rng.random_range(0.515..0.55),
        },
        friction: rng.log_uniform(0.01, 0.2),
        density: 7800.0,
        modulus: 207.0,
        rpm: if rng.random_bool(0.7) { (rpm, 0.0) } else { (0.0, -rpm) },
        fit: ArchFit::default(),
    };
    // A load of 0.1 to 25 N/mm² times the square of the ball diameter causes contact pressures of
    // up to 3 GPa.
    (scene, rng.log_uniform(0.1, 25.0) * ball * ball)
}

/// Returns a random fit of a ball in its gothic arches: no play, an oversize ball, a radial gap, or
/// an axial play.
fn random_fit(rng: &mut ChaCha8Rng, ball: f64) -> ArchFit {
    let (mut fit, um) = (ArchFit::default(), 1e-6 * ball);
    match rng.random_range(0..5) {
        0 => {}
        1 => fit.oversize = um * rng.random_range(0.02..0.5),
        2 => fit.radial_gap = um * rng.random_range(0.1..3.0),
        _ => fit.axial_play = um * rng.log_uniform(0.1, 10.0),
    }
    fit
}

/// The random balls have axial play, no play, a radial gap or oversize, and their screws turn at 1
/// to 5000 rpm. For each ball, the solver converges, and the solution satisfies the power balance
/// and carries the axial force. If the screw is turned end for end, the loads on the two flanks are
/// exchanged.
#[test]
fn random_ball_solutions_satisfy_power_balance_and_mirror_symmetry() {
    let mut rng = ChaCha8Rng::seed_from_u64(23);
    let work = &mut GothicWorkspace::default();
    let (mut contacts, mut held, mut refused, mut skidding) = ([0; FLANKS + 1], 0, 0, 0);
    let (mut most_steps, mut most_imbalance) = (0, 0.0_f64);
    for number in 0..campaign(5000) {
        let (scene, load) = random_scene(&mut rng);
        let scene = Scene { fit: random_fit(&mut rng, scene.ball), ..scene };
        let found = scene
            .gothic()
            .solve(AxialCondition::Force(load), None, work)
            .unwrap_or_else(|why| panic!("{number}: {why:?}"));
        contacts[found.contacts.iter().flatten().count()] += 1;
        most_steps = most_steps.max(found.info.steps);
        most_imbalance = most_imbalance.max(found.power_balance.abs());
        assert_near("axial force", found.axial_force, load, 1e-9, found.loads()[0]);
        // A contact carries load if and only if it is compressed.
        for (load, approach) in found.loads().into_iter().zip(found.approaches) {
            assert_eq!(load > 0.0, approach > 0.0, "{number}");
        }
        if scene.gothic().force_at_rest(found.axial_displacement - found.first_touch, work).is_err()
        {
            // Without friction, the ball would not be held at this displacement of the nut.
            held += 1;
            continue;
        }
        let turned = Scene { rpm: (-scene.rpm.0, -scene.rpm.1), ..scene };
        let position = AxialCondition::Displacement(-found.axial_displacement);
        let Ok(mirrored) = turned.gothic().solve(position, None, work) else {
            refused += 1;
            continue;
        };
        let change = found.motion.precession + mirrored.motion.precession;
        if change.abs() > 1e-3 * found.relative_speed.abs() {
            // A lightly loaded ball at high speed may have a second steady motion, in which it
            // skids.
            skidding += 1;
            continue;
        }
        for i in 0..FLANKS {
            // The residuals of both solutions are below 1e-10 of the friction force, but the loads
            // are less accurate. The elastic approach is calculated from the groove radius, which
            // is much larger than the approach, so the rounding error of the approach is 1e-16 of
            // the groove radius. The relative error of a load is 3/2 times the relative error of
            // its approach.
            assert_near("load", found.loads()[i], mirrored.loads()[i ^ 1], 1e-7, found.loads()[0]);
        }
    }
    println!(
        "contacts {contacts:?}, at most {most_steps} steps, imbalance {most_imbalance:e}; at the displacement {held} held by \
         friction alone, {refused} without a root, {skidding} with another motion"
    );
    // It is more difficult to solve a ball for a given displacement than for a given force, so a
    // few exceptions are permitted.
    assert!(50 * held < campaign(5000) && 200 * (refused + skidding) < campaign(5000));
    assert!(contacts[..2] == [0, 0] && contacts[2..].iter().all(|n| *n > 20), "{contacts:?}");
    // The solver balances the forces to 1e-10 of the friction force.
    assert!(most_imbalance <= 1e-9, "{most_imbalance}");
}

/// The random nuts have a few balls, which carry an axial load and a side load. Every nut that
/// carries its load must have a friction torque. Third contacts must not occur unless the play is
/// given.
#[test]
fn random_nuts_that_carry_their_load_have_a_friction_torque() {
    let mut rng = ChaCha8Rng::seed_from_u64(68);
    let (mut solved, mut refused, mut thirds, mut on_two_contacts) = (0, 0, 0, 0);
    for number in 0..campaign(5000) {
        let balls = rng.random_range(3..12_u8);
        let mut nut = with_circuits(vec![Circuit {
            start: 0.0,
            arc: rng.random_range(4.0..12.0),
            balls: usize::from(balls),
            thread: 0,
            body: 0,
            flanks: Flanks::Both,
            offset: 0.0,
        }]);
        nut.errors.axial_play = rng.random_bool(0.6).then(|| rng.log_uniform(1e-7, 5e-5));
        let load = rng.log_uniform(1.0, 200.0) * f64::from(balls);
        let mut support = Support::free(load);
        support.0[1] = Freedom::Loaded(load * rng.random_range(0.0..0.3));
        let Ok(found) = nut.solve(&support) else { continue };
        let speed = rng.log_uniform(0.1, 300.0);
        let drive = Drive {
            screw_speed: if rng.random_bool(0.5) { speed } else { -speed },
            nut_speed: 0.0,
        };
        let coefficient = rng.log_uniform(0.01, 0.15);
        let friction = FlankFriction::equal(coefficient);
        let work = &mut ModelWorkspace::default();
        let all = nut.friction(&found, friction, &drive, 0.0, |at| {
            let (accuracy, creep) = (1e-6, Traction::<f64>::CREEP);
            Problem::Traction(Traction { screw: at, accuracy, creep }).solve(work)
        });
        let Some(torque) = all.torque else {
            assert!(all.balls.len() < found.balls.len() && all.parts.is_none(), "{number}");
            refused += 1;
            continue;
        };
        assert!(torque > 0.0 && torque.is_finite(), "{number}: {torque}");
        solved += 1;
        thirds += all.third_contacts.count;
        let Some(axial_play) = nut.errors.axial_play else {
            assert!(all.third_contacts.count == 0, "{number}");
            continue;
        };
        let point = OperatingPoint {
            helix: nut.helix,
            contact_angle: nut.contact_angle,
            ball: nut.ball,
            friction: Coulomb(coefficient),
            drive,
            load: Load { axial: 1.0, balls: 1.0 },
        };
        let at = ElasticPoint { point, conformity: nut.conformity, material: nut.material };
        for (ball, motion) in all.motions.iter().enumerate() {
            let Some(state) = motion.and_then(|motion| motion.ball) else { continue };
            let fit = ArchFit { axial_play, radial_gap: -found.grooves[ball][1], oversize: 0.0 };
            let far_friction = at.point.friction;
            let creep = Traction::<f64>::CREEP;
            let in_arches = GothicBall { screw: at, fit, far_friction, accuracy: 1e-6, creep };
            let gap = in_arches.far_gap_on_two_contacts(&state).expect("a moving ball");
            // The friction integrals have a relative accuracy of 1e-6, and the elastic approaches
            // are a few micrometers. Calculated gaps are therefore accurate to about 1e-11 m.
            assert!(gap >= -1e-11, "{number}, ball {ball}: {gap:e}");
            on_two_contacts += 1;
        }
    }
    println!("{solved} solved, {refused} refused, {thirds} third contacts");
    // Balls with a load below 4 N at the edge of their flanks may have no steady motion.
    assert!(10 * solved > 8 * campaign(5000) && 200 * refused < solved, "{solved} {refused}");
    assert!(thirds > 200 && on_two_contacts > 200, "{thirds} {on_two_contacts}");
}

/// As the side load increases, the eight balls of a nut touch their far flanks one after another.
/// If the play is not given, friction presses a ball onto a far flank only if the ball touches this
/// flank at rest.
#[test]
fn friction_is_continuous_under_a_growing_side_load() {
    for play in [None, Some(8e-6)] {
        let mut nut = with_circuits(vec![Circuit {
            start: 0.3,
            arc: 7.0,
            balls: 8,
            thread: 0,
            body: 0,
            flanks: Flanks::Both,
            offset: 0.0,
        }]);
        nut.errors.axial_play = play;
        let work = &mut ModelWorkspace::default();
        let drive = Drive { screw_speed: 50.0, nut_speed: 0.0 };
        let mut at = |side: f64| {
            let mut support = Support::free(600.0);
            support.0[1] = Freedom::Loaded(side);
            let found = nut.solve(&support).expect("carried");
            let friction = nut.friction(&found, FlankFriction::equal(0.06), &drive, 0.0, |at| {
                let (accuracy, creep) = (1e-6, Traction::<f64>::CREEP);
                Problem::Traction(Traction { screw: at, accuracy, creep }).solve(work)
            });
            (friction.balls_on_both_flanks, friction.torque.expect("all balls"))
        };
        let mut changes = 0;
        let mut low = (0.0, at(0.0));
        for step in 1..=40_u32 {
            let side = 10.0 * f64::from(step);
            let (mut below, mut above) = (low, (side, at(side)));
            low = above;
            if below.1.0 == above.1.0 {
                continue;
            }
            // The loop finds the side load at which one more ball begins to carry load on a far
            // flank.
            while above.0 - below.0 > 1e-5 * above.0 {
                let middle = 0.5 * (below.0 + above.0);
                let found = (middle, at(middle));
                if found.1.0 == below.1.0 { below = found } else { above = found }
            }
            changes += 1;
            let step = above.1.1 / below.1.1 - 1.0;
            // The two side loads differ by a relative amount of 1e-5, which changes the torque by
            // about 1e-5 of its value. This is one hundredth of the tolerance.
            assert!(step.abs() < 1e-3, "{play:?}: {step:e} at {below:?} {above:?}");
        }
        assert!(changes > 2, "{changes}");
    }
}

/// Turning a screw end for end reverses its direction of rotation and exchanges the + and − flanks.
#[test]
fn contacts_are_mirrored_if_the_screw_is_turned_end_for_end() {
    for (um, fit) in [
        (10.0, ArchFit::default()),
        (3.0, ArchFit { oversize: 1.5e-6, ..ArchFit::default() }),
        (14.0, ArchFit { axial_play: 12e-6, ..ArchFit::default() }),
    ] {
        let scene = Scene { fit, rpm: (300.0, 20.0), ..Scene::from_study(0.08, 0.0) };
        let turned = Scene { rpm: (-300.0, -20.0), ..scene };
        let here = scene.solve(AxialCondition::Displacement(um * 1e-6));
        let there = turned.solve(AxialCondition::Displacement(-um * 1e-6));
        let (loads, other) = (here.loads(), there.loads());
        for i in 0..FLANKS {
            // In both solutions, the forces are balanced to better than 1e-10 of the friction
            // force.
            assert_near("load", loads[i], other[i ^ 1], 1e-10, loads[0]);
        }
        assert_near("torque", here.screw_torque, -there.screw_torque, 1e-9, here.screw_torque);
    }
}

/// Without friction, the loads equal the loads in the static nut model. The test uses a friction
/// coefficient of 1e-6, which changes the loads by about 1e-6 of their value.
#[test]
fn ball_loads_without_friction_match_the_static_nut_model() {
    let nut = with_circuits(Vec::new());
    let at_rest = nut.ball_in_grooves().expect("Hertz contacts");
    for (um, oversize) in [(0.0, 1.5e-6), (1.0, 1.5e-6), (6.0, 0.5e-6), (8.0, 0.0)] {
        // The speed is low, because a ball that is nearly frictionless would skid at higher speed.
        let scene = Scene {
            fit: ArchFit { oversize, ..ArchFit::default() },
            rpm: (1.0, 0.0),
            pitch: 41.336,
            conformity: Conformities::alike(0.5203),
            modulus: 206.0,
            ..Scene::from_study(1e-6, 0.0)
        };
        let found = scene.solve(AxialCondition::Displacement(um * 1e-6));
        let w = um * 1e-6 * nut.helix.lead_angle.cos();
        let expected = at_rest.at([w, 0.0], oversize, Flanks::Both).expect("a pressed ball");
        let largest = expected.max_load();
        for (load, expected) in found.loads().into_iter().zip(expected.loads) {
            assert_near("load", load, expected, 1e-5, largest);
        }
    }
}

/// The torque is a continuous function of the play. The gap at the far flank closes exactly at the
/// threshold play.
#[test]
fn torque_is_continuous_where_the_third_contact_begins() {
    for (friction, rpm) in [(0.06, 100.0), (0.06, -100.0), (0.1, 100.0), (0.1, -100.0)] {
        let at = |play_um: f64| {
            let scene = Scene { rpm: (rpm, 0.0), ..Scene::from_study(friction, play_um) };
            scene.solve(AxialCondition::Force(60.0))
        };
        let wide = Scene { rpm: (rpm, 0.0), ..Scene::from_study(friction, 100.0) };
        let threshold = wide.gothic().threshold_play(60.0, &mut GothicWorkspace::default());
        let threshold = threshold.expect("friction reaches a far flank") * 1e6;
        let [above, below] = [1.0 + 1e-6, 1.0 - 1e-6].map(|part| at(threshold * part));
        assert!(!above.far_flank_carries() && below.far_flank_carries(), "{threshold}");
        // The play exceeds the threshold play of about 30 um by a relative amount of 1e-6, so the
        // gap at the far flank is smaller than 1e-10 m.
        assert!(above.far_gap() > 0.0 && above.far_gap() < 1e-10, "{}", above.far_gap());
        assert_near("torque", above.screw_torque, below.screw_torque, 1e-6, above.screw_torque);
        // Above the threshold play, the gap at the far flank increases with the play, but an
        // increase of the play by one tenth hardly changes the torque.
        let wide = at(threshold * 1.1);
        assert_near(
            "two contacts",
            wide.screw_torque,
            above.screw_torque,
            1e-9,
            above.screw_torque,
        );
    }
}

#[test]
fn unloaded_or_frictionless_balls_and_invalid_gaps_are_rejected() {
    let work = &mut GothicWorkspace::default();
    let scene = Scene::from_study(0.06, 10.0);
    let solve = |scene: &Scene, condition, work: &mut GothicWorkspace| {
        scene.gothic().solve(condition, None, work).map(|found| found.loads())
    };
    // At a displacement of 4 um, the ball is loose between the flanks or carries no load.
    assert!(solve(&scene, AxialCondition::Displacement(4e-6), work).is_err());
    assert!(solve(&scene, AxialCondition::Force(0.0), work).is_err());
    assert!(solve(&scene, AxialCondition::Force(-10.0), work).is_err());
    assert!(solve(&scene, AxialCondition::Force(f64::NAN), work).is_err());
    let force = AxialCondition::Force(50.0);
    assert!(solve(&Scene { friction: 0.0, ..scene }, force, work).is_err());
    assert!(solve(&Scene { rpm: (5.0, 5.0), ..scene }, force, work).is_err());
    let fit = ArchFit { axial_play: -1e-6, ..ArchFit::default() };
    assert!(solve(&Scene { fit, ..scene }, force, work).is_err());
    // The radial gap is larger than the depth of the groove.
    let fit = ArchFit { radial_gap: 1e-3, ..ArchFit::default() };
    assert!(solve(&Scene { fit, ..scene }, force, work).is_err());
}

#[test]
fn reference_pairs_have_the_expected_drag() {
    let work = &mut GothicWorkspace::default();
    for case in reference_cases("pair") {
        let (name, expect) = (case["name"].as_str().expect("name"), &case["expect"]);
        let scene = Scene::from_reference(&case["case"]);
        let pair = if let Some(preload) = number(&case["case"], "preload_N") {
            GothicPair::of_preload(scene.gothic(), preload, work).expect("a pair")
        } else {
            let um = number(&case["case"], "preload_offset_um").expect("an offset");
            GothicPair { driving: scene.gothic(), offset: -um * 1e-6 }
        };
        let get = |key: &str| number(expect, key).unwrap_or_else(|| panic!("{key}"));
        assert_near("offset", pair.offset * 1e6, -get("preload_offset_um"), 1e-5, 1.0);
        let preload = pair.force_at_rest(work).expect("pressed balls");
        assert_near("preload", preload, get("frictionless_preload_N"), 1e-6, preload);
        let load = number(&case["case"], "axial_load_N").expect("a load");
        let found = pair.solve(load, work).expect("a running pair");
        let turning = found.driving.motion.omega.norm();
        compare_with_reference(
            &format!("{name} driven"),
            &found.driving,
            &expect["driven"],
            turning,
        );
        compare_with_reference(
            &format!("{name} back"),
            &found.back_driven,
            &expect["back"],
            turning,
        );
        let torque = found.friction_torque;
        assert_near("torque", torque, get("friction_torque_Nm"), 1e-6, torque);
        let running = found.drag_coefficient(found.force(), scene.lead_m());
        assert_near("K_p", running, get("drag_coefficient_running"), 1e-6, running);
        let at_rest = found.drag_coefficient(preload, scene.lead_m());
        assert_near("K_p at rest", at_rest, get("drag_coefficient"), 1e-6, at_rest);
        assert_near("force", found.force() / preload, get("running_over_frictionless"), 1e-6, 1.0);
    }
}

/// The drag torque of a pair, as a function of play and friction, agrees with an independent study
/// to the six digits that the study prints.
#[test]
fn drag_as_a_function_of_play_and_friction_matches_an_independent_study() {
    let work = &mut GothicWorkspace::default();
    let mut rows = 0;
    for row in STUDY.lines().filter(|row| row.starts_with("play,")) {
        let fields: Vec<_> = row.split(',').collect();
        let value = |column: usize| fields[column].parse::<f64>().expect("a number");
        let (friction, play) = (value(1), value(2));
        if !([0.06, 0.1].contains(&friction) && [0.0, 10.0, 20.0, 50.0].contains(&play)) {
            continue;
        }
        rows += 1;
        let scene = Scene::from_study(friction, play);
        let pair = GothicPair::of_preload(scene.gothic(), value(10), work).expect("a pair");
        let found = pair.solve(0.0, work).expect("a running pair");
        let running = found.drag_coefficient(found.force(), scene.lead_m());
        // The study prints six digits of each value.
        assert_near(&format!("K_p {friction} {play}"), running, value(11), 1e-5, running);
        assert_near("force", found.force() / value(10), value(13), 1e-5, 1.0);
    }
    assert_eq!(rows, 8);
}

/// If the friction coefficient at the far flanks is halved, the drag coefficient K_p decreases from
/// 0.205 to 0.166. Both values are taken from an independent study, which prints three digits.
#[test]
fn lower_friction_coefficient_at_the_far_flank_reduces_the_drag() {
    let work = &mut GothicWorkspace::default();
    let scene = Scene::from_study(0.1, 0.0);
    let ball = GothicBall { far_friction: Coulomb(0.05), ..scene.gothic() };
    let pair = GothicPair::of_preload(ball, 60.0, work).expect("a pair");
    let found = pair.solve(0.0, work).expect("a running pair");
    let running = found.drag_coefficient(found.force(), scene.lead_m());
    assert_near("K_p", running, 0.166, 5e-4, 1.0);
}

/// Returns the friction torque of a pair whose preload is 60 N per ball.
fn pair_drag(scene: &Scene, work: &mut GothicWorkspace) -> f64 {
    let pair = GothicPair::of_preload(scene.gothic(), 60.0, work).expect("a pair");
    pair.solve(0.0, work).expect("a running pair").friction_torque
}

/// The drag torque does not depend on the direction of rotation: if the rotation is reversed, the
/// two nuts of the pair exchange their roles.
#[test]
fn an_unloaded_pair_of_identical_nuts_has_equal_drag_in_both_directions() {
    let work = &mut GothicWorkspace::default();
    let [there, back] = [1.0, -1.0].map(|way| {
        pair_drag(&Scene { rpm: (way * 100.0, 0.0), ..Scene::from_study(0.08, 10.0) }, work)
    });
    // Both solutions balance the forces to 1e-10 of the friction force.
    assert_near("torque", there, back, 1e-8, there);
}

#[test]
fn drag_does_not_increase_with_the_play() {
    let work = &mut GothicWorkspace::default();
    let plays = [0.0, 4.0, 8.0, 12.0, 16.0, 20.0, 24.0, 28.0, 32.0, 40.0];
    let torques = plays.map(|play| pair_drag(&Scene::from_study(0.08, play), work));
    for pair in torques.windows(2) {
        // Above the threshold play, the torque is constant except for rounding errors.
        assert!(pair[1] <= pair[0] * (1.0 + 1e-9), "{torques:?}");
    }
}

/// Under a large external load, one nut of the pair is unloaded, so that only the other nut carries
/// load.
#[test]
fn a_pair_without_remaining_preload_is_rejected() {
    let work = &mut GothicWorkspace::default();
    let pair = GothicPair::of_preload(Scene::from_study(0.06, 10.0).gothic(), 60.0, work);
    let pair = pair.expect("a pair");
    assert!(pair.solve(100.0, work).is_ok());
    assert!(pair.solve(1000.0, work).is_err());
}

#[test]
fn running_torque_of_a_pair_decreases_continuously_with_the_play() {
    /// Preload of each ball at rest \[N\].
    const PRELOAD: f64 = 50.0;
    /// Largest relative decrease of the torque when the play grows by 0.25 um.
    const MAX_DECREASE: f64 = 0.015;
    let torque = |friction: f64, play_um: f64, rpm: f64| {
        let scene = Scene {
            pitch: 41.336,
            conformity: Conformities::alike(0.5203),
            modulus: 206.0,
            rpm: (rpm, 0.0),
            ..Scene::from_study(friction, play_um)
        };
        let (driving, work) =
            (GothicBall { accuracy: 1e-6, ..scene.gothic() }, &mut GothicWorkspace::default());
        let pair =
            GothicPair::of_preload(driving, PRELOAD, work).and_then(|pair| pair.solve(0.0, work));
        let place = format!("friction {friction}, play {play_um} um, {rpm} rpm");
        pair.unwrap_or_else(|failure| panic!("{place}: {failure:?}")).friction_torque
    };
    for (friction, from) in [(0.12, 28.0), (0.13, 15.0), (0.14, 15.0), (0.14, 33.0), (0.16, 18.0)] {
        let mut last: Option<f64> = None;
        for step in 0..=20 {
            let play = from + 0.25 * f64::from(step);
            let forward = torque(friction, play, 100.0);
            // In the opposite direction, the two nuts of the pair exchange their roles.
            assert_near("reverse", torque(friction, play, -100.0), forward, 1e-6, forward);
            if let Some(last) = last {
                let decrease = 1.0 - forward / last;
                assert!(
                    (0.0..MAX_DECREASE).contains(&decrease),
                    "friction {friction}, play {play} um: the torque decreases by {decrease:e}"
                );
            }
            last = Some(forward);
        }
    }
}
