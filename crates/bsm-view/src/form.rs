//! Data for the input form of the page: groups of inputs with their units and permitted values, and
//! the names of all choices.

use bsm_case::units::{UnitChange, label, other_units};
use bsm_case::{
    Choice, DisplayUnit, DisplayUnits, INPUTS, ModelChoice, OUTPUTS, OutputType, Settings,
    input_schema, output_schema,
};
use bsm_dyn::{Control, model::RacewayFriction};
use serde_json::{Value, json};

use crate::answer::MAX_POINTS;

/// Returns the schemas of cases and results, and all other data that the form needs.
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
    let outputs = OUTPUTS.iter().filter(|output| output.output_type == OutputType::Number).map(|output| {
        let whole = label(output.name, output.unit);
        let words = whole.rsplit_once(", ").map_or(&*whole, |(words, _)| words);
        json!({ "name": output.name, "label": words, "unit": output.unit, "about": output.about })
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
        "output": output_schema(),
        "groups": groups,
        "inputs": inputs.collect::<Vec<_>>(),
        "outputs": outputs.collect::<Vec<_>>(),
        "models": ModelChoice::names().collect::<Vec<_>>(),
        "controls": Control::ALL.map(Control::name),
        "frictions": RacewayFriction::ALL.map(RacewayFriction::name),
        "settings": Settings::default().to_json(),
        "points": MAX_POINTS,
    })
}
