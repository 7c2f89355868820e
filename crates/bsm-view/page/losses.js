// The components of the power loss.

import { html, svg, text, picture, number, numberOf, interval, brief, none, legend, narrow } from "bsm/draw";
import { OUTPUT } from "bsm/source";

const OILED = [
  ["sliding_power_W", "--c1"],
  ["rolling_power_W", "--c3"],
  ["seal_power_W", "--c5"],
  ["ball_contact_power_W", "--c4"],
  ["return_power_W", "--c2"],
  ["drag_power_W", "--c6"],
];
const DRY = [
  ["center", "sliding of the contact center"],
  ["spin", "spin"],
  ["curvature", "curvature of the contact surface"],
];
const CONTACTS = [
  ["nut", "--c1"],
  ["screw", "--c2"],
  ["far flank", "--c4", "unloaded_flank"],
];

export function showLosses(host, result, slip) {
  const total = result.dissipated_power_W;
  if (total == null) {
    host.replaceChildren(
      none(
        result.status === "converged"
          ? `Model ${result.model} calculates an efficiency of ${number(result.efficiency)}, but no powers. Powers require the speed, the axial load and the number of loaded balls.`
          : "There is no solution, so there are no losses to show.",
      ),
    );
    return;
  }
  let rows;
  const endsOf = (answer, name) => answer.groove_estimate?.intervals?.[name];
  if (result.sliding_power_W != null) {
    rows = OILED.map(([name, paint]) => [
      OUTPUT.get(name).label,
      result[name] ?? 0,
      paint,
      endsOf(result, name),
    ]).filter(([, value]) => value !== 0);
  } else if (slip.error) {
    host.replaceChildren(
      html("p", {}, `${numberOf(result, "dissipated_power_W")} W in total.`),
      none(slip.error),
    );
    return;
  } else {
    rows = DRY.flatMap(([name, words]) =>
      CONTACTS.map(([contact, paint, key = contact]) => {
        const own = `${key}_${name}_power_W`;
        return [`${words}, ${contact}`, slip[own], paint, endsOf(slip, own)];
      }),
    ).filter(([, value]) => value != null && Math.abs(value) > 1e-9 * total);
  }
  // On a phone, the labels are above the bars. Otherwise, the longest label determines the start of the bars (7 px per letter).
  const phone = narrow();
  const longest = Math.max(31, ...rows.map(([words]) => words.length));
  const [left, width, row, top, base] = phone ? [2, 340, 40, 18, 13] : [8 + 7 * longest, 560, 27, 4, 17];
  const high = Math.max(total, ...rows.map(([, value]) => value));
  const low = Math.min(0, ...rows.map(([, value]) => value));
  // The numbers are to the right of the bars. Numbers with intervals need more space.
  const room = result.groove_estimate ? 180 : 78;
  const x = (v) => left + ((v - low) / (high - low || 1)) * (width - left - room - 0.12 * (width - left));
  const bar = (y, value, paint) =>
    svg(
      "g",
      {},
      svg("rect", {
        x: Math.min(x(0), x(value)),
        y,
        width: Math.max(Math.abs(x(value) - x(0)), 0.8),
        height: 18,
        fill: paint,
        rx: 2,
      }),
    );
  // If the case has a lubricant, the line shows the 90 % interval. With a friction coefficient, it shows the error bound.
  const oil = result.sliding_power_W != null;
  const contacts = oil ? result.sliding_power_W + result.rolling_power_W : 0;
  const ratio = result.band?.contact_loss_ratio;
  const drawn = ratio && [ratio.low, ratio.high].map((end) => total + (end - 1) * contacts);
  const bound = oil ? null : result.loss_error_bound;
  const ends = drawn ?? (bound == null ? null : [Math.max(total * (1 - bound), 0), total * (1 + bound)]);
  const y = rows.length * row + top;
  const far = ends ? Math.min(ends[1], high * 1.12) : 0;
  const lines = [...rows, ["total", total, null, endsOf(result, "dissipated_power_W")]].map(
    ([words, value, paint, estimated], i) => [
      text(phone ? left : left - 8, i * row + base, words, {
        "text-anchor": phone ? "start" : "end",
        style: paint ? null : "font-weight:600",
      }),
      bar(i * row + top, value, `var(${paint ?? "--steel"})`),
      text(
        Math.max(x(paint ? value : Math.max(value, far)), x(0)) + 6,
        i * row + top + 13,
        `${number(value)}${interval(estimated)} W`,
      ),
    ],
  );
  const whisker = ends
    ? svg("path", { d: `M${x(ends[0])} ${y + 9}H${x(far)}`, stroke: "var(--ink)", "stroke-width": 2 })
    : null;
  const chart = picture(
    width,
    (rows.length + 1) * row + 6,
    `Loss in watts: ${rows.map(([words, value]) => `${words} ${number(value)}`).join("; ")}; total ${number(total)}`,
    ...lines.flat(),
    ...(whisker ? [whisker] : []),
  );
  const parts = [
    result.sliding_power_W == null
      ? legend(
          CONTACTS.filter(([name]) => rows.some(([words]) => words.endsWith(name))).map(([name, paint]) => [
            name,
            `var(${paint})`,
          ]),
        )
      : null,
    html(
      "p",
      { class: "small" },
      html("strong", {}, `${numberOf(result, "dissipated_power_W")} W of heat`),
      `, ${number((100 * total) / result.input_power_W)} % of the input power of ${numberOf(result, "input_power_W")} W.`,
      drawn
        ? ` The line shows the 90 % interval for the uncertain oil properties, ${number(drawn[0])} to ${number(drawn[1])} W.`
        : bound != null
          ? ` The line shows the error bound, ${brief(Number((100 * bound).toPrecision(2)))} %.`
          : "",
    ),
  ];
  host.replaceChildren(html("div", { class: "split" }, chart, html("div", {}, parts.filter(Boolean))));
}
