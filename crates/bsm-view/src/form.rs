//! Data for the input form and the labels of the page: groups of inputs with their units and
//! permitted values, outputs, and the names of the models.

use bsm_case::units::{UnitChange, label, other_units};
use bsm_case::{Choice, DisplayUnit, DisplayUnits, INPUTS, ModelChoice, OUTPUTS, input_schema};
use serde_json::{Value, json};

/// Returns the schema of cases, the names and units of inputs and outputs, and the display units.
pub(crate) fn schema() -> Value {
    let mut groups = Vec::new();
    for input in INPUTS {
        if !groups.contains(&input.title) {
            groups.push(input.title);
        }
    }
    let inputs = INPUTS.iter().map(|input| {
        let whole = label(input.name, "");
        let label = label(input.name, input.unit).split(',').next().map_or(whole, str::to_owned);
        let units: Vec<_> = other_units(input.name)
            .into_iter()
            .map(|(unit, change)| json!([unit, change.factor, change.zero]))
            .collect();
        json!({
            "name": input.name,
            "label": label,
            "unit": input.unit,
            "about": input.about,
            "rule": input.rule.describe(),
            "default": input.default,
            "group": input.title,
            "units": units,
        })
    });
    let outputs = OUTPUTS.iter().filter(|output| output.json_type == "number").map(|output| {
        let whole = label(output.name, output.unit);
        let words = whole.rsplit_once(", ").map_or(&*whole, |(words, _)| words);
        json!({ "name": output.name, "label": words, "unit": output.unit })
    });
    // For each unit system, the list contains the display units that differ from the metric units,
    // each with its text, its conversion factor and the offset of its zero point.
    let display = DisplayUnits::NAMES.iter().map(|(name, units)| {
        let unit = |(own, shown): (&str, DisplayUnit)| {
            let UnitChange { factor, zero } = shown.change();
            (own.to_owned(), json!([shown.text, factor, zero]))
        };
        ((*name).to_owned(), units.changed().map(unit).collect::<Value>())
    });
    json!({
        "display": display.collect::<Value>(),
        "input": input_schema(),
        "groups": groups,
        "inputs": inputs.collect::<Vec<_>>(),
        "outputs": outputs.collect::<Vec<_>>(),
        "models": ModelChoice::names().collect::<Vec<_>>(),
    })
}
