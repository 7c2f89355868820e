// Functions that all pictures use: numbers formatted as on the command line, elements, axes and colors.

/** Rounds a value to a given number of decimal places, with ties to even, like the program. */
function fixed(value, decimals) {
  const up = value.toFixed(decimals);
  const exact = value.toFixed(Math.min(100, decimals + 45)).split(".")[1] ?? "";
  if (!/^50*$/.test(exact.slice(decimals)) || !/[13579]$/.test(up)) return up;
  return (Number(up) - Math.sign(value) * 10 ** -decimals).toFixed(decimals);
}

/** Formats a number with five significant digits, like `bsm`. */
export function number(value) {
  if (typeof value !== "number" || !Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size < 1e-4 || size >= 1e6) return value.toExponential(4).replace("e+", "e");
  return fixed(value, Math.max(0, 4 - Math.floor(Math.log10(size))));
}

/** Formats the 90 % interval of a number over the possible grooves. Without interval, the text is empty. */
export const interval = (ends) => (ends ? ` (${number(ends[0])} to ${number(ends[1])})` : "");

/** Formats a number of an answer by name, with its 90 % interval over the possible grooves. */
export const numberOf = (answer, name) =>
  `${number(answer[name])}${interval(answer.groove_estimate?.intervals?.[name])}`;

/** Formats a number with few digits, for axes and labels. */
export function brief(value) {
  if (!Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-3 || size >= 1e6))
    return value.toExponential(1).replace("e+", "e").replace(".0e", "e");
  return String(Number(value.toPrecision(4)));
}

/** Formats a fraction as a percentage with two significant digits. */
export const percent = (fraction) => brief(Number((100 * fraction).toPrecision(2)));

/**
 * Parses a number; returns NaN if the text is not a number. A comma is read as a decimal point, unless it
 * could separate thousands. The inputs are text fields, because browsers ignore a comma in a number field:
 * 1,5 becomes 15.
 */
export function parsed(text) {
  const plain = text.trim();
  if (!/^[-+]?(\d+[.,]?\d*|[.,]\d+)(e[-+]?\d+)?$/i.test(plain) || /^[-+]?[1-9]\d{0,2},\d{3}$/.test(plain))
    return NaN;
  return Number(plain.replace(",", "."));
}

/** Creates an HTML element. */
export function html(tag, attributes = {}, ...children) {
  return filled(document.createElement(tag), attributes, children);
}

/** Creates an SVG element. */
export function svg(tag, attributes = {}, ...children) {
  return filled(document.createElementNS("http://www.w3.org/2000/svg", tag), attributes, children);
}

function filled(element, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else if (name.startsWith("aria-")) element.setAttribute(name, value);
    else if (value === true) element.setAttribute(name, "");
    else if (value !== false && value != null) element.setAttribute(name, value);
  }
  element.append(...children.flat().filter((child) => child != null));
  return element;
}

/** Returns true if the page is as narrow as a phone. Pictures are then smaller, with the same font size. */
export const narrow = () => innerWidth < 520;

/** Creates a picture with an alternative text. */
export function picture(width, height, label, ...children) {
  return svg("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": label }, ...children);
}

export function text(x, y, words, attributes = {}) {
  return svg("text", { x, y, ...attributes }, words);
}

/** Returns the current value of a color of the style sheet. */
export function color(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

// The color scale viridis in eleven steps. Its lightness changes evenly, so readers with color blindness can
// read it.
const RAMP = [
  [68, 1, 84],
  [72, 36, 117],
  [65, 68, 135],
  [53, 95, 141],
  [42, 120, 142],
  [33, 145, 140],
  [34, 168, 132],
  [68, 191, 112],
  [122, 209, 81],
  [189, 223, 38],
  [253, 231, 37],
];

/** Returns the red, green and blue components of the color for a fraction from 0 to 1. */
export function ramp(part) {
  const at = Math.min(Math.max(part, 0), 1) * (RAMP.length - 1);
  const low = Math.min(Math.floor(at), RAMP.length - 2);
  return RAMP[low].map((c, i) => Math.round(c + (RAMP[low + 1][i] - c) * (at - low)));
}

export const rampCss = (part) => `rgb(${ramp(part).join(" ")})`;

/** Creates a color bar with the values at its ends. */
export function rampBar(low, high, words) {
  const stops = RAMP.map((_, i) => rampCss(i / (RAMP.length - 1))).join(",");
  return html(
    "div",
    {},
    html("div", {
      class: "ramp",
      style: `background:linear-gradient(90deg,${stops})`,
      role: "img",
      "aria-label": `color scale from ${number(low)} to ${number(high)}, ${words}`,
    }),
    html(
      "div",
      { class: "ends" },
      html("span", {}, number(low)),
      html("span", {}, words),
      html("span", {}, number(high)),
    ),
  );
}

/** Returns round values for the ticks of an axis. */
export function ticks(low, high, log = false, count = 6) {
  if (!(high > low)) return [low];
  if (log) {
    const decades = Math.log10(high / low);
    const parts =
      decades > 4 ? [1] : decades > 1.5 ? [1, 2, 5] : decades > 0.6 ? [1, 1.5, 2, 3, 4, 5, 7] : null;
    if (parts) {
      const list = [];
      for (let e = Math.floor(Math.log10(low)); e <= Math.ceil(Math.log10(high)); e += 1) {
        for (const part of parts) {
          const v = part * 10 ** e;
          if (v >= low * 0.999999 && v <= high * 1.000001) list.push(v);
        }
      }
      return list;
    }
  }
  const rough = (high - low) / count;
  const size = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 2.5, 5, 10].map((k) => k * size).find((k) => k >= rough);
  const list = [];
  for (let v = Math.ceil(low / step - 1e-9) * step; v <= high + step * 1e-9; v += step)
    list.push(Math.abs(v) < step * 1e-9 ? 0 : v);
  return list;
}

/** Creates a function that maps values to positions on the screen. */
export function scale([low, high], [from, to], log = false) {
  const f = log ? Math.log : (v) => v;
  const inverse = log ? Math.exp : (v) => v;
  const place = (v) => from + ((f(v) - f(low)) / (f(high) - f(low) || 1)) * (to - from);
  place.value = (p) => inverse(f(low) + ((p - from) / (to - from)) * (f(high) - f(low)));
  place.domain = [low, high];
  place.log = log;
  return place;
}

/** Draws the frame, the ticks and the labels of a chart. */
export function axes(x, y, [left, top, right, bottom], xWords, yWords, room = 60) {
  const group = svg("g", {});
  const line = (attributes) => svg("line", { stroke: "var(--rule)", ...attributes });
  let last = -Infinity;
  for (const v of ticks(...x.domain, x.log, Math.max(3, Math.floor((right - left) / 80)))) {
    group.append(line({ x1: x(v), x2: x(v), y1: top, y2: bottom }));
    if (x(v) - last > 34) {
      group.append(text(x(v), bottom + 15, brief(v), { "text-anchor": "middle", class: "small" }));
      last = x(v);
    }
  }
  last = Infinity;
  for (const v of ticks(...y.domain, y.log, Math.max(3, Math.floor((bottom - top) / 45)))) {
    group.append(line({ x1: left, x2: right, y1: y(v), y2: y(v) }));
    if (last - y(v) > 13) {
      group.append(text(left - 5, y(v) + 4, brief(v), { "text-anchor": "end", class: "small" }));
      last = y(v);
    }
  }
  group.append(
    svg("path", { d: `M${left} ${top}V${bottom}H${right}`, fill: "none", stroke: "var(--ink)" }),
    text((left + right) / 2, bottom + 32, xWords, { "text-anchor": "middle" }),
    text(0, 0, yWords, {
      "text-anchor": "middle",
      transform: `translate(${left - room + 12} ${(top + bottom) / 2}) rotate(-90)`,
    }),
  );
  return group;
}

/** Returns an SVG path through points. Missing points interrupt the path. */
export function path(points) {
  let d = "";
  let pen = false;
  for (const [x, y] of points) {
    if (Number.isFinite(x) && Number.isFinite(y)) {
      d += `${pen ? "L" : "M"}${x.toFixed(2)} ${y.toFixed(2)}`;
      pen = true;
    } else pen = false;
  }
  return d;
}

/** Creates a table with a caption. */
export function table(caption, head, rows, attributes = {}) {
  const cell = (words, i) =>
    i === 0
      ? html("th", { scope: "row" }, words)
      : html("td", { class: typeof words === "string" && /^[-–\d]/.test(words) ? "number" : null }, words);
  return html(
    "div",
    { class: "scroll", tabindex: "0", role: "region", "aria-label": caption },
    html(
      "table",
      attributes,
      html("caption", {}, caption),
      head
        ? html(
            "thead",
            {},
            html(
              "tr",
              {},
              head.map((words, i) =>
                words ? html("th", { scope: "col", class: i ? "number" : null }, words) : html("td"),
              ),
            ),
          )
        : null,
      html(
        "tbody",
        {},
        rows.map((row) => (row instanceof Node ? row : html("tr", {}, row.map(cell)))),
      ),
    ),
  );
}

/** Formats a unit with its usual symbols. */
export const unitOf = (unit) =>
  unit
    .replace(/\bum\b/, "µm")
    .replace(/\buin\b/, "µin")
    .replace(/\bdegF\b/, "°F")
    .replace(/^C$/, "°C");

/** Display units that differ from the units of the program, each with a text, a factor and a zero point. */
let displayed = {};

/** Sets the display units of all pictures. */
export const display = (units) => {
  displayed = units ?? {};
};

/** Converts a number to its display unit. */
export const shown = (value, unit) => {
  const [, factor, zero] = displayed[unit] ?? [];
  return factor === undefined || typeof value !== "number" ? value : value / factor + zero;
};

/** Converts a number from its display unit to the unit of the program. */
export const own = (value, unit) => {
  const [, factor, zero] = displayed[unit] ?? [];
  return factor === undefined ? value : factor * (value - zero);
};

/** Converts a list of numbers to their display unit. */
export const shownAll = (values, unit) => values.map((value) => shown(value, unit));

/** Returns the text of the display unit. */
export const shownUnit = (unit) => unitOf(displayed[unit]?.[0] ?? unit);

/** Formats a number in its display unit, with its 90 % interval over the possible grooves. */
export const measuredNumber = (value, unit, ends) =>
  `${number(shown(value, unit))}${interval(ends && shownAll(ends, unit))}`;

/** Formats a number together with its display unit and its 90 % interval over the possible grooves. */
export const measured = (value, unit, ends) =>
  `${measuredNumber(value, unit, ends)} ${shownUnit(unit)}`.trim();

/** Formats a quantity of an answer by name, with its unit and its 90 % interval over the possible grooves. */
export const measuredOf = (answer, name, unit) =>
  measured(answer[name], unit, answer.groove_estimate?.intervals?.[name]);

/** Returns the label of an axis with the display unit. */
export const labeled = (words, unit) => (unit ? `${words}, ${shownUnit(unit)}` : words);

/** Creates a table row with a label, a unit and values as text. */
export const row = (label, unit, ...values) =>
  html(
    "tr",
    {},
    html("th", { scope: "row" }, label),
    html("td", { class: "faint" }, unitOf(unit)),
    values.map((value) => html("td", { class: "number" }, value ?? "")),
  );

export function legend(entries) {
  return html(
    "ul",
    { class: "legend" },
    entries.map(([words, paint, kind]) =>
      html(
        "li",
        {},
        html(
          "i",
          kind === "circle"
            ? { class: "circle", style: `background:${paint}` }
            : kind
              ? { class: `line ${kind}`, style: `border-color:${paint}` }
              : { style: `background:${paint}` },
        ),
        words,
      ),
    ),
  );
}

/** Creates a paragraph that explains why a panel is empty. */
export const none = (words) => html("p", { class: "none" }, words);

/** Sets the size of a canvas and adapts its resolution to the screen. */
export function sharp(canvas, width, height) {
  const k = Math.min(globalThis.devicePixelRatio || 1, 2);
  canvas.width = Math.round(width * k);
  canvas.height = Math.round(height * k);
  canvas.style.height = `${height}px`;
  const context = canvas.getContext("2d");
  context.setTransform(k, 0, 0, k, 0, 0);
  return context;
}
