//! Tests of `bsm select`, `bsm fit` and the search for the optimum contact angle on the command
//! line.

use std::fs;

use serde_json::Value;

use crate::program::{bsm, example, folder, json, stderr, stdout};

/// Follows the steps of the guide from a requirement to a case and then to a solved motion.
#[test]
fn a_selected_screw_can_be_solved() {
    let dir = folder();
    let requirement = example("requirements/feed_drive.json");
    let output = bsm(dir.path(), &["select", &requirement, "--free", "-o", "screw.json"], "");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let text = stdout(&output);
    for part in ["active limit: ", "pass", ">= 10000", "next:  bsm axis screw.json"] {
        assert!(text.contains(part), "{text}");
    }
    assert!(!text.contains("FAIL"), "{text}");
    for show in ["motion", "ratings", "slip", "motion,slip,ratings"] {
        let output = bsm(dir.path(), &["solve", "screw.json", "--show", show], "");
        assert_eq!(output.status.code(), Some(0), "{show}: {}", stderr(&output));
    }
    let output = bsm(dir.path(), &["select", "--show", "keys"], "");
    assert_eq!(output.status.code(), Some(0));
    assert!(stdout(&output).contains("pressure_limit_MPa"));
}

/// If no screw meets the requirement, the command must name the violated limit and state by how
/// much it is missed. The command must write no case and exit with code 3. Invalid input must cause
/// exit code 2.
#[test]
fn error_for_an_unattainable_requirement_names_the_violated_limit() {
    let dir = folder();
    let requirement = example("requirements/feed_drive.json");
    let set = |setting: &str| {
        let args = ["select", &requirement, "--free", "--set", setting, "-o", "none.json"];
        let output = bsm(dir.path(), &args, "");
        (output.status.code(), stdout(&output), stderr(&output))
    };
    let (code, text, _) = set("required_life_h=1e6");
    assert_eq!(code, Some(3), "{text}");
    assert!(
        text.contains("FAIL")
            && text.contains("if all other limits are met, the best possible value is"),
        "{text}"
    );
    assert!(!dir.path().join("none.json").exists());
    let (code, text, _) = set("axial_load_N=1e30");
    assert_eq!(code, Some(3), "{text}");
    assert!(
        text.contains("largest pressure at the nut, with equal load sharing must be"),
        "{text}"
    );
    for (setting, words) in [
        ("screw_torque_Nm=12", "give either axial_load_N or screw_torque_Nm"),
        ("lead_mm=-2", "`lead_mm` = -2 must be a finite number > 0"),
        ("loaded=3", "unknown key `loaded`"),
    ] {
        let (code, _, text) = set(setting);
        assert_eq!(code, Some(2), "{text}");
        assert!(text.contains("feed_drive.json: ") && text.contains(words), "{text}");
    }
    let output = bsm(dir.path(), &["select", "nowhere.json"], "");
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
}

#[test]
fn catalog_nuts_are_filtered_sorted_and_written() {
    let dir = folder();
    let wanted = ["--where", "dynamic_load_rating_N>=50000", "--where", "lead_mm=10"];
    let lightest = ["--sort", "nut_mass_kg", "--first", "5"];
    let args =
        [&["select", "--from", "standard"], &wanted[..], &lightest[..], &["--json"]].concat();
    let output = bsm(dir.path(), &args, "");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stderr(&output).contains("The list contains"), "{}", stderr(&output));
    let rows = json(&stdout(&output));
    let rows = rows.as_array().expect("rows");
    let number = |row: &Value, name: &str| row[name].as_f64().unwrap_or_else(|| panic!("{name}"));
    assert_eq!(rows.len(), 5);
    assert!(rows.windows(2).all(|w| number(&w[0], "nut_mass_kg") <= number(&w[1], "nut_mass_kg")));
    assert!(rows.iter().all(|row| number(row, "dynamic_load_rating_N") >= 5e4));

    // All table formats must contain the same rows. The JSON file contains the first nut as a case.
    let mut tables = Vec::new();
    for table in ["a.csv", "a.jsonl", "a.parquet"] {
        let args = [&["select", "--from", "standard"], &wanted[..], &lightest[..], &["-o", table]]
            .concat();
        assert_eq!(bsm(dir.path(), &args, "").status.code(), Some(0), "{table}");
        tables.push(fs::read(dir.path().join(table)).expect("written"));
    }
    let lines = String::from_utf8(tables[1].clone()).expect("UTF-8");
    let from_lines: Vec<_> = lines.lines().map(json).collect();
    assert_eq!(&from_lines, rows);
    let csv = String::from_utf8(tables[0].clone()).expect("UTF-8");
    assert_eq!(csv.lines().count(), 6);
    assert!(tables[2].starts_with(b"PAR1"));
    let args =
        [&["select", "--from", "standard"], &wanted[..], &["--pareto", "-o", "nut.json"]].concat();
    let output = bsm(dir.path(), &args, "");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stderr(&output).contains("are Pareto-optimal"), "{}", stderr(&output));
    let output = bsm(dir.path(), &["solve", "nut.json", "--show", "steps"], "");
    assert!(stdout(&output).contains("C_s/C_n"), "{}", stderr(&output));
    // Regression test: for a nut from the list, `solve --show ratings` stated a smaller mass than
    // the list, because it used a different screw diameter.
    let picked = bsm(dir.path(), &["solve", "nut.json", "--show", "ratings", "--json"], "");
    let picked = json(&stdout(&picked));
    let args =
        [&["select", "--from", "standard"], &wanted[..], &["--pareto", "--first", "1", "--json"]]
            .concat();
    let first = json(&stdout(&bsm(dir.path(), &args, "")));
    for name in ["nut_mass_kg", "edge_load_N", "preloaded_stiffness_N_um", "screw_root_diameter_mm"]
    {
        let ratio = number(&picked, name) / number(&first[0], name);
        assert!((ratio - 1.0).abs() < 1e-12, "{name}: {ratio}");
    }
}

#[test]
fn invalid_options_for_the_nut_list_are_reported() {
    let dir = folder();
    let heavy = ["--where", "dynamic_load_rating_N>=5e6"];
    let output = bsm(dir.path(), &[&["select"], &heavy[..]].concat(), "");
    assert_eq!(output.status.code(), Some(3));
    assert!(
        stdout(&output).contains("the value closest to this condition is"),
        "{}",
        stdout(&output)
    );
    // Columns that `--sort` and `--where` use must be shown on the screen.
    let named = ["--sort", "clearance_per_turn_mm", "--where", "nut_length_mm<=50", "--first", "3"];
    let output = stdout(&bsm(dir.path(), &[&["select"], &named[..]].concat(), ""));
    for name in ["clearance_per_turn_mm", "nut_length_mm"] {
        assert!(output.contains(name), "{output}");
    }
    assert!(!output.contains("nut_bore_mm"), "{output}");
    // Regression test: if no nut in the list met the requirement, the program printed nothing on
    // standard output and named no limit.
    let requirement = example("requirements/feed_drive.json");
    let long = ["--set", "required_life_h=100000"];
    let args =
        [&["select", &requirement, "--from", "standard", "--first", "1"], &long[..]].concat();
    let output = bsm(dir.path(), &args, "");
    assert_eq!(output.status.code(), Some(3));
    let limit =
        "no nut was selected: life under the cycle according to ISO 3408-5 must be >= 100000 h";
    assert!(stdout(&output).contains(limit), "{}", stdout(&output));
    for (args, words) in [
        (["select", "--where", "mass>=1"], "did you mean `nut_mass_kg`?"),
        (["select", "--sort", "weight_kg"], "no column is named `weight_kg`"),
        (["select", "--where", "passes=true"], "conditions and sorting need a column of numbers"),
        (["select", "--where", "lead_mm=ten"], "`ten` is not a number"),
        (
            ["select", "--columns", "nut,lead_mm"],
            "`nut` is a column only of a manufacturer's table",
        ),
        (["select", "-o", "table.txt"], "must end with .csv, .jsonl, .parquet, .xlsx or .json"),
    ] {
        let output = bsm(dir.path(), &args, "");
        assert_eq!(output.status.code(), Some(2), "{args:?}");
        assert!(stderr(&output).contains(words), "{}", stderr(&output));
    }
    fs::write(dir.path().join("lists.json"), "{\"lead_mm\": [10], \"turns\": [3]}")
        .expect("written");
    let output = bsm(dir.path(), &["select", "--from", "lists.json"], "");
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("lists.json: unknown key `turns`"), "{}", stderr(&output));
    // The printed lists must be valid input for `--from`.
    let lists = stdout(&bsm(dir.path(), &["select", "--show", "lists"], ""));
    fs::write(dir.path().join("lists.json"), lists).expect("written");
    let output = bsm(
        dir.path(),
        &["select", "--from", "lists.json", "--first", "1", "--figures", "figures"],
        "",
    );
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let figures = fs::read_dir(dir.path().join("figures")).expect("figures").count();
    assert_eq!(figures, 26);
}

/// Regression test: figures were drawn for a fixed nut instead of the listed nuts. With the lists
/// of Fig 3 of Sobolewski (2002), eight tables therefore contained only a header.
#[test]
fn figures_show_the_listed_sizes_of_nuts() {
    let dir = folder();
    let lists = |leads: &str| {
        format!(
            r#"{{"nominal_diameter_mm": [20], "lead_mm": {leads}, "ball_diameter_mm": [3.175],
            "loaded_turns": [3], "nut_conformity": [0.52, 0.53, 0.54, 0.55]}}"#
        )
    };
    fs::write(dir.path().join("lists.json"), lists("[8, 10, 20]")).expect("written");
    let args = ["select", "--from", "lists.json", "--figures", "figures"];
    let output = bsm(dir.path(), &args, "");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let table = |name: &str| fs::read_to_string(dir.path().join("figures").join(name));
    let figure = table("catalog-3.csv").expect("Fig 3");
    // The table has a header and one line for each of four conformities at three leads.
    assert_eq!(figure.lines().count(), 13, "{figure}");
    for entry in fs::read_dir(dir.path().join("figures")).expect("figures") {
        let path = entry.expect("an entry").path();
        let text = fs::read_to_string(&path).expect("UTF-8");
        let table = path.extension().is_some_and(|extension| extension == "csv");
        assert!(!table || text.lines().count() > 1, "{}", path.display());
    }
    // The lists contain only one diameter. Therefore, no figure has the diameter as its axis, and
    // Fig 7 is drawn only once instead of separately for 50 and 63 mm.
    assert!(table("catalog-4.csv").is_err() && table("catalog-7b.csv").is_err());
    assert!(table("catalog-7a.csv").is_ok(), "{}", stderr(&output));
    fs::write(dir.path().join("lists.json"), lists("[10]")).expect("written");
    let output = bsm(dir.path(), &args, "");
    assert!(stderr(&output).contains("two nuts that differ"), "{}", stderr(&output));
    // Only figures with the requested nuts must be drawn.
    let args = [
        "select",
        "--from",
        "standard",
        "--where",
        "lead_mm=20",
        "--first",
        "1",
        "--figures",
        "leads",
    ];
    assert_eq!(bsm(dir.path(), &args, "").status.code(), Some(0));
    assert!(!dir.path().join("leads/catalog-7a.csv").exists());
    assert!(dir.path().join("leads/catalog-4.csv").exists());
}

#[test]
fn solve_with_the_fitted_friction_coefficient_reproduces_the_measured_torque() {
    let dir = folder();
    let feed_drive = example("feed_drive.json");
    let args = ["fit", &feed_drive, "--measured", "screw_torque_Nm=26", "--json"];
    let output = bsm(dir.path(), &args, "");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let answer = json(&stdout(&output));
    let friction = answer["found"][0]["friction_coefficient"].as_f64().expect("found");
    let setting = format!("friction_coefficient={friction}");
    let args = ["solve", &feed_drive, "--model", "traction", "--set", &setting, "--json"];
    let solved = json(&stdout(&bsm(dir.path(), &args, "")));
    let torque = solved["ball_torque_Nm"].as_f64().expect("converged");
    // The search stops when the error of the friction coefficient is below 5e-11.
    assert!((torque - 26.0).abs() < 1e-7, "{torque}");
    let args = ["fit", &feed_drive, "--measured", "screw_torque_Nm=1"];
    let output = bsm(dir.path(), &args, "");
    assert_eq!(output.status.code(), Some(3));
    assert!(stdout(&output).contains("not 1"), "{}", stdout(&output));
    let args = [
        "fit",
        &feed_drive,
        "--measured",
        "screw_torque_Nm=1",
        "--input",
        "friction_coefficient=wide",
    ];
    assert_eq!(bsm(dir.path(), &args, "").status.code(), Some(2));
}

/// Fits two inputs to a table of measured points. The result must be printed, written as JSON and
/// plotted.
#[test]
fn inputs_can_be_fitted_to_a_table_of_measurements() {
    let dir = folder();
    let oil = example("feed_drive_oil.json");
    let points = "screw_speed_rpm,axial_load_N,screw_torque_Nm\n10,8000,26.60\n200,8000,26.44\n1500,8000,26.35\n3000,4000,13.45\n";
    fs::write(dir.path().join("measured.csv"), points).expect("a file");
    let fixed = ["fit", &oil, "--model", "raceway-control", "--measured", "screw_torque_Nm"];
    let sought = ["--points", "measured.csv", "--input", "boundary_friction_coefficient"];
    let more = ["--input", "seal_torque_Nm=0:1", "-o", "fit.svg"];
    let args = [&fixed[..], &sought, &more].concat();
    let output = bsm(dir.path(), &args, "");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let text = stdout(&output);
    for part in ["seal_torque_Nm", "standard deviation", "condition", "difference"] {
        assert!(text.contains(part), "{text}");
    }
    let svg = fs::read_to_string(dir.path().join("fit.svg")).expect("a plot");
    assert!(svg.contains("measured screw_torque_Nm"));
    let answer = bsm(dir.path(), &[&args[..], &["--json"]].concat(), "");
    let answer = json(&stdout(&answer));
    let seal = answer["found"]["seal_torque_Nm"]["value"].as_f64().expect("a number");
    assert!((0.0..=1.0).contains(&seal), "{answer}");
    assert_eq!(answer["points"].as_array().map(Vec::len), Some(4));
    // The same points are read from a table with semicolons as separators and with decimal commas.
    let commas = points.replace(',', ";").replace('.', ",");
    fs::write(dir.path().join("measured.csv"), commas).expect("a file");
    let dialect = ["--delimiter", "semicolon", "--decimal", "comma", "--json"];
    let same = bsm(dir.path(), &[&args[..], &dialect].concat(), "");
    assert_eq!(json(&stdout(&same)), answer);
    // A single point can determine only one input.
    let two = ["fit", &oil, "--measured", "screw_torque_Nm=26", "--input", "a", "--input", "b"];
    assert_eq!(bsm(dir.path(), &two, "").status.code(), Some(2));
}

/// The 90 % interval of the torque of a lubricated screw is printed by default. With `--show` or
/// `--json`, it is included only on request.
#[test]
fn json_contains_the_friction_interval_only_on_request() {
    let dir = folder();
    let oil = example("feed_drive_oil.json");
    let said = |more: &[&str]| {
        let args = [&["solve", &oil, "--model", "raceway-control"][..], more].concat();
        stdout(&bsm(dir.path(), &args, ""))
    };
    let table = said(&[]);
    assert!(table.contains("90 % interval") && table.contains("not included"), "{table}");
    assert!(!said(&["--show", "motion"]).contains("90 % interval"));
    assert!(json(&said(&["--json"]))["band"].is_null());
    let band = json(&said(&["--json", "--show", "band"]));
    assert!(band["band"]["ball_torque_Nm"]["high"].as_f64().expect("a number") > 26.0, "{band}");
}

/// With the closed-form model, the search must find the optimum given by the formula.
#[test]
fn the_optimum_search_matches_the_closed_form() {
    let dir = folder();
    let lin = example("lin1994.json");
    let args = ["solve", &lin, "--show", "optimum", "--model", "closed-form", "--json"];
    let answer = json(&stdout(&bsm(dir.path(), &args, "")));
    let number = |value: &Value, name: &str| value[name].as_f64().expect("an optimum");
    let found = number(&answer["by_model"], "optimum_contact_angle_deg");
    let exact = number(&answer, "rotary_to_linear_optimum_contact_angle_deg");
    // Near a flat maximum, the position is accurate to only half as many digits as the efficiency.
    assert!((found - exact).abs() < 1e-5, "{found} {exact}");
    let output = bsm(dir.path(), &["solve", &lin, "--show", "optimum", "--model", "traction"], "");
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("nut_conformity"), "{}", stderr(&output));
}

/// Regression test: a case with a lead angle but no contact angle, or vice versa, was rejected.
/// Each of these angles determines the optimum of the other one. Each figure of Lin, Velinsky and
/// Ravani (1994) must be drawn only if the case contains the inputs of the figure.
#[test]
fn optimum_is_found_if_only_lead_angle_or_only_contact_angle_is_known() {
    let dir = folder();
    let of = |setting: &str| {
        let args = [
            "solve",
            "--show",
            "optimum",
            "--set",
            setting,
            "--set",
            "friction_coefficient=0.075",
            "--json",
        ];
        let output = bsm(dir.path(), &args, "");
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        json(&stdout(&output))
    };
    let contact = of("contact_angle_deg=75");
    let lead = contact["linear_to_rotary_optimum_lead_angle_deg"].as_f64().expect("a lead angle");
    assert!(contact["linear_to_rotary_optimum_contact_angle_deg"].is_null(), "{contact}");
    let back = of(&format!("lead_angle_deg={lead}"));
    let angle = back["linear_to_rotary_optimum_contact_angle_deg"].as_f64().expect("an optimum");
    assert!((angle - 75.0).abs() < 1e-9, "{angle}");
    let output =
        bsm(dir.path(), &["solve", "--show", "optimum", "--set", "friction_coefficient=0.075"], "");
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("or contact_angle_deg"), "{}", stderr(&output));

    let figures = |args: &[&str]| {
        let args = [args, &["--figures", "figures"][..]].concat();
        let output = bsm(dir.path(), &args, "");
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let names = fs::read_dir(dir.path().join("figures")).expect("figures");
        names
            .filter(|name| {
                name.as_ref().is_ok_and(|n| n.path().extension() == Some("svg".as_ref()))
            })
            .count()
    };
    let angles = ["--set", "lead_angle_deg=10", "--set", "friction_coefficient=0.075"];
    assert_eq!(figures(&[&["solve", "--show", "optimum"][..], &angles].concat()), 2);
    assert_eq!(figures(&["solve", &example("lin1994.json"), "--show", "optimum"]), 7);
}

/// By default, the program must use manufacturers' sizes. The sizes in a user's table (here the
/// built-in table with decimal commas) must be used unchanged. Continuous sizes must be used only
/// on request.
#[test]
fn sizes_can_be_taken_from_manufacturer_catalogs_or_from_a_table() {
    let dir = folder();
    let requirement = example("requirements/axis.json");
    let case = |more: &[&str]| {
        let args = [&["select", &requirement, "--json"], more].concat();
        let output = bsm(dir.path(), &args, "");
        assert_eq!(output.status.code(), Some(0), "{more:?}: {}", stderr(&output));
        json(&stdout(&output))["case"].clone()
    };
    let own = case(&[]);
    assert_eq!(case(&["--from", "manufacturers"]), own);
    let sizes = stdout(&bsm(dir.path(), &["select", "--show", "sizes"], ""));
    fs::write(dir.path().join("sizes.csv"), &sizes).expect("written");
    assert_eq!(case(&["--from", "sizes.csv"]), own);
    let head = "d0;P;ball;turns\n";
    fs::write(dir.path().join("mine.csv"), format!("{head}50;20;10;5,5/6\n")).expect("written");
    fs::write(
        dir.path().join("names.json"),
        r#"{"d0": "nominal_diameter_mm", "P": "lead_mm", "ball": "ball_diameter_mm"}"#,
    )
    .expect("written");
    let dialect = ["--delimiter", "semicolon", "--decimal", "comma", "--names", "names.json"];
    let mine = case(&[&["--from", "mine.csv"], &dialect[..]].concat());
    for (name, value) in [("lead_mm", 20.0), ("ball_diameter_mm", 10.0)] {
        assert_eq!(mine[name].as_f64(), Some(value), "{mine}");
    }
    assert!([5.5, 6.0].map(Some).contains(&mine["loaded_turns"].as_f64()), "{mine}");
    let standard = case(&["--from", "standard"]);
    assert_ne!(standard, own);
    fs::write(dir.path().join("mine.csv"), format!("{head}50;20;;3\n")).expect("written");
    let args = [&["select", "--from", "mine.csv"], &dialect[..]].concat();
    let output = bsm(dir.path(), &args, "");
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("ball_diameter_mm is missing"), "{}", stderr(&output));
}
