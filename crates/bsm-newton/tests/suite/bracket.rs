//! Tests of root finding for functions of one variable: limits on the number of evaluations, and
//! functions for which interpolation fails.

use std::convert::Infallible;

use bsm_newton::{Bracket, Root, RootResult};

/// Returns the root of `f` between two points with zero tolerances.
fn root(f: impl Fn(f64) -> f64, ends: [f64; 2]) -> Root {
    Bracket::new(ends, ends.map(&f)).root(&f).root().expect("a sign change")
}

/// Checks that the search finds the root of `f` and that it needs at most `evaluations`
/// evaluations.
fn check_root(f: impl Fn(f64) -> f64, ends: [f64; 2], expected: f64, evaluations: usize) {
    let found = root(f, ends);
    // The tolerance is the rounding error of the root.
    assert!((found.x - expected).abs() <= 1e-15 * expected.abs(), "{found:?}, {expected:e}");
    assert!(found.evaluations <= evaluations, "{found:?}");
}

#[test]
fn root_search_for_smooth_functions_needs_few_evaluations() {
    check_root(|x| x * x - 2.0, [0.0, 2.0], 2.0_f64.sqrt(), 8);
    check_root(|x| x.exp() - 10.0, [0.0, 5.0], 10.0_f64.ln(), 10);
    check_root(|x| 1.0 / x - 3.0, [1e-3, 1e3], 1.0 / 3.0, 13);
    check_root(|x| 2.0 * x - 3.0, [-10.0, 10.0], 1.5, 1);
}

/// With derivatives, the search uses Newton's method and ends when a step is short.
#[test]
fn root_search_with_derivatives_and_a_good_start_needs_three_evaluations() {
    let bracket =
        Bracket { start: Some(1.4), x_tol: 1e-8, ..Bracket::new([0.0, 2.0], [-2.0, 2.0]) };
    let found = bracket.root(|x| (x * x - 2.0, 2.0 * x)).root().expect("a sign change");
    // After a last step of at most 1e-8, the error is of the order of the squared step or of
    // rounding errors.
    assert!((found.x - 2.0_f64.sqrt()).abs() <= 1e-15, "{found:?}");
    assert!(found.evaluations <= 3);
    // A starting point or a Newton step outside the bracket is ignored.
    let bracket = Bracket { start: Some(7.0), ..bracket };
    let found = bracket.root(|x| (x.atan() - 1.0, 1.0 / (1.0 + x * x))).root().expect("a root");
    assert!((found.x - 1.0_f64.tan()).abs() <= 1e-15 * 2.0 && found.x < 2.0, "{found:?}");
}

#[test]
fn root_at_an_end_needs_no_evaluation() {
    for (ends, values) in [([3.0, 4.0], [0.0, 1.0]), ([4.0, 3.0], [1.0, -0.0])] {
        let found = Bracket::new(ends, values).root(|_| f64::NAN).root().expect("at an end");
        assert!((found.x - 3.0).abs() < f64::EPSILON && found.evaluations == 0, "{found:?}");
    }
}

/// Invalid brackets are expected failures. They are reported as results, without a panic.
#[test]
fn invalid_brackets_are_reported() {
    let same = Bracket::new([0.0, 1.0], [2.0, 1.0]).root(|x| x);
    assert_eq!(same, RootResult::NoSignChange { values: [2.0, 1.0] });
    let inside = Bracket::new([0.0, 1.0], [-1.0, 1.0]).root(|_| f64::NAN);
    assert!(matches!(inside, RootResult::NotFinite { x, value } if x > 0.0 && value.is_nan()));
    for ends in [[f64::NAN, 1.0], [0.0, f64::INFINITY]] {
        let bad = Bracket::new(ends, [-1.0, 1.0]).root(|x| x);
        assert!(matches!(bad, RootResult::NotFinite { .. }), "{bad:?}");
    }
}

/// A pole is also a sign change. The search finds its location, and the reported function value is
/// large.
#[test]
fn function_value_reported_at_a_pole_is_large() {
    let found = root(|x| 1.0 / (x - 0.3), [0.0, 1.0]);
    assert!((found.x - 0.3).abs() <= 1e-15 && found.value.abs() > 1e14, "{found:?}");
}

/// Infinite values at the two ends of a bracket specify only the signs of the function.
#[test]
fn bracketed_root_search_needs_only_the_signs_at_the_ends_of_the_bracket() {
    let bracket = Bracket::new([0.0, 10.0], [f64::NEG_INFINITY, f64::INFINITY]);
    let found = bracket.root(f64::ln).root().expect("a sign change");
    assert!((found.x - 1.0).abs() <= 1e-15, "{found:?}");
}

/// For a predicate, the final bracket consists of two adjacent floating-point numbers on either
/// side of the transition, even if the transition is at zero or the initial bracket spans many
/// orders of magnitude.
#[test]
fn predicate_transition_is_enclosed_by_adjacent_doubles() {
    for edge in [1e-300, 1e-5, 0.0, 0.7, 3e200] {
        let at = |x: f64| if x > edge { 1.0 } else { -1.0 };
        let found = root(at, [-1.0, f64::MAX]);
        let [below, above] = found.ends;
        assert!(below <= edge && above > edge, "{found:?}");
        assert_eq!(below.next_up().to_bits() & !(1 << 63), above.to_bits(), "{found:?}");
        assert!(found.evaluations <= Bracket::MAX_EVALUATIONS, "{found:?}");
    }
}

/// If interpolation fails, the search stays within the limit of evaluations and still finds a sign
/// change.
#[test]
fn root_search_for_difficult_functions_stays_within_the_evaluation_limit() {
    type Case = (fn(f64) -> f64, [f64; 2]);
    let hostile: [Case; 6] = [
        (|x| (x - 1.0).powi(9), [0.0, 10.0]),
        (|x| x.cbrt(), [-1.0, 8.0]),
        (|x| if x == 0.0 { 0.0 } else { x * (-x.powi(-2)).exp() }, [-1.0, 4.0]),
        (|x| x.powi(21) - 1e-30, [0.0, 1e10]),
        (|x| (x * 1e8).atan() + 1e-9, [-1e8, 1e8]),
        (|x| if x < 1e-200 { -1e-300 } else { 1e300 }, [-1e300, 1e300]),
    ];
    for (i, (f, ends)) in hostile.into_iter().enumerate() {
        let found = root(f, ends);
        assert!(found.evaluations <= 150, "{i}: {found:?}");
        let [a, b] = found.ends;
        let changes = (f(a) > 0.0) != (f(b) > 0.0);
        assert!(found.value.abs() <= f64::MIN_POSITIVE || changes, "{i}: {found:?}");
    }
}

/// With larger tolerances, the search ends earlier, and the error of the root is within these
/// tolerances.
#[test]
fn root_search_results_are_within_its_tolerances() {
    let f = |x: f64| x.exp() - 10.0;
    let coarse = Bracket { x_tol: 1e-3, ..Bracket::new([0.0, 5.0], [f(0.0), f(5.0)]) };
    let found = coarse.root(f).root().expect("a sign change");
    assert!((found.x - 10.0_f64.ln()).abs() <= 1e-3 * 2.4 && found.evaluations <= 9, "{found:?}");
    let value = Bracket { f_tol: 0.1, x_tol: 0.0, ..coarse };
    let found = value.root(f).root().expect("a sign change");
    assert!(found.value.abs() <= 0.1 && found.evaluations <= 8, "{found:?}");
}

/// `first_sign_change` stops at the first sign change, zero, NaN or error.
#[test]
fn first_change_stops_at_a_sign_change_zero_nan_or_error() {
    let walk = |f: fn(f64) -> f64| {
        let places = [1.0, 2.0, 4.0];
        let Ok(change) =
            Bracket::first_sign_change((0.0, f(0.0)), places, |x| Ok::<_, Infallible>(f(x)));
        change.map(|bracket| bracket.ends)
    };
    assert_eq!(walk(|x| x - 1.5), Some([1.0, 2.0]));
    assert_eq!(walk(|x| x - 2.0), Some([1.0, 2.0]));
    assert_eq!(walk(|x| x), Some([0.0, 1.0]), "the root is the first point");
    assert_eq!(walk(|x| 1.5 - x), Some([1.0, 2.0]));
    assert_eq!(walk(|x| (1.5 - x).sqrt()), Some([1.0, 2.0]), "not a number");
    assert_eq!(walk(|x| x - 5.0), None);
    assert_eq!(Bracket::first_sign_change((0.0, -1.0), [1.0], |_| Err("no")), Err("no"));
}
