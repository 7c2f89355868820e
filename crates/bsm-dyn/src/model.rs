//! The models by name, and one operating point with the inputs of one model.

use crate::{
    Auto, ClosedForm, Elastic, ElasticWorkspace, Lubricated, LubricatedWorkspace, QuasiStatic,
    RacewayControl, RacewayWorkspace, Rigid, RigidWorkspace, Solution, Traction, TractionWorkspace,
};

/// A model of the ball screw, from the one with the fewest inputs to the one with the most.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Model {
    /// Lin's closed form, Eqs 14-19.
    ClosedForm,
    /// Two contacts without inertia, Lin's Eqs 1-4.
    QuasiStatic,
    /// The published steady-state equations, Lin's Eqs 5-9.
    Rigid,
    /// Elastic contacts, rolling balls: Jones and Harris.
    RacewayControl,
    /// Gross slip on elastic contacts: Lin's equations with Jones geometry.
    Elastic,
    /// Friction integrated over the contact ellipses: rolling, partial and gross slip.
    Traction,
}

/// Memory of the solves, reused from point to point; one for each thread.
#[derive(Default)]
pub struct ModelWorkspace {
    pub(crate) rigid: RigidWorkspace,
    pub(crate) raceway: RacewayWorkspace,
    pub(crate) elastic: ElasticWorkspace,
    pub(crate) traction: TractionWorkspace,
    pub(crate) lubricated: LubricatedWorkspace,
}

impl Model {
    /// All models, by the number of inputs that they need.
    pub const ALL: [Self; 6] = [
        Self::ClosedForm,
        Self::QuasiStatic,
        Self::Rigid,
        Self::RacewayControl,
        Self::Elastic,
        Self::Traction,
    ];

    /// Name in files and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::ClosedForm => "closed-form",
            Self::QuasiStatic => "quasi-static",
            Self::Rigid => "rigid",
            Self::RacewayControl => "raceway-control",
            Self::Elastic => "elastic",
            Self::Traction => "traction",
        }
    }

    /// The model of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|m| m.name() == name)
    }
}

/// Inputs of one model at one operating point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Problem<D = f64> {
    /// Inputs of [`Model::ClosedForm`].
    ClosedForm(ClosedForm<D>),
    /// Inputs of [`Model::QuasiStatic`].
    QuasiStatic(QuasiStatic<D>),
    /// Inputs of [`Model::Rigid`].
    Rigid(Rigid<D>),
    /// Inputs of [`Model::RacewayControl`].
    RacewayControl(RacewayControl<D>),
    /// Inputs of [`Model::Elastic`].
    Elastic(Elastic<D>),
    /// Inputs of [`Model::Traction`].
    Traction(Traction<D>),
    /// Inputs of the choice by error bounds.
    Auto(Auto<D>),
    /// Inputs of [`Model::RacewayControl`] or [`Model::Traction`] with a lubricant.
    Lubricated(Lubricated<D>),
}

impl Problem {
    /// Solves it; `work` is memory that one thread reuses from point to point.
    pub fn solve(&self, work: &mut ModelWorkspace) -> Solution {
        match self {
            Self::ClosedForm(p) => p.solve(),
            Self::QuasiStatic(p) => p.solve(),
            Self::Rigid(p) => p.solve(&mut work.rigid),
            Self::RacewayControl(p) => p.solve(&mut work.raceway),
            Self::Elastic(p) => p.solve(&mut work.elastic),
            Self::Traction(p) => p.solve(&mut work.traction),
            Self::Auto(p) => p.solve(work),
            Self::Lubricated(p) => p.solve(work),
        }
    }
}
