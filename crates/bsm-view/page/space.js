// The screw in 3D: the thread, the cut-open nut, the balls colored by load, and the motion of one ball.

import * as three from "three";
import { OrbitControls } from "three";
import {
  html,
  svg,
  picture,
  number,
  shown,
  measured,
  labeled,
  brief,
  none,
  ramp,
  rampBar,
  color,
  path,
} from "bsm/draw";

const DEG = Math.PI / 180;
const TURN = 2 * Math.PI;
/** Speed of the faster of screw and nut in the animation [rev/s]. */
const SHOWN = 0.1;
/** Frame time above which a machine counts as slow [ms]. */
const QUICK = 20;
/** Pause between frames on a slow machine [ms]. */
const PAUSE = 120;
/** Explains the colors of the picture of one ball. */
const COLORS =
  "Red: axis of rotation of the ball. Gray: tangent t of the helix, normal n toward the screw axis, " +
  "binormal b. Blue: contact at the nut. Orange: contact at the screw.";
/**
 * Axes of the picture of one ball: t points to the left of the viewer, b points up, and n points to the right
 * and away.
 */
const FRAME = {
  t: new three.Vector3(0, 0, 1),
  n: new three.Vector3(0, -1, 0),
  b: new three.Vector3(1, 0, 0),
};

/** Returns the dimensions of a case in millimeters. */
function sizes(given, solved, nut) {
  // If the groove is estimated, the result contains the estimated inputs.
  const entries = { ...given, ...solved.inputs };
  const ball = entries.ball_diameter_mm;
  const pitch = entries.pitch_circle_diameter_mm;
  const angle = solved.lead_angle_deg;
  if (!ball || !pitch || angle == null) return null;
  const lead = Math.PI * pitch * Math.tan(angle * DEG);
  const starts = entries.starts ?? 1;
  let balls;
  if (nut?.balls) {
    const [theta, z, plus, minus] = ["theta_deg", "z_mm", "nut_plus_N", "nut_minus_N"].map(
      (name) => nut.balls[name].values,
    );
    balls = theta.map((theta, i) => ({ theta: theta * DEG, z: z[i], load: Math.max(plus[i], minus[i]) }));
  } else {
    const turn = (Math.PI * pitch) / Math.cos(angle * DEG);
    const most = Math.max(1, Math.floor(turn / (1.02 * ball)));
    const count = Math.min(Math.round(entries.loaded_balls ?? 0) || most, 600);
    const each = TURN / Math.min(most, entries.loaded_balls_per_turn ?? most);
    balls = Array.from({ length: count }, (_, i) => ({
      theta: i * each,
      z: (i * each * lead) / TURN,
      load: solved.nut_normal_load_N ?? 1,
    }));
  }
  const z = balls.map((b) => b.z);
  const middle = (Math.min(...z) + Math.max(...z)) / 2;
  balls = balls.map((b) => ({ ...b, z: b.z - middle, helix: b.theta }));
  const half = (Math.max(...z) - Math.min(...z)) / 2;
  return { ball, pitch, lead, starts, angle: angle * DEG, balls, half, middle, section: solved.section };
}

/**
 * Returns the radius of the groove or land as a function of the axial distance from the middle of the groove,
 * and the position of the edge.
 */
function profile({ ball, pitch, section }, member) {
  const points = section?.[member];
  const side = member === "nut" ? 1 : -1;
  if (!points) {
    const r = 0.52 * ball;
    return {
      edge: 0.5 * ball,
      at: (s) => pitch / 2 + side * Math.max(Math.abs(s) < r ? Math.sqrt(r * r - s * s) : 0, 0.14 * ball),
    };
  }
  const half = points.filter(([x]) => x >= 0).sort((a, b) => a[0] - b[0]);
  return {
    edge: half.at(-2)[0],
    at: (s) => {
      const x = Math.abs(s);
      let i = half.findIndex(([px]) => px >= x);
      if (i <= 0) i = i < 0 ? half.length - 1 : 1;
      const [[x0, y0], [x1, y1]] = [half[i - 1], half[i]];
      return pitch / 2 + y0 + (x1 > x0 ? Math.min(Math.max((x - x0) / (x1 - x0), 0), 1) : 1) * (y1 - y0);
    },
  };
}

/**
 * A thread surface between two ends, made of lines along the helix. The lines are close together where the
 * groove is steep.
 */
class Thread {
  constructor({ lead, starts, middle }, { edge, at }, [low, high]) {
    const step = lead / starts;
    const most = Math.abs(step) / 2;
    const deep = Math.min(edge, most);
    const lines = Array.from({ length: 13 }, (_, i) => deep * Math.sin(((i - 6) * Math.PI) / 12));
    // A narrow strip next to the edge of the groove keeps the shading of the land uniform.
    const land = Math.min(deep + 0.03 * most, most);
    this.offsets = [-land, ...lines, land].map((s) => [s, at(s)]);
    Object.assign(this, { step, lead, middle, at, low, high });
    const turns = [low, high].flatMap((z) =>
      [0, TURN].map((theta) => (z + middle - (lead * theta) / TURN) / step),
    );
    this.turns = [Math.floor(Math.min(...turns)) - 1, Math.ceil(Math.max(...turns)) + 1];
  }

  /** Returns the radius at a position. */
  radius(theta, z) {
    const turns = (z + this.middle - (this.lead * theta) / TURN) / this.step;
    return this.at((turns - Math.round(turns)) * this.step);
  }

  /**
   * Returns the positions along the axis at an angle, with their radii. The number of positions is the same
   * for every angle.
   */
  places(theta) {
    const list = [];
    const { low, high } = this;
    for (let k = this.turns[0]; k <= this.turns[1]; k += 1) {
      for (const [s, r] of this.offsets) {
        const z = k * this.step + s - this.middle + (this.lead * theta) / TURN;
        list.push(
          z < low ? [low, this.radius(theta, low)] : z > high ? [high, this.radius(theta, high)] : [z, r],
        );
      }
    }
    return list;
  }

  surface([from, to], around) {
    const positions = [];
    const index = [];
    let count = 0;
    for (let i = 0; i <= around; i += 1) {
      const theta = from + ((to - from) * i) / around;
      const places = this.places(theta);
      count = places.length;
      for (const [z, r] of places) positions.push(r * Math.cos(theta), r * Math.sin(theta), z);
    }
    for (let i = 0; i < around; i += 1) {
      for (let j = 0; j + 1 < count; j += 1) {
        const a = i * count + j;
        const b = a + count;
        index.push(a, b, a + 1, a + 1, b, b + 1);
      }
    }
    return geometryOf(positions, index);
  }

  /** Creates the cut face of the nut. */
  wall(theta, outer) {
    const positions = [];
    const index = [];
    this.places(theta).forEach(([z, r], j) => {
      for (const radius of [r, outer]) positions.push(radius * Math.cos(theta), radius * Math.sin(theta), z);
      if (j) index.push(2 * j - 2, 2 * j - 1, 2 * j, 2 * j, 2 * j - 1, 2 * j + 1);
    });
    return geometryOf(positions, index);
  }

  /** Creates an end face of the nut. */
  ring([from, to], outer, z) {
    const positions = [];
    const index = [];
    const n = 60;
    for (let i = 0; i <= n; i += 1) {
      const theta = from + ((to - from) * i) / n;
      const r = this.radius(theta, z);
      for (const radius of [r, outer]) positions.push(radius * Math.cos(theta), radius * Math.sin(theta), z);
      if (i < n) index.push(2 * i, 2 * i + 1, 2 * i + 2, 2 * i + 2, 2 * i + 1, 2 * i + 3);
    }
    return geometryOf(positions, index);
  }
}

export class Space {
  constructor(host) {
    this.host = host;
    this.one = this.held = false;
    this.time = 0;
    // The machine counts as slow until the time of a frame has been measured.
    this.slow = true;
    this.playing = false;
    this.whole = html(
      "button",
      { type: "button", "aria-pressed": true, onclick: () => this.look(false) },
      "Whole screw",
    );
    this.single = html(
      "button",
      { type: "button", "aria-pressed": false, onclick: () => this.look(true) },
      "One ball",
    );
    this.play = html(
      "button",
      {
        type: "button",
        "aria-pressed": this.playing,
        onclick: () => {
          this.playing = !this.playing;
          this.play.setAttribute("aria-pressed", this.playing);
          this.loop();
        },
      },
      "Turn",
    );
    this.stage = html("div", { class: "stage" });
    this.words = html("div");
    host.append(html("div", { class: "bar" }, this.whole, this.single, this.play), this.stage, this.words);
    try {
      this.begin();
    } catch {
      this.renderer = null;
      this.play.hidden = true;
      this.single.hidden = true;
      this.whole.hidden = true;
    }
  }

  begin() {
    this.canvas = html("canvas", { role: "img", tabindex: "0", "aria-label": "Screw, nut and balls in 3D" });
    // The drawing buffer is kept, so that the picture can be printed.
    this.renderer = new three.WebGLRenderer({
      canvas: this.canvas,
      antialias: true,
      alpha: true,
      powerPreference: "low-power",
      preserveDrawingBuffer: true,
    });
    this.stage.append(this.canvas);
    this.world = new three.Scene();
    this.world.add(
      new three.HemisphereLight(0xffffff, 0x778899, 1.9),
      new three.AmbientLight(0xffffff, 0.35),
    );
    const sun = new three.DirectionalLight(0xffffff, 2.2);
    sun.position.set(1, 1.6, 1.2);
    this.camera = new three.PerspectiveCamera(32, 1.5, 0.1, 10000);
    this.camera.add(sun);
    this.world.add(this.camera);
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.enablePan = false;
    this.controls.enableZoom = true;
    this.controls.addEventListener("change", () => {
      if (!this.running) this.paint();
    });
    this.canvas.addEventListener("keydown", (event) => {
      const turn = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] }[
        event.key
      ];
      if (!turn) return;
      event.preventDefault();
      this.turn(...turn);
    });
    new IntersectionObserver(([entry]) => {
      this.seen = entry.isIntersecting;
      this.loop();
    }).observe(this.canvas);
    new ResizeObserver(() => this.resize()).observe(this.stage);
    document.addEventListener("visibilitychange", () => this.loop());
  }

  /** Pauses drawing on a slow machine while inputs change, because updating the numbers has priority. */
  hold(on) {
    if (!this.slow || on === this.held) return;
    this.held = on;
    if (on || !this.last) return;
    this.show(...this.last);
    if (this.renderer && this.key && !this.measured) this.measure();
  }

  /**
   * Measures whether frames are fast enough to follow the sliders. The first frame, which compiles the
   * shaders, is not measured.
   */
  measure() {
    const gl = this.renderer.getContext();
    const began = performance.now();
    this.paint();
    // This call waits until the frame has been drawn.
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
    this.slow = performance.now() - began > QUICK;
    this.measured = true;
    if (!this.slow && !matchMedia("(prefers-reduced-motion: reduce)").matches) this.play.click();
  }

  turn(side, up) {
    const offset = this.camera.position.clone().sub(this.controls.target);
    const axis = new three.Vector3(0, 1, 0);
    offset.applyAxisAngle(axis, side);
    offset.applyAxisAngle(new three.Vector3().crossVectors(axis, offset).normalize(), up);
    this.camera.position.copy(this.controls.target).add(offset);
    this.controls.update();
    this.paint();
  }

  look(one) {
    this.one = one;
    this.whole.setAttribute("aria-pressed", !one);
    this.single.setAttribute("aria-pressed", one);
    this.key = null;
    this.show(...this.last);
  }

  show(entries, solved, nut) {
    this.last = [entries, solved, nut];
    if (this.held) return;
    const found = solved && sizes(entries, solved, nut);
    if (!found) {
      this.stage.hidden = true;
      this.words.replaceChildren(
        none("To draw the picture, give ball_diameter_mm, pitch_circle_diameter_mm and the lead."),
      );
      return;
    }
    this.stage.hidden = false;
    this.found = found;
    this.solved = solved;
    const loads = found.balls.map(({ load }) => load);
    const low = Math.min(...loads);
    const high = Math.max(...loads);
    this.part = (load) => (high > low * (1 + 1e-9) + 1e-12 ? (load - low) / (high - low) : 0.6);
    const [turned, held] = solved.speeds_rpm ?? [0, 0];
    const fastest = Math.max(Math.abs(turned), Math.abs(held));
    const slow = fastest / 60 / SHOWN;
    this.rate = {
      screw: slow ? (turned * TURN) / 60 / slow : TURN * SHOWN,
      nut: slow ? (held * TURN) / 60 / slow : 0,
      ball: slow && solved.ball_precession_rad_s != null ? solved.ball_precession_rad_s / slow : null,
      omega:
        solved.ball_omega_t_rad_s == null || !slow
          ? null
          : ["t", "n", "b"].map((axis) => solved[`ball_omega_${axis}_rad_s`] / slow),
    };
    const words = this.describe(found, solved, low, high, slow, Boolean(nut?.balls));
    if (!this.renderer) {
      this.stage.replaceChildren(drawing(found, this.part, words[0]));
      this.words.replaceChildren(...words.slice(1));
      return;
    }
    this.canvas.setAttribute("aria-label", words[0]);
    this.words.replaceChildren(...words.slice(1));
    const shape = this.one ? 0 : { ...found, balls: found.balls.map(({ theta, z }) => [theta, z]) };
    const key = JSON.stringify([
      shape,
      this.one && [
        solved.nut_contact_angle_deg,
        solved.screw_contact_angle_deg,
        this.rate.omega,
        solved.nut_normal_load_N,
      ],
      matchMedia("(prefers-color-scheme: dark)").matches,
    ]);
    if (key !== this.key) {
      this.key = key;
      this.build();
    }
    if (!this.one) this.paintLoads();
    if (this.running) return;
    this.loop();
  }

  /** Returns the alternative text of the picture, followed by the elements below the picture. */
  describe(found, solved, low, high, slow, shared) {
    const speed = slow ? `slowed ${brief(slow)} times` : "not to scale, because the speed is missing";
    const motion = html(
      "p",
      { class: "small faint" },
      `Motion ${speed}.`,
      "nut_spin_rad_s" in solved.shown.keys ? spinOf(solved) : "",
      " Drag or use the arrow keys to look around.",
    );
    const { balls } = found;
    const [pitch, ball, lead] = [found.pitch, found.ball, found.lead].map((size) => measured(size, "mm"));
    const label =
      `Screw with a pitch circle of ${pitch}, ${balls.length} balls of ${ball} and a lead of ${lead}; ` +
      `loads from ${number(shown(low, "N"))} to ${measured(high, "N")}`;
    if (this.one) return [label, motion, html("p", { class: "small faint" }, COLORS)];
    const loads = shared
      ? rampBar(shown(low, "N"), shown(high, "N"), labeled("load of a ball", "N"))
      : html("p", { class: "small" }, loadOf(balls.length, measured(high, "N")));
    return [label, loads, motion];
  }

  build() {
    for (const child of [...this.world.children]) {
      if (child.userData.made) {
        this.world.remove(child);
        child.traverse?.((part) => {
          part.geometry?.dispose();
          part.material?.dispose();
        });
      }
    }
    const add = (object) => {
      object.userData.made = true;
      this.world.add(object);
      return object;
    };
    if (this.one) this.buildOne(add);
    else this.buildWhole(add);
    this.resize();
  }

  metal(name, more = {}) {
    return new three.MeshStandardMaterial({
      color: new three.Color(color(name)),
      metalness: 0.35,
      roughness: 0.42,
      side: three.DoubleSide,
      ...more,
    });
  }

  buildWhole(add) {
    const f = this.found;
    const steel = this.metal("steel");
    const reach = f.half + 0.8 * f.lead + 0.6 * f.ball;
    const end = reach + Math.max(1.2 * f.lead, 0.6 * f.pitch);
    const thread = new Thread(f, profile(f, "screw"), [-end, end]);
    this.screw = add(new three.Group());
    this.screw.add(new three.Mesh(thread.surface([0, TURN], 64), steel));
    for (const z of [-end, end]) {
      const cap = new three.Mesh(
        new three.CylinderGeometry(f.pitch / 2 - 0.35 * f.ball, f.pitch / 2 - 0.35 * f.ball, 0.02, 64),
        steel,
      );
      cap.rotation.x = Math.PI / 2;
      cap.position.z = z;
      this.screw.add(cap);
    }
    // The nut is cut open on the side that faces the viewer.
    const open = [0.42 * Math.PI, 1.62 * Math.PI];
    const outer = f.pitch / 2 + 1.55 * f.ball;
    const metal = this.metal("metal", { metalness: 0.15 });
    const inside = new Thread(f, profile(f, "nut"), [-reach, reach]);
    this.shell = add(new three.Group());
    this.shell.add(
      new three.Mesh(inside.surface(open, 44), metal),
      new three.Mesh(tube(outer, open, reach), metal),
    );
    for (const theta of open)
      this.shell.add(new three.Mesh(inside.wall(theta, outer), this.metal("metal-edge", { metalness: 0 })));
    for (const z of [-reach, reach]) this.shell.add(new three.Mesh(inside.ring(open, outer, z), metal));
    const balls = f.balls;
    this.balls = add(
      new three.InstancedMesh(
        new three.SphereGeometry(f.ball / 2, ...(balls.length > 100 ? [10, 7] : [16, 11])),
        new three.MeshStandardMaterial({ metalness: 0.1, roughness: 0.35 }),
        balls.length,
      ),
    );
    const gap = balls.length > 1 ? Math.abs(balls[1].theta - balls[0].theta) : TURN / 12;
    this.gap = gap > 0 ? gap : TURN / 12;
    const size = Math.hypot(end, outer);
    const away = size * 2.6;
    if (this.placed !== size) {
      this.camera.position.set(0.62, 0.42, 0.66).setLength(away);
      this.controls.target.set(0, 0, 0);
      this.placed = size;
    }
    this.controls.minDistance = outer;
    this.controls.maxDistance = 12 * size;
    this.camera.far = 40 * size;
    this.camera.near = size / 200;
  }

  paintLoads() {
    const paint = new three.Color();
    this.found.balls.forEach((ball, i) =>
      this.balls.setColorAt(i, paint.set(`rgb(${ramp(this.part(ball.load)).join(",")})`)),
    );
    this.balls.instanceColor.needsUpdate = true;
  }

  buildOne(add) {
    const { omega } = this.rate;
    const rod = (direction, length, paint, thick, hasHead) =>
      add(rodOf(direction, length, paint, thick, hasHead));
    this.globe = add(new three.Group());
    const surface = this.metal("steel", { transparent: true, opacity: 0.88 });
    this.globe.add(new three.Mesh(new three.SphereGeometry(1, 48, 32), surface));
    this.axis = omega && Math.hypot(...omega) > 0 ? mix(omega).normalize() : FRAME.b;
    this.globe.add(meridians(this.axis));
    if (omega) {
      rod(this.axis, 1.75, "hot", 0.045);
      rod(this.axis.clone().negate(), 1.4, "hot", 0.03, false);
    }
    for (const direction of Object.values(FRAME)) rod(direction, 1.5, "faint", 0.014);
    for (const [name, side, paint] of [
      ["nut", -1, "c1"],
      ["screw", 1, "c2"],
    ]) {
      const angle = this.solved[`${name}_contact_angle_deg`];
      if (angle == null) continue;
      const place = mix([0, side * Math.cos(angle * DEG), side * Math.sin(angle * DEG)]);
      rod(place, 1.55, paint, 0.03, false);
      const material = new three.MeshStandardMaterial({ color: new three.Color(color(paint)) });
      const mark = add(new three.Mesh(new three.SphereGeometry(0.09, 20, 14), material));
      mark.position.copy(place);
    }
    if (this.placed !== "one") {
      this.camera.position.set(2.6, 1.6, 6);
      this.controls.target.set(0, 0, 0);
      this.placed = "one";
    }
    this.controls.minDistance = 2;
    this.controls.maxDistance = 20;
    this.camera.near = 0.05;
    this.camera.far = 100;
  }

  resize() {
    if (!this.renderer || !this.found) return;
    const width = this.stage.clientWidth;
    const height = Math.round(Math.min(380, 0.72 * width));
    if (!width) return;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(width, height, false);
    this.canvas.style.height = `${height}px`;
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.paint();
  }

  /** Runs the animation while it is visible. */
  loop() {
    const wanted = Boolean(this.renderer && this.playing && this.seen && !document.hidden && this.found);
    if (this.renderer && !wanted) this.paint();
    if (wanted === Boolean(this.running)) return;
    this.running = wanted;
    let last = performance.now();
    const frame = (this.frame = (now) => {
      if (!this.running || this.frame !== frame) return;
      this.time += Math.min(now - last, 300) / 1000;
      last = now;
      this.paint();
      if (this.slow) setTimeout(() => requestAnimationFrame(frame), PAUSE);
      else requestAnimationFrame(frame);
    });
    if (wanted) requestAnimationFrame(frame);
  }

  paint() {
    if (!this.found || !this.renderer || !this.key || this.held) return;
    const { time, rate, found } = this;
    if (this.one) {
      if (rate.omega) this.globe.quaternion.setFromAxisAngle(this.axis, Math.hypot(...rate.omega) * time);
    } else {
      this.screw.rotation.z = rate.screw * time;
      this.shell.rotation.z = rate.nut * time;
      // Each ball moves along the helix of the nut to the initial position of the next ball, and then starts
      // again.
      const run = (((((rate.ball ?? rate.screw / 2) - rate.nut) * time) % this.gap) + this.gap) % this.gap;
      const place = new three.Matrix4();
      found.balls.forEach((ball, i) => {
        const theta = ball.theta + run + rate.nut * time;
        place.makeTranslation(
          (found.pitch / 2) * Math.cos(theta),
          (found.pitch / 2) * Math.sin(theta),
          ball.z + (found.lead * run) / TURN,
        );
        this.balls.setMatrixAt(i, place);
      });
      this.balls.instanceMatrix.needsUpdate = true;
    }
    this.renderer.render(this.world, this.camera);
  }
}

function spinOf(solved) {
  const { nut_spin_rad_s: nut, screw_spin_rad_s: screw } = solved.shown.keys;
  const orbital = number(solved.ball_precession_rad_s);
  return (
    ` The spin is ${nut.text} rad/s at the nut and ${screw.text} rad/s at the screw. ` +
    `The orbital speed of the ball is ${orbital} rad/s.`
  );
}

/** Describes the load of the balls if the loads of all balls are the same. */
function loadOf(count, load) {
  if (count === 1) return `The picture shows one ball under ${load}.`;
  return (
    `${count} balls, each under ${load}. ` +
    "To calculate the load of each ball, give loaded_balls_per_turn and loaded_turns."
  );
}

/** Returns the vector with the given components along t, n and b. */
const mix = ([t, n, b]) =>
  FRAME.t.clone().multiplyScalar(t).addScaledVector(FRAME.n, n).addScaledVector(FRAME.b, b);

/** Returns a rod from the center in a direction, with a conical head unless `hasHead` is false. */
function rodOf(direction, length, paint, thick, hasHead = true) {
  const group = new three.Group();
  const material = new three.MeshStandardMaterial({ color: new three.Color(color(paint)), roughness: 0.6 });
  const shaft = new three.Mesh(new three.CylinderGeometry(thick, thick, length, 12), material);
  shaft.position.y = length / 2;
  group.add(shaft);
  if (hasHead) {
    const tip = new three.Mesh(new three.CylinderGeometry(0, thick * 3, thick * 7, 16), material);
    tip.position.y = length;
    group.add(tip);
  }
  group.quaternion.setFromUnitVectors(new three.Vector3(0, 1, 0), direction.clone().normalize());
  return group;
}

/** Returns circles through the ends of the axis of rotation, which make the rotation of the ball visible. */
function meridians(axis) {
  const material = new three.LineBasicMaterial({ color: new three.Color(color("ink")) });
  const lines = new three.Group();
  // The circles are slightly larger than the ball, whose radius is 1.
  const radius = 1.004;
  for (let k = 0; k < 4; k += 1) {
    const turned = (k * Math.PI) / 4;
    const points = [];
    for (let i = 0; i <= 96; i += 1) {
      const a = (TURN * i) / 96;
      const across = radius * Math.cos(a);
      points.push(across * Math.cos(turned), radius * Math.sin(a), across * Math.sin(turned));
    }
    const geometry = new three.BufferGeometry();
    geometry.setAttribute("position", new three.BufferAttribute(new Float32Array(points), 3));
    lines.add(new three.Line(geometry, material));
  }
  lines.quaternion.setFromUnitVectors(new three.Vector3(0, 1, 0), axis);
  return lines;
}

/** Returns a smooth cylindrical surface around the axis. */
function tube(radius, [from, to], reach) {
  const positions = [];
  const index = [];
  const n = 44;
  for (let i = 0; i <= n; i += 1) {
    const theta = from + ((to - from) * i) / n;
    for (const z of [-reach, reach]) positions.push(radius * Math.cos(theta), radius * Math.sin(theta), z);
    if (i) index.push(2 * i - 2, 2 * i, 2 * i - 1, 2 * i - 1, 2 * i, 2 * i + 1);
  }
  return geometryOf(positions, index);
}

function geometryOf(positions, index) {
  const geometry = new three.BufferGeometry();
  geometry.setAttribute("position", new three.BufferAttribute(new Float32Array(positions), 3));
  geometry.setIndex(index);
  geometry.computeVertexNormals();
  return geometry;
}

/** Draws a side view for browsers without WebGL. */
function drawing(f, part, label) {
  const width = 460;
  const height = 260;
  const reach = f.half + 1.6 * f.lead;
  const k = Math.min((width - 20) / (2 * reach), (height - 20) / (f.pitch + 3 * f.ball));
  const at = (z, y) => [width / 2 + k * z, height / 2 - k * y];
  const core = f.pitch / 2 - 0.3 * f.ball;
  const rod = svg(
    "g",
    {},
    svg("rect", {
      x: 4,
      y: height / 2 - k * core,
      width: width - 8,
      height: 2 * k * core,
      style: "fill:var(--steel)",
    }),
  );
  // Only complete half turns are drawn. Each half turn has an axial length of half the lead.
  const lines = [];
  const most = Math.floor(reach / f.lead - 0.25);
  for (let turn = -most; turn <= most; turn += 1) {
    const points = [];
    for (let a = 0; a <= 18; a += 1) {
      const t = Math.PI * (a / 18) - Math.PI / 2;
      points.push(at(turn * f.lead + (f.lead * t) / TURN, core * Math.sin(t)));
    }
    lines.push(
      svg("path", { d: path(points), fill: "none", stroke: "var(--metal-edge)", "stroke-width": 2 }),
    );
  }
  const balls = f.balls
    .filter(({ theta }) => Math.cos(theta) >= -0.05)
    .map(({ theta, z, load }) => {
      const [x, y] = at(z, (f.pitch / 2) * Math.sin(theta));
      return svg("circle", {
        cx: x,
        cy: y,
        r: (k * f.ball) / 2,
        fill: `rgb(${ramp(part(load)).join(" ")})`,
        stroke: "var(--ink)",
        "stroke-width": 0.6,
      });
    });
  return picture(width, height, label, rod, ...lines, ...balls);
}
