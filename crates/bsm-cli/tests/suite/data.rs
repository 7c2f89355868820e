//! Copies of the published data that a test may modify.

use std::fs;
use std::path::{Path, PathBuf};

/// Copies the published data to `folder/data` and returns the path of the copy.
pub(crate) fn copy_published(folder: &Path) -> PathBuf {
    let published = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../validation/published");
    let data = folder.join("data");
    fs::create_dir_all(&data).expect("a folder");
    for source in fs::read_dir(published).expect("sources") {
        let source = source.expect("a source");
        let to = data.join(source.file_name());
        if source.path().is_file() {
            fs::copy(source.path(), to).expect("a copy");
            continue;
        }
        fs::create_dir_all(&to).expect("a folder");
        for file in fs::read_dir(source.path()).expect("data") {
            let file = file.expect("a file");
            fs::copy(file.path(), to.join(file.file_name())).expect("a copy");
        }
    }
    data
}
