//! Inputs of `bsm select`: the requirement, and the sizes or nuts to choose from.

use std::path::Path;

use bsm_case::{CaseError, Catalog, ListColumn, ManufacturerNut, NameKind, RequirementFile};

use crate::answer::Destination;
use crate::args::SelectArgs;
use crate::failure::Failure;
use crate::files::{InputFiles, MAX_TABLE_BYTES, ending_of, read, read_json};

/// Name of the built-in list of standard sizes.
const STANDARD: &str = "standard";
/// Name of the built-in list of manufacturers' sizes.
const MANUFACTURERS: &str = "manufacturers";

/// Hint that suggests the standard lists as an alternative source of sizes.
pub(crate) const STANDARD_HINT: &str =
    "--from standard searches every combination of the standard lists";

/// Sizes or nuts that `--from` specifies: a list of sizes (by default, manufacturers' sizes), or
/// the nuts in a manufacturer's table.
#[expect(clippy::large_enum_variant, reason = "a run creates only one value of this type")]
pub(crate) enum Source {
    Sizes(Catalog),
    Nuts(Vec<ManufacturerNut>),
}

impl Source {
    pub(crate) fn read(args: &SelectArgs) -> Result<Self, Failure> {
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
