//! What to order.

use bsm_design::PreloadMethod;

use super::state::AxisState;
use crate::InputKey;
use crate::case::axis::preload_method;
use crate::vocabulary::number::trimmed;
use crate::vocabulary::units::MM;

impl AxisState<'_> {
    /// What to order: size, nut, preload, grade, length, torque of the preload, travel, ends.
    pub(super) fn order(&self) -> String {
        let screw = &self.axis().screw;
        let mm = |metres: f64| trimmed(metres / MM);
        // The land is no nominal diameter.
        let nominal = self.scene.nominal_diameter_mm.or(self.scene.screw_outer_diameter_mm);
        let pitch = || format!("pitch circle {}", mm(screw.pitch_diameter));
        let size = nominal.map_or_else(pitch, trimmed);
        let mut parts = vec![format!("{size} x {}", mm(screw.lead))];
        if let Some((nut, _)) = &self.machine.groove {
            let circuits = self.scene.value_or_default(InputKey::circuits_count).unwrap_or(1.0);
            let of_each = trimmed(nut.turns / circuits);
            let turns = if circuits > 1.0 { format!("{circuits} x {of_each}") } else { of_each };
            parts.extend([format!("{turns} turns"), format!("ball {}", mm(nut.ball_diameter))]);
        }
        let method = match preload_method(self.scene) {
            PreloadMethod::DoubleNut => "double nut",
            PreloadMethod::Offset => "nut with a shifted lead",
            PreloadMethod::Oversize => "oversize balls",
        };
        match &self.preload {
            Some(preload) => {
                parts.extend([method.to_owned(), format!("preload {:.0} N", preload.cold)]);
            }
            None => parts.push("single nut".to_owned()),
        }
        parts.extend(self.grade().map(|grade| grade.name.to_owned()));
        parts.extend(self.shaft().map(|shaft| format!("thread {:.0}", shaft.length / MM)));
        if let Some(preload) = &self.preload {
            let percent = self.torque_percent();
            let percent = percent.map_or_else(String::new, |percent| format!(" +-{percent:.0} %"));
            parts.push(format!("T_p0 {:.2} N m{percent}", preload.by_rule));
        }
        if let (Some(target), Some(stroke)) = (self.travel_compensation(), self.scene.stroke_mm) {
            parts.push(format!("T = {target:.3}/{stroke:.0}"));
        }
        parts.extend(self.shaft().map(|shaft| shaft.support.name().to_owned()));
        parts.join(", ")
    }

    /// Permitted variation of the torque by which the preload is checked \[%\].
    pub(super) fn torque_percent(&self) -> Option<f64> {
        let (torque, diameter) = (self.preload.as_ref()?.by_rule, self.axis().screw.outer);
        self.grade()?.torque_variation(torque, self.shaft()?.length, diameter)
    }

    /// That torque at an end of its variation.
    pub(super) fn torque_by(&self, side: f64) -> Option<f64> {
        Some(self.preload.as_ref()?.by_rule * (1.0 + side * 0.01 * self.torque_percent()?))
    }

    /// Target of the travel over the stroke for a stretched screw \[mm\].
    pub(super) fn travel_compensation(&self) -> Option<f64> {
        let kelvin = self.pretension()?.stretched;
        Some(-self.expansion()? * self.scene.stroke_mm? * kelvin)
    }
}
