//! Prints the median solution time of nuts with elastic bodies and various numbers of balls, as
//! JSON. `benches/peers/nut.sh` compares these times with SciPy.

use std::f64::consts::PI;
use std::io::{Error, Write as _, stdout};
use std::time::Instant;

use bsm_dyn::{Ball, Conformities, Material, Materials};
use bsm_kin::Helix;
use bsm_nut::{BallNut, Bar, Circuit, Errors, Flanks, Ring, Support};
use serde_json::json;

/// Returns a 40 mm x 10 mm nut with 6.35 mm balls, 20.4 balls per turn, elastic bars anchored at
/// opposite ends, and an elastic ring.
fn nut(balls: u16) -> BallNut {
    let (pitch, lead, radius) = (41.336e-3, 10e-3, 3.175e-3);
    let steel = Material { youngs_modulus: 206e9, poisson_ratio: 0.3 };
    let arc = f64::from(balls) / 20.4 * 2.0 * PI;
    let length = lead * arc / (2.0 * PI);
    // The rigidity EA of the bodies is proportional to the square of their length. For a given load
    // per ball, the displacements of all nuts therefore have the same magnitude.
    let bodies = f64::from(balls) / 100.0;
    let circuit = Circuit {
        start: 0.0,
        arc,
        balls: usize::from(balls),
        thread: 0,
        body: 0,
        flanks: Flanks::Both,
        offset: 0.0,
    };
    BallNut {
        helix: Helix { radius: 0.5 * pitch, lead_angle: (lead / (PI * pitch)).atan() },
        starts: 1,
        ball: Ball::of_density(radius, 7800.0),
        contact_angle: 45_f64.to_radians(),
        conformity: Conformities::alike(0.5203),
        material: Materials::alike(steel),
        circuits: vec![circuit],
        errors: Errors::default(),
        nut_bar: Some(Bar { stiffness: bodies * bodies * 453e6, anchor: -0.01 }),
        screw_bar: Some(Bar { stiffness: bodies * bodies * 219.7e6, anchor: length + 0.01 }),
        ring: Some(Ring {
            outer_diameter: 70e-3,
            inner_diameter: 45.826e-3,
            youngs_modulus: 206e9,
        }),
        reference: None,
        precession: 0.0,
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut rows = Vec::new();
    for (balls, runs) in [(100_u16, 2001), (1000, 201), (10_000, 21)] {
        let nut = nut(balls);
        let axial = 200.0 * f64::from(balls);
        let support = Support::free(axial);
        let mut times = Vec::with_capacity(runs);
        for _ in 0..runs {
            let begin = Instant::now();
            std::hint::black_box(nut.solve(&support)?);
            times.push(begin.elapsed().as_secs_f64());
        }
        times.sort_by(f64::total_cmp);
        let found = nut.solve(&support)?;
        let ball = nut.ball_in_grooves().map_err(|_| Error::other("no Hertzian contact"))?;
        let positions: Vec<_> =
            found.positions.iter().map(|position| [position.theta, position.z]).collect();
        let bars = [nut.nut_bar, nut.screw_bar].map(|bar| bar.map(|b| [b.stiffness, b.anchor]));
        rows.push(json!({
            "balls": balls,
            "seconds": times[runs / 2],
            "steps": found.steps,
            "axial_load_N": axial,
            "displacement": found.displacement,
            "max_load_N": found.max_load(),
            "pitch_radius": nut.helix.radius,
            "lead_angle": nut.helix.lead_angle,
            "contact_angle": nut.contact_angle,
            "arc_distance": ball.series.distance,
            "stiffness": ball.series.stiffness,
            "places": positions,
            "bars": bars,
            "ring_N_m": nut.ring.map(|ring| ring.stiffness(nut.helix.lead(), nut.circuits[0].arc)),
        }));
    }
    writeln!(stdout(), "{}", json!(rows))?;
    Ok(())
}
