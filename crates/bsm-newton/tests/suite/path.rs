//! Tests of pseudo-arclength continuation along curves with known closed forms, with limits on the
//! number of points.

use bsm_newton::{CurveEquations, EvalError, PathEnd, Seed, StepControl, Trace, trace};

/// A plane curve that is defined by a function and its gradient.
struct Curve<F>(F);

impl<F: Fn(f64, f64) -> Result<(f64, [f64; 2]), EvalError>> CurveEquations<1, 2> for Curve<F> {
    fn residual(&self, &[x, y]: &[f64; 2]) -> Result<[f64; 1], EvalError> {
        Ok([self.0(x, y)?.0])
    }

    fn linearize(&self, &[x, y]: &[f64; 2]) -> Result<([f64; 1], [[f64; 2]; 1]), EvalError> {
        let (value, slopes) = self.0(x, y)?;
        Ok(([value], [slopes]))
    }
}

type Value = Result<(f64, [f64; 2]), EvalError>;

#[expect(clippy::unnecessary_wraps, reason = "all curves have the same signature")]
fn circle(x: f64, y: f64) -> Value {
    Ok((x * x + y * y - 1.0, [2.0 * x, 2.0 * y]))
}

/// Follows a curve from a point. The event function is the height above a horizontal line.
fn follow_curve(
    curve: impl Fn(f64, f64) -> Value,
    (z, towards): ([f64; 2], [f64; 2]),
    height: f64,
    on: impl Fn(&Trace<2>) -> bool,
    control: &StepControl,
) -> Trace<2> {
    let event = |z: &[f64; 2], way: &[f64; 2]| [(z[1] - height, way[1])];
    trace(&Curve(curve), &Seed { z, towards }, event, on, control)
}

/// The path around a circle crosses a line twice and is closed, regardless of the direction in
/// which the circle is followed.
#[test]
fn closed_curve_is_traced_exactly_once() {
    for (towards, first, points) in [([0.0, 1.0], 0.8, 19), ([0.0, -1.0], -0.8, 21)] {
        let seed = ([1.0, 0.0], towards);
        let seen = follow_curve(circle, seed, 0.6, |_| true, &StepControl::default());
        assert_eq!(seen.end, PathEnd::Closed, "{seen:?}");
        assert_eq!(seen.crossings.len(), 2, "{seen:?}");
        for (crossing, expected) in seen.crossings.iter().zip([first, -first]) {
            // The tolerance is ten times the residual to which the points on the path are refined.
            assert!((crossing.z[0] - expected).abs() < 1e-9, "{seen:?}");
        }
        assert_eq!(seen.unresolved, 0, "{seen:?}");
        assert!(seen.points <= points, "{seen:?}");
    }
}

/// The parabola x = y² crosses x = 1 twice, on both sides of its fold at x = 0.
#[test]
fn path_passes_through_a_fold() {
    let fold = |x: f64, y: f64| Ok((x - y * y, [1.0, -2.0 * y]));
    let event = |z: &[f64; 2], way: &[f64; 2]| [(z[0] - 1.0, way[0])];
    let seed = Seed { z: [4.0, 2.0], towards: [-1.0, 0.0] };
    let seen =
        trace(&Curve(fold), &seed, event, |seen| seen.last[1] > -2.0, &StepControl::default());
    assert_eq!(seen.end, PathEnd::Ended, "{seen:?}");
    let places: Vec<f64> = seen.crossings.iter().map(|c| c.z[1]).collect();
    assert_eq!(places.len(), 2, "{seen:?}");
    assert!((places[0] - 1.0).abs() < 1e-9 && (places[1] + 1.0).abs() < 1e-9, "{places:?}");
}

/// Two sign changes within a single step are found. If the curve only touches the line, there is no
/// sign change, but the step is counted as unresolved because it may hide a pair of sign changes.
#[test]
fn close_pair_of_sign_changes_is_found_or_counted_as_unresolved() {
    let seed = ([1.0, 0.0], [0.0, 1.0]);
    for (height, crossings, resolved, points) in
        [(1.0 - 1e-4, 2, true, 37), (1.0, 0, false, 42), (1.0 + 1e-2, 0, true, 19)]
    {
        let seen = follow_curve(circle, seed, height, |_| true, &StepControl::default());
        assert_eq!(seen.end, PathEnd::Closed, "{height}: {seen:?}");
        assert_eq!(seen.crossings.len(), crossings, "{height}: {seen:?}");
        assert_eq!(seen.unresolved == 0, resolved, "{height}: {seen:?}");
        assert!(seen.points <= points, "{height}: {seen:?}");
    }
}

/// As the curve y = 1/(1 − x) approaches its pole, y grows without limit. The path therefore
/// continues until the caller ends it.
#[test]
fn path_toward_a_pole_continues_until_the_caller_ends_it() {
    let pole = |x: f64, y: f64| Ok((y * (1.0 - x) - 1.0, [-y, 1.0 - x]));
    let seed = ([0.0, 1.0], [1.0, 0.0]);
    let seen = follow_curve(pole, seed, 1e3, |seen| seen.last[1] < 1e6, &StepControl::default());
    assert_eq!(seen.end, PathEnd::Ended, "{seen:?}");
    assert_eq!(seen.crossings.len(), 1, "{seen:?}");
    assert!((seen.crossings[0].z[0] - 0.999).abs() < 1e-9, "{seen:?}");
    let cut = StepControl { max_points: 5, ..StepControl::default() };
    assert_eq!(follow_curve(pole, seed, 1e3, |_| true, &cut).end, PathEnd::MaxPoints);
    let first =
        follow_curve(pole, seed, 2.0, |seen| seen.crossings.is_empty(), &StepControl::default());
    assert!(first.end == PathEnd::Ended && first.crossings.len() == 1, "{first:?}");
}

/// The failures in this test are expected, because the domain of the equations is limited, or
/// because there is no curve near the seed.
#[test]
fn failure_to_find_or_follow_a_solution_curve_is_reported() {
    let root = |x: f64, y: f64| {
        if x < 0.0 {
            return Err(EvalError { quantity: "x", value: x, requirement: "at least 0" });
        }
        Ok((y - x.sqrt() - x, [-0.5 / x.sqrt() - 1.0, 1.0]))
    };
    let seen =
        follow_curve(root, ([1.0, 2.0], [-1.0, 0.0]), 1.0, |_| true, &StepControl::default());
    assert!(seen.end == PathEnd::Lost, "{seen:?}");
    assert!(seen.crossings.len() == 1 && seen.last[0] < 1e-3, "{seen:?}");
    let nothing = |x: f64, y: f64| Ok((x * x + y * y + 1.0, [2.0 * x, 2.0 * y]));
    let seen =
        follow_curve(nothing, ([1.0, 2.0], [-1.0, 0.0]), 1.0, |_| true, &StepControl::default());
    assert_eq!(seen.end, PathEnd::NoCurve, "{seen:?}");
}

/// The curve satisfies the seven equations z_i = sin(i u) with the parameter u. The component z_7
/// crosses 1/2 at 7u = π/6, 5π/6, …
#[test]
fn path_follows_a_curve_of_seven_equations() {
    struct Waves;
    impl CurveEquations<7, 8> for Waves {
        fn residual(&self, z: &[f64; 8]) -> Result<[f64; 7], EvalError> {
            Ok(self.linearize(z)?.0)
        }

        fn linearize(&self, z: &[f64; 8]) -> Result<([f64; 7], [[f64; 8]; 7]), EvalError> {
            let mut rows = [[0.0; 8]; 7];
            let mut values = [0.0; 7];
            for (i, n) in (1..8).map(f64::from).enumerate() {
                values[i] = z[i] - (n * z[7]).sin();
                (rows[i][i], rows[i][7]) = (1.0, -n * (n * z[7]).cos());
            }
            Ok((values, rows))
        }
    }
    let seed = Seed { z: [0.0; 8], towards: [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0] };
    let event = |z: &[f64; 8], way: &[f64; 8]| [(z[6] - 0.5, way[6])];
    let seen = trace(&Waves, &seed, event, |seen| seen.last[7] < 3.1, &StepControl::default());
    assert_eq!(seen.end, PathEnd::Ended, "{:?}", seen.end);
    // The condition sin 7u = 1/2 is met at 7u = π/6, 5π/6, 13π/6, …; eight of these values are
    // below 7·3.1 (41π/6 = 21.5).
    assert_eq!(seen.crossings.len(), 8, "{:?}", seen.crossings);
    for (k, crossing) in seen.crossings.iter().enumerate() {
        let turn =
            f64::from(u32::try_from(k / 2 * 12 + if k % 2 == 0 { 1 } else { 5 }).expect("small"));
        assert!((7.0 * crossing.z[7] - turn * std::f64::consts::PI / 6.0).abs() < 1e-8, "{k}");
    }
    assert!(seen.points <= 65, "{seen:?}");
}
