//! The program where the system says no: full disks, closed pipes, protected files, odd names,
//! interrupts. Every time a clear sentence, the right exit code, and nothing lost.
#![cfg(unix)]

mod program;

use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::{self, Write};
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::{FileTypeExt, symlink};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use program::{bsm, folder, stderr, stdout};

fn example(name: &str) -> String {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    examples.join(name).display().to_string()
}

/// Every command that prints, on an example.
fn printing() -> Vec<Vec<String>> {
    let (drive, lin, nut) =
        (example("feed_drive.json"), example("lin1994.json"), example("nut.json"));
    let (slip, jam) = (example("xu2015.json"), example("dong2020.json"));
    let measured = "--measured=screw_torque_Nm=26";
    let sweep = ["--vary=axial_load_N=100:9000:2000", "--model=closed-form", "-o-"];
    [
        &["--help"][..],
        &["solve", "--help"],
        &["--version"],
        &["schema", "input"],
        &["schema", "output"],
        &["completions", "bash"],
        &["solve", &drive],
        &["solve", &drive, "--format=json", "--sensitivities"],
        &["compare", &drive],
        &["sweep", &drive, sweep[0], sweep[1], sweep[2]],
        &["optimum", &lin],
        &["capacity", &nut],
        &["catalog", "--lists"],
        &["catalog", "--columns"],
        &["design"],
        &["slip", &slip],
        &["jam", &jam],
        &["fit", &drive, measured, "--model=raceway-control"],
    ]
    .into_iter()
    .map(|args| args.iter().map(|a| (*a).to_owned()).collect())
    .collect()
}

fn program(args: &[impl AsRef<OsStr>], folder: &Path) -> Command {
    // Whoever starts the tests may ignore signals.
    let mut command = Command::new("env");
    command.arg("--default-signal").arg(env!("CARGO_BIN_EXE_bsm")).args(args).current_dir(folder);
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

fn run(args: &[impl AsRef<OsStr>], folder: &Path) -> Output {
    program(args, folder).output().expect("the program runs")
}

/// Exit code, and one sentence on standard error that has `part` in it and nothing of a panic.
fn assert_told(output: &Output, code: i32, part: &str) {
    let text = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{text}");
    assert!(text.contains(part) && !text.contains("panicked"), "{text}");
    assert!(text.trim_end().lines().count() <= 1, "{text}");
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("folder").map(|entry| entry.expect("entry"));
    let mut names: Vec<_> = entries.map(|e| e.file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

#[test]
fn a_full_disk_is_told() {
    let dir = folder();
    for args in printing() {
        let full = File::options().write(true).open("/dev/full").expect("Linux has it");
        let output = program(&args, dir.path()).stdout(full).output().expect("the program runs");
        assert_told(&output, 1, "cannot write to standard output: No space left on device");
    }
    let drive = example("feed_drive.json");
    symlink("/dev/full", dir.path().join("full.csv")).expect("link");
    symlink("/dev/full", dir.path().join("full.parquet")).expect("link");
    for table in ["full.csv", "full.parquet"] {
        let args = ["sweep", &drive, "--vary=axial_load_N=1:9:3", "-o", table];
        assert_told(&run(&args, dir.path()), 1, &format!("cannot write {table}: "));
    }
}

/// A reader that has seen enough, as in `bsm ... | head -1`.
#[test]
fn a_closed_pipe_is_no_failure() {
    let dir = folder();
    for args in printing() {
        let (reader, writer) = io::pipe().expect("a pipe");
        drop(reader);
        let output = program(&args, dir.path()).stdout(writer).output().expect("the program runs");
        assert_told(&output, 0, "");
        assert!(output.stderr.is_empty(), "{args:?}: {}", stderr(&output));
    }
}

/// Without standard output the answer is dropped, as into /dev/null; without standard error only words.
#[test]
fn closed_streams_do_no_harm() {
    let dir = folder();
    let drive = example("feed_drive.json");
    let sh = |script: &str| {
        let program = env!("CARGO_BIN_EXE_bsm");
        let mut sh = Command::new("sh");
        sh.args(["-c", script, program, &drive]).current_dir(dir.path());
        sh.output().expect("sh")
    };
    let whole = sh(r#""$0" solve "$1""#);
    assert_eq!(stdout(&sh(r#""$0" solve "$1" 2>&-"#)), stdout(&whole));
    assert_eq!(stdout(&sh(r#""$0" solve "$1" 2>/dev/full"#)), stdout(&whole));
    assert_eq!(stdout(&sh(r#""$0" solve "$1" <&-"#)), stdout(&whole));
    assert_told(&sh(r#""$0" solve "$1" >&-"#), 0, "");
    assert_eq!(sh(r#""$0" solve nothing 2>&-"#).status.code(), Some(1));
    assert_eq!(sh(r#""$0" sovle 2>/dev/full"#).status.code(), Some(2));
    assert_told(&sh(r#""$0" solve - <&-"#), 2, "standard input: is empty");
}

/// Found by hand: a pipe or a device under the name of the output was replaced by a file.
#[test]
fn pipes_are_written_to_and_stay_pipes() {
    let dir = folder();
    let fifo = dir.path().join("pipe.csv");
    assert!(Command::new("mkfifo").arg(&fifo).status().expect("mkfifo").success());
    let drive = example("feed_drive.json");
    let sweep =
        ["sweep", &drive, "--vary=axial_load_N=1:9:3", "--columns=efficiency", "-o", "pipe.csv"];
    let child = program(&sweep, dir.path()).spawn().expect("the program starts");
    let text = fs::read_to_string(&fifo).expect("a table");
    assert_eq!(text.lines().count(), 4);
    assert_told(&child.wait_with_output().expect("ends"), 0, "");
    assert!(fs::metadata(&fifo).expect("there").file_type().is_fifo());
    // A table is read from one, too.
    let batch = ["batch", "pipe.csv", "--base", &drive, "--model=closed-form", "-o", "out.csv"];
    let child = program(&batch, dir.path()).spawn().expect("the program starts");
    fs::write(&fifo, "axial_load_N\n1\n").expect("pipe");
    assert_told(&child.wait_with_output().expect("ends"), 0, "");
    assert_eq!(names(dir.path()), ["out.csv", "pipe.csv"]);
}

#[test]
fn links_stay_links_and_what_is_protected_stays() {
    let dir = folder();
    let at = |name: &str| dir.path().join(name);
    let drive = example("feed_drive.json");
    let sweep = |output: &str| {
        run(&["sweep", &drive, "--vary=axial_load_N=1:9:3", "-o", output], dir.path())
    };
    fs::write(at("real.csv"), "old").expect("file");
    symlink("real.csv", at("link.csv")).expect("link");
    assert_told(&sweep("link.csv"), 0, "");
    assert!(at("link.csv").is_symlink());
    assert_eq!(fs::read_to_string(at("real.csv")).expect("table").lines().count(), 4);

    symlink("nothing.csv", at("astray.csv")).expect("link");
    assert_told(&sweep("astray.csv"), 1, "astray.csv: it is a link to nothing; remove it or");
    symlink("loop.csv", at("loop.csv")).expect("link");
    assert_eq!(sweep("loop.csv").status.code(), Some(1));

    let mut protected = fs::metadata(at("real.csv")).expect("there").permissions();
    protected.set_readonly(true);
    fs::write(at("kept.csv"), "old").expect("file");
    fs::set_permissions(at("kept.csv"), protected).expect("mine");
    assert_told(
        &sweep("kept.csv"),
        1,
        "cannot write kept.csv: it is read-only; make it writable or",
    );
    assert_eq!(fs::read_to_string(at("kept.csv")).expect("there"), "old");

    // Nobody makes files here, not even root.
    assert_told(&sweep("/proc/x.csv"), 1, "cannot write in folder /proc: ");
    assert_told(&sweep("no/such/x.csv"), 1, "cannot write in folder no/such: No such file");
    assert_told(&sweep("real.csv/x.csv"), 1, "cannot write in folder real.csv: Not a directory");
    fs::create_dir(at("folder.svg")).expect("folder");
    let plot = ["sweep", &drive, "--vary=axial_load_N=1:9:3", "-o", "x.csv", "--plot=folder.svg"];
    assert_told(&run(&plot, dir.path()), 1, "cannot write folder.svg: it is a folder");
    for args in [&["solve", "folder.svg"][..], &["batch", "folder.svg/../.csv", "-o-"]] {
        assert!(matches!(run(args, dir.path()).status.code(), Some(1 | 2)));
    }
    let left = ["astray.csv", "folder.svg", "kept.csv", "link.csv", "loop.csv", "real.csv"];
    assert_eq!(names(dir.path()), left);
}

/// The scene or requirement that a command reads is not replaced by what it writes.
#[test]
fn inputs_are_not_lost() {
    let dir = folder();
    let copy = |from: &str, to: &str| fs::copy(example(from), dir.path().join(to)).expect("copy");
    copy("feed_drive.json", "scene.csv");
    copy("requirements/feed_drive.json", "wish.json");
    symlink("wish.json", dir.path().join("same.json")).expect("link");
    fs::write(dir.path().join("lists.csv"), "{\"nominal_diameter_mm\": [20]}").expect("lists");
    fs::write(dir.path().join("points.csv"), "axial_load_N\n5\n").expect("points");
    for args in [
        &["sweep", "scene.csv", "--vary=axial_load_N=1:9:3", "-o", "scene.csv"][..],
        &["sweep", "scene.csv", "--vary=axial_load_N=1:9:3", "-o", "./scene.csv"],
        &["batch", "points.csv", "--base=scene.csv", "-o", "scene.csv"],
        &["design", "wish.json", "-o", "same.json"],
        &["catalog", "lists.csv", "-o", "lists.csv"],
        &["catalog", "lists.csv", "--pick", "lists.csv"],
    ] {
        assert_told(
            &run(args, dir.path()),
            2,
            "is an input, which would be lost; take another name",
        );
    }
    // A table of points may be answered in its place: it is read to its end before.
    let args =
        ["batch", "points.csv", "--base=scene.csv", "--model=closed-form", "-o", "points.csv"];
    assert_told(&run(&args, dir.path()), 0, "");
    let table = fs::read_to_string(dir.path().join("points.csv")).expect("table");
    assert!(table.lines().nth(1).expect("a row").starts_with("5,closed-form,converged"));
}

/// A sweep that takes hours, once it writes its table.
fn long_sweep(folder: &Path, output: &str) -> Child {
    let drive = example("feed_drive.json");
    let vary = "--vary=axial_load_N=100:9000:100000000";
    let args = ["sweep", &drive, vary, "--model=traction", "-o", output];
    program(&args, folder).spawn().expect("the program starts")
}

fn wait_for(what: impl Fn() -> bool) {
    let start = Instant::now();
    while !what() {
        assert!(start.elapsed() < Duration::from_secs(60), "nothing happens");
        sleep(Duration::from_millis(5));
    }
}

fn unfinished(folder: &Path) -> usize {
    names(folder).iter().filter(|name| name.starts_with(".bsm-")).count()
}

fn signal(child: &Child, name: &str) {
    let kill = Command::new("kill").args([name, &child.id().to_string()]).status();
    assert!(kill.expect("kill").success());
}

#[test]
fn an_interrupt_leaves_the_former_file_and_nothing_else() {
    for (name, code) in [("-INT", Some(130)), ("-TERM", Some(130)), ("-KILL", None)] {
        let dir = folder();
        let table = dir.path().join("out.csv");
        fs::write(&table, "old").expect("file");
        let child = long_sweep(dir.path(), "out.csv");
        wait_for(|| unfinished(dir.path()) == 1);
        signal(&child, name);
        let output = child.wait_with_output().expect("ends");
        assert_eq!(output.status.code(), code);
        assert_eq!(fs::read_to_string(&table).expect("there"), "old");
        if code.is_some() {
            assert_told(&output, 130, "interrupted; nothing unfinished was kept");
            assert_eq!(names(dir.path()), ["out.csv"]);
        }
    }
}

/// Found by hand: while it waited for its input, the program heard the first interrupt only when
/// more came, and left its temporary file at the second.
#[test]
fn an_interrupt_is_heard_while_input_is_waited_for() {
    let dir = folder();
    let args =
        ["batch", "-", "--base", &example("feed_drive.json"), "--model=closed-form", "-o", "x.csv"];
    let mut child = program(&args, dir.path()).stdin(Stdio::piped()).spawn().expect("starts");
    let mut stdin = child.stdin.take().expect("piped");
    let rows = "axial_load_N\n".to_owned() + &"2000\n".repeat(70_000);
    stdin.write_all(rows.as_bytes()).expect("it reads");
    wait_for(|| unfinished(dir.path()) == 1);
    signal(&child, "-INT");
    assert_told(&child.wait_with_output().expect("ends"), 130, "interrupted");
    assert!(names(dir.path()).is_empty());
}

#[test]
fn two_writers_do_not_mix() {
    let dir = folder();
    let first = long_sweep(dir.path(), "parts/");
    let parts = dir.path().join("parts");
    let tmp = parts.join("tmp");
    let begun = || parts.join("plan.json").exists() && !names(&tmp).is_empty();
    wait_for(|| tmp.is_dir() && begun());
    let drive = example("feed_drive.json");
    for (more, part) in [
        ("--resume", "parts/ holds the parts of another task, which differs in: points"),
        ("--quiet", "parts/ holds the parts of another task; go on with --resume"),
    ] {
        let args = ["sweep", &drive, "--vary=axial_load_N=1:9:3", more, "-o", "parts/"];
        assert_told(&run(&args, dir.path()), 2, part);
    }
    assert_eq!(names(&tmp).len(), 1, "the file of the first is still there");
    signal(&first, "-INT");
    assert_told(&first.wait_with_output().expect("ends"), 130, "interrupted");
    assert_eq!(names(&parts), ["data", "plan.json", "tmp"]);
    assert!(names(&tmp).is_empty() && names(&parts.join("data")).is_empty());

    // Into one file, the last one wins, with a whole table.
    let sweep = |count: &str| {
        let vary = format!("--vary=axial_load_N=100:9000:{count}");
        let args = ["sweep", &drive, &vary, "--model=rigid", "-o", "both.csv"];
        program(&args, dir.path()).spawn().expect("the program starts")
    };
    for child in [sweep("3000"), sweep("3001")] {
        assert_told(&child.wait_with_output().expect("ends"), 0, "");
    }
    let text = fs::read_to_string(dir.path().join("both.csv")).expect("table");
    let last = text.lines().last().expect("a row");
    assert!([3001, 3002].contains(&text.lines().count()) && last.starts_with("9000,"), "{last}");
    assert_eq!(names(dir.path()), ["both.csv", "parts"]);
}

#[test]
fn names_need_not_be_utf8() {
    let dir = folder();
    let name = |ending: &str| {
        let mut name = b"caf\xe9".to_vec();
        name.extend_from_slice(ending.as_bytes());
        PathBuf::from(OsStr::from_bytes(&name))
    };
    let run = |args: &[&OsStr]| run(args, dir.path());
    fs::copy(example("feed_drive.json"), dir.path().join(name(".json"))).expect("copy");
    fs::write(dir.path().join(name(".csv")), "axial_load_N\n2000\n").expect("points");
    let (scene, points, out, parts) = (name(".json"), name(".csv"), name("2.parquet"), name("/"));
    let os = OsStr::new;
    assert_told(&run(&[os("solve"), scene.as_os_str()]), 0, "");
    for output in [&out, &parts] {
        let args =
            [points.as_os_str(), os("--base"), scene.as_os_str(), os("-o"), output.as_os_str()];
        assert_told(&run(&[&[os("batch")][..], &args].concat()), 0, "");
    }
    let missing = run(&[os("solve"), name(".gone").as_os_str()]);
    assert_told(&missing, 1, "cannot read caf\u{fffd}.gone: No such file");
    assert_eq!(
        run(&[os("solve"), scene.as_os_str(), os("--set"), out.as_os_str()]).status.code(),
        Some(2)
    );
    assert_eq!(fs::read_dir(dir.path()).expect("folder").count(), 4);
}

/// What other programs write: answered, or told what is wrong with it.
#[test]
fn tables_of_other_programs() {
    let dir = folder();
    let utf16 = |text: &str| text.encode_utf16().flat_map(u16::to_le_bytes).collect::<Vec<u8>>();
    let marked = [&b"\xff\xfe"[..], &utf16("axial_load_N\n2000\n")].concat();
    let header = format!("{}axial_load_N\n", "model,".repeat(1_000_000));
    let row = format!("{}2000\n", "a,".repeat(1_000_000));
    let unknown = format!("{}axial_load_N\n", "x,".repeat(1_000_000));
    let long = format!("{}\n1\n", "x".repeat(1_000_000));
    let key = format!("{{\"{}\": 1}}\n", "x".repeat(1_000_000));
    let quote = format!("id,axial_load_N\n\"1,2000\n{}", "2,3000\n".repeat(3_000_000));
    let deep = "{\"lead_mm\":".repeat(100_000);
    for (name, bytes, code, part) in [
        ("bom.csv", &b"\xef\xbb\xbfaxial_load_N\n2000\n"[..], 0, ""),
        ("bom.jsonl", b"\xef\xbb\xbf{\"axial_load_N\": 2000}\n", 0, ""),
        ("crlf.csv", b"axial_load_N\r\n2000\r\n", 0, ""),
        ("crlf.jsonl", b"{\"axial_load_N\": 2000}\r\n\r\n", 0, ""),
        ("header.csv", b"axial_load_N\n", 0, ""),
        ("wide.csv", (header + &row).as_bytes(), 0, ""),
        ("wide-unknown.csv", unknown.as_bytes(), 2, "column `x` is no input"),
        ("long-name.csv", long.as_bytes(), 2, "xxx…` is no input; leave it out"),
        ("long-key.jsonl", key.as_bytes(), 2, "xxx…` is no input; leave it out"),
        ("semicolons.csv", b"axial_load_N;lead_mm\n2000,5;10\n", 2, "separated by `;`; cells are"),
        ("tabs.csv", b"axial_load_N\tlead_mm\n2000\t10\n", 2, "separated by `\\t`; cells are"),
        ("utf16.csv", &marked, 2, "the names of the columns are not UTF-8 text; save"),
        ("utf16-unmarked.csv", &utf16("axial_load_N\n2\n"), 2, "separated by `\\0`"),
        ("utf16.jsonl", &marked, 2, "row 1: is not valid JSON"),
        ("latin1.csv", b"axial_load_N,model\n1,a\n2,M\xfcller\n", 2, "row 2 is not UTF-8 text"),
        ("latin1.jsonl", b"{\"axial_load_N\": \"\xfc\"}\n", 2, "row 1: is not valid JSON"),
        ("nul.csv", b"axial_load_N\x00\n2000\n", 2, "separated by `\\0`"),
        ("empty.csv", b"", 2, "the table is empty: the first row must name the columns"),
        ("empty.jsonl", b"\n \n", 2, "the table is empty: the first row must name the columns"),
        ("empty.parquet", b"", 2, "not a Parquet table"),
        (
            "damaged.parquet",
            include_bytes!("../../../fuzz/corpus/parquet/damaged-levels.parquet"),
            2,
            "not a Parquet table: it is damaged",
        ),
        ("twice.csv", b"axial_load_N,axial_load_N\n1,2\n", 2, "`axial_load_N` stands twice"),
        ("twice.jsonl", b"{\"axial_load_N\": 1, \"axial_load_N\": 2}\n", 2, "is given twice"),
        (
            "ragged.csv",
            b"axial_load_N,model\n1,a\n\n2\n",
            2,
            "row 2 has 1 cells, but the table has 2",
        ),
        ("quote.csv", quote.as_bytes(), 2, "row 1 is longer than 16 MiB; is a quote"),
        ("deep.jsonl", deep.as_bytes(), 2, "row 1: is not valid JSON: recursion"),
    ] {
        fs::write(dir.path().join(name), bytes).expect("table");
        let drive = example("feed_drive.json");
        let args = ["batch", name, "--base", &drive, "--model=closed-form", "-o-"];
        let keep = if name == "quote.csv" { "--keep=id" } else { "--quiet" };
        let output = run(&[&args[..], &[keep]].concat(), dir.path());
        assert_told(&output, code, part);
        assert!(code == 0 || output.stderr.starts_with(format!("error: {name}: ").as_bytes()));
        let rows =
            stdout(&output).lines().filter(|row| row.starts_with("2000,closed-form")).count();
        assert_eq!(rows, usize::from(code == 0 && name != "header.csv"), "{name}");
    }
    // A decimal comma in quotes is one cell, which the row tells.
    let args = ["batch", "-", "--base", &example("feed_drive.json"), "-o-"];
    let output = bsm(dir.path(), &args, "axial_load_N\n\"2000,5\"\n");
    assert!(stdout(&output).contains("is `2000,5`, but must be a number"), "{}", stdout(&output));
}

/// Neither locale nor terminal, home or temporary folder change an answer.
#[test]
fn the_environment_changes_nothing() {
    let dir = folder();
    let drive = example("feed_drive.json");
    let args = ["solve", &drive, "--sensitivities"];
    let usual = run(&args, dir.path());
    for (name, value) in [
        ("LC_ALL", "de_DE.UTF-8"),
        ("LC_ALL", "tr_TR"),
        ("LC_ALL", "C"),
        ("NO_COLOR", "1"),
        ("CLICOLOR_FORCE", "1"),
        ("COLUMNS", "1"),
        ("TERM", "dumb"),
        ("TMPDIR", "/no/such/folder"),
        ("RAYON_NUM_THREADS", "0"),
    ] {
        let mut command = program(&args, dir.path());
        let output = command.env_clear().env(name, value).output().expect("the program runs");
        assert_eq!((output.status.code(), stdout(&output)), (Some(0), stdout(&usual)), "{name}");
    }
    let help = |columns: &str| {
        let mut command = program(&["--help"], dir.path());
        command.env("COLUMNS", columns).output().expect("the program runs")
    };
    assert_told(&help("1"), 0, "");
    let vary = "--vary=axial_load_N=1:9:3";
    let sweep = |more: &[&str]| {
        let args =
            [&["sweep", &drive, vary, "-o", "x.csv", "--model=closed-form"][..], more].concat();
        program(&args, dir.path()).env_clear().env("TMPDIR", "/no/such").output().expect("runs")
    };
    assert_told(&sweep(&["--threads=1024"]), 0, "");
    for threads in ["0", "-1", "1025", "99999999999999999999", "many"] {
        let output = sweep(&[&format!("--threads={threads}")]);
        assert_eq!(output.status.code(), Some(2), "{threads}");
        assert!(stderr(&output).contains("a whole number from 1 to 1024"), "{}", stderr(&output));
    }
    let mut command = program(&["solve", &drive], dir.path());
    let output = command.env("RAYON_NUM_THREADS", "100000").output().expect("the program runs");
    assert_told(&output, 2, "RAYON_NUM_THREADS must be a whole number from 1 to 1024");
}
