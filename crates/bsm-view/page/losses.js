// The components of the power loss.

import {
  html,
  svg,
  text,
  picture,
  number,
  numberOf,
  interval,
  percent,
  none,
  legend,
  narrow,
} from "bsm/draw";
import { OUTPUT } from "bsm/source";

/** Components of the loss with a lubricant, with their colors. */
const OILED = [
  ["sliding_power_W", "--c1"],
  ["rolling_power_W", "--c3"],
  ["seal_power_W", "--c5"],
  ["ball_contact_power_W", "--c4"],
  ["return_power_W", "--c2"],
  ["drag_power_W", "--c6"],
];
/** Components of the loss of each contact with a friction coefficient. */
const DRY = [
  ["center", "sliding of the contact center"],
  ["spin", "spin"],
  ["curvature", "curvature of the contact surface"],
];
/** Contacts, with their colors and, if it differs, the beginning of the names of their results. */
const CONTACTS = [
  ["nut", "--c1"],
  ["screw", "--c2"],
  ["far flank", "--c4", "unloaded_flank"],
];

export function showLosses(host, result, slip) {
  if (result.dissipated_power_W == null) {
    host.replaceChildren(none(reasonWithoutPowers(result)));
    return;
  }
  const oil = result.sliding_power_W != null;
  if (!oil && slip.error) {
    const total = html("p", {}, `${numberOf(result, "dissipated_power_W")} W in total.`);
    host.replaceChildren(total, none(slip.error));
    return;
  }
  const rows = oil ? oiledRows(result) : dryRows(result, slip);
  const ends = endsOfTotal(result, oil);
  const shownContacts = CONTACTS.filter(([name]) => rows.some(([words]) => words.endsWith(name)));
  const contacts = legend(shownContacts.map(([name, paint]) => [name, `var(${paint})`]));
  const share = number((100 * result.dissipated_power_W) / result.input_power_W);
  const words = html(
    "p",
    { class: "small" },
    html("strong", {}, `${numberOf(result, "dissipated_power_W")} W of heat`),
    `, ${share} % of the input power of ${numberOf(result, "input_power_W")} W.`,
    meaningOfLine(result, oil, ends),
  );
  const beside = html("div", {}, oil ? null : contacts, words);
  host.replaceChildren(html("div", { class: "split" }, chart(result, rows, ends), beside));
}

function reasonWithoutPowers({ status, model, efficiency }) {
  if (status !== "converged") return "There is no solution, so there are no losses to show.";
  return (
    `Model ${model} calculates an efficiency of ${number(efficiency)}, but no powers. ` +
    "Powers require the speed, the axial load and the number of loaded balls."
  );
}

/** Returns the 90 % interval of a number over the possible grooves. */
const endsOf = (answer, name) => answer.groove_estimate?.intervals?.[name];

/** Returns the components of the loss with a lubricant: label, power, color and interval. */
function oiledRows(result) {
  const rows = OILED.map(([name, paint]) => [
    result.shown.keys[name]?.label ?? OUTPUT.get(name).label,
    result[name] ?? 0,
    paint,
    endsOf(result, name),
  ]);
  return rows.filter(([, power]) => power !== 0);
}

/** Returns the components of the loss with a friction coefficient: label, power, color and interval. */
function dryRows(result, slip) {
  const rows = DRY.flatMap(([component, words]) =>
    CONTACTS.map(([contact, paint, key = contact]) => {
      const name = `${key}_${component}_power_W`;
      return [`${words}, ${contact}`, slip[name], paint, endsOf(slip, name)];
    }),
  );
  return rows.filter(([, power]) => power != null && Math.abs(power) > 1e-9 * result.dissipated_power_W);
}

/**
 * Returns the ends of the line at the bar of the total loss. With a lubricant, they are the 90 % interval for
 * the uncertain oil properties. With a friction coefficient, they follow from the error bound.
 */
function endsOfTotal(result, oil) {
  const total = result.dissipated_power_W;
  const ratio = result.band?.contact_loss_ratio;
  if (ratio) {
    const contacts = oil ? result.sliding_power_W + result.rolling_power_W : 0;
    return [ratio.low, ratio.high].map((end) => total + (end - 1) * contacts);
  }
  const bound = oil ? null : result.loss_error_bound;
  return bound == null ? null : [Math.max(total * (1 - bound), 0), total * (1 + bound)];
}

function meaningOfLine(result, oil, ends) {
  if (result.band?.contact_loss_ratio) {
    const [low, high] = ends.map(number);
    return ` The line shows the 90 % interval for the uncertain oil properties, ${low} to ${high} W.`;
  }
  const bound = oil ? null : result.loss_error_bound;
  return bound == null ? "" : ` The line shows the error bound, ${percent(bound)} %.`;
}

/** Draws a bar for each component of the loss and for the total. */
function chart(result, rows, ends) {
  const total = result.dissipated_power_W;
  const high = Math.max(total, ...rows.map(([, power]) => power));
  const low = Math.min(0, ...rows.map(([, power]) => power));
  // On a phone, the labels are above the bars. Otherwise, the longest label determines the start of the bars
  // (7 px per letter).
  const phone = narrow();
  const longest = Math.max(31, ...rows.map(([words]) => words.length));
  const [left, width, step, top, base] = phone ? [2, 340, 40, 18, 13] : [8 + 7 * longest, 560, 27, 4, 17];
  // The numbers are to the right of the bars. Numbers with intervals need more space.
  const room = result.groove_estimate ? 180 : 78;
  const x = (v) => left + ((v - low) / (high - low || 1)) * (width - left - room - 0.12 * (width - left));
  const far = ends ? Math.min(ends[1], high * 1.12) : 0;
  // The style sheet fills rectangles outside a group with the background color.
  const bar = (y, power, fill) => {
    const length = Math.max(Math.abs(x(power) - x(0)), 0.8);
    const rectangle = { x: Math.min(x(0), x(power)), y, width: length, height: 18, fill, rx: 2 };
    return svg("g", {}, svg("rect", rectangle));
  };
  const line = ([words, power, paint, possible], i) => {
    const y = i * step + top;
    const labelAttributes = {
      "text-anchor": phone ? "start" : "end",
      style: paint ? null : "font-weight:600",
    };
    const end = Math.max(x(paint ? power : Math.max(power, far)), x(0));
    return [
      text(phone ? left : left - 8, i * step + base, words, labelAttributes),
      bar(y, power, `var(${paint ?? "--steel"})`),
      text(end + 6, y + 13, `${number(power)}${interval(possible)} W`),
    ];
  };
  const lines = [...rows, ["total", total, null, endsOf(result, "dissipated_power_W")]].flatMap(line);
  const middle = rows.length * step + top + 9;
  const whisker = ends
    ? svg("path", { d: `M${x(ends[0])} ${middle}H${x(far)}`, stroke: "var(--ink)", "stroke-width": 2 })
    : null;
  const components = rows.map(([words, power]) => `${words} ${number(power)}`).join("; ");
  const label = `Loss in watts: ${components}; total ${number(total)}`;
  return picture(width, (rows.length + 1) * step + 6, label, ...lines, whisker);
}
