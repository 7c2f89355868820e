//! Compares the first root of the static balance with a dense search that uses neither brackets nor
//! bounds.

use std::f64::consts::FRAC_PI_2;

use bsm_kin::{Drive, Helix, Jet};
use proptest::prelude::*;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::*;
use crate::extreme::random_extreme_screw;
use crate::models::ball::ElasticPoint;
use crate::{Ball, Conformities, Coulomb, Load, Material, Materials, OperatingPoint};

/// Number of contact angles in the dense search.
const GRID: usize = 1500;

/// Generates screws whose inertia forces are 0.01 to 100 times the load.
fn random_screws() -> impl Strategy<Value = ElasticPoint> {
    let shape = (0.5..80.0_f64, 3.0..87.0_f64, 0.02..0.45_f64, 0.505..0.8_f64, 0.505..0.8_f64);
    let state = (-2.0..2.0_f64, 1e-9..1e-1_f64, -3.0..3.0_f64, any::<bool>());
    (shape, state).prop_map(|((lead, beta, size, f_n, f_s), (inertia, soft, nut, back))| {
        let ball = Ball::of_density(3e-3, 7800.0);
        let radius = ball.radius / size;
        // The elastic modulus follows from its given ratio to the load, and the speed follows from
        // the given inertia ratio.
        let axial = 100.0;
        let modulus = axial / (soft * ball.radius * ball.radius);
        let speed = (10.0_f64.powf(inertia) * axial / (ball.mass * radius)).sqrt();
        let speed = if back { -speed } else { speed };
        let material = Material { youngs_modulus: modulus, poisson_ratio: 0.3 };
        ElasticPoint {
            point: OperatingPoint {
                helix: Helix { radius, lead_angle: lead.to_radians() },
                contact_angle: beta.to_radians(),
                ball,
                friction: Coulomb(0.1),
                drive: Drive { screw_speed: (1.0 + nut) * speed, nut_speed: nut * speed },
                load: Load { axial, balls: 1.0 },
            },
            conformity: Conformities { nut: f_n, screw: f_s },
            material: Materials::alike(material),
        }
    })
}

/// Returns the residual of the radial force balance, calculated from the contact angle at the
/// screw. Returns `None` if no contact angle at the nut satisfies the radial closure of the groove
/// arcs, or if the contact angle at the nut would be larger than at the screw.
fn residual(contacts: &ElasticContacts, control: Control, screw: f64) -> Option<f64> {
    let [nut_offset, screw_offset] = contacts.scaled.offsets;
    let lead = contacts.helix.lead_angle;
    let load = |angle: f64| (lead.cos() * angle.sin()).recip();
    let along = |i: usize, offset: f64, angle: f64| {
        (offset + contacts.approach_of(i, load(angle))) * angle.cos()
    };
    let radial_distance = (nut_offset + screw_offset) * contacts.contact_angle.cos();
    let rest = radial_distance - along(1, screw_offset, screw);
    let (mut low, mut high) = (1e-9, screw);
    if along(0, nut_offset, low) < rest || along(0, nut_offset, high) > rest {
        return None;
    }
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if along(0, nut_offset, middle) > rest {
            low = middle;
        } else {
            high = middle;
        }
    }
    let nut = 0.5 * (low + high);
    let angles = [nut.sin_cos(), screw.sin_cos()];
    let (p, _) =
        rolling(control == Control::Nut, contacts.scaled.lead, contacts.scaled.arc, angles);
    let rate = p + contacts.scaled.nut_speed;
    let centrifugal = contacts.inertia_ratio() * rate * rate;
    Some(load(nut) * nut.cos() - load(screw) * screw.cos() - centrifugal)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    /// If the model finds no root on the flanks, the dense search must not find a root either.
    #[test]
    fn first_root_agrees_with_a_dense_search(screw in random_screws(), nut in any::<bool>()) {
        let control = if nut { Control::Nut } else { Control::Screw };
        let Ok(contacts) = screw.scaled() else { return Ok(()) };
        let found = Balance::new(&contacts, control).first_root(&mut Workspace::default());
        #[expect(clippy::cast_precision_loss, reason = "a small count")]
        let angles = (1..GRID).map(|i| FRAC_PI_2 * i as f64 / GRID as f64);
        let mut before = None;
        let crossed = angles.filter_map(|angle| Some((angle, residual(&contacts, control, angle)?))).find(|at| {
            // The residual is negative at equal contact angles, so a sign change to a positive
            // value marks the first root.
            let here = at.1 >= 0.0 && before.is_some_and(|(_, residual)| residual < 0.0);
            if !here {
                before = Some(*at);
            }
            here
        });
        let step = FRAC_PI_2 / 1500.0;
        match found {
            Ok(root) => {
                let [c, cot] = root.unknowns;
                prop_assert!(c >= 0.0 && cot > 0.0 && root.residual <= 1e-10);
                let angle = cot.recip().atan();
                let residual = residual(&contacts, control, angle);
                // Contact angles near zero are less accurate in this calculation, and the dense
                // search has few points there.
                if let (Some(residual), Some((_, around))) = (residual, before) {
                    let size = 1.0 + around.abs().max((c + cot) / contacts.helix.lead_angle.cos());
                    prop_assert!(residual.abs() <= 1e-6 * size, "{residual}");
                }
                if let Some((beyond, _)) = crossed {
                    // If there are two roots within one step, the dense search may miss both.
                    prop_assert!(angle <= beyond + step, "{angle} {beyond}");
                }
            }
            Err(failure) => {
                prop_assert_eq!(failure.evidence(), Some(Evidence::Proof), "{:?}", failure);
                prop_assert!(crossed.is_none(), "{:?} {:?}", crossed, failure);
                let Reason::FlanksCannotHold { max_force_ratio, force_ratio, .. } = *failure.reason() else {
                    panic!("{failure:?}")
                };
                prop_assert!(max_force_ratio < force_ratio);
            }
        }
    }

    #[test]
    fn slope_of_the_radial_contact_force_agrees_with_automatic_differentiation(screw in random_screws(), cot in 1e-3..1e3_f64) {
        let Ok(contacts) = screw.scaled() else { return Ok(()) };
        let balance = Balance::new(&contacts, Control::Nut);
        for i in 0..2 {
            let exact = balance.statics.contact(i, Jet::<1>::variable(cot, 0)).radial_component().eps[0];
            let slope = balance.statics.contact(i, cot).radial_slope();
            // For large cotangents, cancellation causes a relative error of 1e-16 cot² in the
            // derivative of the jet.
            prop_assert!((slope - exact).abs() <= 1e-8 * exact.abs(), "{slope} {exact}");
        }
    }
}

/// If (W17) excludes a second root, the scan finds no second root.
#[test]
fn scan_finds_no_second_root_below_the_inertia_limit() {
    let mut rng = ChaCha8Rng::seed_from_u64(77);
    let mut newton = Workspace::default();
    let (mut tried, mut several, mut missed) = (0, 0, 0);
    while tried < 8000 {
        let Ok(contacts) = random_extreme_screw(&mut rng).scaled() else { continue };
        // Very small inertia has no significant effect on the contact angles, so such points are
        // skipped.
        if contacts.inertia_ratio() < 1e-2 {
            continue;
        }
        for control in Control::ALL {
            let balance = Balance::new(&contacts, control);
            let Ok(root) = balance.first_root(&mut newton) else { continue };
            tried += 1;
            let has_more = !balance.scan(root.unknowns[0], &mut newton).is_empty();
            several += usize::from(has_more);
            missed += usize::from(has_more && balance.is_unique());
        }
    }
    println!(
        "{several} of {tried} balls have several roots; (W17) had excluded {missed} of these roots"
    );
    assert_eq!(missed, 0);
    assert!(several > 100, "{several}");
}
