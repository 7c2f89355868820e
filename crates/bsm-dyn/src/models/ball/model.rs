//! The names of the models.

use crate::outcome::named;

named! {
    /// A model of the ball screw, from the one with the fewest inputs to the one with the most.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
    pub enum Model {
        /// Lin's closed form, Eqs 14-19.
        ClosedForm = "closed-form",
        /// Two contacts without inertia, Lin's Eqs 1-4.
        QuasiStatic = "quasi-static",
        /// The published steady-state equations, Lin's Eqs 5-9.
        Rigid = "rigid",
        /// Elastic contacts, rolling balls: Jones and Harris.
        RacewayControl = "raceway-control",
        /// Gross slip on elastic contacts: Lin's equations with Jones geometry.
        Elastic = "elastic",
        /// Friction integrated over the contact ellipses: rolling, partial and gross slip.
        Traction = "traction",
    }
}
