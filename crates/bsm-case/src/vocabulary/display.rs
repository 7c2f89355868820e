//! Units in which answers are displayed. JSON always uses the units of the vocabulary.

use bsm_design::Band;
use serde_json::{Value, json};

use super::entries::Named;
use super::number::trimmed;
use super::units::{UnitChange, change_of, convert};
use crate::{
    Answer, Case, CaseError, ColumnValues, Content, Criterion, Known, Numbers, Section, Table,
    nearest,
};

/// System of units for screen, sheet, figures and columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum DisplayUnits {
    /// Units of the vocabulary.
    #[default]
    Metric,
    /// Inches, pounds and degrees Fahrenheit.
    Inch,
}

/// Units of the vocabulary and their counterparts in the inch system, each with the suffix that it
/// has in names. Units that are not listed are the same in both systems.
const INCH: [[(&str, &str); 2]; 23] = [
    [("mm", "mm"), ("in", "in")],
    [("um", "um"), ("uin", "uin")],
    [("m", "m"), ("ft", "ft")],
    [("km", "km"), ("million in", "million_in")],
    [("mm2", "mm2"), ("in2", "in2")],
    [("N", "N"), ("lbf", "lbf")],
    [("kN", "kN"), ("klbf", "klbf")],
    [("N m", "Nm"), ("lbf in", "lbf_in")],
    [("N mm", "Nmm"), ("lbf in", "lbf_in")],
    [("m/min", "m_min"), ("in/min", "in_min")],
    [("m/s", "m_s"), ("in/s", "in_s")],
    [("mm/s", "mm_s"), ("in/s", "in_s")],
    [("mm/min", "mm_min"), ("in/min", "in_min")],
    [("m/s2", "m_s2"), ("in/s2", "in_s2")],
    [("kg", "kg"), ("lb", "lb")],
    [("kg/m", "kg_m"), ("lb/in", "lb_in")],
    [("kg/m3", "kg_m3"), ("lb/in3", "lb_in3")],
    [("kg m2", "kg_m2"), ("lb in2", "lb_in2")],
    [("N/um", "N_um"), ("lbf/in", "lbf_in")],
    [("MPa", "MPa"), ("psi", "psi")],
    [("GPa", "GPa"), ("Mpsi", "Mpsi")],
    [("C", "C"), ("degF", "degF")],
    [("K", "K"), ("degF", "degF")],
];

/// A displayed unit, and the conversion to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DisplayUnit {
    /// Unit as text.
    pub text: &'static str,
    /// Suffixes of the displayed unit and of the unit of the vocabulary, if the units differ.
    suffixes: Option<(&'static str, &'static str)>,
    change: UnitChange,
}

impl DisplayUnit {
    /// Converts a number from the unit of the vocabulary. If the unit is the same in both systems,
    /// the number is returned unchanged, including the sign of zero.
    pub fn value(self, value: f64) -> f64 {
        if self.suffixes.is_none() { value } else { self.change.back(value) }
    }

    /// Converts both ends of an interval.
    pub fn band(self, band: Option<Band>) -> Option<Band> {
        band.map(|Band { low, high }| Band { low: self.value(low), high: self.value(high) })
    }

    /// Returns the name of a quantity with the suffix of the displayed unit.
    pub fn name(self, name: &str) -> String {
        let renamed = self.suffixes.and_then(|(shown, own)| {
            Some(format!("{}_{shown}", name.strip_suffix(own)?.strip_suffix('_')?))
        });
        renamed.unwrap_or_else(|| name.to_owned())
    }

    /// Converts the number in a requirement such as "<= 12000". Returns `None` if the text has
    /// another form.
    fn limit(self, text: &str) -> Option<String> {
        let (sign, number) =
            text.split_once(' ').filter(|(sign, _)| [">=", "<="].contains(sign))?;
        Some(format!("{sign} {}", trimmed(self.value(number.parse().ok()?))))
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
        self.nut.display_units.map(|Named(units)| units).unwrap_or_default()
    }
}

impl DisplayUnits {
    /// Returns the displayed unit that corresponds to a unit of the vocabulary.
    pub fn of(self, unit: &'static str) -> DisplayUnit {
        let found = INCH.iter().find(|[(own, _), _]| *own == unit).filter(|_| self == Self::Inch);
        match found {
            Some([(_, own), (text, shown)]) => DisplayUnit {
                text,
                suffixes: Some((shown, own)),
                change: change_of(shown, own).unwrap_or(UnitChange::NONE),
            },
            None => DisplayUnit { text: unit, suffixes: None, change: UnitChange::NONE },
        }
    }

    /// Replaces the unit in a label such as "axial load, N" by the displayed unit, and returns the
    /// label and this unit.
    pub fn label(self, label: &str) -> (String, DisplayUnit) {
        let (words, unit) = label.rsplit_once(", ").unwrap_or((label, ""));
        let known = INCH.iter().map(|[(own, _), _]| *own).find(|own| *own == unit);
        let shown = self.of(known.unwrap_or_default());
        let text = if shown.text.is_empty() {
            label.to_owned()
        } else {
            format!("{words}, {}", shown.text)
        };
        (text, shown)
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
    /// Index among the columns of the table.
    pub place: usize,
    /// Name, with the displayed unit as suffix.
    pub name: String,
    /// Displayed unit as text.
    pub unit: &'static str,
    change: UnitChange,
}

impl ShownColumn {
    /// Selects the columns of a table that are displayed.
    ///
    /// * `heads`: name and unit of each column of the table.
    /// * `wanted`: names of the selected columns, in any unit. If it is `None`, all columns are
    ///   displayed in the units of `display`.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError::Unknown`] for a name that is not a column.
    pub fn select(
        heads: &[(String, &'static str)],
        wanted: Option<&[String]>,
        display: DisplayUnits,
    ) -> Result<Vec<Self>, CaseError> {
        let displayed = |(place, (name, unit)): (usize, &(String, &'static str))| {
            let shown = display.of(unit);
            Self { place, name: shown.name(name), unit: shown.text, change: shown.change }
        };
        let Some(wanted) = wanted else {
            return Ok(heads.iter().enumerate().map(displayed).collect());
        };
        let names = || heads.iter().map(|(name, _)| name.as_str());
        let named = |name: &String| {
            if let Some(own) = heads.iter().enumerate().find(|(_, (own, _))| own == name) {
                return Ok(displayed(own));
            }
            let (own, change) = convert(name, names())
                .ok_or_else(|| CaseError::unknown(Known::Column, name, nearest(name, names())))?;
            let place = names().position(|known| known == own).unwrap_or_default();
            Ok(Self { place, name: name.clone(), unit: unit_of(name), change })
        };
        wanted.iter().map(named).collect()
    }

    /// Returns the values of the column in its displayed unit.
    ///
    /// * `columns`: values of all columns of the table.
    pub fn values(&self, columns: &[ColumnValues]) -> ColumnValues {
        match &columns[self.place] {
            ColumnValues::Numbers(values) => {
                ColumnValues::Numbers(values.iter().map(|value| self.change.back(*value)).collect())
            }
            texts @ ColumnValues::Texts(_) => texts.clone(),
        }
    }
}

/// Returns the unit that a name has as its suffix, as text. The text is empty if [`INCH`] does not
/// contain the suffix.
fn unit_of(name: &str) -> &'static str {
    let is_suffix =
        |suffix: &str| name.strip_suffix(suffix).is_some_and(|stem| stem.ends_with('_'));
    let known = INCH.iter().flatten().filter(|(_, suffix)| is_suffix(suffix));
    known.max_by_key(|(_, suffix)| suffix.len()).map_or("", |(text, _)| text)
}

impl Numbers {
    /// Returns the numbers in displayed units.
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
    /// Returns the table in displayed units. If a row has its own unit, the numbers in this row are
    /// converted from this unit.
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
    /// Returns the name of the number with the suffix of its displayed unit.
    pub fn shown_name(&self) -> String {
        let renamed =
            INCH.iter().filter(|[_, (text, _)]| *text == self.unit).find_map(|[own, shown]| {
                let stem = self.name.strip_suffix(own.1)?.strip_suffix('_')?;
                Some(format!("{stem}_{}", shown.1))
            });
        renamed.unwrap_or_else(|| self.name.to_owned())
    }

    /// Returns the rule in displayed units.
    #[must_use]
    fn in_units(self, display: DisplayUnits) -> Self {
        let shown = display.of(self.unit);
        Self {
            unit: shown.text,
            value: shown.value(self.value),
            limit: self.limit.map(|limit| shown.value(limit)),
            band: shown.band(self.band),
            ..self
        }
    }
}

impl Answer {
    /// Returns the answer in displayed units. Sentences keep the units of the vocabulary, because
    /// they contain names of inputs that end with these units.
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

    /// Each counterpart has the correct size. The expected values were calculated by hand.
    #[test]
    fn units_have_their_counterparts() {
        for [(own, suffix), (text, shown)] in INCH {
            assert!(change_of(shown, suffix).is_some(), "{own} {text}");
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
            // Two roundings can each cause an error of half a unit in the last place.
            assert!((found / expected - 1.0).abs() < 1e-14, "{unit}: {found}");
            assert!((DisplayUnits::Metric.of(unit).value(value) - value).abs() <= 0.0, "{unit}");
        }
        let name = DisplayUnits::Inch.of("N m").name("screw_torque_Nm");
        assert_eq!(name, "screw_torque_lbf_in");
        let (label, _) = DisplayUnits::Inch.label("axial load, kN");
        assert_eq!(label, "axial load, klbf");
    }
}
