//! Interpolates properties of the balls, such as precession rates, from a few balls to all balls of
//! a nut.

/// Relative remainder below which a monomial counts as linearly dependent on the previous
/// monomials, because the remainder is only rounding error.
const DEPENDENCE_TOLERANCE: f64 = 1e-9;
/// Number of consecutive nodes at which the error of the polynomial must be within the tolerance
/// before the remaining points are interpolated.
const CONSECUTIVE_NODES: usize = 3;
/// Maximum degree of the interpolating polynomial.
const MAX_DEGREE: i32 = 12;

/// Returns the values of a smooth function of two variables at all points. The function is
/// evaluated only at a few of the points and interpolated at the others. Returns `None` if `value`
/// returns `None` at a point where it is evaluated.
///
/// The method is Newton interpolation with monomials of increasing degree. The next node is the
/// point at which the next monomial has the largest remainder after interpolation by the previous
/// nodes (discrete Leja points). The error of the polynomial at this point is known before the node
/// is added. If the error does not fall below the tolerance, the function is evaluated at all
/// points.
///
/// * `points`: coordinates of the points. The function should vary more strongly with the first
///   coordinate, because monomials with powers of the second coordinate are added later.
/// * `tolerances`: permitted relative interpolation error of each component of the function.
/// * `value`: function that returns the components at the point with a given index.
pub(crate) fn interpolated<const N: usize>(
    points: &[[f64; 2]],
    tolerances: [f64; N],
    mut value: impl FnMut(usize) -> Option<[f64; N]>,
) -> Option<Vec<[f64; N]>> {
    let scaled = [0, 1].map(|axis| {
        let along = points.iter().map(|point| point[axis]);
        let low = along.clone().fold(f64::MAX, f64::min);
        let half = 0.5 * (along.clone().fold(f64::MIN, f64::max) - low);
        let scaled = |x: f64| if half > 0.0 { (x - low) / half - 1.0 } else { 0.0 };
        along.map(scaled).collect::<Vec<_>>()
    });
    // If several points are equal, the function is evaluated only at the first of them.
    let bits: Vec<_> = points.iter().map(|point| point.map(f64::to_bits)).collect();
    let first = bits.iter().map(|point| bits.iter().position(|other| other == point));
    let first = first.collect::<Option<Vec<_>>>()?;
    let mut open: Vec<_> = (0..points.len()).filter(|n| first[*n] == *n).collect();
    let mut found = vec![[0.0; N]; points.len()];
    let mut nodes: Vec<(usize, Vec<f64>)> = Vec::new();
    let mut consecutive = 0;
    for [i, j] in monomials() {
        let monomial = scaled[0].iter().zip(&scaled[1]).map(|(x, y)| x.powi(i) * y.powi(j));
        let mut residual: Vec<_> = monomial.collect();
        for (node, basis) in &nodes {
            let at_node = residual[*node];
            for (residual, basis) in residual.iter_mut().zip(basis) {
                *residual -= at_node * basis;
            }
        }
        let sizes = open.iter().map(|n| residual[*n].abs()).enumerate();
        let Some((position, size)) = sizes.max_by(|a, b| a.1.total_cmp(&b.1)) else { break };
        if size <= DEPENDENCE_TOLERANCE {
            continue;
        }
        let node = open.swap_remove(position);
        let (size, at_node) = (residual[node], value(node)?);
        let error: [f64; N] = std::array::from_fn(|k| at_node[k] - found[node][k]);
        for (found, residual) in found.iter_mut().zip(&mut residual) {
            *residual /= size;
            for (found, error) in found.iter_mut().zip(error) {
                *found += error * *residual;
            }
        }
        nodes.push((node, residual));
        let is_small = (0..N).all(|k| error[k].abs() <= tolerances[k] * at_node[k].abs());
        consecutive = if is_small { consecutive + 1 } else { 0 };
        if consecutive == CONSECUTIVE_NODES {
            open.clear();
        }
    }
    for n in open {
        found[n] = value(n)?;
    }
    Some(first.into_iter().map(|n| found[n]).collect())
}

/// Returns the exponents of monomials in two variables, in order of increasing degree. The exponent
/// of the second variable counts twice toward the degree.
fn monomials() -> impl Iterator<Item = [i32; 2]> {
    (0..=MAX_DEGREE).flat_map(|degree| (0..=degree / 2).map(move |j| [degree - 2 * j, j]))
}

#[cfg(test)]
mod tests {
    use super::{CONSECUTIVE_NODES, interpolated};

    /// Returns 100 points on a curve that fills a rectangle almost uniformly.
    fn points() -> Vec<[f64; 2]> {
        let along = (0_u8..100).map(f64::from);
        along.map(|i| [10.0 + (0.32 * i).sin(), 1e-6 * (0.2 * i).cos()]).collect()
    }

    /// Returns the largest interpolation error and the number of function evaluations.
    fn error(tolerance: f64, function: impl Fn([f64; 2]) -> f64) -> (f64, usize) {
        let (points, mut asked) = (points(), 0);
        let found = interpolated(&points, [tolerance], |n| {
            asked += 1;
            Some([function(points[n])])
        });
        let found = found.expect("values everywhere");
        let errors =
            points.iter().zip(found).map(|(point, [found])| (found - function(*point)).abs());
        (errors.fold(0.0, f64::max), asked)
    }

    #[test]
    fn polynomials_are_interpolated_exactly() {
        // The interpolation needs four nodes for the monomials 1, x, x² and y, followed by three
        // nodes at which the error is within the tolerance.
        let (residual, asked) = error(1e-12, |[x, y]| 3.0 + x - 0.5 * x * x + 2e5 * y);
        assert!(residual < 1e-12 && asked == 4 + CONSECUTIVE_NODES, "{residual:e}, {asked}");
    }

    #[test]
    fn interpolation_of_smooth_functions_needs_few_evaluations() {
        // The tolerance is relative to the largest function value, which is about 30.
        let (residual, asked) = error(1e-7, |[x, y]| (0.3 * x + 1e4 * y).exp());
        assert!(residual < 2e-7 * 30.0 && asked < 25, "{residual:e}, {asked}");
    }

    #[test]
    fn function_with_a_kink_is_evaluated_at_every_point() {
        let (residual, asked) = error(1e-7, |[x, _]| 1.0 + (x - 10.1).abs());
        assert!(residual < 1e-15 * 11.0 && asked == 100, "{residual:e}, {asked}");
    }

    #[test]
    fn function_is_evaluated_only_once_if_all_interpolation_points_are_equal() {
        let mut asked = 0;
        let found = interpolated(&[[65.0, 0.0]; 98], [1e-7], |_| {
            asked += 1;
            Some([0.45])
        });
        assert_eq!((found, asked), (Some(vec![[0.45]; 98]), 1));
        assert_eq!(interpolated(&points(), [1e-7], |_| None::<[f64; 1]>), None);
    }
}
