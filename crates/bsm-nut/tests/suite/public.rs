//! Tests of the reference cases in `validation/published/nut`. All loads, contact angles,
//! displacements, reactions, stiffnesses and lives must match an independent solution.

use std::f64::consts::PI;

use bsm_dyn::{Ball, Conformities, Material, Materials};
use bsm_kin::Helix;
use bsm_nut::{
    BallNut, Bar, Circuit, Errors, Flanks, Freedom, LeadError, Ring, Support, TurnRatings,
};
use serde_json::Value;

const CASES: &str = include_str!("../../../../validation/published/nut/public.json");
const DEG: f64 = PI / 180.0;

pub(crate) fn number(value: &Value, key: &str) -> Option<f64> {
    value.get(key).and_then(Value::as_f64)
}

fn read_numbers(value: &Value) -> Vec<Option<f64>> {
    value.as_array().expect("list").iter().map(Value::as_f64).collect()
}

fn circuit(value: &Value) -> Circuit {
    let whole = |key| value.get(key).map_or(0, |n| n.to_string().parse().expect("whole number"));
    Circuit {
        start: number(value, "start_deg").expect("start") * DEG,
        arc: number(value, "arc_deg").expect("arc") * DEG,
        balls: whole("balls"),
        thread: whole("start"),
        body: whole("body"),
        flanks: match value["flank"].as_str().expect("flank") {
            "+" => Flanks::Plus,
            "-" => Flanks::Minus,
            _ => Flanks::Both,
        },
        offset: number(value, "offset_um").unwrap_or(0.0) * 1e-6,
    }
}

pub(crate) fn nut(case: &Value) -> BallNut {
    let mm = |key| number(case, key).expect("length") * 1e-3;
    let (pitch, lead) = (mm("pitch_circle_diameter_mm"), mm("lead_mm"));
    let steel = Material {
        youngs_modulus: number(case, "youngs_modulus_GPa").expect("modulus") * 1e9,
        poisson_ratio: number(case, "poisson_ratio").expect("ratio"),
    };
    let radius = 0.5 * mm("ball_diameter_mm");
    let lead_error = |value: &Value| match number(value, "amplitude_um") {
        Some(amplitude) => LeadError::Wave {
            amplitude: amplitude * 1e-6,
            order: number(value, "order").expect("order"),
            phase: number(value, "phase_deg").expect("phase") * DEG,
        },
        None => LeadError::Slope {
            slope: number(value, "slope_um_per_mm").expect("slope") * 1e-3,
            origin: number(value, "z0_mm").expect("origin") * 1e-3,
        },
    };
    let list = |key: &str| case.get(key).and_then(Value::as_array).cloned().unwrap_or_default();
    let errors = Errors {
        balls: list("ball_deviation_um").iter().map(|x| x.as_f64().expect("um") * 0.5e-6).collect(),
        oversize: number(case, "ball_oversize_um").unwrap_or(0.0) * 0.5e-6,
        lead: list("lead_error").iter().map(lead_error).collect(),
        gap: number(case, "radial_gap_um").unwrap_or(0.0) * 1e-6,
        axial_play: None,
    };
    let mut nut = BallNut {
        helix: Helix { radius: 0.5 * pitch, lead_angle: (lead / (PI * pitch)).atan() },
        starts: case.get("starts").map_or(1, |n| n.to_string().parse().expect("whole number")),
        ball: Ball { radius, mass: 4.0 / 3.0 * PI * radius.powi(3) * 7800.0 },
        contact_angle: number(case, "contact_angle_deg").expect("angle") * DEG,
        conformity: Conformities {
            nut: number(case, "nut_conformity").expect("conformity"),
            screw: number(case, "screw_conformity").expect("conformity"),
        },
        material: Materials::alike(steel),
        circuits: list("circuits").iter().map(circuit).collect(),
        errors,
        nut_bar: None,
        screw_bar: None,
        ring: case.get("ring").map(|ring| Ring {
            outer_diameter: number(ring, "outer_diameter_mm").expect("mm") * 1e-3,
            inner_diameter: number(ring, "inner_diameter_mm").expect("mm") * 1e-3,
            youngs_modulus: steel.youngs_modulus,
        }),
        reference: None,
        precession: number(case, "ball_precession_rad_s").unwrap_or(0.0),
    };
    let positions = nut.positions();
    let low = positions.iter().map(|p| p.z).fold(f64::MAX, f64::min);
    let high = positions.iter().map(|p| p.z).fold(f64::MIN, f64::max);
    let bar = |body: &str| {
        let bar = case.get("bars")?.get(body)?;
        let anchor = match bar.get("anchor").and_then(Value::as_str) {
            Some("low") => low,
            Some(_) => high,
            None => number(bar, "anchor_z_mm").expect("anchor") * 1e-3,
        };
        Some(Bar { stiffness: number(bar, "EA_N").expect("EA"), anchor })
    };
    (nut.nut_bar, nut.screw_bar) = (bar("nut"), bar("screw"));
    nut
}

fn read_support(case: &Value) -> Support {
    Support(["uz", "ux", "uy", "px", "py"].map(|key| match number(&case["load_SI"], key) {
        Some(load) => Freedom::Loaded(load),
        None => Freedom::Held(number(&case["fixed_SI"], key).unwrap_or(0.0)),
    }))
}

/// Compares calculated numbers with expected numbers. For values that are zero by symmetry, the
/// tolerance is the rounding error of a sum over a hundred balls, which is 1e-12 of the largest
/// value in the list.
fn assert_agree(name: &str, what: &str, found: &[f64], expected: &[Option<f64>], tolerance: f64) {
    assert_eq!(found.len(), expected.len(), "{name} {what}");
    let size = expected.iter().flatten().fold(0.0_f64, |most, x| most.max(x.abs()));
    for (i, (found, expected)) in found.iter().zip(expected).enumerate() {
        let Some(expected) = expected else { continue };
        let allowed = tolerance * expected.abs().max(1e-3 * size);
        assert!(
            (found - expected).abs() <= allowed,
            "{name} {what}[{i}]: {found:e}, expected {expected:e}, allowed {allowed:e}"
        );
    }
}

#[test]
fn nuts_match_the_reference_cases() {
    let cases: Vec<Value> = serde_json::from_str(CASES).expect("JSON");
    assert_eq!(cases.len(), 14);
    for case in &cases {
        let name = case["name"].as_str().expect("name");
        let nut = nut(&case["case"]);
        let found = nut.solve(&read_support(case)).unwrap_or_else(|e| panic!("{name}: {e}"));
        let expect = &case["expect"];
        // The reference values have 14 digits, and the two solutions agree to 3e-11 or better.
        let tolerance = number(case, "rel_tol").expect("tolerance");
        let load = |c: usize| found.balls.iter().map(|b| b.loads[c]).collect::<Vec<_>>();
        let largest = found.max_load();
        for (c, key) in
            ["nut_plus_N", "nut_minus_N", "screw_plus_N", "screw_minus_N"].iter().enumerate()
        {
            let expected: Vec<_> = read_numbers(&expect[key]);
            for (i, (found, expected)) in load(c).iter().zip(&expected).enumerate() {
                let expected = expected.expect("load");
                let allowed = tolerance * expected.max(1e-6 * largest);
                assert!(
                    (found - expected).abs() <= allowed,
                    "{name} {key}[{i}]: {found:e} {expected:e} {:e}",
                    (found - expected).abs() / expected
                );
            }
        }
        let angle = |c: usize| found.balls.iter().map(|b| b.angles[c] / DEG).collect::<Vec<_>>();
        assert_agree(
            name,
            "nut angle",
            &angle(0),
            &read_numbers(&expect["nut_plus_deg"]),
            tolerance,
        );
        assert_agree(
            name,
            "screw angle",
            &angle(2),
            &read_numbers(&expect["screw_plus_deg"]),
            tolerance,
        );
        let [uz, ux, uy, px, py] = found.displacement;
        let lengths = [uz, ux, uy].map(|u| u * 1e6);
        assert_agree(
            name,
            "displacement",
            &lengths,
            &read_numbers(&expect["displacement_um"]),
            tolerance,
        );
        assert_agree(
            name,
            "tilt",
            &[px, py].map(|t| t * 1e6),
            &read_numbers(&expect["tilt_urad"]),
            tolerance,
        );
        // The last element of the list is the sum of the contact loads at the nut. It is the
        // largest number in the list and sets the tolerance for forces that are zero except for
        // rounding errors.
        let sum = load(0).into_iter().chain(load(1)).sum::<f64>();
        let with_sum = |mut all: Vec<f64>| {
            all.push(sum);
            all
        };
        let expected = read_numbers(&expect["reaction_SI"]).into_iter().chain([Some(sum)]);
        let carried = with_sum(found.carried.to_vec());
        assert_agree(name, "carried", &carried, &expected.collect::<Vec<_>>(), tolerance);
        let rows = found.stiffness.concat();
        assert_agree(name, "stiffness", &rows, &read_numbers(&expect["stiffness_SI"]), tolerance);
        let expected = read_numbers(&expect["body_axial_N"]).into_iter().chain([Some(sum)]);
        let bodies = with_sum(found.bodies.clone());
        assert_agree(name, "bodies", &bodies, &expected.collect::<Vec<_>>(), tolerance);
        let whole = [found.max_load(), found.concentration()];
        let expected = [number(expect, "max_contact_load_N"), number(expect, "max_over_mean")];
        assert_agree(name, "largest", &whole[..1], &expected[..1], tolerance);
        assert_agree(name, "concentration", &whole[1..], &expected[1..], tolerance);
        assert_eq!(Some(found.unloaded() as u64), expect["unloaded_balls"].as_u64(), "{name}");
        let hertz = nut.hertz().expect("Hertz contacts");
        let most = |c: usize| load(c).into_iter().chain(load(c + 1)).fold(0.0, f64::max);
        let pressure = f64::max(hertz[0].max_pressure(most(0)), hertz[1].max_pressure(most(2)));
        let expected = [number(expect, "max_pressure_MPa")];
        assert_agree(name, "pressure", &[pressure * 1e-6], &expected, tolerance);
        if let Some(ratings) = case["ratings"].as_object() {
            let ratings = TurnRatings {
                screw: ratings["screw_rating_N"].as_f64().expect("N"),
                nut: ratings["nut_rating_N"].as_f64().expect("N"),
            };
            let life = found.life(&nut, &ratings);
            assert_agree(name, "life", &[life], &[number(expect, "life_revolutions")], tolerance);
        }
        // The equilibrium must not depend on the starting point, because the energy is convex. The
        // starting point is off by one micrometer and ten microradians.
        let off = [1e-6, -1e-6, 1e-6, 1e-5, -1e-5];
        let start = std::array::from_fn(|i| found.displacement[i] + off[i]);
        let again = nut.solve_from(&read_support(case), Some(&start)).expect("carried");
        let [here, there] = [&found, &again]
            .map(|f| f.balls.iter().flat_map(|b| b.loads).map(Some).collect::<Vec<_>>());
        let there: Vec<f64> = there.into_iter().flatten().collect();
        assert_agree(name, "another start", &there, &here, tolerance);
        assert!(found.steps <= 12, "{name}: {} steps", found.steps);
    }
}
