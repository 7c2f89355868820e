// The screw in space: its thread, the nut cut open, the balls by their load, and one ball with its motion.

import * as three from "three";
import { OrbitControls } from "three";
import { html, svg, picture, number, brief, none, ramp, rampBar, colour, path } from "bsm/draw";

const DEG = Math.PI / 180, TURN = 2 * Math.PI;
/** Turns of the screw in a second, as shown. */
const SHOWN = 0.1;

/** Sizes of a scene in millimetres. */
function sizes(scene, solved, nut) {
  const ball = scene.ball_diameter_mm, pitch = scene.pitch_circle_diameter_mm, angle = solved.lead_angle_deg;
  if (!ball || !pitch || angle == null) return null;
  const lead = Math.PI * pitch * Math.tan(angle * DEG), starts = scene.starts ?? 1;
  let balls;
  if (nut?.balls) balls = nut.balls.theta_deg.map((theta, i) => ({ theta: theta * DEG, z: nut.balls.z_mm[i], load: Math.max(nut.balls.nut_plus_N[i], nut.balls.nut_minus_N[i]) }));
  else {
    const turn = Math.PI * pitch / Math.cos(angle * DEG), most = Math.max(1, Math.floor(turn / (1.02 * ball)));
    const count = Math.min(Math.round(scene.loaded_balls ?? 0) || most, 600), each = TURN / Math.min(most, scene.loaded_balls_per_turn ?? most);
    balls = Array.from({ length: count }, (_, i) => ({ theta: i * each, z: (i * each * lead) / TURN, load: solved.nut_normal_load_N ?? 1 }));
  }
  const z = balls.map((b) => b.z), middle = (Math.min(...z) + Math.max(...z)) / 2;
  balls = balls.map((b) => ({ ...b, z: b.z - middle, helix: b.theta }));
  const half = (Math.max(...z) - Math.min(...z)) / 2;
  return { ball, pitch, lead, starts, angle: angle * DEG, balls, half, middle, section: solved.section };
}

/** Distance of groove or land from the axis, over the axial distance from the middle of the groove. */
function profile({ ball, pitch, section }, member) {
  const points = section?.[member], side = member === "nut" ? 1 : -1;
  if (!points) { const r = 0.52 * ball; return (s) => pitch / 2 + side * Math.max(Math.abs(s) < r ? Math.sqrt(r * r - s * s) : 0, 0.14 * ball); }
  const half = points.filter(([x]) => x >= 0).sort((a, b) => a[0] - b[0]);
  return (s) => {
    const x = Math.abs(s);
    let i = half.findIndex(([px]) => px >= x);
    if (i <= 0) i = i < 0 ? half.length - 1 : 1;
    const [[x0, y0], [x1, y1]] = [half[i - 1], half[i]];
    return pitch / 2 + y0 + (x1 > x0 ? Math.min(Math.max((x - x0) / (x1 - x0), 0), 1) : 1) * (y1 - y0);
  };
}

/** A surface around the axis whose radius follows the thread. */
function threaded({ lead, starts, middle }, radius, [from, to], [low, high], [around, along]) {
  const step = lead / starts, positions = [], index = [];
  for (let j = 0; j <= along; j += 1) for (let i = 0; i <= around; i += 1) {
    const theta = from + ((to - from) * i) / around, z = low + ((high - low) * j) / along;
    const turns = (z + middle - (lead * theta) / TURN) / step, r = radius((turns - Math.round(turns)) * step);
    positions.push(r * Math.cos(theta), r * Math.sin(theta), z);
    if (i < around && j < along) { const a = j * (around + 1) + i, b = a + around + 1; index.push(a, a + 1, b, b, a + 1, b + 1); }
  }
  const geometry = new three.BufferGeometry();
  geometry.setAttribute("position", new three.BufferAttribute(new Float32Array(positions), 3));
  geometry.setIndex(index); geometry.computeVertexNormals();
  return geometry;
}

export class Space {
  constructor(host) {
    this.host = host; this.one = false; this.time = 0;
    this.playing = !matchMedia("(prefers-reduced-motion: reduce)").matches;
    this.whole = html("button", { type: "button", "aria-pressed": true, onclick: () => this.look(false) }, "Whole screw");
    this.single = html("button", { type: "button", "aria-pressed": false, onclick: () => this.look(true) }, "One ball");
    this.play = html("button", { type: "button", "aria-pressed": this.playing, onclick: () => { this.playing = !this.playing; this.play.setAttribute("aria-pressed", this.playing); this.loop(); } }, "Turn");
    this.stage = html("div", { class: "stage" }); this.words = html("div");
    host.append(html("div", { class: "bar" }, this.whole, this.single, this.play), this.stage, this.words);
    try { this.begin(); } catch { this.renderer = null; this.play.hidden = true; this.single.hidden = true; this.whole.hidden = true; }
  }

  begin() {
    this.canvas = html("canvas", { role: "img", tabindex: "0", "aria-label": "Screw, nut and balls in space" });
    this.renderer = new three.WebGLRenderer({ canvas: this.canvas, antialias: true, alpha: true, powerPreference: "low-power" });
    this.stage.append(this.canvas);
    this.world = new three.Scene();
    this.world.add(new three.HemisphereLight(0xffffff, 0x778899, 1.9), new three.AmbientLight(0xffffff, 0.35));
    const sun = new three.DirectionalLight(0xffffff, 2.2); sun.position.set(1, 1.6, 1.2);
    this.camera = new three.PerspectiveCamera(32, 1.5, 0.1, 10000);
    this.camera.add(sun); this.world.add(this.camera);
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.enablePan = false; this.controls.enableZoom = true;
    this.controls.addEventListener("change", () => { if (!this.running) this.paint(); });
    this.canvas.addEventListener("keydown", (event) => {
      const turn = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] }[event.key];
      if (!turn) return;
      event.preventDefault(); this.turn(...turn);
    });
    new IntersectionObserver(([entry]) => { this.seen = entry.isIntersecting; this.loop(); }).observe(this.canvas);
    new ResizeObserver(() => this.resize()).observe(this.stage);
    document.addEventListener("visibilitychange", () => this.loop());
  }

  turn(side, up) {
    const offset = this.camera.position.clone().sub(this.controls.target), axis = new three.Vector3(0, 1, 0);
    offset.applyAxisAngle(axis, side); offset.applyAxisAngle(new three.Vector3().crossVectors(axis, offset).normalize(), up);
    this.camera.position.copy(this.controls.target).add(offset); this.controls.update(); this.paint();
  }

  look(one) {
    this.one = one;
    this.whole.setAttribute("aria-pressed", !one); this.single.setAttribute("aria-pressed", one);
    this.key = null; this.show(...this.last);
  }

  show(scene, solved, nut) {
    this.last = [scene, solved, nut];
    const found = solved && sizes(scene, solved, nut);
    if (!found) { this.stage.hidden = true; this.words.replaceChildren(none("The picture needs ball_diameter_mm, pitch_circle_diameter_mm and the lead.")); return; }
    this.stage.hidden = false; this.found = found; this.solved = solved;
    const loads = found.balls.map(({ load }) => load), low = Math.min(...loads), high = Math.max(...loads);
    this.part = (load) => (high > low * (1 + 1e-9) + 1e-12 ? (load - low) / (high - low) : 0.6);
    const W = ((scene.screw_speed_rpm ?? 0) * TURN) / 60, slow = W ? Math.abs(W) / (TURN * SHOWN) : 0;
    this.rate = { screw: W ? Math.sign(W) * TURN * SHOWN : TURN * SHOWN, nut: slow ? ((scene.nut_speed_rpm ?? 0) * TURN) / 60 / slow : 0,
      ball: slow && solved.ball_precession_rad_s != null ? solved.ball_precession_rad_s / slow : null,
      omega: solved.ball_omega_t_rad_s == null || !slow ? null : ["t", "n", "b"].map((axis) => solved[`ball_omega_${axis}_rad_s`] / slow) };
    const words = this.describe(found, solved, low, high, slow, Boolean(nut?.balls));
    if (!this.renderer) { this.stage.replaceChildren(drawing(found, this.part, words[0])); this.words.replaceChildren(...words.slice(1)); return; }
    this.canvas.setAttribute("aria-label", words[0]);
    this.words.replaceChildren(...words.slice(1));
    const shape = this.one ? 0 : { ...found, balls: found.balls.map(({ theta, z }) => [theta, z]) };
    const key = JSON.stringify([shape, this.one && [solved.nut_contact_angle_deg, solved.screw_contact_angle_deg, this.rate.omega, solved.nut_normal_load_N], matchMedia("(prefers-color-scheme: dark)").matches]);
    if (key !== this.key) { this.key = key; this.build(); }
    if (!this.one) this.paintLoads();
    if (this.running) return;
    this.loop();
  }

  describe(found, solved, low, high, slow, shared) {
    const speed = slow ? `slowed ${brief(slow)} times` : "speed not given";
    const [, , spins] = solved.shown.contacts.find(([words]) => words === "spin about the normal") ?? [];
    const spin = spins ? ` Spin ${spins[0]} rad/s at the nut, ${spins[1]} at the screw; the ball circles at ${number(solved.ball_precession_rad_s)} rad/s.` : "";
    const label = `Screw of ${number(found.pitch)} millimetres pitch circle with ${found.balls.length} balls of ${number(found.ball)} millimetres, lead ${number(found.lead)} millimetres; loads from ${number(low)} to ${number(high)} newtons`;
    const balls = shared ? rampBar(low, high, "load of a ball, N") : html("p", { class: "small" }, `${found.balls.length === 1 ? "One ball" : `${found.balls.length} balls, each`} under ${number(high)} N: the nut level, with loaded_balls_per_turn and loaded_turns, tells them apart.`);
    const axes = this.one ? html("p", { class: "small faint" }, "Red: axis of rotation of the ball. Grey: helix t, towards the axis n, binormal b. Blue: contact at the nut. Orange: contact at the screw.") : null;
    return [label, ...(this.one ? [] : [balls]), html("p", { class: "small faint" }, `Motion ${speed}.${spin} Drag or use the arrow keys to look around.`), ...(axes ? [axes] : [])];
  }

  build() {
    for (const child of [...this.world.children]) if (child.userData.made) { this.world.remove(child); child.traverse?.((part) => { part.geometry?.dispose(); part.material?.dispose(); }); }
    const add = (object) => { object.userData.made = true; this.world.add(object); return object; };
    if (this.one) this.buildOne(add); else this.buildWhole(add);
    this.resize();
  }

  metal(name, more = {}) { return new three.MeshStandardMaterial({ color: new three.Color(colour(name)), metalness: 0.35, roughness: 0.42, side: three.DoubleSide, ...more }); }

  buildWhole(add) {
    const f = this.found, steel = this.metal("steel"), reach = f.half + 0.8 * f.lead + 0.6 * f.ball, end = reach + Math.max(1.2 * f.lead, 0.6 * f.pitch);
    const along = (length) => Math.min(700, Math.ceil((length / (f.lead / f.starts)) * 46));
    this.screw = add(new three.Group());
    this.screw.add(new three.Mesh(threaded(f, profile(f, "screw"), [0, TURN], [-end, end], [120, along(2 * end)]), steel));
    for (const z of [-end, end]) { const cap = new three.Mesh(new three.CylinderGeometry(f.pitch / 2 - 0.35 * f.ball, f.pitch / 2 - 0.35 * f.ball, 0.02, 64), steel); cap.rotation.x = Math.PI / 2; cap.position.z = z; this.screw.add(cap); }
    // The nut, open on the side of the viewer.
    const open = [0.42 * Math.PI, 1.62 * Math.PI], inner = profile(f, "nut"), outer = f.pitch / 2 + 1.55 * f.ball, metal = this.metal("metal", { metalness: 0.15 });
    this.shell = add(new three.Group());
    const n = along(2 * reach);
    this.shell.add(new three.Mesh(threaded(f, inner, open, [-reach, reach], [90, n]), metal), new three.Mesh(threaded(f, () => outer, open, [-reach, reach], [60, 2]), metal));
    for (const theta of open) this.shell.add(new three.Mesh(wall(f, inner, outer, theta, reach, n), this.metal("metal-edge", { metalness: 0 })));
    for (const z of [-reach, reach]) this.shell.add(new three.Mesh(ring(f, inner, outer, open, z), metal));
    const balls = f.balls;
    this.balls = add(new three.InstancedMesh(new three.SphereGeometry(f.ball / 2, 24, 16), new three.MeshStandardMaterial({ metalness: 0.1, roughness: 0.35 }), balls.length));
    const gap = balls.length > 1 ? Math.abs(balls[1].theta - balls[0].theta) : TURN / 12;
    this.gap = gap > 0 ? gap : TURN / 12;
    const size = Math.hypot(end, outer), away = size * 3.1;
    if (this.placed !== size) { this.camera.position.set(0.62, 0.42, 0.66).setLength(away); this.controls.target.set(0, 0, 0); this.placed = size; }
    this.controls.minDistance = outer; this.controls.maxDistance = 12 * size; this.camera.far = 40 * size; this.camera.near = size / 200;
  }

  paintLoads() {
    const paint = new three.Color();
    this.found.balls.forEach((ball, i) => this.balls.setColorAt(i, paint.set(`rgb(${ramp(this.part(ball.load)).join(",")})`)));
    this.balls.instanceColor.needsUpdate = true;
  }

  buildOne(add) {
    const r = 1, omega = this.rate.omega, s = this.solved;
    // Axes of the picture: t to the viewer's left, b up, n to the right and back.
    const frame = { t: new three.Vector3(0, 0, 1), n: new three.Vector3(0, -1, 0), b: new three.Vector3(1, 0, 0) };
    const mix = ([t, n, b]) => frame.t.clone().multiplyScalar(t).addScaledVector(frame.n, n).addScaledVector(frame.b, b);
    const rod = (direction, length, paint, thick = 0.035, head = true) => {
      const group = add(new three.Group()), material = new three.MeshStandardMaterial({ color: new three.Color(paint), roughness: 0.6 });
      const shaft = new three.Mesh(new three.CylinderGeometry(thick, thick, length, 12), material); shaft.position.y = length / 2;
      group.add(shaft);
      if (head) { const tip = new three.Mesh(new three.CylinderGeometry(0, thick * 3, thick * 7, 16), material); tip.position.y = length; group.add(tip); }
      group.quaternion.setFromUnitVectors(new three.Vector3(0, 1, 0), direction.clone().normalize());
      return group;
    };
    this.globe = add(new three.Group());
    this.globe.add(new three.Mesh(new three.SphereGeometry(r, 48, 32), this.metal("steel", { transparent: true, opacity: 0.88 })));
    // Circles on the ball show that it turns.
    const axis = omega && Math.hypot(...omega) > 0 ? mix(omega).normalize() : frame.b;
    const circle = (k) => { const points = []; for (let i = 0; i <= 96; i += 1) { const a = (TURN * i) / 96; points.push(1.004 * Math.cos(a) * Math.cos(k), 1.004 * Math.sin(a), 1.004 * Math.cos(a) * Math.sin(k)); } const g = new three.BufferGeometry(); g.setAttribute("position", new three.BufferAttribute(new Float32Array(points), 3)); return new three.Line(g, new three.LineBasicMaterial({ color: new three.Color(colour("ink")) })); };
    const lines = new three.Group(); for (let k = 0; k < 4; k += 1) lines.add(circle((k * Math.PI) / 4));
    lines.quaternion.setFromUnitVectors(new three.Vector3(0, 1, 0), axis); this.globe.add(lines);
    this.axis = axis;
    if (omega) { rod(axis, 1.75, colour("hot"), 0.045); rod(axis.clone().negate(), 1.4, colour("hot"), 0.03, false); }
    for (const direction of Object.values(frame)) rod(direction, 1.5, colour("faint"), 0.014);
    for (const [name, side, paint] of [["nut", -1, "c1"], ["screw", 1, "c2"]]) {
      const angle = s[`${name}_contact_angle_deg`];
      if (angle == null) continue;
      const place = mix([0, side * Math.cos(angle * DEG), side * Math.sin(angle * DEG)]);
      rod(place, 1.55, colour(paint), 0.03, false);
      const mark = add(new three.Mesh(new three.SphereGeometry(0.09, 20, 14), new three.MeshStandardMaterial({ color: new three.Color(colour(paint)) }))); mark.position.copy(place);
    }
    if (this.placed !== "one") { this.camera.position.set(2.6, 1.6, 6); this.controls.target.set(0, 0, 0); this.placed = "one"; }
    this.controls.minDistance = 2; this.controls.maxDistance = 20; this.camera.near = 0.05; this.camera.far = 100;
  }

  resize() {
    if (!this.renderer || !this.found) return;
    const width = this.stage.clientWidth, height = Math.round(Math.min(380, 0.72 * width));
    if (!width) return;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2)); this.renderer.setSize(width, height, false); this.canvas.style.height = `${height}px`;
    this.camera.aspect = width / height; this.camera.updateProjectionMatrix(); this.controls.update(); this.paint();
  }

  /** Turns while it is looked at. */
  loop() {
    const wanted = Boolean(this.renderer && this.playing && this.seen && !document.hidden && this.found);
    if (this.renderer && !wanted) this.paint();
    if (wanted === Boolean(this.running)) return;
    this.running = wanted;
    let last = performance.now();
    const frame = (now) => {
      if (!this.running) return;
      this.time += Math.min(now - last, 100) / 1000; last = now;
      this.paint(); requestAnimationFrame(frame);
    };
    if (wanted) requestAnimationFrame(frame);
  }

  paint() {
    if (!this.found || !this.renderer || !this.key) return;
    const { time, rate, found } = this;
    if (this.one) { if (rate.omega) this.globe.quaternion.setFromAxisAngle(this.axis, Math.hypot(...rate.omega) * time); }
    else {
      this.screw.rotation.z = rate.screw * time; this.shell.rotation.z = rate.nut * time;
      // Balls run on along the helix of the nut, each to the place of the next.
      const run = (((((rate.ball ?? rate.screw / 2) - rate.nut) * time) % this.gap) + this.gap) % this.gap, place = new three.Matrix4();
      found.balls.forEach((ball, i) => { const theta = ball.theta + run + rate.nut * time; place.makeTranslation((found.pitch / 2) * Math.cos(theta), (found.pitch / 2) * Math.sin(theta), ball.z + (found.lead * run) / TURN); this.balls.setMatrixAt(i, place); });
      this.balls.instanceMatrix.needsUpdate = true;
    }
    this.renderer.render(this.world, this.camera);
  }
}

/** Face of the cut nut. */
function wall({ lead, starts, middle }, inner, outer, theta, reach, n) {
  const step = lead / starts, positions = [], index = [];
  for (let j = 0; j <= n; j += 1) {
    const z = -reach + (2 * reach * j) / n, turns = (z + middle - (lead * theta) / TURN) / step, r = inner((turns - Math.round(turns)) * step);
    for (const radius of [r, outer]) positions.push(radius * Math.cos(theta), radius * Math.sin(theta), z);
    if (j < n) index.push(2 * j, 2 * j + 1, 2 * j + 2, 2 * j + 2, 2 * j + 1, 2 * j + 3);
  }
  return geometryOf(positions, index);
}

/** End of the nut. */
function ring({ lead, starts, middle }, inner, outer, [from, to], z) {
  const step = lead / starts, positions = [], index = [], n = 60;
  for (let i = 0; i <= n; i += 1) {
    const theta = from + ((to - from) * i) / n, turns = (z + middle - (lead * theta) / TURN) / step, r = inner((turns - Math.round(turns)) * step);
    for (const radius of [r, outer]) positions.push(radius * Math.cos(theta), radius * Math.sin(theta), z);
    if (i < n) index.push(2 * i, 2 * i + 1, 2 * i + 2, 2 * i + 2, 2 * i + 1, 2 * i + 3);
  }
  return geometryOf(positions, index);
}

function geometryOf(positions, index) {
  const geometry = new three.BufferGeometry();
  geometry.setAttribute("position", new three.BufferAttribute(new Float32Array(positions), 3));
  geometry.setIndex(index); geometry.computeVertexNormals();
  return geometry;
}

/** Without WebGL: a view from the side. */
function drawing(f, part, label) {
  const width = 460, height = 260, reach = f.half + 1.6 * f.lead, k = Math.min((width - 20) / (2 * reach), (height - 20) / (f.pitch + 3 * f.ball));
  const at = (z, y) => [width / 2 + k * z, height / 2 - k * y], core = f.pitch / 2 - 0.3 * f.ball;
  const rod = svg("g", {}, svg("rect", { x: 4, y: height / 2 - k * core, width: width - 8, height: 2 * k * core, style: "fill:var(--steel)" }));
  const lines = [];
  for (let turn = -Math.ceil(reach / f.lead); turn <= Math.ceil(reach / f.lead); turn += 1) { const points = []; for (let a = 0; a <= 18; a += 1) { const t = Math.PI * (a / 18) - Math.PI / 2; points.push(at(turn * f.lead + (f.lead * t) / TURN, core * Math.sin(t))); } lines.push(svg("path", { d: path(points), fill: "none", stroke: "var(--metal-edge)", "stroke-width": 2 })); }
  const balls = f.balls.filter(({ theta }) => Math.cos(theta) >= -0.05).map(({ theta, z, load }) => { const [x, y] = at(z, (f.pitch / 2) * Math.sin(theta)); return svg("circle", { cx: x, cy: y, r: (k * f.ball) / 2, fill: `rgb(${ramp(part(load)).join(" ")})`, stroke: "var(--ink)", "stroke-width": 0.6 }); });
  return picture(width, height, label, rod, ...lines, ...balls);
}
