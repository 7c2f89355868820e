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
  // 90 % intervals over the possible grooves, one object for each model.
  const ends = answer.groove_estimate?.intervals?.models ?? [];
  // In a saved page, no computing times are shown, because the clock of a browser is too coarse to measure them.
  const heads = [
    ...COLUMNS.map((name) => labeled(OUTPUT.get(name).label, OUTPUT.get(name).unit)),
    "deviation of the efficiency",
    "deviation of the loss, %",
    ...(served ? ["time, µs"] : []),
  ];
  const cells = (model, ends) => [
    ...COLUMNS.map((name) =>
      model[name] == null ? "–" : measuredNumber(model[name], OUTPUT.get(name).unit, ends?.[name]),
    ),
    ...deviations(model, answer.reference_model),
    ...(served ? [model.time_us.toFixed(2)] : []),
  ];
  const rows = answer.models.map((model, place) =>
    html(
      "tr",
      { class: model.model === solved?.model ? "here" : null },
      html("th", { scope: "row" }, model.model),
      model.status === "converged"
        ? cells(model, ends[place]).map((cell) => html("td", { class: "number" }, cell))
        : html(
            "td",
            { colspan: heads.length, class: "small" },
            html("strong", {}, model.status.replace("_", " ")),
            `: ${model.message}`,
          ),
    ),
  );
  // Models that are omitted for the same reason are listed together.
  const modelsByReason = new Map();
  for (const { model, reason } of answer.left_out)
    modelsByReason.set(reason, [...(modelsByReason.get(reason) ?? []), model]);
  const left = [...modelsByReason].map(([reason, models]) => `${models.join(", ")}: ${reason}`);
  host.replaceChildren(
    html(
      "p",
      {},
      html("strong", {}, "Regime: "),
      answer.regime ?? "unknown, because no model has a solution here",
    ),
    table("All models whose inputs are given", ["model", ...heads], rows),
    left.length ? html("p", { class: "small faint" }, `Not compared: ${left.join("; ")}.`) : "",
    // The note on the groove estimate is already shown at the top of the page.
    ...(answer.groove_estimate ? answer.notes.filter((note) => note !== answer.groove_note) : []).map(
      (note) => html("p", { class: "small faint" }, note),
    ),
  );
}
