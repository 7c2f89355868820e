//! Checks of grooves that are estimated from load ratings. The estimates are compared with catalog
//! rows whose ball diameters are known, and with an independent implementation.

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::f64::consts::TAU;

use bsm_case::Settings;
use bsm_case::units::{MM, RPM, UM};
use bsm_design::groove::{
    BallProbability, BallReturn, CatalogLine, DRAWS, EstimatedGroove, GrooveEstimate, KnownGroove,
    Prior,
};
use bsm_design::statistics::{Band, quantile};
use bsm_design::{NutBody, NutSet};
use bsm_dyn::model::Auto;
use bsm_dyn::{
    Ball, Conformities, Coulomb, ElasticPoint, Load, Material, Materials, ModelWorkspace,
    OperatingPoint, Problem, Reason,
};
use bsm_kin::{Drive, Helix};
use serde::Deserialize;

use crate::{Check, PublishedData, ValidateError};

const PROTOTYPE: &str = "an independent implementation of theory chapter 21";
const CATALOGS: &str = "catalogs of HIWIN, TBI and THK";

/// Steel of raceways and balls for which the reference bands were calculated. It is also the
/// default steel of a case.
const STEEL: Material = Material { youngs_modulus: 207e9, poisson_ratio: 0.3 };

/// Returns all checks of estimated grooves.
pub(crate) fn checks(published: &PublishedData) -> Result<Vec<Check>, ValidateError> {
    let file: File = published.groove.json()?;
    let name = published.groove.name();
    if file.rows.is_empty() || file.refused.is_empty() {
        return Err(ValidateError::of(
            name,
            "the file contains no rows, so nothing would be checked",
        ));
    }
    let mut checks = Vec::new();
    let mut estimates = Vec::new();
    for row in &file.rows {
        match row.line(Known::default()).estimate() {
            Ok(estimate) => estimates.push((row, estimate)),
            Err(refused) => {
                let nearest = refused.nearest.map(|nearest| nearest.ln_evidence);
                let why =
                    format!("row {} is rejected; logarithm of its evidence: {nearest:?}", row.name);
                return Err(ValidateError::of(name, why));
            }
        }
    }
    checks.extend(against_prototype(&estimates));
    checks.extend(against_prototype_bands(&estimates)?);
    for test_set in TestSet::all(&file) {
        checks.extend(test_set.rates());
        if test_set.limits.is_some() {
            checks.extend(test_set.widths()?);
            checks.extend(test_set.contained()?);
        }
    }
    checks.extend(refusals(&file));
    Ok(checks)
}

/// A set of catalog rows, and the prior with which the groove of each row is estimated.
struct TestSet<'a> {
    /// Word that identifies this set of rows in the keys of its checks.
    key: String,
    /// Description of the rows to which the prior was fitted, and of the rows whose grooves are
    /// estimated.
    words: String,
    rows: Vec<(&'a Row, Prior)>,
    /// Reason why the results must be within limits; `None` if no limits apply to the results.
    limits: Option<&'static str>,
}

impl<'a> TestSet<'a> {
    /// Returns three kinds of sets: all rows, with the built-in prior; each half of the rows, with
    /// a prior that is fitted to the other half; and the rows of each manufacturer, with a prior
    /// that is fitted to the other manufacturers.
    fn all(file: &'a File) -> Vec<Self> {
        let is_fit = file.half == FITTED;
        let relation = if is_fit { "fitted to the same rows" } else { "fitted to other rows" };
        let limits = "required for rows that were not used to fit the prior";
        let usual = Self {
            key: "usual".to_owned(),
            words: format!("built-in prior, {relation}"),
            rows: file.rows.iter().map(|row| (row, Prior::USUAL)).collect(),
            limits: (!is_fit).then_some(limits),
        };
        // The rows are sorted by series and size, so each half, which consists of every second row,
        // contains all series and sizes.
        let halves = [0, 1].map(|half| {
            let is_in = move |place: &usize| place % 2 == half;
            let all = || file.rows.iter().enumerate();
            let fit = all().filter(|(place, _)| !is_in(place)).map(|(_, row)| row);
            let prior = fitted(&fit.collect::<Vec<_>>());
            let tested = all().filter(move |(place, _)| is_in(place));
            tested.map(|(_, row)| (row, prior.clone())).collect::<Vec<_>>()
        });
        let halves = Self {
            key: "other-half".to_owned(),
            words: "prior fitted to every second row and tested on the other rows, and vice versa"
                .to_owned(),
            rows: halves.concat(),
            limits: Some(limits),
        };
        let makers: BTreeSet<&str> = file.rows.iter().map(|row| row.maker.as_str()).collect();
        let of_maker = |maker: &str| {
            let is_own = |row: &&Row| row.maker == maker;
            let others: Vec<_> = file.rows.iter().filter(|row| !is_own(row)).collect();
            let prior = fitted(&others);
            Self {
                key: format!("new-maker-{maker}"),
                words: format!(
                    "prior fitted to all manufacturers except {maker}, tested on {maker}"
                ),
                rows: file.rows.iter().filter(is_own).map(|row| (row, prior.clone())).collect(),
                limits: None,
            }
        };
        [usual, halves].into_iter().chain(makers.into_iter().map(of_maker)).collect()
    }

    /// Returns the text of a claim, followed by the number of rows and the description of this set
    /// of rows.
    fn claim(&self, what: &str) -> String {
        format!("{what}, {} rows; {}", self.rows.len(), self.words)
    }

    /// Returns the rows and their estimated grooves. Rows that no groove fits are left out.
    fn estimates(&self) -> impl Iterator<Item = (&'a Row, GrooveEstimate)> {
        let estimate = |(row, prior): &(&'a Row, Prior)| {
            Some((*row, row.line(Known::default()).estimate_with(prior).ok()?))
        };
        self.rows.iter().filter_map(estimate)
    }
}

/// Value of the field `half` in the catalog rows to which the built-in prior was fitted.
const FITTED: &str = "public";

/// Fits a prior to catalog rows. All manufacturers have the same total weight.
fn fitted(rows: &[&Row]) -> Prior {
    let known = |row: &&Row| {
        #[expect(clippy::cast_precision_loss, reason = "a few hundred rows")]
        let of_maker = rows.iter().filter(|other| other.maker == row.maker).count() as f64;
        Some(KnownGroove {
            line: row.sizes.line(),
            ball_diameter: row.truth.ball_diameter_mm * MM,
            turns: row.truth.printed_turns,
            ball_return: ball_return(&row.series)?,
            weight: of_maker.recip(),
        })
    };
    Prior::fitted(&rows.iter().filter_map(known).collect::<Vec<_>>())
}

/// Returns the type of ball return that the catalog states for a series, or `None` for an unknown
/// series. Nuts of the series SFU have deflectors, but their load ratings are calculated for full
/// turns.
fn ball_return(series: &str) -> Option<BallReturn> {
    match series {
        "FSC" | "FSCDIN" | "SFH" | "SFY" | "SFU" | "BLK" | "WGF" | "WTF" => {
            Some(BallReturn::FullTurn)
        }
        "BNF" | "BNFN" => Some(BallReturn::Tube),
        "FSI" | "DK" => Some(BallReturn::Deflector),
        _ => None,
    }
}

#[derive(Deserialize)]
struct File {
    /// Origin of the rows. It is [`FITTED`] if the built-in prior was fitted to these rows, and any
    /// other word otherwise.
    half: String,
    rows: Vec<Row>,
    /// Catalog rows with misprints, for which the estimate must be rejected.
    refused: Vec<Misprint>,
}

#[derive(Deserialize)]
struct Row {
    maker: String,
    series: String,
    name: String,
    #[serde(flatten)]
    sizes: Sizes,
    truth: Truth,
    prototype: Prototype,
}

#[derive(Deserialize)]
struct Misprint {
    name: String,
    ln_evidence: f64,
    #[serde(flatten)]
    sizes: Sizes,
}

/// Dimensions and load ratings of a catalog row.
#[derive(Deserialize)]
#[expect(non_snake_case, reason = "columns of the table")]
struct Sizes {
    nominal_diameter_mm: f64,
    lead_mm: f64,
    rated_dynamic_load_N: f64,
    rated_static_load_N: f64,
    core_diameter_mm: Option<f64>,
}

#[derive(Deserialize)]
struct Truth {
    ball_diameter_mm: f64,
    printed_turns: f64,
}

/// Results of the independent implementation. Three numbers in a list are the 5 %, 50 % and 95 %
/// quantiles.
#[derive(Deserialize)]
struct Prototype {
    ln_evidence: f64,
    balls: Vec<(f64, f64)>,
    ball_set_90: Vec<f64>,
    loaded_balls: [f64; 3],
    best: Best,
    at_a_tenth_of_the_dynamic_rating: Bands,
}

#[derive(Deserialize)]
struct Best {
    ball_diameter_mm: f64,
    loaded_turns: f64,
    loaded_balls: f64,
}

#[derive(Deserialize)]
#[expect(non_snake_case, reason = "keys of the file")]
struct Bands {
    friction_torque_Nm: [f64; 3],
    screw_max_pressure_MPa: [f64; 3],
    secant_contact_stiffness_N_um: [f64; 3],
}

/// Quantities that are known in addition to nominal diameter, lead and dynamic load rating.
#[derive(Clone, Copy)]
struct Known {
    static_rating: bool,
    turns: bool,
    core: bool,
}

impl Default for Known {
    /// By default, both load ratings are known.
    fn default() -> Self {
        Self { static_rating: true, turns: false, core: false }
    }
}

impl Sizes {
    /// Returns a catalog line with nominal diameter, lead and both load ratings.
    fn line(&self) -> CatalogLine {
        CatalogLine {
            nominal_diameter: self.nominal_diameter_mm * MM,
            lead: self.lead_mm * MM,
            dynamic_rating: self.rated_dynamic_load_N,
            static_rating: Some(self.rated_static_load_N),
            ball_diameter: None,
            pitch_diameter: None,
            core: None,
            turns: None,
            conformity: Conformities::alike(None),
            contact_angle: None,
        }
    }
}

impl Row {
    /// Returns a catalog line with the known quantities. A core diameter that the catalog does not
    /// print is left out.
    fn line(&self, known: Known) -> CatalogLine {
        let line = self.sizes.line();
        CatalogLine {
            static_rating: line.static_rating.filter(|_| known.static_rating),
            turns: known.turns.then_some(self.truth.printed_turns),
            core: self.sizes.core_diameter_mm.filter(|_| known.core).map(|core| core * MM),
            ..line
        }
    }

    /// Returns true if a ball diameter \[m\] equals the true ball diameter to within the given
    /// relative tolerance.
    fn has_ball(&self, ball: f64, tolerance: f64) -> bool {
        (ball / MM / self.truth.ball_diameter_mm - 1.0).abs() <= tolerance
    }
}

/// Maximum relative difference between two ball diameters that count as equal. Catalogs round ball
/// diameters to 0.01 mm or to three digits.
const SAME_BALL: f64 = 0.006;

/// Returns the largest value, and the name of the row to which it belongs.
fn worst<'a>(values: impl IntoIterator<Item = (&'a str, f64)>) -> (&'a str, f64) {
    // The function `total_cmp` sorts NaN as the largest value, so NaN is returned if there is one.
    values.into_iter().max_by(|one, other| one.1.total_cmp(&other.1)).unwrap_or(("", f64::NAN))
}

/// Returns the relative difference between two numbers.
fn relative(ours: f64, theirs: f64) -> f64 {
    (ours / theirs - 1.0).abs()
}

/// Compares the estimated grooves of all rows with the results of the independent implementation.
fn against_prototype(estimates: &[(&Row, GrooveEstimate)]) -> Vec<Check> {
    let check = |key: &str, claim: &str, difference: &dyn Fn(&Row, &GrooveEstimate) -> f64| {
        let (name, value) =
            worst(estimates.iter().map(|(row, found)| (row.name.as_str(), difference(row, found))));
        Check::new(
            key,
            PROTOTYPE,
            format!("{claim}: largest difference in {} rows", estimates.len()),
        )
        .measured(value, "")
        .note(format!("largest at {name}"))
    };
    let probability = |estimate: &GrooveEstimate, ball: f64| {
        let same = |found: &&BallProbability| (found.ball_diameter / MM - ball).abs() < 1e-6;
        estimate.balls.iter().find(same).map_or(f64::NAN, |found| found.probability)
    };
    let other_best = |row: &Row, estimate: &GrooveEstimate| {
        let (best, theirs) = (estimate.best(), &row.prototype.best);
        let mut likely: Vec<_> =
            estimate.likely_balls().iter().map(|ball| ball.ball_diameter / MM).collect();
        likely.sort_by(f64::total_cmp);
        let other_set = likely.len() != row.prototype.ball_set_90.len()
            || likely.iter().zip(&row.prototype.ball_set_90).any(|(a, b)| (a - b).abs() > 1e-6);
        let same = (best.ball_diameter / MM - theirs.ball_diameter_mm).abs() < 1e-6
            && (best.turns - theirs.loaded_turns).abs() < 1e-6
            && (best.loaded_balls - theirs.loaded_balls).abs() < 1e-6;
        f64::from(u8::from(!same || other_set))
    };
    vec![
        check("groove/evidence", "logarithm of the evidence", &|row, found| {
            (found.ln_evidence - row.prototype.ln_evidence).abs()
        })
        .at_most(1e-3, "three decimals"),
        check("groove/probabilities", "probabilities of the most likely balls", &|row, found| {
            let differences =
                row.prototype.balls.iter().map(|(ball, p)| (probability(found, *ball) - p).abs());
            worst(differences.map(|difference| ("", difference))).1
        })
        .at_most(1e-4, "four decimals"),
        check("groove/loaded-balls", "quantiles of the number of loaded balls", &|row, found| {
            let quantiles = [0.05, 0.5, 0.95].map(|part| found.loaded_balls_quantile(part));
            let pairs = quantiles.into_iter().zip(row.prototype.loaded_balls);
            worst(pairs.map(|(ours, theirs)| ("", relative(ours, theirs)))).1
        })
        .at_most(1e-3, "four digits"),
        check(
            "groove/best",
            "rows with a different best groove or different likely balls",
            &other_best,
        )
        .at_most(
            0.0,
            "both implementations must find equal ball diameters, turns and numbers of balls",
        ),
    ]
}

/// A result that depends on the groove, and for which the independent implementation states a band.
struct BandQuantity {
    key: &'static str,
    words: &'static str,
    /// Function that calculates the result for a groove, a lead \[m\] and a load \[N\].
    value: GrooveValue,
    reference: fn(&Bands) -> [f64; 3],
    /// Relative tolerance of the limits of the band, and the reason for this tolerance.
    tolerance: (f64, &'static str),
    /// Largest permitted median ratio of the upper to the lower limit of the band.
    widest: f64,
}

type GrooveValue = fn(&EstimatedGroove, lead: f64, load: f64) -> Result<f64, Reason>;

const BAND_QUANTITIES: [BandQuantity; 3] = [
    BandQuantity {
        key: "torque",
        words: "friction torque of the contacts",
        value: friction_torque,
        reference: |bands| bands.friction_torque_Nm,
        tolerance: (1e-4, "five digits"),
        widest: 1.5,
    },
    BandQuantity {
        key: "stiffness",
        words: "secant stiffness of the contacts",
        value: stiffness,
        reference: |bands| bands.secant_contact_stiffness_N_um,
        tolerance: (1e-4, "five digits"),
        widest: 1.6,
    },
    BandQuantity {
        key: "pressure",
        words: "largest pressure at the screw",
        value: pressure,
        reference: |bands| bands.screw_max_pressure_MPa,
        tolerance: (
            0.01,
            "1 %: in the reference, contact angles increase with the load, which reduces the contact pressures by up to 1 %",
        ),
        widest: 1.35,
    },
];

thread_local! {
    /// Workspace of the models. Each thread uses the same workspace for all its calculations.
    static WORK: RefCell<ModelWorkspace> = RefCell::default();
}

/// Friction coefficient with which the reference torques were calculated.
const FRICTION: f64 = 0.08;
/// Screw speed at which the reference torques were calculated \[rad/s\].
const SPEED: f64 = 500.0 * RPM;
/// Ball density with which the reference torques were calculated \[kg/m³\].
const DENSITY: f64 = 7800.0;

/// Returns the friction torque of the contacts \[N·m\]. As in the reference, it is calculated with
/// model `auto`.
fn friction_torque(groove: &EstimatedGroove, lead: f64, load: f64) -> Result<f64, Reason> {
    let nut = groove.nut(lead, Materials::alike(STEEL));
    let point = OperatingPoint {
        helix: Helix { radius: 0.5 * groove.pitch_diameter, lead_angle: nut.lead_angle() },
        contact_angle: groove.contact_angle,
        ball: Ball::of_density(0.5 * groove.ball_diameter, DENSITY),
        friction: Coulomb(FRICTION),
        drive: Drive { screw_speed: SPEED, nut_speed: 0.0 },
        load: Load { axial: load, balls: groove.loaded_balls },
    };
    let at =
        ElasticPoint { point, conformity: groove.conformity, material: Materials::alike(STEEL) };
    let problem = Problem::Auto(Auto { screw: at, tolerance: Settings::default().tolerance });
    let solution = WORK.with_borrow_mut(|work| problem.solve(work));
    if let Some(reason) = solution.reason() {
        return Err(reason.clone());
    }
    let torque = solution.steady_state().and_then(|solved| solved.transmission.screw_torque);
    let torque =
        torque.expect("every model that auto can choose calculates the torque of a turning screw");
    Ok(torque - lead / TAU * load)
}

/// Returns the secant stiffness of the contacts \[N/µm\].
fn stiffness(groove: &EstimatedGroove, lead: f64, load: f64) -> Result<f64, Reason> {
    let nut = groove.nut(lead, Materials::alike(STEEL));
    Ok(nut.elasticity(&NutBody::usual(&nut, NutSet::Single))?.secant(load) * UM)
}

/// Returns the largest contact pressure at the screw \[MPa\], assuming equal ball loads and the
/// unloaded contact angle.
fn pressure(groove: &EstimatedGroove, lead: f64, load: f64) -> Result<f64, Reason> {
    let nut = groove.nut(lead, Materials::alike(STEEL));
    let [_, screw] = nut.hertz()?;
    let direction = groove.contact_angle.sin() * nut.lead_angle().cos();
    Ok(screw.max_pressure(load / (groove.loaded_balls * direction)) * 1e-6)
}

/// Returns the band of a result over the possible grooves. The load is a tenth of the dynamic load
/// rating.
fn band(estimate: &GrooveEstimate, value: GrooveValue) -> Result<Band, Reason> {
    let (lead, load) = (estimate.line.lead, 0.1 * estimate.line.dynamic_rating);
    let values: Result<Vec<_>, _> =
        estimate.draws(DRAWS).iter().map(|groove| value(groove, lead, load)).collect();
    Ok(Band::of(values?).expect("there are draws"))
}

/// Sets of quantities that are assumed to be known, each with a key and a description.
const KNOWN: [(&str, &str, Known); 5] = {
    let line = Known { static_rating: true, turns: false, core: false };
    [
        ("dynamic-rating", "dynamic rating alone", Known { static_rating: false, ..line }),
        ("line", "both ratings", line),
        ("turns", "both ratings and turns", Known { turns: true, ..line }),
        ("core", "both ratings and core diameter", Known { core: true, ..line }),
        (
            "turns-core",
            "both ratings, turns and core diameter",
            Known { turns: true, core: true, ..line },
        ),
    ]
};

impl TestSet<'_> {
    /// Determines, for each set of known quantities, how often the most likely ball diameter is
    /// correct, and how often the correct diameter is among the likely diameters.
    fn rates(&self) -> Vec<Check> {
        let mut checks = Vec::new();
        for (key, words, known) in KNOWN {
            let rates = Rates::of(&self.rows, known);
            let check = |what: &str, claim: &str| {
                let key = format!("groove/{}/{what}-{key}", self.key);
                Check::new(&key, CATALOGS, self.claim(&format!("{claim} from {words}")))
            };
            let first =
                check("first-ball", "most likely ball is correct").measured(rates.first, "");
            let first = first.note(format!(
                "ball diameter within 7 %: {:.2}; rows rejected: {:.3}",
                rates.near, rates.refused
            ));
            let likely = check("likely-balls", "correct ball is among the likely balls");
            let likely = likely.measured(rates.likely, "");
            let size = check("number-of-likely-balls", "mean number of likely balls");
            let size = size.measured(rates.set_size, "");
            checks.extend(match self.limits.filter(|_| key == "line") {
                Some(reason) => [
                    first.at_least(0.87, reason),
                    likely.at_least(0.93, reason),
                    size.at_most(3.0, "a longer list of likely balls would not be useful"),
                ],
                None => [first, likely, size],
            });
        }
        checks
    }
}

/// Fractions of the rows for which an estimate is correct or is rejected, and the mean number of
/// likely ball diameters.
#[derive(Default)]
struct Rates {
    first: f64,
    near: f64,
    likely: f64,
    set_size: f64,
    refused: f64,
}

impl Rates {
    fn of(rows: &[(&Row, Prior)], known: Known) -> Self {
        let mut rates = Self::default();
        #[expect(clippy::cast_precision_loss, reason = "a few hundred rows")]
        let share = (rows.len() as f64).recip();
        let part = |holds: bool| if holds { share } else { 0.0 };
        for (row, prior) in rows {
            let Ok(estimate) = row.line(known).estimate_with(prior) else {
                rates.refused += share;
                continue;
            };
            let ball = estimate.balls[0].ball_diameter;
            rates.first += part(row.has_ball(ball, SAME_BALL));
            rates.near += part(row.has_ball(ball, 0.07));
            let likely = estimate.likely_balls();
            rates.likely +=
                part(likely.iter().any(|found| row.has_ball(found.ball_diameter, SAME_BALL)));
            #[expect(clippy::cast_precision_loss, reason = "at most 33 balls")]
            let size = likely.len() as f64;
            rates.set_size += share * size;
        }
        rates
    }
}

/// Compares the bands for all rows with the bands of the independent implementation.
fn against_prototype_bands(
    estimates: &[(&Row, GrooveEstimate)],
) -> Result<Vec<Check>, ValidateError> {
    let mut checks = Vec::new();
    for BandQuantity { key, words, value, reference, tolerance, .. } in BAND_QUANTITIES {
        let mut differences = Vec::new();
        for (row, found) in estimates {
            let band = band_of(row, found, value)?;
            let [low, _, high] = reference(&row.prototype.at_a_tenth_of_the_dynamic_rating);
            let off = relative(band.low, low).max(relative(band.high, high));
            differences.push((row.name.as_str(), off));
        }
        let (name, difference) = worst(differences);
        let claim = format!(
            "band for the {words}: largest relative difference in {} rows",
            estimates.len()
        );
        let equal = Check::new(&format!("groove/{key}-band"), PROTOTYPE, claim);
        let equal = equal.measured(difference, "").note(format!("largest at {name}"));
        checks.push(equal.at_most(tolerance.0, tolerance.1));
    }
    Ok(checks)
}

/// Returns the band of a result over the possible grooves of a catalog row.
fn band_of(row: &Row, found: &GrooveEstimate, value: GrooveValue) -> Result<Band, ValidateError> {
    band(found, value).map_err(|why| ValidateError::of(&row.name, format!("{why:?}")))
}

impl TestSet<'_> {
    /// Calculates, for each result, the median width of its band over all rows.
    fn widths(&self) -> Result<Vec<Check>, ValidateError> {
        let mut checks = Vec::new();
        for BandQuantity { key, words, value, widest, .. } in BAND_QUANTITIES {
            let width = |(row, found): (&Row, GrooveEstimate)| {
                band_of(row, &found, value).map(|band| band.high / band.low)
            };
            let mut widths = self.estimates().map(width).collect::<Result<Vec<_>, _>>()?;
            widths.sort_by(f64::total_cmp);
            let claim = self.claim(&format!(
                "ratio of upper to lower limit of the band for the {words} (median)"
            ));
            let width = Check::new(&format!("groove/{}/{key}-width", self.key), CATALOGS, claim);
            let width = width.measured(quantile(&widths, 0.5), "");
            checks.push(
                width.at_most(widest, "required for rows that were not used to fit the prior"),
            );
        }
        Ok(checks)
    }

    /// Determines how often the band of a result contains the value for the true groove. The true
    /// groove is the groove that is estimated if ball diameter and number of turns are known.
    fn contained(&self) -> Result<Vec<Check>, ValidateError> {
        let mut checks = Vec::new();
        for BandQuantity { key, words, value, .. } in BAND_QUANTITIES {
            let (mut known, mut inside) = (0.0, 0.0);
            for (row, found) in self.estimates() {
                let line = CatalogLine {
                    ball_diameter: Some(row.truth.ball_diameter_mm * MM),
                    ..row.line(Known { turns: true, ..Known::default() })
                };
                // Rows whose printed ball diameter contradicts the load ratings are skipped.
                let Ok(exact) = line.estimate() else { continue };
                let failed = |why| ValidateError::of(&row.name, format!("{why:?}"));
                let load = 0.1 * line.dynamic_rating;
                let exact = value(&exact.best(), line.lead, load).map_err(failed)?;
                let Band { low, high } = band_of(row, &found, value)?;
                known += 1.0;
                inside += f64::from(u8::from((low..=high).contains(&exact)));
            }
            let claim = self.claim(&format!(
                "fraction of {known} rows in which the band for the {words} contains the value for the known ball and turns"
            ));
            let check =
                Check::new(&format!("groove/{}/{key}-contained", self.key), CATALOGS, claim);
            checks.push(check.measured(inside / known, "").at_least(0.9, "a 90 % band"));
        }
        Ok(checks)
    }
}

/// A function that inserts a mistake into a catalog row.
type Corruption = fn(CatalogLine) -> CatalogLine;

/// Checks that the estimate is rejected for catalog rows with mistakes.
fn refusals(file: &File) -> Vec<Check> {
    let misprints = file.refused.iter().map(|row| {
        let refused = row.sizes.line().estimate().err().and_then(|refused| refused.nearest);
        let measured = refused.map_or(f64::NAN, |nearest| nearest.ln_evidence);
        Check::new(
            &format!("groove/misprint-{}", row.name),
            CATALOGS,
            "row with a misprinted static load rating is rejected",
        )
        .measured(measured, "")
        .equals(
            row.ln_evidence,
            0.05,
            "the logarithm of the evidence is printed with one decimal",
        )
    });
    let corruptions: [(&str, &str, Corruption); 2] = [
        ("static-times-10", "static rating times 10", |line| CatalogLine {
            static_rating: line.static_rating.map(|rating| 10.0 * rating),
            ..line
        }),
        ("kgf", "ratings in kgf read as N", |line| CatalogLine {
            dynamic_rating: line.dynamic_rating / 9.806_65,
            static_rating: line.static_rating.map(|rating| rating / 9.806_65),
            ..line
        }),
    ];
    let corrupted = corruptions.into_iter().map(|(key, words, corrupt)| {
        let refused = |row: &&Row| corrupt(row.line(Known::default())).estimate().is_err();
        #[expect(clippy::cast_precision_loss, reason = "a few hundred rows")]
        let [refused, rows] =
            [file.rows.iter().filter(refused).count(), file.rows.len()].map(|n| n as f64);
        Check::new(
            &format!("groove/refused-{key}"),
            CATALOGS,
            format!("{words}: fraction of {rows} rows that are rejected"),
        )
        .measured(refused / rows, "")
        .at_least(0.99, "an error by a factor of 10 must be detected")
    });
    misprints.chain(corrupted).collect()
}
