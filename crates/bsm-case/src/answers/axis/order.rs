//! Order data of a screw, as printed on the axis sheet.

use bsm_design::{Make, NutSet, PreloadMethod};

use super::Preload;
use super::state::AxisState;
use crate::InputKey;
use crate::case::axis::TorqueTolerance;
use crate::case::axis_inputs::{given_make, nut_set, preload_method};
use crate::vocabulary::entries::Choice;
use crate::vocabulary::number::format_trimmed;
use crate::vocabulary::units::MM;

/// An entry in the order data of a screw.
#[derive(Debug, Clone, PartialEq)]
struct OrderEntry {
    what: &'static str,
    /// Words that precede the text if all entries are printed on one line.
    prefix: &'static str,
    text: String,
}

/// Order data, one entry per line.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Order(Vec<OrderEntry>);

impl Order {
    /// Returns each quantity of the order data with its text, followed by the data that the
    /// customer still has to specify.
    pub fn rows(&self) -> impl Iterator<Item = (&'static str, &str)> {
        const OTHERS: [(&str, &str); 2] =
            [("ends of the shaft", "by drawing"), ("wipers, lubrication port", "to be chosen")];
        self.0.iter().map(|entry| (entry.what, entry.text.as_str())).chain(OTHERS)
    }

    fn add(&mut self, what: &'static str, prefix: &'static str, text: impl Into<Option<String>>) {
        self.0.extend(text.into().map(|text| OrderEntry { what, prefix, text }));
    }
}

impl std::fmt::Display for Order {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let text = |OrderEntry { prefix, text, .. }: &OrderEntry| format!("{prefix}{text}");
        f.write_str(&self.0.iter().map(text).collect::<Vec<_>>().join(", "))
    }
}

impl AxisState<'_> {
    /// Returns the order data: manufacturer, size, nut, preload, grade, make, length, preload
    /// torque,
    /// travel and bearings.
    pub(super) fn order(&self) -> Order {
        let screw = &self.axis().screw;
        let units = self.case.display_units();
        let (in_mm, force, torque_unit) = (units.of("mm"), units.of("N"), units.of("N m"));
        let mm = |meters: f64| format_trimmed(in_mm.value(meters / MM));
        let length = |meters: f64| units.length(meters / MM);
        // Without `nut_length_mm`, the nut length and all lengths that include the nut are
        // estimates.
        let estimate = if self.case.nut_length_mm.is_none() { " (estimated)" } else { "" };
        let with_nut = |meters: f64| length(meters) + estimate;
        // A calculated land diameter must not be stated as the nominal diameter.
        let nominal = self.case.nominal_diameter_mm.or(self.case.screw_outer_diameter_mm);
        let pitch = || format!("pitch circle {}", mm(screw.pitch_diameter));
        let size = nominal.map_or_else(pitch, |nominal| format_trimmed(in_mm.value(nominal)));
        let mut order = Order::default();
        order.add("manufacturer", "", self.case.entries.manufacturer.clone());
        order.add("code", "", self.case.entries.order_code.clone());
        let is_known =
            screw.lead.is_finite() && (nominal.is_some() || screw.pitch_diameter.is_finite());
        let size = is_known.then(|| format!("{size} x {} {}", mm(screw.lead), in_mm.text));
        order.add("size", "", size);
        // The order data do not contain the ball diameter of an estimated groove.
        let given = self.machine.groove.as_ref().filter(|_| !self.case.has_estimated_groove());
        if let Some((nut, _)) = given {
            let circuits = self.case.number(InputKey::circuits_count);
            let of_each = format_trimmed(nut.turns / circuits);
            let turns = if circuits > 1.0 { format!("{circuits} x {of_each}") } else { of_each };
            let nuts = match nut_set(self.case) {
                NutSet::Single => "",
                NutSet::Pair { .. } => "2 nuts x ",
                NutSet::ShiftedLead => "2 x ",
            };
            order.add("loaded turns", "", format!("{nuts}{turns} turns"));
            order.add("balls", "ball ", format!("{} {}", mm(nut.ball_diameter), in_mm.text));
        }
        let method = match preload_method(self.case) {
            _ if self.preload.is_none() => "single nut, length",
            PreloadMethod::DoubleNut => "double nut, length",
            PreloadMethod::Offset => "nut with a shifted lead, length",
            PreloadMethod::Oversize => "nut with oversize balls, length",
        };
        let nut_length = Some(self.machine.body.length).filter(|length| length.is_finite());
        order.add("nut", "", nut_length.map(|length| format!("{method} {}", with_nut(length))));
        let preload = self.preload.as_ref();
        let cold = |preload: &Preload| format!("{:.0} {}", force.value(preload.cold), force.text);
        order.add("preload", "preload ", preload.map(cold));
        order.add("accuracy grade", "", self.grade().map(|grade| grade.name.to_owned()));
        let make = given_make(self.case).map(|make| match make {
            Make::Rolled => "rolled screw",
            Make::Ground => "ground screw",
            Make::Caged => "screw with a ball cage",
            Make::HighSpeed => "screw with a high-speed ball return",
        });
        order.add("make of the screw", "", make.map(str::to_owned));
        let shaft = self.shaft();
        order.add("thread", "thread ", self.machine.thread.map(with_nut));
        let is_given = self.case.unsupported_length_mm.is_some();
        let between =
            shaft.map(|shaft| if is_given { length(shaft.length) } else { with_nut(shaft.length) });
        order.add("length between bearings", "length between bearings ", between);
        let percent = self.torque_percent();
        let percent = percent.map_or_else(String::new, |percent| format!(" +-{percent:.0} %"));
        let torque = |preload: &Preload| {
            format!("{:.2} {}{percent}", torque_unit.value(preload.by_rule), torque_unit.text)
        };
        order.add("friction torque due to preload", "T_p0 ", preload.map(torque));
        let travel = self.travel_compensation().zip(self.machine.stroke);
        let travel = travel.map(|(target, stroke)| format!("T = {target:.3}/{:.0}", stroke / MM));
        order.add("travel compensation, mm", "", travel);
        order.add("bearings", "", shaft.map(|shaft| shaft.support.name().to_owned()));
        let count = self.case.number(InputKey::screws_count);
        let screws = if count > 1.0 { "screws with nuts" } else { "screw with nut" };
        order.add("number of screws with nuts", "", format!("{count} {screws}"));
        order
    }

    /// Returns the permitted variation of the drag torque that is measured to verify the preload
    /// \[%\].
    pub(super) fn torque_percent(&self) -> Option<f64> {
        self.torque_tolerance().percent(self.preload.as_ref()?.by_rule)
    }

    /// Returns one of the limits for the drag torque that is measured to verify the preload
    /// \[N·m\]: the lower limit if `side` is -1, and the upper limit if `side` is 1.
    pub(super) fn torque_by(&self, side: f64) -> Option<f64> {
        self.torque_tolerance().end(self.preload.as_ref()?.by_rule, side)
    }

    pub(super) fn torque_tolerance(&self) -> TorqueTolerance {
        TorqueTolerance {
            grade: self.grade(),
            length: self.machine.thread.or(self.shaft().map(|shaft| shaft.length)),
            diameter: self.axis().screw.outer,
        }
    }

    /// Returns the travel compensation of a pretensioned screw over its stroke \[mm\].
    pub(super) fn travel_compensation(&self) -> Option<f64> {
        let kelvin = self.pretension()?.stretched;
        Some(-self.expansion()? * self.machine.stroke? / MM * kelvin)
    }
}
