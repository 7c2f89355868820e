//! Inputs of many points for the vectorized kernels. An input is a column with one value per point,
//! or a constant.

use std::borrow::Cow;

use bsm_case::units::{DEG, drive_of_rpm};
use bsm_case::{INPUTS, InputKey, Inputs, Relation, Rule, covered};
use bsm_dyn::{Model, angles::Sines, lubrication::Lubricant, model::RacewayFriction};
use bsm_kin::{Drive, Real};
use bsm_simd::{BLOCK, NullaryFnOnce, Simd};

/// Number of SIMD vectors per [`Lane`]. In benchmarks, the rigid model is fastest with this number.
const UNROLL: usize = 2;

pub(crate) type Lane<S> = bsm_simd::Lane<S, UNROLL>;
pub(crate) type Mask<S> = bsm_simd::Mask<S, UNROLL>;

/// Maximum number of points in a block, which is the number of points in a [`Lane`] with the widest
/// instruction set.
pub(crate) const MAX_BLOCK: usize = UNROLL * BLOCK;

/// Values of one input for all points.
#[derive(Debug)]
pub enum InputColumn<'a> {
    /// No point has a value for the input.
    Absent,
    /// All points have the same value. The value already satisfies the rule of the input and is
    /// plain ([`is_plain`]).
    Constant(f64),
    /// Each point has its own value. The kernel must check the values against the rule of the
    /// input.
    Column(Rule, Cow<'a, [f64]>),
}

/// Inputs that one model needs at several points.
#[derive(Debug)]
pub struct InputColumns<'a> {
    values: [InputColumn<'a>; INPUTS.len()],
    /// Indices of all inputs that are columns, which means that each point has its own value.
    varying: Vec<usize>,
    /// Lubricant (without its temperature) and method for calculating the raceway friction; `None`
    /// for a constant friction coefficient.
    pub(crate) lubricant: Option<(Lubricant, RacewayFriction)>,
}

impl<'a> InputColumns<'a> {
    /// Creates the input columns from all inputs, in the order of [`INPUTS`].
    ///
    /// * `lubricant`: lubricant (without its temperature) and method for calculating the raceway
    ///   friction; `None` for a constant friction coefficient.
    pub fn new(
        values: [InputColumn<'a>; INPUTS.len()],
        lubricant: Option<(Lubricant, RacewayFriction)>,
    ) -> Self {
        let is_column = |index: &usize| matches!(values[*index], InputColumn::Column(..));
        let varying = (0..values.len()).filter(is_column).collect();
        Self { values, varying, lubricant }
    }

    /// Returns the inputs of the points with the given indices.
    pub(crate) fn select(&self, points: &[usize]) -> Self {
        let input = |input: &InputColumn<'_>| match input {
            InputColumn::Absent => InputColumn::Absent,
            InputColumn::Constant(value) => InputColumn::Constant(*value),
            InputColumn::Column(rule, values) => {
                InputColumn::Column(*rule, points.iter().map(|point| values[*point]).collect())
            }
        };
        Self {
            values: self.values.each_ref().map(input),
            varying: self.varying.clone(),
            lubricant: self.lubricant,
        }
    }
}

/// Minimum absolute value of a plain number (see [`is_plain`]) other than zero, in any unit.
const MIN_PLAIN: f64 = 1e-60;

/// Maximum absolute value of a plain number (see [`is_plain`]), in any unit.
const MAX_PLAIN: f64 = 1e60;

/// Returns true if a number is plain: it is zero, or its size is such that products of a few plain
/// numbers neither overflow nor underflow. Points with other values are left to the scalar solver.
#[inline(always)]
pub fn is_plain<F: Real>(value: F) -> F::Mask {
    let size = value.abs();
    size.at_most(0.0) | (size.at_least(MIN_PLAIN) & size.at_most(MAX_PLAIN))
}

/// Inputs of the points in one block.
#[derive(Clone, Copy)]
pub(crate) struct LaneInputs<'a, S> {
    pub(crate) simd: S,
    pub(crate) columns: &'a InputColumns<'a>,
    /// Row index of the first point in the block.
    pub(crate) row: usize,
}

impl<S: Simd> LaneInputs<'_, S> {
    /// Loads the values of the points in the block from a column.
    #[inline(always)]
    fn load(&self, values: &[f64]) -> Lane<S> {
        Lane::load(self.simd, &values[self.row..])
    }

    /// Returns the values of an input at the points of the block, or `None` if no point has a value
    /// for this input.
    #[inline(always)]
    pub(crate) fn try_get(&self, key: InputKey) -> Option<Lane<S>> {
        match &self.columns.values[key as usize] {
            InputColumn::Absent => None,
            InputColumn::Constant(value) => Some(Lane::splat(self.simd, *value)),
            InputColumn::Column(_, values) => Some(self.load(values)),
        }
    }

    /// Returns the values of an input that has a default or that the model requires. The values are
    /// NaN if the input is missing.
    #[inline(always)]
    pub(crate) fn get(&self, key: InputKey) -> Lane<S> {
        self.try_get(key).unwrap_or(Lane::splat(self.simd, f64::NAN))
    }

    /// Returns sine and cosine of an input that is an angle between 0 and 90 degrees.
    #[inline(always)]
    pub(crate) fn sin_cos(&self, key: InputKey) -> (Lane<S>, Lane<S>) {
        (self.get(key) * DEG).sin_cos_first_quadrant()
    }

    /// Returns sine and cosine of the lead angle. The lead angle is an input or is calculated from
    /// the lead.
    #[inline(always)]
    pub(crate) fn lead(&self) -> (Lane<S>, Lane<S>) {
        if self.try_get(InputKey::lead_angle_deg).is_some() {
            return self.sin_cos(InputKey::lead_angle_deg);
        }
        let lead = self.get(InputKey::lead_mm);
        let tan = lead / (self.get(InputKey::pitch_circle_diameter_mm) * std::f64::consts::PI);
        let cos = (tan * tan + 1.0).sqrt().recip();
        (tan * cos, cos)
    }

    /// Returns sines and cosines of lead angle and contact angle.
    #[inline(always)]
    pub(crate) fn sines(&self) -> Sines<Lane<S>> {
        let (sin_a, cos_a) = self.lead();
        let (sin_b, cos_b) = self.sin_cos(InputKey::contact_angle_deg);
        Sines { sin_a, cos_a, sin_b, cos_b }
    }

    /// Returns the speeds of screw and nut, or `None` if the screw speed is missing.
    #[inline(always)]
    pub(crate) fn drive(&self) -> Option<Drive<Lane<S>>> {
        let screw = self.try_get(InputKey::screw_speed_rpm)?;
        Some(drive_of_rpm(screw, self.get(InputKey::nut_speed_rpm)))
    }

    /// Returns a mask that is true for points that the kernel may solve. The inputs of these points
    /// satisfy the rules for single inputs and for combinations of inputs, and are within the range
    /// of the model.
    #[inline(always)]
    fn valid(&self, model: Model) -> Mask<S> {
        let zero = Lane::splat(self.simd, 0.0);
        let mut valid = zero.mask(true);
        // Only columns are checked here, because constants were checked when they were read.
        for index in &self.columns.varying {
            let InputColumn::Column(rule, values) = &self.columns.values[*index] else { continue };
            let x = self.load(values);
            valid = valid & is_plain(x) & rule.holds(x);
        }
        for relation in Relation::ALL {
            if let Some(holds) = relation.holds(self) {
                valid = valid & holds;
            }
        }
        match covered(model, self) {
            Some(covered) => valid & covered,
            None => valid,
        }
    }
}

/// Function object that calls [`LaneInputs::valid`]. It is compiled as a separate function because
/// all kernels share it.
pub(crate) struct ValidCall<'a, 'b, S> {
    pub(crate) given: &'a LaneInputs<'b, S>,
    pub(crate) model: Model,
}

impl<S: Simd> NullaryFnOnce for ValidCall<'_, '_, S> {
    type Output = Mask<S>;

    #[inline(always)]
    fn call(self) -> Mask<S> {
        self.given.valid(self.model)
    }
}

impl<S: Simd> Inputs for LaneInputs<'_, S> {
    type Number = Lane<S>;

    #[inline(always)]
    fn value(&self, key: InputKey) -> Option<Lane<S>> {
        self.try_get(key)
    }
}
