// The two contact ellipses: pressure, slip and friction, with the spin poles and the lines of pure rolling.

import {
  html,
  number,
  shown,
  measured,
  labeled,
  ramp,
  rampBar,
  sharp,
  color,
  none,
  legend,
  table,
} from "bsm/draw";

/** Color of lines and arrows on the field, and of their outlines. */
const LINE = "#111";
const OUTLINE = "#fff";
const TURN = 2 * Math.PI;

/** Fields that can be shown, each with its label, its unit and its value at a grid point of a contact. */
const FIELDS = {
  pressure: ["pressure", "MPa", (c, i) => c.pressure_MPa[i]],
  slip: [
    "slip speed",
    "m/s",
    (c, i) => (c.slip_along_m_s[i] === null ? null : Math.hypot(c.slip_along_m_s[i], c.slip_across_m_s[i])),
  ],
  friction: [
    "ratio of friction to pressure",
    "",
    (c, i) => (c.friction_along[i] === null ? null : Math.hypot(c.friction_along[i], c.friction_across[i])),
  ],
};

/** Returns the slip speeds at all grid points. Outside the ellipse, the speed is 0. */
const speeds = (c) => c.slip_along_m_s.map((_, i) => FIELDS.slip[2](c, i) ?? 0);

/**
 * Returns the fields as columns of a table. The columns `across` and `along` contain the position relative to
 * the semi-axes.
 */
function columns({ places, pressure_MPa, slip_across_m_s, slip_along_m_s, friction_across, friction_along }) {
  const inside = pressure_MPa.flatMap((p, k) => (p === null ? [] : [k]));
  const n = places.length;
  const of = (list) => inside.map((k) => list[k]);
  return {
    across: inside.map((k) => places[k % n]),
    along: inside.map((k) => places[Math.floor(k / n)]),
    pressure_MPa: of(pressure_MPa),
    slip_across_m_s: of(slip_across_m_s),
    slip_along_m_s: of(slip_along_m_s),
    friction_across: of(friction_across),
    friction_along: of(friction_along),
  };
}

export class Ellipses {
  constructor(host) {
    this.field = "pressure";
    this.on = { arrows: true, lines: true };
    const pick = html(
      "select",
      {
        "aria-label": "Field shown on the ellipses",
        onchange: () => {
          this.field = pick.value;
          this.draw();
        },
      },
      Object.entries(FIELDS).map(([name, [words]]) => html("option", { value: name }, words)),
    );
    const toggle = (name, words) =>
      html(
        "label",
        {},
        html("input", {
          type: "checkbox",
          checked: true,
          onchange: (event) => {
            this.on[name] = event.target.checked;
            this.draw();
          },
        }),
        words,
      );
    this.stage = html("div");
    host.columns = () =>
      Object.fromEntries((this.answer?.contacts ?? []).map((contact) => [contact.contact, columns(contact)]));
    host.append(
      html(
        "div",
        { class: "bar" },
        html("label", {}, "Color ", pick),
        toggle("arrows", "slip of the ball"),
        toggle("lines", "pure rolling and poles"),
      ),
      this.stage,
    );
  }

  show(answer) {
    this.answer = answer;
    this.draw();
  }

  draw() {
    const { answer } = this;
    if (!answer) return;
    if (answer.error) {
      this.stage.replaceChildren(none(answer.error));
      return;
    }
    const { contacts, model } = answer;
    if (!contacts.length) {
      const words =
        `Model ${model} treats the contacts as points. ` +
        "To see ellipses, give the conformities and select an elastic model.";
      this.stage.replaceChildren(none(words));
      return;
    }
    const [words, unit, read] = FIELDS[this.field];
    const all = contacts.map((contact) => contact.pressure_MPa.map((_, i) => read(contact, i)));
    const values = all.flat().filter((v) => v !== null);
    const high = Math.max(...values);
    const low = this.field === "pressure" ? 0 : Math.min(...values);
    const fastest = Math.max(...contacts.flatMap(speeds));
    const widest = Math.max(...contacts.map((c) => c.semi_axes_mm[0]));
    const canvases = contacts.map((contact) =>
      html("canvas", { role: "img", "aria-label": alternative(contact) }),
    );
    const figures = contacts.map((contact, i) => html("figure", {}, caption(contact), canvases[i]));
    const sticks = contacts.some((c) => c.sticking_share > 0);
    this.stage.replaceChildren(
      html("div", { class: "pair" }, figures),
      rampBar(shown(low, unit), shown(high, unit), labeled(words, unit)),
      legend([
        ["slip of the ball against the groove", "var(--ink)", "solid"],
        ["pure rolling (no slip along the groove)", "var(--ink)", "dash"],
        ["spin pole (no slip)", "var(--hot)"],
        ...(sticks ? [["sticking (slower than the creep speed)", "#ffffff"]] : []),
      ]),
      frictionTable(contacts),
      html(
        "p",
        { class: "small faint" },
        `Model ${model}. `,
        contacts[0].saturated
          ? "This model saturates the friction in one direction; " +
              "the picture shows the slip over the ellipse. "
          : "",
        "The long axis of each ellipse lies across the groove. The ball rolls along the groove, ",
        "which points upward here and is drawn to a larger scale. The longest arrow corresponds to ",
        `${measured(fastest, "m/s")}. The thick arrow is the friction force on the ball.`,
      ),
    );
    // A canvas gets its size when it is part of the page.
    contacts.forEach((contact, i) => this.paint(canvases[i], contact, all[i], [low, high], fastest, widest));
  }

  /** Paints a contact ellipse. `values` is the field at the grid points; `[low, high]` is its color scale. */
  paint(canvas, contact, values, [low, high], fastest, widest) {
    const width = canvas.parentElement.clientWidth;
    const height = Math.min(210, 0.52 * width);
    if (width < 40) return;
    const g = sharp(canvas, width, height);
    const center = [width / 2, height / 2];
    const radii = [(width / 2 - 8) * (contact.semi_axes_mm[0] / widest), height / 2 - 8];
    const at = (x, y) => [center[0] + radii[0] * x, center[1] - radii[1] * y];
    paintField(g, contact, values, [low, high], center, radii);
    if (this.on.lines) paintRollingLines(g, contact, at);
    if (this.on.arrows) {
      paintSlip(g, contact, fastest, at);
      paintFriction(g, contact, center, height);
    }
    if (this.on.lines) paintSpinPoles(g, contact, at);
    g.beginPath();
    g.strokeStyle = color("ink");
    g.lineWidth = 1.2;
    g.ellipse(...center, ...radii, 0, 0, TURN);
    g.stroke();
  }
}

/** Creates the caption of an ellipse: its size, its largest pressure and its load. */
function caption(contact) {
  const [across, along] = contact.semi_axes_mm;
  const size = `${number(shown(2 * across, "mm"))} × ${measured(2 * along, "mm")}`;
  const rest = `${measured(contact.max_pressure_MPa, "MPa")}, ${measured(contact.normal_load_N, "N")}`;
  return html(
    "figcaption",
    {},
    html("strong", {}, contact.contact),
    html("span", { class: "faint" }, `  ${size}, ${rest}`),
  );
}

/** Describes an ellipse for readers who cannot see the picture. */
function alternative(c) {
  return [
    `Contact ellipse at the ${c.contact}: largest pressure ${measured(c.max_pressure_MPa, "MPa")}`,
    `${c.spin_poles.length} spin poles`,
    `${c.rolling_lines.length} lines of pure rolling`,
    `ratio of friction to load ${number(c.friction_over_load)}`,
    `${number(100 * c.sticking_share)} percent of the area sticks`,
  ].join(", ");
}

function frictionTable(contacts) {
  const line = (label, value) => [label, ...contacts.map(value)];
  return table(
    "Friction of the two contacts",
    ["", ...contacts.map((c) => c.contact)],
    [
      line(labeled("friction force", "N"), (c) => number(shown(Math.hypot(...c.friction_force_N), "N"))),
      line("ratio of friction to load", (c) => number(c.friction_over_load)),
      line("spin, rad/s", (c) => number(c.spin_rad_s)),
      line(labeled("largest slip", "m/s"), (c) => number(shown(Math.max(...speeds(c)), "m/s"))),
      line("sticking fraction of the area", (c) => `${number(100 * c.sticking_share)} %`),
    ],
  );
}

/** Paints the field of a contact inside its ellipse, with one pixel per grid point and smoothing. */
function paintField(g, { places }, values, [low, high], [cx, cy], [rx, ry]) {
  const n = places.length;
  // The field is extended beyond the edge of the ellipse, so that smoothing does not darken the edge.
  const near = (i, j) => {
    const value = values[j * n + i];
    if (value !== null) return value;
    const size = Math.hypot(places[i], places[j]) * 1.001 + 1.2 / n;
    const place = (v) => Math.round(((v / size + 1) / 2) * (n - 1));
    return values[place(places[j]) * n + place(places[i])] ?? low;
  };
  const image = new ImageData(n, n);
  for (let j = 0; j < n; j += 1) {
    for (let i = 0; i < n; i += 1) {
      const [red, green, blue] = ramp((near(i, j) - low) / (high - low || 1));
      image.data.set([red, green, blue, 255], 4 * ((n - 1 - j) * n + i));
    }
  }
  const small = new OffscreenCanvas(n, n);
  small.getContext("2d").putImageData(image, 0, 0);
  g.save();
  g.beginPath();
  g.ellipse(cx, cy, rx, ry, 0, 0, TURN);
  g.clip();
  g.imageSmoothingQuality = "high";
  // The outer pixels are centered on the edge of the ellipse.
  const [right, up] = [rx, ry].map((radius) => radius * (1 + 1 / (n - 1)));
  g.drawImage(small, cx - right, cy - up, 2 * right, 2 * up);
  g.restore();
}

/** Draws lines with a light outline, which keeps them visible on dark colors. */
function stroke(g, draw, paint, width, dash = []) {
  const outline = ["rgb(255 255 255 / .75)", width + 2.4];
  for (const [style, wide] of [outline, [paint, width]]) {
    g.beginPath();
    g.setLineDash(dash);
    g.lineWidth = wide;
    g.strokeStyle = style;
    draw();
    g.stroke();
  }
  g.setLineDash([]);
}

/** Adds an arrow to the path of a canvas. `head` is the length of its head [px]. */
function arrow(g, [x, y], [dx, dy], head) {
  const direction = Math.atan2(dy, dx);
  const [endX, endY] = [x + dx, y + dy];
  g.moveTo(x, y);
  g.lineTo(endX, endY);
  for (const turn of [2.6, -2.6]) {
    g.moveTo(endX, endY);
    g.lineTo(endX + head * Math.cos(direction + turn), endY + head * Math.sin(direction + turn));
  }
}

/** Draws a filled circle with an outline. */
function dot(g, [x, y], radius, fill, outline, width) {
  g.beginPath();
  g.fillStyle = fill;
  g.strokeStyle = outline;
  g.lineWidth = width;
  g.arc(x, y, radius, 0, TURN);
  g.fill();
  g.stroke();
}

function paintRollingLines(g, contact, at) {
  for (const xi of contact.rolling_lines) {
    const y = Math.sqrt(1 - xi * xi);
    const line = () => {
      g.moveTo(...at(xi, -y));
      g.lineTo(...at(xi, y));
    };
    stroke(g, line, LINE, 1.6, [5, 4]);
  }
}

/** Draws the slip at some of the grid points: an arrow, or a dot where the ball sticks. */
function paintSlip(g, contact, fastest, at) {
  const n = contact.places.length;
  const skip = Math.max(1, Math.round(n / 13));
  for (let j = skip >> 1; j < n; j += skip) {
    for (let i = skip >> 1; i < n; i += skip) {
      const along = contact.slip_along_m_s[j * n + i];
      const across = contact.slip_across_m_s[j * n + i];
      if (along === null) continue;
      const speed = Math.hypot(along, across);
      const [x, y] = at(contact.places[i], contact.places[j]);
      if (speed < contact.creep_speed_m_s) {
        dot(g, [x, y], 2.6, OUTLINE, LINE, 1);
        continue;
      }
      const length = 4 + 17 * Math.sqrt(speed / fastest);
      const [dx, dy] = [(across / speed) * length, (-along / speed) * length];
      stroke(g, () => arrow(g, [x - dx / 2, y - dy / 2], [dx, dy], 4), LINE, 1.2);
    }
  }
}

/** Draws the direction of the friction force at the center. */
function paintFriction(g, contact, center, height) {
  const [across, along] = contact.friction_force_N;
  const size = Math.hypot(across, along);
  if (!(size > 0)) return;
  const length = 0.3 * height;
  stroke(g, () => arrow(g, center, [(across / size) * length, (-along / size) * length], 9), LINE, 3.2);
}

function paintSpinPoles(g, contact, at) {
  for (const [xi, upsilon] of contact.spin_poles) dot(g, at(xi, upsilon), 5.5, color("hot"), OUTLINE, 1.8);
}
