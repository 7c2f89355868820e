//! Sweeps of the analyses of a motion: figures, and whether the curves follow published trends.

mod jam;
mod slip;

use bsm_report::{Curve, Figure, Stroke, short};

/// Which way a curve is said to go.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Claim {
    /// It grows.
    Rises,
    /// It becomes less.
    Falls,
    /// It becomes less, before this place twice as fast as after it, or more.
    Flattens(f64),
    /// A ratio that is above one.
    Exceeds,
}

impl Claim {
    /// True if points in the order of x, whose shape is known, do as claimed all along.
    fn holds(self, points: &[(f64, f64)], shape: Shape) -> bool {
        match self {
            Self::Rises => shape == Shape::Rises,
            Self::Falls => shape == Shape::Falls,
            Self::Flattens(knee) => {
                shape == Shape::Falls
                    && slope(points, |x| x <= knee) <= 2.0 * slope(points, |x| x >= knee)
            }
            Self::Exceeds => points.iter().all(|(_, y)| *y > 1.0),
        }
    }
}

/// Mean slope of the points in a range; NaN if they are less than two.
fn slope(points: &[(f64, f64)], within: impl Fn(f64) -> bool) -> f64 {
    let mut within = points.iter().filter(|(x, _)| within(*x));
    let (first, last) = (within.next(), within.last());
    first.zip(last).map_or(f64::NAN, |(a, b)| (b.1 - a.1) / (b.0 - a.0))
}

/// Which way it goes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// It never falls.
    Rises,
    /// It never rises.
    Falls,
    /// It stays where it is.
    Constant,
    /// It turns back at this place, the first of them.
    Turns(f64),
}

impl Shape {
    /// Of points in the order of x; what changes less than `rounding` does not change.
    fn of(points: &[(f64, f64)], rounding: f64) -> Self {
        let mut shape = Self::Constant;
        let mut reached = points.first().map_or(0.0, |p| p.1);
        let mut at = f64::NAN;
        for &(x, y) in points {
            if (y - reached).abs() <= rounding {
                continue;
            }
            let way = if y > reached { Self::Rises } else { Self::Falls };
            if shape == Self::Constant {
                shape = way;
            } else if shape != way {
                return Self::Turns(at);
            }
            (reached, at) = (y, x);
        }
        shape
    }
}

/// A published trend and what a curve does.
#[derive(Debug, Clone, PartialEq)]
pub struct Trend {
    /// What the trend is of, the same for all contacts and settings: the name of its check.
    pub group: String,
    /// The curve.
    pub curve: String,
    /// What is so.
    pub shape: Shape,
    /// True if the curve goes the claimed way all along.
    pub holds: bool,
    /// First point.
    pub first: (f64, f64),
    /// Last point.
    pub last: (f64, f64),
}

impl Trend {
    /// Of points in the order of x, of which those that are not finite are left out.
    pub(crate) fn of(
        (group, curve): (String, String),
        claim: Claim,
        points: &[(f64, f64)],
        rounding: f64,
    ) -> Option<Self> {
        let clean = |(x, y): (f64, f64)| (x, if y.abs() <= rounding { 0.0 } else { y });
        let points: Vec<_> =
            points.iter().copied().filter(|(_, y)| y.is_finite()).map(clean).collect();
        let shape = Shape::of(&points, rounding);
        let holds = claim.holds(&points, shape);
        Some(Self { group, curve, shape, holds, first: *points.first()?, last: *points.last()? })
    }

    /// What the curve does, in words.
    pub fn describe(&self) -> String {
        let from = format!("from {} to {}", short(self.first.0), short(self.last.0));
        match self.shape {
            Shape::Rises => format!("rises {from}"),
            Shape::Falls => format!("falls {from}"),
            Shape::Constant => format!("stays the same {from}"),
            Shape::Turns(at) => {
                let way = if self.last.1 > self.first.1 { "higher" } else { "lower" };
                format!("turns at {}, ends {way}", short(at))
            }
        }
    }
}

/// Figures of an analysis and the trends of their curves.
#[derive(Debug, Clone, PartialEq)]
pub struct Study {
    /// The figures.
    pub figures: Vec<Figure>,
    /// The trends.
    pub trends: Vec<Trend>,
}

/// A curve without marks; `None` if it has no points.
fn line(label: &str, color: usize, stroke: Stroke, points: Vec<(f64, f64)>) -> Option<Curve> {
    points.iter().any(|(_, y)| y.is_finite()).then(|| Curve::new(label, color, stroke, points))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shape(values: &[f64]) -> Shape {
        let points: Vec<_> = (0..).map(f64::from).zip(values.iter().copied()).collect();
        Shape::of(&points, 1e-9)
    }

    #[test]
    fn shapes_are_told_apart() {
        assert_eq!(shape(&[1.0, 2.0, 2.0, 3.0]), Shape::Rises);
        assert_eq!(shape(&[3.0, 2.0, 2.0]), Shape::Falls);
        assert_eq!(shape(&[1.0, 1.0 + 1e-12, 1.0 - 1e-12]), Shape::Constant);
        assert_eq!(shape(&[1.0, 2.0, 3.0, 2.5, 4.0]), Shape::Turns(2.0));
        // Rounding neither turns a curve nor adds up to a trend unseen.
        assert_eq!(shape(&[1.0, 2.0, 2.0 - 1e-10, 3.0]), Shape::Rises);
        let slow: Vec<_> = (0..30).map(|i| f64::from(i) * 5e-10).collect();
        assert_eq!(shape(&slow), Shape::Rises);
    }

    /// A trend holds all along or not at all; a gap is no point.
    #[test]
    fn a_curve_that_turns_does_not_hold() {
        let trend = |claim, values: &[f64]| {
            let points: Vec<_> = (0..).map(f64::from).zip(values.iter().copied()).collect();
            let names = ("group".to_owned(), "curve".to_owned());
            Trend::of(names, claim, &points, 0.0)
        };
        assert!(trend(Claim::Falls, &[3.0, f64::NAN, 1.0]).is_some_and(|t| t.holds));
        assert!(trend(Claim::Rises, &[3.0, 1.0]).is_some_and(|t| !t.holds));
        assert!(trend(Claim::Falls, &[3.0, 1.0, 2.0]).is_some_and(|t| !t.holds));
        assert!(trend(Claim::Falls, &[1.0, 1.0]).is_some_and(|t| !t.holds));
        assert!(trend(Claim::Falls, &[f64::NAN]).is_none());
        // Slopes of −2 and −0.5, and of −1 and −1, on both sides of the third point.
        assert!(trend(Claim::Flattens(2.0), &[6.0, 4.0, 2.0, 1.5, 1.0]).is_some_and(|t| t.holds));
        assert!(trend(Claim::Flattens(2.0), &[6.0, 5.0, 4.0, 3.0, 2.0]).is_some_and(|t| !t.holds));
        assert!(trend(Claim::Flattens(2.0), &[1.0, 2.0, 3.0, 2.0]).is_some_and(|t| !t.holds));
        assert!(trend(Claim::Flattens(9.0), &[6.0, 4.0, 3.0]).is_some_and(|t| !t.holds));
        assert!(trend(Claim::Exceeds, &[1.5, 3.0, 1.1]).is_some_and(|t| t.holds));
        assert!(trend(Claim::Exceeds, &[1.5, 0.9, 2.0]).is_some_and(|t| !t.holds));
    }
}
