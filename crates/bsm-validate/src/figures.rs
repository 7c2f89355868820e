//! Figures of the validation report: the figures of Lin, Velinsky and Ravani (1994), calculated by
//! this program; the transition from rolling to gross skid; the figures of Sobolewski (2002); the
//! sweeps for slip and jamming; and a warm feed axis.

use bsm_case::{Case, Settings, WarmBranch};
use bsm_dyn::{Control, Model, Solution, model::RacewayFriction};
use bsm_report::sheets::{catalog_figures, lin_figures_with_fig5_case, points, warm_preload};
use bsm_report::{Curve, Figure, PlotAxis, Stroke};

use crate::{PublishedData, ValidateError, dong2020, elastic, lin1994, xu2015};

/// Returns all figures of the validation report.
///
/// # Errors
///
/// Returns [`ValidateError`] if the published data are invalid.
pub fn figures(published: &PublishedData) -> Result<Vec<Figure>, ValidateError> {
    let case = published.lin_case.case()?;
    let mut figures = lin_figures_with_fig5_case(&case, &lin1994::slender(&case))?;
    figures.push(transition(&elastic::lin(published)?)?);
    figures.extend(xu2015::study(published, Model::RacewayControl, Control::Nut)?.figures);
    figures.extend(xu2015::study(published, Model::Rigid, Control::Nut)?.figures);
    let parkon = published.parkon.catalog()?;
    figures.extend(catalog_figures(&parkon, &parkon.indices()));
    figures.extend(dong2020::study(published, Model::RacewayControl)?.figures);
    figures.push(feed_axis(&published.feed_axis.case()?)?);
    Ok(figures)
}

/// Plots the warm preload against the speed for a feed axis with a cooled nut. The curves show both
/// arrangements of the nuts, dry and lubricated.
fn feed_axis(axis: &Case) -> Result<Figure, ValidateError> {
    /// Thermal conductance between the nut and a heavy saddle \[W/K\].
    const COOLED: f64 = 20.0;
    let dry = Case {
        friction_coefficient: Some(0.06),
        iso_vg: None,
        ball_roughness_um: None,
        nut_roughness_um: None,
        screw_roughness_um: None,
        ..axis.clone()
    };
    // A calculation with one friction coefficient per contact takes one sixth of the time. It
    // changes the speed at the fold by 0.4 %, which is less than the width of a line in the figure.
    let friction = RacewayFriction::PerContact;
    let settings =
        Settings { control: Some(Control::Nut), friction, ..Model::RacewayControl.into() };
    let mut branches = Vec::new();
    for (state, case) in [("lubricated", axis), ("dry", &dry)] {
        for arrangement in ["X", "O"] {
            let mut case = case.clone();
            case.nut_conductance_W_K = Some(COOLED);
            case.apply(&[format!("preload_arrangement={arrangement}")])?;
            let branch = WarmBranch::of(&case, &settings)?;
            branches.extend(branch.map(|branch| (format!("{arrangement}, {state}"), branch)));
        }
    }
    let branches: Vec<_> = branches.iter().map(|(label, branch)| (label, branch)).collect();
    Ok(warm_preload(
        [
            "feed-axis",
            "Preload of a feed axis with a cooled nut",
            "The preload of the cold nut is 2500 N. In X arrangement, a screw that is warmer than the nut increases the \
             preload, which increases the heat. Above the speed of the circle, no steady state exists. Below this speed, \
             a disturbance beyond the dashed line also causes a thermal runaway. In O arrangement, the preload hardly \
             changes.",
        ],
        &branches,
    ))
}

/// Plots the efficiency against the speed for three models at three loads. The speeds range from
/// rolling to gross skid.
fn transition(lin: &Case) -> Result<Figure, ValidateError> {
    let speeds: Vec<_> = (0..=60).map(|i| 300.0 * 100.0_f64.powf(f64::from(i) / 60.0)).collect();
    let mut curves = Vec::new();
    for (model, stroke) in [
        (Model::RacewayControl, Stroke::Dashed),
        (Model::Traction, Stroke::Solid),
        (Model::Elastic, Stroke::Dotted),
    ] {
        let settings = Settings { control: Some(Control::Nut), ..model.into() };
        for (color, load) in [2113.0, 100.0, 20.0].into_iter().enumerate() {
            let case = Case { axial_load_N: Some(load), ..lin.clone() };
            curves.push(Curve::new(
                format!("{}, {load} N", model.name()),
                color,
                stroke,
                points(&case, &settings, "screw_speed_rpm", &speeds, Solution::efficiency)?,
            ));
        }
    }
    Ok(Figure::new(
        [
            "transition",
            "From rolling to gross skid: Lin's screw, one ball",
            "At low speed, traction (solid) agrees with raceway control (dashed). At high speed, it agrees with \
                  saturated friction (dotted), because friction can no longer support the gyroscopic moment. Under \
                  2113 N, friction supports this moment at all speeds in the figure.",
        ],
        [PlotAxis::log("screw speed, rpm"), PlotAxis::linear("efficiency")],
        curves,
    ))
}
