// A map of any output as a function of any two inputs, with the operating point.

import {
  html,
  svg,
  text,
  number,
  shown,
  shownAll,
  shownUnit,
  own,
  labeled,
  measured,
  brief,
  parsed,
  ramp,
  rampBar,
  scale,
  axes,
  sharp,
  none,
  path,
} from "bsm/draw";
import { INPUT, OUTPUT, start } from "bsm/source";

const PAD = { left: 66, top: 10, right: 14, bottom: 44 };
/** Number of points per side of the map that is shown first. */
const COARSE = 24;
/** Numbers of points per side of finer maps. The finest map within the time limit replaces the coarse map. */
const FINER = [100, 60, 40];
/** Time limit for a finer map [ms]. */
const PATIENCE = 1600;
/** Colors of lines on the map, and of their outlines. */
const LINE = "#111";
const OUTLINE = "#fff";

export class ModelMap {
  /**
   * `moved` is called with the values of a selected point, `ask` sends a request, and `again` is called when
   * another map is selected.
   */
  constructor(host, { moved, ask, again }) {
    Object.assign(this, { host, moved, ask, again, ranges: {} });
    const pick = (words) => html("select", { "aria-label": words, onchange: () => this.other() });
    this.x = pick("Horizontal input of the map");
    this.y = pick("Vertical input of the map");
    this.output = html("select", { "aria-label": "Output of the map", onchange: () => this.again() });
    this.fields = html("div", { class: "bar small" });
    host.columns = () => (this.answer ? { points: this.columns() } : {});
    this.stage = html("div", { class: "map" });
    this.under = html("div");
    this.readout = html(
      "p",
      { class: "readout small", "aria-live": "off" },
      "Point at the map to read values. Drag the cross or use the arrow keys to move the operating point.",
    );
    host.append(
      html(
        "div",
        { class: "bar" },
        this.output,
        html("label", {}, "as a function of ", this.x),
        html("label", {}, "and ", this.y),
      ),
      html("div", { class: "split" }, this.stage, html("div", {}, this.readout, this.under, this.fields)),
    );
  }

  /** Returns the selected inputs, the selected output and the ranges of the inputs. */
  choice() {
    return { x: this.x.value, y: this.y.value, output: this.output.value, ranges: this.ranges };
  }

  /** Lists the inputs that can be varied in a case, and makes the selection `chosen`. */
  choices(entries, chosen = {}) {
    const { inputs, outputs } = start.schema;
    const can = inputs.filter(({ name }) => typeof entries[name] === "number" && entries[name] !== 0);
    const fill = (select, list, wanted, asked) => {
      const known = (value) => list.some(({ name }) => name === value);
      const former = [asked, select.value].find(known) ?? wanted;
      select.replaceChildren(
        ...list.map(({ name, label, unit }) =>
          html(
            "option",
            { value: name, selected: name === former },
            list === can ? label : labeled(label, unit),
          ),
        ),
      );
    };
    const has = (name) => can.some((input) => input.name === name);
    fill(this.x, can, ["screw_speed_rpm", "lead_angle_deg", "lead_mm"].find(has) ?? can[0]?.name, chosen.x);
    fill(this.y, can, ["axial_load_N", "contact_angle_deg"].find(has) ?? can[1]?.name, chosen.y);
    if (this.x.value === this.y.value) this.y.selectedIndex = (this.x.selectedIndex + 1) % can.length;
    fill(this.output, outputs, "efficiency", chosen.output);
    this.ranges = { ...chosen.ranges };
    this.drawFields(entries);
  }

  range(name, value) {
    if (this.ranges[name]) return this.ranges[name];
    const p = start.schema.input.properties[name];
    const top = p.maximum ?? p.exclusiveMaximum ?? Infinity;
    const bottom = p.minimum ?? p.exclusiveMinimum ?? -Infinity;
    let low;
    let high;
    let log = value > 0 && bottom <= 0 && top === Infinity;
    if (bottom > 0 && top === Infinity) {
      low = bottom + (value - bottom) * 0.1;
      high = bottom + (value - bottom) * 3;
      log = false;
    } else if (top < Infinity && bottom > -Infinity) {
      const room = (top - bottom) / 60;
      low = bottom + room;
      high = top - room;
    } else if (log) {
      low = value / 10;
      high = value * 10;
    } else {
      low = value < 0 ? value * 10 : value / 10;
      high = value < 0 ? value / 10 : value * 10;
    }
    const tidy = (v) => Number(v.toPrecision(4));
    return (this.ranges[name] = { low: tidy(low), high: tidy(high), log });
  }

  drawFields(entries) {
    const row = (select) => {
      const name = select.value;
      const value = entries[name];
      if (value == null) return null;
      const range = this.range(name, value);
      const { label, unit } = INPUT.get(name);
      const text = (end) => Number(shown(range[end], unit).toPrecision(6));
      const box = (end) =>
        html("input", {
          type: "text",
          inputmode: "decimal",
          autocomplete: "off",
          value: text(end),
          style: "width:7rem",
          "aria-label": `${end === "low" ? "Lowest" : "Highest"} ${label}`,
          onchange: (event) => {
            const value = parsed(event.target.value);
            if (Number.isNaN(value)) event.target.value = text(end);
            else {
              range[end] = own(value, unit);
              this.again();
            }
          },
        });
      return html(
        "span",
        {},
        `${label} `,
        box("low"),
        " to ",
        box("high"),
        ` ${shownUnit(unit)} `,
        html(
          "label",
          {},
          html("input", {
            type: "checkbox",
            checked: range.log,
            "aria-label": `${label} logarithmic`,
            onchange: (event) => {
              range.log = event.target.checked;
              this.again();
            },
          }),
          "log",
        ),
      );
    };
    this.fields.replaceChildren(...[this.x, this.y].map(row).filter(Boolean));
  }

  /** Updates the map after the user has selected other inputs. */
  other() {
    this.drawFields(this.case);
    this.again();
  }

  /** Solves the map of a case, first with few points, and then with more points if the time limit permits. */
  async show(body, signal) {
    const { case: entries } = body;
    const names = [this.x.value, this.y.value];
    if (names[0] === names[1] || names.some((name) => entries[name] == null)) {
      this.refuse("The map needs two different inputs that the case contains.");
      return;
    }
    const vary = (count) =>
      names.map((name) => {
        const { low, high, log } = this.range(name, entries[name]);
        return `${name}=${low}:${high}:${count}${log && low > 0 ? ":log" : ""}`;
      });
    // The map does not depend on the inputs on its axes, so the operating point can move without a new map.
    const key = JSON.stringify([
      { ...entries, [names[0]]: null, [names[1]]: null },
      body.settings,
      vary(0),
      this.output.value,
    ]);
    if (key === this.key) return;
    const draw = async (count) => {
      const answer = await this.ask(
        "sweep",
        { ...body, vary: vary(count), columns: [this.output.value] },
        signal,
      );
      if (signal.aborted) return null;
      this.answer = answer;
      this.case = entries;
      this.host.dataset.points = answer.model.length;
      this.host.dataset.ms = answer.took;
      this.draw();
      return answer.took;
    };
    try {
      const took = await draw(COARSE);
      const finer = took !== null && FINER.find((count) => took * (count / COARSE) ** 2 < PATIENCE);
      // If the fine map takes too long and is stopped, the coarse map remains visible.
      if (finer) await draw(finer).catch(() => null);
      if (!signal.aborted) this.key = key;
    } catch (error) {
      if (!signal.aborted) this.refuse(error.message);
    }
  }

  refuse(words) {
    this.answer = this.key = this.cross = null;
    this.stage.replaceChildren(none(words));
    this.under.replaceChildren();
  }

  /** Moves the cross to the operating point of a case. */
  point(entries) {
    this.case = entries;
    if (this.cross) this.place();
  }

  /** Returns the points of the map as columns. */
  columns() {
    const {
      axes: [x, y],
      columns,
      model,
      models,
      status,
      statuses,
    } = this.answer;
    const n = y.values.length;
    return {
      [x.name]: model.map((_, k) => x.values[Math.floor(k / n)]),
      [y.name]: model.map((_, k) => y.values[k % n]),
      ...columns,
      model: model.map((place) => models[place]),
      status: status.map((place) => statuses[place]),
    };
  }

  draw() {
    const { answer } = this;
    if (!answer) return;
    const width = this.stage.clientWidth;
    const height = Math.max(250, Math.min(400, 0.72 * width));
    const box = [PAD.left, PAD.top, width - PAD.right, height - PAD.bottom];
    const [ax, ay] = answer.axes;
    const output = OUTPUT.get(this.output.value);
    const values = shownAll(answer.columns[output.name] ?? [], output.unit);
    const found = values.filter((v) => v !== null);
    const ends = ({ values }) => [values[0], values.at(-1)];
    const x = scale(ends(ax), [box[0], box[2]], ax.log);
    const y = scale(ends(ay), [box[3], box[1]], ay.log);
    const outputWords = labeled(output.label, output.unit);
    Object.assign(this, { scales: [x, y], box, values, outputWords });
    if (!found.length) {
      this.cross = null;
      this.stage.replaceChildren(none(`No point of this map has a value for: ${outputWords}.`));
      this.under.replaceChildren();
      return;
    }
    const range = [Math.min(...found), Math.max(...found)];
    const [low, high] = range.map(number);
    const [xInput, yInput] = [ax, ay].map(({ name }) => INPUT.get(name));
    const [xWords, yWords] = [xInput, yInput].map(({ label, unit }) => labeled(label, unit));
    const overlay = svg("svg", {
      viewBox: `0 0 ${width} ${height}`,
      role: "group",
      "aria-label": `Map of ${outputWords} as a function of ${xWords} and ${yWords}, from ${low} to ${high}`,
    });
    const canvas = html("canvas");
    this.stage.replaceChildren(canvas, overlay);
    const size = [ax.values.length, ay.values.length];
    paintColors(sharp(canvas, width, height), values, size, range, box);
    const [shownX, shownY] = [shownScale(x, xInput.unit), shownScale(y, yInput.unit)];
    this.cross = this.crossAt();
    overlay.append(
      this.contours(values, size, ...range, box),
      this.borders(size, box),
      frame(shownX, shownY, box, xWords, yWords),
      this.cross,
    );
    this.followPointer(overlay);
    this.place();
    this.under.replaceChildren(
      rampBar(...range, outputWords),
      html("p", { class: "small faint" }, this.summary(values)),
    );
  }

  /** Reads values at the pointer, and moves the operating point while a button is pressed. */
  followPointer(overlay) {
    overlay.addEventListener("pointermove", (event) => this.hover(event));
    overlay.addEventListener("pointerdown", (event) => {
      this.drag(event);
      overlay.setPointerCapture(event.pointerId);
      this.dragging = true;
    });
    overlay.addEventListener("pointerup", () => {
      this.dragging = false;
    });
  }

  /** States the number of points, the models and the number of points without a solution. */
  summary(values) {
    const { model, models } = this.answer;
    const names = [...new Set(model.filter((_, i) => values[i] !== null))].map((place) => models[place]);
    const empty = values.filter((v) => v === null).length;
    const lines =
      names.length > 1 ? `red lines separate the models ${names.join(", ")}` : `model ${names[0]}`;
    const gray = empty ? `; gray: ${empty} points without a solution` : "";
    return `${values.length} points, ${lines}${gray}.`;
  }

  /** Draws lines of equal values with the marching squares algorithm. */
  contours(values, [nx, ny], low, high, box) {
    const group = svg("g", {});
    const at = (i, j) => [
      box[0] + (i / (nx - 1)) * (box[2] - box[0]),
      box[3] - (j / (ny - 1)) * (box[3] - box[1]),
    ];
    for (const level of levels(values, low, high)) {
      let d = "";
      let label = null;
      for (let i = 0; i + 1 < nx; i += 1) {
        for (let j = 0; j + 1 < ny; j += 1) {
          const corners = [
            [i, j],
            [i + 1, j],
            [i + 1, j + 1],
            [i, j + 1],
          ];
          const heights = corners.map(([a, b]) => values[a * ny + b]);
          if (heights.includes(null)) continue;
          const places = corners.map(([a, b]) => at(a, b));
          const cuts = cutsOf(places, heights, level);
          for (let c = 0; c + 1 < cuts.length; c += 2) d += path([cuts[c], cuts[c + 1]]);
          const middle =
            cuts[0] &&
            cuts[0][0] > box[0] + 0.62 * (box[2] - box[0]) &&
            cuts[0][0] < box[2] - 20 &&
            cuts[0][1] > box[1] + 12 &&
            cuts[0][1] < box[3] - 6;
          if (middle && !label) label = cuts[0];
        }
      }
      if (d) {
        group.append(
          svg("path", { d, fill: "none", stroke: OUTLINE, "stroke-width": 2.4, opacity: 0.5 }),
          svg("path", { d, fill: "none", stroke: LINE, "stroke-width": 0.9 }),
        );
      }
      if (label) {
        group.append(
          text(label[0], label[1] + 3, brief(level), {
            "text-anchor": "middle",
            class: "small",
            style: `fill:${LINE};paint-order:stroke;stroke:${OUTLINE};stroke-width:3px`,
          }),
        );
      }
    }
    return group;
  }

  /** Draws the borders between models. */
  borders([nx, ny], box) {
    const { model } = this.answer;
    const dx = (box[2] - box[0]) / (nx - 1);
    const dy = (box[3] - box[1]) / (ny - 1);
    let d = "";
    for (let i = 0; i < nx; i += 1) {
      for (let j = 0; j < ny; j += 1) {
        const here = model[i * ny + j];
        const x = box[0] + i * dx;
        const y = box[3] - j * dy;
        if (i + 1 < nx && model[(i + 1) * ny + j] !== here) {
          d += path([
            [x + dx / 2, Math.max(y - dy / 2, box[1])],
            [x + dx / 2, Math.min(y + dy / 2, box[3])],
          ]);
        }
        if (j + 1 < ny && model[i * ny + j + 1] !== here) {
          d += path([
            [Math.max(x - dx / 2, box[0]), y - dy / 2],
            [Math.min(x + dx / 2, box[2]), y - dy / 2],
          ]);
        }
      }
    }
    return svg(
      "g",
      {},
      svg("path", { d, stroke: OUTLINE, "stroke-width": 3.4, fill: "none" }),
      svg("path", { d, stroke: "#c2185b", "stroke-width": 1.8, fill: "none" }),
    );
  }

  crossAt() {
    const cross = svg("g", {
      class: "cross",
      tabindex: "0",
      role: "slider",
      "aria-label": "Operating point: use the arrow keys to move it",
      "aria-valuemin": "0",
      "aria-valuemax": "100",
      onkeydown: (event) => {
        const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[
          event.key
        ];
        if (!step) return;
        event.preventDefault();
        const size = event.shiftKey ? 30 : 6;
        const p = this.spot();
        this.move(p[0] + step[0] * size, p[1] + step[1] * size);
      },
    });
    for (const [stroke, wide] of [
      [OUTLINE, 5],
      [LINE, 2],
    ]) {
      cross.append(
        svg("path", { d: "M-13 0H-5M5 0H13M0 -13V-5M0 5V13", stroke, "stroke-width": wide }),
        svg("circle", { r: 6.5, fill: "none", stroke, "stroke-width": wide }),
      );
    }
    cross.append(svg("circle", { r: 16, fill: "transparent" }));
    return cross;
  }

  spot() {
    return this.scales.map((s, i) => {
      const v = this.case[this.answer.axes[i].name];
      return s.log && v <= 0 ? NaN : s(v);
    });
  }

  place() {
    const [x, y] = this.spot();
    const { box, answer } = this;
    const inside = x >= box[0] - 1 && x <= box[2] + 1 && y >= box[1] - 1 && y <= box[3] + 1;
    this.cross.style.display = inside ? "" : "none";
    if (!inside) return;
    this.cross.setAttribute("transform", `translate(${x} ${y})`);
    this.cross.setAttribute("aria-valuenow", Math.round((100 * (x - box[0])) / (box[2] - box[0])));
    this.cross.setAttribute(
      "aria-valuetext",
      answer.axes.map(({ name }) => `${name.replaceAll("_", " ")} ${number(this.case[name])}`).join(", "),
    );
  }

  move(px, py) {
    const { box, scales, answer } = this;
    const at = [Math.min(Math.max(px, box[0]), box[2]), Math.min(Math.max(py, box[1]), box[3])];
    const values = answer.axes.map(({ name, values }, i) => {
      const v = scales[i].value(at[i]);
      const p = start.schema.input.properties[name];
      return [name, p.type?.includes("integer") ? Math.round(v) : Number(v.toPrecision(4))];
    });
    this.moved(Object.fromEntries(values));
  }

  local(event) {
    const bounds = this.stage.getBoundingClientRect();
    return [event.clientX - bounds.left, event.clientY - bounds.top];
  }

  drag(event) {
    this.move(...this.local(event));
  }

  hover(event) {
    if (this.dragging) {
      this.drag(event);
      return;
    }
    const [px, py] = this.local(event);
    const { answer, scales, values } = this;
    const [i, j] = [px, py].map((p, k) => {
      const v = scales[k].value(p);
      const far = (w) => Math.abs(scales[k](w) - scales[k](v));
      const list = answer.axes[k].values;
      return list.reduce((best, w, place) => (far(w) < far(list[best]) ? place : best), 0);
    });
    const [ax, ay] = answer.axes;
    const at = i * ay.values.length + j;
    this.readout.dataset.x = ax.values[i];
    this.readout.dataset.y = ay.values[j];
    const value = values[at] === null ? "" : number(values[at]);
    this.readout.dataset.value = value;
    const status = answer.statuses[answer.status[at]].replace("_", " ");
    const words = (axis, v) => {
      const { label, unit } = INPUT.get(axis.name);
      return `${label} ${measured(v, unit)}`;
    };
    this.readout.replaceChildren(
      html("strong", {}, `${this.outputWords}: ${value || status}`),
      html("br"),
      `${words(ax, ax.values[i])}, ${words(ay, ay.values[j])}; model ${answer.models[answer.model[at]]}`,
    );
  }
}

/** Returns the places at which the edges of a cell cross a level. `heights` are the values at its corners. */
function cutsOf(places, heights, level) {
  const cuts = [];
  for (let edge = 0; edge < 4; edge += 1) {
    const next = (edge + 1) % 4;
    const a = heights[edge] - level;
    const b = heights[next] - level;
    if (a < 0 === b < 0) continue;
    const t = a / (a - b);
    const [p, q] = [places[edge], places[next]];
    cuts.push([p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])]);
  }
  return cuts;
}

/** Paints the values of a map. The colored area of each point extends halfway to its neighbors. */
function paintColors(g, values, [nx, ny], [low, high], [left, top, right, bottom]) {
  const image = new ImageData(nx, ny);
  for (let i = 0; i < nx; i += 1) {
    for (let j = 0; j < ny; j += 1) {
      const value = values[i * ny + j];
      const at = 4 * ((ny - 1 - j) * nx + i);
      if (value === null) image.data.set([128, 128, 128, 70], at);
      else image.data.set([...ramp((value - low) / (high - low || 1)), 255], at);
    }
  }
  const small = new OffscreenCanvas(nx, ny);
  small.getContext("2d").putImageData(image, 0, 0);
  const [width, height] = [right - left, bottom - top];
  const [stepX, stepY] = [width / (nx - 1), height / (ny - 1)];
  g.save();
  g.beginPath();
  g.rect(left, top, width, height);
  g.clip();
  g.imageSmoothingEnabled = false;
  g.drawImage(small, left - stepX / 2, top - stepY / 2, width + stepX, height + stepY);
  g.restore();
}

/**
 * Returns up to seven contour levels, rounded to three digits. About the same number of points is between any
 * two levels.
 */
function levels(values, low, high) {
  if (!(high > low)) return [];
  const sorted = values.filter((v) => v !== null).sort((a, b) => a - b);
  const list = [];
  for (let k = 1; k < 8; k += 1) {
    const v = Number(sorted[Math.floor((k / 8) * (sorted.length - 1))].toPrecision(3));
    if (v > low && v < high && !list.includes(v) && (!list.length || v - list.at(-1) > 0.015 * (high - low)))
      list.push(v);
  }
  return list;
}

/** Returns a scale with the same positions, whose values are in the display unit. */
function shownScale(place, unit) {
  const [low, high] = place.domain;
  return scale(shownAll(place.domain, unit), [place(low), place(high)], place.log);
}

/** Draws the axes on top of the colors, without grid lines. */
function frame(x, y, box, xWords, yWords) {
  const group = axes(x, y, box, xWords, yWords, PAD.left);
  group.querySelectorAll("line").forEach((line) => line.remove());
  return group;
}
