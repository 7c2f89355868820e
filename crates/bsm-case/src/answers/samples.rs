//! Random samples of a nut with scattered ball diameters and lead errors.

use bsm_design::groove::FEW_DRAWS;
use bsm_design::statistics::quantile;
use bsm_nut::LeadError;

use super::nut::QUANTITIES;
use crate::vocabulary::error::invalid_input;
use crate::vocabulary::members::{Data, Keyed, Word, answer, row};
use crate::{
    Answer, Case, CaseError, NutProblem, NutReport, OutputName, Quantity, Settings, output,
};

/// Quantities that depend on the random errors of a nut.
const SAMPLED: [OutputName; 6] = [
    output!(max_contact_load_N),
    output!(max_over_mean),
    output!(unloaded_balls),
    output!(max_pressure_MPa),
    output!(nut_stiffness_N_um),
    output!(life_by_balls_revolutions),
];

/// Maximum number of samples.
const MAX_SAMPLES: u64 = 1_000_000;

/// Maximum number of samples for each possible groove. With 200 samples, the 5 % quantile is the
/// tenth smallest value.
const PER_GROOVE: u64 = 200;

/// Random copies of a nut, which differ in their ball diameters and in the phases of their lead
/// errors.
#[derive(Debug)]
pub struct Samples<'a> {
    problem: &'a NutProblem,
    seed: u64,
    /// Indices of the lead-error waves that have random phases.
    waves: Vec<usize>,
}

/// Values of the quantities in [`SAMPLED`] for a random copy; `None` if the copy cannot carry the
/// load or its preload cannot be set.
type DrawnNut = Option<Vec<Option<f64>>>;

row! {
    /// Quantiles of a quantity.
    pub(crate) struct QuantileRow {
        [skip] name: &'static str;
        [skip] about: &'static str = "quantiles";
        [skip] unit: &'static str = "";
        p5: f64 as "0.05" = "5 %";
        p25: f64 as "0.25" = "25 %";
        p50: f64 as "0.5" = "50 %";
        p75: f64 as "0.75" = "75 %";
        p95: f64 as "0.95" = "95 %";
    } unit unit
}

answer! {
    /// Random copies of a nut.
    pub(crate) struct SampleMembers {
        /// Number of random nuts that carry the load.
        carried: Data<usize>;
        /// Number of random nuts that do not carry the load.
        failed: Data<usize>;
        quantiles: Keyed<QuantileRow>;
        [skip] summary: Word;
    }
}

impl<'a> Samples<'a> {
    /// Probabilities of the quantiles that are calculated.
    const PARTS: [f64; 5] = [0.05, 0.25, 0.5, 0.75, 0.95];

    /// Prepares `number` random copies of the nut.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError::Entry`] if nothing in the nut is random, and [`CaseError::OutOfRange`]
    /// if the number of samples is zero or too large.
    pub fn new(problem: &'a NutProblem, number: u64, seed: Option<u64>) -> Result<Self, CaseError> {
        if number == 0 || number > MAX_SAMPLES {
            let rule = format!("from 1 to {MAX_SAMPLES}");
            #[expect(clippy::cast_precision_loss, reason = "a number in a message")]
            let value = number as f64;
            return Err(CaseError::out_of_range("samples", value, rule));
        }
        let wave =
            |(i, error): (usize, &LeadError)| matches!(error, LeadError::Wave { .. }).then_some(i);
        let waves: Vec<_> = problem.nut.errors.lead.iter().enumerate().filter_map(wave).collect();
        if !problem.scatters() && waves.is_empty() {
            let what = "or a wave in lead_error is required for samples, because all samples are identical otherwise";
            let key = "ball_deviation_sd_um".to_owned();
            return Err(invalid_input(key, what));
        }
        Ok(Self { problem, seed: seed.unwrap_or(problem.seed), waves })
    }

    /// Solves the copy with the given index. The result depends only on the seed and the index.
    pub fn solve(&self, number: u64) -> DrawnNut {
        let one = self.problem.with_random_errors(self.seed, number, &self.waves);
        let at_rest = one.solve_without_errors().ok()?;
        Some(NutReport::new(one, at_rest).values_of(&SAMPLED))
    }

    /// Returns the answer with the quantiles of each quantity over all random copies of the nut.
    pub fn answer(nuts: &[DrawnNut], case: &Case) -> Answer {
        let carried: Vec<_> = nuts.iter().flatten().collect();
        let failed = nuts.len() - carried.len();
        let row = |(i, name): (usize, &OutputName)| {
            let quantity = QUANTITIES.iter().find(|quantity| quantity.name == name.name())?;
            let mut values: Vec<_> = carried.iter().filter_map(|numbers| numbers[i]).collect();
            values.sort_by(f64::total_cmp);
            let [p5, p25, p50, p75, p95] = Self::PARTS.map(|part| quantile(&values, part));
            let Quantity { name, about, unit, .. } = *quantity;
            (!values.is_empty()).then_some(QuantileRow {
                name,
                about,
                unit,
                p5,
                p25,
                p50,
                p75,
                p95,
            })
        };
        let quantiles = Keyed(SAMPLED.iter().enumerate().filter_map(row).collect());
        let summary = format!("{} nuts carry the load, but {failed} do not", carried.len());
        let of = Answer { fails: failed > 0, warnings: case.warnings(), ..Answer::default() };
        of.with_members(SampleMembers {
            carried: Data(carried.len()),
            failed: Data(failed),
            quantiles,
            summary: Word("", summary),
        })
    }

    /// Adds the 90 % intervals of the quantiles to an answer, if the groove is estimated.
    ///
    /// * `number`: number of samples in the answer.
    pub fn with_groove_intervals(
        answer: Answer,
        case: &Case,
        settings: &Settings,
        number: u64,
        seed: Option<u64>,
    ) -> Answer {
        let each = number.min(PER_GROOVE);
        let mut answer = answer.with_groove_intervals(case, FEW_DRAWS, |possible| {
            let problem = NutProblem::of(possible, settings).ok()?;
            let samples = Samples::new(&problem, each, seed).ok()?;
            let nuts: Vec<_> = (0..each).map(|i| samples.solve(i)).collect();
            Some(Self::answer(&nuts, possible))
        });
        if case.has_estimated_groove() && each < number {
            answer.notes.push(format!(
                "The intervals of the quantiles are calculated from {PER_GROOVE} samples of each possible groove."
            ));
        }
        answer
    }
}
