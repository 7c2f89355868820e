//! The figures of Sobolewski (2002), drawn for arbitrary lists of sizes.

use bsm_case::Catalog;
use bsm_case::units::{DEG, MM, UM};
use bsm_design::LIMIT_LOAD;
use bsm_design::catalog::{Candidate, Size};

use crate::{Curve, Figure, MAX_CURVES, PlotAxis, Stroke};

/// Number of nuts that are calculated in one batch.
const PART: usize = 1 << 14;

/// A dimension of a nut that a figure can vary.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Entry {
    Diameter,
    Lead,
    Ball,
    Turns,
    Conformity,
    ContactAngle,
}

/// Name, unit (text and SI value) and value function of a dimension.
type EntryRow = (&'static str, (&'static str, f64), fn(&Size) -> f64);

use Entry::{Ball, Conformity, ContactAngle, Diameter, Lead, Turns};

impl Entry {
    const ALL: [Self; 6] = [Diameter, Lead, Ball, Turns, Conformity, ContactAngle];

    fn row(self) -> EntryRow {
        match self {
            Diameter => ("nominal diameter", (" mm", MM), |size| size.diameter),
            Lead => ("lead", (" mm", MM), |size| size.lead),
            Ball => ("ball diameter", (" mm", MM), |size| size.ball),
            Turns => ("loaded turns", ("", 1.0), |size| size.turns),
            Conformity => ("conformity", ("", 1.0), |size| size.conformity),
            ContactAngle => ("contact angle", (" deg", DEG), |size| size.contact_angle),
        }
    }

    fn name(self) -> &'static str {
        self.row().0
    }

    fn of(self, size: &Size) -> f64 {
        (self.row().2)(size)
    }

    /// Returns the dimension of a nut in the unit of the label, rounded to three decimals.
    fn printed(self, size: &Size) -> f64 {
        (1e3 * self.of(size) / self.row().1.1).round() * 1e-3
    }

    /// Returns the name and the value of the dimension as text.
    fn text(self, size: &Size) -> String {
        let value = format!("{:.3}", self.printed(size));
        let value = value.trim_end_matches('0').trim_end_matches('.');
        format!("{} {value}{}", self.name(), self.row().1.0)
    }
}

/// A quantity of a nut: its axis label, and a function that returns its value.
type PlottedNumber = (&'static str, fn(&Candidate) -> f64);

/// A figure of the paper, which shows a quantity as a function of one dimension, with a curve for
/// each value of another dimension. The remaining dimensions have the values stated in the caption.
struct Drawing {
    key: &'static str,
    /// Number of the figure in the paper.
    of: &'static str,
    quantity: PlottedNumber,
    x: Entry,
    series: Entry,
    near: Size,
}

/// Returns Figs 3 to 10 of the paper with the dimensions stated in its captions and text. For Figs
/// 4 to 6, the paper states neither the lead nor the ball diameter. These figures use a lead of 10
/// mm and the ball diameter of Figs 3, 7 and 9, because this combination is possible for all
/// nominal diameters.
fn drawings() -> [Drawing; 12] {
    let rating: PlottedNumber = ("dynamic load rating, kN", |c| 1e-3 * c.dynamic_rating);
    let stiffness: PlottedNumber = ("stiffness of the preloaded pair, N/um", |c| c.stiffness * UM);
    let mass: PlottedNumber = ("mass of a nut, kg", |c| c.mass);
    let size = |diameter: f64, ball: f64, conformity: f64| Size {
        diameter: diameter * MM,
        lead: 10.0 * MM,
        ball: ball * MM,
        turns: 3.0,
        conformity,
        contact_angle: 45.0 * DEG,
        offered: None,
    };
    let drawing =
        |key, of, quantity, (x, series), near| Drawing { key, of, quantity, x, series, near };
    let over_diameter =
        |key, of, quantity| drawing(key, of, quantity, (Diameter, Turns), size(40.0, 3.175, 0.55));
    let over_lead = |key, of, quantity, diameter, ball| {
        drawing(key, of, quantity, (Lead, Turns), size(diameter, ball, 0.53))
    };
    [
        drawing("catalog-3", "Fig 3", stiffness, (Lead, Conformity), size(20.0, 3.175, 0.53)),
        over_diameter("catalog-4", "Fig 4", rating),
        over_diameter("catalog-5", "Fig 5", stiffness),
        over_diameter("catalog-6", "Fig 6", mass),
        over_lead("catalog-7a", "Fig 7", rating, 50.0, 3.175),
        over_lead("catalog-7b", "Fig 7", rating, 63.0, 3.175),
        over_lead("catalog-8a", "Fig 8", rating, 50.0, 9.525),
        over_lead("catalog-8b", "Fig 8", rating, 63.0, 9.525),
        over_lead("catalog-9a", "Fig 9", mass, 50.0, 3.175),
        over_lead("catalog-9b", "Fig 9", mass, 63.0, 3.175),
        over_lead("catalog-10a", "Fig 10", mass, 50.0, 9.525),
        over_lead("catalog-10b", "Fig 10", mass, 63.0, 9.525),
    ]
}

impl Drawing {
    /// Returns the dimensions that all nuts of the figure have in common.
    fn fixed(&self) -> impl Iterator<Item = Entry> {
        let drawn = [self.x, self.series];
        Entry::ALL.into_iter().filter(move |entry| !drawn.contains(entry))
    }

    /// Returns the logarithmic distance of the fixed dimensions of a nut from the dimensions stated
    /// in the caption.
    fn distance(&self, size: &Size) -> f64 {
        self.fixed().map(|entry| (entry.of(size) / entry.of(&self.near)).ln().abs()).sum()
    }

    /// Returns true if the fixed dimensions of a nut are equal to the dimensions of `size`.
    fn has(&self, size: &Size, nut: &Candidate) -> bool {
        // The values are compared exactly, because both are copied from the same list entry.
        self.fixed().all(|entry| entry.of(size).to_bits() == entry.of(&nut.size).to_bits())
    }

    /// Draws the figure for the nuts that have the fixed dimensions of `size`. Returns `None` if no
    /// two of these nuts form a curve.
    fn figure(&self, size: &Size, nuts: &[Candidate]) -> Option<Figure> {
        let (label, read) = self.quantity;
        let mut series: Vec<_> = nuts.iter().map(|nut| self.series.of(&nut.size)).collect();
        series.sort_by(f64::total_cmp);
        series.dedup();
        let mut curves = Vec::new();
        for value in series {
            let same = |nut: &&Candidate| self.series.of(&nut.size).to_bits() == value.to_bits();
            let nuts: Vec<_> = nuts.iter().filter(same).collect();
            let point = |nut: &&Candidate| (self.x.printed(&nut.size), read(nut));
            let mut points: Vec<_> = nuts.iter().map(point).collect();
            points.sort_by(|(a, _), (b, _)| a.total_cmp(b));
            points.dedup();
            // A single nut does not form a curve.
            if points.len() > 1 {
                let label = self.series.text(&nuts[0].size);
                curves.push(Curve::new(label, curves.len(), Stroke::Solid, points));
            }
        }
        let left_out = curves.len().saturating_sub(MAX_CURVES);
        curves.drain(..left_out);
        if curves.is_empty() {
            return None;
        }
        for (color, curve) in curves.iter_mut().enumerate() {
            curve.color = color;
        }
        let fixed: Vec<_> = self.fixed().map(|entry| entry.text(size)).collect();
        let rest = if left_out > 0 {
            format!(" The curves show the {MAX_CURVES} largest values of {}.", self.series.name())
        } else {
            String::new()
        };
        let unit = self.x.row().1.0.trim();
        let x = if unit.is_empty() { String::new() } else { format!(", {unit}") };
        Some(Figure::new(
            [
                self.key,
                &format!(
                    "{} against {} (Sobolewski 2002, {})",
                    capital(label.split(',').next().unwrap_or(label)),
                    self.x.name(),
                    self.of
                ),
                &format!("{}.{rest}", capital(&fixed.join(", "))),
            ],
            [PlotAxis::linear(&format!("{}{x}", self.x.name())), PlotAxis::linear(label)],
            curves,
        ))
    }
}

/// Returns Figs 2 to 10 of Sobolewski (2002) for the nuts of a catalog. The fixed dimensions of a
/// figure are those of the nut that is closest to the dimensions in the caption. A figure with
/// fewer than two nuts is omitted.
pub fn catalog_figures(catalog: &Catalog, places: &[u32]) -> Vec<Figure> {
    let drawings = drawings();
    let mut nearest = [(f64::INFINITY, None); 12];
    for part in places.chunks(PART) {
        for size in catalog.map(part, |_, nut| Some(nut.size)) {
            for ((least, best), drawing) in nearest.iter_mut().zip(&drawings) {
                let distance = drawing.distance(&size);
                if distance < *least {
                    (*least, *best) = (distance, Some(size));
                }
            }
        }
    }
    let drawn: Vec<_> =
        drawings.iter().zip(nearest).filter_map(|(d, (_, size))| Some((d, size?))).collect();
    let nuts = catalog.map(places, |_, nut| {
        drawn.iter().any(|(drawing, size)| drawing.has(size, nut)).then_some(*nut)
    });
    let figure = |(drawing, size): &(&Drawing, Size)| {
        let nuts: Vec<_> = nuts.iter().filter(|nut| drawing.has(size, nut)).copied().collect();
        drawing.figure(size, &nuts)
    };
    let mut figures: Vec<Figure> = Vec::new();
    for figure in drawn.iter().filter_map(figure) {
        // The same nut may be the best match for two captions, so duplicate figures are omitted.
        let same = |other: &Figure| {
            (&other.caption, &other.x, &other.y) == (&figure.caption, &figure.x, &figure.y)
        };
        if !figures.iter().any(same) {
            figures.push(figure);
        }
    }
    let diagram = nuts.iter().max_by(|a, b| a.dynamic_rating.total_cmp(&b.dynamic_rating));
    diagram.map(preload_diagram).into_iter().chain(figures).collect()
}

/// Plots the forces in a preloaded nut pair against the displacement, as sketched in Fig 2 of the
/// paper.
fn preload_diagram(nut: &Candidate) -> Figure {
    let Candidate { elasticity, preload, size, .. } = nut;
    let approach = elasticity.displacement(*preload);
    let carried = |x: f64| 1e-3 * elasticity.constant * x.max(0.0).powf(1.5);
    let curve = |label: &str, color, stroke, force: &dyn Fn(f64) -> f64, most: f64| {
        let point = |i: i32| 0.02 * most * f64::from(i) * approach;
        let points = (0..=50).map(|i| (point(i) / UM, force(point(i)))).collect();
        Curve::new(label, color, stroke, points)
    };
    let linear = 1e-3 * elasticity.preloaded(*preload);
    let limit = LIMIT_LOAD * preload / elasticity.preloaded(*preload) / approach;
    let sizes: Vec<_> = Entry::ALL.iter().map(|entry| entry.text(size)).collect();
    Figure::new(
        [
            "catalog-2",
            "Forces of a preloaded pair of nuts (Sobolewski 2002, Fig 2)",
            &format!(
                "{}, preload {:.0} N. The straight line of eq. 9 ends at the limit load of eq. 8.",
                capital(&sizes.join(", ")),
                preload
            ),
        ],
        [PlotAxis::linear("displacement under the load, um"), PlotAxis::linear("axial force, kN")],
        vec![
            curve("nut 1", 0, Stroke::Solid, &|w| carried(approach + w), 1.5),
            curve("nut 2", 1, Stroke::Solid, &|w| carried(approach - w), 1.5),
            curve(
                "load of the pair",
                2,
                Stroke::Solid,
                &|w| carried(approach + w) - carried(approach - w),
                1.5,
            ),
            curve("eq. 9", 3, Stroke::Dashed, &|w| linear * w, limit),
        ],
    )
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |c| c.to_uppercase().chain(letters).collect())
}
