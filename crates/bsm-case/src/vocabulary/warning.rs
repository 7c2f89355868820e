//! Warnings on an axis sheet, some of which correspond to selection limits.

/// A limit that `bsm select` imposes and that corresponds to a warning of `bsm axis`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum SelectionLimit {
    /// The screw is longer than all screws in the manufacturers' lists.
    ScrewLength,
    /// The number of loaded turns is outside the typical range.
    LoadedTurns,
    /// The land between the grooves is too narrow for the balls.
    BallOverLead,
    /// The nut model has no solution. Therefore, the preload rules, which need the loads of all
    /// balls, cannot be checked.
    UnsolvedNut,
    /// The steady-state temperature rise is too high.
    TemperatureRise,
    /// The driven nut turns near the critical speed of its screw.
    NutResonance,
}

impl SelectionLimit {
    /// Returns the label of the limit.
    pub fn label(self) -> &'static str {
        match self {
            Self::ScrewLength => "longest screw in manufacturers' lists",
            Self::LoadedTurns => "typical number of loaded turns",
            Self::BallOverLead => "ball diameter divided by lead",
            Self::UnsolvedNut => "calculation of the nut with all its balls",
            Self::TemperatureRise => {
                "recommended limit of the steady-state temperature rise (40 K)"
            }
            Self::NutResonance => "resonance of the driven nut",
        }
    }

    /// Returns true if `allow_warnings` in a requirement disables the limit.
    pub fn can_be_allowed(self) -> bool {
        matches!(self, Self::TemperatureRise | Self::NutResonance)
    }
}

/// A warning, and the selection limit to which it corresponds, if any.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Warning {
    /// Text of the warning.
    pub text: String,
    /// Selection limit that corresponds to the warning. If it is `None`, a screw with this warning
    /// may be selected, and `select` prints the warning.
    pub limit: Option<SelectionLimit>,
}

impl Warning {
    /// Creates a warning that does not prevent the selection of a screw.
    pub(crate) fn advice(text: impl Into<String>) -> Self {
        Self { text: text.into(), limit: None }
    }

    /// Creates a warning that corresponds to a selection limit.
    pub(crate) fn limit(limit: SelectionLimit, text: impl Into<String>) -> Self {
        Self { text: text.into(), limit: Some(limit) }
    }
}
