//! Blocks whose commands take only seconds and always give the same result. `docs/remake fast`
//! writes these blocks, and `cargo test -p bsm-cli documents::` compares them with the documents.

use std::collections::BTreeMap;
use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use bsm_case::format_digits;
use bsm_report::format_short;
use bsm_validate::tradeoff::{self, Distribution, Errors, Group, Points, Setting};
use serde_json::{Value, json};

/// The text of a block, or the reason why it cannot be generated.
type Blocks = Result<String, Box<dyn Error>>;

/// A function that generates the text of a block.
type Generate = fn(&Program) -> Blocks;

/// The program `bsm`, with a working folder that contains the examples and the published data.
pub(crate) struct Program {
    pub(crate) path: PathBuf,
    pub(crate) folder: PathBuf,
}

/// Names of all blocks, with the functions that generate them.
pub(crate) const BLOCKS: &[(&str, Generate)] = &[
    ("checks", checks),
    ("accuracies", accuracies),
    ("slip-powers", slip_powers),
    ("catalog", catalog),
    ("nut-sharing", nut_sharing),
    ("ball-train", ball_train),
    ("accuracy", accuracy),
    ("catalog-line", catalog_line),
    ("catalog-line-items", catalog_line_items),
    ("groove-rates", groove_rates),
    ("groove-new-makers", groove_new_makers),
    ("groove-widths", groove_widths),
];

impl Program {
    /// Prepares the working folder by linking the examples and the published data.
    pub(crate) fn new(path: PathBuf, root: &Path, folder: &Path) -> std::io::Result<Self> {
        for name in ["examples", "validation"] {
            std::os::unix::fs::symlink(root.join(name), folder.join(name))?;
        }
        Ok(Self { path, folder: folder.to_owned() })
    }

    pub(crate) fn run(&self, arguments: &[String]) -> std::io::Result<Output> {
        Command::new(&self.path).args(arguments).current_dir(&self.folder).output()
    }

    /// Runs a command and returns its standard output and standard error. Exit codes 0 (solution)
    /// and 3 (no solution) are accepted.
    pub(crate) fn prints(&self, arguments: &[String]) -> Result<(String, String), Box<dyn Error>> {
        let output = self.run(arguments)?;
        let text = |bytes| String::from_utf8(bytes);
        let (stdout, stderr) = (text(output.stdout)?, text(output.stderr)?);
        if !matches!(output.status.code(), Some(0 | 3)) {
            return Err(format!("bsm {}: {stderr}", arguments.join(" ")).into());
        }
        Ok((stdout, stderr))
    }

    fn json(&self, arguments: &str) -> Result<Value, Box<dyn Error>> {
        let words: Vec<_> = arguments.split(' ').map(str::to_owned).collect();
        Ok(serde_json::from_str(&self.prints(&words)?.0)?)
    }
}

/// Formats the output of a command as a fenced block.
pub(crate) fn fenced(text: &str) -> String {
    format!("\n```text\n{}\n```\n", text.trim_end())
}

/// Formats a header and rows as a Markdown table.
pub(crate) fn table(header: &str, rows: &[String]) -> String {
    let columns = header.matches('|').count() - 1;
    format!("\n{header}\n{}|\n{}\n", "|---".repeat(columns), rows.join("\n"))
}

fn number(value: &Value, name: &str) -> Result<f64, String> {
    value[name].as_f64().ok_or_else(|| format!("no number `{name}`"))
}

fn checks(program: &Program) -> Blocks {
    let results = program.json("validate --json")?;
    let checks = results["checks"].as_array().ok_or("no checks")?;
    let count = |verdict: &str| checks.iter().filter(|check| check["verdict"] == verdict).count();
    let (passed, failed, findings) = (count("pass"), count("fail"), count("finding"));
    Ok(format!(
        "\n{passed} checks pass and {failed} fail. Another {findings} checks are findings: published trends that do not hold on all \
         curves,\nand numbers without a reference value.\n"
    ))
}

fn accuracies(program: &Program) -> Blocks {
    let solved = |accuracy: &str| {
        let solve = "solve examples/feed_drive.json --model traction --json --accuracy";
        program.json(&format!("{solve} {accuracy}"))
    };
    let finest = number(&solved("1e-12")?, "efficiency")?;
    let row = |accuracy| {
        let result = solved(accuracy)?;
        let (found, bound) =
            (number(&result, "efficiency")?, number(&result, "efficiency_error_bound")?);
        let off = (found - finest).abs();
        // The solver stops at residuals of 1e-10, so differences below this value are meaningless.
        let off = if off < 1e-10 { "< 1e-10".to_owned() } else { format!("{off:.0e}") };
        Ok::<_, Box<dyn Error>>(format!("| {accuracy} | {found:.9} | {off} | {bound:.0e} |"))
    };
    let rows = ["1e-4", "1e-6", "1e-8"].map(row).into_iter().collect::<Result<Vec<_>, _>>()?;
    Ok(table("| A | efficiency | difference from A = 1e-12 | stated error bound |", &rows))
}

fn slip_powers(program: &Program) -> Blocks {
    let row = |model: &str| {
        let slip = format!("solve examples/xu2015.json --show slip --json --model {model}");
        let report = program.json(&slip)?;
        let both = |part: &str| {
            let at = |contact: &str| number(&report, &format!("{contact}_{part}_power_W"));
            Ok::<_, String>(at("nut")? + at("screw")?)
        };
        let [center, spin, curvature] = [both("center")?, both("spin")?, both("curvature")?];
        let all = number(&report, "total_friction_power_W")?;
        Ok::<_, Box<dyn Error>>(format!(
            "| `{model}` | {center:.2} | {spin:.2} | {curvature:.2} | {all:.2} |"
        ))
    };
    let models = ["raceway-control", "traction", "elastic"];
    let rows = models.map(row).into_iter().collect::<Result<Vec<_>, _>>()?;
    Ok(table("| model | slip at the center | spin | curvature | total |", &rows))
}

fn catalog(program: &Program) -> Blocks {
    let words = ["select", "--from", "standard", "--first", "1"].map(str::to_owned);
    let (_, note) = program.prints(&words)?;
    let count = note.split_whitespace().find_map(|word| word.parse::<u64>().ok());
    Ok(count.ok_or_else(|| format!("no number of nuts in the note: {note}"))?.to_string())
}

/// Generates a table of the effects that equal load sharing neglects, one effect per row. Each nut
/// is compared with a nut that has the same balls, but stiff guides and rigid bodies without
/// errors.
fn nut_sharing(program: &Program) -> Blocks {
    let read = |case: &str| std::fs::read(program.folder.join("examples").join(case));
    let mut base: Value = serde_json::from_slice(&read("nut_guided.json")?)?;
    for (key, value) in [("axial_load_N", json!(6340)), ("seed", json!(1))] {
        base[key] = value;
    }
    let fields = base.as_object_mut().ok_or("no case")?;
    fields.retain(|key, _| !["nut_anchor", "screw_anchor", "nut_guidance"].contains(&key.as_str()));
    let solved = |change: &Value| -> Result<[f64; 4], Box<dyn Error>> {
        let mut case = base.clone();
        let fields = case.as_object_mut().ok_or("no case")?;
        fields.extend(change.as_object().ok_or("no words")?.clone());
        fields.retain(|_, value| !value.is_null());
        std::fs::write(program.folder.join("nut-sharing.json"), case.to_string())?;
        let found = program.json("nut nut-sharing.json --model raceway-control --json")?;
        let names = [
            "max_over_mean",
            "nut_secant_stiffness_N_um",
            "life_by_balls_revolutions",
            "friction_torque_Nm",
        ];
        let [a, b, c, d] = names.map(|name| number(&found, name));
        Ok([a?, b?, c?, d?])
    };
    let circuits = |phase: f64| json!({ "loaded_turns": null, "circuits_count": 5, "gap_deg": 30, "phase_deg": phase });
    let bars = |screw: &str, more: &Value| {
        let mut words = json!({ "nut_anchor": "low", "screw_anchor": screw });
        words.as_object_mut().expect("object").extend(more.as_object().expect("object").clone());
        words
    };
    let (whole, heavy) = (json!({}), json!({ "axial_load_N": 19020 }));
    let ring = json!({ "ring_expansion": true, "nut_guidance": "free" });
    let free = |key: &str, value: f64| json!({ "nut_guidance": "free", key: value });
    let wave =
        |amplitude: f64| json!({ "lead_error": [{ "amplitude_um": amplitude, "order": 1 }] });
    let cases = [
        ("free nut (no guides)", &whole, free("seed", 1.0)),
        ("free nut, ball returns in line", &circuits(0.0), free("seed", 1.0)),
        ("free nut, ball returns 72 deg apart", &circuits(72.0), free("seed", 1.0)),
        ("elastic bodies, anchors at the same end", &whole, bars("low", &json!({}))),
        ("elastic bodies, anchors at the same end, 19 kN", &heavy, bars("low", &json!({}))),
        ("elastic bodies, anchors at opposite ends", &whole, bars("high", &json!({}))),
        ("elastic bodies, anchors at opposite ends, 19 kN", &heavy, bars("high", &json!({}))),
        (
            "free nut, elastic bodies that also expand radially, same end, 19 kN",
            &heavy,
            bars("low", &ring),
        ),
        (
            "free nut, elastic bodies that also expand radially, opposite ends, 19 kN",
            &heavy,
            bars("high", &ring),
        ),
        (
            "free nut, standard deviation of the ball diameters 0.5 um",
            &whole,
            free("ball_deviation_sd_um", 0.5),
        ),
        (
            "free nut, standard deviation of the ball diameters 1 um",
            &whole,
            free("ball_deviation_sd_um", 1.0),
        ),
        (
            "free nut, standard deviation of the ball diameters 2 um",
            &whole,
            free("ball_deviation_sd_um", 2.0),
        ),
        ("lead error of 1 um once per turn", &whole, wave(1.0)),
        ("lead error of 3 um once per turn", &whole, wave(3.0)),
        ("lead error of 5 um once per turn", &whole, wave(5.0)),
        ("free nut, moment of 10 N m", &whole, free("moment_y_Nm", 10.0)),
        ("free nut, moment of 50 N m", &whole, free("moment_y_Nm", 50.0)),
        ("free nut, moment of 100 N m", &whole, free("moment_y_Nm", 100.0)),
        ("free nut, side load of 0.1 kN", &whole, free("radial_load_x_N", 100.0)),
        ("free nut, side load of 0.5 kN", &whole, free("radial_load_x_N", 500.0)),
        ("free nut, side load of 1 kN", &whole, free("radial_load_x_N", 1000.0)),
        ("free nut, side load of 2 kN", &whole, free("radial_load_x_N", 2000.0)),
    ];
    let row = |(name, balls, change): &(&str, &Value, Value)| {
        let mut words = (*balls).clone();
        let equal = solved(&words)?;
        words
            .as_object_mut()
            .ok_or("no words")?
            .extend(change.as_object().ok_or("no words")?.clone());
        let found = solved(&words)?;
        let [concentration, ..] = found;
        let percent = |i: usize| 100.0 * (found[i] / equal[i] - 1.0);
        Ok::<_, Box<dyn Error>>(format!(
            "| {name} | {concentration:.2} | {:+.0} % | {:+.0} % | {:+.1} % |",
            percent(1),
            percent(2),
            percent(3)
        ))
    };
    let rows = cases.iter().map(row).collect::<Result<Vec<_>, _>>()?;
    let header =
        "| changed assumption | largest load / mean load | stiffness | life | friction torque |";
    Ok(table(header, &rows))
}

/// Command that analyzes the axis of the example catalog line.
const CATALOG_LINE: &str = "axis examples/catalog_line.json --json";

/// Formats a result of the axis analysis and its 90 % interval.
fn with_interval(axis: &Value, name: &str, unit: &str) -> Result<[String; 2], Box<dyn Error>> {
    let three = |value: f64| format_digits(value, 3);
    let value = three(number(&axis["results"], name)?);
    let interval = &axis["groove_estimate"]["intervals"][name];
    let end = |place: usize| interval[place].as_f64().map(three);
    let interval = match (end(0), end(1)) {
        (Some(low), Some(high)) => format!("{low} to {high} {unit}"),
        _ => "none, because the result does not depend on the groove".to_owned(),
    };
    Ok([format!("{value} {unit}"), interval])
}

/// Generates a table of the axis results for the example catalog line, with their intervals.
fn catalog_line(program: &Program) -> Blocks {
    let axis = program.json(CATALOG_LINE)?;
    let row = |(label, name, unit): (&str, &str, &str)| {
        let [value, interval] = with_interval(&axis, name, unit)?;
        Ok::<_, Box<dyn Error>>(format!("| {label} | {value} | {interval} |"))
    };
    let rows = [
        ("largest axial load", "largest_load_N", "N"),
        ("torque of the screw at the largest load", "screw_torque_Nm", "N m"),
        ("efficiency of the screw at the largest load", "screw_efficiency", ""),
        ("mean heat of the cycle", "mean_heat_W", "W"),
        ("temperature rise of the screw", "steady_temperature_rise_K", "K"),
        ("stiffness of the nut at the largest load", "nut_stiffness_at_largest_load_N_um", "N/um"),
        ("stiffness of the axis", "axis_stiffness_N_um", "N/um"),
        ("life of the cycle", "cycle_life_h", "h"),
    ];
    let rows = rows.into_iter().map(row).collect::<Result<Vec<_>, _>>()?;
    Ok(table("| result | best groove | 90 % interval |", &rows))
}

/// Generates a table that shows how the intervals narrow if further inputs are known in addition to
/// the catalog line.
fn catalog_line_items(program: &Program) -> Blocks {
    let conformity = "--set nut_conformity=0.52 --set screw_conformity=0.52";
    let cases = [
        ("no additional inputs", String::new()),
        ("`ball_diameter_mm`", "--set ball_diameter_mm=6.35".to_owned()),
        ("`nut_conformity`, `screw_conformity`", conformity.to_owned()),
        (
            "all of these and `contact_angle_deg`",
            format!("{conformity} --set ball_diameter_mm=6.35 --set contact_angle_deg=45"),
        ),
    ];
    let row = |(given, settings): (&str, String)| {
        let axis = program.json(format!("{CATALOG_LINE} {settings}").trim_end())?;
        let [_, heat] = with_interval(&axis, "mean_heat_W", "")?;
        let [_, stiffness] = with_interval(&axis, "nut_stiffness_at_largest_load_N_um", "")?;
        Ok::<_, Box<dyn Error>>(format!("| {given} | {} | {} |", heat.trim(), stiffness.trim()))
    };
    let rows = cases.into_iter().map(row).collect::<Result<Vec<_>, _>>()?;
    Ok(table("| additional inputs | heat of the example, W | stiffness of the nut, N/um |", &rows))
}

/// Returns the calculated value from a check of the groove estimate.
fn groove_check(checks: &Value, key: &str) -> Result<f64, Box<dyn Error>> {
    let list = checks["checks"].as_array().ok_or("no checks")?;
    let key = format!("groove/{key}");
    let check = list.iter().find(|check| check["key"] == json!(key));
    number(check.ok_or_else(|| format!("no check `{key}`"))?, "measured").map_err(Into::into)
}

/// Generates a table that lists the fraction of catalog rows for which the groove estimate finds
/// the correct ball diameter. These rows were not used to fit the prior.
fn groove_rates(program: &Program) -> Blocks {
    let checks = program.json("validate --json")?;
    let row = |(key, known): (&str, &str)| {
        let rate = |what: &str| groove_check(&checks, &format!("other-half/{what}-{key}"));
        Ok::<_, Box<dyn Error>>(format!(
            "| {known} | {:.2} | {:.2} | {:.1} |",
            rate("first-ball")?,
            rate("likely-balls")?,
            rate("number-of-likely-balls")?
        ))
    };
    let rows = [
        ("dynamic-rating", "dynamic rating"),
        ("line", "both ratings"),
        ("turns", "both ratings and turns"),
        ("core", "both ratings and core diameter"),
        ("turns-core", "both ratings, turns and core diameter"),
    ];
    let rows = rows.into_iter().map(row).collect::<Result<Vec<_>, _>>()?;
    let head =
        "| known | most likely ball is correct | correct ball in the 90 % set | balls in the set |";
    Ok(table(head, &rows))
}

/// Generates a table that lists, for each manufacturer, the fraction of correctly estimated ball
/// diameters. The prior was fitted to the other manufacturers.
fn groove_new_makers(program: &Program) -> Blocks {
    let checks = program.json("validate --json")?;
    let row = |maker: &str| {
        let rate = |what: &str| groove_check(&checks, &format!("new-maker-{maker}/{what}-line"));
        Ok::<_, Box<dyn Error>>(format!(
            "| {maker} | {:.2} | {:.2} | {:.1} |",
            rate("first-ball")?,
            rate("likely-balls")?,
            rate("number-of-likely-balls")?
        ))
    };
    let rows = ["HIWIN", "TBI", "THK"].map(row).into_iter().collect::<Result<Vec<_>, _>>()?;
    let head = "| tested manufacturer | most likely ball is correct | correct ball in the 90 % set | balls in the set |";
    Ok(table(head, &rows))
}

/// Generates a table of interval widths for catalog rows that were not used to fit the prior.
fn groove_widths(program: &Program) -> Blocks {
    let checks = program.json("validate --json")?;
    let of = |key: &str| groove_check(&checks, &format!("other-half/{key}"));
    Ok(format!(
        "\nFor these rows, the ratio of the upper to the lower end of the interval has a median of {:.2} for the friction torque, of {:.2} \
         for the stiffness of the contacts, and of {:.2} for the largest pressure. The intervals contain the results of the correct ball and \
         turns in {:.0} %, {:.0} % and {:.0} % of the rows.\n",
        of("torque-width")?,
        of("stiffness-width")?,
        of("pressure-width")?,
        100.0 * of("torque-contained")?,
        100.0 * of("stiffness-contained")?,
        100.0 * of("pressure-contained")?
    ))
}

/// Generates a table of the gap that the balls need and of the effect of a smaller gap, for a
/// driving and a back-driven screw.
fn ball_train(program: &Program) -> Blocks {
    const PER_CENT: [f64; 4] = [0.5, 0.2, 0.05, 0.01];
    const COLUMNS: &str = "needed_gap_mm,advance_spread,max_over_mean,idle_balls,contact_torque_free_Nm,friction_torque_Nm,max_push_N";
    const ONE: (&str, f64) = ("nut_train", 98.0);
    let five = " --set loaded_balls_per_turn=20.374 --set ball_contact_friction=0.1";
    let lead = |um: u8| format!(" --set lead_error=[{{\"amplitude_um\":{um},\"order\":1}}]");
    let tilted = " --set nut_guidance=guided --set tilt_y_urad=200 --set radial_x_um=5";
    let cases = [
        (
            "guided, rigid (including a preloaded pair)",
            ONE,
            " --set nut_guidance=guided".to_owned(),
        ),
        ("guided, elastic, 19 kN", ("nut_guided", 98.0), five.to_owned()),
        ("free, five circuits", ("nut_free", 19.0), five.to_owned()),
        ("free, lead error of 1 um", ONE, lead(1)),
        ("free, side load of 500 N", ONE, " --set radial_load_x_N=500".to_owned()),
        ("free, lead error of 3 um", ONE, lead(3)),
        ("free, moment of 30 N m", ONE, " --set moment_y_Nm=30".to_owned()),
        ("guided, tilted by 0.2 mrad", ONE, tilted.to_owned()),
    ];
    let mut rows = Vec::new();
    for (speed, drive, cases) in [(100, "", &cases[..]), (-100, "back-driven: ", &cases[2..7])] {
        for (name, (case, balls), change) in cases {
            let gaps = PER_CENT.map(|part| (0.01 * part * balls * 6.35).to_string()).join(",");
            let words = format!(
                "sweep examples/{case}.json --model traction --set screw_speed_rpm={speed}{change} --vary ball_gap_mm={gaps} --columns {COLUMNS} -o -"
            );
            let words: Vec<_> = words.split(' ').map(str::to_owned).collect();
            let text = program.prints(&words)?.0;
            let mut lines = csv::Reader::from_reader(text.as_bytes());
            let rows_of =
                lines.deserialize().collect::<Result<Vec<BTreeMap<String, String>>, _>>()?;
            let cell = |row: usize, name: &str| rows_of.get(row)?.get(name)?.parse::<f64>().ok();
            let first = |name| cell(0, name).ok_or_else(|| format!("no number `{name}`"));
            let ball = 6.35 * (balls - first("idle_balls")?);
            let shown = |value: Option<f64>, digits| {
                value.map_or_else(|| "-".to_owned(), |value| format!("{value:.digits$}"))
            };
            let torque = |row| {
                let whole = cell(row, "friction_torque_Nm")?;
                Some(whole / cell(row, "contact_torque_free_Nm")?)
            };
            let [torques, pushes] = [
                [0, 1, 2, 3].map(|row| shown(torque(row), 2)),
                [0, 1, 2, 3].map(|row| shown(cell(row, "max_push_N"), 1)),
            ];
            rows.push(format!(
                "| {drive}{name} | {:.2} | {:.2} | {:.2} | {} | {} |",
                first("max_over_mean")?,
                100.0 * first("advance_spread")?,
                100.0 * first("needed_gap_mm")? / ball,
                torques.join(", "),
                pushes.join(", ")
            ));
        }
    }
    let header = "| nut | largest / mean load | speed spread, % | needed gap, % | torque ratio at 0.5, 0.2, 0.05, 0.01 % | largest push at these gaps, N |";
    Ok(table(header, &rows))
}

/// Generates a table of the errors of every model and setting for the operating points in the
/// repository.
fn accuracy(_: &Program) -> Blocks {
    let rows: Vec<_> = tradeoff::accuracy(&Points::committed()?)?.iter().map(errors_row).collect();
    let header = "| model and setting | solved | rolling | partial skid | gross skid | loads, rolling | angles, rolling |";
    Ok(table(header, &rows))
}

fn errors_row((setting, errors): &(Setting, Vec<Errors>)) -> String {
    let of = |group: Group| errors.iter().find(|errors| errors.group == group);
    let cell = |distribution: Option<Distribution>| {
        distribution.map_or_else(String::new, |q| {
            format!("{}, {}", format_error(q.median), format_error(q.q99))
        })
    };
    let [all, rolling, partial, gross] = Group::ALL.map(of);
    let solved = all.map_or(0.0, |all| 100.0 * all.solved);
    let cells = [
        cell(rolling.and_then(|e| e.efficiency)),
        cell(partial.and_then(|e| e.efficiency)),
        cell(gross.and_then(|e| e.efficiency)),
        cell(rolling.and_then(|e| e.loads)),
        cell(rolling.and_then(|e| e.angles_deg)),
    ];
    format!("| `{}` | {solved:.1} % | {} |", setting.name(), cells.join(" | "))
}

/// Formats an error. If the error is smaller than the residual of the solver, an upper limit is
/// shown.
fn format_error(error: f64) -> String {
    if error < 1e-9 { "< 1e-9".to_owned() } else { format_short(error) }
}
