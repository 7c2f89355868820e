// All balls of a nut: their loads, and the displacement of the nut.

import {
  html,
  svg,
  text,
  picture,
  number,
  shown,
  shownAll,
  shownUnit,
  measured,
  measuredOf,
  numberOf,
  labeled,
  none,
  axes,
  scale,
  path,
  legend,
  rampCss,
  rampBar,
  table,
  row,
  narrow,
} from "bsm/draw";

const SIDES = [
  ["nut_plus_N", "nut, flank +", "--c1", "circle"],
  ["nut_minus_N", "nut, flank −", "--c2", "square"],
];
/** Width of the numbers and the label of a vertical axis [px]. */
const ROOM = 64;
/** Attributes of a circle that marks a point of a curve. */
const RING = { r: 5, fill: "none", stroke: "var(--ink)", "stroke-width": 2 };

/** Returns the width and height of a chart, and the rectangle for its curves. */
const sizes = () => {
  const width = narrow() ? 340 : 460;
  const height = 270;
  return [width, height, [ROOM, 12, width - 12, height - 42]];
};
const span = (values) => {
  const v = values.filter(Number.isFinite);
  return [Math.min(...v), Math.max(...v)];
};

export function showNut(host, answer) {
  if (answer instanceof Error || answer.status !== "converged") {
    host.replaceChildren(none(answer.message ?? ""));
    return;
  }
  host.columns = () => ({
    balls: mapValues(answer.balls, ({ values }) => values),
    curve: mapValues(answer.curve, ({ values }) => values),
  });
  const [balls, curve] = [inUnits(answer.balls), inUnits(answer.curve)];
  host.replaceChildren(
    html(
      "div",
      { class: "pair" },
      sharing(balls, answer),
      developed(balls),
      deflection(curve, answer),
      train(balls, answer),
      html("div", { class: "warm" }),
      html("div", {}, remarks(answer)),
    ),
    html(
      "details",
      {},
      html("summary", {}, "Numbers of the nut"),
      html("div", { class: "tables" }, groups(answer.shown)),
    ),
  );
}

/** Applies a function to all values of an object. */
const mapValues = (object, change) =>
  Object.fromEntries(Object.entries(object).map(([name, value]) => [name, change(value)]));

/** Converts the values of columns to their display units. */
const inUnits = (columns) => mapValues(columns, ({ values, unit }) => shownAll(values, unit));

/** Creates the notes and warnings of an answer. */
export const remarks = ({ notes, warnings }) => [
  ...notes.map((note) => html("p", { class: "small faint" }, note)),
  ...warnings.map((warning) => html("p", { class: "warn" }, warning)),
];

/** Creates tables of numbers with their titles. */
export function groups(rows) {
  const titles = [...new Set(rows.map(([title]) => title))];
  return titles.map((title) =>
    table(
      title,
      null,
      rows.filter(([t]) => t === title).map(([, ...entry]) => row(...entry)),
    ),
  );
}

const figure = (words, ...children) =>
  html("figure", {}, html("figcaption", {}, html("strong", {}, words)), ...children);
const mark = (kind, x, y, paint) =>
  kind === "circle"
    ? svg("circle", { cx: x, cy: y, r: 3.2, fill: paint })
    : svg("path", { d: `M${x - 3} ${y - 3}h6v6h-6Z`, fill: paint });

/** Draws the load of each ball at its position along the axis. */
function sharing(balls, answer) {
  const [width, height, box] = sizes();
  const sides = SIDES.filter(([name]) => balls[name].some((v) => v > 0));
  const high = Math.max(...sides.flatMap(([name]) => balls[name]), 1e-9);
  const [first, last] = span(balls.z_mm);
  const x = scale(first === last ? [first - 1, last + 1] : [first, last], [box[0], box[2]]);
  const y = scale([0, high * 1.06], [box[3], box[1]]);
  const dot =
    ([name, , paint, kind]) =>
    (load, i) => {
      if (!(load > 0)) return null;
      const z = balls.z_mm[i];
      const words = `ball ${i + 1}: ${number(load)} ${shownUnit("N")} at ${number(z)} ${shownUnit("mm")}`;
      return svg("g", {}, svg("title", {}, words), mark(kind, x(z), y(load), `var(${paint})`));
    };
  const dots = sides.flatMap((side) => balls[side[0]].map(dot(side)));
  const { unloaded_balls: unloaded, max_contact_load_N: most, max_over_mean: ratio } = answer;
  const largest = `largest ${measured(most, "N")}, ${number(ratio)} times the mean`;
  return figure(
    "Load of each ball along the axis",
    picture(
      width,
      height,
      `Load of each ball along the axis: ${largest}, ${unloaded} balls unloaded`,
      axes(x, y, box, labeled("position along the axis", "mm"), labeled("load", "N"), ROOM),
      ...dots,
    ),
    legend(
      sides.map(([, words, paint, kind]) => [words, `var(${paint})`, kind === "circle" ? kind : undefined]),
    ),
    html(
      "p",
      { class: "small" },
      `The largest load is ${measuredOf(answer, "max_contact_load_N", "N")}, `,
      `${numberOf(answer, "max_over_mean")} times the mean. `,
      `${unloaded} of ${balls.z_mm.length} balls are unloaded.`,
    ),
  );
}

/** Draws the balls in a developed view of the nut, colored by their loads. */
function developed(balls) {
  const [width, height, box] = sizes();
  const load = balls.nut_plus_N.map((v, i) => Math.max(v, balls.nut_minus_N[i], 0));
  const high = Math.max(...load, 1e-9);
  const low = Math.min(...load);
  const turn = balls.theta_deg.map((v) => ((v % 360) + 360) % 360);
  const [first, last] = span(balls.z_mm);
  const room = 0.06 * (last - first) + 0.5;
  const x = scale([0, 360], [box[0], box[2]]);
  const y = scale([first - room, last + room], [box[3], box[1]]);
  const paint = (v) => (v > 0 ? rampCss(high > low * 1.0001 ? (v - low) / (high - low) : 0.6) : "none");
  const unit = shownUnit("N");
  const dots = turn.map((v, i) => {
    const center = { cx: x(v), cy: y(balls.z_mm[i]), r: 5 };
    const style = { fill: paint(load[i]), stroke: "var(--ink)", "stroke-width": 0.8 };
    const words = `ball ${i + 1}: ${number(load[i])} ${unit}`;
    return svg("circle", { ...center, ...style }, svg("title", {}, words));
  });
  const range = `from ${number(low)} to ${number(high)} ${unit}`;
  return figure(
    "Developed view of the balls and their loads",
    picture(
      width,
      height,
      `Developed view of the nut with balls colored by load ${range}`,
      axes(x, y, box, "angle around the axis, °", labeled("position along the axis", "mm"), ROOM),
      ...dots,
    ),
    rampBar(low, high, labeled("load", "N")),
  );
}

/**
 * Draws the speeds and the advance of the balls along the helix and, if the gap is given, touching balls and
 * their forces.
 */
function train(balls, answer) {
  // If all balls move identically, the calculated advance is only a rounding error, far below a nanometer.
  if (!(answer.needed_gap_mm > 1e-6)) return null;
  const motion = motionOf(balls);
  const { turns, free, moving, front, most, touches } = motion;
  const [width, , [left, top, right]] = sizes();
  const x = scale(span(turns), [left, right]);
  // The diagrams are stacked, each with its own frame and with room for tick labels below.
  let from = top;
  const strip = (values, words, height, axis = "") => {
    const [low, high] = span(values);
    const room = 0.05 * (high - low);
    const box = [left, from, right, from + height];
    const y = scale(high > low ? [low - room, high + room] : [low - 1, low + 1], [box[3], box[1]]);
    from += height + 26;
    return { box, y, frame: axes(x, y, box, axis, words, ROOM) };
  };
  const speeds = strip([...free, ...moving], "speed deviation, %", 130);
  const pushes = most > 0 ? strip([0, most], labeled("force", "N"), 60) : null;
  const advances = strip(
    [0, ...balls.advance_mm.map((v) => v ?? NaN)],
    labeled("advance", "mm"),
    90,
    "position along the helix, turns",
  );
  const strips = [speeds, pushes, advances].filter(Boolean);
  const [slow, fast] = span(free).map(number);
  const force = `${number(most)} ${shownUnit("N")}`;
  const touching = touches.filter(Boolean).length;
  const contact = `, ${touching} touching balls with forces of up to ${force} between them`;
  const words = `from ${slow} to ${fast} percent relative to their mean${most > 0 ? contact : ""}`;
  return figure(
    "Speeds and advance of the balls along the helix",
    picture(
      width,
      from + 12,
      `Speeds of the balls without push forces, ${words}`,
      ...strips.map((strip) => strip.frame),
      ...strips.flatMap((strip) => shades(balls, motion, x, strip.box)),
      ...trainSpeeds(balls, answer, motion, x, speeds.y),
      ...(pushes ? pushForces(front, turns, x, pushes.y) : []),
      ...speedDots(motion, x, speeds.y),
      ...advanceDots(balls, turns, x, advances.y),
    ),
    legend([
      ["speed without push forces, relative to the mean", "var(--c1)", "circle"],
      ...(most > 0
        ? [
            ["with push forces", "var(--c2)", "circle"],
            ["speed of touching balls", "var(--c2)", "solid"],
            ["touching balls", "color-mix(in srgb, var(--c5) 30%, transparent)"],
            [`force of the ball in front, up to ${force}`, "var(--c2)"],
          ]
        : []),
    ]),
    html(
      "p",
      { class: "small" },
      "No balls touch if the gaps of a circuit total at least ",
      `${measuredOf(answer, "needed_gap_mm", "mm")}.`,
    ),
  );
}

/**
 * Returns the motion of the balls: positions along the helix [turns], speeds without and with push forces
 * [deviation from the mean in %], the force from the ball in front and its maximum, and which balls touch.
 */
function motionOf(balls) {
  const rates = balls.free_rate.filter((rate) => rate != null);
  const mean = rates.reduce((sum, rate) => sum + rate, 0) / rates.length;
  const deviation = (rate) => (rate == null ? NaN : 100 * (rate / mean - 1));
  const front = balls.front_push_N.map((v) => v ?? 0);
  return {
    turns: balls.theta_deg.map((v) => v / 360),
    free: balls.free_rate.map(deviation),
    moving: balls.rate.map(deviation),
    front,
    most: Math.max(...front, 0),
    touches: front.map((force, i) => force > 0 || balls.back_push_N[i] > 0),
    deviation,
  };
}

/** Shades the areas of touching balls. The area of a ball extends halfway to each neighbor. */
function shades(balls, { turns, touches }, x, [, top, , bottom]) {
  return turns.map((turn, i) => {
    if (!touches[i]) return null;
    const [start, end] = [i - 1, i + 1].map((n) =>
      balls.circuit[n] === balls.circuit[i] ? x((turn + turns[n]) / 2) : x(turn),
    );
    return svg("rect", {
      class: "touch",
      x: start,
      y: top,
      width: end - start,
      height: bottom - top,
      style: "fill:var(--c5)",
      opacity: 0.25,
    });
  });
}

/** Draws the common speed of the touching balls of each circuit. */
function trainSpeeds(balls, answer, { turns, touches, deviation }, x, y) {
  return (answer.circuits ?? []).map(({ circuit, train_rate: rate }) => {
    const isHere = (_, i) => balls.circuit[i] === circuit;
    if (!touches.filter(isHere).some(Boolean)) return null;
    const ends = span(turns.filter(isHere));
    return svg("path", {
      class: "train",
      fill: "none",
      d: path(ends.map((turn) => [x(turn), y(deviation(rate))])),
      stroke: "var(--c2)",
      "stroke-width": 1.6,
    });
  });
}

function pushForces(front, turns, x, y) {
  return turns.map((turn, i) => {
    if (!(front[i] > 0)) return null;
    const words = `ball ${i + 1} is pushed back with ${number(front[i])} ${shownUnit("N")}`;
    const line = `M${x(turn)} ${y(0)}V${y(front[i])}`;
    const attributes = { class: "push", d: line, stroke: "var(--c2)", "stroke-width": 2.4 };
    return svg("path", attributes, svg("title", {}, words));
  });
}

/** Draws a dot with a description, or nothing if the value is missing. */
function dot(x, y, attributes, words) {
  return Number.isFinite(y)
    ? svg("circle", { cx: x, cy: y, r: 2.6, ...attributes }, svg("title", {}, words))
    : null;
}

function speedDots({ turns, free, moving, touches }, x, y) {
  return turns.flatMap((turn, i) => {
    const place = x(turn);
    const ball = `ball ${i + 1}: `;
    const withoutPushes = `${ball}${number(free[i])} % without push forces`;
    return [
      dot(place, y(free[i]), { class: "free", fill: "none", stroke: "var(--c1)" }, withoutPushes),
      touches[i]
        ? dot(place, y(moving[i]), { class: "moving", fill: "var(--c2)" }, `${ball}${number(moving[i])} %`)
        : null,
    ];
  });
}

function advanceDots(balls, turns, x, y) {
  return turns.map((turn, i) => {
    const advance = balls.advance_mm[i];
    const words = `ball ${i + 1}: ${number(advance)} ${shownUnit("mm")}`;
    return dot(x(turn), y(advance ?? NaN), { class: "advance", fill: "var(--c1)" }, words);
  });
}

/** Draws the displacement, the stiffness and the remaining preload as functions of the load. */
function deflection(curve, answer) {
  const [width, height, [left, top, outer, bottom]] = sizes();
  // The right scale needs some room.
  const right = outer - 52;
  const loads = curve.axial_load_N;
  const shift = curve.nut_displacement_um;
  const [low, high] = span(shift.map((v) => v ?? NaN));
  const [, stiffest] = span(curve.nut_stiffness_N_um.map((v) => v ?? NaN));
  const most = Math.max(...curve.preload_left_N.map((v) => v ?? 0));
  const up = [bottom, top];
  const x = scale([Math.min(0, ...loads), Math.max(0, ...loads)], [left, right]);
  const y = scale([Math.min(0, low), high > low ? high : low + 1], up);
  const stiffness = scale([0, stiffest * 1.05], up);
  const preload = most > 0 ? scale([0, most * 1.05], up) : null;
  const line = (values, to, paint, dash) =>
    svg("path", {
      d: path(loads.map((v, i) => [x(v), values[i] == null ? NaN : to(values[i])])),
      fill: "none",
      stroke: `var(${paint})`,
      "stroke-width": 2.2,
      "stroke-dasharray": dash,
    });
  const stiffnessUnit = shownUnit("N/um");
  const displacementWords = `Displacement up to ${number(high)} ${shownUnit("um")}`;
  const stiffnessWords = `tangent stiffness up to ${number(stiffest)} ${stiffnessUnit}`;
  const preloadWords = `remaining preload, up to ${number(most)} ${shownUnit("N")}`;
  const box = [left, top, right, bottom];
  return figure(
    "Displacement and stiffness as functions of the load",
    picture(
      width,
      height,
      `${displacementWords} and ${stiffnessWords} as functions of the axial load`,
      axes(x, y, box, labeled("axial load", "N"), labeled("displacement", "um"), ROOM),
      line(shift, y, "--c1"),
      line(curve.nut_stiffness_N_um, stiffness, "--c3", "7 4"),
      preload ? line(curve.preload_left_N, preload, "--c2", "2 3") : null,
      operatingPoint(answer, x, y),
      ...rightScale(stiffness, right),
      limitLoad(answer, x, top, bottom),
    ),
    legend([
      ["displacement, left scale", "var(--c1)", "solid"],
      [`tangent stiffness, ${stiffnessUnit}, right scale`, "var(--c3)", "dash"],
      ...(preload ? [[preloadWords, "var(--c2)", "dots"]] : []),
    ]),
    html("p", { class: "small" }, aboutStiffness(answer)),
  );
}

/** Writes the numbers of the right scale of a chart, without zeros at the end of their decimal places. */
function rightScale(y, right) {
  const [, top] = y.domain;
  return [0, 0.5 * top, top].map((value) => {
    const words = number(value).replace(/\.0+$|(\.\d*[1-9])0+$/, "$1");
    return text(right + 6, y(value) + 4, words, { class: "small", style: "fill:var(--c3)" });
  });
}

/** Marks the load of the case, if it is in the chart. */
function operatingPoint(answer, x, y) {
  const load = shown(answer.reaction_SI?.[0], "N");
  const isInside = Number.isFinite(load) && load >= x.domain[0] && load <= x.domain[1];
  if (!isInside || answer.nut_displacement_um == null) return null;
  const center = { cx: x(load), cy: y(shown(answer.nut_displacement_um, "um")) };
  return svg("circle", { ...center, ...RING }, svg("title", {}, "this load"));
}

/** Marks the load above which no preload remains, if it is in the chart. */
function limitLoad(answer, x, top, bottom) {
  const limit = shown(answer.limit_load_N, "N");
  if (!limit || limit > x.domain[1]) return null;
  const words = { "text-anchor": "end", class: "small faint" };
  return svg("g", {}, dashedLine(x(limit), top, bottom), text(x(limit) - 4, top + 12, "limit load", words));
}

/** Draws a vertical line across a chart. */
const dashedLine = (x, top, bottom) =>
  svg("path", { d: `M${x} ${top}V${bottom}`, stroke: "var(--faint)", "stroke-dasharray": "3 3" });

/** States the stiffness at the load of the case, the preload and the load up to which preload remains. */
function aboutStiffness(answer) {
  const of = (name) => measuredOf(answer, name, "N");
  const sentences = [`The stiffness at this load is ${measuredOf(answer, "nut_stiffness_N_um", "N/um")}.`];
  if (answer.preload_left_N != null) {
    const [cold, warm] = [of("cold_preload_N"), of("warm_preload_N")];
    const preload = cold === warm ? cold : `${cold} cold and ${warm} warm`;
    sentences.push(`The preload is ${preload}; ${of("preload_left_N")} of the preload remain.`);
  }
  if (answer.limit_load_N != null) sentences.push(`Above ${of("limit_load_N")}, no preload remains.`);
  return sentences.join(" ");
}

/**
 * Draws the preload of the warm steady states as a function of the speed. The curve is solid up to the fold
 * and dashed beyond the fold.
 */
export function showWarm(host, branch, answer) {
  const place = host.querySelector(".warm");
  if (!place || !answer?.warm) return;
  if (branch instanceof Error) place.replaceChildren(none(branch.message));
  else if (branch) place.replaceChildren(warm(branch, answer));
}

function warm(branch, answer) {
  const [width, height, box] = sizes();
  const { screw_speed_rpm: speed, stable, asked_rpm: asked } = branch;
  const preload = shownAll(branch.warm_preload_N, "N");
  const x = scale([0, Math.max(...speed, asked) * 1.05], [box[0], box[2]]);
  const y = scale([0, Math.max(...preload, 1) * 1.06], [box[3], box[1]]);
  const line = (part, dash) =>
    svg("path", {
      d: path(part.map((i) => [x(speed[i]), y(preload[i])])),
      fill: "none",
      stroke: "var(--c1)",
      "stroke-width": 2.2,
      "stroke-dasharray": dash,
    });
  // The fold is the last stable state of a branch that turns back.
  const all = speed.map((_, i) => i);
  const turn = stable.indexOf(false);
  const hasFold = turn >= 0;
  const solid = hasFold ? all.slice(0, turn) : all;
  const fold = solid.at(-1);
  const foldSpeed = `${number(speed[fold])} rpm`;
  const foldWords = hasFold ? `, with a fold at ${foldSpeed}` : ", without a fold";
  const meaning = hasFold
    ? `Above ${foldSpeed} (circle), no steady state exists and the preload runs away. ` +
      "The dashed states are unstable."
    : "No fold in this range.";
  const ends = answer.groove_estimate?.intervals ?? {};
  const [nut, screw, balls] = ["nut", "screw", "balls"]
    .map((part) => `${part}_temperature_C`)
    .map((name) => measured(answer.warm[name], "C", ends[name]));
  return figure(
    "Warm preload against speed",
    picture(
      width,
      height,
      `Warm preload as a function of the screw speed${foldWords}`,
      axes(x, y, box, "screw speed, rpm", labeled("warm preload", "N"), ROOM),
      line(solid),
      hasFold ? line(all.slice(turn - 1), "7 4") : null,
      hasFold
        ? svg(
            "circle",
            { cx: x(speed[fold]), cy: y(preload[fold]), ...RING },
            svg("title", {}, "fold: no steady state above this speed"),
          )
        : null,
      dashedLine(x(asked), box[1], box[3]),
    ),
    html(
      "p",
      { class: "small" },
      `Nut ${nut}, screw ${screw}, balls ${balls} at ${number(asked)} rpm. ${meaning} `,
      "The curve uses raceway control with friction per contact.",
    ),
  );
}
