// Cross section of the grooves through the center of a ball, to scale.

import { html, svg, text, picture, path, number, measured, legend, none, narrow } from "bsm/draw";

const DEG = Math.PI / 180;

/** Radius of the ball in the picture [px]. */
const RADIUS = 92;

const WITHOUT_GROOVES =
  "To draw the grooves, give nut_conformity and screw_conformity. " +
  "Without conformities, the contacts are points.";

/**
 * Members that touch the ball: the beginning of the names of their results, their name on the page, the signs
 * of the direction to the contact, and their color. The nut is drawn above the ball, so its contact is at the
 * top. The contact with the screw is on the opposite side.
 */
const CONTACTS = [
  { key: "nut", name: "nut", side: [-1, 1], paint: "var(--c1)" },
  { key: "screw", name: "screw", side: [1, -1], paint: "var(--c2)" },
  { key: "unloaded_flank", name: "far flank", side: [1, 1], paint: "var(--c4)" },
];

export function showSection(host, given, result) {
  // If the groove is estimated, the result contains the estimated inputs.
  const entries = { ...given, ...result.inputs };
  const ball = entries.ball_diameter_mm;
  if (!ball) {
    host.replaceChildren(none("To draw the section, give ball_diameter_mm."));
    return;
  }
  const view = viewOf(ball / 2);
  const { width, height, at, toward } = view;
  const { section } = result;
  const start = section?.contact_angle_deg ?? entries.contact_angle_deg;
  const contacts = contactsOf(result);
  const words = contacts.map(({ name, angle, load, a }) => {
    const ellipse = a == null ? "" : `, ellipse ${measured(2 * a, "mm")} wide`;
    return `${name} contact at ${number(angle)} degrees under ${measured(load, "N")}${ellipse}`;
  });
  const unloaded = `Without load the contact angle is ${number(start)} degrees`;
  const label = `Section of ball and grooves. ${unloaded}; ${words.join("; ")}.`;
  const line = [-1, 1].map((side) => toward(start, [side, -side], 1.75));
  const unloadedLine = {
    d: path(line),
    stroke: "var(--faint)",
    "stroke-dasharray": "5 4",
    fill: "none",
  };
  const cross = path([at([-0.12, 0]), at([0.12, 0])]) + path([at([0, -0.12]), at([0, 0.12])]);
  const nameOf = (y, name) => text(width / 2, y, name, { "text-anchor": "middle", class: "faint" });
  host.replaceChildren(
    picture(
      width,
      height,
      label,
      ...(section ? grooves(section, view) : []),
      svg("circle", {
        cx: width / 2,
        cy: height / 2,
        r: RADIUS,
        fill: "var(--steel)",
        "fill-opacity": 0.55,
        stroke: "var(--ink)",
      }),
      svg("path", { d: cross, stroke: "var(--ink)" }),
      start == null ? null : svg("path", unloadedLine),
      ...contacts.flatMap((contact) => marks(contact, view)),
      ...contacts.flatMap((contact) => labels(contact, view)),
      ...(section ? [nameOf(16, "nut"), nameOf(height - 8, "screw")] : []),
    ),
    legend([
      ["contact angle without load", "var(--faint)", "dash"],
      ["nut", "var(--c1)"],
      ["screw", "var(--c2)"],
      ...(contacts.some(({ key }) => key === "unloaded_flank") ? [["far flank", "var(--c4)"]] : []),
    ]),
    html("p", { class: "small faint" }, section ? explanation(entries, result) : WITHOUT_GROOVES),
    ...result.section_warnings.map((warning) => html("p", { class: "warn" }, warning)),
  );
}

/**
 * Returns the size of the picture, and functions that convert positions to places in the picture. `radius` is
 * the radius of the ball [mm]. `at` converts a position in ball radii, and `toward` converts a direction with
 * a contact angle [deg], the signs of a contact and a distance from the center of the ball in ball radii.
 */
function viewOf(radius) {
  const width = narrow() ? 340 : 460;
  const height = narrow() ? 320 : 360;
  const at = ([x, y]) => [width / 2 + RADIUS * x, height / 2 - RADIUS * y];
  const toward = (angle, [x, y], distance) =>
    at([x * Math.sin(angle * DEG) * distance, y * Math.cos(angle * DEG) * distance]);
  return { radius, width, height, at, toward };
}

/** Returns the contacts that carry a load. `length` is the length of the arrow of the load [px]. */
function contactsOf(result) {
  const loadOf = ({ key }) => result[`${key}_normal_load_N`];
  const most = Math.max(...CONTACTS.map((contact) => loadOf(contact) ?? 0), 1e-300);
  const contacts = CONTACTS.map((contact) => {
    const { key } = contact;
    const load = loadOf(contact);
    // The far flank belongs to the nut and has the same contact angle.
    const angle = result[`${key === "unloaded_flank" ? "nut" : key}_contact_angle_deg`];
    const length = (narrow() ? 0.6 : 1) * (18 + 62 * (load / most));
    return { ...contact, load, angle, a: result[`${key}_ellipse_a_mm`], length };
  });
  return contacts.filter(({ load, angle }) => load != null && angle != null);
}

/** Draws the grooves of nut and screw, clipped to the picture. */
function grooves(section, { radius, width, height, at }) {
  const body = (points, far) => {
    const inRadii = points.map(([x, y]) => [x / radius, y / radius]);
    const inside = inRadii.filter(([x]) => Math.abs(x) * RADIUS < width);
    const edge = width / RADIUS;
    const outline = [[-edge, inside[0][1]], ...inside, [edge, inside.at(-1)[1]]];
    return `${path(outline.map(at))}V${far}H${-width}Z`;
  };
  const metal = { fill: "var(--metal)", stroke: "var(--metal-edge)", "clip-path": "url(#section-clip)" };
  return [
    svg("clipPath", { id: "section-clip" }, svg("rect", { x: 0, y: 0, width, height })),
    svg("path", { d: body(section.nut, -50), ...metal }),
    svg("path", { d: body(section.screw, height + 50), ...metal }),
  ];
}

/** Returns the place of a contact, and the place at which the arrow of its load begins. */
function arrowOf({ angle, side, length }, { width, height, toward }) {
  const tip = toward(angle, side, 1);
  const from = [width / 2, height / 2].map((center, i) => tip[i] + ((tip[i] - center) / RADIUS) * length);
  return { tip, from };
}

/** Draws the width of the contact ellipse, if it is known, and the load of a contact. */
function marks(contact, view) {
  const { angle, side, a, paint } = contact;
  const { radius, at, toward } = view;
  const list = [];
  if (a != null) {
    const half = Math.asin(Math.min(a / radius, 1)) / DEG;
    const arc = Array.from({ length: 25 }, (_, i) => toward(angle - half + (2 * half * i) / 24, side, 1));
    const sector = [arc[0], at([0, 0]), arc.at(-1)];
    list.push(
      svg("path", { d: path(arc), stroke: paint, "stroke-width": 6, fill: "none", "stroke-linecap": "butt" }),
      svg("path", { d: path(sector), stroke: paint, "stroke-width": 1, fill: "none", opacity: 0.55 }),
    );
  }
  const { tip, from } = arrowOf(contact, view);
  const direction = Math.atan2(tip[1] - from[1], tip[0] - from[0]);
  const barb = (turn) => [tip[0] - 9 * Math.cos(direction + turn), tip[1] - 9 * Math.sin(direction + turn)];
  const arrow = path([from, tip]) + path([barb(0.4), tip, barb(-0.4)]);
  list.push(
    svg("path", { d: arrow, stroke: paint, "stroke-width": 2.2, fill: "none" }),
    svg("circle", { cx: tip[0], cy: tip[1], r: 3, fill: paint }),
  );
  return list;
}

/** Writes the load and the contact angle of a contact into the corner of the picture next to its arrow. */
function labels(contact, view) {
  const { name, angle, load, paint } = contact;
  const { from } = arrowOf(contact, view);
  const isLeft = from[0] < view.width / 2;
  const x = isLeft ? 8 : view.width - 8;
  const y = from[1] < view.height / 2 ? 22 : view.height - 30;
  const halo = {
    "text-anchor": isLeft ? "start" : "end",
    style: `fill:${paint};font-weight:600;paint-order:stroke;stroke:var(--metal);stroke-width:4px`,
  };
  return [text(x, y, `${name}: ${measured(load, "N")}`, halo), text(x, y + 17, `at ${number(angle)}°`, halo)];
}

/** Explains the picture and states the widths of the contact ellipses. */
function explanation(entries, result) {
  const widths = ["nut", "screw"].map((name) => {
    const a = result[`${name}_ellipse_a_mm`];
    return a == null ? "not calculated by this model" : `${name} ${measured(2 * a, "mm")}`;
  });
  const [nut, screw] = [entries.nut_conformity, entries.screw_conformity].map(number);
  return (
    `To scale. The thick arcs show the widths of the contact ellipses: ${[...new Set(widths)].join(", ")}. ` +
    `Conformity ${nut} (nut), ${screw} (screw).`
  );
}
