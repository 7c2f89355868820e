//! Points in the middle of their solves, those that are worked on together taken from anywhere.

#![expect(clippy::needless_range_loop, reason = "places of vectors")]

use bsm_simd::{BLOCK, Simd};

use super::balance::{BALL, Balls, Race, Vector};
use crate::operand::Lane;

/// Most points that are worked on together.
pub(super) const MANY: usize = 4 * BLOCK;

/// What is known of a point; some are the first of several numbers.
#[derive(Debug, Clone, Copy)]
pub(super) enum Known {
    Arc,
    SinLead,
    CosLead,
    NutSpeed,
    Sign,
    InertiaRatio,
    Friction,
    Reach,
    Creep,
    /// Of nut and screw.
    Offset,
    Compliance = Self::Offset as isize + 2,
    SemiAxis = Self::Compliance as isize + 2,
    Flatness = Self::SemiAxis as isize + 2,
    PressedRadius = Self::Flatness as isize + 2,
    /// The seven unknowns, and the step from them.
    At = Self::PressedRadius as isize + 2,
    Step = Self::At as isize + 7,
    /// Part of the step that is tried, and scaled residual before it.
    Part = Self::Step as isize + 7,
    Residual,
    /// Weights of forces and moments.
    ForceWeight,
    MomentWeight,
    Steps,
    /// Torque on the screw, friction power and bound of the error of the efficiency.
    Torque,
    Power,
    Error,
    End,
}

/// Numbers of all points of a call.
pub(super) struct Pool {
    len: usize,
    numbers: Vec<f64>,
}

/// Points that are worked on together, the last one repeated where there are fewer.
pub(super) struct Together {
    places: [usize; MANY],
    pub(super) len: usize,
}

impl Together {
    pub(super) fn of(points: &[usize]) -> Self {
        let mut places = [points[points.len() - 1]; MANY];
        places[..points.len()].copy_from_slice(points);
        Self { places, len: points.len() }
    }

    /// The points, each once.
    pub(super) fn points(&self) -> &[usize] {
        &self.places[..self.len]
    }
}

impl Pool {
    pub(super) fn new(len: usize) -> Self {
        Self { len, numbers: vec![0.0; len * Known::End as usize] }
    }

    /// One number of neighbouring points.
    #[inline(always)]
    pub(super) fn put<S: Simd>(&mut self, known: Known, more: usize, row: usize, x: Lane<S>) {
        let begin = (known as usize + more) * self.len;
        x.store(&mut self.numbers[begin + row..begin + self.len]);
    }

    /// Neighbouring points from a row on.
    #[inline(always)]
    pub(super) fn row<S: Simd>(&self, row: usize) -> Together {
        let mut places = [row; MANY];
        let len = Lane::<S>::LEN.min(self.len - row);
        for i in 0..len {
            places[i] = row + i;
        }
        Together { places, len }
    }

    /// One number of points anywhere.
    #[inline(always)]
    pub(super) fn take<S: Simd>(
        &self,
        simd: S,
        known: Known,
        more: usize,
        at: &Together,
    ) -> Lane<S> {
        let column = &self.numbers[(known as usize + more) * self.len..][..self.len];
        let mut block = [0.0; MANY];
        for i in 0..Lane::<S>::LEN {
            block[i] = column[at.places[i]];
        }
        Lane::load(simd, &block)
    }

    /// Stores a number of points anywhere.
    #[inline(always)]
    pub(super) fn keep<S: Simd>(&mut self, known: Known, more: usize, at: &Together, x: Lane<S>) {
        let column = &mut self.numbers[(known as usize + more) * self.len..][..self.len];
        for (place, x) in at.points().iter().zip(x.as_slice()) {
            column[*place] = *x;
        }
    }

    #[inline(always)]
    pub(super) fn take_all<S: Simd>(&self, simd: S, known: Known, at: &Together) -> Vector<S> {
        let mut vector = [Lane::splat(simd, 0.0); BALL];
        for k in 0..BALL {
            vector[k] = self.take(simd, known, k, at);
        }
        vector
    }

    #[inline(always)]
    pub(super) fn keep_all<S: Simd>(&mut self, known: Known, at: &Together, vector: &Vector<S>) {
        for k in 0..BALL {
            self.keep(known, k, at, vector[k]);
        }
    }

    #[inline(always)]
    pub(super) fn balls<S: Simd>(&self, simd: S, at: &Together) -> Balls<S> {
        let zero = Lane::splat(simd, 0.0);
        let none = Race {
            offset: zero,
            compliance: zero,
            semi_axis: zero,
            flatness: zero,
            pressed_radius: zero,
        };
        let mut races = [none; 2];
        for i in 0..2 {
            races[i] = Race {
                offset: self.take(simd, Known::Offset, i, at),
                compliance: self.take(simd, Known::Compliance, i, at),
                semi_axis: self.take(simd, Known::SemiAxis, i, at),
                flatness: self.take(simd, Known::Flatness, i, at),
                pressed_radius: self.take(simd, Known::PressedRadius, i, at),
            };
        }
        Balls {
            arc: self.take(simd, Known::Arc, 0, at),
            sin_a: self.take(simd, Known::SinLead, 0, at),
            cos_a: self.take(simd, Known::CosLead, 0, at),
            nut_speed: self.take(simd, Known::NutSpeed, 0, at),
            sign: self.take(simd, Known::Sign, 0, at),
            inertia_ratio: self.take(simd, Known::InertiaRatio, 0, at),
            friction: self.take(simd, Known::Friction, 0, at),
            reach: self.take(simd, Known::Reach, 0, at),
            creep: self.take(simd, Known::Creep, 0, at),
            races,
        }
    }
}
