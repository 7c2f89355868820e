//! The figures of the report: those of Lin, Velinsky and Ravani (1994), drawn again from our
//! solution, the way from rolling to gross skid, those of Sobolewski (2002), and the sweeps of slip and jamming.

use bsm_case::{Scene, Settings};
use bsm_dyn::{Control, Model, Solution};
use bsm_report::sheets::{around_scenes, catalogue_figures, points};
use bsm_report::{Axis, Curve, Figure, Stroke};

use crate::{Published, ValidateError, dong2020, elastic, lin1994, xu2015};

/// All figures.
///
/// # Errors
///
/// [`ValidateError`] if the data cannot be used.
pub fn figures(published: &Published) -> Result<Vec<Figure>, ValidateError> {
    let case = published.lin_case.scene()?;
    let mut figures = around_scenes(&case, &lin1994::slender(&case))?;
    figures.push(transition(&elastic::lin(published)?)?);
    figures.extend(xu2015::study(published, Model::RacewayControl, Control::Nut)?.figures);
    figures.extend(xu2015::study(published, Model::Rigid, Control::Nut)?.figures);
    let parkon = published.parkon.catalogue()?;
    figures.extend(catalogue_figures(&parkon, &parkon.places()));
    figures.extend(dong2020::study(published, Model::RacewayControl)?.figures);
    Ok(figures)
}

/// Efficiency against speed from rolling to gross skid: three models at three loads.
fn transition(lin: &Scene) -> Result<Figure, ValidateError> {
    let speeds: Vec<_> = (0..=60).map(|i| 300.0 * 100.0_f64.powf(f64::from(i) / 60.0)).collect();
    let mut curves = Vec::new();
    for (model, stroke) in [
        (Model::RacewayControl, Stroke::Dashed),
        (Model::Traction, Stroke::Solid),
        (Model::Elastic, Stroke::Dotted),
    ] {
        let settings = Settings { control: Some(Control::Nut), ..model.into() };
        for (color, load) in [2113.0, 100.0, 20.0].into_iter().enumerate() {
            let scene = Scene { axial_load_N: Some(load), ..lin.clone() };
            curves.push(Curve::new(
                format!("{}, {load} N", model.name()),
                color,
                stroke,
                points(&scene, &settings, "screw_speed_rpm", &speeds, Solution::efficiency)?,
            ));
        }
    }
    Ok(Figure::new(
        [
            "transition",
            "From rolling to gross skid: Lin's screw, one ball",
            "Traction (solid) leaves raceway control (dashed) and joins saturated friction \
                  (dotted) where friction gives way to the gyroscopic moment; under 2113 N it \
                  holds.",
        ],
        [Axis::log("screw speed, rpm"), Axis::linear("efficiency")],
        curves,
    ))
}
