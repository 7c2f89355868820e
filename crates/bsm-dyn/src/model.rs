//! The models by name, and one operating point with the inputs of one model.

use crate::{ClosedForm, QuasiStatic, Rigid, RigidWorkspace, Solution};

/// A model of the ball screw, cheapest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Model {
    /// Lin's closed form, Eqs 14-19.
    ClosedForm,
    /// Two contacts without inertia, Lin's Eqs 1-4.
    QuasiStatic,
    /// The published steady-state equations, Lin's Eqs 5-9.
    Rigid,
}

impl Model {
    /// All models, cheapest first.
    pub const ALL: [Self; 3] = [Self::ClosedForm, Self::QuasiStatic, Self::Rigid];

    /// Name in files and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::ClosedForm => "closed-form",
            Self::QuasiStatic => "quasi-static",
            Self::Rigid => "rigid",
        }
    }

    /// The model of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|m| m.name() == name)
    }
}

/// Inputs of one model at one operating point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Problem {
    /// Inputs of [`Model::ClosedForm`].
    ClosedForm(ClosedForm),
    /// Inputs of [`Model::QuasiStatic`].
    QuasiStatic(QuasiStatic),
    /// Inputs of [`Model::Rigid`].
    Rigid(Rigid),
}

impl Problem {
    /// The model that solves it.
    pub fn model(&self) -> Model {
        match self {
            Self::ClosedForm(_) => Model::ClosedForm,
            Self::QuasiStatic(_) => Model::QuasiStatic,
            Self::Rigid(_) => Model::Rigid,
        }
    }

    /// Solves it; `work` is memory that one thread reuses from point to point.
    pub fn solve(&self, work: &mut RigidWorkspace) -> Solution {
        match self {
            Self::ClosedForm(p) => p.solve(),
            Self::QuasiStatic(p) => p.solve(),
            Self::Rigid(p) => p.solve(work),
        }
    }
}
