//! Sizes that makers offer.

use std::sync::LazyLock;

use crate::vocabulary::cells::Cells;

/// The table: THK general catalogue, B-584 to B-735; HIWIN BS-08-2, 6.4 to 6.9.
const TABLE: &str = include_str!("maker_sizes.csv");

/// A size of a maker; lengths in mm.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct MakerSize {
    pub(crate) nominal: f64,
    pub(crate) lead: f64,
    pub(crate) ball: Option<f64>,
    pub(crate) pitch_circle: Option<f64>,
    pub(crate) core: Option<f64>,
}

static SIZES: LazyLock<Vec<MakerSize>> = LazyLock::new(|| {
    let cells = Cells::read(TABLE.as_bytes(), b',', '.').expect("the table has rows");
    let columns = cells.columns(|name| Ok(name.to_owned())).expect("every name will do");
    let row = |cells: &Cells, row: &mut dyn Iterator<Item = (&String, &str)>| {
        let mut size = MakerSize::default();
        for (column, text) in row {
            match column.as_str() {
                "nominal_diameter_mm" => size.nominal = cells.number(text)?,
                "lead_mm" => size.lead = cells.number(text)?,
                "ball_diameter_mm" => size.ball = Some(cells.number(text)?),
                "pitch_circle_diameter_mm" => size.pitch_circle = Some(cells.number(text)?),
                "core_diameter_mm" => size.core = Some(cells.number(text)?),
                _ => {}
            }
        }
        Ok(size)
    };
    cells.each(&columns, |_, cells_of_row| row(&cells, cells_of_row)).expect("numbers")
});

impl MakerSize {
    /// Sizes of a nominal diameter and a lead \[mm\].
    pub(crate) fn all(nominal: f64, lead: f64) -> impl Iterator<Item = &'static Self> + Clone {
        let same = |a: f64, b: f64| (a - b).abs() < 1e-9;
        SIZES.iter().filter(move |size| same(size.nominal, nominal) && same(size.lead, lead))
    }
}
