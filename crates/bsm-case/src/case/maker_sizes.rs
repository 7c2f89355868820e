//! Sizes that makers offer.

use std::sync::LazyLock;

use crate::CaseError;
use crate::vocabulary::cells::Cells;

/// The table: THK general catalogue, B-584 to B-735; HIWIN BS-08-2, 6.4 to 6.9.
const TABLE: &str = include_str!("maker_sizes.csv");

/// A size of a maker; lengths in mm.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct MakerSize {
    pub(crate) nominal: f64,
    pub(crate) lead: f64,
    pub(crate) ball: Option<f64>,
    /// False if the ball diameter follows from pitch circle and core.
    pub(crate) ball_is_printed: bool,
    pub(crate) pitch_circle: Option<f64>,
    pub(crate) core: Option<f64>,
    pub(crate) turns: Vec<f64>,
}

static SIZES: LazyLock<Vec<MakerSize>> =
    LazyLock::new(|| MakerSize::read().expect("the table is compiled in"));

impl MakerSize {
    fn read() -> Result<Vec<Self>, CaseError> {
        let cells = Cells::read(TABLE.as_bytes(), b',', '.')?;
        let columns = cells.columns(|name| Ok(name.to_owned()))?;
        cells.each(&columns, |_, row| {
            let mut size = Self::default();
            for (column, text) in row {
                match column.as_str() {
                    "nominal_diameter_mm" => size.nominal = cells.number(text)?,
                    "lead_mm" => size.lead = cells.number(text)?,
                    "ball_diameter_mm" => size.ball = Some(cells.number(text)?),
                    "ball" => size.ball_is_printed = text == "printed",
                    "pitch_circle_diameter_mm" => size.pitch_circle = Some(cells.number(text)?),
                    "core_diameter_mm" => size.core = Some(cells.number(text)?),
                    "turns" => {
                        let turns = text.split('/').map(|text| cells.number(text));
                        size.turns = turns.collect::<Result<_, _>>()?;
                    }
                    _ => {}
                }
            }
            Ok(size)
        })
    }

    /// All of them.
    pub(crate) fn list() -> &'static [Self] {
        &SIZES
    }

    /// Sizes of a nominal diameter and a lead \[mm\].
    pub(crate) fn all(nominal: f64, lead: f64) -> impl Iterator<Item = &'static Self> + Clone {
        let same = |a: f64, b: f64| (a - b).abs() < 1e-9;
        SIZES.iter().filter(move |size| same(size.nominal, nominal) && same(size.lead, lead))
    }
}
