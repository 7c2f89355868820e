//! The layout of a folder, and how its files come and go.

use std::fs::{self, File};
use std::io::{self, ErrorKind, Read};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use super::DatasetError;
use super::part::kind;

/// Names in a folder.
const PLAN: &str = "plan.json";
const DATA: &str = "data";
const UNFINISHED: &str = "tmp";
const LIST: &str = "parts.parquet";
/// What older versions wrote in place of a plan.
const OLD_PLAN: &str = "parts.json";

/// Letters at the end of the name of an unfinished file, and of the id of the plan in it.
const RANDOM: usize = 8;
const SHORT_ID: usize = 12;

/// Makes an unfinished file. A program that is interrupted makes it known before, so that it is removed.
pub type MakeTemporary =
    fn(&mut dyn FnMut() -> io::Result<NamedTempFile>) -> io::Result<NamedTempFile>;

/// A folder of parts.
#[derive(Debug)]
pub(super) struct Folder {
    pub(super) path: PathBuf,
    make: MakeTemporary,
}

impl Folder {
    pub(super) fn new(path: &Path, make: MakeTemporary) -> Self {
        Self { path: path.to_owned(), make }
    }

    /// Where the plan is.
    pub(super) fn plan(&self) -> PathBuf {
        self.path.join(PLAN)
    }

    /// Where a part is once it is finished.
    pub(super) fn part(&self, number: u64) -> PathBuf {
        self.path.join(DATA).join(format!("part-{number:06}.parquet"))
    }

    /// Where the list of the parts is.
    pub(super) fn list(&self) -> PathBuf {
        self.path.join(LIST)
    }

    /// Files among the parts; none without their folder.
    pub(super) fn data(&self) -> Result<Vec<fs::DirEntry>, DatasetError> {
        match entries(&self.path.join(DATA)) {
            Err(DatasetError::Io { error, .. }) if error.kind() == ErrorKind::NotFound => {
                Ok(vec![])
            }
            found => found,
        }
    }

    /// The text of the plan: what cannot be one is not read.
    pub(super) fn read_plan(&self) -> Result<String, DatasetError> {
        /// Longest plan \[B\], with axes of a million values.
        const LONGEST: u64 = 64 << 20;
        let path = self.plan();
        let unreadable = |error| DatasetError::io("read", &path, error);
        let not_a_plan = |why: String| DatasetError::NotAPlan { path: path.clone(), why };
        let found = fs::metadata(&path).map_err(unreadable)?;
        if !found.is_file() {
            return Err(not_a_plan(format!("it is {}", kind(&found))));
        }
        let mut text = Vec::new();
        let file = File::open(&path).map_err(unreadable)?;
        file.take(LONGEST).read_to_end(&mut text).map_err(unreadable)?;
        if text.is_empty() {
            return Err(not_a_plan("it is empty".to_owned()));
        }
        String::from_utf8(text).map_err(|_| not_a_plan("it is damaged".to_owned()))
    }

    /// Makes the folder, unless something else is in it.
    pub(super) fn begin(&self) -> Result<(), DatasetError> {
        // A slash at the end would follow the link.
        let named: PathBuf = self.path.components().collect();
        if named.is_symlink() && !named.exists() {
            let path = self.path.display();
            let what = format!("{path} is a link to nothing; remove it or take another name");
            return Err(DatasetError::Refused(what));
        }
        fs::create_dir_all(&self.path)
            .map_err(|e| DatasetError::io("make folder", &self.path, e))?;
        if self.path.join(OLD_PLAN).exists() {
            return Err(DatasetError::Refused(format!(
                "{} holds the parts of an older version of bsm ({OLD_PLAN}), which this one cannot continue; take \
                 another folder",
                self.path.display()
            )));
        }
        // A run that was killed in its first moments leaves empty folders and unfinished files.
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
                let what = format!("{path} is a folder with something else in it");
                return Err(DatasetError::Refused(what));
            }
        }
        self.make_folders()
    }

    /// Makes the folders in the folder.
    pub(super) fn make_folders(&self) -> Result<(), DatasetError> {
        for name in [UNFINISHED, DATA] {
            let path = self.path.join(name);
            fs::create_dir_all(&path).map_err(|e| DatasetError::io("make folder", &path, e))?;
        }
        Ok(())
    }

    /// An unfinished file of a plan, which is removed unless it gets its name.
    pub(super) fn unfinished(
        &self,
        name: &Path,
        plan: &str,
    ) -> Result<NamedTempFile, DatasetError> {
        let folder = self.path.join(UNFINISHED);
        let stem = name.file_stem().unwrap_or_default().to_string_lossy();
        let prefix = format!("{stem}.{}.", &plan[..SHORT_ID]);
        let mut builder = tempfile::Builder::new();
        builder.prefix(&prefix).rand_bytes(RANDOM);
        // Temporary files are private; a result gets what the user's mask leaves of 0666.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        (self.make)(&mut || builder.tempfile_in(&folder))
            .map_err(|e| DatasetError::io("write in folder", &folder, e))
    }

    /// Removes unfinished files of a plan.
    pub(super) fn tidy(&self, plan: &str) -> Result<(), DatasetError> {
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

/// Gives a file that is complete its name, so that it lasts through a loss of power.
///
/// * `replace`: whether a file of that name is replaced; it is an error otherwise.
pub(super) fn complete(file: NamedTempFile, name: &Path, replace: bool) -> io::Result<()> {
    file.as_file().sync_all()?;
    if replace { file.persist(name) } else { file.persist_noclobber(name) }.map_err(|e| e.error)?;
    match name.parent() {
        Some(folder) if cfg!(unix) => File::open(folder)?.sync_all(),
        // Elsewhere folders cannot be opened.
        _ => Ok(()),
    }
}

fn entries(folder: &Path) -> Result<Vec<fs::DirEntry>, DatasetError> {
    fs::read_dir(folder)
        .and_then(Iterator::collect)
        .map_err(|e| DatasetError::io("read folder", folder, e))
}

/// The id in the name of an unfinished file, if it has the form that [`Folder::unfinished`] gives it.
fn unfinished_id(entry: &fs::DirEntry) -> Option<String> {
    let name = entry.file_name().into_string().ok()?;
    let [what, id, random] = name.split('.').collect::<Vec<_>>()[..] else { return None };
    let part = what.strip_prefix("part-").is_some_and(|n| n.parse::<u64>().is_ok());
    let ours = (part || ["plan", "parts"].contains(&what))
        && id.len() == SHORT_ID
        && id.bytes().all(|b| b.is_ascii_hexdigit())
        && random.len() == RANDOM
        && entry.file_type().is_ok_and(|found| found.is_file());
    ours.then(|| id.to_owned())
}
