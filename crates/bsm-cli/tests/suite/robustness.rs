//! Tests of the behavior when the operating system refuses an operation: full disks, closed pipes,
//! protected files, unusual file names and interrupts. Each case must cause a clear message and the
//! right exit code, and no file may be lost.
#![cfg(unix)]

use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::{self, Write};
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::{FileTypeExt, MetadataExt, PermissionsExt, chown, symlink};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::program::{bsm, example, folder, stderr, stdout};

/// Returns an example of every command that prints to standard output.
fn printing_commands() -> Vec<Vec<String>> {
    let (drive, lin, nut) =
        (example("feed_drive.json"), example("lin1994.json"), example("nut.json"));
    let (slip, jam) = (example("feed_drive.json"), example("dong2020.json"));
    let measured = "--measured=screw_torque_Nm=26";
    let sweep = ["--vary=axial_load_N=100:9000:2000", "--model=closed-form", "-o-"];
    [
        &["--help"][..],
        &["solve", "--help"],
        &["--version"],
        &["schema", "input"],
        &["schema", "output"],
        &["schema"],
        &["solve", &drive],
        &["solve", &drive, "--json", "--show", "sensitivities"],
        &["solve", &drive, "--model", "all"],
        &["sweep", &drive, sweep[0], sweep[1], sweep[2]],
        &["solve", &lin, "--show", "optimum"],
        &["solve", &nut, "--show", "ratings"],
        &["select", "--show", "lists"],
        &["select", "--show", "columns"],
        &["select", "--show", "keys"],
        &["solve", &slip, "--show", "slip"],
        &["solve", &jam, "--show", "jam"],
        &["fit", &drive, measured, "--model=raceway-control"],
    ]
    .into_iter()
    .map(|args| args.iter().map(|a| (*a).to_owned()).collect())
    .collect()
}

fn program(args: &[impl AsRef<OsStr>], folder: &Path) -> Command {
    // The parent process may ignore signals, so the default signal handlers are restored.
    let mut command = Command::new("env");
    command.arg("--default-signal").arg(env!("CARGO_BIN_EXE_bsm")).args(args).current_dir(folder);
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

fn run(args: &[impl AsRef<OsStr>], folder: &Path) -> Output {
    program(args, folder).output().expect("the program runs")
}

/// Checks the exit code. Apart from warnings and notes, standard error must contain one sentence with the
/// text `part` and no panic message.
fn assert_exit_and_message(output: &Output, code: i32, part: &str) {
    let text = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{text}");
    assert!(text.contains(part) && !text.contains("panicked"), "{text}");
    assert!(lines_without_notes(&text).count() <= 1, "{text}");
}

/// Returns all lines except empty lines and warnings.
fn lines_without_notes(text: &str) -> impl Iterator<Item = &str> {
    text.lines().filter(|line| {
        !line.is_empty() && !["warning: ", "note: "].iter().any(|kind| line.starts_with(kind))
    })
}

fn file_names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("folder").map(|entry| entry.expect("entry"));
    let mut names: Vec<_> = entries.map(|e| e.file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

#[test]
fn a_full_disk_is_reported() {
    let dir = folder();
    for args in printing_commands() {
        let full = File::options().write(true).open("/dev/full").expect("Linux has it");
        let output = program(&args, dir.path()).stdout(full).output().expect("the program runs");
        assert_exit_and_message(
            &output,
            1,
            "cannot write to standard output: No space left on device",
        );
    }
    let drive = example("feed_drive.json");
    symlink("/dev/full", dir.path().join("full.csv")).expect("link");
    symlink("/dev/full", dir.path().join("full.parquet")).expect("link");
    for table in ["full.csv", "full.parquet"] {
        let args = ["sweep", &drive, "--vary=axial_load_N=1:9:3", "-o", table];
        assert_exit_and_message(&run(&args, dir.path()), 1, &format!("cannot write {table}: "));
    }
}

/// If the program that reads the output stops early, as in `bsm ... | head -1`, this must not count
/// as a failure.
#[test]
fn a_closed_pipe_is_not_a_failure() {
    let dir = folder();
    for args in printing_commands() {
        let (reader, writer) = io::pipe().expect("a pipe");
        drop(reader);
        let output = program(&args, dir.path()).stdout(writer).output().expect("the program runs");
        assert_exit_and_message(&output, 0, "");
        assert_eq!(lines_without_notes(&stderr(&output)).next(), None, "{args:?}");
    }
}

/// If standard output is closed, the answer must be discarded, as if it were written to /dev/null.
/// If standard error is closed, only messages may be lost.
#[test]
fn closed_standard_streams_are_tolerated() {
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
    assert_exit_and_message(&sh(r#""$0" solve "$1" >&-"#), 0, "");
    assert_eq!(sh(r#""$0" solve nothing 2>&-"#).status.code(), Some(1));
    assert_eq!(sh(r#""$0" sovle 2>/dev/full"#).status.code(), Some(2));
    assert_exit_and_message(&sh(r#""$0" solve - <&-"#), 2, "standard input: is empty");
}

/// Regression test: an existing pipe or device with the name of the output was replaced by a file.
#[test]
fn output_pipes_are_written_to_and_not_replaced() {
    let dir = folder();
    let fifo = dir.path().join("pipe.csv");
    assert!(Command::new("mkfifo").arg(&fifo).status().expect("mkfifo").success());
    let drive = example("feed_drive.json");
    let sweep =
        ["sweep", &drive, "--vary=axial_load_N=1:9:3", "--columns=efficiency", "-o", "pipe.csv"];
    let child = program(&sweep, dir.path()).spawn().expect("the program starts");
    let text = fs::read_to_string(&fifo).expect("a table");
    assert_eq!(text.lines().count(), 4);
    assert_exit_and_message(&child.wait_with_output().expect("ends"), 0, "");
    assert!(fs::metadata(&fifo).expect("there").file_type().is_fifo());
    // A table can also be read from a pipe.
    let batch = ["sweep", &drive, "--points", "pipe.csv", "--model=closed-form", "-o", "out.csv"];
    let child = program(&batch, dir.path()).spawn().expect("the program starts");
    fs::write(&fifo, "axial_load_N\n1\n").expect("pipe");
    assert_exit_and_message(&child.wait_with_output().expect("ends"), 0, "");
    assert_eq!(file_names(dir.path()), ["out.csv", "pipe.csv"]);
}

#[test]
fn symbolic_links_and_write_protected_files_are_not_replaced() {
    let dir = folder();
    let at = |name: &str| dir.path().join(name);
    let drive = example("feed_drive.json");
    let sweep = |output: &str| {
        run(&["sweep", &drive, "--vary=axial_load_N=1:9:3", "-o", output], dir.path())
    };
    fs::write(at("real.csv"), "old").expect("file");
    symlink("real.csv", at("link.csv")).expect("link");
    assert_exit_and_message(&sweep("link.csv"), 0, "");
    assert!(at("link.csv").is_symlink());
    assert_eq!(fs::read_to_string(at("real.csv")).expect("table").lines().count(), 4);

    symlink("nothing.csv", at("astray.csv")).expect("link");
    assert_exit_and_message(
        &sweep("astray.csv"),
        1,
        "astray.csv: the path is a broken link; remove the link or",
    );
    symlink("loop.csv", at("loop.csv")).expect("link");
    assert_eq!(sweep("loop.csv").status.code(), Some(1));

    let mut protected = fs::metadata(at("real.csv")).expect("there").permissions();
    protected.set_readonly(true);
    fs::write(at("kept.csv"), "old").expect("file");
    fs::set_permissions(at("kept.csv"), protected).expect("mine");
    assert_exit_and_message(
        &sweep("kept.csv"),
        1,
        "cannot write kept.csv: the file is read-only; make it writable or",
    );
    assert_eq!(fs::read_to_string(at("kept.csv")).expect("there"), "old");

    // No user can create files in these folders, not even root.
    assert_exit_and_message(&sweep("/proc/x.csv"), 1, "cannot write in folder /proc: ");
    assert_exit_and_message(
        &sweep("no/such/x.csv"),
        1,
        "cannot write in folder no/such: No such file",
    );
    assert_exit_and_message(
        &sweep("real.csv/x.csv"),
        1,
        "cannot write in folder real.csv: Not a directory",
    );
    fs::create_dir(at("folder.svg")).expect("folder");
    let plot = ["sweep", &drive, "--vary=axial_load_N=1:9:3", "-o", "x.csv", "-o", "folder.svg"];
    assert_exit_and_message(
        &run(&plot, dir.path()),
        1,
        "cannot write folder.svg: the path is a folder",
    );
    for args in [&["solve", "folder.svg"][..], &["sweep", "--points", "folder.svg/../.csv", "-o-"]]
    {
        assert!(matches!(run(args, dir.path()).status.code(), Some(1 | 2)));
    }
    let left = ["astray.csv", "folder.svg", "kept.csv", "link.csv", "loop.csv", "real.csv"];
    assert_eq!(file_names(dir.path()), left);
}

/// An output must never replace the case or the requirement that the command reads.
#[test]
fn input_files_are_not_overwritten() {
    let dir = folder();
    let copy = |from: &str, to: &str| fs::copy(example(from), dir.path().join(to)).expect("copy");
    copy("feed_drive.json", "case.csv");
    copy("requirements/feed_drive.json", "requirement.json");
    symlink("requirement.json", dir.path().join("same.json")).expect("link");
    fs::write(dir.path().join("lists.json"), "{\"nominal_diameter_mm\": [20]}").expect("lists");
    fs::write(dir.path().join("points.csv"), "axial_load_N\n5\n").expect("points");
    for args in [
        &["sweep", "case.csv", "--vary=axial_load_N=1:9:3", "-o", "case.csv"][..],
        &["sweep", "case.csv", "--vary=axial_load_N=1:9:3", "-o", "./case.csv"],
        &["sweep", "case.csv", "--points", "points.csv", "-o", "case.csv"],
        &["select", "requirement.json", "-o", "same.json"],
        &["select", "--from", "lists.json", "-o", "nuts.csv", "-o", "lists.json"],
        &["select", "requirement.json", "--from", "lists.json", "-o", "requirement.json"],
    ] {
        assert_exit_and_message(
            &run(args, dir.path()),
            2,
            "is an input file and would be overwritten; use another name",
        );
    }
    // The output may replace the table of points, because the table is read completely before the
    // temporary output file is renamed.
    let args =
        ["sweep", "case.csv", "--points", "points.csv", "--model=closed-form", "-o", "points.csv"];
    assert_exit_and_message(&run(&args, dir.path()), 0, "");
    let table = fs::read_to_string(dir.path().join("points.csv")).expect("table");
    assert!(table.lines().nth(1).expect("a row").starts_with("5,closed-form,converged"));
}

/// Starts a sweep that would take hours, and waits until it has started to write its table.
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

fn count_unfinished_files(folder: &Path) -> usize {
    file_names(folder).iter().filter(|name| name.starts_with(".bsm-")).count()
}

fn send_signal(child: &Child, name: &str) {
    let kill = Command::new("kill").args([name, &child.id().to_string()]).status();
    assert!(kill.expect("kill").success());
}

#[test]
fn interrupt_keeps_the_existing_file_and_leaves_no_temporary_files() {
    for (name, code) in [
        ("-HUP", Some(129)),
        ("-INT", Some(130)),
        ("-QUIT", Some(131)),
        ("-TERM", Some(143)),
        ("-XFSZ", Some(153)),
        ("-KILL", None),
    ] {
        let dir = folder();
        let table = dir.path().join("out.csv");
        fs::write(&table, "old").expect("file");
        let child = long_sweep(dir.path(), "out.csv");
        wait_for(|| count_unfinished_files(dir.path()) == 1);
        send_signal(&child, name);
        let output = child.wait_with_output().expect("ends");
        assert_eq!(output.status.code(), code);
        assert_eq!(fs::read_to_string(&table).expect("there"), "old");
        if let Some(code) = code {
            assert_exit_and_message(&output, code, "interrupted; incomplete files were removed");
            assert_eq!(file_names(dir.path()), ["out.csv"]);
        }
    }
}

/// Regression test: if SIGHUP was ignored (under `nohup`) or SIGINT was ignored (in background jobs
/// of scripts), the program did not handle any other signal and left a temporary file behind.
#[test]
fn signals_are_handled_under_nohup_and_in_the_background() {
    for ignored in ["HUP", "INT"] {
        let dir = folder();
        let vary = "--vary=axial_load_N=100:9000:100000000";
        let drive = example("feed_drive.json");
        let mut command = Command::new("env");
        command.args(["--default-signal", &format!("--ignore-signal={ignored}")]);
        command.arg(env!("CARGO_BIN_EXE_bsm")).args(["sweep", &drive, vary, "--model=traction"]);
        command.args(["-o", "out.csv"]).current_dir(dir.path());
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped());
        let mut child = command.spawn().expect("the program starts");
        wait_for(|| count_unfinished_files(dir.path()) == 1);
        send_signal(&child, &format!("-{ignored}"));
        sleep(Duration::from_millis(300));
        assert!(child.try_wait().expect("a child").is_none(), "{ignored} must stay ignored");
        send_signal(&child, "-TERM");
        assert_exit_and_message(&child.wait_with_output().expect("ends"), 143, "interrupted");
        assert!(file_names(dir.path()).is_empty());
    }
}

/// Runs the program in a shell with resource limits. If the shell does not support the limits,
/// prints the reason and returns `None`.
#[expect(clippy::print_stdout, reason = "a test that was skipped says so")]
fn run_with_limits(limits: &str, args: &[&str], folder: &Path) -> Option<Output> {
    let script = format!("{limits} || exit 99; exec \"$0\" \"$@\"");
    let mut sh = Command::new("bash");
    sh.args(["-c", &script, env!("CARGO_BIN_EXE_bsm")]).args(args).current_dir(folder);
    let output = sh.stdin(Stdio::null()).output().expect("bash");
    if output.status.code() == Some(99) {
        println!("skipped: this system does not know {limits}");
        return None;
    }
    Some(output)
}

/// Regression test: a thread that could not be started caused a panic.
#[test]
fn program_does_not_panic_if_a_thread_cannot_be_started() {
    let dir = folder();
    let drive = example("feed_drive.json");
    // Each stack takes 2 MiB, so that the memory limit allows only some of the 1024 threads.
    let many = ["sweep", &drive, "--vary=axial_load_N=1:9:3", "--threads=1024", "-o", "x.csv"];
    if let Some(output) = run_with_limits("ulimit -v 1000000", &many, dir.path()) {
        assert_exit_and_message(
            &output,
            0,
            "of 1024 threads are used, because the operating system did not start more",
        );
    }
    let catalog = ["select", "--first=3", "--where=lead_mm=20"];
    let usual = run(&catalog, dir.path());
    let limits = "export RAYON_NUM_THREADS=1024; ulimit -v 1000000";
    if let Some(output) = run_with_limits(limits, &catalog, dir.path()) {
        assert_eq!((output.status.code(), stdout(&output)), (Some(0), stdout(&usual)));
        assert!(
            stderr(&output).contains(
                "of 1024 threads are used, because the operating system did not start more"
            )
        );
    }
    // The root user may start any number of threads. Other users exceed the limit and get an error.
    for args in [&many[..], &catalog] {
        let Some(output) = run_with_limits("ulimit -u 1", args, dir.path()) else { continue };
        let text = stderr(&output);
        match output.status.code() {
            Some(0) => {}
            Some(1) => assert!(text.contains("cannot start a thread: "), "{text}"),
            other => panic!("{other:?}: {text}"),
        }
    }
}

/// Returns an upper bound of the address space that the program file itself occupies \[kB\]. A test
/// build is larger than a release build. Each memory limit in the tests is the sum of this size and
/// the memory of a run, which consists of allocator arenas and thread stacks of 16 MiB each if
/// debug assertions are enabled.
fn program_size_in_kb() -> u64 {
    fs::metadata(env!("CARGO_BIN_EXE_bsm")).expect("the program").len() / 1000
}

/// For any memory limit, the program must succeed or exit with code 1. If the limit is too low to
/// start any process, the shell and the loader exit with codes 126 and 127. Just above this limit,
/// Rust's runtime aborts before `main`, because it cannot allocate the stack for signal handlers.
#[test]
fn program_does_not_panic_if_memory_is_low() {
    let dir = folder();
    let drive = example("feed_drive.json");
    let sweep =
        ["sweep", &drive, "--vary=axial_load_N=100:9000:60000", "--model=rigid", "-o", "x.csv"];
    let mut codes = Vec::new();
    let mapped = program_size_in_kb();
    for kilobytes in [1, 20, 30, 40, 60, 90, mapped / 1000 + 160].map(|n| 1000 * n) {
        let Some(output) = run_with_limits(&format!("ulimit -v {kilobytes}"), &sweep, dir.path())
        else {
            return;
        };
        let text = stderr(&output);
        let before_main = text.contains("failed to allocate an alternative stack");
        assert!(before_main || !text.contains("panicked"), "{kilobytes} kB: {text}");
        codes.push(output.status.code());
    }
    let [first, .., last] = codes[..] else { unreachable!("seven limits") };
    assert!(first != Some(0) && last == Some(0), "{codes:?}");
    assert!(codes.iter().all(|c| matches!(c, Some(0 | 1 | 126 | 127) | None)), "{codes:?}");
}

/// Regression test: if a file exceeded the limit of `ulimit -f`, the signal SIGXFSZ ended the
/// program, and the temporary file was left behind.
#[test]
fn a_file_above_the_size_limit_is_reported() {
    let dir = folder();
    let drive = example("feed_drive.json");
    let sweep = |output| {
        ["sweep", &drive, "--vary=axial_load_N=1:9:20000", "--model=closed-form", "-o", output]
            .map(str::to_owned)
    };
    for (limits, output, part) in [
        ("ulimit -f 8", "x.csv", "cannot write x.csv: File too large"),
        ("ulimit -f 8", "x.parquet", "cannot write x.parquet: "),
        ("ulimit -f 64", "x.xlsx", "cannot write x.xlsx: not enough space for a temporary file"),
        ("ulimit -f 8; exec > y.csv", "-", "cannot write to standard output: File too large"),
    ] {
        let args = sweep(output);
        let args: Vec<_> = args.iter().map(String::as_str).collect();
        if let Some(output) = run_with_limits(limits, &args, dir.path()) {
            assert_exit_and_message(&output, 1, part);
        }
    }
    assert!(
        file_names(dir.path()).iter().all(|name| name == "y.csv"),
        "{:?}",
        file_names(dir.path())
    );
}

/// If the program reaches the limit of open files, it must report this error. With a sufficient
/// limit, it must succeed.
#[test]
fn exceeding_the_limit_of_open_files_is_reported() {
    let dir = folder();
    let drive = example("feed_drive.json");
    let args = ["sweep", &drive, "--vary=axial_load_N=1:9:3", "--model=closed-form", "-o", "x.csv"];
    let mut codes = Vec::new();
    for files in 4..16 {
        let Some(output) = run_with_limits(&format!("ulimit -n {files}"), &args, dir.path()) else {
            return;
        };
        let text = stderr(&output);
        assert!(!text.contains("panicked"), "{files} files: {text}");
        let code = output.status.code();
        assert!(code != Some(1) || text.contains("Too many open files"), "{files} files: {text}");
        codes.push(code);
    }
    assert!(codes.contains(&Some(1)) && codes.last() == Some(&Some(0)), "{codes:?}");
    assert_eq!(file_names(dir.path()), ["x.csv"]);
}

/// Regression test: a private output file became readable by all users, and its owner could change.
#[test]
fn a_replaced_output_keeps_its_permissions_and_owner() {
    let dir = folder();
    let (table, drive) = (dir.path().join("out.csv"), example("feed_drive.json"));
    let args = ["sweep", &drive, "--vary=axial_load_N=1:9:3", "-o", "out.csv"];
    for mode in [0o600, 0o640, 0o664, 0o777] {
        fs::write(&table, "old").expect("file");
        fs::set_permissions(&table, fs::Permissions::from_mode(mode)).expect("mine");
        // Only root can change the owner of a file.
        let given = chown(&table, Some(4321), Some(1234)).is_ok();
        let before = fs::metadata(&table).expect("there");
        assert_exit_and_message(&run(&args, dir.path()), 0, "");
        let after = fs::metadata(&table).expect("there");
        assert_ne!(after.ino(), before.ino(), "a new file took its name");
        assert_eq!(after.mode() & 0o7777, mode);
        assert_eq!((after.uid(), after.gid()), (before.uid(), before.gid()), "given: {given}");
        fs::remove_file(&table).expect("mine");
    }
    // A new file gets the permissions that the umask allows.
    let output = Command::new("sh")
        .args(["-c", "umask 027; exec \"$0\" \"$@\"", env!("CARGO_BIN_EXE_bsm")])
        .args(args)
        .current_dir(dir.path())
        .output();
    assert_exit_and_message(&output.expect("sh"), 0, "");
    assert_eq!(fs::metadata(&table).expect("there").mode() & 0o7777, 0o640);
    // Another hard link to the replaced file must keep the old contents.
    fs::write(&table, "old").expect("file");
    fs::hard_link(&table, dir.path().join("other.csv")).expect("link");
    assert_exit_and_message(&run(&args, dir.path()), 0, "");
    assert_eq!(fs::read_to_string(dir.path().join("other.csv")).expect("there"), "old");
    assert_ne!(fs::read_to_string(&table).expect("there"), "old");
}

/// Regression test: `--resume` removed every file whose name began with `.bsm-`, including the
/// user's own files.
#[test]
fn resume_keeps_files_of_the_user() {
    let dir = folder();
    let drive = example("feed_drive.json");
    let sweep = |more: &[&str]| {
        let args = ["sweep", &drive, "--vary=axial_load_N=1:9:3", "-o", "parts/"];
        run(&[&args[..], more].concat(), dir.path())
    };
    assert_exit_and_message(&sweep(&[]), 0, "");
    let parts = dir.path().join("parts");
    let others = [
        ".bsm-notes",
        ".bsm-part-000001.parquet",
        ".bsm-part-000001.parquet-old",
        ".bsm-mine.csv-0aB1cD2eF3gH4iJ5",
    ];
    for folder in [&parts, &parts.join("tmp")] {
        fs::create_dir_all(folder).expect("folder");
        for name in others {
            fs::write(folder.join(name), "mine").expect("file");
        }
    }
    assert_exit_and_message(&sweep(&["--resume"]), 0, "");
    let mut expected = others.map(str::to_owned).to_vec();
    assert_eq!(file_names(&parts.join("tmp")), {
        expected.sort();
        expected.clone()
    });
    expected.extend(["data", "parts.parquet", "plan.json", "tmp"].map(str::to_owned));
    assert_eq!(file_names(&parts), expected);
}

/// Regression test: `solve /dev/zero` never stopped reading.
#[test]
fn reading_an_endless_device_stops_at_the_size_limit() {
    let dir = folder();
    let axis = example("axis.json");
    for args in [
        &["solve", "/dev/zero"][..],
        &["solve", "/dev/zero", "--model", "all"],
        &["select", "/dev/zero"],
        &["select", "--from", "/dev/zero"],
        &["sweep", "/dev/zero", "--vary=axial_load_N=1:9:3", "-o-"],
        &["sweep", "/dev/zero", "--points", "-", "-o-"],
    ] {
        assert_exit_and_message(&run(args, dir.path()), 2, "/dev/zero: is larger than 1 MiB");
    }
    let cycle = ["axis", &axis, "--cycle", "/dev/zero"];
    assert_exit_and_message(&run(&cycle, dir.path()), 2, "/dev/zero: is larger than 16 MiB");
    let zero = File::open("/dev/zero").expect("Linux has it");
    let output = program(&["solve", "-"], dir.path()).stdin(zero).output().expect("runs");
    assert_exit_and_message(&output, 2, "standard input: is larger than 1 MiB");
}

/// Regression test: every nut in a catalog was held in memory several times, which took 2.7 GB for
/// five million nuts.
#[test]
fn memory_needed_for_a_large_catalog_is_less_than_one_copy_of_its_table() {
    let dir = folder();
    let list = |from: f64, step: f64, count: u32| {
        let values: Vec<_> = (0..count).map(|i| (from + step * f64::from(i)).to_string()).collect();
        format!("[{}]", values.join(","))
    };
    let lists = format!(
        "{{\"nominal_diameter_mm\": {}, \"lead_mm\": {}, \"ball_diameter_mm\": [5, 6],
          \"loaded_turns\": {}, \"nut_conformity\": {}}}",
        list(40.0, 1.0, 30),
        list(12.0, 1.0, 25),
        list(2.0, 0.2, 20),
        list(0.51, 0.01, 6),
    );
    fs::write(dir.path().join("lists.json"), lists).expect("lists");
    // Each additional copy of the table of 180 000 nuts would take at least 100 MB. The program
    // needs only about 20 MB in addition to its own size.
    let limits = format!("export RAYON_NUM_THREADS=1; ulimit -v {}", program_size_in_kb() + 46_000);
    let limits = limits.as_str();
    let args = ["select", "--from", "lists.json", "--sort=nut_mass_kg", "-o", "nuts.csv"];
    let Some(output) = run_with_limits(limits, &args, dir.path()) else { return };
    assert_exit_and_message(&output, 0, "The list contains 180000 nuts");
    let table = fs::read_to_string(dir.path().join("nuts.csv")).expect("table");
    assert_eq!(table.lines().count(), 180_001);
    let column = table.lines().next().expect("names").split(',').position(|n| n == "nut_mass_kg");
    let mass = |row: &str| row.split(',').nth(column.expect("there")).expect("cell").parse::<f64>();
    let masses: Vec<_> = table.lines().skip(1).map(|row| mass(row).expect("a number")).collect();
    assert!(masses.is_sorted());
}

/// Regression test: earlier versions printed "thrust of NaN N" in the jamming report, calculated a
/// life of 0 for a load spectrum of 1e300 N, and returned NaN as the first value of a grid over the
/// whole range of doubles.
#[test]
fn messages_and_results_do_not_contain_nan() {
    let dir = folder();
    fs::write(dir.path().join("loads.csv"), "force_N,feed_m_min,share\n1e300,1,1\n")
        .expect("cycle");
    let axis = ["axis", &example("axis.json"), "--cycle", "loads.csv"];
    assert_exit_and_message(&run(&axis, dir.path()), 2, "the ball forces are not balanced");
    let loads = ["--set=axial_load_N=1e300", "--set=screw_speed_rpm=100", "--show=ratings"];
    let nut = example("nut.json");
    let ratings = [&["solve", &nut], &loads[..]].concat();
    assert_exit_and_message(
        &run(&ratings, dir.path()),
        2,
        "is outside the range of double precision",
    );
    let dong = example("dong2020.json");
    for setting in [
        "return_stiffness_N_um15=1e308",
        "step_normal_force_N=1e308",
        "return_approach_speed_m_s=1e200",
        "return_approach_speed_m_s=1e-200",
        "lubricant_density_kg_m3=1e308",
        "loaded_balls_per_turn=1e308",
    ] {
        let output = run(&["solve", &dong, "--show", "jam", "--set", setting], dir.path());
        let text = stdout(&output) + &stderr(&output);
        assert!(matches!(output.status.code(), Some(0 | 2 | 3)), "{setting}: {text}");
        assert!(!text.contains("NaN") && !text.contains("inf"), "{setting}: {text}");
    }
    let vary = "--vary=screw_speed_rpm=-1e308:1e308:3";
    let args = ["sweep", &dong, vary, "-o-", "--columns=efficiency"];
    let table = stdout(&run(&args, dir.path()));
    let first: Vec<_> = table.lines().skip(1).map(|row| row.split(',').next()).collect();
    assert_eq!(first, [Some("-1e+308"), Some("0"), Some("1e+308")], "{table}");
}

/// Regression test: a control character in a description was printed on the terminal and made the
/// plot invalid.
#[test]
fn control_characters_of_an_input_are_written_to_neither_terminal_nor_plot() {
    let dir = folder();
    let text = fs::read_to_string(example("feed_drive.json")).expect("an example");
    let start = text.find("\"description\": \"").expect("has one") + 16;
    let end = start + text[start..].find('"').expect("ends");
    let evil = r"red \u001b[31m bell \u0007 nul \u0000 turned \u202e <b>&\ufffe";
    let case = format!("{}{evil}{}", &text[..start], &text[end..]);
    fs::write(dir.path().join("evil.json"), case).expect("case");
    for more in ["--show=motion", "--model=all", "--show=slip", "--show=jam"] {
        let output = run(&["solve", "evil.json", more], dir.path());
        let text = stdout(&output);
        assert!(text.starts_with("red \\u{1b}[31m bell \\u{7} nul \\u{0}"), "{more}: {text}");
        assert!(!text.contains(|c: char| c == '\u{202e}' || (c.is_control() && c != '\n')));
    }
    let named = run(&["solve", "no\u{1b}[31m.json"], dir.path());
    assert_exit_and_message(&named, 1, "cannot read no\\u{1b}[31m.json: No such file");
    let args = ["sweep", "evil.json", "--vary=axial_load_N=100:9000:9", "-o", "x.csv"];
    let output = run(&[&args[..], &["-o", "x.svg"]].concat(), dir.path());
    assert_exit_and_message(&output, 0, "");
    let svg = fs::read_to_string(dir.path().join("x.svg")).expect("plot");
    let svg = roxmltree::Document::parse(&svg).expect("well-formed XML");
    let texts: String = svg.descendants().filter_map(|node| node.text()).collect();
    assert!(texts.contains("<b>&") && texts.contains("[31m"), "{texts}");
}

/// Regression test: one row of the output contained numbers in two formats, 10000000000000000000000
/// and 3.18e19.
#[test]
fn numbers_in_a_row_have_a_uniform_format() {
    let dir = folder();
    let args =
        ["sweep", &example("feed_drive.json"), "--points", "-", "--model=closed-form", "-o-"];
    let rows = "axial_load_N,loaded_balls\n1e22,8\n0.000001,4\n";
    let table = stdout(&bsm(dir.path(), &args, rows));
    let cells: Vec<_> = table.lines().skip(1).flat_map(|row| row.split(',')).collect();
    assert!(
        cells.starts_with(&["1e+22", "8", "closed-form"]) && cells.contains(&"1e-6"),
        "{table}"
    );
    for cell in cells.iter().filter(|cell| cell.parse::<f64>().is_ok()) {
        let digits = cell.trim_start_matches('-').len();
        assert!(digits <= 24 && !cell.ends_with(".0"), "{cell}");
    }
    let exponents = cells.iter().filter(|cell| cell.contains('e') && cell.parse::<f64>().is_ok());
    for cell in exponents {
        let size = cell.parse::<f64>().expect("a number").abs();
        assert!(!(1e-5..1e16).contains(&size), "{cell}");
    }
}

/// Regression test: the program printed rounding errors, such as a friction direction of 3.3562e-13
/// deg and a spin of 3.5594e-14 rad/s, instead of zero.
#[test]
fn rounding_errors_are_not_printed_as_results() {
    let dir = folder();
    for show in ["motion", "slip", "jam"] {
        let args = ["solve", &example("feed_drive.json"), "--show", show];
        let text = stdout(&run(&args, dir.path()));
        let tiny = text.split_whitespace().filter(|word| {
            let value = word.parse::<f64>().map_or(0.0, f64::abs);
            // The residual and the power differences may be below 1e-11, because they consist only
            // of rounding errors.
            value > 0.0 && value < 1e-11
        });
        let by_nature = |line: &&str| line.starts_with("status") || line.contains("difference");
        let by_nature: String = text.lines().filter(by_nature).collect();
        let tiny: Vec<_> = tiny.filter(|word| !by_nature.contains(word)).collect();
        assert!(tiny.is_empty(), "{show}: {tiny:?} in\n{text}");
    }
    // In JSON output, numbers must keep all their digits, even if they are only rounding errors.
    let json = stdout(&run(&["solve", &example("feed_drive.json"), "--json"], dir.path()));
    let spin = json.lines().find(|line| line.contains("\"screw_spin_rad_s\":")).expect("there");
    assert!(spin.contains("e-"), "{spin}");
}

/// Regression test: while the program waited for standard input, it did not handle the first
/// interrupt until more input arrived. When a second interrupt ended the program, it left its
/// temporary file behind.
#[test]
fn an_interrupt_is_handled_while_waiting_for_input() {
    let dir = folder();
    let args = [
        "sweep",
        &example("feed_drive.json"),
        "--points",
        "-",
        "--model=closed-form",
        "-o",
        "x.csv",
    ];
    let mut child = program(&args, dir.path()).stdin(Stdio::piped()).spawn().expect("starts");
    let mut stdin = child.stdin.take().expect("piped");
    let rows = "axial_load_N\n".to_owned() + &"2000\n".repeat(70_000);
    stdin.write_all(rows.as_bytes()).expect("it reads");
    wait_for(|| count_unfinished_files(dir.path()) == 1);
    send_signal(&child, "-INT");
    assert_exit_and_message(&child.wait_with_output().expect("ends"), 130, "interrupted");
    assert!(file_names(dir.path()).is_empty());
}

#[test]
fn concurrent_runs_do_not_mix_their_output() {
    let dir = folder();
    let first = long_sweep(dir.path(), "parts/");
    let parts = dir.path().join("parts");
    let tmp = parts.join("tmp");
    let begun = || parts.join("plan.json").exists() && !file_names(&tmp).is_empty();
    wait_for(|| tmp.is_dir() && begun());
    let drive = example("feed_drive.json");
    for (more, part) in [
        ("--resume", "parts/ holds the parts of another task, which differs in: points"),
        ("--quiet", "parts/ holds the parts of another task; continue with --resume"),
    ] {
        let args = ["sweep", &drive, "--vary=axial_load_N=1:9:3", more, "-o", "parts/"];
        assert_exit_and_message(&run(&args, dir.path()), 2, part);
    }
    assert_eq!(file_names(&tmp).len(), 1, "the file of the first is still there");
    send_signal(&first, "-INT");
    assert_exit_and_message(&first.wait_with_output().expect("ends"), 130, "interrupted");
    assert_eq!(file_names(&parts), ["data", "plan.json", "tmp"]);
    assert!(file_names(&tmp).is_empty() && file_names(&parts.join("data")).is_empty());

    // If several processes write to the same file, the file must finally contain the complete table
    // of the process that finished last.
    let sweep = |count: &str| {
        let vary = format!("--vary=axial_load_N=100:9000:{count}");
        let args = ["sweep", &drive, &vary, "--model=rigid", "-o", "both.csv"];
        program(&args, dir.path()).spawn().expect("the program starts")
    };
    for child in [sweep("3000"), sweep("3001")] {
        assert_exit_and_message(&child.wait_with_output().expect("ends"), 0, "");
    }
    let text = fs::read_to_string(dir.path().join("both.csv")).expect("table");
    let last = text.lines().last().expect("a row");
    assert!([3001, 3002].contains(&text.lines().count()) && last.starts_with("9000,"), "{last}");
    assert_eq!(file_names(dir.path()), ["both.csv", "parts"]);
}

#[test]
fn file_names_need_not_be_utf8() {
    let dir = folder();
    let name = |ending: &str| {
        let mut name = b"caf\xe9".to_vec();
        name.extend_from_slice(ending.as_bytes());
        PathBuf::from(OsStr::from_bytes(&name))
    };
    let run = |args: &[&OsStr]| run(args, dir.path());
    fs::copy(example("feed_drive.json"), dir.path().join(name(".json"))).expect("copy");
    fs::write(dir.path().join(name(".csv")), "axial_load_N\n2000\n").expect("points");
    let (case, points, out, parts) = (name(".json"), name(".csv"), name("2.parquet"), name("/"));
    let os = OsStr::new;
    assert_exit_and_message(&run(&[os("solve"), case.as_os_str()]), 0, "");
    for output in [&out, &parts] {
        let args =
            [case.as_os_str(), os("--points"), points.as_os_str(), os("-o"), output.as_os_str()];
        assert_exit_and_message(&run(&[&[os("sweep")][..], &args].concat()), 0, "");
    }
    let missing = run(&[os("solve"), name(".gone").as_os_str()]);
    assert_exit_and_message(&missing, 1, "cannot read caf\u{fffd}.gone: No such file");
    assert_eq!(
        run(&[os("solve"), case.as_os_str(), os("--set"), out.as_os_str()]).status.code(),
        Some(2)
    );
    assert_eq!(fs::read_dir(dir.path()).expect("folder").count(), 4);
}

/// Tables written by other programs must be solved, or rejected with a message that states the
/// reason.
#[test]
fn tables_written_by_other_programs_are_solved_or_rejected() {
    let dir = folder();
    let utf16 = |text: &str| text.encode_utf16().flat_map(u16::to_le_bytes).collect::<Vec<u8>>();
    let marked = [&b"\xff\xfe"[..], &utf16("axial_load_N\n2000\n")].concat();
    let header = format!("{}axial_load_N\n", "model,".repeat(1_000_000));
    let row = format!("{}2000\n", "a,".repeat(1_000_000));
    let unknown = format!("{}axial_load_N\n", "x,".repeat(1_000_000));
    let long = format!("{}\n1\n", "x".repeat(1_000_000));
    let key = format!("{{\"{}\": 1}}\n", "x".repeat(1_000_000));
    let quote = format!("id,axial_load_N\n\"1,2000\n{}", "2,3000\n".repeat(3));
    let deep = "{\"lead_mm\":".repeat(100_000);
    for (name, bytes, code, part) in [
        ("bom.csv", &b"\xef\xbb\xbfaxial_load_N\n2000\n"[..], 0, ""),
        ("bom.jsonl", b"\xef\xbb\xbf{\"axial_load_N\": 2000}\n", 0, ""),
        ("crlf.csv", b"axial_load_N\r\n2000\r\n", 0, ""),
        ("crlf.jsonl", b"{\"axial_load_N\": 2000}\r\n\r\n", 0, ""),
        ("header.csv", b"axial_load_N\n", 0, ""),
        ("wide.csv", (header + &row).as_bytes(), 0, ""),
        ("wide-unknown.csv", unknown.as_bytes(), 2, "column `x` is not an input"),
        ("long-name.csv", long.as_bytes(), 2, "xxx…` is not an input; remove it"),
        ("long-key.jsonl", key.as_bytes(), 2, "xxx…` is not an input; remove it"),
        (
            "semicolons.csv",
            b"axial_load_N;lead_mm\n2000,5;10\n",
            2,
            "separated by `;`, but the expected separator is",
        ),
        (
            "tabs.csv",
            b"axial_load_N\tlead_mm\n2000\t10\n",
            2,
            "separated by `\\t`, but the expected separator is",
        ),
        ("utf16.csv", &marked, 2, "line 1 contains a NUL byte; save the table as UTF-8 text"),
        ("utf16-unmarked.csv", &utf16("axial_load_N\n2\n"), 2, "line 1 contains a NUL byte; save"),
        ("utf16.jsonl", &marked, 2, "line 1 contains a NUL byte; save"),
        ("latin1.csv", b"axial_load_N,model\n1,a\n2,M\xfcller\n", 2, "line 3 is not UTF-8 text"),
        ("latin1.jsonl", b"{\"axial_load_N\": \"\xfc\"}\n", 2, "line 1 is not UTF-8 text; save"),
        ("nul.csv", b"axial_load_N\n2000\x00\n", 2, "line 2 contains a NUL byte; save"),
        (
            "empty.csv",
            b"",
            2,
            "the table is empty; the first row must contain the names of the columns",
        ),
        (
            "empty.jsonl",
            b"\n \n",
            2,
            "the table is empty; the first row must contain the names of the columns",
        ),
        ("empty.parquet", b"", 2, "not a Parquet table"),
        (
            "damaged.parquet",
            include_bytes!("../../../../fuzz/corpus/parquet/damaged-levels.parquet"),
            2,
            "not a Parquet table: it is damaged",
        ),
        ("twice.csv", b"axial_load_N,axial_load_N\n1,2\n", 2, "`axial_load_N` appears twice"),
        ("twice.jsonl", b"{\"axial_load_N\": 1, \"axial_load_N\": 2}\n", 2, "is given twice"),
        (
            "ragged.csv",
            b"axial_load_N,model\n1,a\n2\n",
            2,
            "line 3 has 1 cells, but the table has 2",
        ),
        ("quote.csv", quote.as_bytes(), 2, "line 2: a quoted cell does not end on its line"),
        ("blank.csv", b"axial_load_N\n1\n\n2000\n", 2, "line 3 is blank; remove it"),
        ("deep.jsonl", deep.as_bytes(), 2, "line 1: is not valid JSON: recursion"),
    ] {
        fs::write(dir.path().join(name), bytes).expect("table");
        let drive = example("feed_drive.json");
        let args = ["sweep", &drive, "--points", name, "--model=closed-form", "-o-"];
        let keep = if name == "quote.csv" { "--keep=id" } else { "--quiet" };
        let output = run(&[&args[..], &[keep]].concat(), dir.path());
        assert_exit_and_message(&output, code, part);
        let text = stderr(&output);
        let names_file = |line: &str| line.starts_with(&format!("error: {name}: "));
        assert!(code == 0 || lines_without_notes(&text).next().is_some_and(names_file), "{text}");
        let rows =
            stdout(&output).lines().filter(|row| row.starts_with("2000,closed-form")).count();
        assert_eq!(rows, usize::from(code == 0 && name != "header.csv"), "{name}");
    }
    // A quoted number with a decimal comma must be read as a single cell, and its row must report
    // that the cell is invalid.
    let args = ["sweep", &example("feed_drive.json"), "--points", "-", "-o-"];
    let output = bsm(dir.path(), &args, "axial_load_N\n\"2000,5\"\n");
    assert!(stdout(&output).contains("is `2000,5`, but must be a number"), "{}", stdout(&output));
}

/// Locale, terminal, home folder and temporary folder must not affect answers.
#[test]
fn results_do_not_depend_on_environment_variables() {
    let dir = folder();
    let drive = example("feed_drive.json");
    let args = ["solve", &drive, "--show", "sensitivities"];
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
    assert_exit_and_message(&help("1"), 0, "");
    let vary = "--vary=axial_load_N=1:9:3";
    let sweep = |more: &[&str]| {
        let args =
            [&["sweep", &drive, vary, "-o", "x.csv", "--model=closed-form"][..], more].concat();
        program(&args, dir.path()).env_clear().env("TMPDIR", "/no/such").output().expect("runs")
    };
    assert_exit_and_message(&sweep(&["--threads=1024"]), 0, "");
    for threads in ["0", "-1", "1025", "99999999999999999999", "many"] {
        let output = sweep(&[&format!("--threads={threads}")]);
        assert_eq!(output.status.code(), Some(2), "{threads}");
        assert!(stderr(&output).contains("a whole number from 1 to 1024"), "{}", stderr(&output));
    }
    let mut command = program(&["solve", &drive], dir.path());
    let output = command.env("RAYON_NUM_THREADS", "100000").output().expect("the program runs");
    assert_exit_and_message(&output, 2, "RAYON_NUM_THREADS must be a whole number from 1 to 1024");
}
