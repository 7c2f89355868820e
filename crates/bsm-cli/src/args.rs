//! Command-line arguments.

use std::num::{NonZeroU64, NonZeroUsize};
use std::path::{Path, PathBuf};
use std::str::FromStr;

use bsm_batch::TableFormat;
use bsm_batch::dataset::sha256;
use bsm_case::{
    Case, CaseError, Choice, DisplayUnits, MAX_EXACT_INTEGER, MeasurementError, ModelChoice, Rule,
    Settings,
};
use bsm_dyn::{Control, model::RacewayFriction};
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, CommandFactory, Parser, Subcommand, ValueEnum};

use crate::failure::Failure;
use crate::{files, schema};

/// Explanation of the exit codes, shown at the end of every help text.
const EXIT_CODES: &str = "Exit codes: 0 success; 1 error with files, disk, threads or memory; 2 \
                          invalid input or usage; 3 no solution or a failed check; 128 + N if \
                          signal N ended the program.";

/// Returns the command-line parser. The help text of every command ends with the exit codes.
pub(crate) fn command() -> clap::Command {
    fn with_exit_codes(command: clap::Command) -> clap::Command {
        command.after_help(EXIT_CODES).mut_subcommands(with_exit_codes)
    }
    let models = PossibleValuesParser::new(ModelChoice::names().chain([ALL_MODELS]));
    with_exit_codes(Cli::command())
        .mut_subcommand("solve", |solve| solve.mut_arg("model", |model| model.value_parser(models)))
}

/// Calculates the steady motion of the balls of a ball screw: loads, slip, spin, torque and
/// efficiency.
///
/// A case is a JSON file of inputs. The name of each input ends with its unit. To solve an example,
/// run `bsm solve examples/feed_drive.json`. For your own screw, copy this file or change its
/// inputs, for example with --set lead_mm=10 --set axial_load_kN=5. `bsm schema input` lists all
/// inputs. To choose a screw for a requirement, run
/// `bsm select examples/requirements/axis.json -o screw.json` and then `bsm axis screw.json`.
#[derive(Debug, Parser)]
#[command(name = "bsm", version = env!("BSM_VERSION"), arg_required_else_help = true)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Solve one operating point: motion, slip, jamming, optimum contact angle, load ratings.
    Solve(SolveArgs),
    /// Solve all balls of a nut: load sharing, stiffness, preload, life, torque. The case needs the
    /// inputs of `bsm solve --show ratings` and a load or a preload (see docs/guide/nut.md).
    Nut(NutArgs),
    /// Calculate a feed axis: critical speed, buckling, speed number, static safety, life,
    /// stiffness, torque and heat over a load cycle, with limits, margins and sources. The exit
    /// code is 3 if a rule fails. Example: bsm axis examples/axis.json
    Axis(AxisArgs),
    /// Choose the best screw for a requirement and print all steps of the choice, or filter and
    /// sort a list of standard or manufacturers' nuts. Example: bsm select
    /// examples/requirements/axis.json
    Select(SelectArgs),
    /// Solve many points: a grid (--vary), random points (--draw) or the rows of a table
    /// (--points). Example: bsm sweep examples/feed_drive.json --vary axial_load_kN=1:20:5
    /// --columns efficiency -o -
    Sweep(SweepArgs),
    /// Solve or check the parts of a folder whose plan was written by `bsm sweep -o DIR/ --plan`.
    #[cfg(feature = "parquet")]
    #[command(subcommand)]
    Parts(PartsCommand),
    #[cfg(not(feature = "parquet"))]
    #[command(hide = true)]
    Parts(NotBuilt),
    /// Find the friction coefficient or another input from a measured torque or another output.
    /// Example: bsm fit examples/feed_drive.json --measured screw_torque_Nm=26
    Fit(FitArgs),
    /// Show a screw in the browser, with graphics and results that are updated after every change.
    /// Example: bsm view examples/feed_drive.json --open
    #[cfg(feature = "view")]
    View(ViewArgs),
    #[cfg(not(feature = "view"))]
    #[command(hide = true)]
    View(NotBuilt),
    /// Check the program against published results.
    #[cfg(feature = "validate")]
    Validate(ValidateArgs),
    #[cfg(not(feature = "validate"))]
    #[command(hide = true)]
    Validate(NotBuilt),
    /// Measure the computing time and accuracy of every model and setting on this machine.
    #[cfg(feature = "validate")]
    Tradeoff(TradeoffArgs),
    #[cfg(not(feature = "validate"))]
    #[command(hide = true)]
    Tradeoff(NotBuilt),
    /// Print the JSON Schema of cases (`input`), of results of a point (`output`), or of the --json
    /// output of a command. `units` prints the units of each quantity. Without a name, print all
    /// names.
    Schema {
        /// Name of the schema to print.
        #[arg(value_parser = PossibleValuesParser::new(schema::names()))]
        name: Option<String>,
    },
}

/// Arguments of a command that is missing from this build. The arguments are accepted and ignored,
/// so that the command can report the missing feature.
#[cfg(not(all(feature = "parquet", feature = "validate", feature = "view")))]
#[derive(Debug, Args)]
#[command(disable_help_flag = true)]
pub(crate) struct NotBuilt {
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    arguments: Vec<std::ffi::OsString>,
}

#[cfg(feature = "parquet")]
#[derive(Debug, Subcommand)]
pub(crate) enum PartsCommand {
    /// Solve the parts of a plan. Any number of processes can share the work on one or more
    /// machines, in any order and repeatedly; finished parts are kept. Example for 100 tasks of a
    /// job scheduler: bsm parts run map/ --only $TASK/100
    Run(RunArgs),
    /// Check the footers of all parts, or all bytes with --deep. The exit code is 3 if a part is
    /// missing or damaged. If all parts exist, write parts.parquet and remove unfinished files.
    Check(CheckArgs),
}

/// Arguments that specify a case file and changes to its inputs.
#[derive(Debug, Args)]
pub(crate) struct CaseArgs {
    /// Case file in JSON; `-` reads standard input.
    #[arg(value_name = "CASE.json", required_unless_present = "settings")]
    case: Option<PathBuf>,
    /// Set or replace an input, for example --set screw_speed_rpm=3000. May be repeated.
    #[arg(long = "set", value_name = "NAME=VALUE", allow_hyphen_values = true)]
    settings: Vec<String>,
    #[command(flatten)]
    units: UnitsArgs,
}

/// Option for the display units.
#[derive(Debug, Args)]
pub(crate) struct UnitsArgs {
    /// Units of screen output, sheets, figures and table columns. JSON always has metric units.
    #[arg(long, value_name = "UNITS", value_parser = display_units())]
    units: Option<DisplayUnits>,
}

/// Returns the parser of the display units.
fn display_units() -> impl TypedValueParser<Value = DisplayUnits> {
    let names = DisplayUnits::NAMES.iter().map(|(name, _)| *name);
    PossibleValuesParser::new(names)
        .try_map(|name| DisplayUnits::from_name(&name).ok_or("unknown units"))
}

impl UnitsArgs {
    /// Appends the display units to the settings of a case or a requirement, if they are given.
    pub(crate) fn added_to(&self, settings: &[String]) -> Vec<String> {
        let units = self.units.map(|units| format!("display_units={}", units.name()));
        settings.iter().cloned().chain(units).collect()
    }
}

impl CaseArgs {
    /// Returns the path of the case file for use in messages, or `--set` if there is no case file.
    pub(crate) fn path(&self) -> &Path {
        self.case.as_deref().unwrap_or(Path::new("--set"))
    }

    /// Reads the case, applies the settings and estimates missing groove inputs.
    pub(crate) fn read(&self) -> Result<Case, Failure> {
        self.read_as_given()?.with_groove().map_err(self.failure())
    }

    /// Reads the case and applies the settings without estimating a groove.
    pub(crate) fn read_as_given(&self) -> Result<Case, Failure> {
        files::read_case(self.case.as_deref(), &self.units.added_to(&self.settings))
    }

    /// Reads a second case file and applies the same settings as for the first case.
    pub(crate) fn read_other(&self, path: &Path) -> Result<Case, Failure> {
        files::read_case(Some(path), &self.units.added_to(&self.settings))
    }

    /// Returns the name and SHA-256 hash of the case file, or `None` if the case does not come from
    /// a file.
    pub(crate) fn hash(&self) -> Option<String> {
        let path = self.case.as_deref().filter(|path| path.is_file())?;
        let name = path.file_name()?.to_string_lossy();
        Some(format!("{name}, SHA-256 {}", sha256(path).ok()?.0))
    }

    /// Returns a function that converts an error in the case to a failure.
    pub(crate) fn failure(&self) -> impl Fn(CaseError) -> Failure + Copy {
        |error| Failure::case(self.path(), &error)
    }
}

/// Options that select the model and its solver settings.
#[derive(Debug, Args)]
#[command(next_help_heading = "Model")]
pub(crate) struct ModelArgs {
    /// Model to use; auto chooses the fastest model whose error is within the tolerance.
    #[arg(long, default_value = "auto", value_parser = PossibleValuesParser::new(ModelChoice::names()))]
    pub(crate) model: String,
    /// Largest error of the efficiency that model auto accepts; defaults to 0.01.
    #[arg(long, value_name = "ERROR", value_parser = number_of(Settings::TOLERANCE))]
    tolerance: Option<f64>,
    /// Relative error of the friction integrals in traction; defaults to 1e-8.
    #[arg(long, value_name = "ERROR", value_parser = number_of(Settings::ACCURACY))]
    accuracy: Option<f64>,
    /// Creep speed of model traction, divided by ball radius times relative speed of screw and nut;
    /// defaults to 1e-4.
    #[arg(long, value_name = "RATIO", value_parser = number_of(Settings::CREEP))]
    creep: Option<f64>,
    /// Controlling raceway in raceway-control: nut or screw (default: automatic).
    #[arg(long, value_name = "RACEWAY", hide_possible_values = true, value_parser = PossibleValuesParser::new(Control::ALL.map(Control::name)))]
    control: Option<String>,
    /// Friction of a lubricant film in model raceway-control: local (at each point, the default) or
    /// contact (one coefficient per contact).
    #[arg(long, value_name = "PLACE", hide_possible_values = true, value_parser = PossibleValuesParser::new(RacewayFriction::ALL.map(RacewayFriction::name)))]
    friction: Option<String>,
}

/// Value of `--model` that compares all models.
pub(crate) const ALL_MODELS: &str = "all";

impl ModelArgs {
    /// Returns the model settings that the options specify.
    pub(crate) fn settings(&self) -> Result<Settings, Failure> {
        let named = Settings::named(&self.model, self.control.as_deref(), self.friction.as_deref());
        let with_numbers = |named: Settings| Settings {
            tolerance: self.tolerance.unwrap_or(named.tolerance),
            accuracy: self.accuracy.unwrap_or(named.accuracy),
            creep: self.creep.unwrap_or(named.creep),
            ..named
        };
        let checked = named.and_then(|named| with_numbers(named).checked());
        checked.map_err(|error| Failure::input(Self::option_of(&error), &error))
    }

    /// Returns the option that caused an error in the settings.
    fn option_of(error: &CaseError) -> &'static str {
        const OPTIONS: [&str; 5] =
            ["--tolerance", "--accuracy", "--creep", "--control", "--friction"];
        let is_cause = |option: &&str| error.key() == Some(option.trim_start_matches('-'));
        OPTIONS.into_iter().find(is_cause).unwrap_or("--model")
    }

    /// Returns true if the command line contains any model setting.
    pub(crate) fn has_settings(&self) -> bool {
        let numbers = [self.tolerance, self.accuracy, self.creep];
        numbers.iter().any(Option::is_some) || self.control.is_some() || self.friction.is_some()
    }
}

/// Returns a parser that accepts only numbers that a rule permits.
fn number_of(rule: Rule) -> impl Fn(&str) -> Result<f64, String> + Clone {
    move |text| {
        let number = text.parse().ok().filter(|number| rule.holds::<f64>(*number));
        number.ok_or_else(|| format!("must be {}", rule.describe()))
    }
}

/// Options for the format of a CSV table.
#[derive(Debug, Args)]
#[command(next_help_heading = "Table")]
pub(crate) struct DialectArgs {
    /// Column separator in CSV: comma (default), semicolon, tab or bar.
    #[arg(long, value_name = "SIGN", hide_possible_values = true)]
    delimiter: Option<Delimiter>,
    /// Decimal sign in CSV: point (default) or comma.
    #[arg(long, value_name = "SIGN", hide_possible_values = true)]
    decimal: Option<Decimal>,
}

/// Options for the column names and the format of an input table.
#[derive(Debug, Args)]
#[command(next_help_heading = "Table")]
pub(crate) struct NamedTableArgs {
    #[command(flatten)]
    dialect: DialectArgs,
    /// JSON file that maps your column names to ours; null ignores a column.
    #[arg(long, value_name = "FILE")]
    pub(crate) names: Option<PathBuf>,
    /// CSV format of the output: standard, or same (--delimiter and --decimal).
    #[arg(
        long,
        value_name = "FORMAT",
        default_value = "standard",
        hide_possible_values = true,
        hide_default_value = true
    )]
    csv_format: CsvFormat,
}

/// CSV format of an output table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum CsvFormat {
    Standard,
    Same,
}

/// Column separator of a CSV table.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum Delimiter {
    Comma,
    Semicolon,
    Tab,
    Bar,
}

/// Decimal sign of numbers in a CSV table.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum Decimal {
    Point,
    Comma,
}

impl DialectArgs {
    /// Returns the table format, with the column names of this program.
    pub(crate) fn format(&self) -> TableFormat {
        let mut format = TableFormat::default();
        if let Some(delimiter) = self.delimiter {
            format.delimiter = match delimiter {
                Delimiter::Comma => ',',
                Delimiter::Semicolon => ';',
                Delimiter::Tab => '\t',
                Delimiter::Bar => '|',
            };
        }
        if let Some(decimal) = self.decimal {
            format.decimal = match decimal {
                Decimal::Point => '.',
                Decimal::Comma => ',',
            };
        }
        format
    }

    /// Returns an error if one of the table format options is given although no table is read.
    ///
    /// * `table`: name of the option that specifies the table.
    pub(crate) fn only_with(&self, table: &str) -> Result<(), Failure> {
        let given = [self.delimiter.map(|_| "--delimiter"), self.decimal.map(|_| "--decimal")];
        not_without_table(given.into_iter().flatten().next(), table)
    }
}

impl NamedTableArgs {
    /// Returns the table format, with the column names from the file of `--names`.
    pub(crate) fn format(&self) -> Result<TableFormat, Failure> {
        let mut format = self.dialect.format();
        if let Some(map) = &self.names {
            format.names = files::names_of_columns(map)?;
        }
        Ok(format)
    }

    /// Returns the format of output tables.
    pub(crate) fn output_format(&self) -> TableFormat {
        match self.csv_format {
            CsvFormat::Standard => TableFormat::default(),
            CsvFormat::Same => self.dialect.format(),
        }
    }

    /// Returns an error if an option for input tables is given although no table is read. Format
    /// options are permitted if they also determine the format of the output.
    ///
    /// * `table`: name of the option that specifies the table.
    pub(crate) fn only_with(&self, table: &str) -> Result<(), Failure> {
        if self.csv_format == CsvFormat::Standard {
            self.dialect.only_with(table)?;
        }
        not_without_table(self.names.as_ref().map(|_| "--names"), table)
    }
}

/// Returns an error if an option for input tables is given although no table is read.
fn not_without_table(option: Option<&str>, table: &str) -> Result<(), Failure> {
    option.map_or(Ok(()), |option| {
        Err(Failure::Input(format!("{option} applies only to the table of {table}")))
    })
}

/// Parses a number of threads. An upper limit prevents overloading the machine.
pub(crate) fn threads(text: &str) -> Result<NonZeroUsize, String> {
    match text.parse::<NonZeroUsize>() {
        Ok(threads) if threads.get() <= 1024 => Ok(threads),
        _ => Err("must be a whole number from 1 to 1024, such as 4".to_owned()),
    }
}

/// Options for output files and JSON output.
#[derive(Debug, Default, Args)]
#[command(next_help_heading = "Output")]
pub(crate) struct OutArgs {
    /// Output file: .html for the page, .json for the output of --json. May be repeated.
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Vec<PathBuf>,
    /// Folder for report.html, results.json and the subfolder figures (SVG and CSV).
    #[arg(long, value_name = "DIR")]
    pub(crate) figures: Option<PathBuf>,
    /// Print JSON. `bsm schema` describes its structure.
    #[arg(long)]
    pub(crate) json: bool,
}

/// Results that `bsm solve --show` can print.
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
#[command(
    mut_arg("output", |arg| arg.help(
        "Output file: .json for the output of --json; .csv or .xlsx for ratings and intermediate results. May be repeated"
    )),
    mut_arg("figures", |arg| arg.help(
        "Folder for figures (SVG and CSV) of sweeps around the case: slip, jamming, optimum"
    ))
)]
pub(crate) struct SolveArgs {
    #[command(flatten)]
    pub(crate) case: CaseArgs,
    /// Results to print. motion: without intervals (the default without a lubricant); band: motion
    /// with the 90 % interval of friction from oil (the default with a lubricant); sensitivities:
    /// motion with derivatives with respect to each input; slip; ellipses: pressure, slip and
    /// friction at each point (a table with -o); jam; optimum: contact angle with the highest
    /// efficiency; ratings of the nut; steps: ratings with intermediate results.
    #[arg(long, value_name = "WHAT,..", value_delimiter = ',', value_enum)]
    pub(crate) show: Vec<Show>,
    /// Number of points per semi-axis for --show ellipses. Defaults to 20.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=500))]
    pub(crate) points: Option<u32>,
    #[command(flatten)]
    pub(crate) model: ModelArgs,
    #[command(flatten)]
    pub(crate) out: OutArgs,
}

#[cfg(feature = "view")]
#[derive(Debug, Args)]
pub(crate) struct ViewArgs {
    #[command(flatten)]
    pub(crate) case: CaseArgs,
    /// Additional cases to compare with the first case. --set applies to all cases.
    #[arg(value_name = "CASE.json")]
    pub(crate) beside: Vec<PathBuf>,
    /// Port of the server on 127.0.0.1. Defaults to a free port.
    #[arg(long, default_value_t = 0, hide_default_value = true)]
    pub(crate) port: u16,
    /// Open the page in the browser.
    #[arg(long)]
    pub(crate) open: bool,
    /// PAGE.html: write the page as one file that contains the solver and needs neither a server
    /// nor a network. CASE.json: file to which the button "Save case" writes. By default, the
    /// browser saves the case.
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) model: ModelArgs,
}

/// Tables that `bsm nut --show` can write.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum NutTable {
    Balls,
    Curve,
}

#[derive(Debug, Args)]
#[command(
    mut_arg("output", |arg| arg.help(
        "Output file: .csv, .jsonl, .parquet, .xlsx or `-` for the table of --show; .json for the output of --json. May be repeated"
    )),
    mut_arg("figures", |arg| arg.help(
        "Folder for figures (SVG and CSV): loads and angles along the helix, displacement, preload"
    ))
)]
pub(crate) struct NutArgs {
    #[command(flatten)]
    pub(crate) case: CaseArgs,
    /// Table that -o writes. balls: one row per ball; curve: displacement, stiffness and remaining
    /// preload as functions of the axial load, up to loads above the given load and the limit load.
    #[arg(long, value_enum, default_value = "balls", requires_if("curve", "output"))]
    pub(crate) show: NutTable,
    /// Solve N nuts with random ball diameters (ball_deviation_sd_um) and phases of lead_error, and
    /// print quantiles of the results.
    #[arg(long, value_name = "N", value_parser = parse_whole_number, conflicts_with = "figures")]
    pub(crate) samples: Option<u64>,
    /// Seed of the samples. Defaults to the seed of the case.
    #[arg(long, value_name = "S", requires = "samples")]
    pub(crate) seed: Option<u64>,
    #[command(flatten)]
    pub(crate) model: ModelArgs,
    #[command(flatten)]
    pub(crate) out: OutArgs,
}

#[derive(Debug, Args)]
#[command(mut_arg("output", |arg| arg.help(
    "Output file: .html for the page, .json for the output of --json, .csv for the rules, .dxf for the groove profiles. May be repeated"
)))]
pub(crate) struct AxisArgs {
    #[command(flatten)]
    pub(crate) case: CaseArgs,
    /// Second offer, which is compared with the first offer under the same --set and --cycle.
    #[arg(value_name = "OTHER.json")]
    pub(crate) other: Option<PathBuf>,
    /// Load cycle in CSV, which replaces the cycle of the case. Columns, in any unit: time_s or
    /// share, force_N, feed_m_min or screw_speed_rpm, acceleration_m_s2.
    #[arg(long, value_name = "CYCLE.csv")]
    pub(crate) cycle: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) table: NamedTableArgs,
    #[command(flatten)]
    pub(crate) model: ModelArgs,
    #[command(flatten)]
    pub(crate) out: OutArgs,
}

/// Lists that `bsm select --show` can print.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum SelectShow {
    Keys,
    Lists,
    Sizes,
    Columns,
}

#[derive(Debug, Args)]
#[command(
    mut_arg("output", |arg| arg.help(
        "Output file: .json for the case of the screw or of the first nut; .csv, .xlsx or `-` for the steps; .csv, .xlsx, `-`, .jsonl or .parquet for a list of nuts. May be repeated"
    )),
    mut_arg("figures", |arg| arg.help(
        "Folder for figures (SVG and CSV): the figures of Sobolewski (2002) for the listed nuts, or ratings, stiffness and mass of the nuts in a TABLE.csv"
    ))
)]
pub(crate) struct SelectArgs {
    /// Requirement in JSON: load, motion, stroke, life; `-` reads standard input. Without list
    /// options, the best screw is chosen. With list options, the nuts that meet the requirement are
    /// listed.
    #[arg(value_name = "REQUIREMENT.json")]
    pub(crate) requirement: Option<PathBuf>,
    /// Set or replace a key of the requirement, for example --set objective=mass. May be repeated.
    #[arg(
        long = "set",
        value_name = "NAME=VALUE",
        allow_hyphen_values = true,
        requires = "requirement"
    )]
    settings: Vec<String>,
    #[command(flatten)]
    units: UnitsArgs,
    /// Optimize sizes and contact angles as continuous variables, with standard balls and the
    /// limits of Lin, Velinsky and Ravani (1994).
    #[arg(long, requires = "requirement", conflicts_with_all = ["from", "conditions", "pareto", "sort", "first", "columns", "figures"])]
    pub(crate) free: bool,
    /// Print the keys of a requirement, the standard lists or the manufacturers' sizes (to copy and
    /// edit), or the columns of a nut list.
    #[arg(long, value_name = "WHAT", value_enum)]
    pub(crate) show: Option<SelectShow>,
    /// Sizes to choose from: manufacturers (THK and HIWIN, the default), standard (all combinations
    /// of ISO 3408-2 at 45 degrees), LISTS.json, a TABLE.csv of sizes (see --show sizes), or a
    /// TABLE.csv of nuts with nut, lead_mm, ball_diameter_mm, circuits or loaded_turns,
    /// core_diameter_mm or pitch_circle_diameter_mm, ratings.
    #[arg(long, value_name = "SIZES")]
    pub(crate) from: Option<PathBuf>,
    /// List only nuts with NAME>=VALUE, NAME<=VALUE or NAME=VALUE. NAME may end with any unit. May
    /// be repeated.
    #[arg(long = "where", value_name = "CONDITION", help_heading = "List of nuts")]
    pub(crate) conditions: Vec<String>,
    /// List only nuts that are Pareto-optimal in dynamic load rating, stiffness and mass.
    #[arg(long, help_heading = "List of nuts")]
    pub(crate) pareto: bool,
    /// Sort by a column in ascending order, or in descending order with -NAME.
    #[arg(long, value_name = "NAME", allow_hyphen_values = true, help_heading = "List of nuts")]
    pub(crate) sort: Option<String>,
    /// List only the first N nuts. By default, the screen shows 20 nuts.
    #[arg(long, value_name = "N", help_heading = "List of nuts")]
    pub(crate) first: Option<NonZeroUsize>,
    /// Comma-separated columns of the list. Their names may end with any unit, for example lead_in.
    #[arg(long, value_name = "NAME,..", value_delimiter = ',', help_heading = "List of nuts")]
    pub(crate) columns: Option<Vec<String>>,
    #[command(flatten)]
    pub(crate) table: NamedTableArgs,
    #[command(flatten)]
    pub(crate) out: OutArgs,
}

impl SelectArgs {
    /// Returns true if the command lists nuts instead of choosing the best screw.
    pub(crate) fn is_list(&self) -> bool {
        self.requirement.is_none()
            || !self.conditions.is_empty()
            || self.pareto
            || self.sort.is_some()
            || self.first.is_some()
            || self.columns.is_some()
            || self.out.figures.is_some()
    }

    /// Returns the settings of the requirement, including the option `--units`.
    pub(crate) fn settings(&self) -> Vec<String> {
        self.units.added_to(&self.settings)
    }

    /// Returns the display units. Without the option `--units`, these are the display units of the
    /// case `nut`, or metric units if there is no such case.
    pub(crate) fn display(&self, nut: Option<&Case>) -> DisplayUnits {
        self.units.units.or(nut.map(Case::display_units)).unwrap_or_default()
    }
}

#[derive(Debug, Args)]
#[command(mut_arg("units", |arg| arg.help(
    "Units of plots and table columns. A folder of parts always has metric units"
)))]
pub(crate) struct SweepArgs {
    /// Case in JSON, without the inputs of the points; `-` reads standard input.
    #[arg(value_name = "CASE.json", required_unless_present_any = ["settings", "points"])]
    pub(crate) case: Option<PathBuf>,
    /// Set or replace an input of the case. May be repeated.
    #[arg(long = "set", value_name = "NAME=VALUE", allow_hyphen_values = true)]
    pub(crate) settings: Vec<String>,
    #[command(flatten)]
    pub(crate) units: UnitsArgs,
    /// Varied input: NAME=START:STOP:COUNT, NAME=START:STOP:COUNT:log or NAME=V1,V2,.. May be
    /// repeated; the last input varies fastest.
    #[arg(long, value_name = "NAME=VALUES", required_unless_present_any = ["draw", "points"], allow_hyphen_values = true, help_heading = "Points")]
    pub(crate) vary: Vec<String>,
    /// Random input: NAME=uniform:LOW:HIGH or NAME=normal:MEAN:DEVIATION.
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
    #[arg(long, value_name = "N", requires = "draw", value_parser = parse_whole_number, help_heading = "Points")]
    pub(crate) samples: Option<u64>,
    /// Seed of the random points.
    #[arg(long, value_name = "S", requires = "draw", default_value_t = 0, help_heading = "Points")]
    pub(crate) seed: u64,
    /// Table of points (.csv, .jsonl, .parquet or `-`) whose columns are inputs in any unit. Empty
    /// cells are filled with the values of the case.
    #[arg(long, value_name = "TABLE", conflicts_with_all = ["vary", "draw"], help_heading = "Points")]
    pub(crate) points: Option<PathBuf>,
    /// Columns of the table to copy to the output.
    #[arg(
        long,
        value_name = "NAME,..",
        value_delimiter = ',',
        requires = "points",
        help_heading = "Points"
    )]
    pub(crate) keep: Vec<String>,
    #[command(flatten)]
    pub(crate) table: NamedTableArgs,
    #[command(flatten)]
    pub(crate) model: ModelArgs,
    /// Output file. .csv, .jsonl, .parquet, .xlsx, `-`: table; DIR/: its parts; .svg, .png: curves;
    /// .map.svg, .map.png: map; .grid.csv: matrix of one output; .txt: Modelica; .json: origin of
    /// the table. May be repeated.
    #[arg(short, long, value_name = "FILE", required = true, help_heading = "Output")]
    pub(crate) output: Vec<PathBuf>,
    /// Comma-separated outputs to write (see `bsm schema output`), in any unit, for example
    /// screw_torque_lbf_in. Defaults to all outputs of a solve. Plots show the first output.
    #[arg(long, value_name = "NAME,..", value_delimiter = ',', help_heading = "Output")]
    pub(crate) columns: Option<Vec<String>>,
    /// Exit with 0 even if some rows have no result.
    #[arg(long, help_heading = "Run")]
    pub(crate) keep_going: bool,
    /// Continue an interrupted run whose results are in a folder.
    #[arg(long, help_heading = "Run")]
    pub(crate) resume: bool,
    /// Write only the plan of a folder; `bsm parts run` solves the plan.
    #[arg(long, help_heading = "Run")]
    pub(crate) plan: bool,
    /// Number of rows in each part of a folder.
    #[arg(long, value_name = "N", value_parser = parse_rows, help_heading = "Run")]
    pub(crate) rows_per_part: Option<NonZeroU64>,
    #[command(flatten, next_help_heading = "Run")]
    pub(crate) work: WorkArgs,
}

/// Options that affect how a command runs, but not its results.
#[derive(Debug, Args)]
pub(crate) struct WorkArgs {
    /// Number of threads, at most 1024. Defaults to all cores.
    #[arg(long, value_name = "N", value_parser = threads)]
    pub(crate) threads: Option<NonZeroUsize>,
    /// Hide the progress bar.
    #[arg(long)]
    pub(crate) quiet: bool,
}

#[derive(Debug, Args)]
pub(crate) struct RunArgs {
    /// Folder that contains the plan.
    #[arg(value_name = "FOLDER")]
    pub(crate) folder: PathBuf,
    /// Parts to solve: I/N for every Nth part starting with I, so that N processes share all parts,
    /// or A:B for the parts A to B - 1. Defaults to all missing parts.
    #[arg(long, value_name = "PARTS", value_parser = parse_parts)]
    pub(crate) only: Option<PartSelection>,
    /// Verify all bytes of existing parts, solve damaged parts again and rewrite parts.parquet.
    #[arg(long)]
    pub(crate) repair: bool,
    /// Table of points. Defaults to the file that the plan names, next to the folder of the plan.
    #[arg(long, value_name = "TABLE")]
    pub(crate) points: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) work: WorkArgs,
}

/// A selection of parts of a dataset.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum PartSelection {
    /// `K/N`: selects every part whose number modulo N equals K.
    Share(u64, NonZeroU64),
    /// Selects the parts from the first number up to, but not including, the second number.
    Range(u64, u64),
}

#[cfg(feature = "parquet")]
impl PartSelection {
    /// Returns the numbers of the selected parts in increasing order.
    ///
    /// * `all`: number of parts of the dataset.
    ///
    /// # Errors
    /// Returns a message if the selection contains parts that the dataset does not have.
    pub(crate) fn numbers(self, all: u64) -> Result<impl Iterator<Item = u64> + Clone, String> {
        let (parts, step) = match self {
            Self::Share(first, step) => (first..all, step.get()),
            Self::Range(from, to) if to > all => {
                return Err(format!("--only {from}:{to} is outside the parts 0:{all} of the plan"));
            }
            Self::Range(from, to) => (from..to, 1),
        };
        Ok(parts.step_by(usize::try_from(step).unwrap_or(usize::MAX)))
    }
}

/// Parses a nonnegative whole number such as 5000 or 5e7.
fn parse_whole_number(text: &str) -> Result<u64, String> {
    let whole = |number: &f64| number.fract() == 0.0 && (0.0..=MAX_EXACT_INTEGER).contains(number);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked")]
    let of_float = || Some(text.parse::<f64>().ok().filter(whole)? as u64);
    let wrong = || "must be a whole number, such as 5000 or 5e7".to_owned();
    text.parse().ok().or_else(of_float).ok_or_else(wrong)
}

/// Parses a number of rows and checks that it is at least 1.
fn parse_rows(text: &str) -> Result<NonZeroU64, String> {
    NonZeroU64::new(parse_whole_number(text)?).ok_or_else(|| "must be at least 1".to_owned())
}

/// Parses two values that are separated by the character `between`.
fn parse_pair<A: FromStr, B: FromStr>(text: &str, between: char) -> Option<(A, B)> {
    let (one, other) = text.split_once(between)?;
    Some((one.parse().ok()?, other.parse().ok()?))
}

/// Parses a selection of parts: `I/N` or `A:B`.
fn parse_parts(text: &str) -> Result<PartSelection, String> {
    let share = parse_pair(text, '/').filter(|(index, of): &(u64, NonZeroU64)| *index < of.get());
    let range = parse_pair(text, ':').filter(|(from, to)| from < to);
    let share = share.map(|(index, of)| PartSelection::Share(index, of));
    share.or(range.map(|(from, to)| PartSelection::Range(from, to))).ok_or_else(|| {
        "must be I/N with I from 0 to N - 1, such as 0/100, or A:B, such as 0:100 for parts 0 to 99".to_owned()
    })
}

#[derive(Debug, Args)]
pub(crate) struct CheckArgs {
    /// Folder that contains the plan.
    #[arg(value_name = "FOLDER")]
    pub(crate) folder: PathBuf,
    /// Verify all bytes of the parts, not only the footers.
    #[arg(long)]
    pub(crate) deep: bool,
    /// Print JSON. `bsm schema` describes its structure.
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
#[command(
    mut_arg("output", |arg| arg.help(
        "Output file: .json for the output of --json; with --points also .svg or .png for a plot of measured and fitted values. May be repeated"
    )),
    mut_arg("figures", |arg| arg.help(
        "Folder for the figure of --points (SVG and CSV)"
    ))
)]
pub(crate) struct FitArgs {
    #[command(flatten)]
    pub(crate) case: CaseArgs,
    /// Measured output of solve, nut or axis and its value in any unit. With --points, give only
    /// the name of the output.
    #[arg(
        long,
        value_name = "OUTPUT[=VALUE]",
        allow_hyphen_values = true,
        required_unless_present = "limit"
    )]
    pub(crate) measured: Option<String>,
    /// Find the input values at which a rule of `bsm axis` reaches its limit. RULE is the title of
    /// the rule, such as "critical speed".
    #[arg(long, value_name = "RULE", conflicts_with_all = ["measured", "points"])]
    pub(crate) limit: Option<String>,
    /// Input to find, and its range. The range defaults to 1e-4 to 0.5 for friction, and to 0.01 to
    /// 100 times the value of the case for other inputs (0.25 to 4 times with --points). May be
    /// repeated with --points.
    #[arg(
        long,
        value_name = "NAME[=LOW:HIGH]",
        default_value = "friction_coefficient",
        allow_hyphen_values = true
    )]
    pub(crate) input: Vec<String>,
    /// CSV table of measured points, with a column for the measured output and columns for inputs
    /// such as screw_speed_rpm, axial_load_kN and lubricant_temperature_C. The case contains the
    /// other inputs.
    #[arg(long, value_name = "TABLE.csv")]
    pub(crate) points: Option<PathBuf>,
    /// Errors of the measured values: proportional to the values (relative, the default) or equal
    /// at all points (absolute). Alternatively, the table may contain the standard deviations of
    /// the measured values in a column such as screw_torque_Nm_error.
    #[arg(long, requires = "points", value_parser = PossibleValuesParser::new(MeasurementError::ALL.map(MeasurementError::name)))]
    pub(crate) errors: Option<String>,
    #[command(flatten)]
    pub(crate) dialect: DialectArgs,
    #[command(flatten)]
    pub(crate) model: ModelArgs,
    #[command(flatten)]
    pub(crate) out: OutArgs,
}

#[cfg(feature = "validate")]
#[derive(Debug, Args)]
pub(crate) struct ValidateArgs {
    /// Run only the checks whose key contains KEY.
    #[arg(long, value_name = "KEY")]
    pub(crate) only: Option<String>,
    /// Folder with published data in the layout of validation/published. Defaults to the built-in
    /// data.
    #[arg(long, value_name = "DIR")]
    pub(crate) from: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) out: OutArgs,
}

#[cfg(feature = "validate")]
#[derive(Debug, Args)]
pub(crate) struct TradeoffArgs {
    /// Table of operating points (see `bsm sweep`) with all inputs of model traction. Defaults to
    /// 300 built-in points from rolling to gross skid.
    #[arg(long, value_name = "TABLE")]
    pub(crate) points: Option<PathBuf>,
    /// Hide the progress bar.
    #[arg(long)]
    pub(crate) quiet: bool,
    #[command(flatten)]
    pub(crate) out: OutArgs,
}
