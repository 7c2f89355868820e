//! What a command answers, and where it goes: the same way for all of them.

use std::path::{Path, PathBuf};

use bsm_case::Scene;
use bsm_report::Figure;
use serde_json::Value;

use crate::args::OutArgs;
use crate::failure::{Failure, warn};
use crate::files::{self, ending_of, is_stdout, keep, pretty_json, print, write_bytes};
use crate::stream::{TABLES, write_rows};
use crate::table;

/// An answer in words and numbers.
#[derive(Debug, Default)]
pub(crate) struct Answer {
    pub(crate) warnings: Vec<String>,
    pub(crate) notes: Vec<String>,
    pub(crate) text: String,
    pub(crate) json: Value,
    /// What a file of JSON gets, if not that: a scene; null if there is none to write.
    pub(crate) scene: Option<Value>,
    /// Names, units and values of a table, if the answer is one.
    pub(crate) rows: Vec<(String, String, f64)>,
    /// The scene that tables are made from.
    pub(crate) about: Value,
    /// True if something has no solution, or a check failed.
    pub(crate) failed: bool,
}

/// Pictures of an answer.
#[derive(Debug, Default)]
pub(crate) struct Drawn {
    pub(crate) figures: Vec<Figure>,
    /// A page that holds them.
    pub(crate) page: Option<String>,
}

/// Adds what is not told yet.
fn add(told: &mut Vec<String>, texts: Vec<String>) {
    for text in texts {
        if !told.contains(&text) {
            told.push(text);
        }
    }
}

/// Rows of a table.
pub(crate) fn named(rows: Vec<(&str, &str, f64)>) -> Vec<(String, String, f64)> {
    rows.into_iter().map(|(name, unit, value)| (name.to_owned(), unit.to_owned(), value)).collect()
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

impl Answer {
    /// Answers of one scene as one: a text after the other, and JSON with a member each.
    pub(crate) fn of_parts(scene: &Scene, mut parts: Vec<(&str, Self)>) -> Self {
        let title = table::title(scene);
        let texts = title.into_iter().chain(parts.iter().map(|(_, part)| part.text.clone()));
        let text = texts.collect::<Vec<_>>().join("\n\n");
        if parts.len() == 1 {
            let (_, only) = parts.remove(0);
            return Self { text, ..only };
        }
        let mut all = Self { text, ..Self::default() };
        for (name, part) in parts {
            all.json[name] = part.json;
            add(&mut all.warnings, part.warnings);
            add(&mut all.notes, part.notes);
            all.rows.extend(part.rows);
            all.about = part.about;
            all.failed |= part.failed;
        }
        all
    }

    /// Says, writes, draws and prints it.
    pub(crate) fn give(
        self,
        to: &OutArgs,
        draw: impl FnOnce() -> Result<Drawn, Failure>,
    ) -> Result<(), Failure> {
        for (kind, texts) in [("warning", &self.warnings), ("note", &self.notes)] {
            for text in texts {
                warn(kind, text);
            }
        }
        let is_picture = |path: &&Path| ending_of("-o", path, &["html", "svg", "png"]).is_ok();
        let pictures: Vec<&Path> =
            to.output.iter().map(PathBuf::as_path).filter(is_picture).collect();
        let drawn =
            if to.figures.is_some() || !pictures.is_empty() { draw()? } else { Drawn::default() };
        for path in &to.output {
            match path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase).as_deref()
            {
                Some("json") => {
                    let json = self.scene.as_ref().unwrap_or(&self.json);
                    if !json.is_null() {
                        files::write(path, &(pretty_json(json) + "\n"))?;
                    }
                }
                Some("html") => files::write(path, drawn.page.as_deref().unwrap_or_default())?,
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
            files::write_drawn(folder, &drawn, &self.json)?;
        }
        if to.json {
            print(&pretty_json(&self.json))?;
        } else if !to.output.iter().any(|path| is_stdout(path)) {
            print(&self.text)?;
        }
        if self.failed { Err(Failure::Unsolved) } else { Ok(()) }
    }
}
