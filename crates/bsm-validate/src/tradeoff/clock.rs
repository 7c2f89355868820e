//! Measures the computing time per point for single solves and for batches, and its breakdown.

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

/// Computing times per point \[ns\].
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Times {
    /// Times for single solves and for batches on one core, for each group. The group of all points
    /// comes first.
    pub one_core: Vec<OneCore>,
    /// Time for batches of all points on all cores.
    pub all_cores: f64,
    /// Time for batches of all points on one core with each instruction set, for models with
    /// kernels.
    pub instruction_sets: Vec<(&'static str, f64)>,
}

/// Computing time per point of a group on one core \[ns\], and its breakdown.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct OneCore {
    /// Group of points.
    pub group: Group,
    /// Time from a case to its outputs if points are solved one after the other.
    pub single: Distribution,
    /// Time from input columns to output columns if all points of the group are in one table.
    pub batch: f64,
    /// Time from input columns to output columns for each point, measured with a table of identical
    /// rows.
    pub row: Distribution,
    /// Number of steps of Newton's method and of path-following searches, for the points whose
    /// solution requires steps.
    pub steps: Option<Distribution>,
    /// Number of evaluations of the equations in single solves.
    pub evaluations: Distribution,
    /// Number of nodes on the contact ellipses at which friction was evaluated in single solves.
    pub nodes: Distribution,
    /// Number of searches for the solution or for other solutions in single solves.
    pub searches: Distribution,
    /// Fraction of the points that required a search.
    pub searching: f64,
}

impl Times {
    /// Returns the times of a group, or `None` if the group has no points.
    pub fn of(&self, group: Group) -> Option<&OneCore> {
        self.one_core.iter().find(|times| times.group == group)
    }
}

/// Number of rounds, in each of which all settings take turns. With debug assertions, one round is
/// enough.
const ROUNDS: usize = if cfg!(debug_assertions) { 1 } else { 5 };

/// Minimum duration of a measurement. Shorter measurements would be affected by the resolution of
/// the clock.
const MIN_DURATION: Duration = Duration::from_millis(8);

/// Minimum number of rows in a batch for fast models. With fewer rows, the overhead per batch would
/// dominate.
const BATCH: usize = if cfg!(debug_assertions) { 512 } else { 8192 };

/// Outputs that the batches calculate. The errors are measured for the same outputs.
const OUTPUTS: [&str; 6] = [
    "efficiency",
    "ball_torque_Nm",
    "nut_normal_load_N",
    "screw_normal_load_N",
    "nut_contact_angle_deg",
    "screw_contact_angle_deg",
];

/// Number of identical rows in the table for one point.
const ROWS: usize = 64;

/// The kinds of times that are measured for a setting. Groups are given by their index.
#[derive(Debug, Clone, Copy)]
enum Way {
    Single,
    Row,
    Batch(usize),
    AllCores,
    On(Arch),
}

/// Measures the times of every setting.
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
        .flat_map(|setting| ways(setting, groups.len()).map(move |way| (setting, way)))
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
        let of = |wanted: fn(&Way) -> bool| {
            jobs.iter()
                .zip(&medians)
                .filter(move |((other, way), _)| *other == setting && wanted(way))
                .map(|((_, way), times)| (way, times.as_slice()))
        };
        let each = |wanted| of(wanted).next().map_or(&[][..], |(_, times)| times);
        let (single, row) =
            (each(|way| matches!(way, Way::Single)), each(|way| matches!(way, Way::Row)));
        let batches = of(|way| matches!(way, Way::Batch(_)));
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
            all_cores: each(|way| matches!(way, Way::AllCores))[0],
            instruction_sets: of(|way| matches!(way, Way::On(_)))
                .filter_map(|(way, times)| match way {
                    Way::On(arch) => Some((bsm_simd::name(*arch), times[0])),
                    _ => None,
                })
                .collect(),
        });
    }
    Ok(all)
}

fn ways(setting: &Setting, groups: usize) -> impl Iterator<Item = Way> {
    let lanes = is_quick(&setting.settings).then(bsm_simd::instruction_sets).unwrap_or_default();
    let each = [Way::Single, Way::Row].into_iter().chain((0..groups).map(Way::Batch));
    each.chain([Way::AllCores]).chain(lanes.into_iter().map(Way::On))
}

/// Returns true if a batch takes only nanoseconds per point.
fn is_quick(settings: &Settings) -> bool {
    matches!(settings.model, ModelChoice::Fixed(model) if model != Model::Traction)
}

/// Returns, for each time, the median over the rounds.
fn medians(rounds: &[Vec<f64>]) -> Vec<f64> {
    let median = |place: usize| {
        let mut times: Vec<_> = rounds.iter().map(|times| times[place]).collect();
        times.sort_unstable_by(f64::total_cmp);
        times[times.len() / 2]
    };
    (0..rounds[0].len()).map(median).collect()
}

/// Data that all measurements share.
struct Bench<'a> {
    points: &'a Points,
    /// One table for each group. The group of all points comes first.
    groups: Vec<Chunk>,
    /// For each group, one longer table for fast models.
    long_groups: Vec<Chunk>,
    /// For each point, one table of identical rows.
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

    /// Returns the number of steps and the solver counters for each point.
    #[expect(clippy::cast_precision_loss, reason = "counts are small")]
    fn work(
        &self,
        setting: &Setting,
        work: &mut ModelWorkspace,
    ) -> Result<Vec<(Option<f64>, Cost)>, CaseError> {
        let count = |case: &Case| {
            let problem = case.problem(&setting.settings)?;
            let (solution, cost) = cost_of(|| problem.solve(work));
            let info = solution.solved().and_then(|solved| solved.info);
            Ok((info.map(|info| info.steps as f64), cost))
        };
        self.points.cases.iter().map(count).collect()
    }

    /// Measures the time for each point in single solves, or the time per point in tables \[ns\].
    fn time(
        &self,
        setting: &Setting,
        way: Way,
        work: &mut ModelWorkspace,
    ) -> Result<Vec<f64>, CaseError> {
        let settings = &setting.settings;
        let task = Task::new(Case::default(), *settings, self.outputs.clone());
        let solve = |arch, chunk: &Chunk| {
            black_box(task.solve_on(arch, chunk, &self.points.columns));
        };
        // Slower calculations, which take microseconds per point, do not need longer tables.
        let tables = if is_quick(settings) { &self.long_groups } else { &self.groups };
        let batch = |arch, chunk: &Chunk| {
            per_point(1, chunk.len, |_| {
                solve(arch, chunk);
                Ok(())
            })
        };
        match way {
            Way::Single => {
                let cases = &self.points.cases;
                per_point(cases.len(), 1, |place| {
                    let _ = black_box(black_box(&cases[place]).problem(settings)?.solve(work));
                    Ok(())
                })
            }
            Way::Row => self.one_core.install(|| {
                per_point(self.rows.len(), ROWS, |place| {
                    solve(Arch::new(), &self.rows[place]);
                    Ok(())
                })
            }),
            Way::Batch(place) => self.one_core.install(|| batch(Arch::new(), &tables[place])),
            Way::AllCores => self.all_cores.install(|| batch(Arch::new(), &tables[0])),
            Way::On(arch) => self.one_core.install(|| batch(arch, &tables[0])),
        }
    }
}

/// Measures the time per point \[ns\] for each of `tables` with `rows` points. Calculations are
/// repeated until a measurement takes [`MIN_DURATION`].
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
