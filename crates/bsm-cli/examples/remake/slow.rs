//! Blocks whose commands take minutes or hours: timings, test campaigns, searches and comparisons
//! with other solvers.

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use bsm_report::format_short;
use serde_json::Value;

use crate::fast::table;

type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// New text for a generated block.
pub(crate) enum Text {
    Whole(String),
    /// A table row, which replaces the row that has the same first cell.
    Row(String),
}

/// Paths of the repository and of the program, and the option to measure only a few points.
pub(crate) struct Site {
    pub(crate) root: PathBuf,
    pub(crate) bsm: PathBuf,
    /// If true, only a thousandth of the points are used, which is sufficient for a quick check.
    pub(crate) quick: bool,
}

/// Folder in the repository for temporary files of the measurements.
const WORK: &str = "target/remake";

/// Test campaigns with extreme points: model, number of points, seed, and number of points in an
/// additional campaign near the limits of the inputs.
pub(crate) const CAMPAIGNS: &[(&str, usize, u64, usize)] = &[
    ("closed-form", 50_000, 2026, 100_000),
    ("quasi-static", 50_000, 2026, 100_000),
    ("rigid", 1_000_000, 1, 100_000),
    ("raceway-control", 1_000_000, 2026, 100_000),
    ("elastic", 1_000_000, 2026, 100_000),
    ("traction", 100_000, 3, 3000),
    ("auto", 20_000, 2026, 3000),
];

impl Site {
    fn points(&self, full: usize) -> usize {
        if self.quick { full.div_ceil(1000).max(20) } else { full }
    }

    /// Returns the build profile. Quick runs use the profile of the tests, for which the crates
    /// have already been built.
    fn profile(&self) -> &'static str {
        if self.quick { "test" } else { "release" }
    }

    fn folder(&self) -> Result<PathBuf> {
        let folder = self.root.join(WORK);
        fs::create_dir_all(&folder)?;
        Ok(folder)
    }

    /// Runs a command in the repository and returns its standard output and standard error.
    pub(crate) fn run(&self, program: impl AsRef<Path>, words: &str) -> Result<(String, String)> {
        let program = program.as_ref();
        eprintln!("  {} {words}", program.file_name().unwrap_or_default().display());
        let output = Command::new(program)
            .args(words.split_whitespace())
            .current_dir(&self.root)
            .stdin(Stdio::null())
            .output()?;
        let [stdout, stderr] = [output.stdout, output.stderr].map(String::from_utf8);
        let (stdout, stderr) = (stdout?, stderr?);
        if output.status.success() {
            return Ok((stdout, stderr));
        }
        eprintln!("{stdout}\n{stderr}");
        Err(format!("{}: {}", program.display(), output.status).into())
    }

    /// Describes the machine and the commit of the measured code.
    fn machine(&self) -> Result<String> {
        let cores = std::thread::available_parallelism()?;
        let kind = bsm_simd::name(bsm_simd::Arch::new());
        let code = "-- crates benches Cargo.toml Cargo.lock";
        let commit = match self.run("git", "log -1 --format=%h,%x20%cs") {
            Ok((commit, _)) if self.run("git", &format!("diff --quiet HEAD {code}")).is_ok() => {
                format!(", commit {}", commit.trim())
            }
            Ok((commit, _)) => format!(", commit {} with changes", commit.trim()),
            Err(_) => String::new(),
        };
        Ok(format!("{cores} cores, {kind}{commit}"))
    }
}

fn number(value: &Value, name: &str) -> Result<f64> {
    Ok(value[name].as_f64().ok_or_else(|| format!("no number `{name}` in {value}"))?)
}

fn list<'a>(value: &'a Value, name: &str) -> Result<&'a Vec<Value>> {
    Ok(value[name].as_array().ok_or_else(|| format!("no list `{name}`"))?)
}

fn word<'a>(value: &'a Value, name: &str) -> Result<&'a str> {
    Ok(value[name].as_str().ok_or_else(|| format!("no text `{name}` in {value}"))?)
}

fn micro(ns: f64) -> String {
    format_short(1e-3 * ns)
}

/// Determines the fastest settings and the time per point with `bsm tradeoff`, and adds averages
/// over newly drawn random points.
pub(crate) fn tradeoff(site: &Site) -> Result<Vec<(&'static str, Text)>> {
    let measured = |points: &str| -> Result<Value> {
        let words = format!("tradeoff --quiet --json{points}");
        Ok(serde_json::from_str::<Value>(&site.run(&site.bsm, &words)?.0)?["tradeoff"].take())
    };
    let draw = format!(
        "run --quiet --locked --profile {} -p bsm-validate --features tools --example case_set -- {}",
        site.profile(),
        site.points(3000)
    );
    fs::write(site.folder()?.join("screws.csv"), site.run("cargo", &draw)?.0)?;
    let fresh = measured(&format!(" --points {WORK}/screws.csv"))?;
    let measured = if site.quick { fresh.clone() } else { measured("")? };
    let advice = list(&measured, "advice")?;
    let times = list(&measured, "settings")?.iter().zip(list(&fresh, "settings")?);
    // Settings that differ only in the creep speed are left out, because the creep speed does not
    // affect the computing time.
    let times = times.filter(|(setting, _)| {
        !setting["options"].as_str().is_some_and(|options| options.starts_with("--creep"))
    });
    let times = times.map(times_row).collect::<Result<Vec<_>>>()?;
    let header = "| model and setting | rolling | partial skid | gross skid | all | 99 % quantile | batch: rolling | batch: partial skid | batch: gross skid | batch: all | fresh | batch: fresh |";
    Ok(vec![
        ("tradeoff/summary", Text::Whole(summary(advice)?)),
        ("tradeoff/auto", Text::Whole(auto_means(list(&measured, "settings")?)?)),
        ("tradeoff/times", Text::Whole(table(header, &times))),
        ("tradeoff/machine", Text::Whole(format!("({})", site.machine()?))),
    ])
}

fn format_pick(pick: &Value) -> Result<String> {
    if pick.is_null() {
        return Ok("none".to_owned());
    }
    Ok(format!("`{}`, {} us", word(pick, "setting")?, micro(number(pick, "ns")?)))
}

/// Formats a table with a row for each tolerance and a column for each regime except partial skid.
fn summary(advice: &[Value]) -> Result<String> {
    let mut tolerances: Vec<_> = advice.iter().map(|a| &a["tolerance"]).collect();
    tolerances.dedup();
    let mut rows = Vec::new();
    for tolerance in tolerances {
        let pick = |group: &str| {
            let place = |a: &&Value| a["tolerance"] == *tolerance && a["group"] == group;
            format_pick(advice.iter().find(place).map_or(&Value::Null, |a| &a["single"]))
        };
        let percent = 100.0 * tolerance.as_f64().ok_or("no tolerance")?;
        rows.push(format!(
            "| {percent} % | {} | {} | {} |",
            pick("all")?,
            pick("rolling")?,
            pick("gross skid")?
        ));
    }
    Ok(table("| error of the efficiency | any regime | rolling | gross skid |", &rows))
}

/// Returns the single-core times of a setting for a group of points.
fn group_times<'a>(setting: &'a Value, group: &str) -> Result<Option<&'a Value>> {
    let times = list(&setting["times"], "one_core")?;
    Ok(times.iter().find(|times| times["group"] == *group))
}

fn times_row((setting, fresh): (&Value, &Value)) -> Result<String> {
    const GROUPS: [&str; 4] = ["rolling", "partial skid", "gross skid", "all"];
    let name = format!("{} {}", word(setting, "model")?, word(setting, "options")?);
    let cell = |setting, group, time: fn(&Value) -> Result<f64>| match group_times(setting, group)?
    {
        Some(times) => Ok(micro(time(times)?)),
        None => Ok(String::new()),
    };
    let mean = |times: &Value| number(&times["single"], "mean");
    let most = |times: &Value| number(&times["single"], "q99");
    let batch = |times: &Value| number(times, "batch");
    let cells = (GROUPS.iter().map(|group| cell(setting, group, mean)))
        .chain([cell(setting, "all", most)])
        .chain(GROUPS.iter().map(|group| cell(setting, group, batch)))
        .chain([mean, batch].map(|time| cell(fresh, "all", time)))
        .collect::<Result<Vec<String>>>()?;
    Ok(format!("| `{}` | {} |", name.trim_end(), cells.join(" | ")))
}

/// Formats the average times of `auto` with its default tolerance.
fn auto_means(settings: &[Value]) -> Result<String> {
    let auto = |s: &&Value| s["model"] == "auto" && s["options"] == "--tolerance 1e-2";
    let times = settings.iter().find(auto).map(|setting| group_times(setting, "all"));
    let times = times.transpose()?.flatten().ok_or("no times of auto")?;
    let [one, row] = [number(&times["single"], "mean")?, number(times, "batch")?].map(micro);
    Ok(format!("{one} us, and one row of a table takes {row} us"))
}

/// Time and memory use of one run of the program.
struct RunTime {
    time: Duration,
    /// Peak memory use \[B\], if the operating system reports it.
    memory: Option<f64>,
}

impl Site {
    fn measure(&self, folder: &Path, words: &str) -> Result<RunTime> {
        eprintln!("  bsm {words}");
        let begin = Instant::now();
        let mut child = Command::new(&self.bsm)
            .args(words.split_whitespace())
            // Only `sweep` has a progress bar, which is hidden here.
            .args(words.starts_with("sweep").then_some("--quiet"))
            .current_dir(folder)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .spawn()?;
        let mut memory = None;
        loop {
            if let Some(status) = child.try_wait()? {
                if !status.success() {
                    return Err(format!("bsm {words}: {status}").into());
                }
                return Ok(RunTime { time: begin.elapsed(), memory });
            }
            let status = fs::read_to_string(format!("/proc/{}/status", child.id()));
            let peak = |text: String| {
                let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
                line.split_whitespace().next()?.parse::<f64>().ok()
            };
            memory = status.ok().and_then(peak).map(|kib| 1024.0 * kib).or(memory);
            std::thread::sleep(Duration::from_millis(5));
        }
    }
}

/// Returns the total size of all Parquet files in a folder and its subfolders \[B\].
fn parquet_bytes(folder: &Path) -> Result<f64> {
    let mut bytes = 0.0;
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        if entry.file_type()?.is_dir() {
            bytes += parquet_bytes(&entry.path())?;
        } else if entry.path().extension().is_some_and(|end| end == "parquet") {
            #[expect(clippy::cast_precision_loss, reason = "a file is smaller than 2^53 bytes")]
            let size = entry.metadata()?.len() as f64;
            bytes += size;
        }
    }
    Ok(bytes)
}

fn seconds(took: &RunTime) -> String {
    format!("{} s", format_short(took.time.as_secs_f64()))
}

/// Formats a large count in the form "10.1 million".
fn millions(count: f64) -> String {
    format!("{} million", (1e-5 * count).round() / 10.0)
}

fn megabytes(bytes: f64) -> String {
    format!("{:.0} MB", 1e-6 * bytes)
}

/// Measures time and memory use of sweeps that write files: grids of up to a hundred million
/// points, and tables of ten million rows.
pub(crate) fn many(site: &Site) -> Result<Vec<(&'static str, Text)>> {
    let folder = tempfile::tempdir_in(site.folder()?)?;
    let folder = folder.path();
    std::os::unix::fs::symlink(site.root.join("examples"), folder.join("examples"))?;
    let case = "examples/feed_drive.json";
    let (axis, cube) = if site.quick { (300, 20) } else { (10_000_u32, 216_u32) };
    let grid = |model: &str, side: u32| {
        let words = format!(
            "sweep {case} --set lead_mm=25 --model {model} --vary axial_load_N=2000:8000:{side} \
             --vary screw_speed_rpm=100:1500:{side} --columns efficiency -o {model}-{side}/"
        );
        site.measure(folder, &words)
    };
    let (rigid, closed, small) =
        (grid("rigid", axis)?, grid("closed-form", axis)?, grid("rigid", axis / 10)?);
    let side = axis / 10;
    let map = |options: &str, out: &str| {
        let words = format!(
            "sweep {case} {options} --vary screw_speed_rpm=100:6000:{side} \
             --vary axial_load_N=500:20000:{side} --columns efficiency,ball_torque_Nm -o {out}/"
        );
        site.measure(folder, &words)
    };
    let (traction, auto) =
        (map("--model traction", "traction")?, map("--model auto --threads 1", "auto")?);
    let (points, rows) = (f64::from(axis.pow(2)), f64::from(cube.pow(3)));
    let bytes = parquet_bytes(&folder.join(format!("rigid-{axis}")))? / points;
    let memory = |took: &RunTime| {
        took.memory.map_or_else(String::new, |bytes| format!(" and {} of memory", megabytes(bytes)))
    };
    let fewer = small.memory.map_or_else(String::new, |bytes| {
        format!(" ({} for a hundredth of the points)", megabytes(bytes))
    });
    for end in ["parquet", "csv"] {
        let words = format!(
            "sweep {case} --set lead_mm=25 --model closed-form --vary axial_load_N=2000:8000:{cube} \
             --vary screw_speed_rpm=100:1500:{cube} --vary friction_coefficient=0.03:0.05:{cube} \
             --columns ball_torque_Nm -o points.{end}"
        );
        site.measure(folder, &words)?;
    }
    let table = |end: &str| {
        let words = format!(
            "sweep {case} --points points.{end} --model rigid --columns efficiency -o out.{end}"
        );
        site.measure(folder, &words)
    };
    let (parquet, csv) = (table("parquet")?, table("csv")?);
    Ok(vec![(
        "many",
        Text::Whole(format!(
            "\nThese {} points take {} (`closed-form` {}){}{fewer}, and {bytes:.1} bytes per row. {} rows with three varied\n\
             inputs take {} from Parquet to Parquet and {} from CSV to CSV. {} points of the same drive with `traction`\n\
             take {}{}. With `auto`, a row takes {} us on one core ({}).\n",
            millions(points),
            seconds(&rigid),
            seconds(&closed),
            memory(&rigid),
            millions(rows),
            seconds(&parquet),
            seconds(&csv),
            millions(points / 100.0),
            seconds(&traction),
            memory(&traction),
            format_short(1e6 * auto.time.as_secs_f64() / f64::from(side.pow(2))),
            site.machine()?
        )),
    )])
}

/// Measures the time per row of a sweep on one core for three kinds of results: nuts, nuts whose
/// balls touch each other, and warm axes.
pub(crate) fn nuts(site: &Site) -> Result<Vec<(&'static str, Text)>> {
    const TRAIN: &str = "examples/nut_train.json --model traction --set moment_y_Nm=30";
    const AXIS: &str = "validation/published/nut/feed_axis.json";
    const MODEL: &str = "--model raceway-control";
    let folder = tempfile::tempdir_in(site.folder()?)?;
    for name in ["examples", "validation"] {
        std::os::unix::fs::symlink(site.root.join(name), folder.path().join(name))?;
    }
    let row = |what: &str, words: &str, vary: &str, column: &str| -> Result<String> {
        let run = |rows: usize| {
            let words = format!(
                "sweep {words} --vary {vary}:{rows} --columns {column} --threads 1 -o rows.csv"
            );
            site.measure(folder.path(), &words)
        };
        let rows = site.points(400);
        // Subtracting the time of a run with two rows removes the startup time of the program,
        // which is a few milliseconds.
        let time = run(rows + 2)?.time.saturating_sub(run(2)?.time);
        #[expect(clippy::cast_precision_loss, reason = "hundreds")]
        let each = 1e3 * time.as_secs_f64() / rows as f64;
        Ok(format!("| {what} | {} ms |", format_short(each)))
    };
    let mut dry: Value = serde_json::from_str(&fs::read_to_string(site.root.join(AXIS))?)?;
    let inputs = dry.as_object_mut().ok_or("the case is not a JSON object")?;
    inputs.retain(|name, _| name != "iso_vg" && !name.ends_with("_roughness_um"));
    inputs.insert("friction_coefficient".to_owned(), 0.05.into());
    fs::write(folder.path().join("dry.json"), dry.to_string())?;
    let speeds = "screw_speed_rpm=90:110";
    let nuts = site.points(10_000);
    let drawn = format!("nut examples/nut_scattered.json --samples {nuts} -o drawn.json");
    let drawn = site.measure(folder.path(), &drawn)?;
    let rows = vec![
        row(
            "loads of 98 balls of different diameters",
            "examples/nut_scattered.json",
            "axial_load_N=3000:9000",
            "max_over_mean",
        )?,
        row(
            "friction of 98 balls",
            &format!("{TRAIN} --set ball_gap_mm=100"),
            speeds,
            "friction_torque_Nm",
        )?,
        row("friction of 98 balls that touch each other", TRAIN, speeds, "friction_torque_Nm")?,
        row(
            "warm state of a pair of 114 balls, lubricated",
            &format!("{AXIS} {MODEL}"),
            speeds,
            "warm_preload_N",
        )?,
        row(
            "warm state of a pair of 114 balls, dry",
            &format!("dry.json {MODEL}"),
            speeds,
            "warm_preload_N",
        )?,
        format!("| {nuts} random nuts of 98 balls, on all cores | {} |", seconds(&drawn)),
    ];
    let text = table("| row of a sweep, on one core | time |", &rows);
    Ok(vec![
        ("nuts", Text::Whole(text)),
        ("nuts/machine", Text::Whole(format!("({})", site.machine()?))),
    ])
}

/// Measures the time for estimating grooves and for solving tables of catalog lines.
pub(crate) fn catalog_lines(site: &Site) -> Result<Vec<(&'static str, Text)>> {
    const PUBLISHED: &str = "validation/published/groove/public.json";
    let folder = tempfile::tempdir_in(site.folder()?)?;
    let file: Value = serde_json::from_str(&fs::read_to_string(site.root.join(PUBLISHED))?)?;
    let published = file["rows"].as_array().ok_or("no rows")?;
    let count = site.points(1000);
    let mut text = String::from(
        "nominal_diameter_mm,lead_mm,rated_dynamic_load_N,rated_static_load_N,axial_load_N\n",
    );
    // The published rows are repeated, each time with a different load.
    for place in 0..count {
        let row = &published[place % published.len()];
        #[expect(clippy::cast_precision_loss, reason = "at most a thousand")]
        let part = 0.05 + 0.1 * place as f64 / count as f64;
        let rating = number(row, "rated_dynamic_load_N")?;
        let sizes = [number(row, "nominal_diameter_mm")?, number(row, "lead_mm")?];
        let ratings = [rating, number(row, "rated_static_load_N")?];
        let cells = sizes.into_iter().chain(ratings).chain([part * rating]);
        text += &(cells.map(|cell| cell.to_string()).collect::<Vec<_>>().join(",") + "\n");
    }
    fs::write(folder.path().join("lines.csv"), &text)?;
    let mut lines = text.lines();
    let head = lines.next().unwrap_or_default();
    let one = format!("{head}\n{}\n", lines.next().unwrap_or_default());
    fs::write(folder.path().join("one.csv"), one)?;
    let list = text.lines().map(|line| line.rsplit_once(',').map_or(line, |(list, _)| list));
    let list: Vec<_> = list.collect();
    fs::write(folder.path().join("list.csv"), list.join("\n"))?;
    let requirement = r#"{"axial_load_N": 1000, "feed_m_min": 5, "stroke_mm": 300}"#;
    fs::write(folder.path().join("axis.json"), requirement)?;
    let point = "--set friction_coefficient=0.08 --set screw_speed_rpm=500";
    let sweep = |table: &str, columns: &str, threads: u8| {
        let words = format!(
            "sweep --points {table} {point} --model raceway-control --columns {columns} --threads {threads} --keep-going -o rows.csv"
        );
        site.measure(folder.path(), &words)
    };
    // Subtracting the time of a run with one row removes the startup time of the program.
    let start = sweep("one.csv", "ball_torque_Nm", 1)?.time;
    let estimates = sweep("lines.csv", "ball_torque_Nm", 1)?.time.saturating_sub(start);
    #[expect(clippy::cast_precision_loss, reason = "at most a thousand")]
    let each = 1e3 * estimates.as_secs_f64() / count as f64;
    let intervals = sweep("lines.csv", "ball_torque_Nm,ball_torque_low_Nm,ball_torque_high_Nm", 2)?;
    let listed = site.measure(folder.path(), "select --from list.csv --json")?;
    let judged = site.measure(folder.path(), "select axis.json --from list.csv --json")?;
    let rows = vec![
        format!(
            "| estimate of one groove and its friction torque, one core | {} ms |",
            format_short(each)
        ),
        format!(
            "| `bsm sweep`: {count} catalog lines with intervals, two cores | {} |",
            seconds(&intervals)
        ),
        format!("| `bsm select --from`: {count} catalog lines, all cores | {} |", seconds(&listed)),
        format!(
            "| `bsm select axis.json --from`: the same lines, each checked in an axis | {} |",
            seconds(&judged)
        ),
    ];
    let text = table("| what | time |", &rows);
    Ok(vec![
        ("catalog-line-times", Text::Whole(text)),
        ("catalog-line-times/machine", Text::Whole(format!("({})", site.machine()?))),
    ])
}

/// Compares the solver of the `rigid` model with other solvers, at random points and at the points
/// of `bsm tradeoff`.
pub(crate) fn peers(site: &Site) -> Result<Vec<(&'static str, Text)>> {
    let few = if site.quick { " --count 64 --runs 3" } else { "" };
    let report = |name: &str, flag: &str| -> Result<Value> {
        let file = site.folder()?.join(name);
        let arguments = format!("--out {}{flag}{few}", file.display());
        site.run(site.root.join("benches/peers/run.sh"), &arguments)?;
        Ok(serde_json::from_str(&fs::read_to_string(&file)?)?)
    };
    let [seeded, ordinary] = [report("seeded.json", "")?, report("ordinary.json", " --ordinary")?];
    let percent = |line: &Value| Ok::<_, Box<dyn Error>>(100.0 * number(line, "share_solved")?);
    let row = |(line, other): (&Value, &Value)| {
        Ok::<_, Box<dyn Error>>(format!(
            "| {} | {:.2} | {:.2} | {:.0} | {:.2} % | {:.0} | {:.1} % | {} |",
            word(line, "peer")?,
            number(line, "over_batch")?,
            number(line, "over_nalgebra")?,
            number(line, "ns_per_point")?,
            percent(line)?,
            number(other, "ns_per_point")?,
            percent(other)?,
            number(other, "other_answers")?,
        ))
    };
    let lines = list(&seeded, "lines")?.iter().zip(list(&ordinary, "lines")?);
    let rows = lines.map(row).collect::<Result<Vec<_>>>()?;
    let header = "| solver | time / bsm batch, 1 thread | time / Newton on nalgebra | ns/point | solved | \
                  trade-off: ns/point | solved | other answers |";
    let said = |name: &str| -> Result<Vec<&str>> {
        Ok(list(&seeded, name)?.iter().filter_map(Value::as_str).collect())
    };
    let missing: Vec<_> =
        said("missing")?.iter().map(|what| format!("not included: {what}")).collect();
    let with =
        [vec![site.machine()?], said("versions")?.iter().map(|&v| v.to_owned()).collect(), missing];
    let with = with.concat().join("; ");
    Ok(vec![
        ("peers", Text::Whole(table(header, &rows))),
        ("peers/machine", Text::Whole(format!("({with})"))),
    ])
}

/// Compares the solver of the `traction` model with other solvers, at random points and at the
/// points of `bsm tradeoff`.
pub(crate) fn traction_peers(site: &Site) -> Result<Vec<(&'static str, Text)>> {
    let few = if site.quick { " --count 64 --runs 3" } else { "" };
    let printed = |flag: &str| {
        Ok::<_, Box<dyn Error>>(
            site.run(site.root.join("benches/peers/traction.sh"), &format!("{flag}{few}"))?.0,
        )
    };
    let [seeded, ordinary] = [printed("")?, printed("--ordinary")?];
    let (lines, with) = seeded.trim_end().split_once("\n\n").ok_or("no table")?;
    // Only the columns for time, unsolved points and different results are taken from the second
    // table.
    let cells = |line: &str| line.split('|').map(|cell| cell.trim().to_owned()).collect::<Vec<_>>();
    let row = |(line, other): (&str, &str)| {
        let (own, other) = (cells(line), cells(other));
        format!("| {} | {} |", own[1..6].join(" | "), other[4..7].join(" | "))
    };
    let rows: Vec<_> = lines.lines().zip(ordinary.lines()).skip(2).map(row).collect();
    let header = "| solver | time / bsm batch, 1 thread | time / bsm, point by point | us/point | not solved | \
                  trade-off: us/point | not solved | other answers |";
    Ok(vec![
        ("peers/traction", Text::Whole(table(header, &rows))),
        ("peers/traction-machine", Text::Whole(format!("({}; {with})", site.machine()?))),
    ])
}

/// Runs a test campaign with extreme points, and another campaign with points near the limits of
/// the inputs.
pub(crate) fn extremes(site: &Site, model: &str) -> Result<Vec<(&'static str, Text)>> {
    let (_, points, seed, edges) = *CAMPAIGNS
        .iter()
        .find(|(name, ..)| *name == model)
        .ok_or("no test campaign is defined for this model")?;
    let ask = |points: usize, more: &str| {
        let just = format!("just extremes {points} --model {model} --seed {seed}{more}");
        let words = format!(
            "run --quiet --locked --profile {} -p bsm-validate --features tools --example extremes -- \
             {points} --model {model} --seed {seed}{more}",
            site.profile()
        );
        let printed = site.run("cargo", &words)?.0;
        Ok::<_, Box<dyn Error>>((just, Campaign::read(&printed)?))
    };
    let (just, wide) = ask(site.points(points), "")?;
    let (next, close) = ask(site.points(edges), " --edges")?;
    let [converged, none, lost] = wide.shares();
    let mut rows = vec![
        (
            "extremes/outcomes",
            Text::Row(format!(
                "| `{model}` | `{just}` | {converged} | {none} | {lost} | {} s |",
                format_short(1e-3 * wide.slowest_ms)
            )),
        ),
        ("extremes/reasons", Text::Row(format!("| `{model}` | {} |", wide.reasons().join(" | ")))),
        ("extremes/edges", Text::Row(format!("| `{model}` | `{next}` | {} |", close.shares()[2]))),
    ];
    // A model that never searches for other solutions is left out of the table of other solutions.
    let [several, single, unknown] = wide.others;
    let all = several + single + unknown;
    if unknown < all {
        let [several, single, unknown] = wide.others.map(|count| percent(count / all));
        let row = format!("| `{model}` | `{just}` | {several} | {single} | {unknown} |");
        rows.push(("extremes/others", Text::Row(row)));
    }
    Ok(rows)
}

/// Results that a test campaign has printed.
struct Campaign {
    points: f64,
    /// For each outcome: its index in [`OUTCOMES`], the reason, and the number of points.
    kinds: Vec<(usize, String, f64)>,
    /// Numbers of converged points for which other solutions exist, for which no other solutions
    /// exist, and for which this is unknown.
    others: [f64; 3],
    slowest_ms: f64,
}

/// First words of the outcome names. Solutions without sensitivities are counted under the last
/// name.
const OUTCOMES: [&str; 3] = ["converged", "no_solution", "not_converged"];

impl Campaign {
    fn read(printed: &str) -> Result<Self> {
        let rows = printed.lines().filter(|line| line.starts_with("| "));
        let mut rows =
            rows.map(|line| line.trim_matches(['|', ' ']).split(" | ").collect::<Vec<_>>());
        let header = rows.next().ok_or("no table")?;
        let points = header[0].trim_end_matches(" points").parse()?;
        let mut kinds = Vec::new();
        for row in rows {
            let name = row[0].trim();
            let (first, rest) = name.split_once(' ').unwrap_or((name, ""));
            let outcome = OUTCOMES.iter().position(|outcome| *outcome == first);
            // The outcome "converged, no sensitivities: ..." does not count as converged.
            let outcome = outcome.or_else(|| first.ends_with(',').then_some(2));
            let outcome = outcome.ok_or_else(|| format!("unknown outcome: {name}"))?;
            // In the name of a converged outcome, the text after a comma or colon describes the
            // regime. This text is left out.
            let rest =
                if outcome == 0 { rest.split([',', ':']).next().unwrap_or("") } else { rest };
            kinds.push((outcome, split_words(rest), row.get(2).ok_or("no count")?.parse()?));
        }
        let slowest = printed.split("slowest ").nth(1).and_then(|rest| rest.split(' ').next());
        let slowest_ms = slowest.ok_or("no slowest point")?.parse()?;
        let others = printed.lines().find_map(|line| line.strip_prefix("other solutions: "));
        let others = others
            .ok_or("the output contains no count of other solutions")?
            .split(", ")
            .map(|words| Ok(words.split(' ').next().unwrap_or_default().parse::<f64>()?));
        let others: Vec<_> = others.collect::<Result<_>>()?;
        let others = others.try_into().map_err(|_| "expected three counts of other solutions")?;
        Ok(Self { points, kinds, others, slowest_ms })
    }

    fn shares(&self) -> [String; 3] {
        [0, 1, 2].map(|place| {
            let of = self.kinds.iter().filter(|(outcome, ..)| *outcome == place);
            percent(of.map(|(.., count)| count).sum::<f64>() / self.points)
        })
    }

    /// Returns the reasons for each outcome, in descending order of frequency.
    fn reasons(&self) -> [String; 3] {
        [0, 1, 2].map(|place| {
            let mut of: Vec<_> =
                self.kinds.iter().filter(|(outcome, ..)| *outcome == place).collect();
            of.sort_by(|a, b| b.2.total_cmp(&a.2));
            let say = |(_, words, count): &&(usize, String, f64)| {
                format!("{words} {}", percent(count / self.points)).trim_start().to_owned()
            };
            of.iter().map(say).collect::<Vec<_>>().join(", ")
        })
    }
}

/// Converts an identifier such as `NoSkidAtInertia` to the words "no skid at inertia".
fn split_words(name: &str) -> String {
    let mut words = String::new();
    for letter in name.chars() {
        if letter.is_ascii_uppercase() {
            let begins = words.is_empty() || words.ends_with(' ');
            words.push_str(if begins { "" } else { " " });
        }
        words.push(letter.to_ascii_lowercase());
    }
    words
}

/// Formats a fraction as a percentage with two decimals, or with two significant digits if it is
/// small.
fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    if percent == 0.0 {
        return "0".to_owned();
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "2 to 10")]
    let decimals = (1.0 - percent.log10().floor()).clamp(2.0, 10.0) as usize;
    format!("{percent:.decimals$} %")
}

/// Measures the time of a clean build and the size of the program.
pub(crate) fn build(site: &Site) -> Result<Vec<(&'static str, Text)>> {
    let folder = site.folder()?.join("build");
    if folder.exists() {
        fs::remove_dir_all(&folder)?;
    }
    // `cargo check` processes the same crates without generating code.
    let what = if site.quick { "check" } else { "build --release" };
    let begin = Instant::now();
    site.run("cargo", &format!("{what} --quiet --locked -p bsm-cli --target-dir {WORK}/build"))?;
    let time = begin.elapsed().as_secs();
    let program = if site.quick { site.bsm.clone() } else { folder.join("release/bsm") };
    #[expect(clippy::cast_precision_loss, reason = "a file is smaller than 2^53 bytes")]
    let size = megabytes(fs::metadata(program)?.len() as f64);
    fs::remove_dir_all(&folder)?;
    let text = format!(
        "\nA cold release build takes {} min {} s with all dependencies, and the size of the program file is {size} ({}).\n",
        time / 60,
        time % 60,
        site.machine()?
    );
    Ok(vec![("build", Text::Whole(text))])
}

/// Runs the long test with the command `line`, which is quoted in a document, and returns the
/// output of the test.
pub(crate) fn test_output(site: &Site, line: &str) -> Result<String> {
    let words =
        line.strip_prefix("cargo ").ok_or_else(|| format!("not a cargo command: {line}"))?;
    let mut words = words.replacen("test ", "test --quiet --locked ", 1);
    if site.quick {
        // Quick runs only check that the test exists.
        words = words.replace(" --release", "").replace(" --nocapture", " --nocapture --list");
    }
    let (stdout, _) = site.run("cargo", &words)?;
    let noise = ["running ", "test result", "test "];
    let mut lines: Vec<_> = stdout.lines().map(str::trim_end).collect();
    // With `--quiet`, cargo prints a line of dots, one dot per test. These lines are removed.
    lines.retain(|line| {
        !line.chars().all(|c| ".i".contains(c)) && !noise.iter().any(|n| line.starts_with(n))
    });
    if lines.is_empty() {
        return Err(format!("{line}: prints nothing").into());
    }
    Ok(crate::fast::fenced(&lines.join("\n")))
}
