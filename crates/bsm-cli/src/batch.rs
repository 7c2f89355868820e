//! `bsm batch`: one row in, one row out.

use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::Path;

use bsm_batch::{CsvSource, JsonSource, ParquetSource, Source, TableError};
use bsm_case::Scene;

use crate::args::BatchArgs;
use crate::failure::Failure;
use crate::files::{self, read_scene};
use crate::stream::{Kind, Task};

pub(crate) fn run(args: &BatchArgs) -> Result<(), Failure> {
    let mut base = Scene::default();
    if let Some(path) = &args.base {
        base = read_scene(path, &[])?;
        files::keep(path, Some(&args.table.output))?;
    }
    files::apply(&mut base, &args.settings)?;
    let settings = args.model.settings().map_err(|e| Failure::Input(e.to_string()))?;
    let task = Task::new(&base, &settings, &args.table)?;
    let mut source = open(&args.points, &args.keep)?;
    // Without its inputs no row can be solved: that is told once, not on every row.
    let most = base.given() | source.columns().set();
    if let Err(error) = settings.model.resolve(most, |_| Ok(())) {
        return Err(Failure::Input(format!(
            "{}: {error}; add columns, a --base scene or --set",
            args.points.display()
        )));
    }
    let origin = || origin(&args.points);
    task.run(source.as_mut(), origin, |_, _| {}).map_err(|e| match e {
        Failure::Table(error) => Failure::table(&args.points, &error),
        other => other,
    })
}

/// Name and checksum of a table, which tell whether it has changed.
fn origin(path: &Path) -> Result<String, Failure> {
    if path.as_os_str() == "-" {
        let text = "a folder needs points from a file: standard input cannot be read again";
        return Err(Failure::Input(text.to_owned()));
    }
    let failed = |e: io::Error| Failure::files("read", path, &e);
    let mut file = BufReader::new(File::open(path).map_err(failed)?);
    let mut sum = crc32fast::Hasher::new();
    let mut buffer = vec![0; 1 << 16];
    let mut length = 0_u64;
    loop {
        let read = file.read(&mut buffer).map_err(failed)?;
        if read == 0 {
            break;
        }
        sum.update(&buffer[..read]);
        length += read as u64;
    }
    Ok(format!("{} bytes, CRC-32 {:08x}", length, sum.finalize()))
}

/// Opens a table by the ending of its name; `-` is CSV on standard input.
pub(crate) fn open(path: &Path, keep: &[String]) -> Result<Box<dyn Source>, Failure> {
    let kind = Kind::of(path, "POINTS")?;
    let failed = |e: TableError| Failure::table(path, &e);
    let file = || File::open(path).map_err(|e| Failure::files("read", path, &e));
    Ok(match kind {
        Kind::Parquet => Box::new(ParquetSource::new(file()?, keep).map_err(failed)?),
        Kind::JsonLines => {
            Box::new(JsonSource::new(BufReader::new(file()?), keep).map_err(failed)?)
        }
        Kind::Csv => {
            let reader: Box<dyn Read + Send> =
                if path.as_os_str() == "-" { Box::new(io::stdin()) } else { Box::new(file()?) };
            Box::new(CsvSource::new(reader, keep).map_err(failed)?)
        }
    })
}
