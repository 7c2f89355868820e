//! Command-line arguments.

use std::num::{NonZeroU64, NonZeroUsize};
use std::path::PathBuf;
use std::str::FromStr;

use bsm_case::{CaseError, ModelChoice, Rule, Settings};
use bsm_dyn::{Control, Model, RacewayFriction};
use clap::builder::PossibleValuesParser;
use clap::{Args, Parser, Subcommand, ValueEnum};

/// What the exit codes mean, at the end of every help text.
const EXIT_CODES: &str = "Exit codes: 0 all solved and all checks passed; 1 a problem with files, disk, \
                          threads or memory; 2 bad input or usage; 3 no solution, not converged, or \
                          a check failed; 128 plus the number of the signal if interrupted.";

/// Steady motion of the balls of a ball screw: loads, slip, spin, torque, efficiency.
///
/// A scene is a JSON file of inputs whose names carry their units. A feed drive: bsm solve
/// examples/feed_drive.json. Your own screw: copy that file, or change it, such as with --set lead_mm=10 --set
/// axial_load_kN=5; `bsm schema input` lists all inputs. From a requirement to a screw: bsm design
/// examples/requirements/axis.json -o screw.json, then bsm size screw.json.
#[derive(Debug, Parser)]
#[command(name = "bsm", version, propagate_version = true, arg_required_else_help = true)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Solve one operating point.
    #[command(after_help = EXIT_CODES)]
    Solve(SolveArgs),
    /// Solve one operating point with every model whose inputs are given, side by side; exit code 3
    /// if one of them has no solution.
    #[command(after_help = EXIT_CODES)]
    Compare(CompareArgs),
    /// Vary one or more inputs over a full grid; write a table and a plot.
    #[command(after_help = EXIT_CODES)]
    Sweep(SweepArgs),
    /// Solve a table of operating points: one row in, one row out, in the same order.
    #[command(after_help = EXIT_CODES)]
    Batch(BatchArgs),
    /// Solve parts of a folder that `sweep --plan` or `batch --plan` has planned, on this machine or any other.
    ///
    /// Any number of processes may do so at once, in any order, more than once: parts that are there are kept, and the bytes are
    /// those of one machine. Without a choice all that is missing is solved. Example, of 100 tasks of a scheduler:
    /// bsm shard map/ --index $TASK --of 100. Then: bsm verify map/
    #[command(after_help = EXIT_CODES)]
    Shard(ShardArgs),
    /// Check the parts of a folder: every part there, and as it was written. Exit code 3 if one is missing or damaged.
    ///
    /// When all are there it writes shards.parquet, and removes what killed runs have left.
    #[command(after_help = EXIT_CODES)]
    Verify(VerifyArgs),
    /// Contact angle of best efficiency, and self-locking limits.
    #[command(after_help = EXIT_CODES)]
    Optimum(OptimumArgs),
    /// Load ratings, rigidity and efficiency of a nut from its geometry.
    ///
    /// The nut is a scene with ball diameter, pitch circle, lead, contact angle, conformities,
    /// loaded_balls_per_turn and loaded_turns. Rigidity is that of a preloaded pair of nuts (preload_N, or
    /// 0.15 of the dynamic load rating), or of one nut under axial_load_N. The rating life needs
    /// axial_load_N and screw_speed_rpm, or a load spectrum.
    #[command(after_help = EXIT_CODES)]
    Capacity(CapacityArgs),
    /// All balls of a nut: how they share the load, stiffness, preload, life, torque.
    ///
    /// The nut is a scene as for bsm capacity, with axial_load_N or a preload (preload_N, preload_offset_um,
    /// ball_oversize_um). circuits lists loaded arcs and balls, or circuits_count and gap_deg divide
    /// loaded_turns. nut_guidance free, side loads, moments, elastic bodies (nut_anchor, screw_anchor, ring_expansion)
    /// and errors (ball_deviation_um, lead_error) make the sharing uneven. Static and without friction; the model gives
    /// the friction of each ball at its own load.
    #[command(after_help = EXIT_CODES)]
    Nut(NutArgs),
    /// The axis around a screw, from a requirement to a calculation sheet.
    ///
    /// Critical speed, buckling, speed number, static safety, life, rigidity, torque and heat over the cycle, each
    /// by the rule that makers' catalogues share, with its limit, margin and source. The scene has the nut as
    /// for bsm capacity, axial_load_N and feed_m_min or screw_speed_rpm or a cycle, and of the axis what is
    /// known: stroke_mm, support, moved_mass_kg, inclination_deg, required_life_h, preload_N and others.
    /// Exit code 3 if a rule fails. Try: bsm size examples/axis.json
    #[command(after_help = EXIT_CODES)]
    Size(SizeArgs),
    /// Friction coefficient, or another input, from a measured torque or another output.
    ///
    /// Example: bsm fit examples/feed_drive.json --measured screw_torque_Nm=26. Prints every value in
    /// the range that gives the measured output, with the result of the model there. Model auto takes
    /// the most complete model here.
    #[command(after_help = EXIT_CODES)]
    Fit(FitArgs),
    /// The best screw for a requirement: load, motion, lead, length, speed, life.
    ///
    /// Prints the steps of Lin, Velinsky and Ravani (1994): each value, its limit, and whether it passes.
    /// What the requirement leaves open is chosen among standard sizes for the largest efficiency or load rating, or the
    /// smallest mass; --free takes any size with balls of standard diameters and whole numbers of balls per turn.
    /// With support in the requirement, critical speed, buckling and static safety are checked too.
    #[command(after_help = EXIT_CODES)]
    Design(DesignArgs),
    /// All nuts of standard sizes: filter them, sort them, write them as a table.
    ///
    /// Every combination of the lists within the limits, with load ratings, rigidity of the preloaded
    /// pair, mass and efficiency. Example: bsm catalog --require 'dynamic_load_rating_N>=50000'
    /// --require 'preloaded_rigidity_N_um>=2000' --require lead_mm=10 --sort mass_kg
    #[command(after_help = EXIT_CODES)]
    Catalog(CatalogArgs),
    /// Slip of the balls by published and exact formulas, and the power lost to each part of it.
    ///
    /// Model auto is traction here, or rigid without conformities. With nut_running_contact_angle_deg and
    /// screw_running_contact_angle_deg it is a ball that rolls at these angles.
    #[command(after_help = EXIT_CODES)]
    Slip(AnalysisArgs),
    /// Jamming of the balls: contact state, self-locking, thrust in the ball return.
    ///
    /// Model auto is traction here, or rigid without conformities.
    /// Each part needs only its own inputs, and names the missing ones: race_yield_strength_MPa and
    /// ball_yield_strength_MPa; lubricant_density_kg_m3 and drag_coefficient; apex_half_angle_deg;
    /// return_angle_deg; step_height_mm; loaded_balls_per_turn. Optional: step_normal_force_N,
    /// return_approach_speed_m_s, return_stiffness_N_um15 or return_linear_stiffness_N_um. Try:
    /// bsm jam examples/jamming.json
    #[command(after_help = EXIT_CODES)]
    Jam(AnalysisArgs),
    /// Check the program against published results.
    #[command(after_help = EXIT_CODES)]
    Validate(ValidateArgs),
    /// Measure time and accuracy of every model and setting on this machine.
    #[command(after_help = EXIT_CODES)]
    Tradeoff(TradeoffArgs),
    /// One screw in the browser: pictures and numbers that follow every change.
    ///
    /// Starts a server for this machine only and prints its address. --out writes the page as one file instead,
    /// which needs no server and no network. Try: bsm view examples/feed_drive.json --open
    #[command(after_help = EXIT_CODES)]
    View(ViewArgs),
    /// Print the JSON Schema of scenes (input), results of a point (output), or of what a command prints with
    /// --format json.
    Schema {
        /// Which one.
        #[arg(value_enum)]
        kind: SchemaKind,
    },
    /// Print a completion script for a shell.
    Completions {
        /// Which shell.
        #[arg(value_enum)]
        shell: clap_complete::Shell,
    },
}

/// A scene with changes.
#[derive(Debug, Args)]
pub(crate) struct SceneArgs {
    /// Scene file in JSON; `-` reads standard input.
    #[arg(value_name = "SCENE.json")]
    pub(crate) scene: PathBuf,
    /// Set or replace an input; may be repeated, such as --set screw_speed_rpm=3000.
    #[arg(long = "set", value_name = "NAME=VALUE", allow_hyphen_values = true)]
    pub(crate) settings: Vec<String>,
}

/// The model to solve with, and its settings.
#[derive(Debug, Args)]
pub(crate) struct ModelArgs {
    /// Model to solve with; auto takes the fastest one whose error is below --tolerance, or, without
    /// conformities, the most complete one whose inputs are given.
    #[arg(long, default_value = "auto", value_parser = PossibleValuesParser::new(ModelChoice::names()))]
    pub(crate) model: String,
    /// Largest error of the efficiency that model auto accepts, against model traction.
    #[arg(long, value_name = "T", default_value_t = Settings::default().tolerance, value_parser = tolerance)]
    pub(crate) tolerance: f64,
    /// Accuracy of the integration over the contact ellipses in model traction, its error over the
    /// friction, 1e-13 to 1e-4; the result states the error of the efficiency and of the loss.
    #[arg(long, value_name = "A", default_value = "1e-8", value_parser = accuracy)]
    pub(crate) accuracy: f64,
    /// Creep speed in model traction, over the ball's rolling speed: smaller is closer to Coulomb
    /// friction.
    #[arg(long, value_name = "V", default_value_t = Settings::default().creep, value_parser = creep)]
    pub(crate) creep: f64,
    /// Race on which the ball does not spin in model raceway-control; unless given, the race with the
    /// larger spin friction moment.
    #[arg(long, value_name = "RACE", value_parser = PossibleValuesParser::new(Control::ALL.map(Control::name)))]
    pub(crate) control: Option<String>,
    /// Where friction of a lubricant is computed in model raceway-control: at every point of the contacts, or once
    /// for each contact, from its mean pressure and slip: half the time, and the loss of the contacts 0.25 % off
    /// in the middle, 4.3 % at most.
    #[arg(long, value_name = "WHERE", default_value = "local", value_parser = PossibleValuesParser::new(RacewayFriction::ALL.map(RacewayFriction::name)))]
    pub(crate) friction: String,
}

impl ModelArgs {
    pub(crate) fn settings(&self) -> Result<Settings, CaseError> {
        let Self { tolerance, accuracy, creep, .. } = *self;
        let control = self.control.as_deref();
        let named = Settings::named(&self.model, control, Some(&self.friction))?;
        Ok(Settings { tolerance, accuracy, creep, ..named })
    }
}

fn accuracy(text: &str) -> Result<f64, String> {
    dial(text, "a number", Settings::ACCURACY)
}

fn tolerance(text: &str) -> Result<f64, String> {
    dial(text, "a number", Settings::TOLERANCE)
}

fn creep(text: &str) -> Result<f64, String> {
    dial(text, "a number", Settings::CREEP)
}

/// The value of a setting, checked against its rule.
fn dial<T: FromStr>(text: &str, kind: &str, rule: Rule) -> Result<T, String> {
    match (text.parse(), text.parse()) {
        (Ok(value), Ok(number)) if rule.holds::<f64>(number) => Ok(value),
        _ => Err(format!("must be {kind}, {}", rule.describe())),
    }
}

/// A number of threads; far more of them stop the machine.
pub(crate) fn threads(text: &str) -> Result<NonZeroUsize, String> {
    match text.parse::<NonZeroUsize>() {
        Ok(threads) if threads.get() <= 1024 => Ok(threads),
        _ => Err("must be a whole number from 1 to 1024, such as 4".to_owned()),
    }
}

/// When something is printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub(crate) enum When {
    /// In tables.
    #[default]
    Table,
    /// In tables and JSON.
    Always,
    /// Not at all.
    Never,
}

#[derive(Debug, Args)]
pub(crate) struct SolveArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,
    #[command(flatten)]
    pub(crate) model: ModelArgs,
    /// Also print how much efficiency and torque change with each input of the model, by exact
    /// derivatives, the most important input first.
    #[arg(long)]
    pub(crate) sensitivities: bool,
    /// How sure friction from a lubricant is: the range in which nine of ten draws of what nobody knows exactly
    /// lie. In the table unless told, in JSON only with `always`.
    #[arg(long, value_enum, value_name = "WHEN", default_value = "table", num_args = 0..=1, default_missing_value = "always", require_equals = true)]
    pub(crate) band: When,
    /// How to print the result.
    #[arg(long, value_enum, default_value_t = Format::Table)]
    pub(crate) format: Format,
}

#[derive(Debug, Args)]
pub(crate) struct CompareArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,
    /// How to print the results.
    #[arg(long, value_enum, default_value_t = Format::Table)]
    pub(crate) format: Format,
}

#[derive(Debug, Args)]
pub(crate) struct ViewArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,
    #[command(flatten)]
    pub(crate) model: ModelArgs,
    /// Port of the server on 127.0.0.1; a free one unless given.
    #[arg(long, default_value_t = 0, hide_default_value = true)]
    pub(crate) port: u16,
    /// Start the browser.
    #[arg(long)]
    pub(crate) open: bool,
    /// Where the button "save" writes the scene; without it the page writes nothing.
    #[arg(long, value_name = "SCENE.json", conflicts_with = "out")]
    pub(crate) save: Option<PathBuf>,
    /// Write the page as one file instead: the pictures of the scene, and of a grid of speeds and loads around it.
    #[arg(long, value_name = "PAGE.html", conflicts_with_all = ["port", "open"])]
    pub(crate) out: Option<PathBuf>,
}

/// The table to write, and how.
#[derive(Debug, Args)]
#[expect(clippy::struct_excessive_bools, reason = "switches of the command line")]
pub(crate) struct TableArgs {
    /// Table to write: .csv, .jsonl, .parquet or .xlsx; `-` is CSV on standard output; FOLDER/ gets Parquet
    /// files in FOLDER/data, and can be continued with --resume. Parquet and .xlsx say what they are made from.
    /// Of `bsm sweep` over one or two inputs, .txt is a Modelica lookup table, and .grid.csv a matrix of one
    /// output with its axes.
    #[arg(short, long, value_name = "OUT")]
    pub(crate) output: PathBuf,
    /// Continue a stopped run of the same task in its folder: finished parts are verified and kept, the
    /// others are solved.
    #[arg(long)]
    pub(crate) resume: bool,
    /// Also write what the table is made from, with its SHA-256, to OUT-metadata.json: program, points, scene,
    /// settings, units.
    #[arg(long)]
    pub(crate) metadata: bool,
    /// Rows in each part of a folder; unless given, chosen from the number of rows, outputs and model.
    #[arg(long, value_name = "N", value_parser = rows)]
    pub(crate) rows_per_shard: Option<NonZeroU64>,
    /// Only write the plan of a folder, and print rows, parts, core-hours and size to expect: `bsm shard` solves the parts,
    /// in as many processes and on as many machines as there are.
    #[arg(long)]
    pub(crate) plan: bool,
    /// Outputs to write, in this order, also numbers of `bsm slip`, `bsm jam`, `bsm optimum` and `bsm capacity`; all of
    /// `bsm solve` unless given. `bsm schema output` lists them.
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    pub(crate) columns: Option<Vec<String>>,
    /// Number of threads, at most 1024; all cores unless given. Results do not depend on it.
    #[arg(long, value_name = "N", value_parser = threads)]
    pub(crate) threads: Option<NonZeroUsize>,
    /// Exit with 0 instead of 3 if some rows have no result; the table is complete either way.
    #[arg(long)]
    pub(crate) keep_going: bool,
    /// No progress bar.
    #[arg(long)]
    pub(crate) quiet: bool,
}

#[derive(Debug, Args)]
pub(crate) struct SweepArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,
    #[command(flatten)]
    pub(crate) model: ModelArgs,
    /// Input to vary: NAME=START:STOP:COUNT (ends included), NAME=START:STOP:COUNT:log (equal ratios) or
    /// NAME=V1,V2,...; may be repeated for a full grid, in which the last input changes fastest.
    #[arg(
        long,
        value_name = "NAME=VALUES",
        required_unless_present = "draw",
        allow_hyphen_values = true
    )]
    pub(crate) vary: Vec<String>,
    /// Input to draw at random in place of a grid: NAME=uniform:LOW:HIGH or NAME=normal:MEAN:DEVIATION; may be repeated.
    /// A row depends on the seed and its number only; a draw that breaks the rule of its input has no result.
    #[arg(
        long,
        value_name = "NAME=LAW",
        conflicts_with = "vary",
        requires = "draws",
        allow_hyphen_values = true
    )]
    pub(crate) draw: Vec<String>,
    /// Number of random points.
    #[arg(long, value_name = "N", requires = "draw", value_parser = count)]
    pub(crate) draws: Option<u64>,
    /// Seed of the random points.
    #[arg(long, value_name = "S", requires = "draw", default_value_t = 0)]
    pub(crate) seed: u64,
    #[command(flatten)]
    pub(crate) table: TableArgs,
    /// Plot to write (.svg or .png) of one output against the first varied input, a line per value of
    /// the second.
    #[arg(long, value_name = "OUT.svg")]
    pub(crate) plot: Option<PathBuf>,
    /// Map to write (.svg or .png) of one output over two varied inputs, of any number of points, with the
    /// boundaries between models.
    #[arg(long, value_name = "OUT.svg")]
    pub(crate) map: Option<PathBuf>,
    /// Output of --plot and --map, also a number of `bsm slip`, `bsm jam`, `bsm optimum` or `bsm capacity`.
    #[arg(long, value_name = "NAME", default_value = "efficiency")]
    pub(crate) plot_output: String,
}

#[derive(Debug, Args)]
pub(crate) struct ShardArgs {
    /// Folder with a plan.
    #[arg(value_name = "FOLDER")]
    pub(crate) folder: PathBuf,
    /// Solve the parts whose number leaves this remainder when divided by --of.
    #[arg(long, value_name = "I", requires = "of")]
    pub(crate) index: Option<u64>,
    /// Number of processes that share the parts.
    #[arg(long, value_name = "N", requires = "index")]
    pub(crate) of: Option<NonZeroU64>,
    /// Solve the parts A, A + 1, ... up to B - 1.
    #[arg(long, value_name = "A:B", conflicts_with = "index", value_parser = shards)]
    pub(crate) shards: Option<(u64, u64)>,
    /// Number of threads, at most 1024; all cores unless given. Bytes do not depend on it.
    #[arg(long, value_name = "T", value_parser = threads)]
    pub(crate) threads: Option<NonZeroUsize>,
    /// Read all bytes of the parts that are there, and solve those again that are not as they were written.
    #[arg(long)]
    pub(crate) repair: bool,
    /// Table of points of the plan, if it is elsewhere than beside the folder under its name.
    #[arg(long, value_name = "POINTS")]
    pub(crate) points: Option<PathBuf>,
    /// No progress bar.
    #[arg(long)]
    pub(crate) quiet: bool,
}

/// A number of rows, such as 5000 or 5e7.
fn count(text: &str) -> Result<u64, String> {
    /// Beyond, not every whole number is a double.
    const MOST: f64 = 9_007_199_254_740_992.0;
    let whole = |number: &f64| number.fract() == 0.0 && (0.0..=MOST).contains(number);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked")]
    let of_float = || Some(text.parse::<f64>().ok().filter(whole)? as u64);
    let wrong = || "must be a whole number, such as 5000 or 5e7".to_owned();
    text.parse().ok().or_else(of_float).ok_or_else(wrong)
}

/// A number of rows, at least one.
fn rows(text: &str) -> Result<NonZeroU64, String> {
    NonZeroU64::new(count(text)?).ok_or_else(|| "must be at least 1".to_owned())
}

/// Numbers of parts, from the first to before the last.
fn shards(text: &str) -> Result<(u64, u64), String> {
    let ends = text.split_once(':').map(|(from, to)| (from.parse(), to.parse()));
    match ends {
        Some((Ok(from), Ok(to))) if from < to => Ok((from, to)),
        _ => Err("must be two whole numbers, such as 0:100 for the parts 0 to 99".to_owned()),
    }
}

#[derive(Debug, Args)]
pub(crate) struct VerifyArgs {
    /// Folder with a plan.
    #[arg(value_name = "FOLDER")]
    pub(crate) folder: PathBuf,
    /// Read all bytes, not only the footers.
    #[arg(long)]
    pub(crate) deep: bool,
    /// How to print what was found.
    #[arg(long, value_enum, default_value_t = Format::Table)]
    pub(crate) format: Format,
}

#[derive(Debug, Args)]
pub(crate) struct BatchArgs {
    /// Table of points: .csv, .jsonl or .parquet, columns named as inputs, in any unit (axial_load_kN); `-` is CSV
    /// on standard input. Each row is solved as by `bsm solve --set` with its values: an empty cell takes the value
    /// of the base scene; a lead replaces its lead angle, and a lead angle its lead. Columns of earlier
    /// results are ignored. In CSV and JSON Lines a row is one line: a quoted cell must end on it, and
    /// blank lines may only be at the end.
    #[arg(value_name = "POINTS")]
    pub(crate) points: PathBuf,
    /// Scene with the inputs that the table does not have.
    #[arg(long, value_name = "SCENE.json")]
    pub(crate) base: Option<PathBuf>,
    /// Set or replace an input of the base scene; may be repeated.
    #[arg(long = "set", value_name = "NAME=VALUE", allow_hyphen_values = true)]
    pub(crate) settings: Vec<String>,
    #[command(flatten)]
    pub(crate) model: ModelArgs,
    #[command(flatten)]
    pub(crate) table: TableArgs,
    /// Columns to copy to the output although they are not inputs, such as an id.
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    pub(crate) keep: Vec<String>,
    #[command(flatten)]
    pub(crate) signs: TableSigns,
    /// Write CSV with the delimiter and the decimal sign of the points.
    #[arg(long)]
    pub(crate) same_signs: bool,
}

#[derive(Debug, Args)]
pub(crate) struct OptimumArgs {
    /// Scene file in JSON with lead angle or contact angle, and friction coefficient; `-` reads standard input.
    #[arg(value_name = "SCENE.json")]
    pub(crate) scene: Option<PathBuf>,
    /// Set or replace an input; without a scene, --set `lead_angle_deg=10` --set `friction_coefficient=0.075`.
    #[arg(long = "set", value_name = "NAME=VALUE", allow_hyphen_values = true)]
    pub(crate) settings: Vec<String>,
    /// Also search for the best contact angle of this model; the scene needs its inputs.
    #[arg(long, value_parser = PossibleValuesParser::new(Model::ALL.map(Model::name)))]
    pub(crate) model: Option<String>,
    /// Folder for the figures (SVG and CSV) of Lin, Velinsky and Ravani (1994) around the scene: efficiency
    /// against both angles and against the direction of slip, normal loads, optimum contact angle,
    /// self-locking limits; those whose inputs are given. Created if it does not exist.
    #[arg(long, value_name = "DIR")]
    pub(crate) plot: Option<PathBuf>,
    /// How to print the result.
    #[arg(long, value_enum, default_value_t = Format::Table)]
    pub(crate) format: Format,
}

#[derive(Debug, Args)]
pub(crate) struct CapacityArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,
    /// Load spectrum for the rating life: CSV with the columns axial_load_N, screw_speed_rpm and
    /// time_share.
    #[arg(long, value_name = "SPECTRUM.csv")]
    pub(crate) spectrum: Option<PathBuf>,
    /// Table of the ratings to write: .csv or .xlsx, a row each.
    #[arg(short, long, value_name = "OUT")]
    pub(crate) output: Option<PathBuf>,
    /// Show the intermediate values of the load ratings, for a check by hand (docs/theory/11-ratings.md).
    #[arg(long)]
    pub(crate) steps: bool,
    /// How to print the ratings.
    #[arg(long, value_enum, default_value_t = Format::Table)]
    pub(crate) format: Format,
}

#[derive(Debug, Args)]
pub(crate) struct SizeArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,
    #[command(flatten)]
    pub(crate) model: ModelArgs,
    /// Cycle of the axis: CSV with the columns time_s or share, force_N, feed_m_min and acceleration_m_s2, in
    /// any unit; in place of the cycle of the scene.
    #[arg(long, value_name = "CYCLE.csv")]
    pub(crate) cycle: Option<PathBuf>,
    /// What separates the cells of --cycle; a comma unless given.
    #[arg(long, value_enum, default_value_t = Delimiter::Comma, requires = "cycle")]
    pub(crate) delimiter: Delimiter,
    /// Decimal sign of --cycle.
    #[arg(long, value_enum, default_value_t = Decimal::Point, requires = "cycle")]
    pub(crate) decimal: Decimal,
    /// Folder for report.html, a sheet of two pages, results.json and figures/ (SVG and CSV); created if it
    /// does not exist.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// How to print the sheet.
    #[arg(long, value_enum, default_value_t = Format::Table)]
    pub(crate) format: Format,
}

#[derive(Debug, Args)]
pub(crate) struct NutArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,
    #[command(flatten)]
    pub(crate) model: ModelArgs,
    /// Table to write with a row for each ball: .csv, .jsonl, .parquet or .xlsx.
    #[arg(long, value_name = "BALLS")]
    pub(crate) table: Option<PathBuf>,
    /// Write displacement, stiffness and preload that is left over the axial load to --output, beyond the load and
    /// the limit load.
    #[arg(long, requires = "output")]
    pub(crate) curve: bool,
    /// Table of --curve: .csv, .jsonl, .parquet or .xlsx; `-` is CSV on standard output, in place of the summary.
    #[arg(short, long, value_name = "OUT", requires = "curve")]
    pub(crate) output: Option<PathBuf>,
    /// Folder for figures (SVG and CSV): loads and contact angles along the helix, the developed nut,
    /// displacement and preload over load; created if it does not exist.
    #[arg(long, value_name = "DIR")]
    pub(crate) plot: Option<PathBuf>,
    /// Solve so many nuts with balls drawn by ball_deviation_sd_um and phases of lead_error drawn, and print
    /// quantiles.
    #[arg(long, value_name = "N", conflicts_with_all = ["table", "curve", "plot"])]
    pub(crate) samples: Option<u64>,
    /// Number that the samples follow from; the seed of the scene unless given.
    #[arg(long, value_name = "S", requires = "samples")]
    pub(crate) seed: Option<u64>,
    /// How to print the summary.
    #[arg(long, value_enum, default_value_t = Format::Table)]
    pub(crate) format: Format,
}

/// An analysis of the motion of a scene, and its sweeps.
#[derive(Debug, Args)]
pub(crate) struct AnalysisArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,
    #[command(flatten)]
    pub(crate) model: ModelArgs,
    /// How to print the analysis.
    #[arg(long, value_enum, default_value_t = Format::Table)]
    pub(crate) format: Format,
    /// Folder for figures (SVG and CSV) of sweeps around the scene; created if it does not exist.
    #[arg(long, value_name = "DIR")]
    pub(crate) plot: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct FitArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,
    #[command(flatten)]
    pub(crate) model: ModelArgs,
    /// Output that was measured at this operating point, and its value; with --data its name alone.
    #[arg(long, value_name = "OUTPUT[=VALUE]", allow_hyphen_values = true)]
    pub(crate) measured: String,
    /// Input to find; with --data one or several, also with a range of their own: NAME=LOW:HIGH.
    #[arg(
        long,
        value_name = "NAME",
        default_value = "friction_coefficient",
        allow_hyphen_values = true
    )]
    pub(crate) input: Vec<String>,
    /// CSV table of measured points: a column of the output, and columns of inputs, such as screw_speed_rpm,
    /// axial_load_kN and lubricant_temperature_C; the scene has the rest.
    #[arg(long, value_name = "CSV", conflicts_with = "range")]
    pub(crate) data: Option<PathBuf>,
    /// Plot measured against fitted values to this SVG file.
    #[arg(long, value_name = "SVG", requires = "data")]
    pub(crate) plot: Option<PathBuf>,
    /// Range to search; unless given, 1e-4 to 0.5 for friction, and a quarter to four times the
    /// scene's value for other inputs.
    #[arg(long, value_name = "LOW:HIGH", allow_hyphen_values = true, value_parser = range)]
    pub(crate) range: Option<(f64, f64)>,
    /// How to print the result.
    #[arg(long, value_enum, default_value_t = Format::Table)]
    pub(crate) format: Format,
}

fn range(text: &str) -> Result<(f64, f64), String> {
    let numbers = text.split_once(':').map(|(low, high)| (low.parse(), high.parse()));
    match numbers {
        Some((Ok(low), Ok(high))) => Ok((low, high)),
        _ => Err("must be two numbers, such as 0.01:0.2".to_owned()),
    }
}

#[derive(Debug, Args)]
pub(crate) struct DesignArgs {
    /// Requirement in JSON; `-` reads standard input. Without it, all keys of a requirement are listed.
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
    /// Let sizes and contact angle run, as the procedure of Lin, Velinsky and Ravani has them, with balls of standard
    /// diameters; unless given, standard sizes of ISO 3408-2 at 45 degrees are tried.
    #[arg(long)]
    pub(crate) free: bool,
    /// Table of the steps to write: .csv or .xlsx, a row each.
    #[arg(long, value_name = "OUT")]
    pub(crate) table: Option<PathBuf>,
    /// Write the screw and its operating point to this scene, for every other command.
    #[arg(short, long, value_name = "SCREW.json")]
    pub(crate) output: Option<PathBuf>,
    /// How to print the steps.
    #[arg(long, value_enum, default_value_t = Format::Table)]
    pub(crate) format: Format,
}

#[derive(Debug, Args)]
#[expect(clippy::struct_excessive_bools, reason = "switches of the command line")]
pub(crate) struct CatalogArgs {
    /// Lists and limits in JSON; what it leaves out is standard (--lists prints the standard).
    #[arg(value_name = "LISTS.json")]
    pub(crate) catalogue: Option<PathBuf>,
    /// Keep only nuts that keep all limits of a requirement, as for bsm design: life, speed number, pressure, and with
    /// support critical speed, buckling and static safety. Numbers of bsm size are columns then, to filter, sort and save.
    #[arg(long, value_name = "REQ.json")]
    pub(crate) requirement: Option<PathBuf>,
    /// Nuts of a maker in place of the lists: CSV with the columns nut, lead_mm, ball_diameter_mm, circuits or
    /// loaded_turns, core_diameter_mm or pitch_circle_diameter_mm, dynamic_load_rating_N, static_load_rating_N and
    /// rigidity_N_um, in any unit. The maker's ratings stand, ours are printed beside; with --requirement
    /// each nut is sized as by bsm size, and the lightest that passes is picked.
    #[arg(long, value_name = "TABLE.csv", conflicts_with_all = ["catalogue", "require", "pareto", "sort", "plot", "output"])]
    pub(crate) makers: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) signs: TableSigns,
    /// Keep only nuts that meet a condition: NAME>=VALUE, NAME<=VALUE or NAME=VALUE; may be repeated.
    #[arg(long, value_name = "CONDITION")]
    pub(crate) require: Vec<String>,
    /// Keep only nuts that no other nut beats in dynamic load rating, rigidity and mass together.
    #[arg(long)]
    pub(crate) pareto: bool,
    /// Sort by a column, with the smallest first.
    #[arg(long, value_name = "NAME")]
    pub(crate) sort: Option<String>,
    /// Sort with the largest first.
    #[arg(long, requires = "sort")]
    pub(crate) descending: bool,
    /// Keep only this many rows; unless given, the screen shows 20.
    #[arg(long, value_name = "N")]
    pub(crate) first: Option<NonZeroUsize>,
    /// Table to write with all columns: .csv, .jsonl, .parquet or .xlsx; `-` is CSV on standard output.
    #[arg(short, long, value_name = "OUT")]
    pub(crate) output: Option<PathBuf>,
    /// Write the first nut to this scene, for every other command; with --requirement it has the operating point.
    #[arg(long, value_name = "NUT.json")]
    pub(crate) pick: Option<PathBuf>,
    /// Folder for the figures of Sobolewski (2002), SVG and CSV, drawn with the nuts that meet the conditions.
    #[arg(long, value_name = "DIR")]
    pub(crate) plot: Option<PathBuf>,
    /// Print the standard lists and limits, to copy and edit.
    #[arg(long)]
    pub(crate) lists: bool,
    /// Print the columns.
    #[arg(long)]
    pub(crate) columns: bool,
    /// How to print the rows.
    #[arg(long, value_enum, default_value_t = Format::Table)]
    pub(crate) format: Format,
}

#[derive(Debug, Args)]
pub(crate) struct ValidateArgs {
    /// Folder for report.html, results.json and figures/ (SVG and CSV); created if it does not exist.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Folder with published data, laid out as validation/published, instead of the built-in data.
    #[arg(long, value_name = "DIR")]
    pub(crate) data: Option<PathBuf>,
    /// How to print the checks.
    #[arg(long, value_enum, default_value_t = Format::Table)]
    pub(crate) format: Format,
}

#[derive(Debug, Args)]
pub(crate) struct TradeoffArgs {
    /// Table of operating points, as for bsm batch, with all inputs of model traction; unless given, 300
    /// built-in points from rolling to gross skid.
    #[arg(value_name = "POINTS")]
    pub(crate) points: Option<PathBuf>,
    /// Folder for report.html, results.json and figures/ (SVG and CSV); created if it does not exist.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// How to print the measurement.
    #[arg(long, value_enum, default_value_t = Format::Table)]
    pub(crate) format: Format,
    /// No progress bar.
    #[arg(long)]
    pub(crate) quiet: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// For reading.
    Table,
    /// For programs; results of a point have the names of `bsm schema output`.
    Json,
}

/// How a table of one's own is written: the one of --makers, or that of the points.
#[derive(Debug, Args)]
pub(crate) struct TableSigns {
    /// Names of the columns of the table: a JSON object from its names to ours, in any unit, or to null for a column
    /// that is not read.
    #[arg(long, value_name = "MAP.json")]
    pub(crate) columns_from: Option<PathBuf>,
    /// What separates the cells of a table of text.
    #[arg(long, value_enum, default_value_t = Delimiter::Comma)]
    pub(crate) delimiter: Delimiter,
    /// Decimal sign of a table of text.
    #[arg(long, value_enum, default_value_t = Decimal::Point)]
    pub(crate) decimal: Decimal,
}

impl TableSigns {
    /// True if nothing is said.
    pub(crate) fn are_ours(&self) -> bool {
        let signs = (self.delimiter, self.decimal);
        self.columns_from.is_none() && signs == (Delimiter::Comma, Decimal::Point)
    }
}

/// What separates cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Delimiter {
    /// A comma.
    Comma,
    /// A semicolon.
    Semicolon,
    /// A tab.
    Tab,
    /// A vertical bar.
    Bar,
}

impl Delimiter {
    /// The sign.
    pub(crate) fn byte(self) -> u8 {
        match self {
            Self::Comma => b',',
            Self::Semicolon => b';',
            Self::Tab => b'\t',
            Self::Bar => b'|',
        }
    }
}

/// The decimal sign of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Decimal {
    /// 1.5
    Point,
    /// 1,5
    Comma,
}

impl Decimal {
    /// The sign.
    pub(crate) fn sign(self) -> char {
        match self {
            Self::Point => '.',
            Self::Comma => ',',
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum SchemaKind {
    /// A scene.
    Input,
    /// The result of a point, as in tables; the numbers of analyses are in its $defs.
    Output,
    /// bsm solve.
    Solve,
    /// bsm compare.
    Compare,
    /// bsm optimum.
    Optimum,
    /// bsm capacity.
    Capacity,
    /// bsm nut.
    Nut,
    /// bsm size.
    Size,
    /// bsm fit.
    Fit,
    /// bsm design.
    Design,
    /// bsm catalog.
    Catalog,
    /// bsm slip.
    Slip,
    /// bsm jam.
    Jam,
    /// bsm validate.
    Validate,
    /// bsm tradeoff.
    Tradeoff,
    /// bsm verify.
    Verify,
}
