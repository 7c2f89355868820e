//! The models of the ball screw and their names.

use crate::outcome::named;

named! {
    /// A model of the ball screw. The models are ordered by increasing number of inputs.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
    pub enum Model {
        /// Closed form of Lin, Velinsky and Ravani, Equations 14 to 19.
        ClosedForm = "closed-form",
        /// Two contacts without inertia (Lin, Velinsky and Ravani, Equations 1 to 4).
        QuasiStatic = "quasi-static",
        /// Three rigid contacts in steady motion (Lin, Velinsky and Ravani, Equations 5 to 9).
        Rigid = "rigid",
        /// Rolling balls on elastic contacts (Jones; Harris and Kotzalas).
        RacewayControl = "raceway-control",
        /// Gross slip on elastic contacts (equations of Lin, geometry of Jones).
        Elastic = "elastic",
        /// Friction integrated over the contact ellipses: rolling, partial and gross slip.
        Traction = "traction",
    }
}
