//! Sets of inputs, and how a given set changes another set.

use std::f64::consts::PI;

use bsm_design::Make;
use bsm_kin::Scalar;

use super::entries::{CaseEntries, InputName};
use super::number::count;

use crate::vocabulary::error::bad;
use crate::vocabulary::units::{DEG, MM};
use crate::{Case, CaseError, INPUTS, InputKey};

/// A set of inputs by their names.
macro_rules! inputs {
    ($($key:ident)*) => { $crate::InputSet::of(&[$($crate::InputKey::$key),*]) };
}

pub(crate) use inputs;

/// Bits of a word of an [`InputSet`].
const BITS: usize = u128::BITS as usize;

/// Some of the inputs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct InputSet([u128; 2]);

const _: () = assert!(INPUTS.len() <= 2 * BITS, "a bit for each input");

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

    /// These inputs.
    pub const fn of(keys: &[InputKey]) -> Self {
        let (mut set, mut i) = (Self([0; 2]), 0);
        while i < keys.len() {
            set = set.with(keys[i] as usize);
            i += 1;
        }
        set
    }

    /// Takes an input in, if it `is_given`.
    #[inline]
    pub(super) fn add(&mut self, key: InputKey, is_given: bool) {
        let place = key as usize;
        self.0[place / BITS] |= u128::from(is_given) << (place % BITS);
    }

    /// The inputs of either set.
    #[must_use]
    pub const fn and(self, other: Self) -> Self {
        Self([self.0[0] | other.0[0], self.0[1] | other.0[1]])
    }

    /// The inputs of both sets.
    const fn common(self, other: Self) -> Self {
        Self([self.0[0] & other.0[0], self.0[1] & other.0[1]])
    }

    /// The inputs of this set that are not in the other.
    #[must_use]
    pub const fn without(self, other: Self) -> Self {
        Self([self.0[0] & !other.0[0], self.0[1] & !other.0[1]])
    }

    /// True if the input is one of them.
    pub fn contains(self, key: InputKey) -> bool {
        let place = key as usize;
        self.0[place / BITS] >> (place % BITS) & 1 == 1
    }

    /// True if all of `other` are among them.
    pub fn contains_all(self, other: Self) -> bool {
        self.and(other) == self
    }

    /// True if any of `other` is among them.
    pub fn meets(self, other: Self) -> bool {
        self.common(other) != Self::default()
    }

    /// The inputs, in the order of the documentation.
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

    /// The inputs that a value for any of these replaces: themselves, and the other forms of the same
    /// quantity, as a lead replaces a lead angle, and a viscosity a friction coefficient.
    #[must_use]
    pub fn replaced(self) -> Self {
        let coefficient = inputs! { friction_coefficient };
        let friction = match (self.meets(coefficient), self.meets(VISCOSITY.keys())) {
            (true, false) => OF_A_LUBRICANT,
            (false, true) => coefficient,
            _ => Self::default(),
        };
        QUANTITIES
            .iter()
            .map(Quantity::keys)
            .filter(|keys| keys.meets(self))
            .fold(self.and(friction), Self::and)
    }

    /// These, and those that follow from them: see [`following`].
    #[must_use]
    pub fn completed(self) -> Self {
        let known = |key| self.contains(key).then_some(1.0);
        let follow = [InputKey::loaded_balls, InputKey::screw_speed_rpm].into_iter();
        self.and(follow.filter(|key| following(*key, known).is_some()).collect())
    }

    /// Two of these inputs that are forms of one quantity, for each quantity that is given so.
    pub(crate) fn two_forms(self) -> impl Iterator<Item = [InputKey; 2]> {
        QUANTITIES.iter().filter_map(move |quantity| {
            let mut given =
                quantity.forms.iter().map(|form| form.key).filter(|key| self.contains(*key));
            Some([given.next()?, given.next()?])
        })
    }

    /// Checks that no quantity is given in two forms. Of the lead both are read, and must agree, see
    /// [`Relation::LeadsAgree`](crate::Relation::LeadsAgree).
    ///
    /// # Errors
    ///
    /// [`CaseError::Entry`].
    pub fn check_forms(self) -> Result<(), CaseError> {
        let agrees = |keys: &[InputKey; 2]| keys[0] == LEAD.forms[0].key;
        match self.two_forms().find(|keys| !agrees(keys)) {
            Some(keys) => Err(CaseError::given_twice(keys.map(InputKey::name))),
            None => Ok(()),
        }
    }

    /// Given inputs after `settings` have been applied to a case that has these inputs.
    #[must_use]
    pub fn overridden_by(self, settings: Self) -> Self {
        self.without(settings.replaced()).and(settings)
    }
}

impl FromIterator<InputKey> for InputSet {
    fn from_iter<I: IntoIterator<Item = InputKey>>(keys: I) -> Self {
        keys.into_iter().fold(Self::default(), |set, key| set.and(Self::of(&[key])))
    }
}

/// A quantity that may be given in one of several forms.
#[derive(Debug)]
pub(crate) struct Quantity {
    /// How a message asks for it.
    pub(crate) words: &'static str,
    /// The forms, of which one is given.
    pub(crate) forms: &'static [Form],
}

/// One form of a quantity.
#[derive(Debug)]
pub(crate) struct Form {
    /// The input.
    pub(crate) key: InputKey,
    /// Inputs that it takes besides, and what for.
    pub(crate) with: InputSet,
    pub(crate) to: &'static str,
}

impl Quantity {
    /// The inputs of all forms.
    fn keys(&self) -> InputSet {
        self.forms.iter().map(|form| form.key).collect()
    }
}

/// Declares the quantities that have several forms, each with its text in a message and its inputs.
macro_rules! forms {
    ($($(#[doc = $about:literal])* $visible:vis $quantity:ident, $words:literal:
        $($key:ident $(with $other:ident $to:literal)?),+;)*) => {
        $($(#[doc = $about])* $visible const $quantity: Quantity = Quantity {
            words: $words,
            forms: &[$(Form {
                key: InputKey::$key,
                with: InputSet::of(&[$(InputKey::$other)?]),
                to: concat!($($to)?),
            },)+],
        };)*

        /// All quantities that have several forms.
        const QUANTITIES: &[Quantity] = &[$($quantity),*];
    };
}

forms! {
    /// Lead angle, or lead on the pitch circle.
    pub(crate) LEAD, "lead_angle_deg (or lead_mm)":
        lead_angle_deg, lead_mm with pitch_circle_diameter_mm "to turn lead_mm into an angle";
    /// Contact angle, or the distance of the grooves that means it; only the ratings of a nut read the latter.
    pub(crate) CONTACT_ANGLE, "contact_angle_deg (or groove_bottom_distance_mm)": contact_angle_deg, groove_bottom_distance_mm;
    /// Speed of the screw, or of the nut along it.
    SPEED, "screw_speed_rpm (or feed_m_min)": screw_speed_rpm, feed_m_min with lead_mm "to turn feed_m_min into a speed";
    /// Viscosity of the lubricant, at two temperatures or by its grade.
    pub(crate) VISCOSITY, "iso_vg (or viscosity_40C_mm2_s and viscosity_100C_mm2_s)":
        viscosity_40C_mm2_s with viscosity_100C_mm2_s "for the viscosity at other temperatures", iso_vg;
    /// Inputs of the lubricant temperature, or the temperature itself.
    pub(crate) TEMPERATURE, "lubricant_temperature_C (or heat_transfer_W_K and ambient_temperature_C)":
        heat_transfer_W_K with ambient_temperature_C "for the heat that leaves", lubricant_temperature_C;
    /// What nut and table give to the air.
    NUT_IN_AIR, "nut_conductance_W_K (or carriage_area_m2)": nut_conductance_W_K, carriage_area_m2;
    /// What a hollow screw gives to its coolant.
    COOLED_SCREW, "coolant_flow_l_min (or coolant_conductance_W_K)":
        coolant_flow_l_min with screw_bore_mm "for the flow through the screw", coolant_conductance_W_K;
    /// Tension of a screw between two fixed bearings as it is set.
    PRETENSION, "pretension_N (or pretension_K)": pretension_N, pretension_K;
    /// Hardness of the raceways.
    HARDNESS, "hardness_HRC (or hardness_HV10)": hardness_HRC, hardness_HV10;
}

/// The value of an input that follows from others: the balls of a nut from those of a turn, the speed from
/// the feed.
pub fn following(key: InputKey, given: impl Fn(InputKey) -> Option<f64>) -> Option<f64> {
    use InputKey as K;
    match key {
        K::loaded_balls => {
            let balls = given(K::loaded_balls_per_turn)? * loaded_turns(&given)?;
            match (given(K::loaded_turns), given(K::circuits_count)) {
                // Circuits of a turn less their gap have whole balls.
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

/// tanα = L / (π d)
pub(crate) fn lead_angle<D: Scalar>(lead_mm: D, pitch_circle_diameter_mm: D) -> D {
    (lead_mm / (pitch_circle_diameter_mm * PI)).atan()
}

/// L = π d tanα
pub(crate) fn lead_mm(lead_angle: f64, pitch_circle_diameter_mm: f64) -> f64 {
    PI * pitch_circle_diameter_mm * lead_angle.tan()
}

/// Loaded turns of a nut: given, or those of circuits of a turn less their gap.
pub(crate) fn loaded_turns(given: impl Fn(InputKey) -> Option<f64>) -> Option<f64> {
    let by_gap = || {
        let arc = 360.0 - given(InputKey::gap_deg)?;
        Some(given(InputKey::circuits_count)? * arc / 360.0)
    };
    given(InputKey::loaded_turns).or_else(by_gap)
}

/// Inputs that say of a case that its friction comes from a lubricant. Density and drag coefficient are
/// not among them: jamming takes them whatever friction is.
pub(crate) const OF_A_LUBRICANT: InputSet = inputs! {
    iso_vg viscosity_40C_mm2_s viscosity_100C_mm2_s pressure_viscosity_1_GPa
    limiting_shear_ratio boundary_friction_coefficient lubricant_temperature_C
    heat_transfer_W_K ball_roughness_um nut_roughness_um screw_roughness_um film_factor
    rolling_factor hysteresis_loss ball_contact_force_N return_circuits return_loss_coefficient
};

impl InputSet {
    /// Inputs of a lubricant that say the same at every point of a table whose lubricant only warms.
    pub(crate) const OF_ONE_LUBRICANT: Self = {
        // A ball without a lubricant may have these too.
        let more = inputs! {
            lubricant_density_kg_m3 seal_torque_Nm drag_coefficient ambient_temperature_C
        };
        OF_A_LUBRICANT.and(more).without(inputs! { lubricant_temperature_C })
    };

    /// Contact angles at which a ball runs, in place of those of a model.
    pub const RUNNING_ANGLES: Self =
        inputs! { nut_running_contact_angle_deg screw_running_contact_angle_deg };

    /// True if friction comes from a lubricant.
    pub fn is_lubricated(self) -> bool {
        self.meets(OF_A_LUBRICANT)
    }

    /// True if friction is known, by a coefficient or from a lubricant.
    pub(crate) fn has_friction(self) -> bool {
        self.contains(InputKey::friction_coefficient) || self.is_lubricated()
    }

    /// Checks that friction is given once, and that no input lacks another one that it needs.
    pub(crate) fn check_friction(self) -> Result<(), CaseError> {
        use InputKey as K;
        if self.contains(InputKey::friction_coefficient)
            && let Some(key) = self.common(OF_A_LUBRICANT).iter().next()
        {
            return Err(CaseError::Invalid(format!(
                "give friction_coefficient or a lubricant, not both: friction_coefficient and {} are given",
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
            Some([one, other]) => Err(bad(one.name(), format!("needs {}, too", other.name()))),
            None => Ok(()),
        }
    }
}

impl Case {
    /// The inputs that it has, those that its other entries give, and those that are found in its warm state.
    pub fn stated(&self) -> InputSet {
        let given = self.given();
        let listed = self.nut.circuits.as_ref().map(|_| InputKey::loaded_balls);
        let warm = self.asks_warm() && given.is_lubricated();
        let found = warm.then_some(InputKey::lubricant_temperature_C);
        let class = self.nut.contamination.as_ref().map(|_| InputKey::contamination_factor);
        given.and(listed.into_iter().chain(found).chain(class).collect())
    }

    /// The value of an input that is not given, from others, from the circuits of a nut or the make of a screw.
    #[inline(never)]
    pub(crate) fn follows(&self, key: InputKey) -> Option<f64> {
        match (key, &self.nut) {
            (InputKey::loaded_balls, CaseEntries { circuits: Some(circuits), .. }) => {
                let first = circuits.iter().filter(|circuit| circuit.body == 0);
                Some(count(first.map(|circuit| circuit.balls).sum()))
            }
            (InputKey::screw_roughness_um, CaseEntries { screw_make: Some(make), .. })
                if make.0 == Make::Rolled =>
            {
                Some(0.4)
            }
            _ => following(key, |key| self[key]),
        }
    }

    /// Applies the values of `settings`, all at once: a form of a quantity replaces the other forms.
    ///
    /// This is what a row of a table, a point of a grid and a changed case mean.
    pub fn override_with(&mut self, settings: &Self) {
        let given = settings.given();
        for key in given.replaced().iter() {
            self[key] = settings[key];
        }
        // A given input is not estimated any more.
        if let Some(estimated) = &mut self.nut.estimated_inputs {
            estimated.retain(|InputName(key)| !given.contains(*key));
        }
        // A preload replaces the class of another one, and the other way round.
        match (settings.preload_N, settings.nut.preload_class) {
            (Some(_), None) => self.nut.preload_class = None,
            (None, Some(_)) => self.preload_N = None,
            _ => {}
        }
        self.nut.override_with(&settings.nut);
    }
}
