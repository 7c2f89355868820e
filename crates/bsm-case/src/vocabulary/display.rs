//! Units in which answers are displayed. JSON always uses the units of the vocabulary.

use bsm_design::statistics::Band;
use serde_json::{Value, json};

use super::entries::Named;
use super::number::format_trimmed;
use super::units::{Counterpart, UnitChange, convert_with_text, counterpart};
use crate::{
    Answer, Case, CaseError, ColumnValues, Content, Criterion, NameKind, Numbers, Section, Table,
    nearest,
};

/// System of units for screen output, reports, figures and table columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum DisplayUnits {
    /// Metric units, which are the units of the vocabulary.
    #[default]
    Metric,
    /// Inches, pounds and degrees Fahrenheit.
    Inch,
}

/// Units of the vocabulary, each with its counterpart in the inch system. Units that are not listed
/// are the same in both systems.
const INCH: [(&str, &str); 23] = [
    ("mm", "in"),
    ("um", "uin"),
    ("m", "ft"),
    ("km", "million in"),
    ("mm2", "in2"),
    ("N", "lbf"),
    ("kN", "klbf"),
    ("N m", "lbf in"),
    ("N mm", "lbf in"),
    ("m/min", "in/min"),
    ("m/s", "in/s"),
    ("mm/s", "in/s"),
    ("mm/min", "in/min"),
    ("m/s2", "in/s2"),
    ("kg", "lb"),
    ("kg/m", "lb/in"),
    ("kg/m3", "lb/in3"),
    ("kg m2", "lb in2"),
    ("N/um", "lbf/in"),
    ("MPa", "psi"),
    ("GPa", "Mpsi"),
    ("C", "degF"),
    ("K", "degF"),
];

/// A displayed unit, and the conversion to this unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DisplayUnit {
    /// Unit as text.
    pub text: &'static str,
    /// Suffix of the unit of the vocabulary, suffix of the displayed unit, and conversion from the
    /// displayed unit. `None` if both units are the same.
    other: Option<Counterpart>,
}

impl DisplayUnit {
    /// Creates a display unit that equals the unit of the vocabulary.
    ///
    /// * `unit`: the unit as text.
    pub const fn unchanged(unit: &'static str) -> Self {
        Self { text: unit, other: None }
    }

    /// Returns the conversion from the displayed unit to the unit of the vocabulary.
    pub fn change(self) -> UnitChange {
        self.other.map_or(UnitChange::NONE, |(.., change)| change)
    }

    /// Returns true if values are displayed in the unit of the vocabulary.
    pub const fn is_own(self) -> bool {
        self.other.is_none()
    }

    /// Converts a number from the unit of the vocabulary to the displayed unit.
    pub fn value(self, value: f64) -> f64 {
        self.other.map_or(value, |(.., change)| change.back(value))
    }

    /// Converts both ends of an interval from the unit of the vocabulary to the displayed unit.
    pub fn band(self, band: Option<Band>) -> Option<Band> {
        band.map(|Band { low, high }| Band { low: self.value(low), high: self.value(high) })
    }

    /// Returns the name of a quantity with the suffix of the displayed unit.
    pub fn name(self, name: &str) -> String {
        let renamed = self.other.and_then(|(own, shown, _)| {
            Some(format!("{}_{shown}", name.strip_suffix(own)?.strip_suffix('_')?))
        });
        renamed.unwrap_or_else(|| name.to_owned())
    }

    /// Converts the number in a requirement such as "<= 12000" to the displayed unit. Returns
    /// `None` if the text does not have this form.
    fn limit(self, text: &str) -> Option<String> {
        let (sign, number) =
            text.split_once(' ').filter(|(sign, _)| [">=", "<="].contains(sign))?;
        Some(format!("{sign} {}", format_trimmed(self.value(number.parse().ok()?))))
    }

    fn json(self, value: &Value) -> Value {
        value
            .as_f64()
            .filter(|_| value.is_f64())
            .map_or_else(|| value.clone(), |number| json!(self.value(number)))
    }
}

impl Case {
    /// Returns the units in which the answers about the case are displayed.
    pub fn display_units(&self) -> DisplayUnits {
        self.entries.display_units.map(|Named(units)| units).unwrap_or_default()
    }
}

impl DisplayUnits {
    /// Returns the units of the vocabulary that are displayed in another unit, each with its
    /// displayed unit.
    pub fn changed(self) -> impl Iterator<Item = (&'static str, DisplayUnit)> {
        let of_inch = INCH.iter().filter(move |_| self == Self::Inch);
        of_inch.map(|(own, text)| (*own, DisplayUnit { text, other: counterpart(own, text) }))
    }

    /// Returns the displayed unit that corresponds to a unit of the vocabulary.
    pub fn of(self, unit: &'static str) -> DisplayUnit {
        self.found(unit).unwrap_or(DisplayUnit::unchanged(unit))
    }

    fn found(self, unit: &str) -> Option<DisplayUnit> {
        self.changed().find_map(|(own, shown)| (own == unit).then_some(shown))
    }

    /// Replaces the unit in a label such as "axial load, N" by the displayed unit, and returns the
    /// new label together with this unit.
    pub fn label(self, label: &str) -> (String, DisplayUnit) {
        let found =
            label.rsplit_once(", ").and_then(|(words, unit)| Some((words, self.found(unit)?)));
        match found {
            Some((words, shown)) => (format!("{words}, {}", shown.text), shown),
            None => (label.to_owned(), DisplayUnit::unchanged("")),
        }
    }

    /// Formats a length with its unit, rounded to 1 mm or to 0.01 in.
    ///
    /// * `millimeters`: length \[mm\].
    pub fn length(self, millimeters: f64) -> String {
        let unit = self.of("mm");
        match self {
            Self::Metric => format!("{millimeters:.0} {}", unit.text),
            Self::Inch => format!("{:.2} {}", unit.value(millimeters), unit.text),
        }
    }
}

/// A column of a table in its displayed unit.
#[derive(Debug, Clone, PartialEq)]
pub struct ShownColumn {
    /// Index of the column in the table.
    pub place: usize,
    /// Name of the column, with the displayed unit as a suffix.
    pub name: String,
    /// Unit in which the values are displayed.
    pub unit: DisplayUnit,
}

impl ShownColumn {
    /// Selects the table columns to display.
    ///
    /// * `heads`: name and unit of each column of the table.
    /// * `wanted`: names of the selected columns, in any unit. If it is `None`, all columns are
    ///   displayed in the units of `display`.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError::Unknown`] for a name that is not the name of a column.
    pub fn select(
        heads: &[(String, &'static str)],
        wanted: Option<&[String]>,
        display: DisplayUnits,
    ) -> Result<Vec<Self>, CaseError> {
        let displayed = |(place, (name, unit)): (usize, &(String, &'static str))| {
            let unit = display.of(unit);
            Self { place, name: unit.name(name), unit }
        };
        let Some(wanted) = wanted else {
            return Ok(heads.iter().enumerate().map(displayed).collect());
        };
        let names = || heads.iter().map(|(name, _)| name.as_str());
        let named = |name: &String| {
            if let Some(own) = heads.iter().enumerate().find(|(_, (own, _))| own == name) {
                return Ok(displayed(own));
            }
            let (own, unit) = in_unit(name, names()).ok_or_else(|| {
                CaseError::unknown(NameKind::Column, name, nearest(name, names()))
            })?;
            let place = names().position(|known| known == own).unwrap_or_default();
            Ok(Self { place, name: name.clone(), unit })
        };
        wanted.iter().map(named).collect()
    }

    /// Returns the values of the column in its displayed unit.
    ///
    /// * `columns`: values of all columns of the table.
    pub fn values(&self, columns: &[ColumnValues]) -> ColumnValues {
        match &columns[self.place] {
            ColumnValues::Numbers(values) => {
                ColumnValues::Numbers(values.iter().map(|value| self.unit.value(*value)).collect())
            }
            texts @ ColumnValues::Texts(_) => texts.clone(),
        }
    }
}

/// Returns the name in `known` that differs from `name` only in its unit, and the unit of `name`.
pub(crate) fn in_unit<'a>(
    name: &str,
    known: impl IntoIterator<Item = &'a str>,
) -> Option<(&'a str, DisplayUnit)> {
    let (own, change, text) = convert_with_text(name, known)?;
    // The name already ends with the suffix of the displayed unit, so no suffix is replaced.
    Some((own, DisplayUnit { text, other: Some(("", "", change)) }))
}

impl Numbers {
    /// Returns the list of numbers, converted to displayed units.
    #[must_use]
    pub fn in_units(mut self, display: DisplayUnits) -> Self {
        for row in self.all_mut() {
            let shown = display.of(row.unit);
            row.unit = shown.text;
            row.values = row.values.map(|value| Some(shown.value(value?)));
            row.bands = row.bands.map(|band| shown.band(band));
        }
        self
    }
}

impl Table {
    /// Returns the table in displayed units. If the rows have different units, the numbers in each
    /// row are converted from the unit of this row.
    #[must_use]
    fn in_units(mut self, display: DisplayUnits) -> Self {
        for (place, column) in self.columns.iter_mut().enumerate() {
            let shown = display.of(column.unit);
            column.unit = shown.text;
            column.head = column.head.take().map(|head| shown.name(&head).into());
            for row in &mut self.rows {
                row[place] = shown.json(&row[place]);
            }
            for bands in &mut self.bands {
                bands[place] = shown.band(bands[place]);
            }
        }
        for (place, unit) in self.row_units.iter_mut().enumerate() {
            let shown = display.of(unit);
            for cell in &mut self.rows[place] {
                *cell = match &*cell {
                    Value::String(text) if text == unit => json!(shown.text),
                    Value::String(text) => {
                        json!(shown.limit(text).unwrap_or_else(|| shown.name(text)))
                    }
                    other => shown.json(other),
                };
            }
            if let Some(bands) = self.bands.get_mut(place) {
                for band in bands {
                    *band = shown.band(*band);
                }
            }
            *unit = shown.text;
        }
        self
    }
}

impl Criterion {
    /// Returns the name of the limited quantity with the suffix of its displayed unit.
    pub fn shown_name(&self) -> String {
        self.unit.name(self.name)
    }

    /// Returns the rule in displayed units.
    #[must_use]
    fn in_units(self, display: DisplayUnits) -> Self {
        let unit = display.of(self.unit.text);
        Self {
            unit,
            value: unit.value(self.value),
            limit: self.limit.map(|limit| unit.value(limit)),
            band: unit.band(self.band),
            ..self
        }
    }
}

impl Answer {
    /// Returns the answer in displayed units. The sentences of notes and warnings keep the units of
    /// the vocabulary, because they contain names of inputs that end with these units.
    #[must_use]
    pub fn in_units(self, display: DisplayUnits) -> Self {
        if display == DisplayUnits::Metric {
            return self;
        }
        let content = |content| match content {
            Content::Numbers { numbers, whole, unbounded } => {
                Content::Numbers { numbers: numbers.in_units(display), whole, unbounded }
            }
            Content::Table(table) => Content::Table(table.in_units(display)),
            texts => texts,
        };
        let section = |section: Section| Section { content: content(section.content), ..section };
        Self {
            sections: self.sections.into_iter().map(section).collect(),
            rules: self.rules.into_iter().map(|rule| rule.in_units(display)).collect(),
            ..self
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values are converted correctly to the inch counterpart of each unit. The expected values
    /// were calculated by hand.
    #[test]
    fn conversion_factors_to_inch_units_match_hand_calculations() {
        for (own, text) in INCH {
            assert!(counterpart(own, text).is_some(), "{own} {text}");
        }
        for (unit, value, expected) in [
            ("mm", 25.4, 1.0),
            ("um", 25.4e-3, 1.0),
            ("N", 4.448_221_615_260_5, 1.0),
            ("N m", 0.112_984_829_027_616_7, 1.0),
            ("C", 20.0, 68.0),
            ("K", 5.0, 9.0),
            ("km", 25.4, 1.0),
            ("N/um", 1.0, 5_710.147_154_732_65),
            ("rpm", 7.0, 7.0),
        ] {
            let found = DisplayUnits::Inch.of(unit).value(value);
            // The result is rounded twice, and each rounding can cause an error of half a unit in
            // the last place.
            assert!((found / expected - 1.0).abs() < 1e-14, "{unit}: {found}");
            assert!((DisplayUnits::Metric.of(unit).value(value) - value).abs() <= 0.0, "{unit}");
        }
        let name = DisplayUnits::Inch.of("N m").name("screw_torque_Nm");
        assert_eq!(name, "screw_torque_lbf_in");
        let (label, _) = DisplayUnits::Inch.label("axial load, kN");
        assert_eq!(label, "axial load, klbf");
    }

    /// If the name of a requested column ends with a unit, the column has this unit instead of the
    /// default display unit.
    #[test]
    fn column_requested_with_a_unit_in_its_name_has_this_unit() {
        let heads = [
            ("screw_torque_Nm", "N m"),
            ("axis_stiffness_N_um", "N/um"),
            ("cycle_life_h", "h"),
            ("max_pressure_MPa", "MPa"),
        ];
        let heads = heads.map(|(name, unit)| (name.to_owned(), unit));
        let names = [
            "screw_torque_kgf_cm",
            "axis_stiffness_lbf_in",
            "cycle_life_d",
            "max_pressure_kgf_mm2",
        ];
        let wanted = names.map(str::to_owned);
        let columns =
            ShownColumn::select(&heads, Some(&wanted), DisplayUnits::Metric).expect("columns");
        let found: Vec<_> =
            columns.iter().map(|column| (&*column.name, column.unit.text)).collect();
        let units = ["kgf cm", "lbf/in", "d", "kgf/mm2"];
        assert_eq!(found, names.into_iter().zip(units).collect::<Vec<_>>());
        assert!((columns[0].unit.value(9.806_65) - 100.0).abs() < 1e-12);
    }

    /// A table can contain -0. It stays -0 in every unit that has no offset.
    #[test]
    fn unit_conversion_keeps_the_sign_of_zero() {
        let heads = [("axial_load_N".to_owned(), "N")];
        for display in [DisplayUnits::Metric, DisplayUnits::Inch] {
            let columns = ShownColumn::select(&heads, None, display).expect("columns");
            let ColumnValues::Numbers(values) =
                columns[0].values(&[ColumnValues::Numbers(vec![-0.0])])
            else {
                panic!("a column of numbers");
            };
            assert!(values[0].is_sign_negative(), "{display:?}");
        }
    }
}
