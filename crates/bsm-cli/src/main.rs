//! The `bsm` program: arguments, output and exit codes. It contains no formulas and no default
//! values.
//!
//! To solve a point from Rust, start with [`bsm_case`](../bsm_case/index.html) (case files;
//! `Case::problem`) or [`bsm_dyn`](../bsm_dyn/index.html) (SI units; `Problem::solve`). Their front
//! pages contain complete examples. To solve many points, use
//! [`bsm_batch`](../bsm_batch/index.html); for all balls of a nut, use
//! [`bsm_nut`](../bsm_nut/index.html).

mod answer;
mod args;
mod axis;
mod console;
mod failure;
mod files;
mod fit;
mod lookup;
mod nut;
mod nuts;
#[cfg(feature = "parquet")]
mod parts;
mod pictures;
mod progress;
mod schema;
mod select;
mod select_input;
mod solve;
mod sweep;
mod table;
mod table_job;
mod threads;
#[cfg(feature = "validate")]
mod tradeoff;
mod unfinished;
#[cfg(feature = "validate")]
mod validate;
#[cfg(feature = "view")]
mod view;
#[cfg(feature = "xlsx")]
mod workbook;

use std::env;
use std::path::Path;
use std::process::ExitCode;

use bsm_batch::silence_caught_panics;
use clap::FromArgMatches;
use clap_complete::CompleteEnv;

#[cfg(feature = "parquet")]
use crate::args::PartsCommand;
use crate::args::{Cli, Command};
use crate::failure::Failure;
use crate::files::OutputFile;
use crate::threads::on_threads;

fn main() -> ExitCode {
    CompleteEnv::with_factory(args::command).complete();
    silence_caught_panics();
    if let Err(error) = unfinished::install_handlers() {
        return Failure::Files(format!("cannot handle signals: {error}")).report();
    }
    let matches = args::command().try_get_matches();
    let command = match matches.and_then(|matches| Cli::from_arg_matches(&matches)) {
        Ok(cli) => cli.command,
        Err(usage_error) => return usage(&usage_error),
    };
    // Rayon starts as many threads as the environment variable RAYON_NUM_THREADS specifies. Like
    // Rayon, this program uses all cores if the value is 0 or not a number.
    let threads =
        env::var("RAYON_NUM_THREADS").ok().filter(|n| n.parse::<usize>().is_ok_and(|n| n > 0));
    let threads = match threads.as_deref().map(args::threads).transpose() {
        Ok(threads) => threads,
        Err(what) => return Failure::Input(format!("RAYON_NUM_THREADS {what}")).report(),
    };
    let result = match command {
        Command::Solve(args) => solve::run(&args),
        Command::Nut(args) => on_threads(threads, |_| nut::run(&args)),
        Command::Axis(args) => on_threads(threads, |_| axis::run(&args)),
        Command::Select(args) => on_threads(threads, |_| select::run(&args)),
        Command::Sweep(args) => {
            on_threads(args.work.threads.or(threads), |workers| sweep::run(&args, workers))
        }
        #[cfg(feature = "parquet")]
        Command::Parts(PartsCommand::Run(args)) => {
            on_threads(args.work.threads.or(threads), |workers| parts::run(&args, workers))
        }
        #[cfg(feature = "parquet")]
        Command::Parts(PartsCommand::Check(args)) => {
            on_threads(threads, |workers| parts::check(&args, workers))
        }
        Command::Fit(args) => fit::run(&args),
        #[cfg(feature = "view")]
        Command::View(args) => on_threads(threads, |_| view::run(&args)),
        #[cfg(feature = "validate")]
        Command::Validate(args) => on_threads(threads, |_| validate::run(&args)),
        #[cfg(feature = "validate")]
        Command::Tradeoff(args) => on_threads(threads, |_| tradeoff::run(&args)),
        #[cfg(not(feature = "parquet"))]
        Command::Parts(_) => Err(Failure::not_built("parquet")),
        #[cfg(not(feature = "validate"))]
        Command::Validate(_) | Command::Tradeoff(_) => Err(Failure::not_built("validate")),
        #[cfg(not(feature = "view"))]
        Command::View(_) => Err(Failure::not_built("view")),
        Command::Schema { name } => schema::run(name.as_deref()),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}

/// Prints the help text, the version or the usage error that the argument parser returned.
fn usage(usage_error: &clap::Error) -> ExitCode {
    match usage_error.print() {
        Err(error) if !usage_error.use_stderr() => {
            OutputFile::failure(Path::new("-"), &error).report()
        }
        _ => ExitCode::from(u8::try_from(usage_error.exit_code()).unwrap_or(2)),
    }
}
