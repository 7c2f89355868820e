//! Command-line tests of user tables, of the description of a table's origin, of workbooks, and of
//! map plots.

use std::fs::{self, File};
use std::io::Read;
use std::path::Path;
use std::sync::Arc;

use arrow_array::{ArrayRef, Float64Array, Int64Array, RecordBatch};
use parquet::arrow::ArrowWriter;
use parquet::file::reader::{FileReader, SerializedFileReader};
use zip::ZipArchive;

use crate::program::{bsm, example, folder, json, stderr, stdout};

fn run(folder: &Path, args: &[&str], code: i32) -> (String, String) {
    let output = bsm(folder, args, "");
    assert_eq!(output.status.code(), Some(code), "{args:?}: {}", stderr(&output));
    (stdout(&output), stderr(&output))
}

/// Regression test: there were no options for semicolons, decimal commas and user-defined column
/// names, and `1.500` was read as 1.5 without a message.
#[test]
fn user_table_with_other_separators_and_names_is_read() {
    let dir = folder();
    let at = |name: &str| dir.path().join(name);
    fs::write(at("own.csv"), "Kraft;Hub;note;Drehzahl\n2,5;20;\"a;b\";1500\n8,0;10;c;3000\n")
        .expect("table");
    let map =
        r#"{"Kraft": "axial_load_kN", "Hub": "lead_mm", "note": null, "Drehzahl": "speed_1_min"}"#;
    fs::write(at("names.json"), map).expect("names");
    fs::write(at("ours.csv"), "axial_load_N,lead_mm,screw_speed_rpm\n2500,20,1500\n8000,10,3000\n")
        .expect("table");
    let base = example("feed_drive.json");
    let common = [&base, "--columns", "efficiency"];
    let dialect = ["--delimiter", "semicolon", "--decimal", "comma", "--names", "names.json"];
    run(
        dir.path(),
        &[&["sweep", "--points", "own.csv", "-o", "a.csv"], &common[..], &dialect].concat(),
        0,
    );
    run(dir.path(), &[&["sweep", "--points", "ours.csv", "-o", "b.csv"], &common[..]].concat(), 0);
    let read = |name: &str| fs::read_to_string(at(name)).expect("a table");
    assert_eq!(read("a.csv"), read("b.csv"));
    // A copied column must keep its own name. The format options must also work for datasets.
    let keep = ["sweep", "--points", "own.csv", "-o", "map/", "--keep", "note"];
    run(dir.path(), &[&keep[..], &common, &dialect].concat(), 0);
    assert!(read("map/plan.json").contains("\"delimiter\":\";\""));
    run(dir.path(), &[&keep[..], &["--resume"], &common, &dialect].concat(), 0);

    // Column names can also be mapped in JSON Lines tables.
    fs::write(at("own.jsonl"), "{\"Kraft\": 2.5, \"note\": [1]}\n{\"Kraft\": 8, \"note\": {}}\n")
        .expect("table");
    let names = "{\"Kraft\": \"axial_load_kN\", \"note\": null}";
    fs::write(at("two.json"), names).expect("names");
    let renamed = ["sweep", "--points", "own.jsonl", "-o", "c.csv", "--names", "two.json"];
    run(dir.path(), &[&renamed[..], &common].concat(), 0);
    assert!(read("c.csv").contains("2500,"), "{}", read("c.csv"));

    for (table, dialect, part) in [
        (
            "Kraft\n1\n",
            &["--names", "names.json"][..],
            "the table has no column `Drehzahl` to rename",
        ),
        (
            "Kraft\n1\n",
            &[],
            "copy it to the output with --keep Kraft, or map names with --names MAP.json",
        ),
        // Regression test: each run reported only one unknown name.
        (
            "Kraft,lead,id\n1,2,3\n",
            &[],
            "columns `Kraft`, `lead` (did you mean `lead_mm`?), `id` are not inputs; remove them, copy them to the \
             output with --keep Kraft,lead,id",
        ),
        (
            "axial_load_N;lead_mm\n1;2\n",
            &[],
            "separated by `;`, but the expected separator is `,`; add --delimiter semicolon",
        ),
        (
            "axial_load_N,lead_mm\n1,2\n",
            &["--delimiter", "tab"],
            "separated by `,`, but the expected separator is `\\t`",
        ),
    ] {
        fs::write(at("bad.csv"), table).expect("table");
        let args =
            [&["sweep", "--points", "bad.csv", "-o", "x.csv"], &common[..], dialect].concat();
        let (_, told) = run(dir.path(), &args, 2);
        assert!(told.contains(part), "{told}");
    }
    // If decimal commas are expected, a value with a decimal point is not a number, and its row
    // reports this error.
    fs::write(at("mixed.csv"), "axial_load_N\n1.500\n").expect("table");
    let mixed = ["sweep", "--points", "mixed.csv", "-o", "x.csv", "--decimal", "comma"];
    run(dir.path(), &[&mixed[..], &common].concat(), 3);
    assert!(read("x.csv").contains("invalid_input"), "{}", read("x.csv"));
}

/// Regression test: tables contained no information about their origin. Every table must contain a
/// case that reproduces the table.
#[test]
fn tables_contain_a_description_of_their_origin() {
    let dir = folder();
    let at = |name: &str| dir.path().join(name);
    let drive = example("feed_drive.json");
    let sweep = |output: &str, more: &[&str]| {
        let args =
            ["sweep", &drive, "--set", "lead_mm=10", "--vary", "axial_load_kN=1:9:3", "--columns"];
        let args =
            [&args[..], &["efficiency,ball_torque_Nm", "--tolerance", "1e-3", "-o", output], more];
        run(dir.path(), &args.concat(), 0);
    };
    sweep("map.parquet", &[]);
    sweep("map.csv", &["-o", "map.json"]);
    let parquet =
        SerializedFileReader::new(File::open(at("map.parquet")).expect("file")).expect("Parquet");
    let keys = parquet.metadata().file_metadata().key_value_metadata().expect("keys");
    let about = keys.iter().find(|key| key.key == "bsm").and_then(|key| key.value.as_deref());
    let about = json(about.expect("what it is made from"));
    let beside = json(&fs::read_to_string(at("map.json")).expect("beside the table"));
    let (version, _) = run(dir.path(), &["--version"], 0);
    if let Some((_, commit)) = version.trim().trim_end_matches(')').split_once(" (") {
        assert_eq!(beside["program"]["commit"], commit, "{version}");
    }
    for about in [&about, &beside] {
        assert_eq!(about["program"]["name"], "bsm", "{about}");
        assert_eq!(
            about["points"]["grid"],
            serde_json::json!(["axial_load_N=1000:9000:3"]),
            "{about}"
        );
        assert_eq!(
            (&about["case"]["lead_mm"], &about["settings"]["tolerance"]),
            (&serde_json::json!(10.0), &serde_json::json!(1e-3))
        );
        assert_eq!(about["columns"]["ball_torque_Nm"]["unit"], "N m");
    }
    // The SHA-256 hash is verified with an independent program.
    let hash =
        std::process::Command::new("sha256sum").arg(at("map.csv")).output().expect("sha256sum");
    let hash = String::from_utf8(hash.stdout).expect("text");
    assert_eq!(beside["table"]["sha256"], hash.split_whitespace().next().expect("a hash"));
    // The stored case must reproduce the table.
    fs::write(at("again.json"), about["case"].to_string()).expect("case");
    let vary = about["points"]["grid"][0].as_str().expect("an axis").to_owned();
    let again = ["sweep", "again.json", "--vary", &vary, "--columns", "efficiency,ball_torque_Nm"];
    run(dir.path(), &[&again[..], &["--tolerance", "1e-3", "-o", "again.csv"]].concat(), 0);
    assert_eq!(fs::read(at("again.csv")).expect("table"), fs::read(at("map.csv")).expect("table"));
    // If the points come from a table, the hash of this table must be stored.
    fs::copy(at("map.csv"), at("points.csv")).expect("copy");
    let batch = [
        "sweep",
        &drive,
        "--points",
        "points.csv",
        "--columns",
        "efficiency",
        "-o",
        "b.csv",
        "-o",
        "b.json",
    ];
    run(dir.path(), &batch, 0);
    let about = json(&fs::read_to_string(at("b.json")).expect("beside the table"));
    assert_eq!(about["points"]["table"]["sha256"], beside["table"]["sha256"]);
}

/// Reads one file from a workbook, which is a ZIP archive of XML files.
fn sheet(path: &Path, name: &str) -> String {
    let mut book = ZipArchive::new(File::open(path).expect("file")).expect("a workbook");
    let mut text = String::new();
    book.by_name(name).expect("a sheet").read_to_string(&mut text).expect("XML");
    text
}

/// Returns the cells of a worksheet as pairs of reference and value.
fn cells(xml: &str) -> Vec<(String, String)> {
    let document = roxmltree::Document::parse(xml).expect("XML");
    let cells = document.descendants().filter(|node| node.has_tag_name("c"));
    let text = |node: roxmltree::Node<'_, '_>| {
        node.descendants()
            .filter(roxmltree::Node::is_text)
            .filter_map(|n| n.text())
            .collect::<Vec<_>>()
            .concat()
    };
    cells.map(|cell| (cell.attribute("r").expect("a place").to_owned(), text(cell))).collect()
}

/// Spreadsheets store numbers as doubles, which represent every integer exactly only up to
/// 9007199254740992. Larger integers must be written as text.
#[test]
fn workbooks_keep_all_digits_of_64_bit_integers() {
    let dir = folder();
    let (drive, seed) = (example("feed_drive.json"), "18446744073709551615");
    let draw =
        ["sweep", &drive, "--draw", "lead_mm=uniform:5:20", "--samples", "2", "--seed", seed];
    let to = ["--columns", "efficiency", "-o", "out.xlsx"];
    run(dir.path(), &[&draw[..], &to].concat(), 0);
    let texts = sheet(&dir.path().join("out.xlsx"), "xl/sharedStrings.xml");
    assert!(texts.contains(seed), "{texts}");
    // A Parquet table stores the id as an integer, so the id is not parsed from text.
    let (path, id) = (dir.path().join("ids.parquet"), 9_007_199_254_740_993);
    let ids: ArrayRef = Arc::new(Int64Array::from(vec![id, 5]));
    let loads: ArrayRef = Arc::new(Float64Array::from(vec![1000.0, 2000.0]));
    let points = RecordBatch::try_from_iter([("id", ids), ("axial_load_N", loads)]).expect("rows");
    let file = File::create(&path).expect("a file");
    let mut writer = ArrowWriter::try_new(file, points.schema(), None).expect("a schema");
    writer.write(&points).expect("rows");
    writer.close().expect("a footer");
    for output in ["ids.xlsx", "ids.csv", "ids.jsonl"] {
        let points = ["sweep", &drive, "--points", "ids.parquet", "--keep", "id"];
        run(dir.path(), &[&points[..], &["--columns", "efficiency", "-o", output]].concat(), 0);
    }
    let found = sheet(&dir.path().join("ids.xlsx"), "xl/worksheets/sheet1.xml");
    let texts = sheet(&dir.path().join("ids.xlsx"), "xl/sharedStrings.xml");
    assert!((found + &texts).contains(&format!("<t>{id}</t>")), "{texts}");
    for output in ["ids.csv", "ids.jsonl"] {
        let rows = fs::read_to_string(dir.path().join(output)).expect("rows");
        assert!(rows.contains(&id.to_string()), "{rows}");
    }
}

/// A workbook must contain the column names, the units, the numbers of the CSV table, and a
/// description of how the numbers were calculated.
#[test]
fn workbooks_contain_units_and_the_numbers_of_the_csv_table() {
    let dir = folder();
    let at = |name: &str| dir.path().join(name);
    let drive = example("feed_drive.json");
    for output in ["out.xlsx", "out.csv"] {
        let sweep = [
            "sweep",
            &drive,
            "--vary",
            "lead_mm=5:20:4",
            "--columns",
            "ball_torque_Nm",
            "-o",
            output,
        ];
        run(dir.path(), &sweep, 0);
    }
    let found = cells(&sheet(&at("out.xlsx"), "xl/worksheets/sheet1.xml"));
    let cell =
        |place: &str| found.iter().find(|(at, _)| at == place).map(|(_, text)| text.as_str());
    assert_eq!(
        (cell("A1"), cell("A2"), cell("E1"), cell("E2")),
        (Some("lead_mm"), Some("mm"), Some("ball_torque_Nm"), Some("N m"))
    );
    let mut csv = csv::Reader::from_path(at("out.csv")).expect("a table");
    let rows: Vec<_> = csv.records().map(|row| row.expect("a row")).collect();
    assert_eq!(rows.len(), 4);
    for (row, record) in (3..).zip(&rows) {
        for (column, place) in [(0, "A"), (4, "E")] {
            let found: f64 =
                cell(&format!("{place}{row}")).expect("a cell").parse().expect("a number");
            let other: f64 = record[column].parse().expect("a number");
            // A workbook stores sixteen digits of each number, whereas the CSV table contains
            // seventeen.
            assert!((found - other).abs() <= 1e-15 * other.abs(), "{found} {other}");
        }
    }
    let about = sheet(&at("out.xlsx"), "xl/sharedStrings.xml");
    assert!(
        about.contains("case.ball_diameter_mm") && about.contains("settings.tolerance"),
        "{about}"
    );

    // Ratings, design steps and catalog nuts must also be available as workbooks.
    run(dir.path(), &["solve", &example("nut.json"), "--show", "ratings", "-o", "ratings.xlsx"], 0);
    assert!(
        sheet(&at("ratings.xlsx"), "xl/worksheets/sheet1.xml").contains("dynamic_load_rating_N")
    );
    let requirement = example("requirements/axis.json");
    run(dir.path(), &["select", &requirement, "-o", "steps.csv"], 0);
    assert!(fs::read_to_string(at("steps.csv")).expect("steps").contains("cycle_life_h,h,"));
    fs::write(at("lists.json"), "{\"nominal_diameter_mm\": [40], \"lead_mm\": [10]}")
        .expect("lists");
    run(dir.path(), &["select", "--from", "lists.json", "-o", "nuts.xlsx"], 0);
    assert!(sheet(&at("nuts.xlsx"), "xl/worksheets/sheet1.xml").contains("nut_mass_kg"));

    // A table with more rows than a worksheet can hold must be rejected before any row is solved.
    let many = ["sweep", &drive, "--vary", "lead_mm=5:20:1048575", "-o", "many.xlsx"];
    let (_, told) = run(dir.path(), &many, 1);
    assert!(
        told.contains("a sheet has at most 1048574 rows, but this table has 1048575"),
        "{told}"
    );
    assert!(!at("many.xlsx").exists());
}

/// Regression test: earlier versions could not plot a grid of 30 x 40 points, labeled axes with
/// column names, and did not mark model changes.
#[test]
fn a_map_plot_shows_axis_labels_and_model_names() {
    let dir = folder();
    let at = |name: &str| dir.path().join(name);
    let drive = example("feed_drive.json");
    let sweep = |more: &[&str]| {
        let args = [
            "sweep",
            &drive,
            "--vary",
            "axial_load_N=100:20000:30:log",
            "--vary",
            "screw_speed_rpm=50:3000:40",
        ];
        run(dir.path(), &[&args[..], &["--keep-going", "-o", "x.parquet"], more].concat(), 0)
    };
    sweep(&["--columns", "efficiency", "-o", "x.map.svg"]);
    sweep(&["-o", "x.map.png", "--columns", "ball_torque_Nm"]);
    let svg = fs::read_to_string(at("x.map.svg")).expect("a map");
    let document = roxmltree::Document::parse(&svg).expect("an SVG");
    let texts: Vec<_> = document.descendants().filter_map(|node| node.text()).collect();
    // The title is wrapped over several lines.
    for part in ["axial load, N", "screw speed, rpm", "Machine-tool feed drive: efficiency"] {
        assert!(texts.iter().any(|text| text.contains(part)), "{part}: {texts:?}");
    }
    for model in ["raceway-control /", "traction"] {
        assert!(texts.contains(&model), "no boundary: {texts:?}");
    }
    let mut head = [0; 24];
    File::open(at("x.map.png")).expect("a picture").read_exact(&mut head).expect("a head");
    // The image size in the PNG header must be twice the size of the SVG.
    let size = |at: usize| u32::from_be_bytes(head[at..at + 4].try_into().expect("four"));
    assert!(head.starts_with(b"\x89PNG") && (size(16), size(20)) == (1280, 800), "{head:?}");
    // Curves must be marked at each point where the model changes.
    let line =
        ["sweep", &drive, "--vary", "axial_load_N=100:20000:30:log", "--columns", "efficiency"];
    run(dir.path(), &[&line[..], &["--keep-going", "-o", "x.csv", "-o", "line.svg"]].concat(), 0);
    let svg = fs::read_to_string(at("line.svg")).expect("a plot");
    assert!(svg.contains("model changes: "), "{svg}");
    let one = ["sweep", &drive, "--vary", "lead_mm=5,10", "-o", "x.csv", "-o", "m.map.svg"];
    let (_, told) = run(dir.path(), &one, 2);
    assert!(told.contains("a map needs two varied inputs"), "{told}");
}

/// Regression test: where `auto` changed the model, a curve of torque or heat jumped by 2 to 13 %
/// without a message.
#[test]
fn a_sweep_notes_where_auto_changes_the_model() {
    let dir = folder();
    let drive = example("feed_drive.json");
    let sweep = |model: &str| {
        let vary = "--vary=screw_speed_rpm=6000,7000,8000,9000";
        run(dir.path(), &["sweep", &drive, vary, "--columns=efficiency", "-o-", model], 0)
    };
    let (table, note) = sweep("--model=auto");
    let models: Vec<_> = table.lines().skip(1).filter_map(|row| row.split(',').nth(1)).collect();
    assert_eq!(models, ["raceway-control", "raceway-control", "traction", "traction"], "{table}");
    let change = "between screw_speed_rpm 7000 and 8000 (raceway-control, traction)";
    assert!(note.contains(change), "{note}");
    assert!(!sweep("--model=traction").1.contains("changes the model"));
    // Regression test: if the model changed at the same point in several lines of a grid, the
    // change was listed several times.
    let lines = ["--vary=axial_load_N=8000,8001", "--vary=screw_speed_rpm=6000,7000,8000"];
    let args = [&["sweep", &drive], &lines[..], &["--columns=efficiency", "-o-"]].concat();
    let (_, note) = run(dir.path(), &args, 0);
    assert_eq!(note.matches("7000 and 8000").count(), 1, "{note}");
    assert!(!note.contains("more"), "{note}");
}

/// If inch units are selected, the names, units and numbers of sweep columns and the axes of plots
/// must be converted. It must also be possible to request a single column in another unit.
#[test]
fn sweep_columns_and_plots_use_display_units() {
    let dir = folder();
    let case = example("feed_drive.json");
    let sweep = |columns: &str, more: &[&str]| {
        let args = [
            "sweep",
            &case,
            "--vary",
            "axial_load_N=4448.2216152605,8896.443230521",
            "--columns",
            columns,
            "--model",
            "rigid",
        ];
        run(dir.path(), &[&args[..], more].concat(), 0).0
    };
    let cells = |table: &str| -> Vec<Vec<String>> {
        table.lines().map(|line| line.split(',').map(str::to_owned).collect()).collect()
    };
    let columns = "screw_torque_Nm,efficiency";
    let metric = cells(&sweep(columns, &["-o", "-"]));
    let inch = cells(&sweep(columns, &["--units", "inch", "-o", "-"]));
    assert_eq!(
        metric[0],
        ["axial_load_N", "model", "status", "message", "screw_torque_Nm", "efficiency"]
    );
    assert_eq!(
        inch[0],
        ["axial_load_lbf", "model", "status", "message", "screw_torque_lbf_in", "efficiency"]
    );
    let number = |cell: &str| cell.parse::<f64>().expect("a number");
    for (row, pounds) in [(1, 1000.0), (2, 2000.0)] {
        let (own, shown) = (&metric[row], &inch[row]);
        // The tolerances allow for two rounding errors per value.
        assert!((number(&shown[0]) / pounds - 1.0).abs() < 1e-14, "{shown:?}");
        let ratio = number(&own[4]) / number(&shown[4]);
        assert!((ratio / 0.112_984_829_027_616_7 - 1.0).abs() < 1e-14, "{ratio}");
        assert_eq!(own[5], shown[5]);
    }
    let other = cells(&sweep("screw_torque_kgf_cm", &["-o", "-"]));
    assert_eq!(other[0][4], "screw_torque_kgf_cm");
    assert!((number(&other[1][4]) * 0.098_066_5 / number(&metric[1][4]) - 1.0).abs() < 1e-14);
    sweep(columns, &["--units", "inch", "-o", "lines.svg", "-o", "book.xlsx"]);
    let picture = fs::read_to_string(dir.path().join("lines.svg")).expect("a picture");
    assert!(
        picture.contains("axial load, lbf") && picture.contains("screw torque, lbf in"),
        "{picture}"
    );
    let map = ["--vary", "screw_speed_rpm=500,1000", "--units", "inch", "-o", "a.map.svg"];
    sweep(columns, &map);
    let map = fs::read_to_string(dir.path().join("a.map.svg")).expect("a map");
    assert!(map.contains("axial load, lbf") && map.contains("screw torque, lbf in"), "{map}");
    // Dataset parts and lookup tables always use metric units, because other programs read these
    // files.
    let folder =
        ["sweep", &case, "--vary", "axial_load_N=1000,2000", "--units", "inch", "-o", "parts/"];
    let (_, message) = run(dir.path(), &folder, 2);
    assert!(message.contains("a folder of parts has metric units"), "{message}");
}

/// If the separator of a load cycle or a list of nuts is a semicolon, the error message must
/// suggest the options `--delimiter` and `--decimal`. The option `--names` must also work for the
/// columns of a load cycle.
#[test]
fn error_for_semicolon_separated_file_suggests_the_delimiter() {
    let dir = folder();
    let at = |name: &str| dir.path().join(name);
    fs::write(at("cycle.csv"), "Zeit;Vorschub;Kraft\n2,0;12,0;4000\n2,0;-12,0;0\n")
        .expect("a table");
    fs::write(at("nuts.csv"), "nut;lead_mm;Preis\na;5,0;12,5\n").expect("a table");
    let names = r#"{"Zeit": "time_s", "Vorschub": "feed_m_min", "Kraft": "force_N"}"#;
    fs::write(at("names.json"), names).expect("names");
    let case = example("rated.json");
    let axis = ["axis", &case, "--cycle", "cycle.csv"];
    for args in [&axis[..], &["select", "--from", "nuts.csv"]] {
        let (_, message) = run(dir.path(), args, 2);
        assert!(message.contains("add --delimiter semicolon, and --decimal comma"), "{message}");
    }
    let dialect = ["--delimiter", "semicolon", "--decimal", "comma"];
    let list = ["select", "--from", "nuts.csv"];
    let (screen, _) = run(dir.path(), &[&list[..], &dialect].concat(), 0);
    assert!(screen.contains("have no effect on the calculation: Preis"), "{screen}");
    let misspelled = "nut;lead_mmm\na;5,0\n";
    fs::write(at("nuts.csv"), misspelled).expect("a table");
    let (_, message) = run(dir.path(), &[&list[..], &dialect].concat(), 2);
    assert!(
        message.contains("unknown column `lead_mmm`") && message.contains("--names MAP.json"),
        "{message}"
    );
    let named = [&axis[..], &dialect, &["--names", "names.json", "--json"]].concat();
    let output = bsm(dir.path(), &named, "");
    let sheet = json(&stdout(&output));
    assert_eq!(sheet["phases"][0]["start_feed_m_min"], 12.0, "{}", stderr(&output));
    let same = ["--names", "names.json", "--csv-format", "same", "-o", "rules.csv"];
    bsm(dir.path(), &[&axis[..], &dialect, &same].concat(), "");
    let rules = fs::read_to_string(at("rules.csv")).expect("a table");
    let row = rules.lines().find(|row| row.starts_with("core stress")).expect("a rule");
    let numbers = row.split(';').filter(|cell| cell.starts_with(|c: char| c.is_ascii_digit()));
    let is_written =
        |cell: &str| !cell.contains('.') && cell.replace(',', ".").parse::<f64>().is_ok();
    assert!(numbers.clone().count() >= 3 && numbers.clone().all(is_written), "{row}");
}

/// A plot shows both ends of the interval of its output as dotted lines, with one legend entry.
#[test]
fn plot_shows_the_interval_if_both_ends_are_requested() {
    let dir = folder();
    let oiled = example("feed_drive_oil.json");
    let plot = |columns: &str| {
        let speeds = ["--vary", "screw_speed_rpm=500,1500", "--vary", "axial_load_N=4000,8000"];
        let args = ["sweep", &oiled, "--model", "raceway-control", "--columns", columns];
        let (_, message) = run(dir.path(), &[&args[..], &speeds, &["-o", "band.svg"]].concat(), 0);
        (fs::read_to_string(dir.path().join("band.svg")).expect("a plot"), message)
    };
    let (plain, message) = plot("efficiency,band_efficiency_low");
    assert!(message.contains("shows only efficiency, the first"), "{message}");
    assert!(!plain.contains("90 % interval"), "{plain}");
    let (band, message) = plot("efficiency,band_efficiency_low,band_efficiency_high");
    assert!(!message.contains("shows only"), "{message}");
    assert_eq!(band.matches("90 % interval").count(), 1, "{band}");
    // The dotted lines are both ends of two curves and the sample in the legend.
    let dotted = |svg: &str| svg.matches("stroke-dasharray").count();
    assert_eq!(dotted(&band) - dotted(&plain), 5, "{band}");
}
