//! Standard output, case files, and output files. Output files become visible only when they are
//! complete.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, BufWriter, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

use bsm_case::{Case, CaseError, column_names};
use serde_json::Value;
use tempfile::NamedTempFile;

use crate::console::print_message;
use crate::failure::Failure;
use crate::unfinished;

/// Prefix of temporary file names. The prefix is followed by part of the final name and by
/// [`RANDOM`] characters.
const TEMPORARY: &str = ".bsm-";

/// Number of random letters and digits at the end of a temporary file name.
const RANDOM: usize = 16;

/// Maximum number of characters of the final file name that the temporary file name repeats. The
/// limit keeps temporary file names shorter than 255 bytes, the maximum length of a file name.
const REPEATED: usize = 40;

/// Maximum size of a case, a requirement or a list of sizes \[B\]. Typical files have a few kB.
const MAX_JSON_BYTES: u64 = 1 << 20;

/// Maximum size of a load cycle or a table of nuts \[B\]. This is enough for about a million rows.
pub(crate) const MAX_TABLE_BYTES: u64 = 16 << 20;

/// Prints a text and a newline to standard output.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    write(Path::new("-"), &format!("{}\n", text.trim_end()))
}

/// Formats a JSON value as indented text.
pub(crate) fn pretty_json(value: &Value) -> String {
    format!("{value:#}")
}

/// Reads a JSON file, or standard input if the path is `-`.
pub(crate) fn read_json(path: &Path) -> Result<Vec<u8>, Failure> {
    read(path, MAX_JSON_BYTES)
}

/// Reads a file, or standard input if the path is `-`. Returns an error after `most` bytes, because
/// a device or a pipe may be endless.
pub(crate) fn read(path: &Path, most: u64) -> Result<Vec<u8>, Failure> {
    let mut bytes = Vec::new();
    let (read, shown) = if is_stdout(path) {
        (io::stdin().take(most + 1).read_to_end(&mut bytes), Path::new("standard input"))
    } else {
        (File::open(path).and_then(|file| file.take(most + 1).read_to_end(&mut bytes)), path)
    };
    read.map_err(|e| Failure::file_operation("read", shown, &e))?;
    if bytes.len() as u64 > most {
        let text = format!("is larger than {} MiB, the limit for this kind of file", most >> 20);
        return Err(Failure::in_case(path, &text));
    }
    Ok(bytes)
}

/// Reads the JSON file that maps the column names of a user's table to input names.
pub(crate) fn names_of_columns(path: &Path) -> Result<BTreeMap<String, Option<String>>, Failure> {
    column_names(&read_json(path)?).map_err(|e| Failure::case(path, &e))
}

/// Reads a case and applies settings. The path `-` means standard input; if there is no path, the
/// case is initially empty.
pub(crate) fn read_case(path: Option<&Path>, settings: &[String]) -> Result<Case, Failure> {
    let mut case = match path {
        Some(path) => Case::from_json(&read_json(path)?).map_err(|e| Failure::case(path, &e))?,
        None => Case::default(),
    };
    case.apply(settings).map_err(|e: CaseError| Failure::input("--set", &e))?;
    Ok(case)
}

/// Returns true if the path is `-`, which means standard input or output.
pub(crate) fn is_stdout(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Returns the feature that a file with the given extension needs, if this program was built without
/// the feature.
fn missing_feature(ending: &str) -> Option<&'static str> {
    match ending {
        "parquet" if cfg!(not(feature = "parquet")) => Some("parquet"),
        "xlsx" if cfg!(not(feature = "xlsx")) => Some("xlsx"),
        "html" | "svg" | "png" | "map.svg" | "map.png" if cfg!(not(feature = "plot")) => {
            Some("plot")
        }
        _ => None,
    }
}

/// Returns the longest of the given extensions that matches the file name, ignoring case.
pub(crate) fn ending_of(
    option: &str,
    path: &Path,
    endings: &[&'static str],
) -> Result<&'static str, Failure> {
    let name = path.file_name().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    let is_its = |ending: &&&str| {
        name.strip_suffix(**ending).is_some_and(|rest| rest.len() > 1 && rest.ends_with('.'))
    };
    let found = endings.iter().filter(is_its).max_by_key(|ending| ending.len());
    if let Some(feature) = found.and_then(|ending| missing_feature(ending)) {
        return Err(Failure::not_built(feature));
    }
    found.copied().ok_or_else(|| {
        let known: Vec<_> = endings.iter().map(|ending| format!(".{ending}")).collect();
        let (last, others) = known.split_last().expect("an ending");
        let or =
            if others.is_empty() { String::new() } else { format!("{} or ", others.join(", ")) };
        let stream =
            if endings.contains(&"csv") { "; - means CSV on standard input or output" } else { "" };
        Failure::Input(format!(
            "{option} {}: the file name must end with {or}{last}{stream}",
            path.display()
        ))
    })
}

/// Destination of an output: standard output, or a file that is renamed to its final name when it
/// is complete.
pub(crate) enum OutputFile {
    /// Standard output, a pipe or a device. Pipes and devices must not be replaced by a file.
    Stream {
        /// The standard output, pipe or device, opened for writing.
        stream: Box<dyn Write + Send>,
        /// Path of the stream; `-` for standard output.
        path: PathBuf,
    },
    /// A temporary file in the same folder as the final file.
    File {
        /// The temporary file with the contents written so far.
        file: BufWriter<NamedTempFile>,
        /// Path of the file after it has been completed.
        path: PathBuf,
    },
}

impl OutputFile {
    /// Opens standard output for the path `-`, an existing pipe or device for writing, and a
    /// temporary file otherwise.
    pub(crate) fn create(path: &Path) -> Result<Self, Failure> {
        if path.as_os_str() == "-" {
            return Ok(Self::Stream { stream: Box::new(io::stdout()), path: path.to_owned() });
        }
        let path = match fs::metadata(path) {
            Ok(found) if found.is_dir() => return Err(refused(path, "the path is a folder")),
            Ok(found) if !found.is_file() => {
                let file = File::options().write(true).open(path);
                let file = file.map_err(|e| Failure::file_operation("write", path, &e))?;
                let stream = Box::new(BufWriter::new(file));
                return Ok(Self::Stream { stream, path: path.to_owned() });
            }
            // Renaming would replace a read-only file despite its protection, so read-only files
            // are refused.
            Ok(found) if found.permissions().readonly() => {
                return Err(refused(
                    path,
                    "the file is read-only; make it writable or use another name",
                ));
            }
            // For a symbolic link, the file to which it points is replaced, and the link is kept.
            Ok(_) => {
                fs::canonicalize(path).map_err(|e| Failure::file_operation("write", path, &e))?
            }
            Err(_) if path.is_symlink() => {
                return Err(refused(
                    path,
                    "the path is a broken link; remove the link or use another name",
                ));
            }
            Err(_) => path.to_owned(),
        };
        let folder = match path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let name: String = name.chars().take(REPEATED).collect();
        let prefix = format!("{TEMPORARY}{name}-");
        let mut builder = tempfile::Builder::new();
        builder.prefix(&prefix).rand_bytes(RANDOM);
        // A new file gets the permissions that the umask allows. A temporary file that will replace
        // an existing file remains private until it gets the permissions of the existing file.
        #[cfg(unix)]
        if !path.exists() {
            builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        }
        let file = unfinished::create_temporary(&mut || builder.tempfile_in(folder))
            .map_err(|e| Failure::file_operation("write in folder", folder, &e))?;
        Ok(Self::File { file: BufWriter::new(file), path })
    }

    /// Returns the failure for an output that cannot be written.
    pub(crate) fn failure(path: &Path, error: &io::Error) -> Failure {
        if path.as_os_str() != "-" {
            Failure::file_operation("write", path, error)
        } else if error.kind() == ErrorKind::BrokenPipe {
            Failure::ClosedPipe
        } else {
            Failure::file_operation("write to", Path::new("standard output"), error)
        }
    }

    /// Flushes the output and renames a temporary file to its final name.
    pub(crate) fn complete(mut self) -> Result<(), Failure> {
        let flushed = self.flush();
        match self {
            Self::Stream { path, .. } => flushed.map_err(|e| Self::failure(&path, &e)),
            Self::File { file, path } => {
                let named = || -> io::Result<()> {
                    flushed?;
                    let file = file.into_inner().map_err(io::IntoInnerError::into_error)?;
                    copy_permissions(file.as_file(), &path)?;
                    file.as_file().sync_all()?;
                    let temporary = file.path().to_owned();
                    let mut held = unfinished::block_interrupts();
                    file.persist(&path).map_err(|e| e.error)?;
                    held.finished(&temporary);
                    Ok(())
                };
                named().map_err(|e| Self::failure(&path, &e))
            }
        }
    }

    fn out(&mut self) -> &mut dyn Write {
        match self {
            Self::Stream { stream, .. } => stream,
            Self::File { file, .. } => file,
        }
    }
}

impl Write for OutputFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        record_size_limit(self.out().write(bytes))
    }

    fn flush(&mut self) -> io::Result<()> {
        record_size_limit(self.out().flush())
    }
}

/// Sets [`unfinished::FILE_TOO_LARGE`] if a write failed because the file would have exceeded the size limit.
fn record_size_limit<T>(written: io::Result<T>) -> io::Result<T> {
    if written.as_ref().is_err_and(|e| e.kind() == ErrorKind::FileTooLarge) {
        unfinished::FILE_TOO_LARGE.store(true, Ordering::Relaxed);
    }
    written
}

/// Gives a new file the permissions, owner and group of the file that the new file replaces.
#[cfg(unix)]
fn copy_permissions(file: &File, path: &Path) -> io::Result<()> {
    use std::os::unix::fs::{MetadataExt, PermissionsExt, fchown};
    let Ok(former) = fs::metadata(path) else { return Ok(()) };
    let new = file.metadata()?;
    let owner = new.uid() == former.uid() || fchown(file, Some(former.uid()), None).is_ok();
    let group = new.gid() == former.gid() || fchown(file, None, Some(former.gid())).is_ok();
    let mut mode = former.mode() & 0o7777;
    if !group {
        // The permissions of the original group must not be granted to a different group.
        mode &= !0o2070;
    }
    if !(owner && group) {
        let kept = format!(
            "could not preserve the owner and group of {}; the file now belongs to you",
            path.display()
        );
        print_message("note", &kept);
    }
    if new.mode() & 0o7777 != mode {
        file.set_permissions(fs::Permissions::from_mode(mode))?;
    }
    Ok(())
}

/// Does nothing, because this operating system has no Unix permissions, owners and groups.
#[cfg(not(unix))]
#[expect(clippy::unnecessary_wraps, reason = "fails on Unix")]
fn copy_permissions(_: &File, _: &Path) -> io::Result<()> {
    Ok(())
}

/// Reports that the program refuses to write to a path.
pub(crate) fn refused(path: &Path, why: &str) -> Failure {
    Failure::Files(format!("cannot write {}: {why}", path.display()))
}

/// Input files of a run. The outputs of the run must not replace these files.
#[derive(Debug, Default)]
pub(crate) struct InputFiles(Vec<PathBuf>);

impl InputFiles {
    /// Collects the regular files among the paths. Standard streams, devices and pipes are left
    /// out, because writing to them destroys no data.
    pub(crate) fn of<'a>(paths: impl IntoIterator<Item = Option<&'a Path>>) -> Self {
        let files = paths.into_iter().flatten().filter(|path| path.is_file());
        Self(files.filter_map(|path| fs::canonicalize(path).ok()).collect())
    }

    /// Rejects outputs that would replace an input or each other. This check must be done before
    /// the run writes anything.
    pub(crate) fn check<'a>(
        &self,
        outputs: impl IntoIterator<Item = &'a Path>,
    ) -> Result<(), Failure> {
        let mut written = Vec::new();
        for output in outputs {
            let Some(real) = real_output(output) else { continue };
            let why = if self.0.contains(&real) {
                "is an input file and would be overwritten"
            } else if written.contains(&real) {
                "would be written twice"
            } else {
                written.push(real);
                continue;
            };
            let text = format!("{} {why}; use another name", output.display());
            return Err(Failure::Input(text));
        }
        Ok(())
    }
}

/// Returns the canonical path of an output, or `None` for standard output, devices and folders,
/// which are never replaced.
fn real_output(path: &Path) -> Option<PathBuf> {
    if is_stdout(path) || path.exists() && !path.is_file() {
        return None;
    }
    fs::canonicalize(path).ok().or_else(|| {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        let folder = fs::canonicalize(folder.unwrap_or(Path::new("."))).ok()?;
        Some(folder.join(path.file_name()?))
    })
}

/// Writes a text to a file or stream.
pub(crate) fn write(path: &Path, text: &str) -> Result<(), Failure> {
    write_bytes(OutputFile::create(path)?, path, text.as_bytes())
}

/// Writes bytes to an open output, then flushes the output or renames the temporary file.
pub(crate) fn write_bytes(mut out: OutputFile, path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    out.write_all(bytes).map_err(|e| OutputFile::failure(path, &e))?;
    out.complete()
}

/// Creates a folder and its parent folders.
pub(crate) fn make_folder(folder: &Path) -> Result<(), Failure> {
    fs::create_dir_all(folder).map_err(|e| Failure::file_operation("create folder", folder, &e))
}
