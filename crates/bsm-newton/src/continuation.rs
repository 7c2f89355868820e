//! Natural parameter continuation: a root is followed along a parameter, for problems without a good starting point.

/// Step lengths of the parameter.
#[derive(Debug, Clone, Copy)]
pub struct Continuation {
    /// Length of the first step.
    pub first: f64,
    /// Minimum length of a step; a shorter one ends the continuation.
    pub shortest: f64,
}

/// Follows a root of `N` unknowns from the parameter `begin`, where `y` is a guess, to `end`.
///
/// `solve` moves a guess to the root of a parameter and returns whether it converged. Each
/// guess is extrapolated linearly from the last two roots. A step grows by half after a success and is
/// halved after a failure.
///
/// # Errors
///
/// The last parameter with a root if the path ends early, with its root in `y`; `None` if the guess did not lead to a
/// root at `begin`.
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
    let (mut at, mut length) = (begin, control.first);
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
            // A step beyond the end was no longer than the rest of the way.
            length = 0.5 * length.min((end - at).abs());
            if length < control.shortest {
                return Err(Some(at));
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Newton on y² = x, at most three steps.
    fn root(x: f64, y: &mut [f64; 1]) -> bool {
        for _ in 0..3 {
            y[0] = 0.5 * (y[0] + x / y[0]);
        }
        (y[0] * y[0] - x).abs() <= 1e-9 * x.abs()
    }

    #[test]
    fn the_root_is_followed_where_a_jump_fails() {
        let mut y = [1.0];
        assert!(!root(1e6, &mut [1.0]));
        let control = Continuation { first: 1.0, shortest: 1e-3 };
        assert_eq!(follow(&mut y, (1.0, 1e6), control, root), Ok(()));
        // Tolerance of `root`.
        assert!((y[0] - 1e3).abs() <= 1e-6);
    }

    /// A step is longer than the way.
    #[test]
    fn no_parameter_is_tried_twice_in_a_row() {
        let (mut tried, control) = (Vec::new(), Continuation { first: 8.0, shortest: 0.1 });
        let end = follow(&mut [1.0], (1.0, -1.0), control, |x, y| {
            tried.push(x.to_bits());
            root(x, y)
        });
        assert!(end.is_err() && tried.len() > 3, "{end:?}");
        assert!(tried.windows(2).all(|pair| pair[0] != pair[1]), "{tried:?}");
    }

    /// Expected failure: no root below zero.
    #[test]
    fn the_end_of_a_path_is_told() {
        let mut y = [1.0];
        let control = Continuation { first: 0.1, shortest: 1e-3 };
        let end = follow(&mut y, (1.0, -1.0), control, root).expect_err("the path ends");
        assert!(end.is_some_and(|x| (0.0..0.01).contains(&x)), "{end:?}");
        assert!(follow(&mut [1.0], (-1.0, 1.0), control, root) == Err(None));
    }
}
