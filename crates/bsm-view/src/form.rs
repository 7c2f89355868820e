//! Data for the input form of the page: grouped inputs with their units and permitted values, and
//! the names of all choices.

use bsm_case::units::{label, other_units};
use bsm_case::{INPUTS, ModelChoice, OUTPUTS, Settings, input_schema, output_schema};
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
    let outputs = OUTPUTS.iter().filter(|output| output.json_type == "number").map(
        |output| json!({ "name": output.name, "label": label(output.name, output.unit), "about": output.about }),
    );
    json!({
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
