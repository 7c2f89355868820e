// Panel of the feed axis: its rules, its results and its sheet.

import { html, number, interval, none, table, unitOf } from "bsm/draw";
import { groups, remarks } from "bsm/nut";
import { download } from "bsm/save";

/** Shows the answer for the axis. `sheet` is a function that opens the axis sheet as a separate page. */
export function showAxis(host, answer, sheet) {
  if (answer instanceof Error) {
    host.replaceChildren(none(answer.message));
    return;
  }
  const rules = answer.rules.filter(({ limit }) => limit != null);
  const failed = rules.filter(({ passes }) => passes === false).length;
  const undecided = rules.filter(({ passes }) => passes == null).length;
  const lacking = [...new Set((answer.not_given ?? []).map(({ text }) => text))];
  const ends = answer.groove_estimate?.intervals?.rules ?? {};
  const open = html(
    "button",
    {
      type: "button",
      onclick: () =>
        sheet().then((page) => {
          if (page) globalThis.open(URL.createObjectURL(new Blob([page], { type: "text/html" })), "_blank");
        }),
    },
    "Open the sheet",
  );
  const keep = html(
    "button",
    {
      type: "button",
      onclick: () =>
        sheet().then((page) => {
          if (page) download("sheet.html", new Blob([page], { type: "text/html" }));
        }),
    },
    "Save the sheet",
  );
  const line = ({ rule, unit, value, must_be: must, limit, margin, passes, source, remedy }) =>
    html(
      "tr",
      { class: limit != null && passes === false ? "failed" : null },
      html(
        "th",
        { scope: "row" },
        rule,
        remedy ? html("div", { class: "small faint" }, `Remedies: ${remedy}.`) : null,
      ),
      html("td", { class: "number" }, `${number(value)}${interval(ends[rule])} ${unitOf(unit)}`.trim()),
      html("td", { class: "number" }, limit == null ? "" : `${must === ">=" ? "≥" : "≤"} ${number(limit)}`),
      html("td", { class: "number" }, margin == null ? "" : `${Number((100 / margin).toPrecision(2))} %`),
      html(
        "td",
        {},
        limit == null
          ? "no requirement"
          : passes == null
            ? html("span", { class: "undecided" }, "? undecided")
            : passes
              ? html("span", { class: "pass" }, "✓")
              : html("span", { class: "fail" }, "✗ FAIL"),
      ),
      html("td", { class: "small source" }, source),
    );
  host.replaceChildren(
    html(
      "div",
      { class: "bar" },
      failed
        ? html(
            "strong",
            { class: "fail" },
            `✗ ${failed} of ${rules.length} rules fail${undecided ? `, and ${undecided} are undecided` : ""}.`,
          )
        : undecided
          ? html(
              "strong",
              { class: "undecided" },
              `? ${undecided} of ${rules.length} rules ${undecided > 1 ? "are" : "is"} undecided because the groove is estimated.`,
            )
          : html(
              "strong",
              { class: "pass" },
              `✓ All ${rules.length} rules pass${lacking.length ? ` for the given inputs; ${lacking.join("; ")}` : ""}.`,
            ),
      open,
      keep,
    ),
    table(
      "Rules of the axis",
      ["rule", "value", "limit", "utilization", "passes", "source"],
      answer.rules.map(line),
    ),
    ...remarks(answer),
    html(
      "details",
      {},
      html("summary", {}, "Numbers of the axis"),
      html("div", { class: "tables" }, groups(answer.shown)),
    ),
  );
}
