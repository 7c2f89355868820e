// The results of a case: the most important numbers at the top of the page, and all numbers at its end.

import {
  html,
  number,
  interval,
  percent,
  table,
  row,
  none,
  unitOf,
  shown,
  shownAll,
  shownUnit,
} from "bsm/draw";
import { OUTPUT } from "bsm/source";

/** Outputs at the top of the page. */
const KEYS = [
  "efficiency",
  "ball_torque_Nm",
  "dissipated_power_W",
  "nut_max_pressure_MPa",
  "axial_displacement_um",
  "ball_precession_rad_s",
];

export function showKey(host, result) {
  if (result.status !== "converged") {
    const words = `${result.status.replace("_", " ")} by model ${result.model}: ${result.message}`;
    host.replaceChildren(html("p", { class: "none bad" }, words), ...warnings(result));
    return;
  }
  const { band, groove_note: grooveNote } = result;
  host.replaceChildren(
    html("dl", { class: "keys" }, keys(result)),
    html("p", { class: "small" }, html("strong", {}, `Model ${result.model}. `), aboutModel(result)),
    band ? html("p", { class: "small" }, aboutBand(band)) : "",
    grooveNote
      ? html("p", { class: "small" }, `${grooveNote} Pictures and maps show the best groove only.`)
      : "",
    ...warnings(result),
  );
}

/** Creates the most important numbers with their labels. */
function keys(result) {
  const ends = result.groove_estimate?.intervals ?? {};
  const key = (name) => {
    if (!(name in result.shown.keys)) return [];
    const { value, unit, label } = result.shown.keys[name];
    const possible = ends[name] ? interval(shownAll(ends[name], OUTPUT.get(name).unit)) : null;
    return html(
      "div",
      {},
      html("dt", {}, result.without_error_bound?.includes(name) ? `${label} *` : label),
      html(
        "dd",
        { "data-output": name },
        number(value),
        html("small", {}, unit ? ` ${unitOf(unit)}` : ""),
        possible ? html("div", { class: "small faint" }, possible) : null,
      ),
    );
  };
  return KEYS.flatMap(key);
}

/** Describes the choice of the model, its error bound and its lubrication. */
function aboutModel(result) {
  const { choice, lubrication, loss_error_bound: bound, controlling_raceway: raceway } = result;
  return [
    choice ? `Reason for the choice: ${choice}. ` : "",
    bound != null && !lubrication ? `The error bound of the heat is ${percent(bound)} %. ` : "",
    lubrication ? `Lubrication: ${lubrication}. ` : "",
    raceway ? `The ${raceway} raceway controls.` : "",
  ].join("");
}

function aboutBand({ ball_torque_Nm: { low, high } }) {
  const [from, to] = [low, high].map((torque) => number(shown(torque, "N m")));
  const unit = shownUnit("N m");
  return `90 % interval of the torque for the uncertain oil properties: ${from} to ${to} ${unit}.`;
}

const warnings = ({ warnings }) => warnings.map((words) => html("p", { class: "warn" }, words));

export function showNumbers(host, result) {
  const { overall, contacts, unbounded } = result.shown;
  if (!overall.length && !contacts.length) {
    host.replaceChildren(none(result.message ?? "There are no numbers."));
    return;
  }
  const marked = (label) => (unbounded.includes(label) ? `${label} *` : label);
  const hasFarFlank = contacts.some(([, , values]) => values[2] != null);
  const heads = ["", "", "nut", "screw", ...(hasFarFlank ? ["far flank"] : [])];
  const overallRows = overall.map(([label, ...entry]) => row(marked(label), ...entry));
  const contactRows = contacts.map(([label, unit, values]) =>
    row(marked(label), unit, ...values.slice(0, hasFarFlank ? 3 : 2)),
  );
  const footnote =
    `* The error bound does not cover this value, which was calculated by model ${result.model}. ` +
    "For an accurate value, use model traction.";
  host.replaceChildren(
    html(
      "div",
      { class: "tables" },
      table("Ball and screw", null, overallRows),
      contacts.length ? table("Contacts", heads, contactRows) : null,
    ),
    unbounded.length ? html("p", { class: "small faint" }, footnote) : "",
  );
}
