//! Tests of text tables. Each line must be read as one row, and the error for an ambiguous input
//! must state its line number.

use std::num::NonZeroUsize;
use std::sync::atomic::AtomicBool;

use arrow_array::ArrayRef;
use arrow_array::cast::AsArray;
use bsm_batch::{
    AnswerSink, Answers, Cell, CsvSource, Format, JsonSource, Source, TableError, TableFormat,
    TableSink, Task, Workers,
};
use bsm_case::{Case, Settings};
use bsm_dyn::{Model, model::RacewayFriction};

/// Copied texts and input cells of each row.
type Rows = Vec<(Vec<String>, Vec<Cell<'static>>)>;

fn rows(source: &mut dyn Source) -> Result<Rows, TableError> {
    let mut rows = Rows::new();
    // The chunks have only two rows, to test that results do not depend on the chunk boundaries.
    while let Some(chunk) = source.next(2)? {
        assert_eq!(chunk.first, rows.len() as u64 + 1);
        for row in 0..chunk.len {
            let text = |texts: &ArrayRef| texts.as_string::<i32>().value(row).to_owned();
            let kept = chunk.kept.iter().map(text).collect();
            let cell = |place| match chunk.cell(row, place) {
                Cell::Number(value) => Cell::Number(value),
                Cell::Text(text) => Cell::Text(text.to_owned().leak()),
                _ => Cell::Missing,
            };
            rows.push((kept, (0..chunk.inputs.len()).map(cell).collect()));
        }
    }
    Ok(rows)
}

fn owned_names(names: &[&str]) -> Vec<String> {
    names.iter().map(|name| (*name).to_owned()).collect()
}

fn csv(table: &[u8], kept: &[&str]) -> Result<Rows, TableError> {
    rows(&mut CsvSource::new(table, &owned_names(kept), &TableFormat::default())?)
}

fn json(table: &[u8], kept: &[&str]) -> Result<Rows, TableError> {
    rows(&mut JsonSource::new(table, &owned_names(kept), &TableFormat::default())?)
}

/// Returns the numbers in a table that has one input column and no copied column.
fn numbers(rows: Result<Rows, TableError>) -> Vec<f64> {
    let number = |cells: &[Cell]| match cells {
        [Cell::Number(value)] => *value,
        [Cell::Missing] => f64::NAN,
        other => panic!("{other:?}"),
    };
    rows.expect("a table").iter().map(|(_, cells)| number(cells)).collect()
}

fn error_text(rows: Result<Rows, TableError>) -> String {
    rows.expect_err("refused").to_string()
}

/// In an earlier version, an unclosed quote joined three rows into a single row, which was solved
/// without an error.
#[test]
fn unclosed_quote_does_not_join_rows() {
    let open = error_text(csv(b"lead_mm,id\n5,\"a\n6,b\n7,c\n", &["id"]));
    assert!(open.starts_with("line 2: a quoted cell does not end on its line"), "{open}");
    // If a second stray quote follows, the lines between the two quotes must not be joined into a
    // single cell.
    let two = error_text(csv(b"lead_mm,id\n4,x\n5,\"a\n6,b\n7,c\"\n", &["id"]));
    assert!(two.starts_with("line 3: a quoted cell does not end"), "{two}");
    // An unclosed quote is also an error in a column that is ignored, and at the end of the file.
    let passed_over = error_text(csv(b"lead_mm,message\n5,\"a\n6,b\n", &[]));
    assert!(passed_over.starts_with("line 2: a quoted cell"), "{passed_over}");
    let last = error_text(csv(b"lead_mm,id\n5,\"", &["id"]));
    assert!(last.starts_with("line 2: a quoted cell"), "{last}");
    let header = error_text(csv(b"lead_mm,\"id\n5,a\n", &["id"]));
    assert!(header.starts_with("line 1: a quoted cell"), "{header}");
}

/// In an earlier version, the cell `"5"6` was read as 56.
#[test]
fn a_quote_inside_a_cell_is_rejected() {
    for (cell, number) in [("\"5\"6", 56), ("5\"6\"", 56), ("\"5\" ", 5), (" \"5\"", 5), ("5\"", 5)]
    {
        let stray = error_text(csv(format!("lead_mm\n{number}\n{cell}\n").as_bytes(), &[]));
        assert!(stray.starts_with("line 3: a cell contains a quote"), "{cell}: {stray}");
    }
    // The id contains an inch mark, which is written correctly as two quotes in the first table,
    // and incorrectly as one quote in the second.
    let inches = csv(b"lead_mm,id\n5,\"3/4\"\" screw, left\"\n", &["id"]).expect("a table");
    assert_eq!(inches, [(vec!["3/4\" screw, left".to_owned()], vec![Cell::Number(5.0)])]);
    let stray = error_text(csv(b"lead_mm,id\n5,3/4\" screw\n", &["id"]));
    assert!(stray.starts_with("line 2: a cell contains a quote"), "{stray}");
}

#[test]
fn correctly_quoted_cells_are_parsed() {
    for (line, kept) in [
        ("5,\"a\"", "a"),
        ("5,\"\"", ""),
        ("5,\"\"\"\"", "\""),
        ("5,\"\"\"a\"\"\"", "\"a\""),
        ("\"5\",\",\"", ","),
        ("5, b ", " b "),
        ("5,", ""),
    ] {
        let read = csv(format!("\"lead_mm\",\"id\"\n{line}\n").as_bytes(), &["id"]);
        assert_eq!(read.expect(line), [(vec![kept.to_owned()], vec![Cell::Number(5.0)])]);
    }
}

/// In an earlier version, a blank line in a table with one column was skipped without an error.
#[test]
fn a_blank_line_between_rows_is_rejected() {
    for table in ["lead_mm\n5\n\n7\n", "lead_mm\r\n5\r\n\r\n7\r\n", "lead_mm\n5\n \t\n7\n"] {
        assert!(error_text(csv(table.as_bytes(), &[])).starts_with("line 3 is blank"), "{table:?}");
    }
    assert!(
        error_text(csv(b"lead_mm,ball_count\n5,1\n\n\n7,1\n", &["ball_count"]))
            .starts_with("line 3")
    );
    assert!(error_text(csv(b"\nlead_mm\n5\n", &[])).starts_with("line 1 is blank"));
    let object = "{\"lead_mm\": 5}\n";
    assert!(
        error_text(json(format!("{object}\n{object}").as_bytes(), &[])).starts_with("line 2 is")
    );
    // In a table with one column, two quotes represent an empty cell.
    let empty = numbers(csv(b"lead_mm\n5\n\"\"\n7\n", &[]));
    assert!(empty.len() == 3 && empty[1].is_nan(), "{empty:?}");
}

/// In an earlier version, rows of empty cells between tabs were lost at the end of a table, and so
/// was a cell that consists of a space.
#[test]
fn line_of_empty_cells_between_tabs_is_read_as_a_row() {
    let table_format = TableFormat { delimiter: '\t', ..TableFormat::default() };
    let tabs = |table: &str, kept: &[&str]| {
        rows(
            &mut CsvSource::new(table.as_bytes(), &owned_names(kept), &table_format)
                .expect("a table"),
        )
    };
    let table = "lead_mm\tscrew_speed_rpm\n10\t\n12\t\n\t\n \t\n";
    let read = tabs(table, &[]).expect("rows");
    let nothing = vec![Cell::Missing, Cell::Missing];
    let lead = |mm| vec![Cell::Number(mm), Cell::Missing];
    let cells: Vec<_> = read.into_iter().map(|(_, cells)| cells).collect();
    assert_eq!(cells, [lead(10.0), lead(12.0), nothing.clone(), nothing]);
    // A row of empty cells is also read at the beginning of a table or of a chunk.
    assert_eq!(tabs("lead_mm\tid\n\t\n5\ta\n", &["id"]).expect("rows").len(), 2);
    // Rows of empty cells are also read if the cells are separated by commas.
    assert_eq!(csv(b"lead_mm,screw_speed_rpm\n10,\n,\n,\n", &[]).expect("rows").len(), 3);
    let space = csv(b"id\na\n \n", &["id"]).expect("rows");
    assert_eq!(space.iter().map(|(kept, _)| &kept[0][..]).collect::<Vec<_>>(), ["a", " "]);
    // A line of spaces contains no delimiter, so it is not a row of a table with two columns.
    assert_eq!(tabs("lead_mm\tid\n5\ta\n   \n", &["id"]).expect("rows").len(), 1);
}

/// In an earlier version, an output with the name of an input column, such as a temperature, had no
/// value in rows in which the input was missing.
#[test]
fn output_with_the_name_of_an_input_column_has_values_where_the_input_is_missing() {
    let mut base =
        Case::from_json(include_bytes!("../../../../examples/feed_drive.json")).expect("a case");
    base.friction_coefficient = None;
    base.apply(&[
        "iso_vg=68",
        "lubricant_temperature_C=40",
        "ball_roughness_um=0.02",
        "nut_roughness_um=0.1",
        "screw_roughness_um=0.1",
    ])
    .expect("inputs");
    let table = "lubricant_temperature_C,pressure_viscosity_1_GPa\n,\n60,\n,18.5\n-500,\n";
    let mut source =
        CsvSource::new(table.as_bytes(), &[], &TableFormat::default()).expect("a table");
    let outputs = ["efficiency", "lubricant_temperature_C", "pressure_viscosity_1_GPa"];
    let outputs = Answers::select(Some(&outputs.map(str::to_owned))).expect("outputs");
    let settings =
        Settings { friction: RacewayFriction::PerContact, ..Model::RacewayControl.into() };
    let task = Task::over_table(base, settings, outputs, source.columns()).expect("inputs");
    let stop = AtomicBool::new(false);
    let workers = Workers::start(NonZeroUsize::new(1), &stop).expect("a thread");
    let out = task.write(&mut source, Format::Csv, Vec::new(), &workers, &mut |_, _| {});
    let out = String::from_utf8(out.expect("solved").0).expect("text");
    let rows: Vec<Vec<_>> = out.lines().skip(1).map(|line| line.split(',').collect()).collect();
    assert_eq!(
        [rows[0][0], rows[1][0], rows[2][0], rows[3][0]],
        ["40", "60", "40", "-500"],
        "{out}"
    );
    assert_eq!((rows[2][1], rows[3][1], rows[3][3]), ("18.5", "", "invalid_input"), "{out}");
    let viscosity = |row: usize| rows[row][1].parse::<f64>().expect("a number");
    assert!(viscosity(0) > 5.0 && viscosity(1) > 5.0, "{out}");
}

/// In an earlier version, the results of a table with decimal commas could not be written with
/// decimal commas.
#[test]
fn results_are_written_in_the_format_of_the_input_table() {
    let table_format = TableFormat { delimiter: ';', decimal: ',', ..TableFormat::default() };
    let table = "id;axial_load_N\n\"a;b\";5000,5\n";
    let mut source =
        CsvSource::new(table.as_bytes(), &owned_names(&["id"]), &table_format).expect("a table");
    let base =
        Case::from_json(include_bytes!("../../../../examples/feed_drive.json")).expect("a case");
    let outputs = Answers::select(Some(&["efficiency".to_owned()])).expect("an output");
    let task = Task::new(base, Model::ClosedForm.into(), outputs);
    let columns = source.columns().clone();
    let chunk = source.next(10).expect("a table").expect("a row");
    let answers = task.solve(&chunk, &columns);
    let efficiency = answers.columns[0][0];
    let written = |table_format: &TableFormat| {
        let sink = TableSink::new(Format::Csv, Vec::new(), &columns, &task.outputs, table_format);
        let mut sink = sink.expect("a head");
        sink.write(chunk.clone(), answers.clone()).expect("a row");
        String::from_utf8(sink.finish(None).expect("written")).expect("text")
    };
    let own = written(&table_format);
    let comma = efficiency.to_string().replace('.', ",");
    assert_eq!(
        own,
        format!(
            "id;axial_load_N;model;status;message;efficiency\n\"a;b\";5000,5;closed-form;converged;;{comma}\n"
        )
    );
    // The written table can be read with the same table format, even if the delimiter and the
    // decimal sign are both commas.
    for table_format in [table_format, TableFormat { decimal: ',', ..TableFormat::default() }] {
        let own = written(&table_format);
        let again = rows(
            &mut CsvSource::new(own.as_bytes(), &owned_names(&["id"]), &table_format)
                .expect("ours"),
        );
        assert_eq!(
            again.expect("rows"),
            [(vec!["a;b".to_owned()], vec![Cell::Number(5000.5)])],
            "{own}"
        );
    }
}

#[test]
fn trailing_blank_lines_and_all_line_ends_are_accepted() {
    for end in ["\n", "\r\n", "\r"] {
        for after in ["", end, &end.repeat(4), " "] {
            let table = format!("\u{feff}lead_mm{end}5{end}7{after}");
            assert_eq!(numbers(csv(table.as_bytes(), &[])), [5.0, 7.0], "{table:?}");
            let table = format!("\u{feff}{{\"lead_mm\":5}}{end}{{\"lead_mm\":7}}{after}");
            assert_eq!(numbers(json(table.as_bytes(), &[])), [5.0, 7.0], "{table:?}");
        }
    }
    for nothing in ["", "\n", "\r\n\r\n", "\u{feff}"] {
        for error in [csv(nothing.as_bytes(), &[]).err(), json(nothing.as_bytes(), &[]).err()] {
            assert!(error.is_some_and(|e| e.to_string().contains("is empty")), "{nothing:?}");
        }
    }
}

/// The test reads lines of all lengths around the size of the read buffer, because a line ending
/// may be at the end of the buffer.
#[test]
fn line_of_any_length_is_read_as_one_row() {
    for length in (1 << 16) - 20..(1 << 16) + 20 {
        let id = "x".repeat(length);
        let table = format!("lead_mm,id\r\n5,{id}\r\n7,b\r\n");
        let read = csv(table.as_bytes(), &["id"]).expect("a table");
        assert_eq!(read.iter().map(|(kept, _)| kept[0].len()).collect::<Vec<_>>(), [length, 1]);
    }
    let long = format!("lead_mm,id\n5,{}\n", "x".repeat(17 << 20));
    assert!(error_text(csv(long.as_bytes(), &["id"])).starts_with("line 2 is longer than 16 MiB"));
}

#[test]
fn nul_bytes_and_non_utf8_encodings_are_rejected() {
    assert!(error_text(csv(b"lead_mm\n5\n7\0\n", &[])).starts_with("line 3 contains a NUL byte"));
    assert!(
        error_text(csv(b"lead_mm,id\n5,a\0b\n", &["id"])).starts_with("line 2 contains a NUL byte")
    );
    assert!(error_text(csv(b"l\0e\0a\0d\0", &[])).starts_with("line 1 contains a NUL byte"));
    assert!(
        error_text(json(b"{\"lead_mm\": 5}\n{\"lead_mm\": 5}\0\n", &[]))
            .starts_with("line 2 contains a NUL byte")
    );
    assert!(
        error_text(csv(b"lead_mm,id\n5,M\xfcller\n", &["id"])).starts_with("line 2 is not UTF-8")
    );
}

#[test]
fn rows_with_a_wrong_number_of_cells_are_rejected() {
    let few = error_text(csv(b"lead_mm,id\n5,a\n6\n", &["id"]));
    assert_eq!(few, "line 3 has 1 cells, but the table has 2 columns");
    // A decimal comma without quotes splits a number into two cells.
    let many = error_text(csv(b"lead_mm,id\n5,5,a\n", &["id"]));
    assert_eq!(many, "line 2 has 3 cells, but the table has 2 columns");
    let semicolons = error_text(csv(b"\"lead_mm\";\"id\"\n\"5,5\";a\n", &["id"]));
    assert!(semicolons.contains("separated by `;`"), "{semicolons}");
}

#[test]
fn ambiguous_json_is_rejected_with_its_line_number() {
    let first = "{\"lead_mm\": 5}\n";
    for (line, part) in [
        ("{\"lead_mm\": 1e400}", "number out of range"),
        ("{\"lead_mm\": 5, \"lead_mm\": 6}", "`lead_mm` is given twice"),
        ("{\"lead_mm\": 5, \"ball_diameter_mm\": 6}", "is not in the first line"),
        ("{\"lead_mm\": 5} {\"lead_mm\": 6}", "is not valid JSON"),
        ("{\"lead_mm\": NaN}", "is not valid JSON"),
        ("[5]", "is JSON a list"),
    ] {
        let told = error_text(json(format!("{first}{line}\n").as_bytes(), &[]));
        assert!(told.starts_with("line 2: ") && told.contains(part), "{line}: {told}");
    }
    // In an earlier version, an input that has the same name as an output was ignored, and the row
    // was solved without this input.
    let oil = json(b"{\"lead_mm\": 5}\n{\"lead_mm\": 5, \"lubricant_temperature_C\": 60}\n", &[]);
    assert!(error_text(oil).contains("`lubricant_temperature_C` is not in the first line"));
    // A text instead of a number is kept, so that the invalid input is reported when the row is
    // solved.
    let text = json(b"{\"lead_mm\": \"5\"}\n", &[]).expect("a table");
    assert_eq!(text, [(vec![], vec![Cell::Text("\"5\"")])]);
}

/// In an earlier version, text outputs were written inside two pairs of quotes, and programs that
/// read the table removed only one pair.
#[test]
fn text_outputs_are_written_without_additional_quotes() {
    let base =
        Case::from_json(include_bytes!("../../../../examples/feed_drive.json")).expect("a case");
    let outputs = ["controlling_raceway", "control_consistent", "iterations"].map(str::to_owned);
    let outputs = Answers::select(Some(&outputs)).expect("outputs");
    let task = Task::new(base, Model::RacewayControl.into(), outputs);
    let mut source = CsvSource::new(
        &b"id,axial_load_N\n\"a, b\",5000\n"[..],
        &owned_names(&["id"]),
        &TableFormat::default(),
    )
    .expect("a table");
    let stop = AtomicBool::new(false);
    let workers = Workers::start(NonZeroUsize::new(1), &stop).expect("a thread");
    let out = task.write(&mut source, Format::Csv, Vec::new(), &workers, &mut |_, _| {});
    let out = String::from_utf8(out.expect("solved").0).expect("text");
    let row = out.lines().last().expect("a row");
    assert!(row.starts_with("\"a, b\",5000,raceway-control,converged,,screw,true,"), "{row}");
}
