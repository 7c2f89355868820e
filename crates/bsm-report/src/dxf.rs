//! Drawings in DXF release 12, a format that every CAD program can read.

use std::fmt::Write;

use bsm_case::GrooveSection;

/// Names and color numbers of the drawing layers.
const LAYERS: [(&str, u8); 5] = [("SCREW", 5), ("NUT", 3), ("BALL", 7), ("CENTER", 1), ("DIM", 8)];

/// The text of a DXF file, which consists of pairs of a code and a value, each on its own line.
struct Dxf(String);

impl Dxf {
    fn pair(&mut self, code: u8, value: impl std::fmt::Display) {
        // Writing to a string cannot fail.
        let _ = writeln!(self.0, "{code:>3}\n{value}");
    }

    /// Adds a coordinate or an angle, rounded to 1e-9.
    fn number(&mut self, code: u8, value: f64) {
        self.pair(code, format_args!("{value:.9}"));
    }

    fn entity(&mut self, kind: &str, layer: &str) {
        self.pair(0, kind);
        self.pair(8, layer);
    }

    fn line(&mut self, layer: &str, [from, to]: [(f64, f64); 2]) {
        self.entity("LINE", layer);
        for (code, (x, y)) in [(10, from), (11, to)] {
            self.number(code, x);
            self.number(code + 10, y);
        }
    }

    fn circle(&mut self, kind: &str, layer: &str, (x, y): (f64, f64), radius: f64) {
        self.entity(kind, layer);
        self.number(10, x);
        self.number(20, y);
        self.number(40, radius);
    }

    /// Adds an arc.
    ///
    /// * `ends`: start and end angle, counterclockwise from the x axis \[deg\].
    fn arc(&mut self, layer: &str, center: (f64, f64), radius: f64, ends: [f64; 2]) {
        self.circle("ARC", layer, center, radius);
        self.number(50, ends[0]);
        self.number(51, ends[1]);
    }

    fn text(&mut self, (x, y): (f64, f64), height: f64, text: &str) {
        self.entity("TEXT", "DIM");
        self.number(10, x);
        self.number(20, y);
        self.number(40, height);
        self.pair(1, text);
    }
}

/// Draws the cross section of the nut and screw grooves around a ball, in millimeters at scale 1:1.
/// The origin is the ball center, x points along the axis, and y points away from the axis.
pub fn groove_dxf(section: &GrooveSection) -> String {
    let mut dxf = Dxf(String::new());
    dxf.pair(0, "SECTION");
    dxf.pair(2, "HEADER");
    dxf.pair(9, "$ACADVER");
    dxf.pair(1, "AC1009");
    dxf.pair(0, "ENDSEC");
    dxf.pair(0, "SECTION");
    dxf.pair(2, "TABLES");
    dxf.pair(0, "TABLE");
    dxf.pair(2, "LAYER");
    dxf.pair(70, LAYERS.len());
    for (name, color) in LAYERS {
        dxf.pair(0, "LAYER");
        dxf.pair(2, name);
        dxf.pair(70, 0);
        dxf.pair(62, color);
        dxf.pair(6, "CONTINUOUS");
    }
    dxf.pair(0, "ENDTAB");
    dxf.pair(0, "ENDSEC");
    dxf.pair(0, "SECTION");
    dxf.pair(2, "ENTITIES");
    for (place, layer, outline) in [(0, "NUT", &section.nut), (1, "SCREW", &section.screw)] {
        // The nut groove is drawn above the ball.
        let up = if place == 0 { 1.0 } else { -1.0 };
        let ((k, h), radius) = (section.centers[place], section.radii[place]);
        let [meet, edge] = section.flanks[place];
        // Flank angles are measured from the radial direction. The flanks of the screw are the
        // mirror image of the flanks of the nut.
        let right = if up > 0.0 { [90.0 - edge, 90.0 - meet] } else { [meet - 90.0, edge - 90.0] };
        let left = [180.0 - right[1], 180.0 - right[0]];
        dxf.arc(layer, (-k, -up * h), radius, right);
        dxf.arc(layer, (k, -up * h), radius, left);
        // The first and the last segment of the outline are the lands on both sides of the groove.
        if let [from, to, .., before, last] = outline[..] {
            dxf.line(layer, [from, to]);
            dxf.line(layer, [before, last]);
        }
    }
    let (ball, angle) = (section.ball_radius, section.contact_angle);
    dxf.circle("CIRCLE", "BALL", (0.0, 0.0), ball);
    let reach = 1.2 * ball;
    dxf.line("CENTER", [(-reach, 0.0), (reach, 0.0)]);
    dxf.line("CENTER", [(0.0, -reach), (0.0, reach)]);
    let (x, y) = (reach * angle.sin(), reach * angle.cos());
    dxf.line("CENTER", [(-x, y), (x, -y)]);
    let height = 0.12 * ball;
    let lines = [
        format!("D_w {:.4} mm", 2.0 * ball),
        format!("R_n {:.4} mm, R_s {:.4} mm", section.radii[0], section.radii[1]),
        format!("contact angle {:.3} deg", angle.to_degrees()),
    ];
    for (line, text) in (0_u8..).zip(&lines) {
        dxf.text((1.8 * ball, -1.6 * f64::from(line) * height), height, text);
    }
    dxf.pair(0, "ENDSEC");
    dxf.pair(0, "EOF");
    dxf.0
}

#[cfg(test)]
mod tests {
    use bsm_case::Case;

    use super::*;

    /// Parses the entities of a DXF file. Each entity has a type and a list of group codes with
    /// their values.
    fn entities(text: &str) -> Vec<(String, Vec<(u8, String)>)> {
        let lines: Vec<_> = text.lines().map(str::trim).collect();
        let pairs = lines.chunks(2).map(|pair| (pair[0].parse().expect("a code"), pair[1]));
        let mut found: Vec<(String, Vec<(u8, String)>)> = Vec::new();
        for (code, value) in pairs {
            match (code, found.last_mut()) {
                (0, _) => found.push((value.to_owned(), Vec::new())),
                (code, Some((_, of))) => of.push((code, value.to_owned())),
                _ => {}
            }
        }
        found
    }

    /// The arcs must have the radii of the grooves, touch the ball at the contact angle, and end
    /// where the lands begin.
    #[test]
    fn groove_arcs_in_the_dxf_drawing_touch_the_ball_at_the_contact_angle() {
        let case = include_bytes!("../../../examples/axis.json");
        let section = GrooveSection::of(&Case::from_json(case).expect("a case"));
        let section = section.expect("a groove");
        let all = entities(&groove_dxf(&section));
        assert_eq!(all.last().map(|(kind, _)| kind.as_str()), Some("EOF"));
        let of = |kind: &str| {
            all.iter().filter(|(k, _)| k == kind).map(|(_, of)| of).collect::<Vec<_>>()
        };
        let number = |of: &[(u8, String)], code: u8| -> f64 {
            let found = of.iter().find(|(own, _)| *own == code).expect("a number");
            found.1.parse().expect("a number")
        };
        let layer = |of: &[(u8, String)]| of[0].1.clone();
        let lines = of("LINE");
        assert_eq!(of("ARC").len(), 4);
        // The tolerance is 1e-6 mm. The file contains nine decimals.
        let close = |a: f64, b: f64| (a - b).abs() < 1e-6;
        for arc in of("ARC") {
            let [x, y, radius, from, to] = [10, 20, 40, 50, 51].map(|code| number(arc, code));
            let place = usize::from(layer(arc) == "SCREW");
            // The groove radius is R = f D_w. The arc center is on the line through the contact, at
            // the distance R - r from the ball center.
            assert!(close(radius, 0.52 * 10.0));
            assert!(close(x.hypot(y), radius - 5.0));
            assert!(close(x.abs(), (radius - 5.0) * 45.0_f64.to_radians().sin()));
            assert!((x.abs() - section.centers[place].0).abs() < 1e-6);
            assert!(to > from && to - from < 90.0);
            // One end of each arc must be in the middle of the groove, and the other end must be
            // where a land begins.
            let end = |deg: f64| {
                (x + radius * deg.to_radians().cos(), y + radius * deg.to_radians().sin())
            };
            let ends = [end(from), end(to)];
            assert!(ends.iter().any(|(x, _)| close(*x, 0.0)), "{ends:?}");
            let lands = lines.iter().filter(|line| layer(line) == layer(arc));
            let begins = lands.flat_map(|line| {
                [(10, 20), (11, 21)].map(|(x, y)| (number(line, x), number(line, y)))
            });
            let meets =
                |(x, y): (f64, f64)| ends.iter().any(|end| close(x, end.0) && close(y, end.1));
            assert_eq!(begins.filter(|point| meets(*point)).count(), 1, "{ends:?}");
        }
        let ball = of("CIRCLE");
        assert!(close(number(ball[0], 40), 5.0));
    }
}
