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
    const written = (value) =>
      value === undefined ? "–" : typeof value === "object" ? JSON.stringify(value) : String(value);
    const names = [...new Set(columns.flatMap(({ case: entries }) => Object.keys(entries)))].filter(
      (name) =>
        name !== "description" &&
        new Set(columns.map(({ case: entries }) => written(entries[name]))).size > 1,
    );
    const line = (label, unit, values, kind = "number") =>
      html(
        "tr",
        {},
        html("th", { scope: "row" }, label),
        html("td", { class: "faint" }, unitOf(unit)),
        values.map((value) => html("td", { class: kind }, value)),
      );
    /** Creates the table row of an input, in its display unit. */
    const given = (name) => {
      const { label, unit } = INPUT.get(name) ?? { label: name.replaceAll("_", " "), unit: "" };
      const value = (own) => {
        const other = shown(own, unit);
        return other === own ? own : Number(other.toPrecision(6));
      };
      return line(
        label,
        shownUnit(unit),
        columns.map(({ case: entries }) => written(value(entries[name]))),
      );
    };
    const numbers = columns.map(
      ({ solved }) =>
        new Map((solved?.shown?.overall ?? []).map(([label, unit, value]) => [label, [unit, value]])),
    );
    const labels = [...new Set(numbers.flatMap((map) => [...map.keys()]))];
    const units = new Map(numbers.flatMap((map) => [...map].map(([label, [unit]]) => [label, unit])));
    const head = ({ case: entries }, i) =>
      html(
        "th",
        { scope: "col", class: "number" },
        html("div", {}, i ? `kept ${i}` : "this case"),
        html("div", { class: "small faint" }, entries.description ?? ""),
        i
          ? html(
              "div",
              {},
              html("button", { type: "button", onclick: () => this.edit(this.kept[i - 1].case) }, "Show"),
              html(
                "button",
                {
                  type: "button",
                  "aria-label": `Remove the kept case ${i}`,
                  onclick: () => {
                    this.kept.splice(i - 1, 1);
                    this.draw();
                    this.changed();
                  },
                },
                "×",
              ),
            )
          : null,
      );
    const status = ({ solved }) =>
      solved
        ? (solved.error ??
          (solved.status === "converged"
            ? (solved.regime ?? "")
            : `${solved.status.replace("_", " ")}: ${solved.message}`))
        : "…";
    this.stage.replaceChildren(
      html(
        "div",
        { class: "scroll", tabindex: "0", role: "region", "aria-label": "Cases side by side" },
        html(
          "table",
          { class: "beside" },
          html("caption", {}, "Cases side by side"),
          html("thead", {}, html("tr", {}, html("td"), html("td"), columns.map(head))),
          html(
            "tbody",
            {},
            names.map(given),
            line(
              "model",
              "",
              columns.map(({ solved }) => solved?.model ?? "–"),
            ),
            line("regime", "", columns.map(status), "small"),
            labels.map((label) =>
              line(
                label,
                units.get(label),
                numbers.map((map) => map.get(label)?.[1] ?? "–"),
              ),
            ),
          ),
        ),
      ),
    );
  }
}
