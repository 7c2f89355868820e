//! Index arithmetic of the systems of equations: (row) → words.

/// Unknowns and equations of one ball.
pub(crate) const BALL: usize = 7;

/// Row of the moment about the contact normal.
pub(crate) const MOMENT_NORMAL: usize = 4;

/// Rows: force and moment in the triad (t, N, e_x) of the loaded contacts, then the axial load.
const ROWS: [&str; BALL] = [
    "force balance along the helix (t)",
    "force balance along the contact normal (N)",
    "force balance across the groove (e_x)",
    "moment balance about t",
    "moment balance about the contact normal (N)",
    "moment balance about e_x",
    "axial load",
];

/// Equation of one ball in words.
pub(crate) fn equation(row: usize) -> &'static str {
    ROWS[row]
}
