//! Sets of inputs, and rules that determine which inputs are replaced when new inputs are given.

use std::f64::consts::PI;

use bsm_design::Make;
use bsm_kin::Scalar;

use super::entries::{CaseEntries, InputName};
use super::number::count;

use crate::vocabulary::error::invalid_input;
use crate::vocabulary::units::{DEG, MM};
use crate::{Case, CaseError, INPUTS, InputKey};

/// Creates a set of inputs from their names.
macro_rules! inputs {
    ($($key:ident)*) => { $crate::InputSet::of(&[$($crate::InputKey::$key),*]) };
}

pub(crate) use inputs;

/// Number of bits in one word of an [`InputSet`].
const BITS: usize = u128::BITS as usize;

/// A set of inputs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct InputSet([u128; 2]);

const _: () = assert!(INPUTS.len() <= 2 * BITS, "each input has a bit");

impl InputSet {
    /// Inputs that have a default.
    pub const WITH_DEFAULT: Self = {
        let (mut set, mut i) = (Self([0; 2]), 0);
        while i < INPUTS.len() {
            if INPUTS[i].default.is_some() {
                set = set.with(i);
            }
            i += 1;
        }
        set
    };

    const fn with(mut self, place: usize) -> Self {
        self.0[place / BITS] |= 1 << (place % BITS);
        self
    }

    /// Creates the set of the given inputs.
    pub const fn of(keys: &[InputKey]) -> Self {
        let (mut set, mut i) = (Self([0; 2]), 0);
        while i < keys.len() {
            set = set.with(keys[i] as usize);
            i += 1;
        }
        set
    }

    /// Adds an input if `is_given` is true.
    #[inline]
    pub(super) fn add(&mut self, key: InputKey, is_given: bool) {
        let place = key as usize;
        self.0[place / BITS] |= u128::from(is_given) << (place % BITS);
    }

    /// Returns the union of two sets.
    #[must_use]
    pub const fn union(self, other: Self) -> Self {
        Self([self.0[0] | other.0[0], self.0[1] | other.0[1]])
    }

    /// Returns the intersection of two sets.
    const fn intersection(self, other: Self) -> Self {
        Self([self.0[0] & other.0[0], self.0[1] & other.0[1]])
    }

    /// Returns the inputs of this set that are not in `other`.
    #[must_use]
    pub const fn without(self, other: Self) -> Self {
        Self([self.0[0] & !other.0[0], self.0[1] & !other.0[1]])
    }

    /// Returns true if the set contains the input.
    pub fn contains(self, key: InputKey) -> bool {
        let place = key as usize;
        self.0[place / BITS] >> (place % BITS) & 1 == 1
    }

    /// Returns true if the set contains all inputs of `other`.
    pub fn contains_all(self, other: Self) -> bool {
        self.union(other) == self
    }

    /// Returns true if the set contains any input of `other`.
    pub fn intersects(self, other: Self) -> bool {
        self.intersection(other) != Self::default()
    }

    /// Returns an iterator over the inputs, in the order of the documentation.
    pub fn iter(self) -> impl Iterator<Item = InputKey> {
        self.0.into_iter().enumerate().flat_map(|(word, mut left)| {
            std::iter::from_fn(move || {
                let bit = left.trailing_zeros() as usize;
                let key = InputKey::ALL.get(word * BITS + bit).filter(|_| left != 0)?;
                left &= left - 1;
                Some(*key)
            })
        })
    }

    /// Returns the inputs that are replaced when the inputs of this set get new values: the inputs
    /// of the set itself, and other forms of the same quantities. For example, a lead replaces a
    /// lead angle, and a viscosity replaces a friction coefficient.
    #[must_use]
    pub fn replaced(self) -> Self {
        let coefficient = inputs! { friction_coefficient };
        let friction = match (self.intersects(coefficient), self.intersects(VISCOSITY.keys())) {
            (true, false) => LUBRICANT_INPUTS,
            (false, true) => coefficient,
            _ => Self::default(),
        };
        QUANTITIES
            .iter()
            .map(QuantityForms::keys)
            .filter(|keys| keys.intersects(self))
            .fold(self.union(friction), Self::union)
    }

    /// Returns the set together with the inputs that can be calculated from the inputs of the set
    /// (see [`derived_input`]).
    #[must_use]
    pub fn completed(self) -> Self {
        let known = |key| self.contains(key).then_some(1.0);
        let follow = [InputKey::loaded_balls, InputKey::screw_speed_rpm].into_iter();
        self.union(follow.filter(|key| derived_input(*key, known).is_some()).collect())
    }

    /// Returns the quantities of the set that are given in more than one form, each with two of the
    /// given forms.
    pub(crate) fn two_forms(self) -> impl Iterator<Item = [InputKey; 2]> {
        QUANTITIES.iter().filter_map(move |quantity| {
            let mut given =
                quantity.forms.iter().map(|form| form.key).filter(|key| self.contains(*key));
            Some([given.next()?, given.next()?])
        })
    }

    /// Checks that no quantity is given in two forms. Lead and lead angle may both be given, but
    /// must be consistent (see [`Relation::LeadsAgree`](crate::Relation::LeadsAgree)).
    ///
    /// # Errors
    ///
    /// Returns [`CaseError::Entry`] if a quantity is given in two forms.
    pub fn check_forms(self) -> Result<(), CaseError> {
        let agrees = |keys: &[InputKey; 2]| keys[0] == LEAD.forms[0].key;
        match self.two_forms().find(|keys| !agrees(keys)) {
            Some(keys) => Err(CaseError::given_twice(keys.map(InputKey::name))),
            None => Ok(()),
        }
    }

    /// Returns the inputs that a case with the inputs of this set contains after `settings` have
    /// been applied.
    #[must_use]
    pub fn overridden_by(self, settings: Self) -> Self {
        self.without(settings.replaced()).union(settings)
    }
}

impl FromIterator<InputKey> for InputSet {
    fn from_iter<I: IntoIterator<Item = InputKey>>(keys: I) -> Self {
        keys.into_iter().fold(Self::default(), |set, key| set.union(Self::of(&[key])))
    }
}

/// A quantity that may be given in one of several forms.
#[derive(Debug)]
pub(crate) struct QuantityForms {
    /// Text that describes the forms of the quantity in messages about missing inputs.
    pub(crate) words: &'static str,
    /// Forms of the quantity.
    pub(crate) forms: &'static [Form],
}

/// One of the forms in which a quantity may be given.
#[derive(Debug)]
pub(crate) struct Form {
    /// Main input of this form of the quantity.
    pub(crate) key: InputKey,
    /// Additional inputs that are needed if the quantity is given in this form.
    pub(crate) with: InputSet,
    pub(crate) to: &'static str,
}

impl QuantityForms {
    /// Returns the main input of each form of the quantity.
    fn keys(&self) -> InputSet {
        self.forms.iter().map(|form| form.key).collect()
    }
}

/// Declares quantities with several forms. Each quantity has a text for messages and a list of its
/// forms.
macro_rules! forms {
    ($($(#[doc = $about:literal])* $visible:vis $quantity:ident, $words:literal:
        $($key:ident $(with $other:ident $to:literal)?),+;)*) => {
        $($(#[doc = $about])* $visible const $quantity: QuantityForms = QuantityForms {
            words: $words,
            forms: &[$(Form {
                key: InputKey::$key,
                with: InputSet::of(&[$(InputKey::$other)?]),
                to: concat!($($to)?),
            },)+],
        };)*

        /// All quantities with several forms.
        const QUANTITIES: &[QuantityForms] = &[$($quantity),*];
    };
}

forms! {
    /// Lead angle, or lead together with the pitch circle diameter.
    pub(crate) LEAD, "lead_angle_deg (or lead_mm)":
        lead_angle_deg, lead_mm with pitch_circle_diameter_mm "to convert lead_mm to an angle";
    /// Contact angle, or the distance between the groove bottoms, from which the contact angle is
    /// calculated. The distance is used only for the ratings of a nut.
    pub(crate) CONTACT_ANGLE, "contact_angle_deg (or groove_bottom_distance_mm)": contact_angle_deg, groove_bottom_distance_mm;
    /// Speed of the screw, or feed rate of the nut.
    SPEED, "screw_speed_rpm (or feed_m_min)": screw_speed_rpm, feed_m_min with lead_mm "to convert feed_m_min to a speed";
    /// Viscosity of the lubricant, given at two temperatures or by its grade.
    pub(crate) VISCOSITY, "iso_vg (or viscosity_40C_mm2_s and viscosity_100C_mm2_s)":
        viscosity_40C_mm2_s with viscosity_100C_mm2_s "for the viscosity at other temperatures", iso_vg;
    /// Temperature of the lubricant, or the inputs from which it is calculated.
    pub(crate) TEMPERATURE, "lubricant_temperature_C (or heat_transfer_W_K and ambient_temperature_C)":
        heat_transfer_W_K with ambient_temperature_C "for the heat transfer to the surroundings", lubricant_temperature_C;
    /// Thermal conductance from nut and table to the air.
    NUT_IN_AIR, "nut_conductance_W_K (or carriage_area_m2)": nut_conductance_W_K, carriage_area_m2;
    /// Thermal conductance from a hollow screw to its coolant.
    COOLED_SCREW, "coolant_flow_l_min (or coolant_conductance_W_K)":
        coolant_flow_l_min with screw_bore_mm "for the flow through the screw", coolant_conductance_W_K;
    /// Pretension of a screw between two fixed bearings.
    PRETENSION, "pretension_N (or pretension_K)": pretension_N, pretension_K;
    /// Required life in one of several units.
    REQUIRED_LIFE, "required_life_h (or _revolutions, _km, _cycles, _strokes or _years)":
        required_life_h, required_life_revolutions, required_life_km, required_life_cycles,
        required_life_strokes, required_life_years;
    /// Hardness of the raceways.
    HARDNESS, "hardness_HRC (or hardness_HV10)": hardness_HRC, hardness_HV10;
}

/// Returns the value of an input that is calculated from other inputs: the number of balls from the
/// balls per turn, or the speed from the feed rate.
pub fn derived_input(key: InputKey, given: impl Fn(InputKey) -> Option<f64>) -> Option<f64> {
    use InputKey as K;
    match key {
        K::loaded_balls => {
            let balls = given(K::loaded_balls_per_turn)? * loaded_turns(&given)?;
            match (given(K::loaded_turns), given(K::circuits_count)) {
                // The loaded arc of each circuit is one turn minus the gap, and each circuit
                // contains a whole number of balls.
                (None, Some(circuits)) => Some((balls / circuits).round() * circuits),
                _ => Some(balls),
            }
        }
        K::screw_speed_rpm => {
            let feed = given(K::feed_m_min)?;
            let lead = given(K::lead_mm).or_else(|| {
                let angle = given(K::lead_angle_deg)? * DEG;
                Some(lead_mm(angle, given(K::pitch_circle_diameter_mm)?))
            })?;
            Some(feed / (lead * MM))
        }
        _ => None,
    }
}

/// Returns the lead angle \[rad\]: tanα = L / (π d).
pub(crate) fn lead_angle<D: Scalar>(lead_mm: D, pitch_circle_diameter_mm: D) -> D {
    (lead_mm / (pitch_circle_diameter_mm * PI)).atan()
}

/// Returns the lead \[mm\]: L = π d tanα.
pub(crate) fn lead_mm(lead_angle: f64, pitch_circle_diameter_mm: f64) -> f64 {
    PI * pitch_circle_diameter_mm * lead_angle.tan()
}

/// Returns the number of loaded turns. This is either the given number, or the number of circuits
/// times the loaded arc of a circuit, which is one turn minus the gap.
pub(crate) fn loaded_turns(given: impl Fn(InputKey) -> Option<f64>) -> Option<f64> {
    let by_gap = || {
        let arc = 360.0 - given(InputKey::gap_deg)?;
        Some(given(InputKey::circuits_count)? * arc / 360.0)
    };
    given(InputKey::loaded_turns).or_else(by_gap)
}

/// Inputs whose presence means that friction is calculated from a lubricant. Density and drag
/// coefficient are not included, because the jamming analysis also uses them for dry balls.
pub(crate) const LUBRICANT_INPUTS: InputSet = inputs! {
    iso_vg viscosity_40C_mm2_s viscosity_100C_mm2_s pressure_viscosity_1_GPa
    limiting_shear_ratio boundary_friction_coefficient lubricant_temperature_C
    heat_transfer_W_K ball_roughness_um nut_roughness_um screw_roughness_um film_factor
    rolling_factor hysteresis_loss ball_contact_force_N return_circuits return_loss_coefficient
};

impl InputSet {
    /// Lubricant inputs that must be constant in a table in which only the temperature of the
    /// lubricant varies.
    pub(crate) const CONSTANT_LUBRICANT_INPUTS: Self = {
        // Lubricant inputs that are also valid for a dry ball.
        let more = inputs! {
            lubricant_density_kg_m3 seal_torque_Nm drag_coefficient ambient_temperature_C
        };
        LUBRICANT_INPUTS.union(more).without(inputs! { lubricant_temperature_C })
    };

    /// Inputs that state the load and the speed of a single operating point. A cycle states the
    /// loads and speeds of all phases instead.
    pub(crate) const LOAD_AND_SPEED: Self =
        inputs! { axial_load_N screw_speed_rpm feed_m_min nut_speed_rpm };

    /// Running contact angles that replace the contact angles calculated by a model.
    pub const RUNNING_ANGLES: Self =
        inputs! { nut_running_contact_angle_deg screw_running_contact_angle_deg };

    /// Returns true if friction is calculated from a lubricant.
    pub fn is_lubricated(self) -> bool {
        self.intersects(LUBRICANT_INPUTS)
    }

    /// Returns true if a friction coefficient or a lubricant is given.
    pub(crate) fn has_friction(self) -> bool {
        self.contains(InputKey::friction_coefficient) || self.is_lubricated()
    }

    /// Checks that friction is given in only one form, and that inputs that require each other are
    /// given together.
    pub(crate) fn check_friction(self) -> Result<(), CaseError> {
        use InputKey as K;
        if self.contains(InputKey::friction_coefficient)
            && let Some(key) = self.intersection(LUBRICANT_INPUTS).iter().next()
        {
            return Err(CaseError::Invalid(format!(
                "give either friction_coefficient or a lubricant, but friction_coefficient and {} are given",
                key.name()
            )));
        }
        let pairs = [
            [K::viscosity_40C_mm2_s, K::viscosity_100C_mm2_s],
            [K::viscosity_100C_mm2_s, K::viscosity_40C_mm2_s],
            [K::heat_transfer_W_K, K::ambient_temperature_C],
            [K::nut_running_contact_angle_deg, K::screw_running_contact_angle_deg],
            [K::screw_running_contact_angle_deg, K::nut_running_contact_angle_deg],
        ];
        let half =
            pairs.into_iter().find(|[one, other]| self.contains(*one) && !self.contains(*other));
        match half {
            Some([one, other]) => {
                Err(invalid_input(one.name(), format!("also needs {}", other.name())))
            }
            None => Ok(()),
        }
    }
}

impl Case {
    /// Returns the inputs whose values are known: given inputs, inputs that follow from other
    /// entries, and inputs that the warm state determines.
    pub fn stated(&self) -> InputSet {
        let given = self.given();
        let listed = self.entries.circuits.as_ref().map(|_| InputKey::loaded_balls);
        let warm = self.requests_warm_state() && given.is_lubricated();
        let found = warm.then_some(InputKey::lubricant_temperature_C);
        let class = self.entries.contamination.as_ref().map(|_| InputKey::contamination_factor);
        given.union(listed.into_iter().chain(found).chain(class).collect())
    }

    /// Returns the value of an input that is not given but follows from other inputs, from the
    /// circuits of the nut or from the manufacturing method of the screw.
    #[inline(never)]
    pub(crate) fn derived_value(&self, key: InputKey) -> Option<f64> {
        match (key, &self.entries) {
            (InputKey::loaded_balls, CaseEntries { circuits: Some(circuits), .. }) => {
                let first = circuits.iter().filter(|circuit| circuit.body == 0);
                Some(count(first.map(|circuit| circuit.balls).sum()))
            }
            (InputKey::screw_roughness_um, CaseEntries { screw_make: Some(make), .. })
                if make.0 == Make::Rolled =>
            {
                Some(0.4)
            }
            _ => derived_input(key, |key| self[key]),
        }
    }

    /// Applies all values of `settings` at once. A new form of a quantity replaces its other forms.
    ///
    /// This function also applies the values of grid points and other changes of a case.
    pub fn override_with(&mut self, settings: &Self) {
        let given = settings.given();
        self.remove_replaced(given);
        for key in given.iter() {
            self[key] = settings[key];
        }
        // A new preload class replaces the preload that was given before.
        if settings.entries.preload_class.is_some() && settings.preload_N.is_none() {
            self.preload_N = None;
        }
        self.entries.override_with(&settings.entries);
    }

    /// Applies several numbers at once like [`override_with`](Self::override_with), but without
    /// creating a second case. This function is used for the rows of a table.
    pub fn override_with_numbers(&mut self, numbers: &[(InputKey, f64)]) {
        self.remove_replaced(numbers.iter().map(|(key, _)| *key).collect());
        for (key, value) in numbers {
            self[*key] = Some(*value);
        }
    }

    /// Removes the inputs that are replaced when the inputs in `given` get new values.
    fn remove_replaced(&mut self, given: InputSet) {
        for key in given.replaced().without(given).iter() {
            self[key] = None;
        }
        // An input that the user gives is no longer an estimate.
        if let Some(estimated) = &mut self.entries.estimated_inputs {
            estimated.retain(|InputName(key)| !given.contains(*key));
        }
        // A new load or speed replaces the cycle, which states the loads and speeds of all phases.
        if given.intersects(InputSet::LOAD_AND_SPEED) {
            self.entries.cycle = None;
        }
        // A new preload replaces the preload class that was given before.
        if given.contains(InputKey::preload_N) {
            self.entries.preload_class = None;
        }
    }
}
