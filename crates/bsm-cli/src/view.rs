//! `bsm view`: shows one screw in the browser.

use std::path::PathBuf;

use bsm_view::{PageSolver, Save, Server, saved};

use crate::args::ViewArgs;
use crate::console::print_message;
use crate::failure::{Failure, note_unused};
use crate::files::{InputFiles, ending_of, print, write};

pub(crate) fn run(args: &ViewArgs) -> Result<(), Failure> {
    let case = args.case.read_as_given()?;
    let in_file = args.case.failure();
    let settings = args.model.settings()?;
    let ending = args.output.as_deref().map(|path| ending_of("-o", path, &["html", "json"]));
    let is_page = ending.transpose()? == Some("html");
    if is_page && (args.open || args.port != 0) {
        let text = "--open and --port cannot be combined with -o PAGE.html, which starts no server";
        return Err(Failure::Input(text.to_owned()));
    }
    // An error in the case is reported on the command line instead of in the browser.
    case.with_groove().and_then(|case| case.problem(&settings)).map_err(in_file)?;
    note_unused(case.given());
    let mut beside = Vec::new();
    for path in &args.beside {
        let other = args.case.read_other(path)?;
        let solvable = other.with_groove().and_then(|other| other.problem(&settings));
        solvable.map_err(|error| Failure::case(path, &error))?;
        beside.push(other);
    }
    // An exported page must not replace the case file. The button "Save case", however, may
    // overwrite it.
    let own = is_page.then_some(args.case.path());
    let beside_files = args.beside.iter().map(|path| Some(path.as_path()));
    InputFiles::of(beside_files.chain([own])).check(args.output.as_deref())?;
    if let Some(path) = args.output.as_deref().filter(|_| is_page) {
        return write(path, &saved(&case, &beside, &settings, &page_solver()?));
    }
    let save = args.output.clone().map(saver);
    let server = Server::start(args.port, &case, &beside, &settings, save)
        .map_err(|error| Failure::Files(error.to_string()))?;
    let address = server.address();
    print(&address)?;
    print_message("note", "the page is only available on this machine; Ctrl-C stops the server");
    if args.open
        && let Err(error) = opener::open_browser(&address)
    {
        print_message("note", &format!("cannot start a browser: {error}; open the address above"));
    }
    server.serve();
    Ok(())
}

/// Returns the solver for saved pages if it was built from the same sources as this program.
fn page_solver() -> Result<PageSolver<'static>, Failure> {
    const VERSION: &str = env!("BSM_VERSION");
    const REMEDY: &str = "Run `crates/bsm-view/page-solver` in the source tree and build bsm again, or show the page without -o";
    let text = match PageSolver::of_build() {
        Some(solver) if solver.version == VERSION => return Ok(solver),
        Some(PageSolver { version, .. }) => format!(
            "cannot write a page, because its solver was built from version {version}, and bsm from {VERSION}. {REMEDY}"
        ),
        None => format!(
            "cannot write a page, because bsm was built without the solver that pages contain. {REMEDY}"
        ),
    };
    Err(Failure::Input(text))
}

/// Returns a function that saves a case to the given path.
fn saver(path: PathBuf) -> Save {
    Box::new(move |text| write(&path, text).map_err(|failure| failure.to_string()))
}
