//! Names of the files in a dataset folder, and functions that create and remove these files.

use std::fs::{self, File};
use std::io::{self, ErrorKind, Read};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use super::DatasetError;
use super::error::describe_entry;

/// Name of the file that contains the plan of a dataset.
const PLAN: &str = "plan.json";
/// Name of the folder that contains the finished parts.
const DATA: &str = "data";
/// Name of the folder that contains unfinished files under temporary names.
const UNFINISHED: &str = "tmp";
/// Name of the file that lists the parts.
const LIST: &str = "parts.parquet";
/// Name of the file that older versions of the program wrote instead of a plan.
const OLD_PLAN: &str = "parts.json";

/// Number of random letters at the end of a temporary file name.
const RANDOM_LETTERS: usize = 8;

/// Number of letters of the plan id in a temporary file name.
const ID_LETTERS: usize = 12;

/// A function that creates a temporary file. The function registers the file before it creates the
/// file, so that the file is removed if the program is interrupted.
pub type MakeTemporary =
    fn(&mut dyn FnMut() -> io::Result<NamedTempFile>) -> io::Result<NamedTempFile>;

/// The folder of a dataset.
#[derive(Debug)]
pub(super) struct Folder {
    pub(super) path: PathBuf,
    make: MakeTemporary,
}

impl Folder {
    pub(super) fn new(path: &Path, make: MakeTemporary) -> Self {
        Self { path: path.to_owned(), make }
    }

    /// Returns the path of the plan file.
    pub(super) fn plan(&self) -> PathBuf {
        self.path.join(PLAN)
    }

    /// Returns the path of the file of a part.
    pub(super) fn part(&self, number: u64) -> PathBuf {
        self.path.join(DATA).join(format!("part-{number:06}.parquet"))
    }

    /// Returns the path of the file that lists the parts.
    pub(super) fn list(&self) -> PathBuf {
        self.path.join(LIST)
    }

    /// Returns all entries of the data folder. The list is empty if the data folder does not exist.
    pub(super) fn data(&self) -> Result<Vec<fs::DirEntry>, DatasetError> {
        match entries(&self.path.join(DATA)) {
            Err(DatasetError::Io { error, .. }) if error.kind() == ErrorKind::NotFound => {
                Ok(vec![])
            }
            found => found,
        }
    }

    /// Reads the text of the plan file. If the entry with this name is not a file but, for example,
    /// a folder, it is rejected without being read.
    pub(super) fn read_plan(&self) -> Result<String, DatasetError> {
        /// Maximum length of a plan file \[B\], which is sufficient for grid axes with a million
        /// values.
        const MAX_PLAN_BYTES: u64 = 64 << 20;
        let path = self.plan();
        let unreadable = |error| DatasetError::io("read", &path, error);
        let not_a_plan = |why: String| DatasetError::NotAPlan { path: path.clone(), why };
        let found = fs::metadata(&path).map_err(unreadable)?;
        if !found.is_file() {
            return Err(not_a_plan(format!("it is {}", describe_entry(&found))));
        }
        let mut text = Vec::new();
        let file = File::open(&path).map_err(unreadable)?;
        file.take(MAX_PLAN_BYTES).read_to_end(&mut text).map_err(unreadable)?;
        if text.is_empty() {
            return Err(not_a_plan("it is empty".to_owned()));
        }
        String::from_utf8(text).map_err(|_| not_a_plan("it is damaged".to_owned()))
    }

    /// Creates the dataset folder. An existing folder is rejected if it contains anything other
    /// than empty subfolders and temporary files of a dataset.
    pub(super) fn create(&self) -> Result<(), DatasetError> {
        // Collecting the components removes a trailing path separator, which would make
        // `is_symlink` follow a symbolic link.
        let named: PathBuf = self.path.components().collect();
        if named.is_symlink() && !named.exists() {
            let path = self.path.display();
            let what = format!("{path} is a broken link; remove the link or use another name");
            return Err(DatasetError::Refused(what));
        }
        fs::create_dir_all(&self.path)
            .map_err(|e| DatasetError::io("make folder", &self.path, e))?;
        if self.path.join(OLD_PLAN).exists() {
            return Err(DatasetError::Refused(format!(
                "{} holds the parts of an older version of bsm ({OLD_PLAN}), which this version cannot continue; use \
                 another folder",
                self.path.display()
            )));
        }
        // Empty subfolders and temporary files may be left over from a run that was killed shortly
        // after its start, so they are accepted.
        for entry in entries(&self.path)? {
            let name = entry.file_name();
            let is_folder = entry.file_type().is_ok_and(|found| found.is_dir());
            let within = || entries(&entry.path());
            let own = match name.to_str() {
                Some(DATA) if is_folder => within()?.is_empty(),
                Some(UNFINISHED) if is_folder => {
                    within()?.iter().all(|e| unfinished_id(e).is_some())
                }
                _ => false,
            };
            if !own {
                let path = self.path.display();
                let what = format!(
                    "{path} is a folder that contains other files; use a new or empty folder"
                );
                return Err(DatasetError::Refused(what));
            }
        }
        self.make_folders()
    }

    /// Creates the subfolders for parts and temporary files.
    pub(super) fn make_folders(&self) -> Result<(), DatasetError> {
        for name in [UNFINISHED, DATA] {
            let path = self.path.join(name);
            fs::create_dir_all(&path).map_err(|e| DatasetError::io("make folder", &path, e))?;
        }
        Ok(())
    }

    /// Creates a temporary file for a plan. The file is removed automatically unless it is later
    /// renamed.
    pub(super) fn unfinished(
        &self,
        name: &Path,
        plan: &str,
    ) -> Result<NamedTempFile, DatasetError> {
        let folder = self.path.join(UNFINISHED);
        let stem = name.file_stem().unwrap_or_default().to_string_lossy();
        let prefix = format!("{stem}.{}.", &plan[..ID_LETTERS]);
        let mut builder = tempfile::Builder::new();
        builder.prefix(&prefix).rand_bytes(RANDOM_LETTERS);
        // By default, only the owner can read a temporary file. Files with results should have the
        // permissions that the umask allows.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        (self.make)(&mut || builder.tempfile_in(&folder))
            .map_err(|e| DatasetError::io("write in folder", &folder, e))
    }

    /// Removes the temporary files of the plan with the given id.
    pub(super) fn remove_temporary_files(&self, plan: &str) -> Result<(), DatasetError> {
        for entry in entries(&self.path.join(UNFINISHED))? {
            let ours = unfinished_id(&entry).is_some_and(|id| plan.starts_with(&id));
            if ours
                && let Err(error) = fs::remove_file(entry.path())
                && error.kind() != ErrorKind::NotFound
            {
                return Err(DatasetError::io("remove", &entry.path(), error));
            }
        }
        Ok(())
    }
}

/// Gives a complete temporary file its final name. The function returns after the file has been
/// written to disk, so that the file survives a power failure.
///
/// * `replace`: if true, an existing file with this name is replaced; if false, an existing file is
///   an error.
pub(super) fn complete(file: NamedTempFile, name: &Path, replace: bool) -> io::Result<()> {
    file.as_file().sync_all()?;
    if replace { file.persist(name) } else { file.persist_noclobber(name) }.map_err(|e| e.error)?;
    match name.parent() {
        Some(folder) if cfg!(unix) => File::open(folder)?.sync_all(),
        // Only Unix can open a folder and synchronize it to disk.
        _ => Ok(()),
    }
}

fn entries(folder: &Path) -> Result<Vec<fs::DirEntry>, DatasetError> {
    fs::read_dir(folder)
        .and_then(Iterator::collect)
        .map_err(|e| DatasetError::io("read folder", folder, e))
}

/// Returns the plan id in the name of a temporary file, or `None` if [`Folder::unfinished`] cannot
/// have created this name.
fn unfinished_id(entry: &fs::DirEntry) -> Option<String> {
    let name = entry.file_name().into_string().ok()?;
    let [what, id, random] = name.split('.').collect::<Vec<_>>()[..] else { return None };
    let part = what.strip_prefix("part-").is_some_and(|n| n.parse::<u64>().is_ok());
    let ours = (part || ["plan", "parts"].contains(&what))
        && id.len() == ID_LETTERS
        && id.bytes().all(|b| b.is_ascii_hexdigit())
        && random.len() == RANDOM_LETTERS
        && entry.file_type().is_ok_and(|found| found.is_file());
    ours.then(|| id.to_owned())
}
