// The results of a case: the most important numbers at the top of the page, and all numbers at its end.

import {
  html,
  number,
  interval,
  brief,
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
    host.replaceChildren(
      html(
        "p",
        { class: "none bad" },
        `${result.status.replace("_", " ")} by model ${result.model}: ${result.message}`,
      ),
      ...warnings(result),
    );
    return;
  }
  const ends = result.groove_estimate?.intervals ?? {};
  const keys = KEYS.flatMap((name) => {
    const [value, unit] = result.shown.keys[name] ?? [];
    const { label, unit: ownUnit } = OUTPUT.get(name);
    return value == null
      ? []
      : [
          html(
            "div",
            {},
            html("dt", {}, result.without_error_bound?.includes(name) ? `${label} *` : label),
            html(
              "dd",
              { "data-output": name },
              number(value),
              html("small", {}, unit ? ` ${unitOf(unit)}` : ""),
              ends[name]
                ? html("div", { class: "small faint" }, interval(shownAll(ends[name], ownUnit)))
                : null,
            ),
          ),
        ];
  });
  const band = result.band;
  host.replaceChildren(
    html("dl", { class: "keys" }, keys),
    html(
      "p",
      { class: "small" },
      html("strong", {}, `Model ${result.model}. `),
      result.choice ? `Reason for the choice: ${result.choice}. ` : "",
      result.loss_error_bound != null && !result.lubrication
        ? `The error bound of the heat is ${brief(Number((100 * result.loss_error_bound).toPrecision(2)))} %. `
        : "",
      result.lubrication ? `Lubrication: ${result.lubrication}. ` : "",
      result.controlling_raceway ? `The ${result.controlling_raceway} raceway controls.` : "",
    ),
    ...(band
      ? [
          html(
            "p",
            { class: "small" },
            `90 % interval of the torque for the uncertain oil properties: ${number(shown(band.ball_torque_Nm.low, "N m"))} to ${number(shown(band.ball_torque_Nm.high, "N m"))} ${shownUnit("N m")}.`,
          ),
        ]
      : []),
    ...(result.groove_note
      ? [html("p", { class: "small" }, `${result.groove_note} Pictures and maps show the best groove only.`)]
      : []),
    ...warnings(result),
  );
}

const warnings = ({ warnings }) => warnings.map((words) => html("p", { class: "warn" }, words));

export function showNumbers(host, result) {
  const { overall, contacts, unbounded } = result.shown;
  const marked = (label) => (unbounded.includes(label) ? `${label} *` : label);
  if (!overall.length && !contacts.length) {
    host.replaceChildren(none(result.message ?? "There are no numbers."));
    return;
  }
  const unloaded = contacts.some(([, , values]) => values[2] != null);
  host.replaceChildren(
    html(
      "div",
      { class: "tables" },
      table(
        "Ball and screw",
        null,
        overall.map(([label, ...entry]) => row(marked(label), ...entry)),
      ),
      contacts.length
        ? table(
            "Contacts",
            ["", "", "nut", "screw", ...(unloaded ? ["far flank"] : [])],
            contacts.map(([label, unit, values]) =>
              row(marked(label), unit, ...values.slice(0, unloaded ? 3 : 2)),
            ),
          )
        : null,
    ),
    ...(unbounded.length
      ? [
          html(
            "p",
            { class: "small faint" },
            `* The error bound does not cover this value, which was calculated by model ${result.model}. For an accurate value, use model traction.`,
          ),
        ]
      : []),
  );
}
