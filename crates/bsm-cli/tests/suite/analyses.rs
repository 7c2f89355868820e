//! Tests of the slip and jamming analyses on the command line.

use crate::data;
use std::fs;

use serde_json::Value;

use crate::program::{bsm, example, folder, root, stderr, stdout};
use data::copy_published;

fn json(args: &[&str]) -> Value {
    let dir = folder();
    let output = bsm(dir.path(), &[args, &["--json"]].concat(), "");
    assert_eq!(output.status.code(), Some(0), "{args:?}: {}", stderr(&output));
    serde_json::from_str(&stdout(&output)).expect("JSON alone on stdout")
}

/// The cases that `validate` checks must be identical to the example cases.
#[test]
fn example_cases_match_the_published_cases() {
    for key in ["xu2015", "dong2020"] {
        let case = root().join("validation/published").join(key).join("case.json");
        let example = fs::read_to_string(example(&format!("{key}.json"))).expect("example");
        assert_eq!(fs::read_to_string(case).expect("case"), example, "{key}");
    }
}

/// The check of a published trend must fail if the recorded number of curves with this trend is
/// wrong, or if a trend does not hold and this deviation is not recorded.
#[test]
fn checks_of_published_trends_fail_if_the_recorded_findings_are_wrong() {
    let dir = folder();
    let data = copy_published(dir.path());
    let file = data.join("xu2015/trends.csv");
    let table = fs::read_to_string(&file).expect("a table");
    let row = |trend: &str| {
        table.lines().find(|row| row.starts_with(&format!("{trend},"))).expect("a row")
    };
    let (slip, efficiency) = ("rolling-nut-angle-differential", "rolling-nut-angle-efficiency");
    let changed = table.replace(row(slip), &row(slip).replace(",0,4", ",1,4"));
    assert_ne!(changed, table);
    let changed_twice = changed.replace(&format!("{}\n", row(efficiency)), "");
    assert_ne!(changed_twice, changed);
    fs::write(&file, changed_twice).expect("written");
    let output = bsm(dir.path(), &["validate", "--from", "data"], "");
    assert_eq!(output.status.code(), Some(3), "{}", stderr(&output));
    let text = stdout(&output);
    for key in [slip, efficiency] {
        assert!(text.contains(&format!("FAIL xu2015/{key}")), "{text}");
    }
    assert!(text.contains(" 2 failed"), "{text}");
}

#[test]
fn slip_output_contains_published_and_exact_formulas() {
    let dir = folder();
    let output = bsm(dir.path(), &["solve", &example("xu2015.json"), "--show", "slip"], "");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let text = stdout(&output);
    for part in [
        "model   traction",
        "slip between neighboring balls",
        "spin slip, formula of Xu and Tang",
        "spin slip, corrected formula",
        "gyroscopic angle",
        "spin slip, exact, at the end of the ellipse",
        "of the slip due to the curved surface",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let result = json(&["solve", &example("xu2015.json"), "--show", "slip", "--model", "traction"]);
    assert_eq!(result["model"], "traction");
    let value = |name: &str| result[name].as_f64().unwrap_or_else(|| panic!("{name}"));
    let parts: f64 = ["nut", "screw"]
        .iter()
        .flat_map(|c| ["center", "spin", "curvature"].map(|p| value(&format!("{c}_{p}_power_W"))))
        .sum();
    assert!((parts / value("dissipated_power_W") - 1.0).abs() < 1e-9, "{result}");
    // Only model `rigid` has a contact at the unloaded flank.
    assert!(result["unloaded_flank_differential_slip_m_s"].is_null());
}

#[test]
fn jam_output_contains_verdicts_and_margins() {
    let result = json(&["solve", &example("dong2020.json"), "--show", "jam", "--model", "elastic"]);
    let value = |name: &str| result[name].as_f64().unwrap_or_else(|| panic!("{name}"));
    let thrusts = ["apex_thrust_N", "step_thrust_N", "entry_thrust_N"].map(value);
    let thrust = thrusts.into_iter().fold(0.0, f64::max);
    for (friction, name) in [
        ("stopped_track_friction_N", "ball_return_margin"),
        ("screw_track_friction_N", "published_margin"),
        ("weaker_track_friction_N", "weaker_contact_margin"),
    ] {
        assert!((value(name) / (value(friction) / thrust) - 1.0).abs() < 1e-12, "{name}");
    }
    assert_eq!(result["verdicts"]["jams"]["answer"], value("ball_return_margin") <= 1.0);
    let jamming = json(&["solve", &example("jamming.json"), "--show", "jam"]);
    assert_eq!(jamming["verdicts"]["jams"]["answer"], true);
    let text = bsm(folder().path(), &["solve", &example("jamming.json"), "--show", "jam"], "");
    let text = stdout(&text);
    // Jamming is a result, not a failed check. The wedge quantity appears twice, because each kind
    // of contact has its own table.
    assert!(text.contains("self_locking_under_load  no ") && !text.contains("FAIL"), "{text}");
    assert_eq!(text.matches("wedge between the raceways").count(), 2, "{text}");
    assert_eq!(result["verdicts"]["contacts_yield"]["answer"], true);
    let total = value("nut_elastic_approach_um") + value("nut_permanent_approach_um");
    assert!((value("nut_total_approach_um") / total - 1.0).abs() < 1e-12);
    assert_eq!(result["lacks"], Value::Array(Vec::new()));

    // If optional inputs are missing, each section must state which inputs it needs.
    let dir = folder();
    let output = bsm(dir.path(), &["solve", &example("feed_drive.json"), "--show", "jam"], "");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let text = stdout(&output);
    for name in ["lubricant_density_kg_m3", "return_angle_deg", "apex_half_angle_deg"] {
        assert!(text.contains(name), "{name}: {text}");
    }
    let output = bsm(dir.path(), &["solve", &example("lin1994.json"), "--show", "jam"], "");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(
        stdout(&output).contains("omitted: deformation of the contacts and wedge angle"),
        "{}",
        stdout(&output)
    );
}

/// Regression test: trends from a published paper were once printed below the user's own results.
/// Only `validate` should print these trends.
#[test]
fn slip_and_jamming_plots_of_a_user_case_do_not_show_published_trends() {
    let dir = folder();
    for (what, case, figure, label) in [
        ("slip", "xu2015.json", "slip-traction-lead-angle-screw", "spin, printed"),
        ("jam", "dong2020.json", "jam-thrust-speed", "thrust at the apex"),
    ] {
        let args = ["solve", &example(case), "--show", what, "--figures", what];
        let output = bsm(dir.path(), &args, "");
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        assert!(!stdout(&output).contains("published trend"), "{}", stdout(&output));
        let read = |file: String| fs::read_to_string(dir.path().join(what).join(file));
        assert!(read(format!("{figure}.svg")).expect("figure").contains(label));
        assert!(read(format!("{figure}.csv")).expect("table").lines().count() > 50);
        assert!(read("trends.csv".to_owned()).is_err());
    }
}

/// Regression test: the slip sweeps assumed a rolling ball, regardless of the chosen model.
#[test]
fn slip_sweeps_use_the_chosen_model() {
    let dir = folder();
    let args = [
        "solve",
        &example("xu2015.json"),
        "--show",
        "slip",
        "--model",
        "rigid",
        "--figures",
        "figures",
    ];
    let output = bsm(dir.path(), &args, "");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let curve = fs::read_to_string(dir.path().join("figures/slip-rigid-lead-angle-nut.csv"));
    let curve = curve.expect("a figure");
    // The differential slip of a rolling ball is at most 0.136 m/s at 10 deg. The slip of a sliding
    // ball is larger.
    let slip = |line: &str| line.rsplit(',').next().and_then(|cell| cell.parse::<f64>().ok());
    let differential = curve.lines().filter(|line| line.starts_with("differential"));
    let most = differential.filter_map(slip).fold(0.0, f64::max);
    assert!(most > 10.0, "{most}: {curve}");
}

#[test]
fn invalid_input_of_an_analysis_is_reported() {
    let dir = folder();
    let (xu, dong) = (example("xu2015.json"), example("dong2020.json"));
    let angles = example("angles_only.json");
    for (args, part) in [
        (
            vec!["solve", &xu, "--show", "slip", "--model", "closed-form"],
            "model closed-form does not calculate the motion of the ball",
        ),
        (vec!["solve", &angles, "--show", "slip", "--figures", "x"], "ball_diameter_mm, "),
        (
            vec!["solve", &angles, "--show", "jam"],
            "required by model rigid, the simplest model that calculates the motion",
        ),
        (vec!["solve", &dong, "--show", "jam", "--set", "return_angle_deg=95"], "between 0 and 90"),
        (
            vec!["solve", &dong, "--show", "jam", "--set", "drag_coeficient=1"],
            "did you mean `drag_coefficient`?",
        ),
        (
            vec!["solve", &dong, "--show", "jam", "--set", "raceway_yield_strength_MPa=0"],
            "must be a finite number > 0",
        ),
        (
            vec![
                "solve",
                &xu,
                "--show",
                "slip",
                "--set",
                "friction_coefficient=0",
                "--model",
                "elastic",
            ],
            "must be > 0",
        ),
    ] {
        let output = bsm(dir.path(), &args, "");
        let text = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{args:?}: {text}");
        assert!(output.stdout.is_empty(), "{args:?}");
        assert!(text.starts_with("error: ") && text.trim_end().lines().count() == 1, "{text}");
        assert!(text.contains(part), "{args:?}: {text}");
    }
    // If the case has no solution, the command must state the reason and exit with code 3.
    let flat = ["solve", &xu, "--show", "slip", "--model", "rigid", "--set", "lead_mm=10"];
    let output = bsm(dir.path(), &flat, "");
    assert_eq!(output.status.code(), Some(3), "{}", stderr(&output));
    assert!(stdout(&output).contains("no_solution"), "{}", stdout(&output));
    let output = bsm(dir.path(), &["solve", "no-such-file.json", "--show", "jam"], "");
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(fs::read_dir(dir.path()).expect("folder").count(), 0);
}

/// The results of slip and jamming analyses must be available as table columns and as curves. For a
/// misspelled column name, the message must suggest the correct name. A column that cannot be
/// calculated in any row must be rejected before any row is solved.
#[test]
fn sweep_columns_may_be_results_of_analyses() {
    let dir = folder();
    let case = example("dong2020.json");
    let sweep = |columns: &str, more: &[&str]| {
        let vary = ["--vary", "screw_speed_rpm=500,2500", "--vary", "axial_load_N=8000,16000"];
        let args = [&["sweep", &case, "--columns", columns, "-o", "t.csv"], &vary[..], more];
        bsm(dir.path(), &args.concat(), "")
    };
    let plot = ["-o", "p.svg", "--model", "elastic"];
    let output = sweep("ball_return_margin,efficiency,nut_spin_slip_m_s,jams", &plot);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let table = fs::read_to_string(dir.path().join("t.csv")).expect("a table");
    let margin =
        json(&["solve", &case, "--show", "jam", "--model", "elastic"])["ball_return_margin"]
            .to_string();
    let last = table.lines().last().expect("rows");
    assert!(last.contains(&margin) && last.ends_with(",false"), "{margin}: {table}");
    let plot = fs::read_to_string(dir.path().join("p.svg")).expect("a plot");
    assert!(plot.contains("ball return margin"));

    for (columns, more, part) in [
        ("ball_return_margn", &[][..], "did you mean `ball_return_margin`?"),
        (
            "ball_slip_m_s",
            &["--model", "closed-form"],
            "closed-form does not calculate the motion of the ball",
        ),
    ] {
        let output = sweep(columns, more);
        assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
        assert!(stderr(&output).contains(part), "{}", stderr(&output));
    }
    let args = ["sweep", &example("feed_drive.json"), "--vary", "screw_speed_rpm=500,2500"];
    let output = bsm(dir.path(), &[&args[..], &["--columns", "jams", "-o", "u.csv"]].concat(), "");
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    let words =
        "column jams would be empty, because apex_half_angle_deg or return_angle_deg is missing";
    assert!(stderr(&output).contains(words), "{}", stderr(&output));
    assert!(!dir.path().join("u.csv").exists());
}

/// Regression test: models that do not use the preload ignored a given preload without a note.
#[test]
fn note_is_printed_for_an_unused_preload() {
    let dir = folder();
    let case = example("feed_drive.json");
    let vary = ["--vary", "screw_speed_rpm=500,1500", "-o", "t.csv"];
    for (command, more) in [
        ("solve", &[][..]),
        ("solve", &["--model", "all"]),
        ("solve", &["--show", "slip"]),
        ("solve", &["--show", "jam"]),
        ("sweep", &vary),
    ] {
        let told = |settings: &[&str]| {
            let output = bsm(dir.path(), &[&[command, &case], settings, more].concat(), "");
            assert_eq!(output.status.code(), Some(0), "{command}: {}", stderr(&output));
            // The notes of an answer are printed below its numbers.
            format!("{}{}", stdout(&output), stderr(&output))
                .contains("note: preload_N is not included in the results of the balls, because the model calculates one ball; `bsm nut`")
        };
        assert!(told(&["--set", "preload_N=4000"]), "{command}");
        assert!(!told(&[]), "{command}");
    }
}
