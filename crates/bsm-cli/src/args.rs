//! Command-line arguments.

use std::num::{NonZeroU64, NonZeroUsize};
use std::path::{Path, PathBuf};
use std::str::FromStr;

use bsm_batch::TableFormat;
use bsm_batch::dataset::sha256;
use bsm_case::{Case, CaseError, GivenNames, MeasurementError, ModelChoice, Rule, Settings};
use bsm_dyn::{Control, RacewayFriction};
use clap::builder::PossibleValuesParser;
use clap::{Args, CommandFactory, Parser, Subcommand, ValueEnum};

use crate::failure::Failure;
use crate::{files, schema};

/// Meaning of the exit codes, shown at the end of every help text.
const EXIT_CODES: &str = "Exit codes: 0 all solved, all checks passed; 1 files, disk, threads or memory; 2 bad \
                          input or usage; 3 no solution or a failed check; 128 + N if signal N interrupted it.";

/// What the files of `-o` and the folder of `--figures` get where it is no page, by command.
const FILES: [(&str, &str, &str); 4] = [
    (
        "select",
        ".json: case of the screw, or of the first nut; .csv, .xlsx, `-`: the steps; these, .jsonl and .parquet: \
         the list of nuts",
        "Folder for the figures of Sobolewski (2002), SVG and CSV, with the nuts of the list",
    ),
    (
        "solve",
        ".json: what --json prints; .csv, .xlsx: ratings and their steps",
        "Folder for figures (SVG and CSV) of sweeps around the case: slip, jam, optimum",
    ),
    (
        "nut",
        ".csv, .jsonl, .parquet, .xlsx, or `-`: the table of --show; .json: what --json prints",
        "Folder for figures (SVG and CSV): loads and angles along the helix, displacement, preload",
    ),
    (
        "fit",
        ".json: what --json prints; with --points .svg, .png: measured against fitted values",
        "Folder for the figure of --points, SVG and CSV",
    ),
];

/// Returns the command-line parser, with the exit codes in the help text of every command.
pub(crate) fn command() -> clap::Command {
    fn with_exit_codes(command: clap::Command) -> clap::Command {
        command.after_help(EXIT_CODES).mut_subcommands(with_exit_codes)
    }
    let mut command = with_exit_codes(Cli::command());
    for (name, files, figures) in FILES {
        command = command.mut_subcommand(name, |command| {
            command
                .mut_arg("output", |arg| arg.help(format!("{files}. May be repeated")))
                .mut_arg("figures", |arg| arg.help(figures))
        });
    }
    let models = PossibleValuesParser::new(ModelChoice::names().chain([ALL]));
    command
        .mut_subcommand("solve", |solve| solve.mut_arg("model", |model| model.value_parser(models)))
}

/// Steady motion of the balls of a ball screw: loads, slip, spin, torque, efficiency.
///
/// A case is a JSON file of inputs whose names carry their units. A feed drive: bsm solve
/// examples/feed_drive.json. Your own screw: copy that file, or change it, such as with --set lead_mm=10 --set
/// axial_load_kN=5; `bsm schema input` lists all inputs. From a requirement to a screw: bsm select
/// examples/requirements/axis.json -o screw.json, then bsm axis screw.json.
#[derive(Debug, Parser)]
#[command(name = "bsm", version = env!("BSM_VERSION"), arg_required_else_help = true)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Solve one operating point: motion, slip, jamming, best contact angle, load ratings.
    Solve(SolveArgs),
    /// All balls of a nut: load sharing, stiffness, preload, life, torque. The nut is a case as for
    /// --show ratings of bsm solve, with axial_load_N or a preload; docs/guide/nut.md has its other inputs.
    Nut(NutArgs),
    /// The axis around a screw, from a requirement to a calculation sheet: critical speed, buckling, speed number,
    /// static safety, life, stiffness, torque and heat over the cycle, each with its limit, margin and source.
    /// Exit code 3 if a rule fails. Try: bsm axis examples/axis.json
    Axis(AxisArgs),
    /// Choose a screw: the best one for a requirement with all steps of the choice, or a list of nuts, of standard
    /// sizes or a manufacturer's, to filter and sort. Try: bsm select examples/requirements/axis.json
    Select(SelectArgs),
    /// Solve many points, one row each: a grid (--vary), random points (--draw) or a table (--points).
    /// Try: bsm sweep examples/feed_drive.json --vary axial_load_kN=1:20:5 --columns efficiency -o -
    Sweep(SweepArgs),
    /// Parts of a folder that `bsm sweep -o DIR/ --plan` has planned: solve them, check them.
    #[command(subcommand)]
    Parts(PartsCommand),
    /// Friction coefficient, or another input, from a measured torque or another output.
    /// Try: bsm fit examples/feed_drive.json --measured screw_torque_Nm=26
    Fit(FitArgs),
    /// One screw in the browser: pictures and numbers that follow every change.
    /// Try: bsm view examples/feed_drive.json --open
    View(ViewArgs),
    /// Check the program against published results.
    Validate(ValidateArgs),
    /// Measure time and accuracy of every model and setting on this machine.
    Tradeoff(TradeoffArgs),
    /// Print the JSON Schema of cases (input), of results of a point (output), or of what a command prints with
    /// --json; `units` prints the units that names of each quantity can end with. Without a name, print the names.
    Schema {
        /// Which one.
        #[arg(value_parser = PossibleValuesParser::new(schema::names()))]
        name: Option<String>,
    },
}

#[derive(Debug, Subcommand)]
pub(crate) enum PartsCommand {
    /// Solve parts: any number of processes on any machine, in any order, more than once.
    /// Finished parts remain. Example, of 100 tasks of a scheduler: bsm parts run map/ --only $TASK/100
    Run(RunArgs),
    /// Check that every part is there and ends as it was written; --deep reads all of it. Exit code 3 if one is missing or damaged. When all
    /// are there it writes parts.parquet and removes unfinished files.
    Check(CheckArgs),
}

/// A case with changes.
#[derive(Debug, Args)]
pub(crate) struct CaseArgs {
    /// Case file in JSON; `-` reads standard input.
    #[arg(value_name = "CASE.json", required_unless_present = "settings")]
    case: Option<PathBuf>,
    /// Set or replace an input; may be repeated, such as --set screw_speed_rpm=3000.
    #[arg(long = "set", value_name = "NAME=VALUE", allow_hyphen_values = true)]
    settings: Vec<String>,
}

impl CaseArgs {
    /// Returns the name of the case for messages.
    pub(crate) fn path(&self) -> &Path {
        self.case.as_deref().unwrap_or(Path::new("--set"))
    }

    /// Reads the case and applies the changes.
    pub(crate) fn read(&self) -> Result<Case, Failure> {
        self.read_as_given()?.with_groove().map_err(self.failure())
    }

    /// Reads the case, and applies the changes.
    pub(crate) fn read_as_given(&self) -> Result<Case, Failure> {
        files::read_case(self.case.as_deref(), &self.settings)
    }

    /// Reads another case with the same settings.
    pub(crate) fn read_other(&self, path: &Path) -> Result<Case, Failure> {
        files::read_case(Some(path), &self.settings)
    }

    /// Returns name and SHA-256 of the case file, or `None` if the case was typed or piped.
    pub(crate) fn hash(&self) -> Option<String> {
        let path = self.case.as_deref().filter(|path| path.is_file())?;
        let name = path.file_name()?.to_string_lossy();
        Some(format!("{name}, SHA-256 {}", sha256(path).ok()?.0))
    }

    /// Returns a function that reports an error in the case.
    pub(crate) fn failure(&self) -> impl Fn(CaseError) -> Failure + Copy {
        |error| Failure::case(self.path(), &error)
    }
}

/// The model to solve with, and the settings of the solver.
#[derive(Debug, Args)]
#[command(next_help_heading = "Model")]
pub(crate) struct ModelArgs {
    /// Model; auto: the fastest one within the tolerance.
    #[arg(long, default_value = "auto", value_parser = PossibleValuesParser::new(ModelChoice::names()))]
    pub(crate) model: String,
    /// tolerance=0.01 of the efficiency, for auto; accuracy=1e-8 and creep=1e-4 of traction; control=nut or screw and
    /// friction=local or contact of raceway-control.
    #[arg(long, value_name = "KEY=VALUE,..", value_delimiter = ',', value_parser = setting)]
    solver: Vec<(&'static str, SolverSetting)>,
}

/// A setting of the solver.
#[derive(Debug, Clone, Copy)]
enum SolverSetting {
    Tolerance(f64),
    Accuracy(f64),
    Creep(f64),
    Control(Option<Control>),
    Friction(RacewayFriction),
}

/// The models, side by side.
pub(crate) const ALL: &str = "all";

impl ModelArgs {
    /// Returns the model and its settings.
    pub(crate) fn settings(&self) -> Result<Settings, Failure> {
        let set = || -> Result<Settings, CaseError> {
            let mut settings = Settings::named(&self.model, None, None)?;
            for setting in once(&self.solver)? {
                match *setting {
                    SolverSetting::Tolerance(tolerance) => settings.tolerance = tolerance,
                    SolverSetting::Accuracy(accuracy) => settings.accuracy = accuracy,
                    SolverSetting::Creep(creep) => settings.creep = creep,
                    SolverSetting::Control(control) => settings.control = control,
                    SolverSetting::Friction(friction) => settings.friction = friction,
                }
            }
            settings.checked()
        };
        set().map_err(|error| Failure::input("--solver", &error))
    }

    /// Returns true if a setting is given.
    pub(crate) fn has_settings(&self) -> bool {
        !self.solver.is_empty()
    }
}

/// Parses a setting of the solver and checks it against its rule.
fn setting(text: &str) -> Result<(&'static str, SolverSetting), String> {
    use SolverSetting::{Accuracy, Control, Creep, Friction, Tolerance};
    let (key, value) = pair(text, &["tolerance", "accuracy", "creep", "control", "friction"])?;
    let number = |rule: Rule| {
        let number = value.parse().ok().filter(|number| rule.holds::<f64>(*number));
        number.ok_or_else(|| format!("must be {}", rule.describe()))
    };
    let named = |control, friction| {
        Settings::named("auto", control, friction).map_err(|error| error.to_string())
    };
    let setting = match key {
        "tolerance" => Tolerance(number(Settings::TOLERANCE)?),
        "accuracy" => Accuracy(number(Settings::ACCURACY)?),
        "creep" => Creep(number(Settings::CREEP)?),
        "control" => Control(named(Some(value), None)?.control),
        _ => Friction(named(None, Some(value))?.friction),
    };
    Ok((key, setting))
}

/// Splits `KEY=VALUE` and checks that the key is one of `keys`.
fn pair<'a>(text: &'a str, keys: &[&'static str]) -> Result<(&'static str, &'a str), String> {
    let split = text.split_once('=');
    let found =
        split.and_then(|(key, value)| Some((*keys.iter().find(|own| **own == key)?, value)));
    found.ok_or_else(|| format!("must be KEY=VALUE, with a key of {}", keys.join(", ")))
}

/// Returns the values. Fails if a key is given twice.
fn once<'a, T>(pairs: &'a [(&'static str, T)]) -> Result<impl Iterator<Item = &'a T>, CaseError> {
    let mut given = GivenNames::default();
    pairs.iter().try_for_each(|(key, _)| given.add(key, key))?;
    Ok(pairs.iter().map(|(_, value)| value))
}

/// Format of a table that is read.
#[derive(Debug, Args)]
pub(crate) struct DialectArgs {
    /// delimiter=comma, semicolon, tab or bar; decimal=point or comma; of points and nuts names=FILE, JSON from its
    /// columns to ours or null; of bsm sweep output=same, for CSV like it.
    #[arg(long, value_name = "KEY=VALUE,..", value_delimiter = ',', value_parser = sign)]
    dialect: Vec<(&'static str, DialectSign)>,
}

/// A property of a table that is read.
#[derive(Debug, Clone)]
enum DialectSign {
    Delimiter(char),
    Decimal(char),
    Names(PathBuf),
    /// CSV is written like the table.
    OfOutput,
}

/// Parses a key of the dialect of a table and its value.
fn sign(text: &str) -> Result<(&'static str, DialectSign), String> {
    let (key, value) = pair(text, &["delimiter", "decimal", "names", "output"])?;
    let one_of = |words: &[(&str, char)]| {
        let found = words.iter().find(|(word, _)| *word == value);
        let names: Vec<_> = words.iter().map(|(word, _)| *word).collect();
        found.map(|(_, sign)| *sign).ok_or_else(|| format!("must be {}", names.join(" or ")))
    };
    let sign = match key {
        "delimiter" => DialectSign::Delimiter(one_of(&[
            ("comma", ','),
            ("semicolon", ';'),
            ("tab", '\t'),
            ("bar", '|'),
        ])?),
        "decimal" => DialectSign::Decimal(one_of(&[("point", '.'), ("comma", ',')])?),
        "names" => DialectSign::Names(value.into()),
        _ if value == "same" => DialectSign::OfOutput,
        _ => return Err("must be same".to_owned()),
    };
    Ok((key, sign))
}

impl DialectArgs {
    /// Returns the format of a table that supports these keys of the dialect.
    pub(crate) fn read(&self, keys: &[&str]) -> Result<TableFormat, Failure> {
        if let Some((key, _)) = self.dialect.iter().find(|(key, _)| !keys.contains(key)) {
            let text = format!("--dialect {key}: this table has {}", keys.join(", "));
            return Err(Failure::Input(text));
        }
        let mut format = TableFormat::default();
        for sign in once(&self.dialect).map_err(|error| Failure::input("--dialect", &error))? {
            match sign {
                DialectSign::Delimiter(delimiter) => format.delimiter = *delimiter,
                DialectSign::Decimal(decimal) => format.decimal = *decimal,
                DialectSign::Names(map) => format.names = files::names_of_columns(map)?,
                DialectSign::OfOutput => {}
            }
        }
        Ok(format)
    }

    /// Returns the path of the file with the names of the columns, if it is given.
    pub(crate) fn names(&self) -> Option<&Path> {
        self.dialect.iter().find_map(|(_, sign)| match sign {
            DialectSign::Names(map) => Some(map.as_path()),
            _ => None,
        })
    }

    /// Returns true if CSV is written in the dialect of the table.
    pub(crate) fn is_of_output(&self) -> bool {
        self.dialect.iter().any(|(_, sign)| matches!(sign, DialectSign::OfOutput))
    }

    /// Returns true if no key is given.
    pub(crate) fn is_ours(&self) -> bool {
        self.dialect.is_empty()
    }
}

/// Parses a number of threads. The maximum protects the machine.
pub(crate) fn threads(text: &str) -> Result<NonZeroUsize, String> {
    match text.parse::<NonZeroUsize>() {
        Ok(threads) if threads.get() <= 1024 => Ok(threads),
        _ => Err("must be a whole number from 1 to 1024, such as 4".to_owned()),
    }
}

/// Outputs besides the screen.
#[derive(Debug, Default, Args)]
#[command(next_help_heading = "Output")]
pub(crate) struct OutArgs {
    /// .html: the page; .json: what --json prints. May be repeated.
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Vec<PathBuf>,
    /// Folder for the page report.html, results.json and figures/ (SVG and CSV).
    #[arg(long, value_name = "DIR")]
    pub(crate) figures: Option<PathBuf>,
    /// Print JSON; bsm schema describes it.
    #[arg(long)]
    pub(crate) json: bool,
}

/// Parts of the answer for an operating point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Show {
    Motion,
    Band,
    Sensitivities,
    Slip,
    Ellipses,
    Jam,
    Optimum,
    Ratings,
    Steps,
}

#[derive(Debug, Args)]
pub(crate) struct SolveArgs {
    #[command(flatten)]
    pub(crate) case: CaseArgs,
    /// motion (the default); band: 90 % range of friction from oil, and sensitivities: derivatives by each input, come with
    /// the motion; slip; ellipses: pressure, slip and friction at each point, with -o as a table; jam; optimum of the
    /// contact angle; ratings of the nut; steps to them.
    #[arg(long, value_name = "WHAT,..", value_delimiter = ',', value_enum)]
    pub(crate) show: Vec<Show>,
    /// Points of --show ellipses on each semi-axis; 20 unless given.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=500))]
    pub(crate) points: Option<u32>,
    #[command(flatten)]
    pub(crate) model: ModelArgs,
    #[command(flatten)]
    pub(crate) out: OutArgs,
}

#[derive(Debug, Args)]
pub(crate) struct ViewArgs {
    #[command(flatten)]
    pub(crate) case: CaseArgs,
    /// Further cases, side by side with the first.
    #[arg(value_name = "CASE.json")]
    pub(crate) beside: Vec<PathBuf>,
    /// Port of the server on 127.0.0.1; a free one unless given.
    #[arg(long, default_value_t = 0, hide_default_value = true)]
    pub(crate) port: u16,
    /// Start the browser.
    #[arg(long)]
    pub(crate) open: bool,
    /// PAGE.html: write the page as one file, which needs no server and no network. CASE.json: where the button "Save
    /// case" of the server's page writes the case; without it the browser saves it.
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) model: ModelArgs,
}

/// Numbers of a nut that make the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum NutTable {
    Balls,
    Curve,
}

#[derive(Debug, Args)]
pub(crate) struct NutArgs {
    #[command(flatten)]
    pub(crate) case: CaseArgs,
    /// What a table of -o has: a row for each of the balls, or the curve of displacement, stiffness and remaining
    /// preload over the axial load, beyond the load and the limit load.
    #[arg(long, value_enum, default_value = "balls", requires_if("curve", "output"))]
    pub(crate) show: NutTable,
    /// Solve N nuts with random ball diameters (ball_deviation_sd_um) and phases of lead_error, and print
    /// quantiles.
    #[arg(long, value_name = "N", conflicts_with = "figures")]
    pub(crate) samples: Option<u64>,
    /// Seed of the samples; the seed of the case unless given.
    #[arg(long, value_name = "S", requires = "samples")]
    pub(crate) seed: Option<u64>,
    #[command(flatten)]
    pub(crate) model: ModelArgs,
    #[command(flatten)]
    pub(crate) out: OutArgs,
}

#[derive(Debug, Args)]
#[command(mut_arg("output", |arg| arg.help(
    ".html: the page; .json: what --json prints; .csv: the rules; .dxf: the grooves. May be repeated"
)))]
pub(crate) struct AxisArgs {
    #[command(flatten)]
    pub(crate) case: CaseArgs,
    /// Second offer: both sheets side by side, with the same --set and --cycle; the better value is named.
    #[arg(value_name = "OTHER.json")]
    pub(crate) other: Option<PathBuf>,
    /// Load cycle: CSV with the columns time_s or share, force_N, feed_m_min or screw_speed_rpm, and acceleration_m_s2, in any unit; in
    /// place of the cycle of the case.
    #[arg(long, value_name = "CYCLE.csv")]
    pub(crate) cycle: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) dialect: DialectArgs,
    #[command(flatten)]
    pub(crate) model: ModelArgs,
    #[command(flatten)]
    pub(crate) out: OutArgs,
}

/// Lists that `bsm select` prints.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum SelectShow {
    Keys,
    Lists,
    Sizes,
    Columns,
}

#[derive(Debug, Args)]
pub(crate) struct SelectArgs {
    /// Requirement in JSON: load, motion, stroke, life; `-` reads standard input. Alone it gives the best screw and the steps
    /// of Lin, Velinsky and Ravani (1994); with an option of a list, the nuts that meet it.
    #[arg(value_name = "REQUIREMENT.json")]
    pub(crate) requirement: Option<PathBuf>,
    /// Set or replace a key of the requirement; may be repeated, such as --set objective=mass.
    #[arg(
        long = "set",
        value_name = "NAME=VALUE",
        allow_hyphen_values = true,
        requires = "requirement"
    )]
    pub(crate) settings: Vec<String>,
    /// Treat sizes and contact angle as continuous, with balls of standard diameters and the shape limits of Lin.
    #[arg(long, requires = "requirement", conflicts_with_all = ["from", "conditions", "pareto", "sort", "first", "figures"])]
    pub(crate) free: bool,
    /// Print the keys of a requirement, the standard lists or manufacturers' sizes to copy and edit, or the columns of the list of nuts.
    #[arg(long, value_name = "WHAT", value_enum)]
    pub(crate) show: Option<SelectShow>,
    /// Sizes to choose from: manufacturers (THK and HIWIN, unless given), standard (every combination of ISO 3408-2 at 45 degrees), lists in
    /// LISTS.json, sizes in TABLE.csv with the columns of --show sizes; or a manufacturer's nuts in TABLE.csv: nut, lead_mm, ball_diameter_mm,
    /// circuits or loaded_turns, core_diameter_mm or pitch_circle_diameter_mm, ratings.
    #[arg(long, value_name = "SIZES")]
    pub(crate) from: Option<PathBuf>,
    /// Keep nuts with NAME>=VALUE, NAME<=VALUE or NAME=VALUE; may be repeated.
    #[arg(long = "where", value_name = "CONDITION", help_heading = "List of nuts")]
    pub(crate) conditions: Vec<String>,
    /// Keep nuts that none beats in dynamic load rating, stiffness and mass together.
    #[arg(long, help_heading = "List of nuts")]
    pub(crate) pareto: bool,
    /// Sort by a column, the smallest first; -NAME puts the largest first.
    #[arg(long, value_name = "NAME", allow_hyphen_values = true, help_heading = "List of nuts")]
    pub(crate) sort: Option<String>,
    /// Keep this number of rows; unless given, the screen shows 20.
    #[arg(long, value_name = "N", help_heading = "List of nuts")]
    pub(crate) first: Option<NonZeroUsize>,
    #[command(flatten, next_help_heading = "List of nuts")]
    pub(crate) dialect: DialectArgs,
    #[command(flatten)]
    pub(crate) out: OutArgs,
}

impl SelectArgs {
    /// Returns true if nuts are listed instead of chosen by steps.
    pub(crate) fn is_list(&self) -> bool {
        self.requirement.is_none()
            || !self.conditions.is_empty()
            || self.pareto
            || self.sort.is_some()
            || self.first.is_some()
            || self.out.figures.is_some()
    }
}

#[derive(Debug, Args)]
pub(crate) struct SweepArgs {
    /// Case in JSON, without the inputs of the points; `-` reads standard input.
    #[arg(value_name = "CASE.json", required_unless_present_any = ["settings", "points"])]
    pub(crate) case: Option<PathBuf>,
    /// Set or replace an input of the case; may be repeated.
    #[arg(long = "set", value_name = "NAME=VALUE", allow_hyphen_values = true)]
    pub(crate) settings: Vec<String>,
    /// Input on a grid: NAME=START:STOP:COUNT, NAME=START:STOP:COUNT:log or NAME=V1,V2,..; repeated, the last one
    /// changes fastest.
    #[arg(long, value_name = "NAME=VALUES", required_unless_present_any = ["draw", "points"], allow_hyphen_values = true, help_heading = "Points")]
    pub(crate) vary: Vec<String>,
    /// Input at random: NAME=uniform:LOW:HIGH or NAME=normal:MEAN:DEVIATION.
    #[arg(
        long,
        value_name = "NAME=LAW",
        conflicts_with = "vary",
        requires = "samples",
        allow_hyphen_values = true,
        help_heading = "Points"
    )]
    pub(crate) draw: Vec<String>,
    /// Number of random points.
    #[arg(long, value_name = "N", requires = "draw", value_parser = count, help_heading = "Points")]
    pub(crate) samples: Option<u64>,
    /// Seed of the random points.
    #[arg(long, value_name = "S", requires = "draw", default_value_t = 0, help_heading = "Points")]
    pub(crate) seed: u64,
    /// Table of points, .csv, .jsonl, .parquet or `-`, whose columns are inputs in any unit; the case fills empty cells.
    #[arg(long, value_name = "TABLE", conflicts_with_all = ["vary", "draw"], help_heading = "Points")]
    pub(crate) points: Option<PathBuf>,
    /// Columns of the table to copy, such as an id.
    #[arg(
        long,
        value_name = "NAME,..",
        value_delimiter = ',',
        requires = "points",
        help_heading = "Points"
    )]
    pub(crate) keep: Vec<String>,
    #[command(flatten, next_help_heading = "Points")]
    pub(crate) dialect: DialectArgs,
    #[command(flatten)]
    pub(crate) model: ModelArgs,
    /// .csv, .jsonl, .parquet, .xlsx or `-`: a table; DIR/: its parts; .svg, .png: lines, .map.svg, .map.png: a map,
    /// .grid.csv: a matrix, of the first column; .txt: Modelica; .json: origin of the table. Repeatable.
    #[arg(short, long, value_name = "FILE", required = true, help_heading = "Output")]
    pub(crate) output: Vec<PathBuf>,
    /// Outputs to write, names of bsm schema output, all of a solve unless given; a picture shows the first one.
    #[arg(long, value_name = "NAME,..", value_delimiter = ',', help_heading = "Output")]
    pub(crate) columns: Option<Vec<String>>,
    /// Exit with 0 even if some rows have no result.
    #[arg(long, help_heading = "Run")]
    pub(crate) keep_going: bool,
    /// Continue a stopped run in its folder.
    #[arg(long, help_heading = "Run")]
    pub(crate) resume: bool,
    /// Only write the plan of a folder, for bsm parts run.
    #[arg(long, help_heading = "Run")]
    pub(crate) plan: bool,
    /// Rows in each part of a folder.
    #[arg(long, value_name = "N", value_parser = rows, help_heading = "Run")]
    pub(crate) rows_per_part: Option<NonZeroU64>,
    #[command(flatten, next_help_heading = "Run")]
    pub(crate) work: WorkArgs,
}

/// How the program works, whatever it answers.
#[derive(Debug, Args)]
pub(crate) struct WorkArgs {
    /// Number of threads, at most 1024; all cores unless given.
    #[arg(long, value_name = "N", value_parser = threads)]
    pub(crate) threads: Option<NonZeroUsize>,
    /// No progress bar.
    #[arg(long)]
    pub(crate) quiet: bool,
}

#[derive(Debug, Args)]
pub(crate) struct RunArgs {
    /// Folder with a plan.
    #[arg(value_name = "FOLDER")]
    pub(crate) folder: PathBuf,
    /// Parts to solve: I/N, every Nth part from I, so that N processes share all of them; or A:B, those from A to
    /// B - 1. Unless given, all missing parts.
    #[arg(long, value_name = "PARTS", value_parser = only)]
    pub(crate) only: Option<Only>,
    /// Verify all bytes of existing parts, solve changed ones again and renew parts.parquet.
    #[arg(long)]
    pub(crate) repair: bool,
    /// Table of points of the plan, unless it is beside the folder under its name.
    #[arg(long, value_name = "TABLE")]
    pub(crate) points: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) work: WorkArgs,
}

/// Some of the parts of a folder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Only {
    /// Those whose number leaves a remainder, and the divisor.
    Share(u64, NonZeroU64),
    /// From the first to before the last.
    Range(u64, u64),
}

/// Parses a number of rows, such as 5000 or 5e7.
fn count(text: &str) -> Result<u64, String> {
    /// Not every integer above this limit is a double.
    const MOST: f64 = 9_007_199_254_740_992.0;
    let whole = |number: &f64| number.fract() == 0.0 && (0.0..=MOST).contains(number);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked")]
    let of_float = || Some(text.parse::<f64>().ok().filter(whole)? as u64);
    let wrong = || "must be a whole number, such as 5000 or 5e7".to_owned();
    text.parse().ok().or_else(of_float).ok_or_else(wrong)
}

/// Parses a number of rows that is at least 1.
fn rows(text: &str) -> Result<NonZeroU64, String> {
    NonZeroU64::new(count(text)?).ok_or_else(|| "must be at least 1".to_owned())
}

/// Parses two values with a separator between them.
fn two<A: FromStr, B: FromStr>(text: &str, between: char) -> Option<(A, B)> {
    let (one, other) = text.split_once(between)?;
    Some((one.parse().ok()?, other.parse().ok()?))
}

/// Parses the selection of parts.
fn only(text: &str) -> Result<Only, String> {
    let share = two(text, '/').filter(|(index, of): &(u64, NonZeroU64)| *index < of.get());
    let range = two(text, ':').filter(|(from, to)| from < to);
    let share = share.map(|(index, of)| Only::Share(index, of));
    share.or(range.map(|(from, to)| Only::Range(from, to))).ok_or_else(|| {
        "must be I/N with I from 0 to N - 1, such as 0/100, or A:B, such as 0:100 for the parts 0 to 99".to_owned()
    })
}

#[derive(Debug, Args)]
pub(crate) struct CheckArgs {
    /// Folder with a plan.
    #[arg(value_name = "FOLDER")]
    pub(crate) folder: PathBuf,
    /// Read all bytes, not only the footers.
    #[arg(long)]
    pub(crate) deep: bool,
    /// Print JSON; bsm schema describes it.
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct FitArgs {
    #[command(flatten)]
    pub(crate) case: CaseArgs,
    /// Output of solve, nut or axis that was measured at this operating point, and its value in any unit; with --points its name
    /// alone.
    #[arg(
        long,
        value_name = "OUTPUT[=VALUE]",
        allow_hyphen_values = true,
        required_unless_present = "limit"
    )]
    pub(crate) measured: Option<String>,
    /// Title of a rule of the axis, such as "critical speed": find the values that just keep it.
    #[arg(long, value_name = "RULE", conflicts_with_all = ["measured", "points"])]
    pub(crate) limit: Option<String>,
    /// Input to find, and the range to search: 1e-4 to 0.5 for friction and 0.01 to 100 times the case's value for other inputs unless
    /// given, with --points 0.25 to 4 times; with --points it may be repeated.
    #[arg(
        long,
        value_name = "NAME[=LOW:HIGH]",
        default_value = "friction_coefficient",
        allow_hyphen_values = true
    )]
    pub(crate) input: Vec<String>,
    /// CSV table of measured points: a column of the output, and columns of inputs, such as screw_speed_rpm,
    /// axial_load_kN and lubricant_temperature_C; the case has the rest. -o may be .svg then, measured against fitted.
    #[arg(long, value_name = "TABLE.csv")]
    pub(crate) points: Option<PathBuf>,
    /// Errors of the measured values: proportional to the values (relative, the default) or equal at all points (absolute).
    /// Instead, the table may have a column of their standard deviations, such as screw_torque_Nm_error.
    #[arg(long, requires = "points", value_parser = PossibleValuesParser::new(MeasurementError::ALL.map(MeasurementError::name)))]
    pub(crate) errors: Option<String>,
    #[command(flatten)]
    pub(crate) dialect: DialectArgs,
    #[command(flatten)]
    pub(crate) model: ModelArgs,
    #[command(flatten)]
    pub(crate) out: OutArgs,
}

#[derive(Debug, Args)]
pub(crate) struct ValidateArgs {
    /// Only checks whose key contains this.
    #[arg(long, value_name = "KEY")]
    pub(crate) only: Option<String>,
    /// Folder with published data, laid out as validation/published, instead of the built-in data.
    #[arg(long, value_name = "DIR")]
    pub(crate) from: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) out: OutArgs,
}

#[derive(Debug, Args)]
pub(crate) struct TradeoffArgs {
    /// Table of operating points, as for bsm sweep, with all inputs of model traction; unless given, 300
    /// built-in points from rolling to gross skid.
    #[arg(long, value_name = "TABLE")]
    pub(crate) points: Option<PathBuf>,
    /// No progress bar.
    #[arg(long)]
    pub(crate) quiet: bool,
    #[command(flatten)]
    pub(crate) out: OutArgs,
}
