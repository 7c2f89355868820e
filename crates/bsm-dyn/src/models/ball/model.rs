//! The models by name.

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
