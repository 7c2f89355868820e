//! The `bsm` program: arguments, printing, exit codes. No formula and no default value lives here.

mod args;
mod batch;
mod capacity;
mod catalog;
mod compare;
mod design;
mod failure;
mod files;
mod fit;
mod lookup;
mod makers;
mod motion;
mod nut;
mod optimum;
mod schema;
mod shard;
mod size;
mod solve;
mod stream;
mod sweep;
mod table;
mod threads;
mod tradeoff;
mod unfinished;
mod validate;
mod verify;
mod view;
#[cfg(feature = "xlsx")]
mod workbook;

use std::env;
use std::process::ExitCode;

use bsm_batch::hush_caught_panics;
use clap::{CommandFactory, Parser};

use crate::args::{Cli, Command};
use crate::failure::Failure;
use crate::files::print;
use crate::threads::on_threads;

fn main() -> ExitCode {
    hush_caught_panics();
    if let Err(error) = unfinished::prepare() {
        return Failure::Files(format!("cannot handle signals: {error}")).report();
    }
    let command = match Cli::try_parse() {
        Ok(cli) => cli.command,
        Err(usage) => return failure::usage(&usage),
    };
    // Rayon starts as many as it is told; 0 and what is no number mean all cores there.
    let asked =
        env::var("RAYON_NUM_THREADS").ok().filter(|n| n.parse::<usize>().is_ok_and(|n| n > 0));
    let asked = match asked.as_deref().map(args::threads).transpose() {
        Ok(asked) => asked,
        Err(what) => return Failure::Input(format!("RAYON_NUM_THREADS {what}")).report(),
    };
    let result = match command {
        Command::Solve(args) => solve::run(&args),
        Command::Compare(args) => compare::run(&args),
        Command::Sweep(args) => {
            on_threads(args.table.threads.or(asked), |workers| sweep::run(&args, workers))
        }
        Command::Batch(args) => {
            on_threads(args.table.threads.or(asked), |workers| batch::run(&args, workers))
        }
        Command::Shard(args) => {
            on_threads(args.threads.or(asked), |workers| shard::run(&args, workers))
        }
        Command::Verify(args) => on_threads(asked, |workers| verify::run(&args, workers)),
        Command::Optimum(args) => optimum::run(&args),
        Command::Capacity(args) => capacity::run(&args),
        Command::Catalog(args) => on_threads(asked, |_| catalog::run(&args)),
        Command::Nut(args) => on_threads(asked, |_| nut::run(&args)),
        Command::Size(args) => on_threads(asked, |_| size::run(&args)),
        Command::Fit(args) => fit::run(&args),
        Command::Design(args) => on_threads(asked, |_| design::run(&args)),
        Command::Slip(args) => motion::slip(&args),
        Command::Jam(args) => motion::jam(&args),
        Command::Validate(args) => on_threads(asked, |_| validate::run(&args)),
        Command::Tradeoff(args) => on_threads(asked, |_| tradeoff::run(&args)),
        Command::View(args) => on_threads(asked, |workers| view::run(&args, workers)),
        Command::Schema { kind } => schema::run(kind),
        Command::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut Cli::command(), "bsm", &mut script);
            print(&String::from_utf8_lossy(&script))
        }
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}
