//! Measures how long each model takes to evaluate its residual, to linearize its equations, and to
//! solve points. To run this benchmark, use `just bench` or `cargo bench -p bsm-benches`.
#![expect(clippy::print_stderr, reason = "counters are printed next to the times")]

use std::hint::black_box;

use bsm_benches::{lin_problem, seeded};
use bsm_case::Settings;
use bsm_dyn::model::{Rigid, RigidSystem};
use bsm_dyn::{Model, ModelWorkspace, Problem};
use bsm_newton::{Equations, Options, Scales, Workspace, solve};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};

fn lin_rigid() -> Rigid {
    match lin_problem(Model::Rigid) {
        Problem::Rigid(case) => case,
        other => panic!("{other:?}"),
    }
}

/// Measures the time to evaluate the residual and the Jacobian for Lin's case at the first-order
/// starting point.
fn equations(c: &mut Criterion) {
    let system = RigidSystem::of(&lin_rigid()).expect("friction and speed");
    c.bench_function("rigid/residual", |b| {
        b.iter(|| system.residual(black_box(&system.start)));
    });
    let rows = &mut [[0.0; 7]; 7];
    c.bench_function("rigid/linearize", |b| {
        b.iter(|| system.linearize(black_box(&system.start), rows));
    });
    let start = system.start.into();
    c.bench_function("rigid/linearize/num-dual", |b| {
        b.iter(|| num_dual::jacobian(|y| system.evaluate(&y), black_box(&start)));
    });
}

/// Measures the time to solve Lin's case. Each model starts from SI inputs without a previous
/// solution. The rigid model is also started from the root at a load that is 1 % lower, with the
/// same tolerance.
fn one_point(c: &mut Criterion) {
    let mut work = ModelWorkspace::default();
    for model in Model::ALL {
        let problem = lin_problem(model);
        c.bench_function(&format!("{}/solve/cold", model.name()), |b| {
            b.iter(|| black_box(&problem).solve(&mut work));
        });
    }

    let case = lin_rigid();
    let mut neighbor = case;
    neighbor.point.load.axial *= 0.99;
    let memory = &mut Workspace::default();
    let run = |case: &Rigid, from: Option<[f64; 7]>, memory: &mut Workspace<7>| {
        let system = RigidSystem::of(case).expect("friction and speed");
        let mut y = from.unwrap_or(system.start);
        let scales = Scales { x: &[1.0; 7], f: &system.weights };
        let report = solve(&system, &mut y, &scales, &Options::default(), memory).report;
        assert!(report.converged());
        (y, report.steps.len())
    };
    let root = run(&neighbor, None, memory).0;
    let (cold, warm) = (run(&case, None, memory).1, run(&case, Some(root), memory).1);
    eprintln!("rigid/newton: {cold} steps from the first-order start, {warm} from the neighbor");
    c.bench_function("rigid/newton/cold", |b| b.iter(|| run(black_box(&case), None, memory)));
    c.bench_function("rigid/newton/warm", |b| {
        b.iter(|| run(black_box(&case), Some(root), memory));
    });
}

/// Returns the settings of all models. The `traction` model is included with several accuracies,
/// and `auto` with two tolerances.
fn settings() -> Vec<(String, Settings)> {
    let auto = |tolerance| Settings { tolerance, ..Settings::default() };
    let mut all: Vec<_> =
        Model::ALL.into_iter().map(|model| (model.name().to_owned(), model.into())).collect();
    for accuracy in [1e-4, 1e-6] {
        let traction = Settings { accuracy, ..Model::Traction.into() };
        all.push((format!("traction, {accuracy:e}"), traction));
    }
    all.push(("auto, 1e-2".to_owned(), auto(1e-2)));
    all.push(("auto, 1e-4".to_owned(), auto(1e-4)));
    all
}

/// Measures the time to solve a thousand random points, so that the time per element is
/// representative of a typical point.
fn many_points(c: &mut Criterion) {
    const COUNT: usize = 1000;
    eprintln!("{COUNT} seeded points: model | median cold solve, ns | median Newton steps | most");
    let cases = seeded(COUNT);
    let mut work = ModelWorkspace::default();
    let mut group = c.benchmark_group("seeded");
    group.throughput(Throughput::Elements(COUNT as u64)).sample_size(20);
    for (label, settings) in settings() {
        let problems: Vec<_> =
            cases.iter().map(|case| case.problem(&settings).expect("complete case")).collect();
        report_median(&label, &problems, &mut work);
        group.bench_function(label, |b| {
            b.iter(|| {
                for problem in &problems {
                    let _ = black_box(black_box(problem).solve(&mut work));
                }
            });
        });
    }
    group.bench_function("rigid from case", |b| {
        b.iter(|| {
            for case in &cases {
                let problem = case.problem(&Model::Rigid.into()).expect("complete case");
                let _ = black_box(problem.solve(&mut work));
            }
        });
    });
}

/// Prints the median time per point and the median number of steps. The time of a point is the
/// shortest of several solves without a previous solution.
fn report_median(label: &str, problems: &[Problem], work: &mut ModelWorkspace) {
    let mut times: Vec<_> = problems
        .iter()
        .map(|problem| {
            (0..20)
                .map(|_| {
                    let start = std::time::Instant::now();
                    let _ = black_box(black_box(problem).solve(work));
                    start.elapsed().as_nanos()
                })
                .min()
                .unwrap_or_default()
        })
        .collect();
    let mut steps: Vec<_> =
        problems.iter().filter_map(|p| Some(p.solve(work).steady_state()?.info?.steps)).collect();
    times.sort_unstable();
    steps.sort_unstable();
    let middle = problems.len() / 2;
    let word = |steps: Option<&usize>| steps.map_or_else(String::new, ToString::to_string);
    let (typical, most) = (word(steps.get(steps.len() / 2)), word(steps.last()));
    eprintln!("seeded | {label} | {} | {typical} | {most}", times[middle]);
}

criterion_group!(models, equations, one_point, many_points);
criterion_main!(models);
