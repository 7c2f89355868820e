//! Tests of inputs that are given twice, and of files that a run would both read and overwrite.

use std::fs;
use std::path::Path;

use crate::program::{bsm, example, folder, json, stderr, stdout};

/// Runs a command that must fail with the given exit code and a message that contains `part`.
fn assert_rejected(folder: &Path, args: &[&str], stdin: &str, code: i32, part: &str) {
    let output = bsm(folder, args, stdin);
    let text = stderr(&output);
    assert_eq!(output.status.code(), Some(code), "{args:?}: {text}");
    assert!(text.contains(part), "{args:?}: {text}");
}

/// Returns the error message for an input that is given under two names.
fn duplicate_message(one: &str, other: &str) -> String {
    if one == other {
        format!("`{one}` is given twice")
    } else {
        format!("`{one}` and `{other}` are the same input")
    }
}

fn write(folder: &Path, name: &str, text: &str) {
    fs::write(folder.join(name), text).expect("a file");
}

fn read(name: &str) -> String {
    fs::read_to_string(example(name)).expect("an example")
}

/// Returns the example table of a manufacturer with an additional column of ones.
fn nuts_with_column(head: &str) -> String {
    let nuts = read("manufacturer_table.csv");
    let (first, rows) = nuts.split_once('\n').expect("rows");
    let rows: Vec<_> = rows.lines().map(|row| format!("{row},1\n")).collect();
    format!("{first},{head}\n{}", rows.concat())
}

#[test]
fn duplicate_column_in_a_load_cycle_is_rejected() {
    let dir = folder();
    let axis = example("axis.json");
    for (head, row, one, other) in [
        ("time_s,force_N,force_kN,feed_m_min", "1,8000,1,10", "force_N", "force_kN"),
        ("time_s,time_s,force_N,feed_m_min", "1,2,8000,10", "time_s", "time_s"),
        ("time_s,force_N,feed_m_min,feed_mm_s", "1,8000,10,1", "feed_m_min", "feed_mm_s"),
    ] {
        write(dir.path(), "cycle.csv", &format!("{head}\n{row}\n"));
        let args = ["axis", &axis, "--cycle", "cycle.csv"];
        assert_rejected(dir.path(), &args, "", 2, &duplicate_message(one, other));
    }
}

#[test]
fn duplicate_column_in_measured_points_is_rejected() {
    let dir = folder();
    let drive = example("feed_drive.json");
    for (head, row, one, other) in [
        (
            "axial_load_N,axial_load_kN,screw_torque_Nm",
            "8000,4,26",
            "axial_load_N",
            "axial_load_kN",
        ),
        ("axial_load_N,axial_load_N,screw_torque_Nm", "8000,4,26", "axial_load_N", "axial_load_N"),
        (
            "screw_torque_Nm,axial_load_N,screw_torque_Nmm",
            "26,1,2",
            "screw_torque_Nm",
            "screw_torque_Nmm",
        ),
    ] {
        write(dir.path(), "points.csv", &format!("{head}\n{row}\n"));
        let args = ["fit", &drive, "--points", "points.csv", "--measured", "screw_torque_Nm"];
        assert_rejected(dir.path(), &args, "", 2, &duplicate_message(one, other));
    }
    write(
        dir.path(),
        "points.csv",
        "axial_load_N,friction_coefficient,screw_torque_Nm\n8000,0.05,26\n",
    );
    let args = ["fit", &drive, "--points", "points.csv", "--measured", "screw_torque_Nm"];
    assert_rejected(dir.path(), &args, "", 2, "is replaced by an input that the fit determines");
    write(dir.path(), "points.csv", "axial_load_N,screw_torque_Nm\n8000,26\n");
    for (one, other, part) in [
        ("friction_coefficient", "friction_coefficient", "is given twice"),
        ("lead_mm", "lead_angle_deg=1:20", "both are given"),
    ] {
        let args = [&args[..], &["--input", one, "--input", other]].concat();
        assert_rejected(dir.path(), &args, "", 2, part);
    }
}

#[test]
fn duplicate_column_in_a_list_of_nuts_is_rejected() {
    let dir = folder();
    for (head, part) in [
        ("lead_inch", duplicate_message("lead_mm", "lead_inch")),
        ("lead_mm", duplicate_message("lead_mm", "lead_mm")),
        (
            "rated_dynamic_load_N",
            duplicate_message("dynamic_load_rating_N", "rated_dynamic_load_N"),
        ),
    ] {
        write(dir.path(), "nuts.csv", &nuts_with_column(head));
        assert_rejected(dir.path(), &["select", "--from", "nuts.csv"], "", 2, &part);
    }
    write(dir.path(), "nuts.csv", &nuts_with_column("P"));
    write(dir.path(), "names.json", r#"{"P": "lead_mm"}"#);
    let args = ["select", "--from", "nuts.csv", "--names", "names.json"];
    assert_rejected(dir.path(), &args, "", 2, &duplicate_message("lead_mm", "P"));
}

#[test]
fn duplicate_column_in_a_list_of_sizes_is_rejected() {
    let dir = folder();
    let sizes = stdout(&bsm(dir.path(), &["select", "--show", "sizes"], ""));
    let (first, rows) = sizes.split_once('\n').expect("rows");
    let rows: Vec<_> = rows.lines().map(|row| format!("{row},1\n")).collect();
    write(dir.path(), "sizes.csv", &format!("{first},lead_inch\n{}", rows.concat()));
    assert_rejected(
        dir.path(),
        &["select", "--from", "sizes.csv"],
        "",
        2,
        &duplicate_message("lead_mm", "lead_inch"),
    );
}

#[test]
fn duplicate_input_in_a_requirement_is_rejected() {
    let dir = folder();
    let requirement = read("requirements/axis.json");
    let load = "\"axial_load_kN\": 10,";
    assert!(requirement.contains(load), "{requirement}");
    let twice = requirement.replace(load, &format!("{load} \"axial_load_N\": 5000,"));
    assert_rejected(
        dir.path(),
        &["select", "-"],
        &twice,
        2,
        &duplicate_message("axial_load_kN", "axial_load_N"),
    );
    let set = ["select", "-", "--set", "axial_load_N=1", "--set", "load_kN=2"];
    assert_rejected(
        dir.path(),
        &set,
        &requirement,
        2,
        &duplicate_message("axial_load_N", "load_kN"),
    );
    let set = ["select", "-", "--set", "objective=mass", "--set", "objective=power"];
    assert_rejected(
        dir.path(),
        &set,
        &requirement,
        2,
        &duplicate_message("objective", "objective"),
    );
}

#[test]
fn duplicate_key_of_a_case_is_rejected() {
    let dir = folder();
    let axis = example("axis.json");
    for (entry, one, other) in [
        (r#""cycle": [{"time_s": 1, "force_N": 8000, "force_N": 1}]"#, "force_N", "force_N"),
        (r#""cycle": [{"time_s": 1, "force_N": 8000, "force_kN": 1}]"#, "force_N", "force_kN"),
        (
            r#""circuits": [{"start_deg": 0, "arc_deg": 360, "balls": 60, "balls": 30}]"#,
            "balls",
            "balls",
        ),
        (
            r#""lead_error": [{"slope_um_per_mm": 1, "slope_um_per_mm": 2}]"#,
            "slope_um_per_mm",
            "slope_um_per_mm",
        ),
        (r#""support": "fixed-free", "support": "fixed-fixed""#, "support", "support"),
        (r#""preload_N": "auto", "preload_class": "Z0""#, "preload_N", "preload_class"),
        (r#""axial_load_kN": 1, "axial_load_N": 1"#, "axial_load_kN", "axial_load_N"),
    ] {
        assert_rejected(
            dir.path(),
            &["nut", "-"],
            &format!("{{{entry}}}"),
            2,
            &duplicate_message(one, other),
        );
    }
    for (one, other) in
        [("load_kN=1", "axial_load_N=1"), ("support=fixed-free", "support=fixed-free")]
    {
        let name = |setting: &'static str| setting.split('=').next().unwrap_or_default();
        let args = ["axis", &axis, "--set", one, "--set", other];
        assert_rejected(dir.path(), &args, "", 2, &duplicate_message(name(one), name(other)));
    }
}

#[test]
fn duplicate_option_is_rejected() {
    let dir = folder();
    let drive = example("feed_drive.json");
    let args = ["solve", &drive, "--model=traction", "--accuracy", "1e-6", "--accuracy", "1e-10"];
    assert_rejected(
        dir.path(),
        &args,
        "",
        2,
        "the argument '--accuracy <ERROR>' cannot be used multiple times",
    );
    write(dir.path(), "nuts.csv", &read("manufacturer_table.csv"));
    let args = ["select", "--from", "nuts.csv", "--decimal", "point", "--decimal", "comma"];
    assert_rejected(
        dir.path(),
        &args,
        "",
        2,
        "the argument '--decimal <SIGN>' cannot be used multiple times",
    );
}

#[test]
fn option_set_accepts_a_text_with_spaces_as_the_description() {
    let dir = folder();
    let args = ["solve", &example("feed_drive.json"), "--set", "description=my screw", "--json"];
    let output = bsm(dir.path(), &args, "");
    assert_eq!(json(&stdout(&output))["inputs"]["description"], "my screw", "{}", stderr(&output));
}

#[test]
fn fit_fails_outside_its_range_and_states_reachable_values() {
    let dir = folder();
    let drive = example("feed_drive.json");
    let fit = |torques: [&str; 2], more: &[&str]| {
        let [one, other] = torques;
        let table = format!("axial_load_N,screw_torque_Nm\n8000,{one}\n4000,{other}\n");
        fs::write(dir.path().join("points.csv"), table).expect("a table");
        let args = ["fit", &drive, "--points", "points.csv", "--measured", "screw_torque_Nm"];
        bsm(dir.path(), &[&args[..], &["--model", "raceway-control"], more].concat(), "")
    };
    for (torques, more, end) in [
        (["39", "17"], &[][..], "friction_coefficient = 0.500000"),
        (["0", "0"], &["--errors", "absolute"], "friction_coefficient = 0.000100"),
        (["-26", "-13"], &["--input", "lead_mm"], "lead_mm = 5.000000"),
    ] {
        let output = fit(torques, more);
        let text = stderr(&output);
        assert_eq!(output.status.code(), Some(3), "{text}");
        for part in [
            "the fit fails, because ",
            end,
            "is at the end of its range",
            "the model gives screw_torque_Nm from",
        ] {
            assert!(text.contains(part), "{text}");
        }
    }
    let endless = fit(["1e300", "1e300"], &[]);
    assert_eq!(endless.status.code(), Some(3), "{}", stderr(&endless));
    assert!(
        stderr(&endless).contains("outside the range of double precision"),
        "{}",
        stderr(&endless)
    );
    assert_eq!(fit(["26", "13"], &[]).status.code(), Some(0));
}

#[test]
fn no_command_overwrites_a_file_that_it_reads() {
    let dir = folder();
    let at = |name: &str| dir.path().join(name);
    let read = |name: &str| fs::read_to_string(at(name)).expect("a file");
    let copy = |from: &str, to: &str| {
        fs::create_dir_all(at(to).parent().expect("a folder")).expect("a folder");
        fs::copy(example(from), at(to)).expect("a copy");
    };
    copy("axis.json", "axis.json");
    copy("axis.json", "sheet/results.json");
    copy("feed_drive.json", "drive.json");
    copy("feed_drive.json", "other.json");
    copy("manufacturer_table.csv", "nuts.csv");
    fs::write(at("cycle.csv"), "time_s,force_N,feed_m_min\n1,8000,10\n").expect("a cycle");
    fs::write(at("points.csv"), "axial_load_N,screw_torque_Nm\n8000,26\n4000,13\n")
        .expect("points");
    fs::create_dir(at("fitted")).expect("a folder");
    fs::copy(at("points.csv"), at("fitted/fit.csv")).expect("points");
    fs::write(at("names.json"), r#"{"P": null}"#).expect("names");
    fs::write(at("load.csv"), "axial_load_N,P\n8000,1\n").expect("points");
    for (args, kept) in [
        ("axis axis.json --cycle cycle.csv -o cycle.csv", "cycle.csv"),
        ("axis sheet/results.json --figures sheet", "sheet/results.json"),
        (
            "sweep drive.json --points load.csv --names names.json --columns efficiency -o o.csv -o names.json",
            "names.json",
        ),
        ("select --from nuts.csv --names names.json -o names.json", "names.json"),
        (
            "fit drive.json --points fitted/fit.csv --measured screw_torque_Nm --figures fitted",
            "fitted/fit.csv",
        ),
        ("view drive.json other.json -o other.json", "other.json"),
    ] {
        let before = read(kept);
        let args: Vec<_> = args.split(' ').collect();
        assert_rejected(dir.path(), &args, "", 2, "is an input file and would be overwritten");
        assert_eq!(read(kept), before, "{args:?}");
    }
    assert!(!at("o.csv").exists() && !at("sheet/report.html").exists());
    let args = ["solve", "drive.json", "-o", "one.json", "-o", "./one.json"];
    assert_rejected(dir.path(), &args, "", 2, "would be written twice");
}

#[test]
fn a_folder_named_like_a_table_is_rejected_as_output() {
    let dir = folder();
    for name in ["map.csv", "map.parquet"] {
        fs::create_dir(dir.path().join(name)).expect("a folder");
        let args =
            ["sweep", &example("feed_drive.json"), "--vary=axial_load_N=1000,2000", "-o", name];
        assert_rejected(dir.path(), &args, "", 1, "the path is a folder");
        assert_eq!(fs::read_dir(dir.path().join(name)).expect("a folder").count(), 0);
    }
}

/// Regression test: a plotted output was missing from the table of the same run. The output was
/// requested for two columns, but batch kernels wrote it to only one of them.
#[test]
fn table_does_not_depend_on_a_requested_plot() {
    let dir = folder();
    let drive = example("feed_drive.json");
    for model in ["auto", "rigid", "raceway-control", "elastic", "traction"] {
        let args = ["sweep", &drive, "--model", model, "--vary=axial_load_N=1000:20000:20"];
        let columns = ["--columns", "efficiency,ball_torque_Nm", "-o"];
        let plain = bsm(dir.path(), &[&args[..], &columns, &["plain.csv"]].concat(), "");
        assert_eq!(plain.status.code(), Some(0), "{}", stderr(&plain));
        let to = ["plotted.csv", "-o", "plot.svg"];
        let plotted = bsm(dir.path(), &[&args[..], &columns, &to].concat(), "");
        assert_eq!(plotted.status.code(), Some(0), "{}", stderr(&plotted));
        let read = |name: &str| fs::read_to_string(dir.path().join(name)).expect("a table");
        assert_eq!(read("plotted.csv"), read("plain.csv"), "{model}");
    }
}

/// The interval of lubricated friction must have the same bounds in a table column and in the
/// answer for a single point.
#[test]
fn table_columns_contain_the_friction_interval_of_single_solves() {
    let dir = folder();
    let drive = example("feed_drive_oil.json");
    let columns = ["contact_loss_ratio", "ball_torque_Nm", "efficiency"];
    let names: Vec<_> = columns
        .iter()
        .flat_map(|column| {
            let (stem, unit) =
                column.split_at(column.len() - if column.ends_with("_Nm") { 3 } else { 0 });
            let stem = stem.strip_prefix("contact_").unwrap_or(stem);
            ["low", "high"].map(|end| format!("band_{stem}_{end}{unit}"))
        })
        .collect();
    let args = ["sweep", &drive, "--vary=screw_speed_rpm=30,1000", "--columns", &names.join(",")];
    let output = bsm(dir.path(), &[&args[..], &["-o", "rows.jsonl"]].concat(), "");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let rows = fs::read_to_string(dir.path().join("rows.jsonl")).expect("rows");
    for row in rows.lines().map(json) {
        let speed = format!("screw_speed_rpm={}", row["screw_speed_rpm"]);
        let args = ["solve", &drive, "--show", "band", "--set", &speed, "--json"];
        let single = json(&stdout(&bsm(dir.path(), &args, "")));
        for (place, column) in columns.iter().enumerate() {
            for (end, name) in ["low", "high"].iter().zip(&names[2 * place..]) {
                assert!(
                    row[name].is_f64() && row[name] == single["band"][column][end],
                    "{name}: {row} {single}"
                );
            }
        }
    }
}

/// A load of 1e6 N on 70 balls causes pressures above 4200 MPa and contact ellipses that extend
/// beyond the flanks, so warnings are expected.
#[test]
fn table_rows_report_the_warnings_of_single_solves() {
    let dir = folder();
    let drive = example("feed_drive.json");
    for model in ["auto", "raceway-control", "rigid", "traction"] {
        let args = ["sweep", &drive, "--model", model, "--vary=axial_load_N=8000,1000000"];
        let to = ["--columns", "efficiency,warnings", "-o", "rows.jsonl"];
        let output = bsm(dir.path(), &[&args[..], &to].concat(), "");
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let rows = fs::read_to_string(dir.path().join("rows.jsonl")).expect("rows");
        let mut counts = Vec::new();
        for row in rows.lines().map(json) {
            let load = format!("axial_load_N={}", row["axial_load_N"]);
            let args = ["solve", &drive, "--model", model, "--set", &load, "--json"];
            let single = json(&stdout(&bsm(dir.path(), &args, "")));
            let texts = single["warnings"].as_array().expect("warnings");
            let count = u32::try_from(texts.len()).expect("few warnings");
            assert_eq!(row["warnings"].as_f64(), Some(count.into()), "{model}: {row}");
            for text in texts {
                let message = row["message"].as_str().expect("a message");
                assert!(message.contains(text.as_str().expect("a text")), "{model}: {message}");
            }
            counts.push(texts.len());
        }
        // Model `rigid` calculates neither pressures nor contact ellipses.
        assert!(model == "rigid" || counts[1] > counts[0], "{model}: {counts:?}");
    }
}
