//! Tests of the plan of a dataset: its text, its id, and its number of rows per part.

use std::num::{NonZeroU64, NonZeroUsize};
use std::sync::atomic::AtomicBool;

use bsm_batch::dataset::{Plan, Points, RESULTS};
use bsm_batch::{Answers, RandomInput, RandomPoints, Task, Workers};
use bsm_case::{Case, Grid, GridAxis, ModelChoice, Output, Settings};
use bsm_dyn::{Control, Model, model::RacewayFriction};

use crate::digest;

static NEVER: AtomicBool = AtomicBool::new(false);

fn workers() -> Workers<'static> {
    Workers::start(NonZeroUsize::new(1), &NEVER).expect("a thread")
}

fn task() -> Task {
    let base = Case { axial_load_N: Some(0.1), ..Case::default() };
    let outputs = Answers::select(Some(&["efficiency".to_owned()])).expect("an output");
    Task::new(base, Settings::from(Model::Rigid), outputs)
}

fn grid(axes: &[&str]) -> Points {
    let axes = axes.iter().map(|axis| GridAxis::parse(axis).expect("an axis")).collect();
    Points::Grid(Grid::new(axes).expect("a grid"))
}

fn plan(task: &Task, points: &Points, rows: u64) -> Plan {
    Plan::new(task, points, NonZeroU64::new(rows), &workers()).expect("a plan")
}

#[test]
fn a_plan_is_one_line_of_canonical_json() {
    let points = grid(&["lead_mm = 5:1e1:11", "screw_speed_rpm=1e300,-0.1,1500.0"]);
    let plan = plan(&task(), &points, 16);
    let version = env!("CARGO_PKG_VERSION");
    let text = |hash: &str| {
        format!(
            "{{\"format\":6,\"program\":{{\"name\":\"bsm\",\"version\":\"{version}\",\
             \"results\":{RESULTS}}},\"points\":{{\"grid\":[\"lead_mm=5:10:11\",\
             \"screw_speed_rpm=1e300,-0.1,1500\"]}},\"base\":{{\"axial_load_N\":0.1}},\
             \"model\":{{\"name\":\"rigid\",\"tolerance\":0.01,\"accuracy\":1e-8,\
             \"creep\":0.0001,\"control\":null,\"friction\":\"local\"}},\"columns\":[\"efficiency\"],\"rows\":33,\
             \"rows_per_part\":16,\"sha256\":\"{hash}\"}}\n"
        )
    };
    assert_eq!(plan.id(), digest::of_bytes(text("").as_bytes()));
    assert_eq!(plan.text(), text(plan.id()));
    let again = Plan::from_text(plan.text()).expect("its own text");
    assert_eq!((again.id(), again.parts(), again.rows()), (plan.id(), 3, 33));
    let last = again.rows() - (again.parts() - 1) * again.rows_per_part();
    assert_eq!(last, 1);
    let read = again.points(|name| name.into(), &workers()).expect("points");
    let (Points::Grid(read), Points::Grid(grid)) = (read, points) else { unreachable!("grids") };
    assert_eq!(read, grid);
    let (a, b) = (task(), again.task().expect("a task"));
    assert_eq!((&a.base, a.settings, a.outputs[0].name), (&b.base, b.settings, b.outputs[0].name));
    for (text, part) in [
        (plan.text().replace("0.0001", "1e-4"), "has been changed"),
        (plan.text().replace("}\n", "}"), "has been changed"),
        (plan.text().replace("load_N\":0.1", "load_N\":0.2"), "has been changed"),
        (text(""), "has been changed"),
        (plan.text().replace("\"format\":6", "\"format\":4"), "format 4"),
        (plan.text().replace(",\"rows\":33", ""), "missing field `rows`"),
        (plan.text().replace("\"name\":\"bsm\"", "\"name\":\"msb\""), "it was made by msb"),
        (String::new(), "EOF"),
    ] {
        let said = Plan::from_text(&text).expect_err("another text").to_string();
        assert!(said.contains(part), "{said}");
    }
}

/// Every setting that affects the results must change the id of the plan, and must be named as a
/// difference between the plans. The id must not depend on the description of the case or on
/// outputs that are only displayed.
#[test]
fn plan_id_changes_with_every_setting_that_affects_results() {
    let points = grid(&["lead_mm=5:10:11"]);
    let first = plan(&task(), &points, 16);
    let with = |change: fn(&mut Task)| {
        let mut task = task();
        change(&mut task);
        plan(&task, &points, 16)
    };
    let same = with(|t| {
        t.base.description = Some("words".to_owned());
        t.watched = Output::named("efficiency");
    });
    assert_eq!(same.id(), first.id());
    assert_eq!(first.differences(same.text()), None);
    let all = |t: &mut Task| t.outputs = Answers::select(None).expect("all");
    for (other, key) in [
        (with(|t| t.base.axial_load_N = Some(0.2)), "base ({\"axial_load_N\":0.2}, now "),
        (with(|t| t.settings.model = Model::Traction.into()), "model"),
        (with(|t| t.settings.tolerance = 0.02), "model"),
        (with(|t| t.settings.creep = 0.02), "model"),
        (with(|t| t.settings.control = Some(Control::Nut)), "model"),
        (with(|t| t.settings.accuracy = 1e-6), "model"),
        (with(|t| t.settings.friction = RacewayFriction::PerContact), "model"),
        (with(all), "columns"),
        (plan(&task(), &points, 17), "rows_per_part (17, now 16)"),
        (plan(&task(), &grid(&["lead_mm=5:11:11"]), 16), "points"),
        (plan(&task(), &random_points("lead_mm=uniform:5:10", 11), 16), "points"),
    ] {
        assert_ne!(other.id(), first.id(), "{key}");
        let said = first.differences(other.text()).expect("another plan");
        let back = other.differences(first.text()).expect("another plan");
        assert_eq!(back.split(' ').next(), said.split(' ').next());
        assert!(said.starts_with(key) && !said.contains(", ") | said.contains("now"), "{said}");
    }
    assert_eq!(first.differences("{}"), None);
    let draws = |count| plan(&task(), &random_points("lead_mm=uniform:5:10", count), 16);
    assert_ne!(draws(11).id(), draws(12).id());
}

fn random_points(of: &str, count: u64) -> Points {
    let of = vec![RandomInput::parse(of).expect("a draw")];
    Points::Random(RandomPoints::new(7, count, of).expect("draws"))
}

/// Random points must not change if a plan is written and read again.
#[test]
fn a_plan_of_random_points_round_trips() {
    let plan = plan(&task(), &random_points("lead_mm=normal:20:0.1", 100), 16);
    let again = Plan::from_text(plan.text()).expect("its own text");
    assert_eq!(again.id(), plan.id());
    let points = again.points(|name| name.into(), &workers()).expect("points");
    let rows = NonZeroU64::new(16);
    let made = Plan::new(&again.task().expect("a task"), &points, rows, &workers());
    assert_eq!(made.expect("a plan").text(), plan.text());
}

/// One core calculates a part of the default size in a few seconds, regardless of the number of
/// rows in the dataset. If a dataset would have more than 100 000 parts, the number of rows per
/// part is doubled until the limit is met. Each part then has less than 1/50 000 of all rows.
#[test]
fn part_size_depends_on_row_count_and_model() {
    for (rows, model, parts, power) in [
        (0, ModelChoice::Auto, 0, 18),
        (1_000_000, Model::Rigid.into(), 1, 20),
        (1_000_000, Model::Elastic.into(), 1, 20),
        (1_000_000, Model::Traction.into(), 8, 17),
        (100_000_000, Model::RacewayControl.into(), 96, 20),
        (1_000_000_000, Model::Traction.into(), 7_630, 17),
        (1_000_000_000_000, Model::ClosedForm.into(), 59_605, 24),
        (1_000_000_000_000, Model::Traction.into(), 59_605, 24),
        (u64::MAX, Model::Traction.into(), 65_536, 48),
    ] {
        let mut task = task();
        task.settings.model = model;
        let points = random_points("lead_mm=uniform:5:10", rows);
        let count = Plan::new(&task, &points, None, &workers()).expect("a plan").rows_per_part();
        assert_eq!((rows.div_ceil(count), count), (parts, 1 << power), "{rows} {model:?}");
    }
}

#[test]
fn too_many_parts_are_rejected() {
    let points = grid(&["lead_mm=5:10:1000001"]);
    let refused = Plan::new(&task(), &points, NonZeroU64::new(10), &workers());
    let said = refused.expect_err("too many").to_string();
    assert!(said.contains("at least 11"), "{said}");
}
