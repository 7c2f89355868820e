//! Time of a point, one by one and in batches.

use std::hint::black_box;
use std::time::{Duration, Instant};

use bsm_batch::{Chunk, Columns, Task};
use bsm_case::{CaseError, ModelChoice, Output, Scene, Settings};
use bsm_dyn::{Model, ModelWorkspace};
use bsm_simd::Arch;
use rayon::{ThreadPool, ThreadPoolBuilder};
use serde::Serialize;

use super::errors::Group;
use super::{Dial, Points};
use crate::ValidateError;

/// Times of a point \[ns\], medians.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Times {
    /// One by one and in batches on one core: all points, then by motion of the balls.
    pub one_core: Vec<OneCore>,
    /// In batches of all points on all cores.
    pub all_cores: f64,
    /// In batches of all points on one core with each instruction set, for models whose batches are quick.
    pub instruction_sets: Vec<(&'static str, f64)>,
}

/// Times of a point of a group on one core \[ns\].
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct OneCore {
    /// Which points.
    pub group: Group,
    /// From a scene to its outputs, one after the other.
    pub single: f64,
    /// From columns of inputs to columns of outputs.
    pub batch: f64,
}

impl Times {
    /// Those of a group.
    pub fn of(&self, group: Group) -> Option<&OneCore> {
        self.one_core.iter().find(|times| times.group == group)
    }
}

/// Rounds in which the dials take turns; the times of a build with checks are worth one.
const ROUNDS: usize = if cfg!(debug_assertions) { 1 } else { 5 };

/// A measurement takes at least this long: shorter ones tell of the clock.
const LEAST: Duration = Duration::from_millis(8);

/// Rows of a quick batch at least: fewer tell of handing them over.
const BATCH: usize = if cfg!(debug_assertions) { 512 } else { 8192 };

/// Outputs of the batches: those whose errors are measured.
const OUTPUTS: [&str; 6] = [
    "efficiency",
    "screw_torque_Nm",
    "nut_normal_load_N",
    "screw_normal_load_N",
    "nut_contact_angle_deg",
    "screw_contact_angle_deg",
];

/// What is timed of a dial; groups by their place.
#[derive(Debug, Clone, Copy)]
enum Way {
    Single(usize),
    Batch(usize),
    AllCores,
    On(Arch),
}

/// Times of every dial.
pub(super) fn times(
    points: &Points,
    groups: &[(Group, Vec<usize>)],
    dials: &[Dial],
    progress: &mut impl FnMut(usize, usize),
) -> Result<Vec<Times>, ValidateError> {
    let bench = Bench::new(points, groups)?;
    let jobs: Vec<_> = dials
        .iter()
        .flat_map(|dial| ways(dial, groups.len()).map(move |way| (dial, way)))
        .collect();
    let mut measured = vec![Vec::with_capacity(ROUNDS); jobs.len()];
    let mut work = ModelWorkspace::default();
    for round in 0..ROUNDS {
        for (i, (job, times)) in jobs.iter().zip(&mut measured).enumerate() {
            times.push(bench.time(job.0, job.1, &mut work)?);
            progress(round * jobs.len() + i + 1, ROUNDS * jobs.len());
        }
    }
    let medians: Vec<_> = measured.into_iter().map(median).collect();
    let of = |dial: &Dial| {
        let none = |(group, _): &(Group, _)| OneCore { group: *group, single: 0.0, batch: 0.0 };
        let mut times = Times {
            one_core: groups.iter().map(none).collect(),
            all_cores: 0.0,
            instruction_sets: Vec::new(),
        };
        for ((_, way), time) in jobs.iter().zip(&medians).filter(|((other, _), _)| *other == dial) {
            match way {
                Way::Single(place) => times.one_core[*place].single = *time,
                Way::Batch(place) => times.one_core[*place].batch = *time,
                Way::AllCores => times.all_cores = *time,
                Way::On(arch) => times.instruction_sets.push((bsm_simd::name(*arch), *time)),
            }
        }
        times
    };
    Ok(dials.iter().map(of).collect())
}

fn ways(dial: &Dial, groups: usize) -> impl Iterator<Item = Way> {
    let lanes = is_quick(&dial.settings).then(bsm_simd::instruction_sets).unwrap_or_default();
    let one_core = (0..groups).flat_map(|place| [Way::Single(place), Way::Batch(place)]);
    one_core.chain([Way::AllCores]).chain(lanes.into_iter().map(Way::On))
}

/// True if a batch takes nanoseconds a point.
fn is_quick(settings: &Settings) -> bool {
    matches!(settings.model, ModelChoice::Fixed(model) if model != Model::Traction)
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_unstable_by(f64::total_cmp);
    times[times.len() / 2]
}

/// The points of a group in the forms that are timed.
struct Forms<'a> {
    scenes: Vec<&'a Scene>,
    chunk: Chunk,
    /// The points over and over.
    many: Chunk,
}

impl<'a> Forms<'a> {
    fn of(points: &'a Points, places: &[usize]) -> Self {
        let places_of = |len| places.iter().copied().cycle().take(len).collect::<Vec<_>>();
        let rows = |len: usize| points.chunk.select(&places_of(len));
        Self {
            scenes: places.iter().map(|place| &points.scenes[*place]).collect(),
            chunk: rows(places.len()),
            many: rows(places.len() * BATCH.div_ceil(places.len())),
        }
    }
}

/// All that is timed.
struct Bench<'a> {
    columns: &'a Columns,
    /// The groups, all points first.
    groups: Vec<Forms<'a>>,
    outputs: Vec<&'static Output>,
    one_core: ThreadPool,
    all_cores: ThreadPool,
}

impl<'a> Bench<'a> {
    fn new(points: &'a Points, groups: &[(Group, Vec<usize>)]) -> Result<Self, ValidateError> {
        Ok(Self {
            columns: &points.columns,
            groups: groups.iter().map(|(_, places)| Forms::of(points, places)).collect(),
            outputs: OUTPUTS.iter().filter_map(|name| Output::named(name)).collect(),
            one_core: ThreadPoolBuilder::new().num_threads(1).build()?,
            all_cores: ThreadPoolBuilder::new().build()?,
        })
    }

    /// Nanoseconds a point.
    fn time(&self, dial: &Dial, way: Way, work: &mut ModelWorkspace) -> Result<f64, CaseError> {
        let settings = &dial.settings;
        let batch = |arch, place: usize| self.batch(arch, &self.groups[place], settings);
        match way {
            Way::Single(place) => {
                let scenes = &self.groups[place].scenes;
                per_point(scenes.len(), || {
                    for scene in scenes {
                        let scene: &Scene = black_box(scene);
                        let _ = black_box(scene.problem(settings)?.solve(work));
                    }
                    Ok(())
                })
            }
            Way::Batch(place) => self.one_core.install(|| batch(Arch::new(), place)),
            Way::AllCores => self.all_cores.install(|| batch(Arch::new(), 0)),
            Way::On(arch) => self.one_core.install(|| batch(arch, 0)),
        }
    }

    fn batch(&self, arch: Arch, points: &Forms, settings: &Settings) -> Result<f64, CaseError> {
        // What takes microseconds a point needs no more of them.
        let chunk = if is_quick(settings) { &points.many } else { &points.chunk };
        let task = Task::new(Scene::default(), *settings, self.outputs.clone());
        per_point(chunk.len, || {
            black_box(task.solve_on(arch, chunk, self.columns));
            Ok(())
        })
    }
}

/// Nanoseconds of each of `points`, over as many runs as [`LEAST`] takes.
#[expect(clippy::cast_precision_loss, reason = "counts are small")]
fn per_point(
    points: usize,
    mut run: impl FnMut() -> Result<(), CaseError>,
) -> Result<f64, CaseError> {
    let (start, mut runs) = (Instant::now(), 0_usize);
    loop {
        run()?;
        runs += 1;
        let time = start.elapsed();
        if time >= LEAST {
            return Ok(time.as_secs_f64() * 1e9 / (runs * points) as f64);
        }
    }
}
