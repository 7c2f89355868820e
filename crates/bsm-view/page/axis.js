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
  const ends = answer.groove_estimate?.intervals?.rules ?? {};
  const withSheet = (act) => async () => {
    const page = await sheet();
    if (page) act(new Blob([page], { type: "text/html" }));
  };
  const open = withSheet((file) => globalThis.open(URL.createObjectURL(file), "_blank"));
  const save = withSheet((file) => download("sheet.html", file));
  host.replaceChildren(
    html(
      "div",
      { class: "bar" },
      verdict(answer),
      html("button", { type: "button", onclick: open }, "Open the sheet"),
      html("button", { type: "button", onclick: save }, "Save the sheet"),
    ),
    table(
      "Rules of the axis",
      ["rule", "value", "limit", "utilization", "passes", "source"],
      answer.rules.map((rule) => ruleRow(rule, ends[rule.rule])),
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

/** Summarizes which rules pass. Only rules with a limit count. */
function verdict(answer) {
  const rules = answer.rules.filter(({ limit }) => limit != null);
  const failed = rules.filter(({ passes }) => passes === false).length;
  const undecided = rules.filter(({ passes }) => passes == null).length;
  if (failed) {
    const others = undecided ? `, and ${undecided} are undecided` : "";
    return html("strong", { class: "fail" }, `✗ ${failed} of ${rules.length} rules fail${others}.`);
  }
  if (undecided) {
    const are = undecided > 1 ? "are" : "is";
    const words = `? ${undecided} of ${rules.length} rules ${are} undecided because the groove is estimated.`;
    return html("strong", { class: "undecided" }, words);
  }
  const lacking = [...new Set((answer.not_given ?? []).map(({ text }) => text))];
  const condition = lacking.length ? ` for the given inputs; ${lacking.join("; ")}` : "";
  return html("strong", { class: "pass" }, `✓ All ${rules.length} rules pass${condition}.`);
}

/** Creates the table row of a rule. `ends` is the 90 % interval of its value over the possible grooves. */
function ruleRow({ rule, unit, value, must_be: must, limit, margin, passes, source, remedy }, ends) {
  const cell = (words) => html("td", { class: "number" }, words);
  const remedies = remedy ? html("div", { class: "small faint" }, `Remedies: ${remedy}.`) : null;
  return html(
    "tr",
    { class: limit != null && passes === false ? "failed" : null },
    html("th", { scope: "row" }, rule, remedies),
    cell(`${number(value)}${interval(ends)} ${unitOf(unit)}`.trim()),
    cell(limit == null ? "" : `${must === ">=" ? "≥" : "≤"} ${number(limit)}`),
    cell(margin == null ? "" : `${Number((100 / margin).toPrecision(2))} %`),
    html("td", {}, limit == null ? "no requirement" : passMark(passes)),
    html("td", { class: "small source" }, source),
  );
}

function passMark(passes) {
  if (passes == null) return html("span", { class: "undecided" }, "? undecided");
  return passes ? html("span", { class: "pass" }, "✓") : html("span", { class: "fail" }, "✗ FAIL");
}
