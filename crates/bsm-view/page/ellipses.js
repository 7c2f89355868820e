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

/** Returns the fields as columns of a table. The columns `across` and `along` contain the position relative to the semi-axes. */
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
    if (!answer.contacts.length) {
      this.stage.replaceChildren(
        none(
          `Model ${answer.model} treats the contacts as points. To see ellipses, give the conformities and select an elastic model.`,
        ),
      );
      return;
    }
    const [words, unit, read] = FIELDS[this.field];
    const all = answer.contacts.map((contact) => contact.pressure_MPa.map((_, i) => read(contact, i)));
    const values = all.flat().filter((v) => v !== null);
    const high = Math.max(...values);
    const low = this.field === "pressure" ? 0 : Math.min(...values);
    const fastest = Math.max(...answer.contacts.flatMap(speeds));
    const widest = Math.max(...answer.contacts.map((c) => c.semi_axes_mm[0]));
    const figures = answer.contacts.map((contact, i) => {
      const canvas = html("canvas", { role: "img", "aria-label": this.alternative(contact) });
      const figure = html(
        "figure",
        {},
        html(
          "figcaption",
          {},
          html("strong", {}, contact.contact),
          html(
            "span",
            { class: "faint" },
            `  ${number(shown(2 * contact.semi_axes_mm[0], "mm"))} × ${measured(2 * contact.semi_axes_mm[1], "mm")}, ${measured(contact.max_pressure_MPa, "MPa")}, ${measured(contact.normal_load_N, "N")}`,
          ),
        ),
        canvas,
      );
      return { figure, paint: () => this.paint(canvas, contact, all[i], [low, high], fastest, widest) };
    });
    const sticks = answer.contacts.some((c) => c.sticking_share > 0);
    this.stage.replaceChildren(
      html(
        "div",
        { class: "pair" },
        figures.map(({ figure }) => figure),
      ),
      rampBar(shown(low, unit), shown(high, unit), labeled(words, unit)),
      legend([
        ["slip of the ball against the groove", "var(--ink)", "solid"],
        ["pure rolling (no slip along the groove)", "var(--ink)", "dash"],
        ["spin pole (no slip)", "var(--hot)"],
        ...(sticks ? [["sticking (slower than the creep speed)", "#ffffff"]] : []),
      ]),
      table(
        "Friction of the two contacts",
        ["", ...answer.contacts.map((c) => c.contact)],
        [
          [
            labeled("friction force", "N"),
            ...answer.contacts.map((c) => number(shown(Math.hypot(...c.friction_force_N), "N"))),
          ],
          ["ratio of friction to load", ...answer.contacts.map((c) => number(c.friction_over_load))],
          ["spin, rad/s", ...answer.contacts.map((c) => number(c.spin_rad_s))],
          [
            labeled("largest slip", "m/s"),
            ...answer.contacts.map((c) => number(shown(Math.max(...speeds(c)), "m/s"))),
          ],
          [
            "sticking fraction of the area",
            ...answer.contacts.map((c) => `${number(100 * c.sticking_share)} %`),
          ],
        ],
      ),
      html(
        "p",
        { class: "small faint" },
        `Model ${answer.model}. ${answer.contacts[0].saturated ? "This model saturates the friction in one direction; the picture shows the slip over the ellipse. " : ""}The long axis of each ellipse lies across the groove. The ball rolls along the groove, which points upward here and is drawn to a larger scale. The longest arrow corresponds to ${measured(fastest, "m/s")}. The thick arrow is the friction force on the ball.`,
      ),
    );
    for (const { paint } of figures) paint();
  }

  alternative(c) {
    return `Contact ellipse at the ${c.contact}: largest pressure ${measured(c.max_pressure_MPa, "MPa")}, ${c.spin_poles.length} spin poles, ${c.rolling_lines.length} lines of pure rolling, ratio of friction to load ${number(c.friction_over_load)}, ${number(100 * c.sticking_share)} percent of the area sticks`;
  }

  paint(canvas, contact, values, [low, high], fastest, widest) {
    const width = canvas.parentElement.clientWidth;
    const height = Math.min(210, 0.52 * width);
    if (width < 40) return;
    const g = sharp(canvas, width, height);
    const n = contact.places.length;
    const rx = (width / 2 - 8) * (contact.semi_axes_mm[0] / widest);
    const ry = height / 2 - 8;
    const cx = width / 2;
    const cy = height / 2;
    const ink = color("ink");
    const hot = color("hot");
    // The field is drawn with one pixel per grid point. It is extended beyond the edge of the ellipse, so that smoothing does not
    // darken the edge.
    const image = new ImageData(n, n);
    const near = (i, j) => {
      const s = values[j * n + i];
      if (s !== null) return s;
      const x = contact.places[i];
      const y = contact.places[j];
      const size = Math.hypot(x, y) * 1.001 + 1.2 / n;
      const place = (v) => Math.round(((v / size + 1) / 2) * (n - 1));
      return values[place(y) * n + place(x)] ?? low;
    };
    for (let j = 0; j < n; j += 1) {
      for (let i = 0; i < n; i += 1) {
        const [r, gr, b] = ramp((near(i, j) - low) / (high - low || 1));
        image.data.set([r, gr, b, 255], 4 * ((n - 1 - j) * n + i));
      }
    }
    const small = new OffscreenCanvas(n, n);
    small.getContext("2d").putImageData(image, 0, 0);
    g.save();
    g.beginPath();
    g.ellipse(cx, cy, rx, ry, 0, 0, 2 * Math.PI);
    g.clip();
    g.imageSmoothingQuality = "high";
    const step = 1 / (n - 1);
    g.drawImage(small, cx - rx * (1 + step), cy - ry * (1 + step), 2 * rx * (1 + step), 2 * ry * (1 + step));
    g.restore();
    const at = (x, y) => [cx + rx * x, cy - ry * y];
    const stroke = (draw, paint, wide, dash = []) => {
      for (const [c, w] of [
        ["rgb(255 255 255 / .75)", wide + 2.4],
        [paint, wide],
      ]) {
        g.beginPath();
        g.setLineDash(dash);
        g.lineWidth = w;
        g.strokeStyle = c;
        draw();
        g.stroke();
      }
      g.setLineDash([]);
    };
    if (this.on.lines) {
      for (const xi of contact.rolling_lines) {
        const y = Math.sqrt(1 - xi * xi);
        stroke(
          () => {
            g.moveTo(...at(xi, -y));
            g.lineTo(...at(xi, y));
          },
          "#111",
          1.6,
          [5, 4],
        );
      }
    }
    const arrow = ([x1, y1], [dx, dy], head = 4) => {
      const a = Math.atan2(dy, dx);
      g.moveTo(x1, y1);
      g.lineTo(x1 + dx, y1 + dy);
      for (const t of [2.6, -2.6]) {
        g.moveTo(x1 + dx, y1 + dy);
        g.lineTo(x1 + dx + head * Math.cos(a + t), y1 + dy + head * Math.sin(a + t));
      }
    };
    const skip = Math.max(1, Math.round(n / 13));
    if (this.on.arrows) {
      for (let j = skip >> 1; j < n; j += skip) {
        for (let i = skip >> 1; i < n; i += skip) {
          const k = j * n + i;
          const along = contact.slip_along_m_s[k];
          const across = contact.slip_across_m_s[k];
          if (along === null) continue;
          const speed = Math.hypot(along, across);
          const [x, y] = at(contact.places[i], contact.places[j]);
          if (speed < contact.creep_speed_m_s) {
            g.beginPath();
            g.fillStyle = "#fff";
            g.strokeStyle = "#111";
            g.lineWidth = 1;
            g.arc(x, y, 2.6, 0, 7);
            g.fill();
            g.stroke();
            continue;
          }
          const length = 4 + 17 * Math.sqrt(speed / fastest);
          const d = [(across / speed) * length, (-along / speed) * length];
          stroke(() => arrow([x - d[0] / 2, y - d[1] / 2], d), "#111", 1.2);
        }
      }
    }
    const [f, t] = contact.friction_force_N;
    const size = Math.hypot(f, t);
    if (this.on.arrows && size > 0)
      stroke(() => arrow([cx, cy], [(f / size) * 0.3 * height, (-t / size) * 0.3 * height], 9), "#111", 3.2);
    if (this.on.lines) {
      for (const [xi, upsilon] of contact.spin_poles) {
        const [x, y] = at(xi, upsilon);
        g.beginPath();
        g.fillStyle = hot;
        g.strokeStyle = "#fff";
        g.lineWidth = 1.8;
        g.arc(x, y, 5.5, 0, 7);
        g.fill();
        g.stroke();
      }
    }
    g.beginPath();
    g.strokeStyle = ink;
    g.lineWidth = 1.2;
    g.ellipse(cx, cy, rx, ry, 0, 0, 2 * Math.PI);
    g.stroke();
  }
}
