//! Figures for a table of nuts: ratings, stiffness, mass, life and torque as functions of the size.

use bsm_case::{InputKey, ManufacturerRow, OutputName, format_trimmed, output};

use crate::{Curve, Figure, MAX_CURVES, PlotAxis, Stroke};

/// Dimensions of a nut for the horizontal axis. The first dimension that the table contains is
/// used.
const SIZES: [(InputKey, &str); 2] = [
    (InputKey::nominal_diameter_mm, "nominal diameter, mm"),
    (InputKey::pitch_circle_diameter_mm, "pitch circle diameter, mm"),
];

/// A quantity for the vertical axis of a figure: file name, title, axis label, alternative columns
/// in order of preference, and factor that converts the column to the unit of the label.
type Drawn = (&'static str, &'static str, &'static str, &'static [OutputName], f64);

/// Quantities that are plotted against the selected dimension. The last two quantities are known
/// only if a requirement describes the axis.
const DRAWN: [Drawn; 6] = [
    (
        "nuts-dynamic-rating",
        "Dynamic load rating against size",
        "dynamic load rating, kN",
        &[output!(dynamic_load_rating_N), output!(our_dynamic_load_rating_N)],
        1e-3,
    ),
    (
        "nuts-static-rating",
        "Static load rating against size",
        "static load rating, kN",
        &[output!(static_load_rating_N), output!(our_static_load_rating_N)],
        1e-3,
    ),
    (
        "nuts-stiffness",
        "Stiffness of the nut against size",
        "stiffness of one nut, N/um",
        &[output!(stiffness_N_um), output!(our_stiffness_N_um)],
        1.0,
    ),
    (
        "nuts-mass",
        "Mass of the nut against size",
        "mass of a nut, kg",
        &[output!(nut_mass_kg)],
        1.0,
    ),
    (
        "nuts-life",
        "Life under the duty cycle of the axis against size",
        "life of the cycle, h",
        &[output!(cycle_life_h)],
        1.0,
    ),
    (
        "nuts-motor-torque",
        "Peak motor torque against size",
        "peak motor torque, N m",
        &[output!(peak_motor_torque_Nm)],
        1.0,
    ),
];

/// Returns figures of the ratings, stiffness and mass of the nuts in a table and, with a
/// requirement, of life and motor torque. Each nut is a circle, whose color represents the lead. A
/// figure with fewer than two nuts is omitted.
pub fn table_figures(rows: &[&ManufacturerRow]) -> Vec<Figure> {
    let has_size = |(key, _): &(InputKey, &str)| rows.iter().any(|row| row.input(*key).is_some());
    let Some((size, x)) = SIZES.into_iter().find(has_size) else { return Vec::new() };
    let figure = |(key, title, label, names, scale): Drawn| {
        let read = |row: &ManufacturerRow| {
            let value = names.iter().find_map(|name| row.value(*name))?;
            Some((row.input(size)?, scale * value))
        };
        let points: Vec<(f64, (f64, f64))> = rows
            .iter()
            .filter_map(|row| Some((row.input(InputKey::lead_mm)?, read(row)?)))
            .collect();
        let mut leads: Vec<_> = points.iter().map(|(lead, _)| *lead).collect();
        leads.sort_by(f64::total_cmp);
        leads.dedup();
        let left_out = leads.len().saturating_sub(MAX_CURVES);
        let curve = |(color, lead): (usize, &f64)| {
            let same = points.iter().filter(|(own, _)| own.to_bits() == lead.to_bits());
            let label = format!("lead {} mm", format_trimmed(*lead));
            Curve::new(label, color, Stroke::Circles, same.map(|(_, point)| *point).collect())
        };
        let curves = leads.iter().take(MAX_CURVES).enumerate().map(curve).collect();
        let rest = if left_out > 0 {
            format!(" The figure shows the {MAX_CURVES} smallest leads.")
        } else {
            String::new()
        };
        let caption = format!("Each circle represents a nut in the table.{rest}");
        (points.len() > 1).then(|| {
            Figure::new(
                [key, title, &caption],
                [PlotAxis::linear(x), PlotAxis::linear(label)],
                curves,
            )
        })
    };
    DRAWN.into_iter().filter_map(figure).collect()
}
