//! Outputs of the models. Records, tables and the schema are generated from a single table of
//! outputs.

use std::sync::LazyLock;

use bsm_dyn::{
    Evidence, Solution, SteadyState,
    lubrication::{ContactFilm, ZERO_CELSIUS},
};
use bsm_kin::{Real, Site};
use serde_json::{Value, json};

use super::number::count;
use super::quantity::{AnalysisKind, Quantity, Scope, group};
use crate::vocabulary::units::{DEG, GPA, MILLI, MM, MPA, UM, direction_deg, unit_suffix};
use crate::{INPUTS, InputKey};

/// Type of the values of an output.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OutputType {
    /// A real number.
    Number,
    /// A nonnegative integer.
    Integer,
    /// A statement that is true or false.
    Boolean,
    /// One of several words.
    Text,
}

impl OutputType {
    /// Returns the name of the type in JSON schemas.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Number => "number",
            Self::Integer => "integer",
            Self::Boolean => "boolean",
            Self::Text => "string",
        }
    }
}

/// Definition of an output.
#[derive(Debug, Clone, Copy)]
pub struct Output {
    /// Name, with its unit as a suffix.
    pub name: &'static str,
    /// Unit as text; empty if dimensionless.
    pub unit: &'static str,
    /// Type of the value.
    pub output_type: OutputType,
    /// Possible values, if the output is a string; empty for numbers.
    pub words: &'static [&'static str],
    /// Meaning of the output.
    pub about: &'static str,
    pub(crate) origin: Origin,
}

/// Source of the value of an output.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Origin {
    /// The value comes from the solution of a model.
    Solution { key: SolutionOutput, read: fn(&SteadyState) -> Option<f64> },
    /// The value comes from a table of quantities. `kind` is set if the table belongs to an
    /// analysis.
    Table { kind: Option<AnalysisKind> },
    /// The value is an input of a case.
    Input,
    /// One end of the 90 % interval of another output over the possible grooves.
    Interval { of: &'static Output, is_high: bool },
}

impl Output {
    /// Creates the definition of an output that belongs to a table of quantities.
    pub(crate) const fn of_table(
        name: &'static str,
        unit: &'static str,
        output_type: OutputType,
        about: &'static str,
        kind: Option<AnalysisKind>,
    ) -> Self {
        Self { name, unit, output_type, words: &[], about, origin: Origin::Table { kind } }
    }

    /// Returns the value of the output in a solution, or `None` if the solution does not contain
    /// it. Flags are returned as 0 or 1, and strings as the index of the string.
    pub fn read(&self, solution: &Solution) -> Option<f64> {
        let Origin::Solution { key, read } = self.origin else { return None };
        match (&solution.result, key) {
            (Ok(solved), _) => read(solved),
            (Err(_), SolutionOutput::self_locking) => solution.self_locking().map(yes),
            (Err(none), SolutionOutput::evidence) => none.evidence().map(|it| f64::from(it.rank())),
            _ => None,
        }
    }

    /// Returns the key of the output in [`OUTPUTS`], or `None` if the output is not a result of a
    /// model.
    pub fn key(&self) -> Option<SolutionOutput> {
        match self.origin {
            Origin::Solution { key, .. } => Some(key),
            Origin::Table { .. } | Origin::Input | Origin::Interval { .. } => None,
        }
    }

    /// Returns the analysis that calculates the output, or `None` if the output is not a result of
    /// an analysis.
    pub fn analysis(&self) -> Option<AnalysisKind> {
        match self.origin {
            Origin::Solution { .. } | Origin::Input => None,
            Origin::Table { kind } => kind,
            Origin::Interval { of, .. } => of.analysis(),
        }
    }

    /// If the output is one end of a 90 % interval, returns the output to which the interval
    /// belongs, and true if it is the upper end.
    pub fn interval(&self) -> Option<(&'static Self, bool)> {
        match self.origin {
            Origin::Interval { of, is_high } => Some((of, is_high)),
            _ => None,
        }
    }

    /// Returns the output that defines a table column with the values of an input.
    pub(crate) fn input(key: InputKey) -> &'static Self {
        static COLUMNS: LazyLock<Vec<Output>> = LazyLock::new(|| {
            let column = |input: &Quantity| Output {
                name: input.name,
                unit: input.unit,
                output_type: OutputType::Number,
                words: &[],
                about: input.about,
                origin: Origin::Input,
            };
            INPUTS.iter().map(column).collect()
        });
        &COLUMNS[key as usize]
    }

    /// Returns true if the column contains an input.
    pub(crate) fn is_input(&self) -> bool {
        matches!(self.origin, Origin::Input)
    }

    /// Returns the names of both ends of an interval. In these names, `low` or `high` precedes the
    /// unit.
    pub fn end_names(name: &str, unit: &str) -> [String; 2] {
        let (stem, unit) = name.split_at(name.len() - unit_suffix(name, unit).len());
        ["low", "high"].map(|word| format!("{stem}_{word}{unit}"))
    }

    /// Returns the outputs for both ends of the 90 % interval of an output over the possible
    /// grooves. In their names, `low` or `high` precedes the unit.
    fn ends(of: &'static Self) -> [Self; 2] {
        let [low, high] = Self::end_names(of.name, of.unit);
        [(low, "lower", false), (high, "upper", true)].map(|(name, end, is_high)| {
            let about = format!(
                "{}: {end} end of the 90 % interval over the possible grooves, if the groove is estimated",
                of.about
            );
            Self {
                // The strings are never freed, but they are created only once per output.
                name: Box::leak(name.into_boxed_str()),
                about: Box::leak(about.into_boxed_str()),
                origin: Origin::Interval { of, is_high },
                ..*of
            }
        })
    }

    /// Returns the output for the interval end with the given name.
    pub(crate) fn interval_end(name: &str) -> Option<&'static Self> {
        static ENDS: LazyLock<Vec<Output>> = LazyLock::new(|| {
            let numbers = Output::all().filter(|output| output.output_type == OutputType::Number);
            numbers.flat_map(Output::ends).collect()
        });
        ENDS.iter().find(|end| end.name == name)
    }

    /// Returns true if the output describes the ball or its contacts.
    pub(crate) fn is_of_the_ball(&self) -> bool {
        use SolutionOutput as K;
        let of_the_ball = K::axial_displacement_um as usize..=K::ball_omega_b_rad_s as usize;
        let of_its_contacts = K::nut_normal_load_N as usize..=K::screw_approach_um as usize;
        let place = self.key().map(|key| key as usize);
        place.is_some_and(|key| of_the_ball.contains(&key) || of_its_contacts.contains(&key))
    }

    /// Returns the string that a number represents in a column of strings.
    pub fn word(&self, number: f64) -> Option<&'static str> {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place")]
        let place = number as usize;
        self.words.get(place).filter(|_| !number.is_nan()).copied()
    }

    /// Converts a value of the output to JSON.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "counts")]
    pub(crate) fn json(&self, value: f64) -> Value {
        match self.output_type {
            OutputType::Number => json!(value),
            OutputType::Integer => json!(value as u64),
            OutputType::Boolean => json!(value > 0.5),
            OutputType::Text => json!(self.word(value)),
        }
    }
}

/// Declares outputs: `"label" ["unit"] Kind: name member = reader, "meaning";`. Outputs of contacts
/// have one name and one member for each contact. The reader returns the value of the output from a
/// solution, for a given contact. Flags are 0 or 1, and strings are represented by their index.
macro_rules! outputs {
    ($($title:tt { $(
        $label:literal [$unit:literal $($symbol:literal)?] $kind:ident: $($name:ident $site:ident)+ =
            |$s:tt, $at:tt| $read:expr, $about:literal;
    )* })*) => {
        /// All outputs of the models, in the order of the documentation.
        pub const OUTPUTS: &[Output] = &[$($($(Output {
            name: stringify!($name),
            unit: $unit,
            output_type: outputs!(@type $kind),
            words: outputs!(@words $kind),
            about: concat!($about, outputs!(@said $site)),
            origin: Origin::Solution {
                key: SolutionOutput::$name,
                read: |solved| {
                    let ($s, $at): (&SteadyState, _) = (solved, outputs!(@site $site));
                    $read
                },
            },
        },)+)*)*];

        /// Outputs as they are displayed, with one quantity for all contacts. Hidden quantities are
        /// displayed only as part of a sentence.
        pub(crate) const SOLUTION: &[Quantity] = &[$($(Quantity {
            name: outputs!(@first $($name)+),
            unit: $unit,
            symbol: concat!($($symbol)?),
            about: $label,
            title: group!(@title $title),
            is_hidden: group!(@is_hidden $title),
            scope: outputs!(@scope $($site)+),
            columns: &[$(OUTPUTS[SolutionOutput::$name as usize],)+],
            ..Quantity::WHOLE
        },)*)*];

        /// Key of an output, which is its index in [`OUTPUTS`].
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        #[expect(non_camel_case_types, reason = "variant names match the output names in the vocabulary")]
        pub enum SolutionOutput {
            $($($(#[doc = $about] $name,)+)*)*
        }

        /// Passes each output of several solutions to `store`, together with the index that `place`
        /// returns for the output. Outputs without an index are skipped. The values have the unit
        /// of the output.
        #[inline(always)]
        pub fn store_outputs<F: Real>(
            solved: &SteadyState<F>,
            place: impl Fn(SolutionOutput) -> Option<usize>,
            mut store: impl FnMut(usize, F),
        ) {
            $($($(
                if let Some(place) = place(SolutionOutput::$name)
                    && let Some(values) = read_at(
                        solved,
                        outputs!(@site $site),
                        #[inline(always)]
                        |$s, $at| $read,
                    )
                {
                    store(place, values);
                }
            )+)*)*
        }
    };
    (@first $name:ident $($other:ident)*) => { stringify!($name) };
    (@scope whole) => { Scope::Scalar };
    (@scope $($at:ident)+) => { Scope::Contacts };
    (@said nut) => { ", nut" };
    (@said screw) => { ", screw" };
    (@said unloaded) => { ", far flank of the nut" };
    (@said whole) => { "" };
    (@site screw) => { Site::Screw };
    (@site unloaded) => { Site::NutUnloaded };
    (@site $at:ident) => { Site::Nut };
    (@type Number) => { OutputType::Number };
    (@type Count) => { OutputType::Integer };
    (@type Flag) => { OutputType::Boolean };
    (@type Raceway) => { OutputType::Text };
    (@type Evidence) => { OutputType::Text };
    (@words Raceway) => { &["nut", "screw"] };
    (@words Evidence) => { &Evidence::NAMES };
    (@words $kind:ident) => { &[] };
}

/// Calls a reader for a contact. The function must be inlined, because SIMD operations use the
/// instruction set of the caller only in inlined functions.
#[inline(always)]
fn read_at<F: Real>(
    solved: &SteadyState<F>,
    at: Site,
    read: impl Fn(&SteadyState<F>, Site) -> Option<F>,
) -> Option<F> {
    read(solved, at)
}

/// Converts a constant to the number type of the solution.
#[inline(always)]
fn constant<F: Real>(solved: &SteadyState<F>, number: f64) -> F {
    solved.transmission.efficiency.constant(number)
}

/// Returns 1 for each solution for which the mask is true, and 0 for all other solutions.
#[inline(always)]
fn flags<F: Real>(solved: &SteadyState<F>, holds: F::Mask) -> F {
    F::select(holds, constant(solved, 1.0), constant(solved, 0.0))
}

/// Converts true to 1 and false to 0.
fn yes(holds: bool) -> f64 {
    f64::from(u8::from(holds))
}

/// Returns the component of the ball's angular velocity along the axis t, n or b.
#[inline(always)]
fn omega<F: Real>(solved: &SteadyState<F>, along: usize) -> Option<F> {
    let [omega] = solved.ball.motion.as_ref()?.omega.data.0;
    Some(omega[along])
}

#[inline(always)]
fn film<F: Real>(solved: &SteadyState<F>, at: Site) -> Option<&ContactFilm<F>> {
    let state = solved.film.as_ref()?;
    Some(if at == Site::Screw { &state.screw } else { &state.nut })
}

outputs! {
    "" {
        "efficiency of the balls" ["" "eta"] Number: efficiency whole = |s, _| Some(s.transmission.efficiency),
            "output power divided by input power of the balls, without preload, seals and bearings; a negative value means self-locking";
        "torque of the balls" ["N m"] Number: ball_torque_Nm whole = |s, _| s.transmission.screw_torque,
            "torque of all balls on the screw; screw_torque_Nm also includes preload, seals and bearings";
        "input power" ["W"] Number: input_power_W whole = |s, _| Some(s.transmission.power.as_ref()?.input),
            "input power, all balls";
        "output power" ["W"] Number: output_power_W whole = |s, _| Some(s.transmission.power.as_ref()?.output),
            "output power, all balls";
        "dissipated power" ["W"] Number: dissipated_power_W whole = |s, _| Some(s.transmission.power.as_ref()?.dissipated),
            "dissipated power, all balls";
        "  sliding at the contacts" ["W"] Number: sliding_power_W whole = |s, _| Some(s.film.as_ref()?.sliding_power),
            "power loss due to sliding at the contacts, all balls";
        "  rolling resistance" ["W"] Number: rolling_power_W whole = |s, _| Some(s.film.as_ref()?.rolling_power),
            "power loss due to rolling resistance of lubricant and hysteresis, all balls";
        "  ball-to-ball contact" ["W"] Number: ball_contact_power_W whole = |s, _| Some(s.film.as_ref()?.outside.ball_contact),
            "power loss due to ball-to-ball contact";
        "  ball returns" ["W"] Number: return_power_W whole = |s, _| Some(s.film.as_ref()?.outside.ball_return),
            "power loss in the ball returns";
        "  drag" ["W"] Number: drag_power_W whole = |s, _| Some(s.film.as_ref()?.outside.drag),
            "power loss due to drag of the balls in the lubricant";
        "equivalent constant friction coefficient" [""] Number: equivalent_friction_coefficient whole = |s, _| Some(s.film.as_ref()?.equivalent_friction),
            "constant friction coefficient that gives the same contact loss at this point";
        "friction coefficient of a plain thread with this efficiency" [""] Number: catalog_friction_coefficient whole = |s, _| Some(s.film.as_ref()?.catalog_friction),
            "friction coefficient of a plain thread with the same efficiency, as stated in catalogs";
        "temperature of the lubricant" ["C"] Number: lubricant_temperature_C whole = |s, _| Some(s.film.as_ref()?.temperature - ZERO_CELSIUS),
            "temperature of the lubricant, given or calculated from the heat balance";
        "viscosity" ["mPa s" "eta_0"] Number: viscosity_mPas whole = |s, _| Some(s.film.as_ref()?.viscosity / MILLI),
            "dynamic viscosity of the lubricant at its temperature";
        "pressure-viscosity coefficient" ["1/GPa" "alpha_p"] Number: pressure_viscosity_1_GPa whole = |s, _| Some(s.film.as_ref()?.pressure_viscosity * GPA),
            "pressure-viscosity coefficient of the lubricant";
        "temperature rise of the film" ["K"] Number: film_heating_K whole = |s, _| Some(s.film.as_ref()?.heating),
            "temperature rise of the hotter film due to sliding; not included in the viscosity";
        "efficiency error bound" [""] Number: efficiency_error_bound whole = |s, _| Some(s.error.as_ref()?.efficiency),
            "upper bound of the efficiency error. With model traction, it covers the integration over the contact ellipses; with model auto, it covers the difference from model traction at 99 % of all points. Torque and powers follow from the efficiency; the numbers of the ball and its contacts have no bound if auto chooses a model other than traction";
        "relative error bound of the loss" [""] Number: loss_error_bound whole = |s, _| s.error.as_ref()?.loss,
            "upper bound of the error of the power loss, relative to the power loss of this result; null if above 0.5";
        "axial displacement of the nut" ["um"] Number: axial_displacement_um whole = |s, _| Some(s.ball.axial_displacement? / UM),
            "axial displacement of the nut";
        "ball precession about the axis" ["rad/s" "omega_m"] Number: ball_precession_rad_s whole = |s, _| Some(s.ball.motion.as_ref()?.precession),
            "precession, the angular velocity of the ball center about the screw axis";
        "ball angular velocity along the tangent t" ["rad/s"] Number: ball_omega_t_rad_s whole = |s, _| omega(s, 0),
            "angular velocity of the ball, component along the helix";
        "ball angular velocity along the normal n" ["rad/s"] Number: ball_omega_n_rad_s whole = |s, _| omega(s, 1),
            "angular velocity of the ball, component towards the axis of the screw";
        "ball angular velocity along the binormal b" ["rad/s"] Number: ball_omega_b_rad_s whole = |s, _| omega(s, 2),
            "angular velocity of the ball, component along the binormal of the helix";
        "skid number" [""] Number: skid_number whole = |s, _| s.skid.as_ref()?.skid_number,
            "gyroscopic moment divided by friction moment of a rolling ball";
        "skid onset number" [""] Number: onset_number whole = |s, _| s.skid.as_ref()?.onset_number(),
            "skid onset number: skid number times a factor that accounts for the friction consumed by lead-induced slip. Below 0.1, the ball rolls; above 2, it is in gross skid";
        "threshold play of the third contact" ["um"] Number: threshold_play_um whole = |s, _| Some(s.ball.threshold_play? / UM),
            "axial play of one nut below which friction presses the balls onto the far flank of a groove; 0 if friction never presses a ball onto a far flank";
        "gap at the far flank (negative: interference)" ["um"] Number: far_flank_gap_um whole = |s, _| Some(s.far_flank.as_ref()?.gap / UM),
            "gap between a ball and the closer of the two far flanks at axial_play_um; a negative gap is the elastic approach of the third contact";
        "third contact load" ["N"] Number: third_contact_load_N whole = |s, _| Some(s.far_flank.as_ref()?.contact.as_ref()?.load),
            "normal load of the third contact of a ball, at the far flank of nut or screw";
        "third contact slip speed" ["m/s"] Number: third_contact_slip_m_s whole = |s, _| Some(s.far_flank.as_ref()?.contact.as_ref()?.slip),
            "slip speed of the third contact";
        "third contact: share of the friction power" [""] Number: third_contact_power_share whole = |s, _| Some(s.far_flank.as_ref()?.contact.as_ref()?.power_share),
            "share of the friction power of a ball that is lost at the third contact";
    }
    "contact" {
        "normal load per ball" ["N" "Q"] Number: nut_normal_load_N nut screw_normal_load_N screw unloaded_flank_normal_load_N unloaded = |s, at| s.ball.contact(at)?.load,
            "normal load of a ball";
        "contact angle" ["deg" "alpha"] Number: nut_contact_angle_deg nut screw_contact_angle_deg screw = |s, at| Some(s.ball.contact(at)?.angle / DEG),
            "contact angle";
        "slip speed" ["m/s"] Number: nut_slip_velocity_m_s nut screw_slip_velocity_m_s screw unloaded_flank_slip_velocity_m_s unloaded = |s, at| Some(s.ball.contact(at)?.slip.as_ref()?.speed),
            "slip speed";
        "direction of friction" ["deg"] Number: nut_slip_angle_deg nut screw_slip_angle_deg screw unloaded_flank_slip_angle_deg unloaded = |s, at| Some(direction_deg(s.ball.contact(at)?.slip_angle?)),
            "direction of friction on the ball";
        "spin about the normal" ["rad/s"] Number: nut_spin_rad_s nut screw_spin_rad_s screw = |s, at| Some(s.ball.contact(at)?.slip.as_ref()?.spin),
            "spin about the contact normal, relative to nut or screw";
        "largest pressure" ["MPa" "p_max"] Number: nut_max_pressure_MPa nut screw_max_pressure_MPa screw = |s, at| Some(s.ball.contact(at)?.pressed.as_ref()?.max_pressure / MPA),
            "largest Hertz pressure";
        "ellipse across the groove" ["mm" "a"] Number: nut_ellipse_a_mm nut screw_ellipse_a_mm screw = |s, at| Some(s.ball.contact(at)?.pressed.as_ref()?.semi_axes.0 / MM),
            "semi-axis across the groove";
        "ellipse along the groove" ["mm" "b"] Number: nut_ellipse_b_mm nut screw_ellipse_b_mm screw = |s, at| Some(s.ball.contact(at)?.pressed.as_ref()?.semi_axes.1 / MM),
            "semi-axis along the groove";
        "elastic approach" ["um" "delta"] Number: nut_approach_um nut screw_approach_um screw = |s, at| Some(s.ball.contact(at)?.pressed.as_ref()?.approach / UM),
            "elastic approach";
        "film" ["um" "h"] Number: nut_film_um nut screw_film_um screw = |s, at| Some(film(s, at)?.thickness / UM),
            "film thickness";
        "film ratio" ["" "Lambda"] Number: nut_film_ratio nut screw_film_ratio screw = |s, at| Some(film(s, at)?.ratio),
            "film thickness divided by roughness: below 0.3 boundary, up to 2 mixed, above 2 full-film lubrication";
        "asperity load share" ["" "xi"] Number: nut_asperity_share nut screw_asperity_share screw = |s, at| Some(film(s, at)?.asperity_share),
            "share of the load that asperities carry";
        "friction coefficient" ["" "mu"] Number: nut_friction_coefficient nut screw_friction_coefficient screw = |s, at| Some(film(s, at)?.friction),
            "mean friction coefficient: sliding power divided by the sliding power for a coefficient of one";
        "rolling moment" ["N mm"] Number: nut_rolling_moment_Nmm nut screw_rolling_moment_Nmm screw = |s, at| Some(film(s, at)?.rolling_moment / MM),
            "moment that opposes rolling, due to lubricant and hysteresis";
        "entrainment" ["m/s" "u"] Number: nut_entrainment_m_s nut screw_entrainment_m_s screw = |s, at| Some(film(s, at)?.entrainment),
            "mean speed of both surfaces along the track";
    }
    hidden {
        "power_balance" [""] Number: power_balance whole = |s, _| s.transmission.power_balance,
            "relative error of the power balance; for an exact solution, only rounding errors remain";
        "iterations" [""] Count: iterations whole = |s, _| Some(constant(s, count(s.info?.steps))),
            "number of Newton steps, or of sweeps in model `rigid`";
        "residual_norm" [""] Number: residual_norm whole = |s, _| Some(constant(s, s.info?.residual)),
            "scaled residual of the equations";
        "seal_power_W" ["W"] Number: seal_power_W whole = |s, _| Some(s.film.as_ref()?.outside.seal),
            "power loss of the seals, which warms the lubricant; included in screw_torque_Nm, but not in dissipated_power_W";
        "self_locking" [""] Flag: self_locking whole = |s, _| Some(flags(s, s.transmission.self_locking)),
            "true if the screw is self-locking in this direction";
        "controlling_raceway" [""] Raceway: controlling_raceway whole = |s, _| Some(constant(s, f64::from(s.control?.raceway as u8))),
            "raceway on which the ball does not spin (raceway control)";
        "control_consistent" [""] Flag: control_consistent whole = |s, _| Some(constant(s, yes(s.control?.consistent?))),
            "true if the controlling raceway has the larger spin friction moment in this solution; false if this condition is met neither under nut control nor under screw control";
        "other_solutions" [""] Count: other_solutions whole = |s, _| Some(constant(s, count(s.alternatives?.count))),
            "number of other steady motions known at this point; null: unknown, because no search was made or the search failed";
        "other_solution_efficiency" [""] Number: other_solution_efficiency whole = |s, _| Some(constant(s, s.alternatives?.farthest_efficiency?)),
            "efficiency of the other steady motion whose efficiency differs most from the efficiency of this motion";
        "evidence" [""] Evidence: evidence whole = |_, _| None,
            "evidence for no_solution: proof; bound (solutions are excluded by a limit that was determined in tests at many points: the error of an expansion, or the boundary of the range in which several solutions exist); traced (the branch that starts at small inertia was traced to its end in finite steps, or all lubricant temperatures up to a limit were searched in finite steps)";
    }
}

#[cfg(test)]
mod tests {
    use bsm_dyn::Control;

    use super::*;

    /// A column for the controlling raceway contains indices of raceway names.
    #[test]
    fn index_in_a_controlling_raceway_column_is_the_index_of_the_raceway_name() {
        let output = Output::named("controlling_raceway").expect("an output");
        for raceway in Control::ALL {
            assert_eq!(output.word(f64::from(raceway as u8)), Some(raceway.name()));
        }
    }

    /// The unit at the end of every output name is recognized, so that `low` or `high` can be
    /// inserted before the unit.
    #[test]
    fn names_of_interval_ends_contain_low_or_high_before_the_unit() {
        for output in Output::all().filter(|output| output.output_type == OutputType::Number) {
            let suffix = unit_suffix(output.name, output.unit);
            let (name, unit) = (output.name, output.unit);
            assert_eq!(suffix.is_empty(), unit.is_empty(), "{name} [{unit}]");
        }
        let named = |of: &str| Output::named(of).expect("an output");
        let names = |of: &str| Output::ends(named(of)).map(|end| end.name);
        assert_eq!(names("ball_torque_Nm"), ["ball_torque_low_Nm", "ball_torque_high_Nm"]);
        assert_eq!(names("efficiency"), ["efficiency_low", "efficiency_high"]);
        let [low, _] = names("nut_stiffness_N_um");
        assert_eq!(low, "nut_stiffness_low_N_um");
        let (of, is_high) = named(low).interval().expect("an end");
        assert_eq!((of.name, is_high), ("nut_stiffness_N_um", false));
    }
}
