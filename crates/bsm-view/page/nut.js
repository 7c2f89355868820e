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
/** Returns the width and height of a chart, and the rectangle for its curves. */
const sizes = () => {
  const width = narrow() ? 340 : 460;
  const height = 270;
  return [width, height, [64, 12, width - 12, height - 42]];
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

function sharing(balls, answer) {
  const [width, height, box] = sizes();
  const sides = SIDES.filter(([name]) => balls[name].some((v) => v > 0));
  const high = Math.max(...sides.flatMap(([name]) => balls[name]), 1e-9);
  const [first, last] = span(balls.z_mm);
  const x = scale(first === last ? [first - 1, last + 1] : [first, last], [box[0], box[2]]);
  const y = scale([0, high * 1.06], [box[3], box[1]]);
  const dots = sides.flatMap(([name, , paint, kind]) =>
    balls[name].map((v, i) =>
      v > 0
        ? svg(
            "g",
            {},
            svg(
              "title",
              {},
              `ball ${i + 1}: ${number(v)} ${shownUnit("N")} at ${number(balls.z_mm[i])} ${shownUnit("mm")}`,
            ),
            mark(kind, x(balls.z_mm[i]), y(v), `var(${paint})`),
          )
        : null,
    ),
  );
  const words = `Load of each ball along the axis: largest ${measured(answer.max_contact_load_N, "N")}, ${number(answer.max_over_mean)} times the mean, ${answer.unloaded_balls} balls unloaded`;
  return figure(
    "Load of each ball along the axis",
    picture(
      width,
      height,
      words,
      axes(x, y, box, labeled("position along the axis", "mm"), labeled("load", "N"), 64),
      ...dots.filter(Boolean),
    ),
    legend(
      sides.map(([, words, paint, kind]) => [words, `var(${paint})`, kind === "circle" ? kind : undefined]),
    ),
    html(
      "p",
      { class: "small" },
      `The largest load is ${measuredOf(answer, "max_contact_load_N", "N")}, ${numberOf(answer, "max_over_mean")} times the mean. ${answer.unloaded_balls} of ${balls.z_mm.length} balls are unloaded.`,
    ),
  );
}

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
  const dots = turn.map((v, i) =>
    svg(
      "circle",
      {
        cx: x(v),
        cy: y(balls.z_mm[i]),
        r: 5,
        fill: paint(load[i]),
        stroke: "var(--ink)",
        "stroke-width": 0.8,
      },
      svg("title", {}, `ball ${i + 1}: ${number(load[i])} ${shownUnit("N")}`),
    ),
  );
  return figure(
    "Developed view of the balls and their loads",
    picture(
      width,
      height,
      `Developed view of the nut with balls colored by load from ${number(low)} to ${number(high)} ${shownUnit("N")}`,
      axes(x, y, box, "angle around the axis, °", labeled("position along the axis", "mm"), 64),
      ...dots,
    ),
    rampBar(low, high, labeled("load", "N")),
  );
}

/** Draws the speeds and the advance of the balls along the helix and, if the gap is given, touching balls and their forces. */
function train(balls, answer) {
  // If all balls move identically, the calculated advance is only a rounding error, far below a nanometer.
  if (!(answer.needed_gap_mm > 1e-6)) return null;
  const [width, , [left, top, right]] = sizes();
  const trains = answer.circuits ?? [];
  const rates = balls.free_rate.filter((rate) => rate != null);
  const mean = rates.reduce((sum, rate) => sum + rate, 0) / rates.length;
  const percent = (rate) => (rate == null ? NaN : 100 * (rate / mean - 1));
  const turns = balls.theta_deg.map((v) => v / 360);
  const x = scale(span(turns), [left, right]);
  const free = balls.free_rate.map(percent);
  const moving = balls.rate.map(percent);
  const front = balls.front_push_N.map((v) => v ?? 0);
  const most = Math.max(...front, 0);
  const pushed = turns.map((_, i) => front[i] > 0 || balls.back_push_N[i] > 0);
  // The diagrams are stacked, each with its own frame and with room for tick labels below.
  let from = top;
  const strip = (values, words, height, axis = "") => {
    const [low, high] = span(values);
    const room = 0.05 * (high - low);
    const box = [left, from, right, from + height];
    const y = scale(high > low ? [low - room, high + room] : [low - 1, low + 1], [box[3], box[1]]);
    from += height + 26;
    return { box, y, frame: axes(x, y, box, axis, words, 64) };
  };
  const dot = (v, i, y, attributes, words) =>
    Number.isFinite(v)
      ? svg(
          "circle",
          { cx: x(turns[i]), cy: y(v), r: 2.6, ...attributes },
          svg("title", {}, `ball ${i + 1}: ${words}`),
        )
      : null;
  const speeds = strip([...free, ...moving], "speed deviation, %", 130);
  const pushes = most > 0 ? strip([0, most], labeled("force", "N"), 60) : null;
  const advances = strip(
    [0, ...balls.advance_mm.map((v) => v ?? NaN)],
    labeled("advance", "mm"),
    90,
    "position along the helix, turns",
  );
  const lines = trains.map(({ circuit, train_rate: rate }) => {
    const places = turns.filter((_, i) => balls.circuit[i] === circuit);
    return pushed.some((is, i) => is && balls.circuit[i] === circuit)
      ? svg("path", {
          class: "train",
          fill: "none",
          d: path(span(places).map((v) => [x(v), speeds.y(percent(rate))])),
          stroke: "var(--c2)",
          "stroke-width": 1.6,
        })
      : null;
  });
  // The shaded area of a ball extends halfway to each neighbor.
  const shade = turns.map((v, i) => {
    if (!pushed[i]) return null;
    const ends = [i - 1, i + 1].map((n) =>
      balls.circuit[n] === balls.circuit[i] ? x((v + turns[n]) / 2) : x(v),
    );
    return [speeds, pushes, advances].map(
      (strip) =>
        strip &&
        svg("rect", {
          class: "touch",
          x: ends[0],
          y: strip.box[1],
          width: ends[1] - ends[0],
          height: strip.box[3] - strip.box[1],
          style: "fill:var(--c5)",
          opacity: 0.25,
        }),
    );
  });
  const forces =
    pushes &&
    turns.map((v, i) =>
      front[i] > 0
        ? svg(
            "path",
            {
              class: "push",
              d: `M${x(v)} ${pushes.y(0)}V${pushes.y(front[i])}`,
              stroke: "var(--c2)",
              "stroke-width": 2.4,
            },
            svg("title", {}, `ball ${i + 1} is pushed back with ${number(front[i])} ${shownUnit("N")}`),
          )
        : null,
    );
  const dots = turns.map((_, i) => [
    dot(
      free[i],
      i,
      speeds.y,
      { class: "free", fill: "none", stroke: "var(--c1)" },
      `${number(free[i])} % without push forces`,
    ),
    pushed[i]
      ? dot(moving[i], i, speeds.y, { class: "moving", fill: "var(--c2)" }, `${number(moving[i])} %`)
      : null,
    dot(
      balls.advance_mm[i] ?? NaN,
      i,
      advances.y,
      { class: "advance", fill: "var(--c1)" },
      `${number(balls.advance_mm[i])} ${shownUnit("mm")}`,
    ),
  ]);
  const [slow, fast] = span(free);
  const touching = pushed.filter(Boolean).length;
  const words = `Speeds of the balls without push forces, from ${number(slow)} to ${number(fast)} percent relative to their mean${
    most > 0
      ? `, ${touching} touching balls with forces of up to ${number(most)} ${shownUnit("N")} between them`
      : ""
  }`;
  return figure(
    "Speeds and advance of the balls along the helix",
    picture(
      width,
      from + 12,
      words,
      ...[speeds, pushes, advances].flatMap((strip) => strip?.frame ?? []),
      ...[shade.flat(), lines, forces, dots].flat(2).filter(Boolean),
    ),
    legend([
      ["speed without push forces, relative to the mean", "var(--c1)", "circle"],
      ...(most > 0
        ? [
            ["with push forces", "var(--c2)", "circle"],
            ["speed of touching balls", "var(--c2)", "solid"],
            ["touching balls", "color-mix(in srgb, var(--c5) 30%, transparent)"],
            [`force of the ball in front, up to ${number(most)} ${shownUnit("N")}`, "var(--c2)"],
          ]
        : []),
    ]),
    html(
      "p",
      { class: "small" },
      `No balls touch if the gaps of a circuit total at least ${measuredOf(answer, "needed_gap_mm", "mm")}.`,
    ),
  );
}

function deflection(curve, answer) {
  const [cold, warm] = [measuredOf(answer, "cold_preload_N", "N"), measuredOf(answer, "warm_preload_N", "N")];
  const [width, height, box] = sizes();
  const loads = curve.axial_load_N;
  const shift = curve.nut_displacement_um;
  const x = scale([Math.min(0, ...loads), Math.max(0, ...loads)], [box[0], box[2] - 52]);
  const [low, high] = span(shift.map((v) => v ?? NaN));
  const y = scale([Math.min(0, low), high > low ? high : low + 1], [box[3], box[1]]);
  const line = (values, to, paint, dash) =>
    svg("path", {
      d: path(loads.map((v, i) => [x(v), values[i] == null ? NaN : to(values[i])])),
      fill: "none",
      stroke: `var(${paint})`,
      "stroke-width": 2.2,
      "stroke-dasharray": dash,
    });
  const k = span(curve.nut_stiffness_N_um.map((v) => v ?? NaN));
  const y2 = scale([0, k[1] * 1.05], [box[3], box[1]]);
  const right = box[2] - 52;
  const preload = curve.preload_left_N.some((v) => v > 0)
    ? scale([0, Math.max(...curve.preload_left_N.map((v) => v ?? 0)) * 1.05], [box[3], box[1]])
    : null;
  const here = shown(answer.reaction_SI?.[0], "N");
  const mark =
    Number.isFinite(here) && here >= x.domain[0] && here <= x.domain[1] && answer.nut_displacement_um != null
      ? svg(
          "circle",
          {
            cx: x(here),
            cy: y(shown(answer.nut_displacement_um, "um")),
            r: 5,
            fill: "none",
            stroke: "var(--ink)",
            "stroke-width": 2,
          },
          svg("title", {}, "this load"),
        )
      : null;
  const limit = shown(answer.limit_load_N, "N");
  const ends = [0, 0.5, 1].map((part) =>
    text(right + 6, y2(part * y2.domain[1]) + 4, number(part * y2.domain[1]).replace(/\.?0+$/, "") || "0", {
      class: "small",
      style: "fill:var(--c3)",
    }),
  );
  return figure(
    "Displacement and stiffness as functions of the load",
    picture(
      width,
      height,
      `Displacement up to ${number(high)} ${shownUnit("um")} and tangent stiffness up to ${number(k[1])} ${shownUnit("N/um")} as functions of the axial load`,
      axes(
        x,
        y,
        [box[0], box[1], right, box[3]],
        labeled("axial load", "N"),
        labeled("displacement", "um"),
        64,
      ),
      line(shift, y, "--c1"),
      line(curve.nut_stiffness_N_um, y2, "--c3", "7 4"),
      preload ? line(curve.preload_left_N, preload, "--c2", "2 3") : null,
      mark,
      ...ends,
      limit && limit <= x.domain[1]
        ? svg(
            "g",
            {},
            svg("path", {
              d: `M${x(limit)} ${box[1]}V${box[3]}`,
              stroke: "var(--faint)",
              "stroke-dasharray": "3 3",
            }),
            text(x(limit) - 4, box[1] + 12, "limit load", { "text-anchor": "end", class: "small faint" }),
          )
        : null,
    ),
    legend([
      ["displacement, left scale", "var(--c1)", "solid"],
      [`tangent stiffness, ${shownUnit("N/um")}, right scale`, "var(--c3)", "dash"],
      ...(preload
        ? [
            [
              `remaining preload, up to ${number(preload.domain[1] / 1.05)} ${shownUnit("N")}`,
              "var(--c2)",
              "dots",
            ],
          ]
        : []),
    ]),
    html(
      "p",
      { class: "small" },
      `The stiffness at this load is ${measuredOf(answer, "nut_stiffness_N_um", "N/um")}.${answer.preload_left_N == null ? "" : ` The preload is ${cold === warm ? cold : `${cold} cold and ${warm} warm`}; ${measuredOf(answer, "preload_left_N", "N")} of the preload remain.`}${limit == null ? "" : ` Above ${measuredOf(answer, "limit_load_N", "N")}, no preload remains.`}`,
    ),
  );
}

/** Draws the preload of the warm steady states as a function of the speed. The curve is solid up to the fold and dashed beyond the fold. */
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
  const turn = stable.indexOf(false);
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
  const all = speed.map((_, i) => i);
  const until = turn < 0 ? all : all.slice(0, turn);
  const fold = until.at(-1);
  const ends = answer.groove_estimate?.intervals ?? {};
  const [nut, screw, balls] = ["nut", "screw", "balls"]
    .map((part) => `${part}_temperature_C`)
    .map((name) => measured(answer.warm[name], "C", ends[name]));
  return figure(
    "Warm preload against speed",
    picture(
      width,
      height,
      `Warm preload as a function of the screw speed${turn < 0 ? ", without a fold" : `, with a fold at ${number(speed[fold])} rpm`}`,
      axes(x, y, box, "screw speed, rpm", labeled("warm preload", "N"), 64),
      line(until),
      turn < 0 ? null : line(all.slice(turn - 1), "7 4"),
      turn < 0
        ? null
        : svg(
            "circle",
            {
              cx: x(speed[fold]),
              cy: y(preload[fold]),
              r: 5,
              fill: "none",
              stroke: "var(--ink)",
              "stroke-width": 2,
            },
            svg("title", {}, "fold: no steady state above this speed"),
          ),
      svg("path", {
        d: `M${x(asked)} ${box[1]}V${box[3]}`,
        stroke: "var(--faint)",
        "stroke-dasharray": "3 3",
      }),
    ),
    html(
      "p",
      { class: "small" },
      `Nut ${nut}, screw ${screw}, balls ${balls} at ${number(asked)} rpm. ${turn < 0 ? "No fold in this range." : `Above ${number(speed[fold])} rpm (circle), no steady state exists and the preload runs away. The dashed states are unstable.`} The curve uses raceway control with friction per contact.`,
    ),
  );
}
