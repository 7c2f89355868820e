//! `bsm view`: shows one screw in the browser.

use std::path::PathBuf;

use bsm_batch::Workers;
use bsm_view::{Save, Server, saved};

use crate::args::ViewArgs;
use crate::failure::{Failure, note_unused, warn};
use crate::files::{InputFiles, ending_of, print, write};

pub(crate) fn run(args: &ViewArgs, workers: &Workers<'_>) -> Result<(), Failure> {
    let case = args.case.read_as_given()?;
    let in_file = args.case.failure();
    let settings = args.model.settings()?;
    let ending = args.output.as_deref().map(|path| ending_of("-o", path, &["html", "json"]));
    let is_page = ending.transpose()? == Some("html");
    if is_page && (args.open || args.port != 0) {
        let text = "--open and --port cannot be combined with -o PAGE.html, which starts no server";
        return Err(Failure::Input(text.to_owned()));
    }
    // An error in the case is reported here instead of in the browser.
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
        let page = saved(&case, &beside, &settings, workers)
            .map_err(|refusal| Failure::in_case(args.case.path(), &refusal.to_string()))?;
        return write(path, &page);
    }
    let save = args.output.clone().map(saver);
    let server = Server::start(args.port, &case, &beside, &settings, save)
        .map_err(|error| Failure::Files(error.to_string()))?;
    let address = server.address();
    print(&address)?;
    warn("note", "the page is only available on this machine; Ctrl-C stops the server");
    if args.open
        && let Err(error) = opener::open_browser(&address)
    {
        warn("note", &format!("cannot start a browser: {error}; open the address above"));
    }
    server.serve();
    Ok(())
}

/// Returns a function that saves a case to the given path.
fn saver(path: PathBuf) -> Save {
    Box::new(move |text| write(&path, text).map_err(|failure| failure.to_string()))
}
