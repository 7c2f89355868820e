// Comparison of all models at one operating point.

import { html, measuredNumber, labeled, table, none } from "bsm/draw";
import { OUTPUT, served } from "bsm/source";

/** Outputs of each model. */
const COLUMNS = [
  "efficiency",
  "ball_torque_Nm",
  "dissipated_power_W",
  "nut_normal_load_N",
  "nut_contact_angle_deg",
  "screw_contact_angle_deg",
];

/** Deviations of a model from the reference model, as texts. */
function deviations(model, reference) {
  if (model.model === reference) return ["reference", "reference"];
  const signed = (value, digits) =>
    value == null ? "–" : `${value < 0 ? "−" : "+"}${Math.abs(value).toFixed(digits)}`;
  const percent = model.loss_deviation == null ? null : 100 * model.loss_deviation;
  return [signed(model.efficiency_deviation, 5), signed(percent, 2)];
}

export function showModels(host, answer, solved) {
  if (answer instanceof Error) {
    host.replaceChildren(none(answer.message));
    return;
  }
  // In a saved page, no computing times are shown, because the clock of a browser is too coarse for them.
  const heads = [
    "model",
    ...COLUMNS.map((name) => labeled(OUTPUT.get(name).label, OUTPUT.get(name).unit)),
    "deviation of the efficiency",
    "deviation of the loss, %",
    ...(served ? ["time, µs"] : []),
  ];
  // 90 % intervals over the possible grooves, one object for each model.
  const ends = answer.groove_estimate?.intervals?.models ?? [];
  const rows = answer.models.map((model, place) => {
    const cells =
      model.status === "converged"
        ? cellsOf(model, ends[place], answer.reference_model)
        : failure(model, heads.length - 1);
    const isHere = model.model === solved?.model;
    return html("tr", { class: isHere ? "here" : null }, html("th", { scope: "row" }, model.model), cells);
  });
  // The note on the groove estimate is already shown at the top of the page.
  const notes = answer.groove_note ? answer.notes.filter((note) => note !== answer.groove_note) : [];
  const regime = answer.regime ?? "unknown, because no model has a solution here";
  host.replaceChildren(
    html("p", {}, html("strong", {}, "Regime: "), regime),
    table("All models whose inputs are given", heads, rows),
    leftOut(answer),
    ...notes.map((note) => html("p", { class: "small faint" }, note)),
  );
}

/**
 * Creates the cells of a model with a solution. `ends` contains the 90 % intervals by name, and `reference` is the name
 * of the model from which the deviations are calculated.
 */
function cellsOf(model, ends, reference) {
  const cells = COLUMNS.map((name) =>
    model[name] == null ? "–" : measuredNumber(model[name], OUTPUT.get(name).unit, ends?.[name]),
  );
  cells.push(...deviations(model, reference));
  if (served) cells.push(model.time_us.toFixed(2));
  return cells.map((cell) => html("td", { class: "number" }, cell));
}

/** Creates the cell of a model without a solution. */
function failure({ status, message }, columns) {
  const name = html("strong", {}, status.replace("_", " "));
  return html("td", { colspan: columns, class: "small" }, name, `: ${message}`);
}

/** Lists the omitted models. Models that are omitted for the same reason are listed together. */
function leftOut(answer) {
  const models = new Map();
  for (const { model, reason } of answer.left_out) models.set(reason, [...(models.get(reason) ?? []), model]);
  const words = [...models].map(([reason, names]) => `${names.join(", ")}: ${reason}`);
  return words.length ? html("p", { class: "small faint" }, `Not compared: ${words.join("; ")}.`) : "";
}
