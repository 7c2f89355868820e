//! Checks of nuts with all their balls. The results are compared with ball bearings, preload
//! formulas, catalog stiffness, and the analytical solution for stiff bodies.

use std::f64::consts::{FRAC_PI_4, PI, TAU};

use bsm_case::units::{MM, UM};
use bsm_design::Nut;
use bsm_dyn::{Ball, Conformities, Material, Materials};
use bsm_kin::Helix;
use bsm_nut::{
    BallNut, Bar, Circuit, Errors, Flanks, Freedom, NutError, PreloadKind, Ring, Support,
};
use serde::Deserialize;

use crate::{Check, PublishedData, ValidateError};

const BEARING: &str = "a commercial program for ISO/TS 16281";
const CATALOG: &str = "HIWIN catalog BS-08-2";
const STEINMEYER: &str = "Steinmeyer, and HIWIN catalog BS-08-2, section 3.6";
const BARS: &str = "linear-elastic bars on an elastic foundation (theory chapter 16)";

/// Steel that is assumed for the nuts in the catalog.
const STEEL: Material = Material { youngs_modulus: 206e9, poisson_ratio: 0.3 };

/// Conformity that is assumed for the nuts in the catalog.
const CONFORMITY: f64 = 0.5203;

/// Returns all checks of the complete nut model.
pub(crate) fn checks(published: &PublishedData) -> Result<Vec<Check>, ValidateError> {
    let mut checks = Vec::new();
    for row in published.nut_bearings.rows::<Bearing>()? {
        checks.extend(row.checks());
    }
    checks.extend(limit_loads());
    let rows = published.nut_stiffness.rows::<CatalogRow>()?;
    checks.extend(stiffnesses(&rows));
    checks.extend(stiff_bars());
    Ok(checks)
}

/// A ball bearing, which is modeled as a nut with zero lead.
#[derive(Deserialize)]
#[expect(non_snake_case, reason = "columns of the table")]
struct Bearing {
    case: String,
    axial_load_N: f64,
    radial_load_N: f64,
    moment_Nm: f64,
    clearance_um: f64,
    axial_um: Option<f64>,
    radial_um: Option<f64>,
    tilt_mrad: Option<f64>,
    tolerance: f64,
}

impl Bearing {
    fn checks(&self) -> Vec<Check> {
        let found = self.displacement();
        // If the nut model rejects the load, the results are NaN, which fails every check.
        let [axial, x, y, tilt_x, tilt_y] = found.unwrap_or([f64::NAN; 5]);
        let rows = [
            ("axial", self.axial_um, axial / UM, "um"),
            ("radial", self.radial_um, x.hypot(y) / UM, "um"),
            ("tilt", self.tilt_mrad, 1e3 * tilt_x.hypot(tilt_y), "mrad"),
        ];
        let check = |(what, claimed, ours, unit): (&str, Option<f64>, f64, &str)| {
            let claimed = claimed?;
            let key = format!("nut/bearing-{}-{what}", self.case);
            let claim = format!("{what} displacement of a ball bearing, {}", self.case);
            let reason = "the reference prints five digits, and the tilt is proportional to the load in this range";
            let check = Check::new(&key, BEARING, claim).measured(ours, unit);
            Some(check.equals(claimed, self.tolerance * claimed, reason))
        };
        rows.into_iter().filter_map(check).collect()
    }

    /// Returns the displacements and tilts of the bearing. The bearing is free to move in the
    /// directions of the loads, and fixed in all other directions.
    fn displacement(&self) -> Result<[f64; 5], NutError> {
        let (diameter, pitch) = (11.5 * MM, 43.5 * MM);
        let steel = Material { youngs_modulus: 210e9, poisson_ratio: 0.3 };
        let circuit = Circuit {
            // The arc begins half a ball spacing before the first ball, so that the first ball lies
            // in the direction of the radial load.
            start: -PI / 7.0,
            ..one_turn(7, Flanks::Plus)
        };
        let bearing = BallNut {
            helix: Helix { radius: 0.5 * pitch, lead_angle: 0.0 },
            ball: Ball::of_density(0.5 * diameter, 7800.0),
            contact_angle: 0.0,
            conformity: Conformities { nut: 0.53, screw: 0.52 },
            material: Materials::alike(steel),
            errors: Errors { gap: 0.5 * self.clearance_um * UM, ..Errors::default() },
            ..rigid(vec![circuit])
        };
        let combined = self.axial_load_N * self.radial_load_N != 0.0;
        let free = |on: bool, load: f64| {
            if on { Freedom::Loaded(load) } else { Freedom::Held(0.0) }
        };
        let (side, tilt) = (self.radial_load_N != 0.0, self.moment_Nm != 0.0 || combined);
        bearing
            .solve(&Support([
                free(self.axial_load_N != 0.0, self.axial_load_N),
                free(side, -self.radial_load_N),
                free(side, 0.0),
                free(tilt, self.moment_Nm),
                free(tilt, 0.0),
            ]))
            .map(|found| found.displacement)
    }
}

fn one_turn(balls: usize, flanks: Flanks) -> Circuit {
    Circuit { start: 0.0, arc: TAU, balls, thread: 0, body: 0, flanks, offset: 0.0 }
}

/// Returns a nut with a nominal diameter of 40 mm, a lead of 10 mm, balls of 6.35 mm and rigid
/// bodies.
fn rigid(circuits: Vec<Circuit>) -> BallNut {
    let (pitch, lead) = (41.336 * MM, 10.0 * MM);
    BallNut {
        helix: Helix { radius: 0.5 * pitch, lead_angle: (lead / (PI * pitch)).atan() },
        starts: 1,
        ball: Ball::of_density(3.175 * MM, 7800.0),
        contact_angle: FRAC_PI_4,
        conformity: Conformities::alike(CONFORMITY),
        material: Materials::alike(STEEL),
        circuits,
        errors: Errors::default(),
        nut_bar: None,
        screw_bar: None,
        ring: None,
        reference: None,
        precession: 0.0,
    }
}

/// Returns a pair of nuts with three loaded turns each.
fn pair() -> BallNut {
    let circuit = |body: usize, flanks: Flanks| Circuit {
        start: if body == 0 { 0.0 } else { 4.0 * TAU },
        arc: 3.0 * TAU,
        body,
        ..one_turn(60, flanks)
    };
    rigid(vec![circuit(0, Flanks::Plus), circuit(1, Flanks::Minus)])
}

/// Checks two load ratios for a preloaded pair. The first is the load that unloads one nut, divided
/// by the preload. The second is the load on the more heavily loaded nut, divided by the preload,
/// if the external load equals the preload.
fn limit_loads() -> Vec<Check> {
    let over = |preload: f64| -> Result<[f64; 2], NutError> {
        let (nut, guided) = (pair(), Support::guided(0.0));
        let offset = nut.preload_displacement(PreloadKind::Offset, preload, &guided)?;
        let nut = nut.preloaded(PreloadKind::Offset, offset);
        let limit = nut.limit_load(PreloadKind::Offset, &guided, 1.0)?;
        let busier = nut.solve(&Support::guided(preload))?.bodies[0];
        Ok([limit / preload, busier / preload])
    };
    // The preloads are 0.001 %, 2 % and 10 % of the dynamic load rating C_a, which is 43 kN for
    // each nut.
    let [light, usual, heavy] =
        [0.4, 860.0, 4300.0].map(|preload| over(preload).unwrap_or([f64::NAN; 2]));
    let check = |key: &str, claim: &str| Check::new(key, STEINMEYER, claim);
    let hertz = 2.0_f64.powf(1.5);
    let claim = "one nut of a pair unloads at 2.83 times the preload";
    let turned = "4 %: contact angles change under the preload, but the claim assumes that they are constant";
    vec![
        check("nut/limit-load-light", claim).measured(light[0], "preloads").equals(
            hertz,
            1e-3,
            "contact angles change by 1e-4 under such a small preload",
        ),
        check("nut/limit-load-usual", claim).measured(usual[0], "preloads").equals(
            hertz,
            0.04 * hertz,
            turned,
        ),
        check("nut/limit-load-heavy", claim).measured(heavy[0], "preloads").equals(
            hertz,
            0.04 * hertz,
            turned,
        ),
        check("nut/busier-nut", "load of the more heavily loaded nut if the axial load is equal to the preload")
            .measured(usual[1], "preloads")
            .equals(
                (1.0 + 1.0 / hertz).powf(1.5),
                0.04,
                "the formula assumes that the remaining preload is linear in the load; its result is 2 % too high",
            ),
    ]
}

/// A row of the catalog, which contains the stiffness of a single nut and of a pair with the same
/// balls.
#[derive(Deserialize)]
#[expect(non_snake_case, reason = "columns of the table")]
struct CatalogRow {
    nut: String,
    lead_mm: f64,
    ball_diameter_mm: f64,
    core_mm: f64,
    outer_diameter_mm: f64,
    dynamic_load_rating_N: f64,
    static_load_rating_N: f64,
    single_N_um: f64,
    pair_N_um: f64,
}

/// Ratios of the stiffness in the catalog to the calculated stiffness. The calculations include
/// different elastic parts.
struct Ratios {
    /// Stiffness ratios for a single nut at 0.3 times the load rating. The three values are
    /// calculated with the contacts only, with contacts and ring, and with contacts, ring and bars.
    single: [f64; 3],
    /// Ratios of the stiffness in the catalog to the calculated stiffness, for a pair with a
    /// preload of 0.1 times the load rating. The calculations include contacts and ring. The three
    /// values are calculated with three definitions of the stiffness: 2, 2^1.5 and 3 times F_p/δ_p.
    pair: [f64; 3],
}

impl CatalogRow {
    /// Calculates the stiffness of the nut from its other catalog data. Returns the ratios of the
    /// stiffness in the catalog to the calculated stiffness.
    fn ratios(&self) -> Result<Ratios, NutError> {
        let ball = self.ball_diameter_mm;
        let deep = 2.0 * (CONFORMITY - 0.5) * ball * (1.0 - FRAC_PI_4.cos());
        let pitch = self.core_mm + ball + deep;
        let (lead, turn) = (self.lead_mm * MM, (PI * pitch).hypot(self.lead_mm) / ball);
        let one = Nut {
            ball_diameter: ball * MM,
            pitch_diameter: pitch * MM,
            lead,
            contact_angle: FRAC_PI_4,
            conformity: Conformities::alike(CONFORMITY),
            material: Materials::alike(STEEL),
            starts: 1.0,
            balls_per_turn: 1.0,
            turns: 1.0,
        };
        // The number of balls is calculated from the static load rating by (D5).
        let balls = self.static_load_rating_N / one.static_rating().rating;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "some hundred balls"
        )]
        let whole = balls.round() as usize;
        let arc = TAU * balls / turn;
        let contacts = BallNut {
            helix: Helix { radius: 0.5 * pitch * MM, lead_angle: one.lead_angle() },
            ball: Ball::of_density(0.5 * ball * MM, 7800.0),
            ..rigid(vec![Circuit { arc, ..one_turn(whole, Flanks::Plus) }])
        };
        let outer = self.outer_diameter_mm * MM;
        let [_, inner] = contacts.groove_diameters();
        let youngs_modulus = STEEL.youngs_modulus;
        let ring = Some(Ring { outer_diameter: outer, inner_diameter: inner, youngs_modulus });
        let with_ring = BallNut { ring, ..contacts.clone() };
        let bar = |stiffness: f64| Some(Bar { stiffness, anchor: 0.0 });
        let with_bars = BallNut {
            nut_bar: bar(contacts.nut_stiffness(outer)),
            screw_bar: bar(contacts.screw_stiffness(false)),
            ..with_ring.clone()
        };
        let under = |nut: &BallNut, load: f64| -> Result<f64, NutError> {
            Ok(load / nut.solve(&Support::guided(load))?.displacement[0] * UM)
        };
        let rating = self.dynamic_load_rating_N;
        let secant = |nut: &BallNut| under(nut, 0.3 * rating);
        let preloaded = under(&with_ring, 0.1 * rating)?;
        let models = [secant(&contacts)?, secant(&with_ring)?, secant(&with_bars)?];
        Ok(Ratios {
            single: models.map(|model| self.single_N_um / model),
            pair: [2.0, 2.0_f64.powf(1.5), 3.0].map(|times| self.pair_N_um / (times * preloaded)),
        })
    }
}

/// Returns the mean and the standard deviation of the values.
fn mean_and_deviation(values: &[f64]) -> [f64; 2] {
    #[expect(clippy::cast_precision_loss, reason = "rows of a table")]
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    [mean, (values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n).sqrt()]
}

/// Compares the calculated stiffness of single nuts and of pairs with the stiffness in the catalog.
fn stiffnesses(rows: &[CatalogRow]) -> Vec<Check> {
    let ratios: Vec<_> = rows
        .iter()
        .map(|row| row.ratios().unwrap_or(Ratios { single: [f64::NAN; 3], pair: [f64::NAN; 3] }))
        .collect();
    let of = |read: &dyn Fn(&Ratios) -> f64| {
        let values: Vec<f64> = ratios.iter().map(read).collect();
        let line = |(row, ratio): (&CatalogRow, &f64)| format!("{} {ratio:.3}", row.nut);
        let details: Vec<_> = rows.iter().zip(&values).map(line).collect();
        (mean_and_deviation(&values), details.join("; "))
    };
    let check = |key: &str, claim: &str, read: &dyn Fn(&Ratios) -> f64| {
        let ([mean, deviation], details) = of(read);
        let mut check = Check::new(key, CATALOG, claim)
            .measured(mean, "of the model")
            .note(format!("standard deviation {deviation:.3} over {} nuts", rows.len()));
        check.details = details;
        check
    };
    let usual = "catalogs state 80 % of the calculated stiffness; the tolerance is the scatter between the nuts";
    let single =
        "stiffness FSI of single nuts, load divided by displacement at 0.3 of the load rating";
    let pair = "stiffness FDI of nut pairs at a preload of 0.1 of the load rating";
    let definition = rows.iter().map(|row| row.pair_N_um / row.single_N_um).collect::<Vec<_>>();
    vec![
        check("nut/stiffness-single-contacts", &format!("{single}: contacts alone"), &|r| {
            r.single[0]
        }),
        check("nut/stiffness-single", &format!("{single}: contacts and ring"), &|r| r.single[1])
            .equals(0.8, 0.04, usual),
        check("nut/stiffness-single-bars", &format!("{single}: contacts, ring and bars"), &|r| {
            r.single[2]
        }),
        check("nut/stiffness-pair-2", &format!("{pair}, as 2 F_p/delta_p"), &|r| r.pair[0]),
        check(
            "nut/stiffness-pair",
            &format!("{pair}, as 2^1.5 F_p/delta_p, the secant to the limit load"),
            &|r| r.pair[1],
        )
        .equals(0.8, 0.04, usual),
        check("nut/stiffness-pair-3", &format!("{pair}, as 3 F_p/delta_p"), &|r| r.pair[2]),
        Check::new(
            "nut/stiffness-definition",
            CATALOG,
            "ratio of FDI to FSI, which is 2^1.5 0.1/(0.3^(1/3) 0.1^(2/3)) because their definitions differ",
        )
        .measured(mean_and_deviation(&definition)[0], "")
        .equals(
            2.0_f64.powf(1.5) * 0.1 / (0.3_f64.cbrt() * 0.1_f64.powf(2.0 / 3.0)),
            0.03,
            "the calculation includes only Hertzian contacts, and the catalog values have three \
             digits",
        ),
    ]
}

/// Checks the load on the first ball of a nut with stiff bars, divided by the mean ball load. The
/// first ball is at the end at which the load is highest. For a continuous nut, this ratio is `$\mu
/// l\coth\mu l$` if both anchors are at the same end. If the anchors are at opposite ends, the
/// ratio is the mean of two ratios: the ratio with both anchors at the near end, and the ratio with
/// both anchors at the far end.
fn stiff_bars() -> Vec<Check> {
    let (turns, balls) = (4.0, 4000_u16);
    let nut =
        rigid(vec![Circuit { arc: turns * TAU, ..one_turn(usize::from(balls), Flanks::Plus) }]);
    let load = 6340.0;
    let places = nut.positions();
    let ends = [places.first(), places.last()].map(|place| place.map_or(f64::NAN, |p| p.z));
    let length = (ends[1] - ends[0]) * f64::from(balls) / f64::from(balls - 1);
    let stiffness = nut.equal(load).map_or(f64::NAN, |equal| equal.stiffness);
    let at = |small: f64, screw: f64| -> Result<f64, NutError> {
        // The stiffness of two equal bars follows from μ² l² = k_u l (1/EA_n + 1/EA_s).
        let bar = |anchor: f64| Some(Bar { stiffness: 2.0 * stiffness * length / small, anchor });
        let nut = BallNut { nut_bar: bar(ends[0]), screw_bar: bar(screw), ..nut.clone() };
        let found = nut.solve(&Support::guided(load))?;
        let axial = |i: usize| found.balls[i].force[0];
        let mean = (0..usize::from(balls)).map(axial).sum::<f64>() / f64::from(balls);
        Ok(axial(0) / mean - 1.0)
    };
    let same = |m: f64| m / m.tanh() - 1.0;
    let opposite = |m: f64| 0.5 * (m / m.tanh() + m / m.sinh()) - 1.0;
    let check = |key: &str, claim: &str, small: f64, found: Result<f64, NutError>, exact: f64| {
        let off = found.map_or(f64::NAN, |found| found / exact - 1.0);
        Check::new(key, BARS, claim)
            .measured(off.abs(), "of the excess")
            .note(format!("(mu l)^2 = {small}"))
    };
    let text = |at: &str| format!("excess load of the first ball if stiff bars are anchored {at}");
    let (coarse, fine) = (0.3, 0.03);
    let [one, two] = [coarse, fine].map(|small| {
        let m = f64::sqrt(small);
        check("nut/cosh-same-end", &text("at one end"), small, at(small, ends[0]), same(m))
    });
    let m = f64::sqrt(fine);
    let across = check(
        "nut/cosh-opposite-ends",
        &text("at opposite ends"),
        fine,
        at(fine, ends[1]),
        opposite(m),
    );
    let ratio = one.measured / two.measured;
    let order = Check::new(
        "nut/cosh-order",
        BARS,
        "the difference from the analytical solution decreases with the compliance of the bars",
    )
    .measured(two.measured / one.measured, "")
    .note(format!("if the bars are ten times as stiff, 1/{ratio:.1} of the difference remains"))
    .at_most(
        0.15,
        "one tenth to first order, plus second-order terms and the effect of the ball spacing",
    );
    let reason = "the contact stiffness is not constant, and 4000 balls are not a continuum";
    let [two, across] = [two, across].map(|check| check.at_most(2e-3, reason));
    vec![two, across, order]
}
