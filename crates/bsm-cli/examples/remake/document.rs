//! Documents, and the blocks that commands write into them. A block is the text between
//! `<!-- remake: NAME -->` and `<!-- end -->`.

use std::fs;
use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};

const BEGIN: &str = "<!-- remake: ";
const CLOSE: &str = " -->";
const END: &str = "<!-- end -->";

/// A Markdown file with its current text.
pub(crate) struct Document {
    pub(crate) path: PathBuf,
    pub(crate) text: String,
}

/// A block, which is written by one command.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Block {
    pub(crate) name: String,
    /// Position of the text between the markers.
    pub(crate) body: Range<usize>,
}

/// A fenced block of a document.
pub(crate) struct Fence<'a> {
    /// Language, followed by any attributes.
    pub(crate) info: &'a str,
    pub(crate) body: &'a str,
    /// Position of the end of the fence in the document.
    pub(crate) end: usize,
}

/// Reads all documents that may contain blocks.
pub(crate) fn documents(root: &Path) -> io::Result<Vec<Document>> {
    let mut paths = vec![root.join("README.md")];
    for folder in ["docs/guide", "docs/evidence", "docs/theory"] {
        let entries = fs::read_dir(root.join(folder))?.collect::<io::Result<Vec<_>>>()?;
        let mut found: Vec<_> = entries.iter().map(fs::DirEntry::path).collect();
        found.retain(|path| path.extension().is_some_and(|end| end == "md"));
        found.sort();
        paths.append(&mut found);
    }
    let read = |path: PathBuf| Ok(Document { text: fs::read_to_string(&path)?, path });
    paths.into_iter().map(read).collect()
}

impl Document {
    /// Returns all blocks in order. The error names the marker that is not closed.
    pub(crate) fn blocks(&self) -> Result<Vec<Block>, String> {
        let (mut blocks, mut from) = (Vec::new(), 0);
        while let Some(begin) = self.text[from..].find(BEGIN).map(|place| from + place) {
            let broken = || {
                let line = 1 + self.text[..begin].matches('\n').count();
                format!("{}:{line}: a block has no end marker", self.path.display())
            };
            let name = begin + BEGIN.len();
            let close = name + self.text[name..].find(CLOSE).ok_or_else(broken)?;
            let body = close + CLOSE.len();
            let end = body + self.text[body..].find(END).ok_or_else(broken)?;
            if self.text[body..end].contains(BEGIN) {
                return Err(broken());
            }
            blocks.push(Block { name: self.text[name..close].to_owned(), body: body..end });
            from = end;
        }
        Ok(blocks)
    }

    /// Returns all fences in order.
    pub(crate) fn fences(&self) -> Vec<Fence<'_>> {
        let (mut fences, mut open, mut place) = (Vec::new(), None, 0);
        for line in self.text.split_inclusive('\n') {
            let start = place;
            place += line.len();
            let Some(info) = line.strip_prefix("```") else { continue };
            open = match open {
                None => Some((info.trim(), place)),
                Some((info, begin)) => {
                    fences.push(Fence { info, body: &self.text[begin..start], end: place });
                    None
                }
            };
        }
        fences
    }

    /// Returns the last shell line before a position. The output of this command belongs at the
    /// position.
    pub(crate) fn command_before(&self, place: usize) -> Option<String> {
        let shell = |fence: &Fence| fence.end <= place && fence.info.starts_with("sh");
        let fence = self.fences().into_iter().rfind(shell)?;
        fence.body.lines().last().map(str::to_owned)
    }
}

/// Returns the arguments of a `bsm` command in a shell line, or `None` if the line runs another
/// program.
pub(crate) fn bsm_arguments(line: &str) -> Option<Vec<String>> {
    const LONG: &str = "cargo run --release --locked -- ";
    let arguments = line.strip_prefix("bsm ").or_else(|| line.strip_prefix(LONG))?;
    // Quotes are the only shell syntax that the documents use.
    let mut words = vec![String::new()];
    let mut quoted = false;
    for letter in arguments.chars() {
        match letter {
            '\'' => quoted = !quoted,
            ' ' if !quoted => words.push(String::new()),
            other => words.last_mut()?.push(other),
        }
    }
    Some(words)
}
