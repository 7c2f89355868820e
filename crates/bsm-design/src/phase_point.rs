//! Operating points of a screw in its duty cycle.

/// Returns the direction of motion between two speeds with the same sign: 1, -1, or 0 at
/// standstill.
pub(crate) fn direction_of([start, end]: [f64; 2]) -> f64 {
    let sum = start + end;
    if sum == 0.0 { 0.0 } else { sum.signum() }
}

/// Operating point of a screw at one instant of a phase.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PhasePoint {
    /// Axial load on the screw \[N\], positive if it opposes a positive feed.
    pub load: f64,
    /// Speed of the screw relative to the nut \[rad/s\].
    pub speed: f64,
    /// Speed for the calculation of friction \[rad/s\]. Its absolute value is at least one
    /// thousandth of the largest speed of the phase, or 0 at standstill.
    pub friction_speed: f64,
    /// Acceleration in the direction of positive feed \[m/s²\].
    pub acceleration: f64,
    /// Load factor used to calculate the life.
    pub load_factor: f64,
}

impl PhasePoint {
    /// Operating point at standstill without load.
    pub const REST: Self =
        Self { load: 0.0, speed: 0.0, friction_speed: 0.0, acceleration: 0.0, load_factor: 1.0 };

    /// Creates an operating point with constant speed \[rad/s\] and load \[N\].
    pub fn steady(load: f64, speed: f64) -> Self {
        Self { load, speed, friction_speed: speed, ..Self::REST }
    }

    /// Returns the direction of motion: 1, -1, or 0 at standstill.
    pub fn direction(&self) -> f64 {
        direction_of([self.friction_speed, 0.0])
    }

    /// Returns true if the load acts against the motion, so that the motor must drive the screw.
    fn is_driven(&self) -> bool {
        self.load * self.direction() > 0.0
    }

    /// Returns true if the absolute loads of both points are equal apart from rounding errors.
    pub fn has_load_of(&self, other: &Self) -> bool {
        let (load, other) = (self.load.abs(), other.load.abs());
        (load - other).abs() <= 1e-12 * load.max(other)
    }

    /// Compares two points by their absolute loads. If the loads are equal, a load against the
    /// motion counts as larger than a load in the direction of motion, because a load against the
    /// motion needs more torque. If both loads act against the motion, or neither does, the
    /// absolute speeds are compared.
    fn compare(&self, other: &Self) -> std::cmp::Ordering {
        if !self.has_load_of(other) {
            return self.load.abs().total_cmp(&other.load.abs());
        }
        let by_direction = self.is_driven().cmp(&other.is_driven());
        by_direction.then(self.speed.abs().total_cmp(&other.speed.abs()))
    }

    /// Returns the point with the larger absolute load. If both loads are equal, returns the point
    /// whose load acts against the motion. If this criterion does not decide, returns the faster
    /// point.
    #[must_use]
    pub fn heavier(self, other: Self) -> Self {
        if self.compare(&other).is_gt() { self } else { other }
    }
}
