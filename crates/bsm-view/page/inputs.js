// Input fields, created from the list of inputs that the program accepts.

import { html, brief, parsed } from "bsm/draw";
import { INPUT, start } from "bsm/source";

const { schema } = start;

/** Returns the permitted values of an input that is not a number: a list of words, or true and false. */
const choices = (name) => {
  const { enum: words, type } = schema.input.properties[name];
  return words ?? (type?.includes("boolean") ? [true, false] : null);
};
/**
 * Names of the inputs with a list of possible values, or with the values true and false. They belong to the
 * nut unless `GROUPED` lists them.
 */
const WORDS = Object.keys(schema.input.properties).filter((name) => !INPUT.has(name) && choices(name));
const GROUPED = {
  lubricant: ["base_oil"],
  axis: ["support", "drag_rule"],
  "warm state": ["warm_state", "coolant"],
};

/** Number of steps of a slider. */
const STEPS = 1000;

/** Returns the range of a slider around a value, within the permitted range of the input. */
function rangeOf(name, value) {
  const p = schema.input.properties[name];
  let low = p.minimum ?? p.exclusiveMinimum ?? -Infinity;
  let high = p.maximum ?? p.exclusiveMaximum ?? Infinity;
  const whole = p.type?.includes("integer");
  const positive = low >= 0 && value > 0;
  if (low > -1e300 && high < 1e300) {
    const room = (high - low) / 200;
    if ("exclusiveMinimum" in p) low += room;
    if ("exclusiveMaximum" in p) high -= room;
    return { low: Math.min(low, value), high: Math.max(high, value), log: false, whole };
  }
  if (positive && low > 0)
    return { low: Math.min(low * 1.002, value), high: Math.max(low * 1.4, value * 1.2), log: false, whole };
  if (positive)
    return { low: Math.max(value / 10, whole ? Math.max(low, 1) : 0), high: value * 10, log: true, whole };
  const size = Math.abs(value) || 1;
  return { low: Math.max(-2 * size, low), high: 2 * size, log: false, whole };
}

/** The input form. `changed(case)` is called after every change. */
export class Inputs {
  constructor(form, changed) {
    Object.assign(this, { form, changed, fields: new Map(), units: new Map() });
    form.addEventListener("submit", (event) => event.preventDefault());
  }

  /** Shows a case, with slider ranges around its values. */
  show(entries) {
    this.case = { ...entries };
    this.ranges = new Map();
    this.build();
  }

  build() {
    this.fields.clear();
    const words = (group) =>
      GROUPED[group] ??
      (group === "nut" ? WORDS.filter((name) => !Object.values(GROUPED).flat().includes(name)) : []);
    const sets = schema.groups.map((group) => {
      const given = schema.inputs.filter((input) => input.group === group && input.name in this.case);
      const texts = words(group).filter((name) => name in this.case);
      const open = schema.inputs.filter((input) => input.group === group && !(input.name in this.case));
      const more = words(group).filter((name) => !(name in this.case) && schema.input.properties[name]);
      if (!given.length && !texts.length && !open.length) return null;
      const add = html(
        "select",
        {
          class: "add",
          "aria-label": `Add an input of the group ${group}`,
          onchange: (event) => this.add(event.target.value),
        },
        html("option", { value: "" }, "Add an input …"),
        open.map((input) =>
          html("option", { value: input.name }, `${input.label}${input.unit ? `, ${input.unit}` : ""}`),
        ),
        more.map((name) => html("option", { value: name }, name.replaceAll("_", " "))),
      );
      return html(
        "fieldset",
        {},
        html("legend", {}, group),
        given.map((input) => this.field(input)),
        texts.map((name) => this.choice(name)),
        open.length + more.length ? add : null,
      );
    });
    this.form.replaceChildren(...sets.filter(Boolean));
  }

  field(input) {
    const { name } = input;
    const id = `in-${name}`;
    const range = this.ranges.get(name) ?? this.rangeFor(name);
    this.ranges.set(name, range);
    // Initially, a field has the display unit of the case.
    const [, factor, zero] = schema.display[this.case.display_units]?.[input.unit] ?? [];
    const usual = input.units.find(([, size, from]) => size === factor && from === zero);
    if (usual && !this.units.has(name)) this.units.set(name, usual);
    /** Conversions between the unit of the field and the unit of the case. */
    const toCase = (value) => {
      const [, factor, zero] = this.unitOf(input);
      return factor * (value - zero);
    };
    const fromCase = (value) => {
      const [, factor, zero] = this.unitOf(input);
      return value / factor + zero;
    };
    const box = html("input", {
      id,
      type: "text",
      inputmode: "decimal",
      autocomplete: "off",
      "aria-describedby": `${id}-about ${id}-wrong`,
      oninput: () => {
        // If the text is not a number, it is sent unchanged, so that the error message names the field.
        const text = box.value.trim();
        const value = parsed(text);
        this.set(name, text === "" ? null : Number.isNaN(value) ? text : tidy12(toCase(value)), box);
      },
    });
    const slider = html("input", {
      type: "range",
      min: 0,
      max: STEPS,
      step: 1,
      "aria-label": `${input.label}, slider`,
      oninput: () => this.set(name, this.at(range, slider.valueAsNumber / STEPS), slider),
    });
    const ends = html("div", { class: "range" });
    const wrong = html("p", { class: "wrong", id: `${id}-wrong`, hidden: true });
    const standard = input.default == null ? "" : `; default ${brief(input.default)}`;
    const about = `${input.about}; ${input.rule}${standard}`;
    const label = html("label", { for: id, title: about }, input.label);
    const element = html(
      "div",
      { class: "field", "data-name": name },
      html("div", { class: "row" }, label, box, this.unitPicker(input), this.dropButton(input)),
      slider,
      ends,
      wrong,
      html("span", { id: `${id}-about`, hidden: true }, about),
    );
    this.fields.set(name, { element, box, slider, ends, wrong, range, fromCase });
    this.refresh(name);
    return element;
  }

  /** Returns the unit of the field of an input: its text, its factor and its zero point. */
  unitOf({ name, unit }) {
    return this.units.get(name) ?? [unit, 1, 0];
  }

  /** Creates the list of units of an input, or the text of its only unit. */
  unitPicker(input) {
    const { name, unit, units } = input;
    if (!units.length) return html("span", { class: "unit" }, unit);
    const select = () => {
      this.units.set(name, picker.selectedIndex === 0 ? [unit, 1, 0] : units[picker.selectedIndex - 1]);
      this.refresh(name);
    };
    const option = ([other]) =>
      html("option", { selected: this.unitOf(input)[0] === other }, other.replaceAll("_", "/"));
    const picker = html(
      "select",
      { "aria-label": `Unit of ${input.label}`, onchange: select },
      html("option", {}, unit),
      units.map(option),
    );
    return picker;
  }

  dropButton({ name, label }) {
    const attributes = {
      type: "button",
      "aria-label": `Remove ${label}`,
      title: "Remove",
      onclick: () => this.drop(name),
    };
    return html("button", attributes, "×");
  }

  choice(name) {
    const words = choices(name);
    const { description } = schema.input.properties[name];
    const pick = html(
      "select",
      {
        id: `in-${name}`,
        title: description,
        onchange: () => {
          this.case[name] = words.find((word) => String(word) === pick.value);
          this.changed(this.case);
        },
      },
      words
        .filter((word) => word !== null)
        .map((word) => html("option", { value: word, selected: this.case[name] === word }, String(word))),
    );
    return html(
      "div",
      { class: "field", "data-name": name },
      html("label", { for: `in-${name}` }, `${name.replaceAll("_", " ")} `),
      pick,
    );
  }

  rangeFor(name) {
    return rangeOf(name, this.case[name] ?? 1);
  }

  at({ low, high, log, whole }, part) {
    const value =
      part === 0 ? low : part === 1 ? high : log ? low * (high / low) ** part : low + (high - low) * part;
    return whole ? Math.round(value) : Number(value.toPrecision(4));
  }

  /** Updates all controls of a field except the control that the user is operating. */
  refresh(name, from) {
    const field = this.fields.get(name);
    if (!field) return;
    const { box, slider, ends, range, fromCase } = field;
    const value = this.case[name];
    if (box !== from) box.value = typeof value === "number" ? tidy12(fromCase(value)) : (value ?? "");
    const part = range.log
      ? Math.log(value / range.low) / Math.log(range.high / range.low)
      : (value - range.low) / (range.high - range.low);
    if (slider !== from) slider.value = Math.round(STEPS * Math.min(Math.max(part, 0), 1));
    ends.replaceChildren(
      html("span", {}, brief(fromCase(range.low))),
      html("span", {}, range.log ? "logarithmic" : ""),
      html("span", {}, brief(fromCase(range.high))),
    );
    slider.setAttribute("aria-valuetext", `${brief(fromCase(value))} ${this.unitOf(INPUT.get(name))[0]}`);
  }

  set(name, value, from) {
    if (value == null) delete this.case[name];
    else this.case[name] = value;
    // A field remains on the page after the user has cleared it.
    this.refresh(name, from);
    this.changed(this.case);
  }

  /** Sets inputs that were changed outside the form, for example by moving the cross in the map. */
  put(values) {
    Object.assign(this.case, values);
    for (const name of Object.keys(values)) this.refresh(name);
    this.changed(this.case);
  }

  add(name) {
    if (!name) return;
    const input = INPUT.get(name);
    const property = schema.input.properties[name];
    this.case[name] = input
      ? (input.default ??
        property.minimum ??
        (property.exclusiveMinimum != null ? (property.exclusiveMinimum || 0.1) * 1.04 : 1))
      : choices(name).find((word) => word !== null);
    this.build();
    this.form.querySelector(`[id="in-${name}"]`)?.focus();
    this.changed(this.case);
  }

  drop(name) {
    delete this.case[name];
    this.build();
    this.changed(this.case);
  }

  /**
   * Marks the field of the input that caused an error, and returns true if such a field exists. If the error
   * does not state an input, all fields that its message names are marked. If there is no error, all marks
   * are removed.
   */
  blame(error) {
    const names = new Set(error?.key ? [error.key] : error?.message.match(/[A-Za-z][A-Za-z0-9_]*/g));
    let any = false;
    for (const [name, { element, box, wrong }] of this.fields) {
      const bad = names.has(name);
      element.classList.toggle("bad", bad);
      box.setAttribute("aria-invalid", bad);
      wrong.hidden = !bad;
      wrong.textContent = bad ? error.message : "";
      any ||= bad;
    }
    return any;
  }
}

/** Removes the rounding errors of unit conversions. */
function tidy12(value) {
  return Number(value.toPrecision(12));
}
