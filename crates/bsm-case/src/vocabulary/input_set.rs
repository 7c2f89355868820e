//! Sets of inputs, and what a set that is given does to another one.

use std::f64::consts::PI;

use bsm_kin::Scalar;

use super::number::count;

use crate::vocabulary::units::{DEG, MM};
use crate::{CaseError, INPUTS, InputKey, Scene};

/// Bits of a word of an [`InputSet`].
const BITS: usize = u128::BITS as usize;

/// Some of the inputs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct InputSet([u128; 2]);

const _: () = assert!(INPUTS.len() <= 2 * BITS, "a bit for each input");

impl InputSet {
    /// Inputs that have a default.
    pub const WITH_DEFAULT: Self = {
        let (mut set, mut i) = ([0; 2], 0);
        while i < INPUTS.len() {
            if INPUTS[i].default.is_some() {
                set[i / BITS] |= 1 << (i % BITS);
            }
            i += 1;
        }
        Self(set)
    };

    /// These inputs.
    pub const fn of(keys: &[InputKey]) -> Self {
        let (mut set, mut i) = ([0; 2], 0);
        while i < keys.len() {
            let place = keys[i] as usize;
            set[place / BITS] |= 1 << (place % BITS);
            i += 1;
        }
        Self(set)
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
        self.meets(Self::of(&[key]))
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
        let coefficient = Self::of(&[InputKey::friction_coefficient]);
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
        self.and(FOLLOW.into_iter().filter(|key| following(*key, known).is_some()).collect())
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
    /// [`CaseError::GivenTwice`].
    pub fn check_forms(self) -> Result<(), CaseError> {
        let agrees = |keys: &[InputKey; 2]| keys[0] == LEAD.forms[0].key;
        match self.two_forms().find(|keys| !agrees(keys)) {
            Some(keys) => Err(CaseError::given_twice(keys.map(InputKey::name))),
            None => Ok(()),
        }
    }

    /// Given inputs after `settings` have been applied to a scene that has these inputs.
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

/// Lead angle, or lead on the pitch circle.
pub(crate) const LEAD: Quantity = Quantity {
    words: "lead_angle_deg (or lead_mm)",
    forms: &[
        Form { key: InputKey::lead_angle_deg, with: InputSet::of(&[]), to: "" },
        Form {
            key: InputKey::lead_mm,
            with: InputSet::of(&[InputKey::pitch_circle_diameter_mm]),
            to: "to turn lead_mm into an angle",
        },
    ],
};

/// Contact angle, or the distance of the grooves that means it; only the ratings of a nut read the latter.
pub(crate) const CONTACT_ANGLE: Quantity = Quantity {
    words: "contact_angle_deg (or groove_bottom_distance_mm)",
    forms: &[
        Form { key: InputKey::contact_angle_deg, with: InputSet::of(&[]), to: "" },
        Form { key: InputKey::groove_bottom_distance_mm, with: InputSet::of(&[]), to: "" },
    ],
};

/// Speed of the screw, or of the nut along it.
const SPEED: Quantity = Quantity {
    words: "screw_speed_rpm (or feed_m_min)",
    forms: &[
        Form { key: InputKey::screw_speed_rpm, with: InputSet::of(&[]), to: "" },
        Form {
            key: InputKey::feed_m_min,
            with: InputSet::of(&[InputKey::lead_mm]),
            to: "to turn feed_m_min into a speed",
        },
    ],
};

/// Viscosity of the lubricant, at two temperatures or by its grade.
pub(crate) const VISCOSITY: Quantity = Quantity {
    words: "iso_vg (or viscosity_40C_mm2_s and viscosity_100C_mm2_s)",
    forms: &[
        Form {
            key: InputKey::viscosity_40C_mm2_s,
            with: InputSet::of(&[InputKey::viscosity_100C_mm2_s]),
            to: "for the viscosity at other temperatures",
        },
        Form { key: InputKey::iso_vg, with: InputSet::of(&[]), to: "" },
    ],
};

/// Inputs of the lubricant temperature, or the temperature itself.
pub(crate) const TEMPERATURE: Quantity = Quantity {
    words: "lubricant_temperature_C (or heat_transfer_W_K and ambient_temperature_C)",
    forms: &[
        Form {
            key: InputKey::heat_transfer_W_K,
            with: InputSet::of(&[InputKey::ambient_temperature_C]),
            to: "for the heat that leaves",
        },
        Form { key: InputKey::lubricant_temperature_C, with: InputSet::of(&[]), to: "" },
    ],
};

/// What nut and table give to the air.
const NUT_IN_AIR: Quantity = Quantity {
    words: "nut_conductance_W_K (or carriage_area_m2)",
    forms: &[
        Form { key: InputKey::nut_conductance_W_K, with: InputSet::of(&[]), to: "" },
        Form { key: InputKey::carriage_area_m2, with: InputSet::of(&[]), to: "" },
    ],
};

/// What a hollow screw gives to its coolant.
const COOLED_SCREW: Quantity = Quantity {
    words: "coolant_flow_l_min (or coolant_conductance_W_K)",
    forms: &[
        Form {
            key: InputKey::coolant_flow_l_min,
            with: InputSet::of(&[InputKey::screw_bore_mm]),
            to: "for the flow through the screw",
        },
        Form { key: InputKey::coolant_conductance_W_K, with: InputSet::of(&[]), to: "" },
    ],
};

/// Tension of a screw between two fixed bearings as it is set.
const PRETENSION: Quantity = Quantity {
    words: "pretension_N (or pretension_K)",
    forms: &[
        Form { key: InputKey::pretension_N, with: InputSet::of(&[]), to: "" },
        Form { key: InputKey::pretension_K, with: InputSet::of(&[]), to: "" },
    ],
};

/// Hardness of the raceways.
const HARDNESS: Quantity = Quantity {
    words: "hardness_HRC (or hardness_HV10)",
    forms: &[
        Form { key: InputKey::hardness_HRC, with: InputSet::of(&[]), to: "" },
        Form { key: InputKey::hardness_HV10, with: InputSet::of(&[]), to: "" },
    ],
};

/// All quantities that have several forms.
const QUANTITIES: &[Quantity] = &[
    LEAD,
    CONTACT_ANGLE,
    SPEED,
    VISCOSITY,
    TEMPERATURE,
    NUT_IN_AIR,
    COOLED_SCREW,
    PRETENSION,
    HARDNESS,
];

/// Inputs that follow from others where they are not given, see [`following`].
const FOLLOW: [InputKey; 2] = [InputKey::loaded_balls, InputKey::screw_speed_rpm];

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

/// Inputs that say of a scene that its friction comes from a lubricant. Density and drag coefficient are
/// not among them: jamming takes them whatever friction is.
pub(crate) const OF_A_LUBRICANT: InputSet = {
    use InputKey as K;
    InputSet::of(&[
        K::iso_vg,
        K::viscosity_40C_mm2_s,
        K::viscosity_100C_mm2_s,
        K::pressure_viscosity_1_GPa,
        K::limiting_shear_ratio,
        K::boundary_friction_coefficient,
        K::lubricant_temperature_C,
        K::heat_transfer_W_K,
        K::ball_roughness_um,
        K::nut_roughness_um,
        K::screw_roughness_um,
        K::film_factor,
        K::rolling_factor,
        K::hysteresis_loss,
        K::ball_contact_force_N,
        K::return_circuits,
        K::return_loss_coefficient,
    ])
};

impl InputSet {
    /// Inputs of a lubricant that say the same at every point of a table whose lubricant only warms.
    pub(crate) const OF_ONE_LUBRICANT: Self = {
        use InputKey as K;
        // A ball without a lubricant may have these too.
        let more = Self::of(&[
            K::lubricant_density_kg_m3,
            K::seal_torque_Nm,
            K::drag_coefficient,
            K::ambient_temperature_C,
        ]);
        OF_A_LUBRICANT.and(more).without(Self::of(&[K::lubricant_temperature_C]))
    };

    /// Contact angles at which a ball runs, in place of those of a model.
    pub const RUNNING_ANGLES: Self = {
        use InputKey as K;
        Self::of(&[K::nut_running_contact_angle_deg, K::screw_running_contact_angle_deg])
    };

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
            return Err(CaseError::FrictionTwice { key: key.name() });
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
            Some([one, other]) => Err(CaseError::BadEntry {
                key: one.name().to_owned(),
                what: format!("needs {}, too", other.name()),
            }),
            None => Ok(()),
        }
    }
}

impl Scene {
    /// The inputs that it has.
    pub fn given(&self) -> InputSet {
        InputKey::ALL.into_iter().filter(|key| self[*key].is_some()).collect()
    }

    /// The inputs that it has, those that its other entries give, and those that are found in its warm state.
    pub fn stated(&self) -> InputSet {
        let given = self.given();
        let listed = self.nut.circuits.as_ref().map(|_| InputKey::loaded_balls);
        let warm = self.asks_warm() && given.is_lubricated();
        let found = warm.then_some(InputKey::lubricant_temperature_C);
        given.and(listed.into_iter().chain(found).collect())
    }

    /// The value of an input that is not given, from others or from the circuits of a nut.
    #[inline(never)]
    pub(crate) fn follows(&self, key: InputKey) -> Option<f64> {
        match (&self.nut.circuits, key) {
            (Some(circuits), InputKey::loaded_balls) => {
                let first = circuits.iter().filter(|circuit| circuit.body == 0);
                Some(count(first.map(|circuit| circuit.balls).sum()))
            }
            _ => following(key, |key| self[key]),
        }
    }

    /// Applies the values of `settings`, all at once: a form of a quantity replaces the other forms.
    ///
    /// This is what a row of a table, a point of a grid and a changed scene mean.
    pub fn override_with(&mut self, settings: &Self) {
        let given = settings.given();
        for key in given.replaced().iter() {
            self[key] = settings[key];
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
