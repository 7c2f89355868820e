//! Time of a point, one by one and in batches.

use std::hint::black_box;
use std::time::{Duration, Instant};

use bsm_batch::{Chunk, Column};
use bsm_case::{CaseError, ModelChoice, Output, Scene, Settings};
use bsm_dyn::ModelWorkspace;
use bsm_simd::Arch;
use rayon::{ThreadPool, ThreadPoolBuilder};
use serde::Serialize;

use super::errors::{Group, Reference};
use super::{Dial, Points};
use crate::ValidateError;

/// Times of a point \[ns\], medians.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Times {
    /// From a scene to its outputs, one after the other: all points, then by motion of the balls;
    /// `None` without points.
    pub single: Vec<(Group, Option<f64>)>,
    /// From columns of inputs to columns of outputs, on one core.
    pub batch: f64,
    /// The same on all cores.
    pub batch_all_cores: f64,
    /// On one core with each instruction set, for models that work on several points at a time.
    pub instruction_sets: Vec<(&'static str, f64)>,
}

/// Rounds in which the dials take turns.
const ROUNDS: usize = 5;

/// A measurement takes at least this long: shorter ones tell of the clock.
const LEAST: Duration = Duration::from_millis(8);

/// Rows of a batch of a kernel at least: fewer tell of handing them over.
const BATCH: usize = 8192;

/// Outputs of the batches: those whose errors are measured.
const OUTPUTS: [&str; 6] = [
    "efficiency",
    "screw_torque_Nm",
    "nut_normal_load_N",
    "screw_normal_load_N",
    "nut_contact_angle_deg",
    "screw_contact_angle_deg",
];

/// What is timed of a dial.
#[derive(Debug, Clone, Copy)]
enum Way {
    Single(Group),
    Batch,
    AllCores,
    On(Arch),
}

/// Times of every dial.
pub(super) fn times(
    points: &Points,
    reference: &Reference,
    dials: &[Dial],
    progress: &mut impl FnMut(usize, usize),
) -> Result<Vec<Times>, ValidateError> {
    let bench = Bench::new(points, reference)?;
    let jobs: Vec<_> =
        dials.iter().flat_map(|dial| ways(dial).map(move |way| (dial, way))).collect();
    let mut measured = vec![Vec::with_capacity(ROUNDS); jobs.len()];
    let mut work = ModelWorkspace::default();
    for round in 0..ROUNDS {
        for (i, (job, times)) in jobs.iter().zip(&mut measured).enumerate() {
            times.extend(bench.time(job.0, job.1, &mut work)?);
            progress(round * jobs.len() + i + 1, ROUNDS * jobs.len());
        }
    }
    let medians: Vec<_> = measured.into_iter().map(median).collect();
    let of = |dial: &Dial| {
        let of_dial = jobs.iter().zip(&medians).filter(|((other, _), _)| *other == dial);
        let mut times = Times {
            single: Vec::new(),
            batch: f64::NAN,
            batch_all_cores: f64::NAN,
            instruction_sets: Vec::new(),
        };
        for ((_, way), time) in of_dial {
            let number = time.unwrap_or(f64::NAN);
            match way {
                Way::Single(group) => times.single.push((*group, *time)),
                Way::Batch => times.batch = number,
                Way::AllCores => times.batch_all_cores = number,
                Way::On(arch) => times.instruction_sets.push((bsm_simd::name(*arch), number)),
            }
        }
        times
    };
    Ok(dials.iter().map(of).collect())
}

fn ways(dial: &Dial) -> impl Iterator<Item = Way> {
    let lanes = has_kernel(&dial.settings).then(bsm_simd::instruction_sets).unwrap_or_default();
    let single = Group::ALL.into_iter().map(Way::Single);
    single.chain([Way::Batch, Way::AllCores]).chain(lanes.into_iter().map(Way::On))
}

fn has_kernel(settings: &Settings) -> bool {
    matches!(settings.model, ModelChoice::Fixed(model) if bsm_batch::has_kernel(model))
}

fn median(mut times: Vec<f64>) -> Option<f64> {
    times.sort_unstable_by(f64::total_cmp);
    times.get(times.len() / 2).copied()
}

/// The points in the forms that are timed.
struct Bench<'a> {
    points: &'a Points,
    /// Places of the points of each group.
    groups: Vec<(Group, Vec<usize>)>,
    /// The points over and over.
    many: Chunk,
    outputs: Vec<&'static Output>,
    one_core: ThreadPool,
    all_cores: ThreadPool,
}

impl<'a> Bench<'a> {
    fn new(points: &'a Points, reference: &Reference) -> Result<Self, ValidateError> {
        let chunk = &points.chunk;
        let len = chunk.len * BATCH.div_ceil(chunk.len);
        let repeated = |column: &Column| {
            let mut many = Column::with_capacity(len);
            many.extend((0..len).map(|row| column.cell(row % chunk.len)));
            many
        };
        let inputs = chunk.inputs.iter().map(repeated).collect();
        let groups = Group::ALL.map(|group| (group, reference.places(group).collect()));
        Ok(Self {
            points,
            groups: groups.to_vec(),
            many: Chunk { first: 1, len, inputs, kept: Vec::new() },
            outputs: OUTPUTS.iter().filter_map(|name| Output::named(name)).collect(),
            one_core: ThreadPoolBuilder::new().num_threads(1).build()?,
            all_cores: ThreadPoolBuilder::new().build()?,
        })
    }

    /// Nanoseconds a point; `None` without points.
    fn time(
        &self,
        dial: &Dial,
        way: Way,
        work: &mut ModelWorkspace,
    ) -> Result<Option<f64>, CaseError> {
        let settings = &dial.settings;
        Ok(match way {
            Way::Single(group) => {
                let places = self.groups.iter().find(|(other, _)| *other == group);
                let places = places.map_or(&[][..], |(_, places)| &places[..]);
                if places.is_empty() {
                    return Ok(None);
                }
                Some(per_point(places.len(), || {
                    for place in places {
                        let scene: &Scene = black_box(&self.points.scenes[*place]);
                        let _ = black_box(scene.problem(settings)?.solve(work));
                    }
                    Ok(())
                })?)
            }
            Way::Batch => Some(self.one_core.install(|| self.batch(Arch::new(), settings))?),
            Way::AllCores => Some(self.all_cores.install(|| self.batch(Arch::new(), settings))?),
            Way::On(arch) => Some(self.one_core.install(|| self.batch(arch, settings))?),
        })
    }

    fn batch(&self, arch: Arch, settings: &Settings) -> Result<f64, CaseError> {
        // What takes microseconds a point needs no more of them.
        let chunk = if has_kernel(settings) { &self.many } else { &self.points.chunk };
        let (columns, base) = (&self.points.columns, Scene::default());
        per_point(chunk.len, || {
            black_box(bsm_batch::solve_on(arch, chunk, columns, &base, settings, &self.outputs));
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
