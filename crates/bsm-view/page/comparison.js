// Comparison of cases: the inputs that differ, and the results of each case.

import { html, shown, shownUnit, unitOf } from "bsm/draw";
import { INPUT } from "bsm/source";

export class Comparison {
  /** `edit` is called with the case to show, and `changed` is called when the list of kept cases changes. */
  constructor(host, { edit, changed }) {
    Object.assign(this, { host, edit, changed, kept: [] });
    const keep = html(
      "button",
      {
        type: "button",
        onclick: () => {
          this.add(this.case, this.solved);
          changed();
        },
      },
      "Keep this case",
    );
    this.stage = html("div");
    host.append(
      html(
        "div",
        { class: "bar" },
        keep,
        html(
          "span",
          { class: "small faint" },
          "Then change the inputs. Each kept case remains as a column of the table.",
        ),
      ),
      this.stage,
    );
  }

  /** Adds a case to the comparison. If its results `solved` are missing, they are requested later. */
  add(entries, solved = null) {
    this.kept.push({ case: structuredClone(entries), solved });
  }

  /** Replaces all cases in the comparison. */
  take(cases) {
    this.kept = [];
    for (const { case: entries } of cases) this.add(entries);
  }

  /** Discards all results, because the settings have changed. */
  forget() {
    for (const kept of this.kept) kept.solved = null;
  }

  /** Requests the missing results. */
  async solve(ask) {
    for (const kept of this.kept) {
      if (!kept.solved) {
        const answer = await ask(kept.case);
        if (answer instanceof Error) {
          if (answer.name === "AbortError") return;
          kept.solved = { error: answer.message };
        } else kept.solved = answer;
      }
    }
    this.draw();
  }

  show(entries, solved) {
    this.case = structuredClone(entries);
    this.solved = solved;
    this.draw();
  }

  draw() {
    if (!this.kept.length) {
      this.stage.replaceChildren();
      return;
    }
    const columns = [{ case: this.case, solved: this.solved }, ...this.kept];
    const body = html(
      "tbody",
      {},
      inputRows(columns),
      line(
        "model",
        "",
        columns.map(({ solved }) => solved?.model ?? "–"),
      ),
      line("regime", "", columns.map(regime), "small"),
      outputRows(columns),
    );
    const heads = columns.map((column, place) => this.head(column, place));
    this.stage.replaceChildren(
      html(
        "div",
        { class: "scroll", tabindex: "0", role: "region", "aria-label": "Cases side by side" },
        html(
          "table",
          { class: "beside" },
          html("caption", {}, "Cases side by side"),
          html("thead", {}, html("tr", {}, html("td"), html("td"), heads)),
          body,
        ),
      ),
    );
  }

  /** Creates the head of a column. Column 0 contains the current case, and the kept cases follow. */
  head({ case: entries }, place) {
    const show = () => this.edit(this.kept[place - 1].case);
    const remove = () => {
      this.kept.splice(place - 1, 1);
      this.draw();
      this.changed();
    };
    const label = `Remove the kept case ${place}`;
    const buttons = [
      html("button", { type: "button", onclick: show }, "Show"),
      html("button", { type: "button", "aria-label": label, onclick: remove }, "×"),
    ];
    return html(
      "th",
      { scope: "col", class: "number" },
      html("div", {}, place ? `kept ${place}` : "this case"),
      html("div", { class: "small faint" }, entries.description ?? ""),
      place ? html("div", {}, buttons) : null,
    );
  }
}

/** Creates a table row with one value for each case. */
const line = (label, unit, values, kind = "number") =>
  html(
    "tr",
    {},
    html("th", { scope: "row" }, label),
    html("td", { class: "faint" }, unitOf(unit)),
    values.map((value) => html("td", { class: kind }, value)),
  );

/** Formats the value of an input. */
function written(value) {
  if (value === undefined) return "–";
  return typeof value === "object" ? JSON.stringify(value) : String(value);
}

/** Creates a table row for each input that differs between the cases, in its display unit. */
function inputRows(columns) {
  const cases = columns.map(({ case: entries }) => entries);
  const names = [...new Set(cases.flatMap((entries) => Object.keys(entries)))];
  const differs = (name) => new Set(cases.map((entries) => written(entries[name]))).size > 1;
  const inputRow = (name) => {
    const { label, unit } = INPUT.get(name) ?? { label: name.replaceAll("_", " "), unit: "" };
    const value = (own) => {
      const other = shown(own, unit);
      return other === own ? own : Number(other.toPrecision(6));
    };
    const values = cases.map((entries) => written(value(entries[name])));
    return line(label, shownUnit(unit), values);
  };
  return names.filter((name) => name !== "description" && differs(name)).map(inputRow);
}

/** Creates a table row for each result. */
function outputRows(columns) {
  const numbers = columns.map(({ solved }) => {
    const rows = solved?.shown?.overall ?? [];
    return new Map(rows.map(([label, unit, value]) => [label, { unit, value }]));
  });
  const labels = [...new Set(numbers.flatMap((map) => [...map.keys()]))];
  return labels.map((label) => {
    const cells = numbers.map((map) => map.get(label));
    const { unit } = cells.findLast((cell) => cell);
    const values = cells.map((cell) => cell?.value ?? "–");
    return line(label, unit, values);
  });
}

/** Returns the regime of a solved case, or the reason why there is no solution. */
function regime({ solved }) {
  if (!solved) return "…";
  if (solved.error) return solved.error;
  if (solved.status === "converged") return solved.regime ?? "";
  return `${solved.status.replace("_", " ")}: ${solved.message}`;
}
