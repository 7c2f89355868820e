//! Tests of `bsm axis`, and of inputs in other units, on the command line.

use std::fs;

use serde_json::Value;

use crate::program::{bsm, example, folder, json, stderr, stdout};

fn number(results: &Value, name: &str) -> f64 {
    results[name].as_f64().unwrap_or_else(|| panic!("{name} in {results}"))
}

/// Three commands must lead from a requirement to an axis sheet, for a horizontal and a vertical
/// axis. The sheet must contain everything that a user would otherwise have to calculate by hand,
/// and its numbers must agree with hand calculations based on the formulas in the theory chapters.
#[test]
fn three_commands_lead_from_a_requirement_to_a_sheet() {
    let requirement = example("requirements/axis.json");
    for (way, set, load) in [
        // The guide friction is 1 % of the weight of a 500 kg mass.
        ("level", "inclination_deg=0", 10_000.0 + 0.01 * 500.0 * 9.806_65),
        ("upright", "inclination_deg=90", 10_000.0 + 500.0 * 9.806_65),
    ] {
        let dir = folder();
        let run = |args: &[&str]| {
            let output = bsm(dir.path(), args, "");
            assert_eq!(
                output.status.code(),
                Some(0),
                "{way} {args:?}: {}{}",
                stdout(&output),
                stderr(&output)
            );
            stdout(&output)
        };
        // Only the process force is given. The weight and the guide friction are calculated from
        // the mass.
        run(&["select", &requirement, "--from", "standard", "--set", set, "-o", "screw.json"]);
        run(&["nut", "screw.json"]);
        let sheet = json(&run(&["axis", "screw.json", "--figures", "sheet", "--json"]));
        let (screw, results) = (&sheet["screw"], &sheet["results"]);
        assert_eq!(sheet["passes"], true, "{way}");

        let close = |name: &str, by_hand: f64, tolerance: f64| {
            let ours = number(results, name);
            assert!(
                (ours / by_hand - 1.0).abs() < tolerance,
                "{way} {name}: {ours}, by hand {by_hand}"
            );
        };
        let lead = number(screw, "lead_mm");
        let rpm = 30_000.0 / lead;
        // The tolerances allow for the rounding errors of a few multiplications.
        close("largest_speed_rpm", rpm, 1e-12);
        close("largest_load_N", load, 1e-9);
        let length = 1200.0 + number(screw, "nut_length_mm") + 2.0 * lead;
        close("unsupported_length_mm", length, 1e-9);
        // The catalog factor 15.1 has only three digits, and the buckling factor in catalogs is
        // based on a slightly different flexural rigidity E I (difference below 1.5 %).
        let core = number(screw, "screw_core_diameter_mm");
        let permitted = 15.1e7 * core / length.powi(2);
        close("critical_speed_rpm", permitted / 0.8, 6e-3);
        close("buckling_load_N", 4.072e5 * core.powi(4) / length.powi(2), 0.02);
        let hours = 1e6 / (60.0 * rpm) * (number(screw, "dynamic_load_rating_N") / load).powi(3);
        close("cycle_life_h", hours, 1e-9);
        close("equivalent_load_N", load, 1e-9);
        // The lands between the grooves lie outside the radius of a solid rod with the same length
        // and mass, so the moment of inertia of the rod is up to 5 % smaller.
        let mass = number(results, "screw_mass_kg");
        let square = 4.0 * mass / (std::f64::consts::PI * 7850.0 * length * 1e-3);
        let over_rod = number(results, "inertia_of_screw_kg_m2") / (mass * square / 8.0);
        assert!((1.0..1.05).contains(&over_rod), "{way}: {over_rod}");
        assert!(square.sqrt() * 1e3 < number(screw, "screw_outer_diameter_mm"), "{way}");
        // The efficiency of the ball contacts is 0.95 to 1. Bearings and seals add 0.8 N m to the
        // torque.
        let ideal = load * lead * 1e-3 / std::f64::consts::TAU;
        let torque = number(results, "peak_motor_torque_Nm") - 0.8;
        assert!((0.95..1.0).contains(&(ideal / torque)), "{way}: {ideal} {torque}");

        // The page must contain every rule of the JSON output.
        let page = fs::read_to_string(dir.path().join("sheet/report.html")).expect("a page");
        for rule in sheet["rules"].as_array().expect("rules") {
            assert!(page.contains(rule["rule"].as_str().expect("a title")), "{rule}");
        }
        assert!(page.contains("<li>Not modeled: ") && page.matches("<svg").count() == 2);
        let written = fs::read_to_string(dir.path().join("sheet/results.json")).expect("numbers");
        assert_eq!(json(&written), sheet);
        // The footer of the page must name the case file.
        let foot = page.split("screw.json, SHA-256 ").nth(1).expect("a foot");
        assert!(foot[..64].bytes().all(|digit| digit.is_ascii_hexdigit()), "{foot}");
        // The rules must also be available as a table.
        let table = run(&["axis", "screw.json", "-o", "-"]);
        let mut rows = csv::Reader::from_reader(table.as_bytes());
        let rows: Vec<_> = rows.records().map(|row| row.expect("a row")).collect();
        for (row, rule) in rows.iter().zip(sheet["rules"].as_array().expect("rules")) {
            assert_eq!(row[0], rule["rule"], "{row:?}");
            assert_eq!(row[2].parse::<f64>().ok(), rule["value"].as_f64(), "{row:?}");
            assert_eq!(&row[6] == "fails", rule["passes"] == false, "{row:?}");
        }
        assert_eq!(rows.len(), sheet["rules"].as_array().expect("rules").len());
    }
}

/// Regression test: four outputs stated the efficiencies 0.879, 0.98750, 0.98774 and 0.99131 for
/// the same screw, and none of these efficiencies included the preload. Every output must state the
/// same efficiency with the same contributions.
#[test]
fn all_commands_report_the_same_efficiency_for_a_screw() {
    let dir = folder();
    let requirement = example("requirements/axis.json");
    let run = |args: &[&str]| {
        let output = bsm(dir.path(), args, "");
        let code = output.status.code();
        assert!(matches!(code, Some(0 | 3)), "{args:?}: {}", stderr(&output));
        stdout(&output)
    };
    // In this case, only the balls cause losses: there is no moved mass, and there are no guides,
    // seals or support bearings.
    let requirement: Value = json(&fs::read_to_string(&requirement).expect("a requirement"));
    let mut requirement = requirement.as_object().expect("an object").clone();
    requirement.retain(|name, _| {
        !["moved_mass", "guide", "support_bearing", "seal"]
            .iter()
            .any(|part| name.starts_with(part))
    });
    fs::write(dir.path().join("requirement.json"), Value::Object(requirement).to_string())
        .expect("written");
    let design = json(&run(&[
        "select",
        "requirement.json",
        "--from",
        "standard",
        "-o",
        "screw.json",
        "--json",
    ]));
    let step = |name: &str| {
        let steps = design["steps"].as_array().expect("steps");
        let step = steps.iter().find(|step| step["name"] == name);
        number(step.unwrap_or_else(|| panic!("no {name}")), "value")
    };
    let solved = json(&run(&["solve", "screw.json", "--json"]));
    let efficiency = number(&solved, "efficiency");
    let close = |what: &str, other: f64, tolerance: f64| {
        assert!(
            (other / efficiency - 1.0).abs() < tolerance,
            "{what}: {other}, solve {efficiency}"
        );
    };
    // The compared commands solve the same point with the same model, so their efficiencies differ
    // only by rounding errors of unit conversions.
    close("select", step("screw_efficiency"), 1e-9);
    let sheet = json(&run(&["axis", "screw.json", "--figures", "sheet", "--json"]));
    close("axis", number(&sheet["results"], "screw_efficiency"), 1e-9);
    close("phase", number(&sheet["phases"][0], "screw_efficiency"), 1e-9);
    // The force balance is solved for each ball of the nut, but in this case all balls carry the
    // same load.
    let nut = json(&run(&["nut", "screw.json", "--json"]));
    close("nut", number(&nut, "nut_efficiency"), 1e-9);
    let page = fs::read_to_string(dir.path().join("sheet/report.html")).expect("a page");
    let printed = format!("{efficiency:.3}");
    assert!(page.contains(&printed), "the report has no {printed}");
    let like = |name: &str| {
        let screw: Value =
            json(&fs::read_to_string(dir.path().join("screw.json")).expect("a screw"));
        format!("{name}={}", number(&screw, name))
    };
    let same = [
        "lead_mm",
        "ball_diameter_mm",
        "loaded_turns",
        "pitch_circle_diameter_mm",
        "nut_conformity",
    ]
    .map(like);
    let asked = same.iter().flat_map(|condition| ["--where", condition]);
    let args = ["select", "requirement.json", "--from", "standard", "--json"];
    let args: Vec<_> = args.into_iter().chain(asked).collect();
    let rows = json(&run(&args));
    assert_eq!(rows.as_array().map(Vec::len), Some(1), "{rows}");
    close("select", number(&rows[0], "screw_efficiency"), 1e-9);

    // With preload, seals and bearings, the outputs of `solve`, `axis` and `nut` must contain the
    // same torque contributions.
    let sets = ["preload_N=2000", "seal_torque_Nm=0.3", "support_bearing_torque_Nm=0.5"];
    let sets: Vec<_> = sets.iter().flat_map(|set| ["--set", *set]).collect();
    let with =
        |command: &str| json(&run(&[&[command, "screw.json", "--json"], &sets[..]].concat()));
    let (solved, sheet, nut) = (with("solve"), with("axis"), with("nut"));
    let (parts, phase) = (&solved["torque_parts"], &sheet["phases"][0]);
    let names = parts.as_object().expect("parts of the torque").keys();
    assert!(names.len() > 6, "{parts}");
    for name in names {
        assert_eq!(parts[name], phase[name], "{name}");
    }
    let part = |name: &str| number(parts, name);
    let rub = part("contact_friction_torque_Nm");
    assert!((rub / number(&nut, "friction_torque_Nm") - 1.0).abs() < 1e-9, "{parts} {nut}");
    // The preload drag is the torque according to the manufacturers' rule, 0.05/sqrt(tan a) F l/(2
    // pi), minus the contact friction under preload at 100 rpm, the speed at which manufacturers
    // measure the torque. Contact friction is interpolated between ball loads with a relative error
    // of 1e-9.
    let whole = number(&sheet["results"], "preload_torque_measured_Nm");
    let slow = [&["nut", "screw.json", "--json"], &sets[..], &["--set", "screw_speed_rpm=100"]];
    let slow = json(&run(&slow.concat()));
    let drag = part("preload_drag_beyond_contacts_Nm");
    assert!((drag - (whole - number(&slow, "preload_torque_Nm"))).abs() < 1e-9 * drag, "{parts}");
    let sum = part("ideal_torque_Nm") + rub + drag + 0.3 + 0.5;
    assert!((part("screw_torque_Nm") / sum - 1.0).abs() < 1e-12, "{parts}");
    let table = run(&[&["solve", "screw.json"], &sets[..]].concat());
    assert!(
        table.contains("model of the ball contacts") && table.contains("support bearings"),
        "{table}"
    );
}

/// Returns all numbers in an answer with their names, except for the inputs that the answer
/// repeats.
fn named_numbers(answer: &Value) -> Vec<(String, f64)> {
    let mut found = Vec::new();
    let mut take = |map: &Value| {
        for (name, value) in map.as_object().into_iter().flatten() {
            found.extend(value.as_f64().map(|value| (name.clone(), value)));
        }
    };
    take(answer);
    for part in ["torque_parts", "results", "screw"] {
        take(&answer[part]);
    }
    take(&answer["phases"][0]);
    // The number of solver iterations is not a physical quantity.
    found.retain(|(name, _)| name != "iterations");
    for list in ["steps", "rules"] {
        for row in answer[list].as_array().into_iter().flatten() {
            let name = row["name"].as_str().expect("a name").to_owned();
            found.extend(row["value"].as_f64().map(|value| (name, value)));
        }
    }
    found
}

/// Regression test: different outputs for the same screw stated the torques 32.3, 34.9 and 35.0 N
/// m, and one answer contained two efficiencies. Each name must have only one value, within an
/// answer and across commands. The test cases are a horizontal and a vertical axis, a warm
/// preloaded pair, and a feed drive with and without oil.
#[test]
fn outputs_with_equal_names_have_equal_values_in_all_commands() {
    let dir = folder();
    let run = |args: &[&str]| {
        let output = bsm(dir.path(), args, "");
        let code = output.status.code();
        assert!(matches!(code, Some(0 | 3)), "{args:?}: {}", stderr(&output));
        json(&stdout(&output))
    };
    let same = |case: &str, answers: &[(&str, Value)]| {
        let mut known: Vec<(String, &str, f64)> = Vec::new();
        let mut shared = 0;
        for (command, answer) in answers {
            for (name, value) in named_numbers(answer) {
                if let Some((_, other, old)) = known.iter().find(|(own, ..)| *own == name) {
                    // The tolerance allows for rounding errors of unit conversions and for the
                    // tolerance 1e-9 of a search.
                    let apart = (value - old).abs();
                    assert!(
                        apart <= 1e-8 * old.abs(),
                        "{case}: {name} is {old} by {other} and {value} by {command}"
                    );
                    shared += usize::from(other != command);
                } else {
                    known.push((name, command, value));
                }
            }
        }
        assert!(shared >= 5, "{case}: {shared} names in common");
        let number = |wanted: &str| {
            let found = known.iter().find(|(name, ..)| name == wanted);
            found.unwrap_or_else(|| panic!("{case}: no {wanted}")).2
        };
        [
            number("ball_torque_Nm"),
            number("screw_torque_Nm"),
            number("efficiency"),
            number("screw_efficiency"),
        ]
    };
    let requirement = example("requirements/axis.json");
    for slope in ["inclination_deg=0", "inclination_deg=90"] {
        let from = ["--from", "standard", "--json", "-o", "screw.json"];
        let design = [&["select", &*requirement, "--set", slope], &from[..]].concat();
        let design = run(&design);
        let screw = json(&fs::read_to_string(dir.path().join("screw.json")).expect("a screw"));
        let requirement: Value = json(&fs::read_to_string(&requirement).expect("a requirement"));
        let mut requirement = requirement.as_object().expect("an object").clone();
        requirement.insert("inclination_deg".to_owned(), screw["inclination_deg"].clone());
        fs::write(dir.path().join("requirement.json"), Value::Object(requirement).to_string())
            .expect("written");
        let like = [
            "lead_mm",
            "ball_diameter_mm",
            "loaded_turns",
            "pitch_circle_diameter_mm",
            "nut_conformity",
        ];
        let like = like.map(|name| format!("{name}={}", number(&screw, name)));
        let asked = like.iter().flat_map(|condition| ["--where", condition]);
        let args = ["select", "requirement.json", "--from", "standard", "--json"];
        let listed = run(&args.into_iter().chain(asked).collect::<Vec<_>>());
        assert_eq!(listed.as_array().map(Vec::len), Some(1), "{slope}: {listed}");
        // All commands use the model with which `bsm select` has chosen the screw.
        let model = ["--model", "raceway-control"];
        let of = |command: &str| run(&[&[command, "screw.json", "--json"], &model[..]].concat());
        let answers = [
            ("select", design),
            ("select --where", listed[0].clone()),
            ("solve", of("solve")),
            ("nut", of("nut")),
            ("axis", of("axis")),
        ];
        same(slope, &answers);
    }
    let both = |case: &str, more: &[&str]| {
        let sets: Vec<_> = more.iter().flat_map(|set| ["--set", *set]).collect();
        let of = |command: &'static str| {
            (command, run(&[&[command, case, "--json"], &sets[..]].concat()))
        };
        same(case, &[of("solve"), of("nut"), of("axis")])
    };
    both(&example("axis.json"), &["screw_temperature_rise_K=5"]);
    // The nut of the feed drive has a seal and is solved both with and without oil.
    for name in ["feed_drive.json", "feed_drive_oil.json"] {
        let drive: Value = json(&fs::read_to_string(example(name)).expect("an example"));
        let mut drive = drive.as_object().expect("an object").clone();
        let balls = drive.remove("loaded_balls").and_then(|balls| balls.as_f64()).expect("balls");
        drive.insert("loaded_turns".to_owned(), 4.into());
        drive.insert("loaded_balls_per_turn".to_owned(), (balls / 4.0).into());
        drive.insert("seal_torque_Nm".to_owned(), 0.3.into());
        fs::write(dir.path().join(name), Value::Object(drive).to_string()).expect("written");
        let [torque, whole, efficiency, of_screw] = both(name, &[]);
        // With or without oil, the seal contributes only to the screw torque.
        assert!((whole - torque - 0.3).abs() < 1e-9 * whole, "{name}: {torque} {whole}");
        let output = efficiency * torque;
        assert!((of_screw * whole / output - 1.0).abs() < 1e-9, "{name}: {efficiency} {of_screw}");
    }
}

/// Regression test: every solve with a lubricant printed a warning that required no action. This
/// information is now a note.
#[test]
fn lubricated_solve_prints_a_note_instead_of_a_warning() {
    let dir = folder();
    let oil = example("feed_drive_oil.json");
    let output = bsm(dir.path(), &["solve", &oil], "");
    let (text, said) = (stdout(&output), stderr(&output));
    assert!(text.contains("note: Friction from the lubricant") && said.is_empty(), "{text}{said}");
    let answer = json(&stdout(&bsm(dir.path(), &["solve", &oil, "--json"], "")));
    assert_eq!(answer["warnings"], Value::Array(Vec::new()));
    assert!(answer["notes"][0].as_str().is_some_and(|note| note.contains("lubricant")), "{answer}");
}

/// If a rule fails, the exit code must be 3, and the sheet must suggest remedies. With each of
/// these remedies, the rule must be met.
#[test]
fn violated_rule_is_met_after_any_suggested_remedy_is_applied() {
    let dir = folder();
    let sheet = |settings: &[&str]| {
        let axis = example("axis.json");
        let sets = settings.iter().flat_map(|setting| ["--set", *setting]);
        let args: Vec<_> = ["axis", &axis, "--json"].into_iter().chain(sets).collect();
        let output = bsm(dir.path(), &args, "");
        (output.status.code(), json(&stdout(&output)))
    };
    let (code, slim) = sheet(&["stroke_mm=2500", "shaft_diameter_mm=30"]);
    assert_eq!(code, Some(3));
    let rules = slim["rules"].as_array().expect("rules");
    let rule = rules.iter().find(|rule| rule["name"] == "critical_speed_ratio").expect("a rule");
    assert_eq!(rule["passes"], false);
    let remedy = rule["remedy"].as_str().expect("a remedy");
    assert!(remedy.starts_with("stroke_mm of at most"), "{remedy}");
    let stroke: f64 = remedy
        .split_whitespace()
        .find_map(|word| word.trim_end_matches(',').parse().ok())
        .unwrap_or_else(|| panic!("{remedy}"));
    for (change, passes) in [(-1.0, true), (1.0, false)] {
        // The length between the bearings is the length of the thread, which follows from the
        // stroke.
        let stroke = format!("stroke_mm={}", stroke + change);
        let (_, changed) = sheet(&[&stroke, "shaft_diameter_mm=30"]);
        let rules = changed["rules"].as_array().expect("rules");
        let rule = rules.iter().find(|rule| rule["name"] == "critical_speed_ratio");
        assert_eq!(rule.expect("a rule")["passes"], passes, "{stroke}");
    }
}

/// A load cycle in a user's table with semicolons, decimal commas and kilonewtons must have the
/// same effect as an identical cycle in the case.
#[test]
fn load_cycle_is_read_from_a_users_table() {
    let dir = folder();
    let table =
        "time_s;force_kN;feed_m_min;acceleration_m_s2\n0,2;0;30;2,5\n2,0;10;30;0\n0,2;0;30;-2,5\n";
    fs::write(dir.path().join("cycle.csv"), table).expect("written");
    let axis = example("axis.json");
    let args = [
        "axis",
        &axis,
        "--cycle",
        "cycle.csv",
        "--delimiter",
        "semicolon",
        "--decimal",
        "comma",
        "--json",
    ];
    let output = bsm(dir.path(), &args, "");
    let from_table = json(&stdout(&output));
    let cycle = r#"cycle=[{"time_s":0.2,"feed_m_min":30,"acceleration_m_s2":2.5},
        {"time_s":2.0,"force_N":10000,"feed_m_min":30},
        {"time_s":0.2,"feed_m_min":30,"acceleration_m_s2":-2.5}]"#;
    let args = ["axis", &axis, "--set", cycle, "--json"];
    let in_case = json(&stdout(&bsm(dir.path(), &args, "")));
    for part in ["phases", "results", "rules"] {
        assert_eq!(from_table[part], in_case[part]);
    }
    assert_eq!(in_case["phases"].as_array().map(Vec::len), Some(3));
    // The load consists of the force that accelerates 500 kg at 2.5 m/s² and the guide friction of
    // 49 N.
    let first = number(&in_case["phases"][0], "screw_load_N");
    assert!((first - 1_299.033_25).abs() < 1e-6, "{first}");
    let args = ["axis", &axis, "--cycle", "cycle.csv"];
    assert_eq!(bsm(dir.path(), &args, "").status.code(), Some(2));
}

/// Cases, settings, sweeps and tables must accept input names that end with other units, and a feed
/// rate instead of a speed.
#[test]
fn input_names_may_end_with_any_unit() {
    let dir = folder();
    let drive = example("feed_drive.json");
    let torque = |args: &[&str]| {
        let args = [&["solve", &drive, "--json"], args].concat();
        let output = bsm(dir.path(), &args, "");
        assert_eq!(output.status.code(), Some(0), "{args:?} {}", stderr(&output));
        number(&json(&stdout(&output)), "ball_torque_Nm")
    };
    let own = torque(&[]);
    for settings in [
        &["axial_load_kN=8"][..],
        &["feed_m_min=30"],
        &["speed_1_min=1500"],
        &["screw_speed_rad_s=157.07963267948966"],
        &["axial_load_lbf=1798.4715440"],
        &["lead_inch=0.7874015748031496"],
    ] {
        let sets: Vec<_> = settings.iter().flat_map(|setting| ["--set", *setting]).collect();
        // The values in pounds are given with ten digits.
        assert!((torque(&sets) / own - 1.0).abs() < 1e-9, "{settings:?}");
    }
    let points = "axial_load_kN,feed_m_min\n8,30\n4,15\n";
    let args = ["sweep", &drive, "--points", "-", "-o", "-", "--columns", "model,ball_torque_Nm"];
    for model in ["raceway-control", "auto"] {
        let output = bsm(dir.path(), &[&args[..], &["--model", model]].concat(), points);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let text = stdout(&output);
        let mut lines = text.lines();
        let header = "axial_load_N,feed_m_min,model,status,message,ball_torque_Nm";
        assert_eq!(lines.next(), Some(header), "{text}");
        assert!(lines.next().is_some_and(|row| row.starts_with("8000,30,")), "{text}");
    }
    let args =
        ["sweep", &drive, "--vary", "axial_load_kN=4,8", "-o", "-", "--columns", "ball_torque_Nm"];
    let text = stdout(&bsm(dir.path(), &args, ""));
    assert!(text.lines().nth(2).is_some_and(|row| row.starts_with("8000,")), "{text}");
    let args = ["solve", &drive, "--set", "axial_load_kN=8", "--set", "axial_load_mm=8"];
    let output = bsm(dir.path(), &args, "");
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("did you mean `axial_load_N`"), "{}", stderr(&output));
}

/// Regression test: for the unknown names `eff` and `speed`, the error message contained no
/// suggestion or a wrong suggestion.
#[test]
fn full_names_are_suggested_for_short_or_incomplete_names() {
    let dir = folder();
    let drive = example("feed_drive.json");
    let columns = |name: &str| {
        let args = ["sweep", &drive, "--vary", "lead_mm=10,20", "-o", "-", "--columns", name];
        stderr(&bsm(dir.path(), &args, ""))
    };
    for (typed, meant) in [
        ("eff", "did you mean `efficiency`? `bsm schema output` lists all outputs"),
        // The name `nut_pressure_MPa` lacks the word `max`. Earlier versions suggested a name with
        // more similar spelling but a different meaning.
        ("nut_pressure_MPa", "did you mean `nut_max_pressure_MPa`?"),
        // All unknown names must be reported in one message.
        (
            "regime,eff,eta",
            "no outputs are named `regime`, `eff` (did you mean `efficiency`?), `eta`",
        ),
    ] {
        assert!(columns(typed).contains(meant), "{}", columns(typed));
    }
    let output = bsm(dir.path(), &["solve", &drive, "--set", "speed=3"], "");
    assert!(stderr(&output).contains("`screw_speed_rpm`"), "{}", stderr(&output));
}

/// Regression test: nuts from the catalog, and screws that `bsm select` had designed, were rejected
/// by other commands.
#[test]
fn every_command_accepts_a_selected_nut() {
    let dir = folder();
    let args =
        ["select", "--where", "nominal_diameter_mm=40", "--where", "lead_mm=20", "-o", "nut.json"];
    assert_eq!(bsm(dir.path(), &args, "").status.code(), Some(0));
    let point =
        ["friction_coefficient=0.06", "axial_load_N=8000", "feed_m_min=30", "stroke_mm=800"];
    let sets: Vec<_> = point.iter().flat_map(|setting| ["--set", *setting]).collect();
    for command in [
        &["solve"][..],
        &["solve", "--model", "traction"],
        &["solve", "--model", "all"],
        &["nut"],
        &["solve", "--show", "ratings"],
        &["solve", "--show", "slip"],
        &["solve", "--show", "optimum"],
        &["axis"],
    ] {
        let args = [&command[..1], &["nut.json"], &command[1..], &sets].concat();
        let output = bsm(dir.path(), &args, "");
        // The exit code of `axis` is 3 if a rule on the sheet fails.
        let codes = if command[0] == "axis" { vec![0, 3] } else { vec![0] };
        let code = output.status.code().expect("a code");
        assert!(codes.contains(&code), "{command:?} {code}: {}", stderr(&output));
    }
}

/// Regression test: `axis` checked a contact ellipse with three different rules, and `--show
/// ellipses` did not check it at all.
#[test]
fn each_contact_ellipse_that_extends_beyond_its_flank_is_reported_exactly_once() {
    let dir = folder();
    let drive = example("feed_drive.json");
    for load in ["axial_load_N=200000", "axial_load_N=8000"] {
        for args in [
            &["solve", &drive][..],
            &["solve", &drive, "--show", "slip"],
            &["solve", &drive, "--show", "jam"],
            &["solve", &drive, "--show", "ellipses"],
            &["nut", &drive],
            &["axis", &drive],
        ] {
            let told = stderr(&bsm(dir.path(), &[args, &["--set", load]].concat(), ""));
            let count = told.matches("truncates the ellipse").count();
            assert_eq!(count, if load == "axial_load_N=8000" { 0 } else { 2 }, "{args:?}: {told}");
        }
    }
    // The ratings are calculated with equal loads on all balls and with the unloaded contact angle,
    // so only one contact ellipse is reported.
    let narrow = ["--set", "screw_outer_diameter_mm=38", "--set", "axial_load_N=200000"];
    let args = [&["solve", &drive, "--show", "ratings"], &narrow[..]].concat();
    let told = stderr(&bsm(dir.path(), &args, ""));
    assert_eq!(told.matches("truncates the ellipse").count(), 1, "{told}");
}

/// Regression test: `solve` omitted the note about missing churning losses in cold oil, which
/// `axis` printed.
#[test]
fn every_command_prints_a_note_about_missing_churning_losses() {
    let dir = folder();
    let oil = example("feed_drive_oil.json");
    let lacks = |command: &str, more: &[&str]| {
        let args = [&[command, &oil, "--json", "--set", "lubricant_temperature_C=-30"], more];
        let found = json(&stdout(&bsm(dir.path(), &args.concat(), "")));
        let all = found["not_given"].as_array().cloned().unwrap_or_default();
        let texts = all.iter().filter_map(|lack| lack["text"].as_str().map(str::to_owned));
        texts.filter(|text| text.contains("churning")).collect::<Vec<_>>()
    };
    let told = lacks("solve", &[]);
    assert_eq!(told.len(), 1, "{told:?}");
    assert_eq!(told, lacks("nut", &[]));
    assert_eq!(told, lacks("axis", &[]));
    for command in ["solve", "nut", "axis"] {
        assert!(lacks(command, &["--set", "drag_coefficient=1"]).is_empty(), "{command}");
    }
}

/// For two catalog screws on the same axis, the comparison must state which offer is better under
/// each rule, and must list the inputs that differ.
#[test]
fn two_offers_are_compared_side_by_side() {
    let dir = folder();
    let offer = |rating: f64, mass: f64| {
        format!(
            r#"{{"nominal_diameter_mm": 32, "lead_mm": 10, "rated_dynamic_load_N": {rating}, "rated_static_load_N": 80000,
                "screw_mass_kg_m": {mass}, "axial_load_N": 3000, "feed_m_min": 10, "stroke_mm": 500, "required_life_h": 1000,
                "seal_torque_Nm": 0.2, "support_bearing_torque_Nm": 0.2, "load_factor": 1.2}}"#
        )
    };
    fs::write(dir.path().join("a.json"), offer(30_000.0, 5.5)).expect("a file");
    fs::write(dir.path().join("b.json"), offer(40_000.0, 6.0)).expect("a file");
    let output = bsm(dir.path(), &["axis", "a.json", "b.json", "--json"], "");
    let both = json(&stdout(&output));
    let row = |table: &str, key: &str, name: &str| {
        let rows = both[table].as_array().expect("rows");
        rows.iter()
            .find(|row| row[key] == name)
            .unwrap_or_else(|| panic!("{name} in {both}"))
            .clone()
    };
    let life = row("rules", "rule", "life");
    let ratio = number(&life, "second") / number(&life, "first");
    // The ratio of the lives is the third power of the ratio of the load ratings.
    assert!((ratio - (4.0_f64 / 3.0).powi(3)).abs() < 1e-9, "{ratio}");
    assert_eq!((&life["better"], number(&life, "first_limit")), (&Value::from("second"), 1000.0));
    // Each offer has its own limit and verdict.
    let load = row("rules", "rule", "equivalent load");
    assert_eq!([&load["first_limit"], &load["second_limit"]], [30_000.0, 40_000.0]);
    assert_eq!([&load["first_verdict"], &load["second_verdict"]], ["passes", "passes"]);
    assert_eq!(row("numbers", "number", "screw_mass_kg")["better"], "first");
    assert_eq!(row("rules", "rule", "static safety")["better"], Value::Null);
    let differ: Vec<_> =
        both["inputs"].as_array().expect("rows").iter().map(|row| row["input"].clone()).collect();
    assert_eq!(differ, ["screw_mass_kg_m", "rated_dynamic_load_N"]);
    let shown = stdout(&bsm(dir.path(), &["axis", "a.json", "b.json"], ""));
    assert!(
        shown.contains("b.json: all rules pass; order: ") && shown.contains("better"),
        "{shown}"
    );
    let page = ["axis", "a.json", "b.json", "--units", "inch", "-o", "offers.html"];
    bsm(dir.path(), &page, "");
    let page = fs::read_to_string(dir.path().join("offers.html")).expect("a page");
    for words in [
        "<th class=\"number\">a.json</th><th class=\"number\">a.json: limit</th>",
        "<th class=\"number\">b.json: limit</th><th>b.json: verdict</th>",
        "lb",
        " better\"",
        "Inputs that differ",
    ] {
        assert!(page.contains(words), "{words}: {page}");
    }
}
