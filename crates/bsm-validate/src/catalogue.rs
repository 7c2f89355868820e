//! What the size of a nut does to its numbers.

use bsm_case::Catalogue;
use bsm_case::units::{DEG, MM, UM};
use bsm_design::{Candidate, Size};
use bsm_report::{Axis, Curve, Figure, MOST_CURVES, Stroke};

/// The size around which the figures vary two numbers; a middle one of a feed drive.
const MIDDLE: Size = Size {
    diameter: 40.0 * MM,
    lead: 10.0 * MM,
    ball: 5.0 * MM,
    turns: 4.0,
    conformity: 0.53,
    contact_angle: 45.0 * DEG,
};

/// An entry of a size that a figure varies.
#[derive(Clone, Copy)]
enum Entry {
    Diameter,
    Lead,
    Ball,
    Turns,
    Conformity,
}

impl Entry {
    fn name(self) -> &'static str {
        match self {
            Self::Diameter => "nominal diameter",
            Self::Lead => "lead",
            Self::Ball => "ball diameter",
            Self::Turns => "loaded turns",
            Self::Conformity => "conformity",
        }
    }

    /// True for a length, which is printed in mm.
    fn is_length(self) -> bool {
        matches!(self, Self::Diameter | Self::Lead | Self::Ball)
    }

    /// The values of the lists, in SI.
    fn values(self, catalogue: &Catalogue) -> &[f64] {
        let lists = &catalogue.lists;
        match self {
            Self::Diameter => &lists.diameters,
            Self::Lead => &lists.leads,
            Self::Ball => &lists.balls,
            Self::Turns => &lists.turns,
            Self::Conformity => &lists.conformities,
        }
    }

    /// A value in the unit that it is printed in, to a micrometre.
    fn printed(self, value: f64) -> f64 {
        let value = if self.is_length() { value / MM } else { value };
        (1e3 * value).round() * 1e-3
    }

    fn legend(self, value: f64) -> String {
        let unit = if self.is_length() { " mm" } else { "" };
        let value = format!("{:.3}", self.printed(value));
        let value = value.trim_end_matches('0').trim_end_matches('.');
        format!("{} {value}{unit}", self.name())
    }

    fn set(self, size: &mut Size, value: f64) {
        *match self {
            Self::Diameter => &mut size.diameter,
            Self::Lead => &mut size.lead,
            Self::Ball => &mut size.ball,
            Self::Turns => &mut size.turns,
            Self::Conformity => &mut size.conformity,
        } = value;
    }
}

/// A number of a nut: label of its axis, and how to read it.
type Quantity = (&'static str, fn(&Candidate) -> f64);

/// Dynamic rating and rigidity over three pairs of sizes, mass and efficiency over one: the
/// dependences that Sobolewski (2002) draws in Figs 3 to 10, on axes of our choice.
pub fn catalogue_figures(catalogue: &Catalogue) -> Vec<Figure> {
    use Entry::{Ball, Conformity, Diameter, Lead, Turns};
    let rating: Quantity = ("dynamic load rating, kN", |c| 1e-3 * c.dynamic_rating);
    let rigidity: Quantity = ("rigidity of the pair, N/um", |c| c.rigidity.total * UM);
    let mass: Quantity = ("mass of a nut, kg", |c| c.mass);
    let efficiency: Quantity = ("efficiency", |c| c.efficiency);
    let figures = [
        (rating, [Ball, Diameter]),
        (rating, [Turns, Conformity]),
        (rating, [Diameter, Lead]),
        (rigidity, [Ball, Diameter]),
        (rigidity, [Turns, Conformity]),
        (rigidity, [Diameter, Lead]),
        (mass, [Diameter, Turns]),
        (efficiency, [Diameter, Lead]),
    ];
    let draw = |(number, (quantity, entries))| figure(catalogue, number, quantity, entries);
    (3..).zip(figures).map(draw).collect()
}

fn figure(
    catalogue: &Catalogue,
    number: u32,
    (label, read): Quantity,
    [x, series]: [Entry; 2],
) -> Figure {
    let quantity = label.split(',').next().unwrap_or(label);
    let mut curves = Vec::new();
    for line in series.values(catalogue) {
        let point = |value: &f64| {
            let mut size = MIDDLE;
            series.set(&mut size, *line);
            x.set(&mut size, *value);
            catalogue.limits.candidate(&size).map(|nut| (x.printed(*value), read(&nut)))
        };
        let points: Vec<_> = x.values(catalogue).iter().filter_map(point).collect();
        // A single nut is no curve.
        if points.len() > 1 {
            let label = series.legend(*line);
            curves.push(Curve::new(label, curves.len(), Stroke::Solid, points));
        }
    }
    // The largest ones, if there are more than colours.
    curves.drain(..curves.len().saturating_sub(MOST_CURVES));
    Figure {
        key: format!("catalogue-{number}"),
        title: format!("{} over {}", capital(quantity), x.name()),
        caption: "Around a nut of 40 mm, lead 10 mm, balls of 5 mm, 4 turns, conformity 0.53; the \
                  seven largest values where a list has more."
            .to_owned(),
        x: Axis::linear(&format!("{}{}", x.name(), if x.is_length() { ", mm" } else { "" })),
        y: Axis::linear(label),
        curves,
    }
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |c| c.to_uppercase().chain(letters).collect())
}
