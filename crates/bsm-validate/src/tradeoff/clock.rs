//! Measures calculation times and solver counters per point, for points that are solved one by one
//! or as a table.

use std::hint::black_box;
use std::time::{Duration, Instant};

use bsm_batch::{Chunk, Task};
use bsm_case::{Case, CaseError, ModelChoice, Output, Settings};
use bsm_dyn::{Cost, Model, ModelWorkspace, cost_of};
use bsm_simd::Arch;
use rayon::{ThreadPool, ThreadPoolBuilder};
use schemars::JsonSchema;
use serde::Serialize;

use super::errors::{Distribution, Group};
use super::{Points, Setting};
use crate::ValidateError;

/// Calculation times per point \[ns\].
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Times {
    /// Times on one core for each group of points. The first group contains all points.
    pub one_core: Vec<OneCore>,
    /// Time per point if all points are solved as a table on all cores.
    pub all_cores: f64,
    /// Time per point with each instruction set, if all points are solved as a table on one core.
    /// The list is empty for models without a kernel.
    pub instruction_sets: Vec<(&'static str, f64)>,
}

/// Calculation times on one core \[ns\] and solver counters for the points of a group.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct OneCore {
    /// Group of points to which the times refer.
    pub group: Group,
    /// Time from a case to its outputs, if the points are solved one by one.
    pub single: Distribution,
    /// Time per point from input columns to output columns, if all points of the group are rows of
    /// one table.
    pub batch: f64,
    /// Time per point from input columns to output columns, measured separately for each point with
    /// a table of identical rows.
    pub row: Distribution,
    /// Number of steps of Newton's method and of path following. Points that were solved without
    /// such steps are left out.
    pub steps: Option<Distribution>,
    /// Number of times that the equations were evaluated to solve a point.
    pub evaluations: Distribution,
    /// Number of quadrature nodes on the contact ellipses at which friction was evaluated to solve
    /// a point.
    pub nodes: Distribution,
    /// Number of searches for a solution or for further solutions of a point.
    pub searches: Distribution,
    /// Fraction of the points for which a search was needed.
    pub searching: f64,
}

impl Times {
    /// Returns the times in a group of points, or `None` if the group contains no points.
    pub fn of(&self, group: Group) -> Option<&OneCore> {
        self.one_core.iter().find(|times| times.group == group)
    }
}

/// Number of rounds. In each round, every setting is measured once. With debug assertions, one
/// round is sufficient.
const ROUNDS: usize = if cfg!(debug_assertions) { 1 } else { 5 };

/// Minimum duration of a measurement. A shorter measurement would be inaccurate because the clock
/// has a limited resolution.
const MIN_DURATION: Duration = Duration::from_millis(8);

/// Minimum number of rows in a table that is solved by a fast model. With fewer rows, the overhead
/// per table would dominate the measurement.
const BATCH: usize = if cfg!(debug_assertions) { 512 } else { 8192 };

/// Outputs that are calculated for the rows of a table. The errors are determined for the same
/// outputs.
const OUTPUTS: [&str; 6] = [
    "efficiency",
    "ball_torque_Nm",
    "nut_normal_load_N",
    "screw_normal_load_N",
    "nut_contact_angle_deg",
    "screw_contact_angle_deg",
];

/// Number of identical rows in the table that is used to measure a single point.
const ROWS: usize = 64;

/// A kind of time that is measured for a setting. The number in `Batch` is the index of a group.
#[derive(Debug, Clone, Copy)]
enum TimeKind {
    Single,
    Row,
    Batch(usize),
    AllCores,
    On(Arch),
}

/// Measures the calculation times of every setting.
#[expect(clippy::cast_precision_loss, reason = "counts are small")]
pub(super) fn times(
    points: &Points,
    groups: &[(Group, Vec<usize>)],
    settings: &[Setting],
    progress: &mut impl FnMut(usize, usize),
) -> Result<Vec<Times>, ValidateError> {
    let bench = Bench::new(points, groups)?;
    let jobs: Vec<_> = settings
        .iter()
        .flat_map(|setting| time_kinds(setting, groups.len()).map(move |kind| (setting, kind)))
        .collect();
    let mut measured = vec![Vec::with_capacity(ROUNDS); jobs.len()];
    let mut work = ModelWorkspace::default();
    for round in 0..ROUNDS {
        for (i, (job, times)) in jobs.iter().zip(&mut measured).enumerate() {
            times.push(bench.time(job.0, job.1, &mut work)?);
            progress(round * jobs.len() + i + 1, ROUNDS * jobs.len());
        }
    }
    let medians: Vec<_> = measured.iter().map(|rounds| medians(rounds)).collect();
    let mut all = Vec::with_capacity(settings.len());
    for setting in settings {
        let of = |wanted: fn(&TimeKind) -> bool| {
            jobs.iter()
                .zip(&medians)
                .filter(move |((other, kind), _)| *other == setting && wanted(kind))
                .map(|((_, kind), times)| (kind, times.as_slice()))
        };
        let each = |wanted| of(wanted).next().map_or(&[][..], |(_, times)| times);
        let (single, row) = (
            each(|kind| matches!(kind, TimeKind::Single)),
            each(|kind| matches!(kind, TimeKind::Row)),
        );
        let batches = of(|kind| matches!(kind, TimeKind::Batch(_)));
        let work = bench.work(setting, &mut work)?;
        let one_core = groups.iter().zip(batches).map(|((group, places), (_, batch))| {
            let over = |of: &dyn Fn(usize) -> Option<f64>| {
                Distribution::of(places.iter().filter_map(|place| of(*place)).collect())
            };
            let count = |of: fn(&Cost) -> usize| over(&|place| Some(of(&work[place].1) as f64));
            let searching = places.iter().filter(|place| work[**place].1.searches > 0).count();
            Some(OneCore {
                group: *group,
                single: over(&|place| Some(single[place]))?,
                batch: batch[0],
                row: over(&|place| Some(row[place]))?,
                steps: over(&|place| work[place].0),
                evaluations: count(|cost| cost.evaluations)?,
                nodes: count(|cost| cost.nodes)?,
                searches: count(|cost| cost.searches)?,
                searching: searching as f64 / places.len() as f64,
            })
        });
        all.push(Times {
            one_core: one_core.flatten().collect(),
            all_cores: each(|kind| matches!(kind, TimeKind::AllCores))[0],
            instruction_sets: of(|kind| matches!(kind, TimeKind::On(_)))
                .filter_map(|(kind, times)| match kind {
                    TimeKind::On(arch) => Some((bsm_simd::name(*arch), times[0])),
                    _ => None,
                })
                .collect(),
        });
    }
    Ok(all)
}

fn time_kinds(setting: &Setting, groups: usize) -> impl Iterator<Item = TimeKind> {
    let lanes = is_quick(&setting.settings).then(bsm_simd::instruction_sets).unwrap_or_default();
    let each =
        [TimeKind::Single, TimeKind::Row].into_iter().chain((0..groups).map(TimeKind::Batch));
    each.chain([TimeKind::AllCores]).chain(lanes.into_iter().map(TimeKind::On))
}

/// Returns true if solving a table takes only nanoseconds per point.
fn is_quick(settings: &Settings) -> bool {
    matches!(settings.model, ModelChoice::Fixed(model) if model != Model::Traction)
}

/// Returns, for each measured time, its median over all rounds.
fn medians(rounds: &[Vec<f64>]) -> Vec<f64> {
    let median = |place: usize| {
        let mut times: Vec<_> = rounds.iter().map(|times| times[place]).collect();
        times.sort_unstable_by(f64::total_cmp);
        times[times.len() / 2]
    };
    (0..rounds[0].len()).map(median).collect()
}

/// Points, tables and thread pools that all measurements use.
struct Bench<'a> {
    points: &'a Points,
    /// One table for each group of points. The first group contains all points.
    groups: Vec<Chunk>,
    /// For each group of points, a longer table that is used for fast models.
    long_groups: Vec<Chunk>,
    /// For each point, a table whose rows are copies of this point.
    rows: Vec<Chunk>,
    outputs: Vec<&'static Output>,
    one_core: ThreadPool,
    all_cores: ThreadPool,
}

impl<'a> Bench<'a> {
    fn new(points: &'a Points, groups: &[(Group, Vec<usize>)]) -> Result<Self, ValidateError> {
        let table = |places: &[usize], len: usize| {
            points.chunk.select(&places.iter().copied().cycle().take(len).collect::<Vec<_>>())
        };
        let long = |places: &Vec<_>| table(places, places.len() * BATCH.div_ceil(places.len()));
        Ok(Self {
            points,
            groups: groups.iter().map(|(_, places)| table(places, places.len())).collect(),
            long_groups: groups.iter().map(|(_, places)| long(places)).collect(),
            rows: (0..points.cases.len()).map(|place| table(&[place], ROWS)).collect(),
            outputs: OUTPUTS.iter().filter_map(|name| Output::named(name)).collect(),
            one_core: ThreadPoolBuilder::new().num_threads(1).build()?,
            all_cores: ThreadPoolBuilder::new().build()?,
        })
    }

    /// Returns the number of solver steps and the solver counters for each point.
    #[expect(clippy::cast_precision_loss, reason = "counts are small")]
    fn work(
        &self,
        setting: &Setting,
        work: &mut ModelWorkspace,
    ) -> Result<Vec<(Option<f64>, Cost)>, CaseError> {
        let count = |case: &Case| {
            let problem = case.problem(&setting.settings)?;
            let (solution, cost) = cost_of(|| problem.solve(work));
            let info = solution.steady_state().and_then(|solved| solved.info);
            Ok((info.map(|info| info.steps as f64), cost))
        };
        self.points.cases.iter().map(count).collect()
    }

    /// Measures the time of each point if the points are solved one by one, or the mean time per
    /// point if they are solved as a table \[ns\].
    fn time(
        &self,
        setting: &Setting,
        kind: TimeKind,
        work: &mut ModelWorkspace,
    ) -> Result<Vec<f64>, CaseError> {
        let settings = &setting.settings;
        let task = Task::new(Case::default(), *settings, self.outputs.clone());
        let solve = |arch, chunk: &Chunk| {
            black_box(task.solve_on(arch, chunk, &self.points.columns));
        };
        // Models that take microseconds per point can be timed with the shorter tables.
        let tables = if is_quick(settings) { &self.long_groups } else { &self.groups };
        let batch = |arch, chunk: &Chunk| {
            per_point(1, chunk.len, |_| {
                solve(arch, chunk);
                Ok(())
            })
        };
        match kind {
            TimeKind::Single => {
                let cases = &self.points.cases;
                per_point(cases.len(), 1, |place| {
                    let _ = black_box(black_box(&cases[place]).problem(settings)?.solve(work));
                    Ok(())
                })
            }
            TimeKind::Row => self.one_core.install(|| {
                per_point(self.rows.len(), ROWS, |place| {
                    solve(Arch::new(), &self.rows[place]);
                    Ok(())
                })
            }),
            TimeKind::Batch(place) => self.one_core.install(|| batch(Arch::new(), &tables[place])),
            TimeKind::AllCores => self.all_cores.install(|| batch(Arch::new(), &tables[0])),
            TimeKind::On(arch) => self.one_core.install(|| batch(arch, &tables[0])),
        }
    }
}

/// Measures the mean time per point \[ns\] for each of several tables, all of which have `rows`
/// points. The calculations are repeated until the measurement has taken [`MIN_DURATION`].
#[expect(clippy::cast_precision_loss, reason = "counts are small")]
fn per_point(
    tables: usize,
    rows: usize,
    mut run: impl FnMut(usize) -> Result<(), CaseError>,
) -> Result<Vec<f64>, CaseError> {
    let mut times = vec![Duration::ZERO; tables];
    let mut runs = 0_usize;
    while times.iter().sum::<Duration>() < MIN_DURATION {
        for (place, time) in times.iter_mut().enumerate() {
            let start = Instant::now();
            run(place)?;
            *time += start.elapsed();
        }
        runs += 1;
    }
    let points = (runs * rows) as f64;
    Ok(times.iter().map(|time| time.as_secs_f64() * 1e9 / points).collect())
}
