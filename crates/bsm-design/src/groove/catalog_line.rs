//! A row of a catalog.

use bsm_dyn::Conformities;

/// Millimeters per meter. The prior uses lengths in mm.
pub(super) const PER_M: f64 = 1e3;

/// One catalog row, which contains everything that is known about a screw and its nut.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CatalogLine {
    /// Nominal diameter \[m\], positive.
    pub nominal_diameter: f64,
    /// Lead \[m\], positive.
    pub lead: f64,
    /// Dynamic axial load rating \[N\], positive.
    pub dynamic_rating: f64,
    /// Static axial load rating \[N\], positive.
    pub static_rating: Option<f64>,
    /// Ball diameter \[m\], positive.
    pub ball_diameter: Option<f64>,
    /// Pitch circle diameter \[m\], positive.
    pub pitch_diameter: Option<f64>,
    /// Core diameter of the screw \[m\], positive.
    pub core: Option<f64>,
    /// Total number of loaded turns of all circuits, positive.
    pub turns: Option<f64>,
    /// Conformities of nut and screw, above 1/2.
    pub conformity: Conformities<Option<f64>>,
    /// Contact angle \[rad\], in (0, π/2).
    pub contact_angle: Option<f64>,
}
