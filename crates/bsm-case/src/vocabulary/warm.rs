//! What a scene says of its warm steady state.

use serde::{Deserialize, Serialize};

use crate::{CaseError, Rule};

macro_rules! numbers {
    ($($name:ident $rule:expr, $about:literal;)*) => {
        /// What the warm steady state of an axis follows from.
        #[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
        #[serde(deny_unknown_fields, default)]
        #[expect(non_snake_case, reason = "names carry their unit as it is written")]
        pub struct WarmWords {
            $(#[doc = $about] #[serde(skip_serializing_if = "Option::is_none")] pub $name: Option<f64>,)*
            /// What flows through a hollow screw; water unless given.
            #[serde(skip_serializing_if = "Option::is_none")]
            pub coolant: Option<CoolantWord>,
            /// False: no drag beyond the contacts; manufacturers' rule unless given.
            #[serde(skip_serializing_if = "Option::is_none")]
            pub drag_rule: Option<bool>,
            /// What was found, of a scene in its warm state.
            #[serde(skip)]
            pub(crate) found: Option<Found>,
        }

        impl WarmWords {
            /// Its keys as [`schema_of`](crate::schema_of) has them.
            pub(crate) const MEMBERS: &str = concat!(
                $(stringify!($name), "? number?, ",)* "coolant? water|oil?, drag_rule? boolean?"
            );

            pub(crate) fn check(&self) -> Result<(), CaseError> {
                $(if let Some(value) = self.$name {
                    let rule: Rule = $rule;
                    rule.check(concat!("warm_state.", stringify!($name)), value)?;
                })*
                Ok(())
            }

            /// One of everything.
            #[cfg(test)]
            pub(crate) fn of_ones() -> serde_json::Value {
                serde_json::json!({
                    $(stringify!($name): 1.0,)* "coolant": "oil", "drag_rule": true,
                })
            }
        }
    };
}

numbers! {
    preload_temperature_C Rule::Within(-40.0, 150.0), "at which preload and fits are set; 20";
    ambient_temperature_C Rule::Within(-40.0, 150.0), "of the air; preload_temperature_C";
    structure_temperature_C Rule::Within(-40.0, 150.0), "of what carries the bearings; ambient_temperature_C";
    coolant_temperature_C Rule::Within(-40.0, 150.0), "of the coolant; ambient_temperature_C";
    nut_conductance_W_K Rule::Above(0.0), "nut and table to air, 2 to 20; computed, known by a factor of 2";
    carriage_area_m2 Rule::Above(0.0), "of bracket and table, in place of nut_conductance_W_K; ten times that of the nut";
    screw_film_W_m2K Rule::Above(0.0), "of the screw in air, 10 to 60; computed, known by a factor of 1.4";
    gap_conductance_W_K Rule::Above(0.0), "of gap and wipers, 0.2 to 3; computed, known by a factor of 3";
    ball_nut_conductance_W_K Rule::Above(0.0), "balls to nut; computed, known by a factor of 2";
    ball_screw_conductance_W_K Rule::Above(0.0), "balls to screw; computed, known by a factor of 2";
    end_conductance_W_K Rule::Above(0.0), "each end of the screw to the structure, 2 to 20; computed, known by a factor of 3";
    nut_coolant_conductance_W_K Rule::Above(0.0), "nut to the coolant, 20 to 60 of a cooled nut; none";
    screw_bore_mm Rule::Above(0.0), "of a hollow screw; none";
    coolant_flow_l_min Rule::Above(0.0), "through the bore; none";
    coolant_conductance_W_K Rule::Above(0.0), "screw to the coolant, in place of coolant_flow_l_min; none";
    pretension_N Rule::AtLeast(0.0), "of a screw between two fixed bearings; 0";
    pretension_K Rule::AtLeast(0.0), "rise that a screw between two fixed bearings is stretched by, 2 to 5; 0";
    extra_drag_factor Rule::AtLeast(0.0), "drag beyond the contacts over the warm preload times the lead over 2 pi; by manufacturers' rule";
    motor_heat_W Rule::AtLeast(0.0), "that the motor gives to end 1; 0";
    fold_search_factor Rule::Above(1.0), "up to which multiple of the speeds the fold is looked for; 2";
    steel_conductivity_W_m_K Rule::Above(0.0), "of steel; 45";
}

/// How warm the nut of a scene is, in SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Found {
    /// Rises of nut, screw and balls \[K\].
    pub(crate) rises: [f64; 3],
    /// Strain of the screw by its tension.
    pub(crate) strain: f64,
}

/// What flows through a hollow screw.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum CoolantWord {
    /// Water.
    Water,
    /// Oil.
    Oil,
}
