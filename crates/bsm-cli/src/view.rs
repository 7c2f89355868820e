//! `bsm view`: one screw in the browser.

use std::path::PathBuf;

use bsm_batch::Workers;
use bsm_view::{Save, Server, saved};

use crate::args::ViewArgs;
use crate::failure::{Failure, note_unused, warn};
use crate::files::{ending_of, keep, print, read_scene, write};

pub(crate) fn run(args: &ViewArgs, workers: &Workers<'_>) -> Result<(), Failure> {
    let scene = args.scene.read()?;
    let in_file = args.scene.failure();
    let settings = args.model.settings().map_err(in_file)?;
    let ending = args.output.as_deref().map(|path| ending_of("-o", path, &["html", "json"]));
    let is_page = ending.transpose()? == Some("html");
    if is_page && (args.open || args.port != 0) {
        let text = "--open and --port are of the server, which -o PAGE.html does not start";
        return Err(Failure::Input(text.to_owned()));
    }
    // Unsolvable input is an error here, not in the browser.
    scene.problem(&settings).map_err(in_file)?;
    note_unused(scene.given());
    let mut beside = Vec::new();
    for path in &args.beside {
        let other = read_scene(Some(path), &[])?;
        other.problem(&settings).map_err(|error| Failure::scene(path, &error))?;
        beside.push(other);
    }
    if let Some(path) = args.output.as_deref().filter(|_| is_page) {
        keep(args.scene.path(), Some(path))?;
        let page = saved(&scene, &beside, &settings, workers)
            .map_err(|refusal| Failure::in_scene(args.scene.path(), &refusal.to_string()))?;
        return write(path, &page);
    }
    let save = args.output.clone().map(saver);
    let server = Server::start(args.port, &scene, &beside, &settings, save)
        .map_err(|error| Failure::Files(error.to_string()))?;
    let address = server.address();
    print(&address)?;
    warn("note", "the page is for this machine only; Ctrl-C ends it");
    if args.open
        && let Err(error) = opener::open_browser(&address)
    {
        warn("note", &format!("cannot start a browser: {error}; open the address above"));
    }
    server.serve();
    Ok(())
}

/// Writes a scene to the path that was given, as other files are written.
fn saver(path: PathBuf) -> Save {
    Box::new(move |text| write(&path, text).map_err(|failure| failure.to_string()))
}
