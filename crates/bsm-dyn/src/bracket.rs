//! Two places around a zero.

/// Places on both sides of a zero, and the values there by the Illinois rule: a place that stays twice
/// counts half as much, so that regula falsi moves it too.
pub(crate) struct Bracket<T> {
    /// The places.
    pub(crate) ends: [T; 2],
    /// Their values, the more halved the longer one stays.
    pub(crate) values: [f64; 2],
    moved: Option<usize>,
}

impl<T> Bracket<T> {
    /// Around a zero between two places; their values differ in sign.
    pub(crate) fn new(ends: [T; 2], values: [f64; 2]) -> Self {
        Self { ends, values, moved: None }
    }

    /// Moves an end to a place nearer to the zero, on the same side.
    pub(crate) fn tighten(&mut self, end: usize, place: T, value: f64) {
        (self.ends[end], self.values[end]) = (place, value);
        if self.moved == Some(end) {
            self.values[1 - end] *= 0.5;
        }
        self.moved = Some(end);
    }
}
