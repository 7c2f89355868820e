//! What a command answers, and where it goes: the same way for all of them.

use std::path::{Path, PathBuf};

use bsm_case::{Answer, Case, printable};
use bsm_report::Figure;
use serde_json::{Map, Value};

use crate::args::OutArgs;
use crate::failure::{Failure, warn};
use crate::files::{self, ending_of, is_stdout, keep, pretty_json, print, write_bytes};
use crate::table;
use crate::table_job::{NumberRow, TABLES, write_rows};

/// Answer of a command.
#[derive(Debug, Default)]
pub(crate) struct Reply {
    /// Heading.
    pub(crate) title: Option<String>,
    /// The answers; several are members of one JSON object.
    pub(crate) parts: Vec<(&'static str, Answer)>,
    /// Content of a JSON file, if not the answer: a case; null if there is none.
    pub(crate) case: Option<Value>,
    /// Names, units and values of a table, if the answer is one.
    pub(crate) rows: Vec<NumberRow>,
    /// The case that tables are made from.
    pub(crate) about: Value,
}

/// Pictures of an answer.
#[derive(Debug, Default)]
pub(crate) struct Pictures {
    pub(crate) figures: Vec<Figure>,
    /// A page that holds them.
    pub(crate) page: Option<String>,
    /// A drawing as DXF.
    pub(crate) drawing: Option<String>,
}

impl OutArgs {
    /// Refuses files of other endings than a command writes, and those that were read.
    pub(crate) fn check(
        &self,
        endings: &[&'static str],
        read: &[Option<&Path>],
    ) -> Result<(), Failure> {
        for path in &self.output {
            for read in read.iter().flatten() {
                keep(read, Some(path))?;
            }
            if !is_stdout(path) || !endings.contains(&"csv") {
                ending_of("-o", path, endings)?;
            }
        }
        Ok(())
    }

    /// The files that are tables.
    pub(crate) fn tables(&self) -> impl Iterator<Item = &Path> {
        let is_table = |path: &&Path| is_stdout(path) || ending_of("-o", path, &TABLES).is_ok();
        self.output.iter().map(PathBuf::as_path).filter(is_table)
    }
}

impl Reply {
    /// One answer.
    pub(crate) fn of(answer: Answer) -> Self {
        Self { parts: vec![("", answer)], ..Self::default() }
    }

    /// One answer about a case.
    pub(crate) fn about(case: &Case, answer: Answer) -> Self {
        Self { title: case.description.as_deref().map(printable), ..Self::of(answer) }
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
        let parts = self.parts.iter().map(|(_, part)| table::answer(part));
        self.title.clone().into_iter().chain(parts).collect::<Vec<_>>().join("\n\n")
    }

    /// Says, writes, draws and prints it.
    pub(crate) fn give(
        self,
        to: &OutArgs,
        draw: impl FnOnce() -> Result<Pictures, Failure>,
    ) -> Result<(), Failure> {
        let mut printed = Vec::new();
        for warning in self.parts.iter().flat_map(|(_, part)| &part.warnings) {
            if !printed.contains(&warning) {
                warn("warning", warning);
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
                        if form == "png" { figure.png()? } else { figure.svg().into_bytes() };
                    write_bytes(files::Output::create(path)?, path, &bytes)?;
                }
                _ if self.rows.is_empty() => {}
                _ => write_rows(path, &self.rows, &self.about)?,
            }
        }
        if let Some(folder) = &to.figures {
            files::write_drawn(folder, &drawn, &json)?;
        }
        let has_stdout = to.output.iter().any(|path| is_stdout(path));
        // Neither a list nor a table has a place for notes.
        if to.json && json.is_array() || !to.json && has_stdout {
            for note in self.parts.iter().flat_map(|(_, part)| &part.notes) {
                warn("note", note);
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
