//! Natural parameter continuation, which follows a root while a parameter changes. It is useful if
//! no good starting point is available for the final parameter.

/// Step lengths of a natural parameter continuation, in the unit of the parameter.
#[derive(Debug, Clone, Copy)]
pub struct Continuation {
    /// Length of the first step, positive.
    pub first_step: f64,
    /// Minimum step length. The continuation fails if it would need a shorter step.
    pub min_step: f64,
}

/// Follows a root of `N` unknowns from the parameter `begin` to the parameter `end`.
///
/// On entry, `y` is an initial guess for the root at `begin`. On success, it is the root at `end`.
///
/// `solve` must replace a guess by the root for a given parameter, and must return true if the
/// iteration converged. Each guess is extrapolated linearly from the last two roots. The step
/// length increases by half after a success and is halved after a failure.
///
/// # Errors
///
/// If the path ends early, the error is the last parameter for which a root was found, and `y` is
/// the root for this parameter. The error is `None` if `solve` did not converge at `begin`.
pub fn follow<const N: usize>(
    y: &mut [f64; N],
    (begin, end): (f64, f64),
    control: Continuation,
    mut solve: impl FnMut(f64, &mut [f64; N]) -> bool,
) -> Result<(), Option<f64>> {
    if !solve(begin, y) {
        return Err(None);
    }
    let direction = (end - begin).signum();
    let (mut at, mut length) = (begin, control.first_step);
    let mut arrived = begin.total_cmp(&end).is_eq();
    let mut before: Option<(f64, [f64; N])> = None;
    while !arrived {
        let last = (end - at).abs() <= length;
        let next = if last { end } else { at + direction * length };
        let mut guess = *y;
        if let Some((previous, root)) = &before {
            let ratio = (next - at) / (at - previous);
            for (guess, old) in guess.iter_mut().zip(root) {
                *guess += (*guess - old) * ratio;
            }
        }
        if solve(next, &mut guess) {
            before = Some((at, *y));
            (at, *y, arrived) = (next, guess, last);
            length *= 1.5;
        } else {
            // The last step is shortened to the remaining distance, which may be less than
            // `length`.
            length = 0.5 * length.min((end - at).abs());
            if length < control.min_step {
                return Err(Some(at));
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Takes three Newton steps for y² = x and returns whether they converged.
    fn root(x: f64, y: &mut [f64; 1]) -> bool {
        for _ in 0..3 {
            y[0] = 0.5 * (y[0] + x / y[0]);
        }
        (y[0] * y[0] - x).abs() <= 1e-9 * x.abs()
    }

    #[test]
    fn continuation_reaches_a_root_that_newton_misses() {
        let mut y = [1.0];
        assert!(!root(1e6, &mut [1.0]));
        let control = Continuation { first_step: 1.0, min_step: 1e-3 };
        assert_eq!(follow(&mut y, (1.0, 1e6), control, root), Ok(()));
        // The function `root` permits an error of 1e-9 x in y². The error in y is therefore 1e-9
        // x/(2 y), which is less than 1e-6.
        assert!((y[0] - 1e3).abs() <= 1e-6);
    }

    /// The initial step length of 8 exceeds the length of the path, which is 2.
    #[test]
    fn continuation_does_not_retry_a_parameter_value_that_failed() {
        let (mut tried, control) = (Vec::new(), Continuation { first_step: 8.0, min_step: 0.1 });
        let end = follow(&mut [1.0], (1.0, -1.0), control, |x, y| {
            tried.push(x.to_bits());
            root(x, y)
        });
        assert!(end.is_err() && tried.len() > 3, "{end:?}");
        assert!(tried.windows(2).all(|pair| pair[0] != pair[1]), "{tried:?}");
    }

    /// The failure is expected because y² = x has no root for negative x.
    #[test]
    fn failed_continuation_reports_the_last_parameter_value_with_a_root() {
        let mut y = [1.0];
        let control = Continuation { first_step: 0.1, min_step: 1e-3 };
        let end = follow(&mut y, (1.0, -1.0), control, root).expect_err("the path ends");
        assert!(end.is_some_and(|x| (0.0..0.01).contains(&x)), "{end:?}");
        assert!(follow(&mut [1.0], (-1.0, 1.0), control, root) == Err(None));
    }
}
