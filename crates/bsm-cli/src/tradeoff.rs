//! `bsm tradeoff`: measures the time and accuracy of each model and setting.

use std::path::Path;

use bsm_batch::TableFormat;
use bsm_case::{Answer, Content};
use bsm_report::{PROGRAM, format_short};
use bsm_validate::tradeoff::{
    self, Advice, Count, Errors, Group, OneCore, Points, SettingResult, Tradeoff,
};
use bsm_validate::tradeoff_page;
use serde_json::json;

use crate::answer::{Pictures, Reply};
use crate::args::TradeoffArgs;
use crate::failure::Failure;
use crate::files::{InputFiles, make_folder};
use crate::progress::progress;
use crate::schema::TradeoffJson;
use crate::table;
use crate::table_job::open;

pub(crate) fn run(args: &TradeoffArgs) -> Result<(), Failure> {
    let to = args.out.check(&["json", "html"], InputFiles::of([args.points.as_deref()]))?;
    let points = match &args.points {
        Some(path) => read(path)?,
        None => Points::committed()?,
    };
    if let Some(folder) = &args.out.figures {
        make_folder(folder)?;
    }
    let bar = progress(Some(0), "measurements", args.quiet);
    let measured = tradeoff::run(&points, |done, all| {
        bar.set_length(all as u64);
        bar.set_position(done as u64);
    })?;
    bar.finish_and_clear();
    let unknown: Vec<_> = measured.without_reference.iter().map(ToString::to_string).collect();
    let warning = (!unknown.is_empty()).then(|| {
        format!("rows without a reference solution are not counted: {}", unknown.join(", "))
    });
    let warnings: Vec<_> = warning.into_iter().collect();
    let answer = Answer { fails: !warnings.is_empty(), warnings, ..Answer::default() }
        .with("", Content::Json(json!(TradeoffJson { program: PROGRAM, tradeoff: &measured })))
        .with_shown(Content::Text("", Some(describe(&measured))));
    let draw = || {
        let (figures, page) = (measured.figures(), Some(tradeoff_page(&measured)?));
        Ok(Pictures { figures, page, ..Pictures::default() })
    };
    Reply::of(answer).deliver(&to, draw)
}

fn read(path: &Path) -> Result<Points, Failure> {
    let mut source = open(path, &[], &TableFormat::default())?;
    Points::read(source.as_mut()).map_err(|e| Failure::in_case(path, &e.to_string()))
}

fn describe(measured: &Tradeoff) -> String {
    let regimes = ["99 % rolling", "partial skid", "gross skid"];
    let header: Vec<_> = COLUMNS.iter().map(|(head, _)| *head).chain(regimes).collect();
    let rows: Vec<_> = measured.settings.iter().map(row).collect();
    let heads = |heads: &'static str| heads.split(" | ").collect::<Vec<_>>();
    let times_header = heads(
        "model and setting | regime | one point us: mean | median | 90 % | 99 % | max | \
         batch us: mean | median | 90 % | 99 % | max",
    );
    let costs_header = heads(
        "model and setting | regime | steps: mean | max | evaluations: mean | max | nodes: mean | max | \
         searches: mean | max | in % of points",
    );
    let rows_of = |row: fn(&OneCore) -> Vec<String>| -> Vec<Vec<String>> {
        let of = |result: &SettingResult| {
            let name = result.setting.name();
            let named = |times: &OneCore| {
                [vec![name.clone(), times.group.name().to_owned()], row(times)].concat()
            };
            result.times.one_core.iter().map(named).collect::<Vec<_>>()
        };
        measured.settings.iter().flat_map(of).collect()
    };
    let count = |count: &Count| format!("{} {}", count.group.name(), count.points);
    let counts: Vec<_> = measured.points.iter().map(count).collect();
    let advice_header = heads(
        "tolerance | regime | one point: setting | time, us | error above tolerance in | batch, one core: setting | time, us | error above tolerance in",
    );
    let advice: Vec<_> = measured.advice.iter().map(advice_row).collect();
    format!(
        "points: {}; errors relative to {}; {}, {} cores\n\n{}\n\nbatch, one core: mean of a table \
         of all points, quantiles of tables of one point each\n\n{}\n\neffort for one point: \
         solver steps, evaluations of the equations, integration nodes on the contact ellipses, \
         and searches along curves and paths or from random starts\n\n{}\n\nerrors of the \
         efficiency eta are absolute; errors of torque and loads are relative; the last columns \
         contain the error of eta for each motion of the ball\n\nfastest setting that solves 99 % \
         of the points, with an error below the tolerance at 99 % of them:\n\n{}",
        counts.join(", "),
        measured.reference,
        measured.instruction_set,
        measured.threads,
        table::plain(Some(&times_header), &rows_of(times_row), 2),
        table::plain(Some(&costs_header), &rows_of(costs_row), 2),
        table::plain(Some(&header), &rows, 1),
        table::plain(Some(&advice_header), &advice, usize::MAX),
    )
}

/// Column heading, and the function that formats the cells of the column.
type Column = (&'static str, fn(&SettingResult, &Errors) -> String);

/// Columns of the table that summarizes all points.
const COLUMNS: [Column; 9] = [
    ("model and setting", |result, _| result.setting.name()),
    ("all cores us", |result, _| micro(result.times.all_cores)),
    ("solved %", |_, all| format!("{:.1}", 100.0 * all.solved)),
    ("eta median", |_, all| cell(all.efficiency.map(|e| e.median))),
    ("99 %", |_, all| cell(all.efficiency.map(|e| e.q99))),
    ("max", |_, all| cell(all.efficiency.map(|e| e.max))),
    ("torque 99 %", |_, all| cell(all.torque.map(|e| e.q99))),
    ("loads 99 %", |_, all| cell(all.loads.map(|e| e.q99))),
    ("angles deg", |_, all| cell(all.angles_deg.map(|e| e.q99))),
];

fn row(result: &SettingResult) -> Vec<String> {
    let of_group = |group| result.errors_of(group).and_then(|errors| errors.efficiency);
    let regimes = Group::ALL.into_iter().filter(|group| *group != Group::All);
    let regimes = regimes.map(|group| cell(of_group(group).map(|e| e.q99)));
    COLUMNS.iter().map(|(_, of)| of(result, &result.errors[0])).chain(regimes).collect()
}

fn cell(value: Option<f64>) -> String {
    value.map_or_else(|| "-".to_owned(), format_short)
}

fn micro(ns: f64) -> String {
    format_short(1e-3 * ns)
}

/// Formats the computing times of single solves and of batch runs.
fn times_row(OneCore { single, batch, row, .. }: &OneCore) -> Vec<String> {
    let of = [single.mean, single.median, single.q90, single.q99, single.max];
    of.into_iter().chain([*batch, row.median, row.q90, row.q99, row.max]).map(micro).collect()
}

/// Formats the numbers of solver steps, function evaluations, quadrature nodes and searches, which
/// determine the computing time.
fn costs_row(
    OneCore { steps, evaluations, nodes, searches, searching, .. }: &OneCore,
) -> Vec<String> {
    let counts = [*steps, Some(*evaluations), Some(*nodes), Some(*searches)];
    let means = counts.iter().flat_map(|of| [of.map(|of| of.mean), of.map(|of| of.max)]);
    means.map(cell).chain([format!("{:.1}", 100.0 * searching)]).collect()
}

fn advice_row(advice: &Advice) -> Vec<String> {
    let group = if advice.group == Group::All { "any regime" } else { advice.group.name() };
    let mut row = vec![format!("{} %", 100.0 * advice.tolerance), group.to_owned()];
    for pick in [&advice.single, &advice.batch] {
        row.extend(match pick {
            Some(pick) => {
                let fails: Vec<_> = pick.fails_where.iter().map(|group| group.name()).collect();
                [pick.setting.clone(), format_short(1e-3 * pick.ns), fails.join(", ")]
            }
            None => ["none".to_owned(), String::new(), String::new()],
        });
    }
    row
}
