//! Steps of a length that lowers what is to be least.

use crate::ARMIJO;

/// What a step towards a minimum lowers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Objective {
    /// Its value, in any unit.
    pub value: f64,
    /// How far the value is off by rounding.
    pub rounding: f64,
    /// Size of its gradient.
    pub gradient: f64,
}

impl Objective {
    /// The point of the longest of the halves of a step that lowers the value by enough, down to a share of `least`; or the
    /// gradient, where near the minimum the value has no more digits. `None` if there is none.
    ///
    /// * `fall`: of the value along the step, to first order, positive. * `at`: a share of the step, in (0, 1\], and the point
    ///   there, if it exists.
    pub fn backtrack<P>(
        &self,
        fall: f64,
        least: f64,
        mut at: impl FnMut(f64) -> Option<(Self, P)>,
    ) -> Option<P> {
        let mut share = 1.0;
        while share > least {
            if let Some((there, point)) = at(share) {
                let is_level =
                    (there.value - self.value).abs() <= self.rounding.max(there.rounding);
                if there.value <= self.value - ARMIJO * share * fall
                    || (is_level && there.gradient < self.gradient)
                {
                    return Some(point);
                }
            }
            share *= 0.5;
        }
        None
    }
}
