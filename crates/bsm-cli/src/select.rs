//! `bsm select`: chooses a screw for a requirement, from lists of sizes or from a manufacturer's
//! table.

use std::path::{Path, PathBuf};

use bsm_case::{
    CaseError, Catalog, Content, DesignReport, DesignRow, ListColumn, MANUFACTURER_SIZES,
    ManufacturerNut, NameKind, REQUIREMENT_INPUTS, RequirementChoice, RequirementFile,
    STANDARD_CATALOG,
};

use crate::answer::{Destination, Pictures, Reply, WriteTable};
use crate::args::{SelectArgs, SelectShow};
use crate::failure::{Failure, print_message};
use crate::files::{InputFiles, MAX_TABLE_BYTES, ending_of, print, read, read_json};
use crate::progress::show_spinner;
use crate::table_job::write_rows;
use crate::{nuts, table};

/// Name of the built-in list of standard sizes.
pub(crate) const STANDARD: &str = "standard";
/// Name of the built-in list of manufacturers' sizes.
pub(crate) const MANUFACTURERS: &str = "manufacturers";

/// Hint that suggests the standard lists as an alternative source of sizes.
const STANDARD_HINT: &str = "--from standard searches every combination of the standard lists";

/// Sizes or nuts that `--from` specifies: a list of sizes (by default, manufacturers' sizes), or
/// the nuts in a manufacturer's table.
#[expect(clippy::large_enum_variant, reason = "a run creates only one value of this type")]
pub(crate) enum Source {
    Sizes(Catalog),
    Nuts(Vec<ManufacturerNut>),
}

impl Source {
    fn read(args: &SelectArgs) -> Result<Self, Failure> {
        let own = |sizes: Result<_, CaseError>| {
            sizes.map(Self::Sizes).map_err(|e| Failure::Input(e.to_string()))
        };
        // A search over continuous dimensions uses standard ball diameters.
        let usual = Path::new(if args.free { STANDARD } else { MANUFACTURERS });
        let from = args.from.as_deref().unwrap_or(usual);
        let is_table = ending_of("--from", from, &["csv"]).is_ok();
        if !is_table {
            args.table.only_with("--from TABLE.csv")?;
        }
        if from == Path::new(MANUFACTURERS) {
            return own(Catalog::manufacturers());
        }
        if from == Path::new(STANDARD) {
            return own(Catalog::standard());
        }
        let failure = |e: CaseError| Failure::case(from, &e);
        if !is_table {
            return Catalog::from_json(&read_json(from)?).map(Self::Sizes).map_err(failure);
        }
        let table = read(from, MAX_TABLE_BYTES)?;
        let format = args.table.format()?;
        match Catalog::from_csv(&table, &format).map_err(failure)? {
            Some(sizes) => Ok(Self::Sizes(sizes)),
            None => ManufacturerNut::from_csv(&table, &format).map(Self::Nuts).map_err(failure),
        }
    }
}

pub(crate) fn run(args: &SelectArgs) -> Result<(), Failure> {
    match args.show {
        Some(SelectShow::Keys) => return print(&keys()),
        Some(SelectShow::Lists) => return print(STANDARD_CATALOG),
        Some(SelectShow::Sizes) => return print(MANUFACTURER_SIZES.trim_end()),
        Some(SelectShow::Columns) => return print(&nuts::columns()),
        None => {}
    }
    match Source::read(args)? {
        Source::Sizes(sizes) if args.requirement.is_some() && !args.is_list() => {
            steps(args, &sizes)
        }
        source => nuts::run(args, source),
    }
}

/// Checks that the output files have supported extensions and that none of them replaces an input
/// file.
pub(crate) fn check<'a>(
    args: &'a SelectArgs,
    endings: &[&'static str],
) -> Result<Destination<'a>, Failure> {
    let inputs = [args.requirement.as_deref(), args.from.as_deref(), args.table.names.as_deref()];
    args.out.check(endings, InputFiles::of(inputs))
}

/// Reads the requirement that the nuts must meet.
pub(crate) fn requirement(
    args: &SelectArgs,
    catalog: &Catalog,
) -> Result<Option<RequirementFile>, Failure> {
    let Some(path) = &args.requirement else { return Ok(None) };
    let requirement =
        RequirementFile::from_json(&read_json(path)?, &args.settings(), catalog.lists.clone());
    requirement.map(Some).map_err(|e| Failure::case(path, &column_instead_of_key(e)))
}

/// Returns an error that points to `--where` if a key of a requirement is not known, but is a
/// column of the list of sizes. Returns any other error unchanged.
fn column_instead_of_key(error: CaseError) -> CaseError {
    if let CaseError::Unknown { kind: NameKind::Requirement, name, .. } = &error
        && ListColumn::of_sizes(true).iter().any(|column| column.name == *name)
    {
        return CaseError::Invalid(format!(
            "`{name}` is not a key of a requirement, but a column of the list of sizes. To restrict it, use a condition such as --where {name}=VALUE"
        ));
    }
    error
}

/// Chooses the best screw and prints the steps of this choice.
fn steps(args: &SelectArgs, sizes: &Catalog) -> Result<(), Failure> {
    let to = check(args, &["json", "csv", "xlsx"])?;
    let Some(requirement) = requirement(args, sizes)? else { return Ok(()) };
    let line = show_spinner("searching for the best screw");
    let of_sizes = if args.free { None } else { DesignReport::standard(&requirement, sizes) };
    if of_sizes.is_none() && !args.free {
        print_message(
            "note",
            &format!(
                "none of these sizes has the values that the requirement fixes, so continuous sizes are searched as with --free; {STANDARD_HINT}"
            ),
        );
    }
    let report = of_sizes.unwrap_or_else(|| DesignReport::of(&requirement));
    drop(line);
    let case = report.case.to_json();
    let units = args.display(Some(&report.case));
    let row = |row: &DesignRow| Some((row.name, row.unit, row.value?));
    let mut answer = report.answer();
    let is_json = |path: &&PathBuf| ending_of("-o", path, &["json"]).is_ok();
    if report.found {
        let next = match args.out.output.iter().find(is_json) {
            Some(path) => format!("bsm axis {}", path.display()),
            None => "-o SCREW.json writes the case for the other commands".to_owned(),
        };
        answer = answer.with_shown(Content::Text("next:", Some(next)));
    }
    let rows: Vec<_> = report.rows.iter().filter_map(row).collect();
    let table = |path: &Path| write_rows(path, &rows, units, &case);
    let table = (!rows.is_empty()).then(|| Box::new(table) as WriteTable<'_>);
    let found = report.found.then(|| case.clone());
    let reply = Reply { table, case: Some(found.into()), units, ..Reply::of(answer) };
    reply.deliver(&to, || Ok(Pictures::default()))
}

/// Returns a text that describes the keys of a requirement.
fn keys() -> String {
    let words = RequirementChoice::ALL.iter().map(|choice| {
        let meaning = format!("{}: {}", choice.about(), choice.words().join(", "));
        vec![choice.name().to_owned(), String::new(), meaning]
    });
    let numbers = REQUIREMENT_INPUTS.iter().map(|input| {
        let default = input.default.map_or_else(String::new, |d| format!("; defaults to {d}"));
        vec![input.name.to_owned(), input.unit.to_owned(), format!("{}{default}", input.about)]
    });
    let rows: Vec<_> = words.chain(numbers).collect();
    let table = table::plain(None, &rows, usize::MAX);
    format!(
        "A requirement needs axial_load_N or screw_torque_Nm with screw_speed_rpm or feed_m_min, or a cycle;\n\
         and stroke_mm or screw_length_mm. Without required_life_h, any life is accepted. friction_coefficient\n\
         defaults to 0.06. All rules of bsm axis are limits.\n\
         The program chooses lead_mm or lead_angle_deg, ball_diameter_mm, pitch_circle_diameter_mm,\n\
         contact_angle_deg, nut_conformity and loaded_turns, unless they are given.\n\
         A key is one of the following keys, or an input of a case (bsm schema input) that describes the\n\
         load, the axis, the lubricant or one of the sizes above. Other columns of the list of sizes, such as\n\
         nominal_diameter_mm, are not keys; restrict them with --where nominal_diameter_mm=25.\n\n{table}"
    )
}
