// Cross section of the grooves through the center of a ball, to scale.

import { html, svg, text, picture, path, number, measured, legend, none, narrow } from "bsm/draw";

const DEG = Math.PI / 180;

export function showSection(host, given, result) {
  // If the groove is estimated, the result contains the estimated inputs.
  const entries = { ...given, ...result.inputs };
  const ball = entries.ball_diameter_mm;
  if (!ball) {
    host.replaceChildren(none("To draw the section, give ball_diameter_mm."));
    return;
  }
  const width = narrow() ? 340 : 460;
  const height = narrow() ? 320 : 360;
  const r = ball / 2;
  const section = result.section;
  const k = 92 / r;
  const at = ([x, y]) => [width / 2 + k * x, height / 2 - k * y];
  const body = (points, far) => {
    const inside = points.filter(([x]) => Math.abs(x) * k < width);
    return `${path([[-width / k, inside[0][1]], ...inside, [width / k, inside.at(-1)[1]]].map(at))}V${far}H${-width}Z`;
  };
  const clip = svg(
    "clipPath",
    { id: "section-clip" },
    svg("rect", { x: 0, y: 0, width: width, height: height }),
  );
  const metal = { fill: "var(--metal)", stroke: "var(--metal-edge)", "clip-path": "url(#section-clip)" };
  const grooves = section
    ? [
        svg("path", { d: body(section.nut, -50), ...metal }),
        svg("path", { d: body(section.screw, height + 50), ...metal }),
      ]
    : [];
  // The nut is drawn above the ball, so its contact is at the top. The contact with the screw is on the opposite side.
  const places = [
    ["nut", -1, 1, "--c1"],
    ["screw", 1, -1, "--c2"],
  ];
  const marks = [];
  const start = section?.contact_angle_deg ?? entries.contact_angle_deg;
  const end = (angle, [x, y], reach) =>
    at([x * Math.sin(angle * DEG) * reach, y * Math.cos(angle * DEG) * reach]);
  if (start != null) {
    const [a, b] = [end(start, [-1, 1], 1.75 * r), end(start, [1, -1], 1.75 * r)];
    marks.push(
      svg("path", { d: path([a, b]), stroke: "var(--faint)", "stroke-dasharray": "5 4", fill: "none" }),
    );
  }
  const loads = ["nut", "screw", "unloaded_flank"].map((name) => result[`${name}_normal_load_N`] ?? 0);
  const most = Math.max(...loads, 1e-300);
  const said = [];
  const arrow = ([x1, y1], [x2, y2], paint) => {
    const a = Math.atan2(y2 - y1, x2 - x1);
    const tip = (turn) => [x2 - 9 * Math.cos(a + turn), y2 - 9 * Math.sin(a + turn)];
    return svg("path", {
      d: `${path([
        [x1, y1],
        [x2, y2],
      ])}${path([tip(0.4), [x2, y2], tip(-0.4)])}`,
      stroke: paint,
      "stroke-width": 2.2,
      fill: "none",
    });
  };
  for (const [name, x, y, paint] of [...places, ["unloaded_flank", 1, 1, "--c4"]]) {
    const load = result[`${name}_normal_load_N`];
    const angle =
      name === "unloaded_flank" ? result.nut_contact_angle_deg : result[`${name}_contact_angle_deg`];
    if (load == null || angle == null) continue;
    const a = result[`${name}_ellipse_a_mm`];
    const color = `var(${paint})`;
    if (a != null) {
      const half = Math.asin(Math.min(a / r, 1)) / DEG;
      const arc = [];
      for (let i = 0; i <= 24; i += 1) arc.push(end(angle - half + (2 * half * i) / 24, [x, y], r));
      marks.push(
        svg("path", {
          d: path(arc),
          stroke: color,
          "stroke-width": 6,
          fill: "none",
          "stroke-linecap": "butt",
        }),
      );
      marks.push(
        svg("path", {
          d: path([end(angle - half, [x, y], r), at([0, 0]), end(angle + half, [x, y], r)]),
          stroke: color,
          "stroke-width": 1,
          fill: "none",
          opacity: 0.55,
        }),
      );
    }
    const tip = end(angle, [x, y], r);
    const length = (narrow() ? 0.6 : 1) * (18 + 62 * (load / most));
    const far = [
      tip[0] + ((tip[0] - width / 2) / (k * r)) * length,
      tip[1] + ((tip[1] - height / 2) / (k * r)) * length,
    ];
    marks.push(arrow(far, tip, color), svg("circle", { cx: tip[0], cy: tip[1], r: 3, fill: color }));
    said.push([name === "unloaded_flank" ? "far flank" : name, angle, load, a, color, far]);
  }
  const labels = said.flatMap(([name, angle, load, , color, far]) => {
    const left = far[0] < width / 2;
    const up = far[1] < height / 2;
    const x = left ? 8 : width - 8;
    const y = up ? 22 : height - 30;
    const anchor = left ? "start" : "end";
    const halo = {
      "text-anchor": anchor,
      style: `fill:${color};font-weight:600;paint-order:stroke;stroke:var(--metal);stroke-width:4px`,
    };
    return [
      text(x, y, `${name}: ${measured(load, "N")}`, halo),
      text(x, y + 17, `at ${number(angle)}°`, halo),
    ];
  });
  const words = said
    .map(
      ([name, angle, load, a]) =>
        `${name} contact at ${number(angle)} degrees under ${measured(load, "N")}${a == null ? "" : `, ellipse ${measured(2 * a, "mm")} wide`}`,
    )
    .join("; ");
  host.replaceChildren(
    picture(
      width,
      height,
      `Section of ball and grooves. Without load the contact angle is ${number(start)} degrees; ${words}.`,
      clip,
      ...grooves,
      svg("circle", {
        cx: width / 2,
        cy: height / 2,
        r: k * r,
        fill: "var(--steel)",
        "fill-opacity": 0.55,
        stroke: "var(--ink)",
      }),
      svg("path", {
        d: path([at([-0.12 * r, 0]), at([0.12 * r, 0])]) + path([at([0, -0.12 * r]), at([0, 0.12 * r])]),
        stroke: "var(--ink)",
      }),
      ...marks,
      ...labels,
      ...(section
        ? [
            text(width / 2, 16, "nut", { "text-anchor": "middle", class: "faint" }),
            text(width / 2, height - 8, "screw", { "text-anchor": "middle", class: "faint" }),
          ]
        : []),
    ),
    legend([
      ["contact angle without load", "var(--faint)", "dash"],
      ["nut", "var(--c1)"],
      ["screw", "var(--c2)"],
      ...(said.some(([name]) => name === "far flank") ? [["far flank", "var(--c4)"]] : []),
    ]),
    html(
      "p",
      { class: "small faint" },
      section
        ? `To scale. The thick arcs show the widths of the contact ellipses: ${["nut", "screw"]
            .map((name) =>
              result[`${name}_ellipse_a_mm`] == null
                ? "not calculated by this model"
                : `${name} ${measured(2 * result[`${name}_ellipse_a_mm`], "mm")}`,
            )
            .filter((w, i, all) => all.indexOf(w) === i)
            .join(
              ", ",
            )}. Conformity ${number(entries.nut_conformity)} (nut), ${number(entries.screw_conformity)} (screw).`
        : "To draw the grooves, give nut_conformity and screw_conformity. Without conformities, the contacts are points.",
    ),
    ...result.section_warnings.map((warning) => html("p", { class: "warn" }, warning)),
  );
}
