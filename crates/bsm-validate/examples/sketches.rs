//! Draws the sketches of the theory chapters with the code that these chapters explain: the helix
//! with its Frenet-Serret triad, the contacts of a ball, and the slip over a contact ellipse.
//!
//! `cargo run -p bsm-validate --features tools --example sketches -- docs/img`

use std::error::Error;
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::path::PathBuf;
use std::{env, fs};

use bsm_case::{Case, Settings};
use bsm_dyn::{Model, ModelWorkspace, Problem};
use bsm_kin::{BallFrame, Contact, Helix, Site};
use nalgebra::{Vector2, Vector3};

/// Style sheet of the drawings, with colors for light and dark pages.
const STYLE: &str = "
  svg { font: 15px sans-serif; background: none }
  .ink { stroke: #333; fill: none; stroke-width: 1.6 } .thin { stroke: #888; fill: none }
  .hidden { stroke: #999; fill: none; stroke-dasharray: 4 4 }
  .body { fill: #d8dde3; stroke: #556; stroke-width: 1.4 } .ball { fill: #f3efe2; stroke: #333; stroke-width: 1.6 }
  .one { stroke: #0b6fb8; fill: none; stroke-width: 2.4 } .two { stroke: #c2410c; fill: none; stroke-width: 2.4 }
  .three { stroke: #15803d; fill: none; stroke-width: 2.4 }
  .fill1 { fill: #0b6fb8 } .fill2 { fill: #c2410c } .fill3 { fill: #15803d } .word { fill: #222 }
  @media (prefers-color-scheme: dark) {
    .ink { stroke: #ddd } .thin { stroke: #999 } .hidden { stroke: #888 } .word { fill: #eee }
    .body { fill: #39424d; stroke: #aab } .ball { fill: #4a4636; stroke: #ddd }
    .one { stroke: #5db3f0 } .two { stroke: #f5925f } .three { stroke: #5fcf8a }
    .fill1 { fill: #5db3f0 } .fill2 { fill: #f5925f } .fill3 { fill: #5fcf8a }
  }";

type Point = Vector2<f64>;

/// A drawing with coordinates in SVG units. The y axis points down.
struct Drawing {
    size: (f64, f64),
    about: &'static str,
    body: String,
}

impl Drawing {
    fn new(width: f64, height: f64, about: &'static str) -> Self {
        Self { size: (width, height), about, body: String::new() }
    }

    fn element(&mut self, text: &str) {
        let _ = writeln!(self.body, "{text}");
    }

    fn line(&mut self, class: &str, points: &[Point]) {
        let points: Vec<_> = points.iter().map(|p| format!("{:.1},{:.1}", p.x, p.y)).collect();
        self.element(&format!("<polyline class='{class}' points='{}'/>", points.join(" ")));
    }

    fn circle(&mut self, class: &str, at: Point, radius: f64) {
        self.element(&format!(
            "<circle class='{class}' cx='{:.1}' cy='{:.1}' r='{radius:.1}'/>",
            at.x, at.y
        ));
    }

    fn arrow(&mut self, number: usize, from: Point, to: Point) {
        let class = ["ink", "one", "two", "three"][number];
        let fill = ["word", "fill1", "fill2", "fill3"][number];
        let along = (to - from).normalize();
        let across = Point::new(-along.y, along.x);
        let neck = to - along * 9.0;
        self.line(class, &[from, neck]);
        let [a, b] = [neck + across * 4.5, neck - across * 4.5];
        self.element(&format!(
            "<path class='{fill}' d='M{:.1} {:.1}L{:.1} {:.1}L{:.1} {:.1}Z'/>",
            to.x, to.y, a.x, a.y, b.x, b.y
        ));
    }

    /// Writes a text that is centered at a point. Characters after an underscore become a
    /// subscript.
    fn word(&mut self, class: &str, at: Point, text: &str) {
        let (stem, index) = text.split_once('_').unwrap_or((text, ""));
        self.element(&format!(
            "<text class='{class}' x='{:.1}' y='{:.1}' text-anchor='middle'>{stem}\
             <tspan dy='4' font-size='11'>{index}</tspan></text>",
            at.x,
            at.y + 5.0
        ));
    }

    fn svg(&self) -> String {
        let ((width, height), about) = (self.size, self.about.replace('\'', "&apos;"));
        format!(
            "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {width} {height}' width='{width}' \
             height='{height}' role='img' aria-label='{about}'>\n<title>{about}</title>\n\
             <style>{STYLE}\n</style>\n{}</svg>\n",
            self.body
        )
    }
}

/// Draws the helix of the ball centers, and the triad (K1) to (K4) at one of its points.
fn helix() -> Drawing {
    let mut drawing =
        Drawing::new(640.0, 340.0, "Helix of the ball centers with its triad t, n, b");
    let helix = Helix { radius: 105.0, lead_angle: 0.27 };
    let project = |p: &Vector3<f64>| Point::new(110.0 + p.z + 0.30 * p.y, 170.0 - p.x + 0.16 * p.y);
    let towards_us = |theta: f64| theta.sin() < 0.0;
    let at = |i: i32| f64::from(i) * TAU / 180.0;
    let mut run = vec![project(&helix.frame(at(0)).p_WC)];
    // The curve is slightly longer than two turns of the helix.
    let last = 396;
    for i in 1..=last {
        run.push(project(&helix.frame(at(i)).p_WC));
        if towards_us(at(i)) != towards_us(at(i - 1)) || i == last {
            let class = if towards_us(at(i - 1)) { "ink" } else { "hidden" };
            drawing.line(class, &run);
            run = run.split_off(run.len() - 1);
        }
    }
    let axis = |z: f64| project(&Vector3::new(0.0, 0.0, z));
    drawing.arrow(0, axis(-60.0), axis(470.0));
    drawing.word("word", axis(485.0), "k");
    drawing.word("word", axis(410.0) + Point::new(0.0, 16.0), "screw axis");

    let frame = helix.frame(-0.13 * TAU + 2.0 * TAU);
    let [c, scale] = [frame.p_WC, Vector3::repeat(62.0)];
    let tip = |v: &Vector3<f64>| project(&(c + v.component_mul(&scale)));
    drawing.line("thin", &[project(&c), axis(c.z)]);
    drawing.word("word", project(&c) * 0.2 + axis(c.z) * 0.8 + Point::new(18.0, 0.0), "r_m");
    for (number, vector, name) in [(1, frame.t_W, "t"), (2, frame.n_W, "n"), (3, frame.b_W, "b")] {
        drawing.arrow(number, project(&c), tip(&vector));
        let class = ["", "fill1", "fill2", "fill3"][number];
        let beyond = project(&(c + vector * 78.0));
        drawing.word(class, beyond, name);
    }
    drawing.circle("ball", project(&c), 6.0);
    drawing.word("word", project(&c) + Point::new(-14.0, 10.0), "C");
    // The two points are one turn apart, so their axial distance is the lead.
    let turns = [0.75, 1.75].map(|turn| helix.frame(turn * TAU).p_WC);
    let foot = turns.map(|p| Point::new(project(&p).x, 315.0));
    for (p, foot) in turns.iter().zip(foot) {
        drawing.line("thin", &[project(p), foot]);
    }
    drawing.arrow(0, (foot[0] + foot[1]) * 0.5, foot[0]);
    drawing.arrow(0, (foot[0] + foot[1]) * 0.5, foot[1]);
    drawing.word("word", (foot[0] + foot[1]) * 0.5 + Point::new(0.0, 14.0), "lead");
    drawing
}

/// Draws nut and screw in the normal plane of the helix, with the angles and triads of the contacts
/// A, A' and B (K9) to (K11).
fn contacts() -> Drawing {
    let mut drawing = Drawing::new(
        640.0,
        480.0,
        "Normal plane with the contacts A, A' and B, their angles and axes",
    );
    let (center, radius, angle) = (Point::new(300.0, 240.0), 120.0, 0.75_f64);
    // In the drawing, n points down toward the screw axis, and b points to the right.
    let at = |v: &Vector3<f64>| center + Point::new(v.z, v.y);
    let frame = BallFrame::turned(0.1, 0.0);
    let site = |site| Contact::new(site, angle, &frame);
    // Each groove consists of arcs through the contact points. As seen from the contact, the center
    // of an arc is beyond the ball center.
    for (sites, name, outside) in [
        ([Site::Nut, Site::NutUnloaded], "nut", 20.0),
        ([Site::Screw, Site::Screw], "screw", 460.0),
    ] {
        let mirror = name == "screw";
        let arc = 1.16 * radius;
        let mut edge = Vec::new();
        for (i, groove) in sites.into_iter().enumerate() {
            let mut normal = site(groove).normal;
            if mirror && i == 0 {
                normal.z = -normal.z;
            }
            let middle = normal * (arc - radius);
            let from = normal.z.atan2(normal.y);
            for k in -12..=12 {
                let phi = from + 0.055 * f64::from(k);
                let p = middle - Vector3::new(0.0, phi.cos(), phi.sin()) * arc;
                // A flank extends from its outer edge to the bottom of the gothic arch.
                let ends_inside = p.z * normal.z <= 2.0;
                if ends_inside {
                    edge.push(at(&p));
                }
            }
        }
        edge.sort_by(|a, b| a.x.total_cmp(&b.x));
        let (left, right) = (edge[0], edge[edge.len() - 1]);
        let mut outline = vec![Point::new(40.0, outside), Point::new(40.0, left.y)];
        outline.extend(&edge);
        outline.extend([Point::new(530.0, right.y), Point::new(530.0, outside)]);
        let points: Vec<_> = outline.iter().map(|p| format!("{:.1},{:.1}", p.x, p.y)).collect();
        drawing.element(&format!("<polygon class='body' points='{}'/>", points.join(" ")));
        drawing.word("word", Point::new(80.0, if mirror { 440.0 } else { 45.0 }), name);
    }
    drawing.circle("ball", center, radius);
    drawing.line("hidden", &[center - Point::new(0.0, 165.0), center + Point::new(0.0, 165.0)]);
    for (groove, name, number) in
        [(Site::Nut, "A", 1), (Site::NutUnloaded, "A'", 3), (Site::Screw, "B", 2)]
    {
        let contact = site(groove);
        let point = contact.point(radius);
        drawing.line("thin", &[at(&point), center]);
        drawing.arrow(number, at(&point), at(&(point + contact.normal * 66.0)));
        drawing.arrow(number, at(&point), at(&(point + contact.transverse * 66.0)));
        let class = ["", "fill1", "fill2", "fill3"][number];
        let side = if groove == Site::Screw { 14.0 } else { -14.0 };
        drawing.word(class, at(&(point * 1.14)), name);
        drawing.word(class, at(&(point + contact.normal * 52.0 + contact.transverse * side)), "N");
        drawing.word(class, at(&(point + contact.transverse * 80.0)), "e_x");
        drawing.circle("ball", at(&point), 3.5);
    }
    for (groove, name) in [(Site::Nut, "β_A"), (Site::Screw, "β_B")] {
        let up = if groove == Site::Screw { 1.0 } else { -1.0 };
        let arc: Vec<_> = (0..=20)
            .map(|i| angle * f64::from(i) / 20.0)
            .map(|phi| center + Point::new(phi.sin(), phi.cos()) * (up * 46.0))
            .collect();
        drawing.line("ink", &arc);
        let middle = Point::new((0.5 * angle).sin(), (0.5 * angle).cos()) * (up * 62.0);
        drawing.word("word", center + middle, name);
    }
    let corner = Point::new(585.0, 200.0);
    drawing.arrow(0, corner, corner + Point::new(0.0, 60.0));
    drawing.word("word", corner + Point::new(0.0, 74.0), "n");
    drawing.word("word", corner + Point::new(6.0, 92.0), "to the axis");
    drawing.arrow(0, corner, corner + Point::new(42.0, 0.0));
    drawing.word("word", corner + Point::new(34.0, -14.0), "b");
    drawing
}

/// Draws the contact ellipse at the screw for the example of a feed drive, with the slip that model
/// `traction` calculates.
fn ellipse() -> Result<Drawing, Box<dyn Error>> {
    let case = Case::from_json(include_bytes!("../../../examples/feed_drive.json"))?;
    let settings: Settings = Model::Traction.into();
    let problem = case.problem(&settings)?;
    let Problem::Traction(traction) = problem else { unreachable!("the model was fixed") };
    let solution = problem.solve(&mut ModelWorkspace::default());
    let ball = solution.steady_state().ok_or("the example has no solution")?.ball;
    let motion = ball.motion.ok_or("no motion")?;
    let (a, b) = ball.nut.pressed.ok_or("no ellipse")?.semi_axes;
    let angle = ball.nut.angle;
    let (frame, ball) = (
        BallFrame::turned(traction.screw.point.helix.lead_angle, 0.0),
        traction.screw.point.ball.radius,
    );
    let contact = Contact::new(Site::Nut, angle, &frame);
    let motion = motion.relative_to(traction.screw.point.drive.nut_speed, &frame);
    let arc = traction.screw.point.helix.arc_length_per_radian();
    let pressed = bsm_dyn::hertz::pressed_radius(traction.screw.conformity.nut, ball);
    let slip = |x: f64, y: f64| {
        let point = contact.normal * (x * x / (2.0 * pressed) - ball)
            + contact.transverse * x
            + BallFrame::tangent() * y;
        let v = motion.slip_velocity(arc, &point);
        Point::new(v.dot(&contact.transverse), v.x)
    };
    let mut drawing = Drawing::new(
        640.0,
        300.0,
        "Contact ellipse with slip velocities and the lines of pure rolling",
    );
    let middle = Point::new(320.0, 140.0);
    // The drawing stretches the ellipse along the groove.
    let (long, short) = (260.0, 100.0);
    let at = |x: f64, y: f64| middle + Point::new(x * long, -y * short);
    drawing.element(&format!(
        "<ellipse class='ball' cx='{}' cy='{}' rx='{long}' ry='{short}'/>",
        middle.x, middle.y
    ));
    let grid =
        || (-9..=9).flat_map(|i| (-2..=2).map(move |k| (f64::from(i) / 10.0, f64::from(k) / 2.6)));
    let inside: Vec<_> = grid().filter(|(x, y)| x * x + y * y < 0.92).collect();
    let fastest = inside.iter().map(|(x, y)| slip(x * a, y * b).norm()).fold(0.0, f64::max);
    for (x, y) in inside {
        let v = slip(x * a, y * b) / fastest;
        let length = 44.0 * v.norm().powf(0.6);
        if length > 6.0 {
            let along = Point::new(v.x, -v.y).normalize() * (0.5 * length);
            drawing.arrow(1, at(x, y) - along, at(x, y) + along);
        } else {
            drawing.circle("fill1", at(x, y), 2.0);
        }
    }
    // The slip along the groove is zero on this line, and has opposite signs on its two sides.
    let steps = 400;
    let x_of = |i: i32| -1.0 + 2.0 * f64::from(i) / f64::from(steps);
    for i in 1..=steps {
        let (one, other) = (x_of(i - 1), x_of(i));
        if slip(one * a, 0.0).y * slip(other * a, 0.0).y < 0.0 {
            let half = (1.0 - other * other).sqrt();
            drawing.line("two", &[at(other, -half), at(other, half)]);
            drawing.word(
                "fill2",
                at(other, half) + Point::new(0.0, -12.0),
                "no slip along the groove",
            );
        }
    }
    let corner = at(-1.0, -1.0) + Point::new(-20.0, 10.0);
    drawing.arrow(0, corner, corner + Point::new(60.0, 0.0));
    drawing.word("word", corner + Point::new(78.0, 0.0), "e_x");
    drawing.arrow(0, corner, corner + Point::new(0.0, -60.0));
    drawing.word("word", corner + Point::new(0.0, -72.0), "t");
    drawing.word(
        "word",
        middle + Point::new(0.0, 132.0),
        &format!(
            "a = {:.3} mm, b = {:.3} mm (drawn wider); largest slip {:.3} m/s",
            1e3 * a,
            1e3 * b,
            fastest
        ),
    );
    Ok(drawing)
}

/// Draws a nut pair with its degrees of freedom and anchors, and the groove-arc centers around a
/// ball (U8).
fn nut() -> Drawing {
    let mut drawing = Drawing::new(
        900.0,
        390.0,
        "A pair of nuts on its screw, and the groove-arc centers around a ball",
    );
    let mut block = |x: f64, y: f64, width: f64, height: f64| {
        drawing.element(&format!(
            "<rect class='body' x='{x}' y='{y}' width='{width}' height='{height}'/>"
        ));
    };
    block(40.0, 170.0, 470.0, 70.0);
    for y in [105.0, 250.0] {
        block(110.0, y, 150.0, 55.0);
        block(290.0, y, 150.0, 55.0);
    }
    block(260.0, 105.0, 30.0, 30.0);
    block(260.0, 275.0, 30.0, 30.0);
    block(96.0, 75.0, 14.0, 85.0);
    block(96.0, 250.0, 14.0, 85.0);
    for i in 0..6 {
        let x = 130.0 + 22.0 * f64::from(i);
        for x in [x, x + 180.0] {
            drawing.circle("ball", Point::new(x, 165.0), 9.0);
            drawing.circle("ball", Point::new(x + 11.0, 245.0), 9.0);
        }
    }
    drawing.line("hidden", &[Point::new(20.0, 205.0), Point::new(545.0, 205.0)]);
    drawing.line("ink", &[Point::new(40.0, 160.0), Point::new(40.0, 250.0)]);
    for i in 0..6 {
        let y = 165.0 + 16.0 * f64::from(i);
        drawing.line("thin", &[Point::new(40.0, y), Point::new(30.0, y + 8.0)]);
    }
    for (x, y, text) in [
        (185.0, 90.0, "body 0, flanks +"),
        (365.0, 90.0, "body 1, flanks −"),
        (275.0, 345.0, "offset O"),
        (103.0, 60.0, "z_F"),
        (40.0, 264.0, "z_S"),
        (275.0, 372.0, "circuits of balls on the helix; the ball returns leave gaps"),
        (720.0, 40.0, "nut"),
        (720.0, 372.0, "screw"),
        (860.0, 202.0, "n"),
        (905.0 - 6.0, 128.0, "b"),
    ] {
        drawing.word("word", Point::new(x, y), text);
    }
    for [from, to] in [[276.0, 291.0], [274.0, 259.0]] {
        drawing.arrow(0, Point::new(from, 322.0), Point::new(to, 322.0));
    }
    drawing.arrow(1, Point::new(455.0, 140.0), Point::new(530.0, 140.0));
    drawing.word("fill1", Point::new(546.0, 138.0), "u_z");
    drawing.arrow(1, Point::new(470.0, 155.0), Point::new(470.0, 80.0));
    drawing.word("fill1", Point::new(486.0, 74.0), "u_x");
    let turn = |i: i32| 470.0 + 50.0 * (f64::from(i) * TAU / 72.0).cos();
    let turned = |i: i32| Point::new(turn(i), 140.0 - 50.0 * (f64::from(i) * TAU / 72.0).sin());
    drawing.line("one", &(3..15).map(turned).collect::<Vec<_>>());
    drawing.arrow(1, turned(14), turned(15));
    drawing.word("fill1", Point::new(524.0, 98.0), "φ_y");
    let corner = Point::new(860.0, 140.0);
    drawing.arrow(0, corner, corner + Point::new(0.0, 45.0));
    drawing.arrow(0, corner, corner + Point::new(32.0, 0.0));

    let (center, radius, offset) = (Point::new(720.0, 205.0), 95.0, 42.0);
    drawing.circle("ball", center, radius);
    for (flank, sign, color) in [("+", 1.0, 1), ("−", -1.0, 2)] {
        for (member, side) in [("N", 1.0), ("S", -1.0)] {
            // This line extends from the groove-arc center through the ball center to the contact.
            let angle = |turn: f64| TAU / 8.0 + turn;
            let outwards =
                |turn: f64| Point::new(-side * sign * angle(turn).sin(), -side * angle(turn).cos());
            let arc_center = center - outwards(0.0) * offset;
            let groove = |i: i32| arc_center + outwards(f64::from(i) * 0.05) * (radius + offset);
            drawing.line("ink", &(-10..=10).map(groove).collect::<Vec<_>>());
            drawing.line(["", "one", "two"][color], &[arc_center, groove(0)]);
            let fill = ["", "fill1", "fill2"][color];
            drawing.circle(fill, arc_center, 4.0);
            let beside = Point::new(18.0 * side * sign, 0.0);
            drawing.word(fill, arc_center + beside, &format!("{member}{flank}"));
        }
    }
    drawing
}

/// Draws a ball in gothic arches, first without friction and then with friction across the grooves
/// (AC1). Play and ball displacement are exaggerated.
fn third_contact() -> Drawing {
    let mut drawing = Drawing::new(
        760.0,
        380.0,
        "A ball in gothic arches: two contacts without friction, and a third contact with friction",
    );
    let (radius, offset) = (95.0, 42.0);
    // The angles give the directions from the ball center to the contacts. In the drawing, n points
    // down toward the screw axis, and b points to the right.
    let half = TAU / 8.0;
    let towards = |angle: f64| Point::new(angle.sin(), -angle.cos());
    let contacts = [
        ("N+", -half, 1),
        ("N−", half, 2),
        ("S+", TAU / 2.0 - half, 1),
        ("S−", TAU / 2.0 + half, 2),
    ];
    let aside = towards(half);
    for (x, with_friction) in [(190.0, false), (570.0, true)] {
        let middle = Point::new(x, 195.0);
        let way = if with_friction { 9.0 } else { 0.0 };
        drawing.circle("ball", middle + aside * way, radius);
        for (name, angle, color) in contacts {
            // The gap at the unloaded flanks equals the displacement of the ball due to friction,
            // so the ball just touches one of these flanks.
            let gap = if color == 2 { 9.0 } else { 0.0 };
            let arc = |i: i32| {
                let turned = towards(angle + f64::from(i) * 0.045);
                middle - towards(angle) * (offset - gap) + turned * (radius + offset)
            };
            drawing.line("ink", &(-9..=9).map(arc).collect::<Vec<_>>());
            let at = arc(0);
            let is_pressed = color == 1 || with_friction && name == "N−";
            if is_pressed {
                let class = if name == "N−" { "fill2" } else { "fill1" };
                drawing.circle(class, at, 5.0);
            }
            let fill = if !is_pressed {
                "word"
            } else if color == 1 {
                "fill1"
            } else {
                "fill2"
            };
            drawing.word(fill, at + towards(angle) * 22.0, name);
            if with_friction && color == 1 {
                let from = at - towards(angle) * 16.0;
                drawing.arrow(3, from, from + aside * 46.0);
            }
        }
        let text = if with_friction {
            "friction moves the ball onto the far flank"
        } else {
            "without friction: two contacts"
        };
        drawing.word("word", Point::new(x, 365.0), text);
    }
    drawing.word("fill3", Point::new(570.0, 195.0), "c f Q");
    for (at, text) in [(30.0, "nut"), (340.0, "screw")] {
        drawing.word("word", Point::new(190.0, at), text);
        drawing.word("word", Point::new(570.0, at), text);
    }
    let corner = Point::new(365.0, 175.0);
    drawing.arrow(0, corner, corner + Point::new(0.0, 45.0));
    drawing.arrow(0, corner, corner + Point::new(45.0, 0.0));
    drawing.word("word", corner + Point::new(-14.0, 40.0), "n");
    drawing.word("word", corner + Point::new(40.0, -14.0), "b");
    drawing
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = env::args_os().nth(1).map_or_else(|| PathBuf::from("docs/img"), PathBuf::from);
    let drawings = [
        ("helix", helix()),
        ("contacts", contacts()),
        ("ellipse", ellipse()?),
        ("nut", nut()),
        ("third-contact", third_contact()),
    ];
    for (name, drawing) in drawings {
        fs::write(folder.join(format!("{name}.svg")), drawing.svg())?;
    }
    Ok(())
}
