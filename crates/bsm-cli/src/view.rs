//! `bsm view`: one screw in the browser.

use std::path::PathBuf;

use bsm_batch::Workers;
use bsm_case::CaseError;
use bsm_view::{Save, Server, saved};

use crate::args::ViewArgs;
use crate::failure::{Failure, note_unused, warn};
use crate::files::{keep, print, read_scene, write};

pub(crate) fn run(args: &ViewArgs, workers: &Workers<'_>) -> Result<(), Failure> {
    let path = &args.scene.scene;
    let scene = read_scene(path, &args.scene.settings)?;
    let in_file = |e: CaseError| Failure::scene(path, &e);
    let settings = args.model.settings().map_err(in_file)?;
    // What cannot be solved is told here, not in the browser.
    scene.problem(&settings).map_err(in_file)?;
    note_unused(scene.given());
    if let Some(out) = &args.out {
        keep(path, Some(out))?;
        let page = saved(&scene, &settings, workers)
            .map_err(|refusal| Failure::in_scene(path, &refusal.to_string()))?;
        return write(out, &page);
    }
    let save = args.save.clone().map(saver);
    let server = Server::start(args.port, &scene, &settings, save)
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
