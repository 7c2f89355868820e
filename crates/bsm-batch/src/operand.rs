//! The inputs of many points by lanes: columns and constants in one.

use std::borrow::Cow;

use bsm_case::units::{DEG, RPM};
use bsm_case::{
    INPUTS, Input, InputKey, InputSet, Inputs, ModelChoice, Relation, Rule, Scene, Settings,
    covered, following,
};
use bsm_dyn::{Lubricant, Model, RacewayFriction, Sines};
use bsm_simd::Simd;

use crate::rows::{Chunk, Columns};

/// Vectors that are worked on together: measured, the fastest number for the rigid model.
const TOGETHER: usize = 2;

pub(crate) type Lane<S> = bsm_simd::Lane<S, TOGETHER>;
pub(crate) type Mask<S> = bsm_simd::Mask<S, TOGETHER>;

/// Where the values of an input come from.
#[derive(Debug)]
enum Operand<'a> {
    Absent,
    Constant(f64),
    Column(Rule, Cow<'a, [f64]>),
}

/// The inputs of a chunk of points that one model takes.
#[derive(Debug)]
pub(crate) struct Operands<'a> {
    inputs: [Operand<'a>; INPUTS.len()],
    /// Places of those that are columns.
    columns: Vec<usize>,
    /// What friction comes from, but for its temperature; `None` with a coefficient.
    pub(crate) lubricant: Option<Lubricant>,
}

impl<'a> Operands<'a> {
    /// The inputs, and the model that answers ordinary rows, which have a value in every column;
    /// `None` if the model depends on the row, or if something is wrong that every
    /// row must tell.
    pub(crate) fn of(
        chunk: &'a Chunk,
        columns: &Columns,
        base: &Scene,
        settings: &Settings,
    ) -> Option<(Self, Model)> {
        settings.check().ok()?;
        let in_row = |cells: InputSet| base.stated().overridden_by(cells);
        let cells = columns.set();
        let ordinary = in_row(cells);
        ordinary.check_forms().ok()?;
        // Rows that a model does not cover are not ordinary either.
        let choice = settings.model.resolve(ordinary, |_| Ok(())).ok()?;
        let ModelChoice::Fixed(model) = choice else { return None };
        let lubricant = if ordinary.is_lubricated() {
            if model != Model::RacewayControl || settings.friction != RacewayFriction::PerContact {
                return None;
            }
            Some(base.lubricant_but_for_temperature(cells)?)
        } else {
            None
        };
        let mut operands = [const { Operand::Absent }; INPUTS.len()];
        for (key, operand) in InputKey::ALL.into_iter().zip(&mut operands) {
            let Input { rule, default, .. } = *key.input();
            if let Some(place) = columns.inputs.iter().position(|column| *column == key) {
                // A row without this cell is ordinary if its other cells leave the value to the base.
                let has_same = |set: InputSet| {
                    set | InputSet::WITH_DEFAULT == ordinary | InputSet::WITH_DEFAULT
                };
                let filled = has_same(in_row(cells - InputSet::of(&[key])));
                let value = base.value_or_default(key).filter(|_| filled);
                *operand = Operand::Column(rule, chunk.inputs[place].filled(value));
            } else if let Some(value) = follows(key, chunk, columns, base, ordinary) {
                *operand = Operand::Column(rule, Cow::Owned(value));
            } else if let Some(value) =
                base.value_or_default(key).filter(|_| ordinary.completed().contains(key))
            {
                if !rule.holds(value) || !is_plain(value) {
                    return None;
                }
                *operand = Operand::Constant(value);
            } else if let Some(value) = default {
                *operand = Operand::Constant(value);
            }
        }
        let is_column = |place: &usize| matches!(operands[*place], Operand::Column(..));
        let columns = (0..operands.len()).filter(is_column).collect();
        Some((Self { inputs: operands, columns, lubricant }, model))
    }
}

/// The values of an input that follows from columns where it is not given.
fn follows(
    key: InputKey,
    chunk: &Chunk,
    columns: &Columns,
    base: &Scene,
    ordinary: InputSet,
) -> Option<Vec<f64>> {
    if ordinary.contains(key) || !ordinary.completed().contains(key) {
        return None;
    }
    let place = |key| columns.inputs.iter().position(|column| *column == key);
    let value = |row: usize| {
        following(key, |from| match place(from) {
            Some(place) => Some(chunk.inputs[place].values()[row]),
            None => base[from].filter(|_| ordinary.contains(from)),
        })
    };
    (0..chunk.len).map(value).collect()
}

/// Sizes whose products of a few stay numbers; what is beyond is left to the model, which looks closer.
const PLAIN: [f64; 2] = [1e-60, 1e60];

fn is_plain(value: f64) -> bool {
    let size = value.abs();
    size <= 0.0 || (PLAIN[0]..=PLAIN[1]).contains(&size)
}

/// The inputs of as many points as a lane holds.
#[derive(Clone, Copy)]
pub(crate) struct Given<'a, S> {
    pub(crate) simd: S,
    pub(crate) operands: &'a Operands<'a>,
    /// The first of the points.
    pub(crate) row: usize,
}

impl<S: Simd> Given<'_, S> {
    #[inline(always)]
    fn load(&self, values: &[f64]) -> Lane<S> {
        Lane::load(self.simd, &values[self.row..])
    }

    /// The values of an input, if there is a column or a constant for it.
    #[inline(always)]
    pub(crate) fn try_get(&self, key: InputKey) -> Option<Lane<S>> {
        match &self.operands.inputs[key as usize] {
            Operand::Absent => None,
            Operand::Constant(value) => Some(Lane::splat(self.simd, *value)),
            Operand::Column(_, values) => Some(self.load(values)),
        }
    }

    /// The values of an input that the model requires, or of one with a default.
    #[inline(always)]
    pub(crate) fn get(&self, key: InputKey) -> Lane<S> {
        self.try_get(key).unwrap_or(Lane::splat(self.simd, f64::NAN))
    }

    /// Sine and cosine of an angle between 0 and 90 degrees.
    #[inline(always)]
    pub(crate) fn sin_cos(&self, key: InputKey) -> (Lane<S>, Lane<S>) {
        (self.get(key) * DEG).sin_cos_first_quadrant()
    }

    /// Sine and cosine of the lead angle, from the angle or from the lead.
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

    /// Sines and cosines of lead angle and contact angle.
    #[inline(always)]
    pub(crate) fn sines(&self) -> Sines<Lane<S>> {
        let (sin_a, cos_a) = self.lead();
        let (sin_b, cos_b) = self.sin_cos(InputKey::contact_angle_deg);
        Sines { sin_a, cos_a, sin_b, cos_b }
    }

    /// Speeds of screw and nut \[rad/s\], if they are given.
    #[inline(always)]
    pub(crate) fn speeds(&self) -> Option<(Lane<S>, Lane<S>)> {
        let nut = self.get(InputKey::nut_speed_rpm);
        Some((self.try_get(InputKey::screw_speed_rpm)? * RPM, nut * RPM))
    }

    /// Where the values of all columns keep their rules, alone and against each other, and the model
    /// covers them.
    #[inline(always)]
    pub(crate) fn lawful(&self, model: Model) -> Mask<S> {
        let zero = Lane::splat(self.simd, 0.0);
        let [least, most] = PLAIN.map(|x| zero.constant(x));
        let mut lawful = zero.le(zero);
        // Constants were checked.
        for place in &self.operands.columns {
            let Operand::Column(rule, values) = &self.operands.inputs[*place] else { continue };
            let x = self.load(values);
            let size = x.abs();
            let plain = size.le(zero) | (least.le(size) & size.le(most));
            lawful = lawful & plain & rule.holds(x);
        }
        for relation in Relation::ALL {
            if let Some(holds) = relation.holds(self) {
                lawful = lawful & holds;
            }
        }
        match covered(model, self) {
            Some(covered) => lawful & covered,
            None => lawful,
        }
    }
}

impl<S: Simd> Inputs for Given<'_, S> {
    type Number = Lane<S>;

    #[inline(always)]
    fn value(&self, key: InputKey) -> Option<Lane<S>> {
        self.try_get(key)
    }
}
