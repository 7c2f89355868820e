//! Output of the commands: its contents, and the files to which it is written.

use std::path::{Path, PathBuf};

use bsm_case::{Answer, Case, DisplayUnits, printable};
use bsm_report::{Figure, figure_files, report_files};
use serde_json::{Map, Value};

use crate::args::OutArgs;
use crate::console::print_message;
use crate::failure::Failure;
use crate::files::{self, InputFiles, ending_of, is_stdout, pretty_json, print, write_bytes};
use crate::table;

/// A function that writes the table of an answer to a file.
pub(crate) type WriteTable<'a> = Box<dyn Fn(&Path) -> Result<(), Failure> + 'a>;

/// The output of a command: its answers, and everything that is needed to print them and to write
/// them to files.
#[derive(Default)]
pub(crate) struct Reply<'a> {
    /// Heading that is printed above the answer.
    pub(crate) title: Option<String>,
    /// Named answers. If there are several, each answer becomes a member of one JSON object.
    pub(crate) parts: Vec<(&'static str, Answer)>,
    /// Case that is written to the JSON file instead of the answer. The value is JSON null if the
    /// command found no case. The field is `None` if the command writes the answer.
    pub(crate) case: Option<Value>,
    /// Function that writes the table of the answer; `None` if the answer has no table.
    pub(crate) table: Option<WriteTable<'a>>,
    /// Units in which numbers are displayed on the screen.
    pub(crate) units: DisplayUnits,
    /// Answer that is printed on the screen instead of `parts`.
    pub(crate) shown: Option<Answer>,
}

/// The output files of a command. They must not replace files that the command reads.
#[derive(Debug)]
pub(crate) struct Destination<'a> {
    out: &'a OutArgs,
    inputs: InputFiles,
}

/// Figures, HTML page and drawing of an answer, in display units.
#[derive(Debug, Default)]
pub(crate) struct Pictures {
    pub(crate) figures: Vec<Figure>,
    /// HTML page that contains the figures of the answer.
    pub(crate) page: Option<String>,
    /// Drawing of the groove profiles in DXF format.
    pub(crate) drawing: Option<String>,
}

impl OutArgs {
    /// Checks that the output files have supported extensions and that none of them replaces an
    /// input file.
    ///
    /// * `endings`: file extensions that the command can write.
    /// * `inputs`: all files that the command reads.
    pub(crate) fn check(
        &self,
        endings: &[&'static str],
        inputs: InputFiles,
    ) -> Result<Destination<'_>, Failure> {
        if self.figures.is_some() && cfg!(not(feature = "plot")) {
            return Err(Failure::not_built("plot"));
        }
        for path in &self.output {
            if !is_stdout(path) || !endings.contains(&"csv") {
                ending_of("-o", path, endings)?;
            }
        }
        inputs.check(self.output.iter().map(PathBuf::as_path))?;
        Ok(Destination { out: self, inputs })
    }
}

impl Reply<'_> {
    /// Creates a reply that consists of one answer.
    pub(crate) fn of(answer: Answer) -> Self {
        Self { parts: vec![("", answer)], ..Self::default() }
    }

    /// Creates a reply that consists of one answer about a case. The heading of the reply is the
    /// description of the case.
    pub(crate) fn about(case: &Case, answer: Answer) -> Self {
        let title = case.description.as_deref().map(printable);
        Self { title, units: case.display_units(), ..Self::of(answer) }
    }

    fn json(&self) -> Value {
        match &self.parts[..] {
            [(_, only)] => only.to_json(),
            parts => {
                let part = |(name, part): &(&str, Answer)| ((*name).to_owned(), part.to_json());
                Value::Object(parts.iter().map(part).collect::<Map<_, _>>())
            }
        }
    }

    fn text(&self) -> String {
        let parts = self.parts.iter().map(|(_, part)| part.clone().in_units(self.units));
        let shown = self.shown.iter().cloned();
        let parts = shown.chain(parts.filter(|_| self.shown.is_none()));
        let parts = parts.map(|part| table::answer(&part));
        self.title.clone().into_iter().chain(parts).collect::<Vec<_>>().join("\n\n")
    }

    /// Prints the answer and writes the requested files and pictures.
    pub(crate) fn deliver(
        self,
        Destination { out: to, inputs }: &Destination<'_>,
        draw: impl FnOnce() -> Result<Pictures, Failure>,
    ) -> Result<(), Failure> {
        let mut printed = Vec::new();
        for warning in self.parts.iter().flat_map(|(_, part)| &part.warnings) {
            if !printed.contains(&warning) {
                print_message("warning", warning);
                printed.push(warning);
            }
        }
        let json = self.json();
        let is_picture =
            |path: &&Path| ending_of("-o", path, &["html", "svg", "png", "dxf"]).is_ok();
        let pictures: Vec<&Path> =
            to.output.iter().map(PathBuf::as_path).filter(is_picture).collect();
        let drawn = if to.figures.is_some() || !pictures.is_empty() {
            draw()?
        } else {
            Pictures::default()
        };
        let files = match &to.figures {
            Some(folder) => drawn_files(folder, &drawn, &json)?,
            None => Vec::new(),
        };
        let all = to.output.iter().chain(files.iter().map(|(path, _)| path));
        inputs.check(all.map(PathBuf::as_path))?;
        for path in &to.output {
            match path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase).as_deref()
            {
                Some("json") => {
                    let json = self.case.as_ref().unwrap_or(&json);
                    if !json.is_null() {
                        files::write(path, &(pretty_json(json) + "\n"))?;
                    }
                }
                Some("html") => files::write(path, drawn.page.as_deref().unwrap_or_default())?,
                Some("dxf") => files::write(path, drawn.drawing.as_deref().unwrap_or_default())?,
                Some(form @ ("svg" | "png")) => {
                    let Some(figure) = drawn.figures.first() else { continue };
                    let bytes =
                        if form == "png" { figure.png()? } else { figure.svg()?.into_bytes() };
                    write_bytes(files::OutputFile::create(path)?, path, &bytes)?;
                }
                _ => {
                    if let Some(write_table) = &self.table {
                        write_table(path)?;
                    }
                }
            }
        }
        if let Some(folder) = &to.figures {
            write_drawn(folder, &drawn, &files)?;
        }
        let has_stdout = to.output.iter().any(|path| is_stdout(path));
        // JSON lists and tables cannot contain notes, so the notes are printed to standard error.
        if to.json && json.is_array() || !to.json && has_stdout {
            for note in self.parts.iter().flat_map(|(_, part)| &part.notes) {
                print_message("note", note);
            }
        }
        if to.json {
            print(&pretty_json(&json))?;
        } else if !has_stdout {
            print(&self.text())?;
        }
        if self.parts.iter().any(|(_, part)| part.fails) { Err(Failure::Unsolved) } else { Ok(()) }
    }
}

/// Returns the paths and contents of the figure files to write into a folder: an SVG file and a
/// table for each figure. If there is an HTML page, the page and the results are included, and the
/// figures go into a subfolder.
fn drawn_files(
    folder: &Path,
    drawn: &Pictures,
    results: &Value,
) -> Result<Vec<(PathBuf, String)>, Failure> {
    let files = match &drawn.page {
        Some(page) => report_files(page.clone(), results, &drawn.figures)?,
        None => figure_files("", &drawn.figures)?,
    };
    Ok(files.into_iter().map(|(name, text)| (folder.join(name), text)).collect())
}

/// Creates a folder and writes the figure files into it.
fn write_drawn(
    folder: &Path,
    drawn: &Pictures,
    files: &[(PathBuf, String)],
) -> Result<(), Failure> {
    let inner = if drawn.page.is_some() { folder.join("figures") } else { folder.to_owned() };
    files::make_folder(&inner)?;
    for (path, text) in files {
        files::write(path, text)?;
    }
    let (count, folder) = (drawn.figures.len(), folder.display());
    let what = match drawn.page {
        Some(_) => "report.html, results.json and figures/".to_owned(),
        None => format!("{count} figures (SVG and CSV)"),
    };
    print_message("note", &format!("wrote {what} in {folder}"));
    Ok(())
}
