// Comparison of all models at one operating point.

import { html, measuredNumber, labeled, table, none } from "bsm/draw";
import { served } from "bsm/source";

const COLUMNS = [["efficiency", "efficiency", ""], ["ball_torque_Nm", "torque", "N m"], ["dissipated_power_W", "heat", "W"],
  ["nut_normal_load_N", "normal load at the nut", "N"], ["nut_contact_angle_deg", "contact angle at the nut", "°"],
  ["screw_contact_angle_deg", "contact angle at the screw", "°"],
  // In a saved page, no computing times are shown, because the clock of a browser is too coarse to measure them.
  ...(served ? [["time_us", "time", "µs"]] : [])];

export function showModels(host, answer, solved) {
  if (answer instanceof Error) { host.replaceChildren(none(answer.message)); return; }
  // 90 % intervals over the possible grooves, one object for each model.
  const ends = answer.groove_estimate?.intervals?.models ?? [];
  const rows = answer.models.map((model, place) => html("tr", { class: model.model === solved?.model ? "here" : null }, html("th", { scope: "row" }, model.model),
    model.status === "converged" ?
      COLUMNS.map(([name, , unit]) => html("td", { class: "number" }, name === "time_us" ?
      model[name].toFixed(2) : model[name] == null ? "–" : measuredNumber(model[name], unit, ends[place]?.[name])))
      : html("td", { colspan: COLUMNS.length, class: "small" }, html("strong", {}, model.status.replace("_", " ")), `: ${model.message}`)));
  // Models that are omitted for the same reason are listed together.
  const why = new Map();
  for (const words of answer.left_out) {
    const name = words.match(/model ([a-z-]+)/)?.[1] ?? "", rest = words.replace(/^model [a-z-]+ /, "").replace(/ by model [a-z-]+/, "");
    why.set(rest, [...(why.get(rest) ?? []), name]);
  }
  const left = [...why].map(([rest, names]) => `${names.join(", ")}: ${rest}`);
  host.replaceChildren(html("p", {}, html("strong", {}, "Regime: "), answer.regime ?? "unknown, because no model has a solution here"),
    table("All models whose inputs are given", ["model", ...COLUMNS.map(([, words, unit]) => labeled(words, unit))], rows),
    left.length ? html("p", { class: "small faint" }, `Not compared: ${left.join("; ")}.`) : "",
    // The first note describes the groove estimate, which is already shown at the top of the page.
    ...(answer.groove_estimate ? answer.notes.slice(1) : []).map((note) => html("p", { class: "small faint" }, note)));
}
