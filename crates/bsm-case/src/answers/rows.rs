//! The numbers of an answer in the order in which people read them.

use crate::vocabulary::units::MM;
use crate::{Numbers, OUTPUTS, Of, Output, OutputKey as Key, Quantity, Record, Scene};

/// Below this part of what is usual for its unit a number is rounding, and is shown as 0.
const ROUNDING: f64 = 1e-12;

/// What is usual for a unit in one table: the largest number that has it; 180 for angles.
#[derive(Debug, Clone)]
pub struct Scales(Vec<(&'static str, f64)>);

impl Scales {
    /// Of numbers with their units.
    pub fn of(numbers: impl Iterator<Item = (&'static str, f64)>) -> Self {
        let mut scales = vec![("deg", 180.0)];
        for (unit, value) in numbers {
            match scales.iter_mut().find(|(known, _)| *known == unit) {
                Some((_, largest)) => *largest = value.abs().max(*largest),
                None => scales.push((unit, value.abs())),
            }
        }
        Self(scales)
    }

    /// A number, or zero where it is rounding. What has no unit has no scale.
    pub fn clean(&self, unit: &str, value: f64) -> f64 {
        let scale = self.0.iter().find(|(known, _)| !unit.is_empty() && *known == unit);
        let noise = scale.is_some_and(|(_, largest)| value.abs() < ROUNDING * largest);
        if noise { 0.0 } else { value }
    }
}

macro_rules! shown {
    ($($label:literal: $first:ident $($other:ident)*;)*) => {
        /// The numbers of a record that people see, in their order: label, and outputs, several at nut, screw and unloaded flank.
        const SHOWN: &[Quantity] = &[$(Quantity {
            name: stringify!($first),
            unit: OUTPUTS[Key::$first as usize].unit,
            symbol: "",
            about: $label,
            title: if matches!(shown!(@of $($other)*), Of::Whole) { "" } else { "contact" },
            of: shown!(@of $($other)*),
            columns: &[OUTPUTS[Key::$first as usize] $(, OUTPUTS[Key::$other as usize])*],
            needs: &[],
        },)*];
    };
    (@of) => { Of::Whole };
    (@of $($other:ident)+) => { Of::Contacts };
}

shown! {
    "efficiency, all balls": efficiency;
    "screw torque, all balls": screw_torque_Nm;
    "input power": input_power_W;
    "output power": output_power_W;
    "dissipated power": dissipated_power_W;
    "  sliding at the contacts": sliding_power_W;
    "  rolling resistance": rolling_power_W;
    "  ball-to-ball contact": ball_contact_power_W;
    "  ball returns": return_power_W;
    "  drag": drag_power_W;
    "equivalent constant friction coefficient": equivalent_friction_coefficient;
    "equivalent thread friction coefficient": catalogue_friction_coefficient;
    "temperature of the lubricant": lubricant_temperature_C;
    "viscosity": viscosity_mPas;
    "pressure-viscosity coefficient": pressure_viscosity_1_GPa;
    "heating of the film": film_heating_K;
    "efficiency error bound": efficiency_error_bound;
    "relative loss error bound": loss_error_bound;
    "axial displacement of the nut": axial_displacement_um;
    "ball precession about the axis": ball_precession_rad_s;
    "ball rotation along the helix t": ball_omega_t_rad_s;
    "ball rotation towards the axis n": ball_omega_n_rad_s;
    "ball rotation along the binormal b": ball_omega_b_rad_s;
    "skid number": skid_number;
    "skid onset number": onset_number;
    "normal load per ball": nut_normal_load_N screw_normal_load_N minor_normal_load_N;
    "contact angle": nut_contact_angle_deg screw_contact_angle_deg;
    "slip speed": nut_slip_velocity_m_s screw_slip_velocity_m_s minor_slip_velocity_m_s;
    "direction of friction": nut_slip_angle_deg screw_slip_angle_deg minor_slip_angle_deg;
    "spin about the normal": nut_spin_rad_s screw_spin_rad_s;
    "largest pressure": nut_max_pressure_MPa screw_max_pressure_MPa;
    "ellipse across the groove": nut_ellipse_a_mm screw_ellipse_a_mm;
    "ellipse along the groove": nut_ellipse_b_mm screw_ellipse_b_mm;
    "elastic approach": nut_approach_um screw_approach_um;
    "film": nut_film_um screw_film_um;
    "film ratio": nut_film_ratio screw_film_ratio;
    "asperity load share": nut_asperity_share screw_asperity_share;
    "friction coefficient": nut_friction_coefficient screw_friction_coefficient;
    "rolling moment": nut_rolling_moment_Nmm screw_rolling_moment_Nmm;
    "entrainment": nut_entrainment_m_s screw_entrainment_m_s;
}

impl Record {
    /// Its numbers for reading, rounding as zero; `scene` is what was asked.
    pub fn rows(&self, scene: &Scene) -> Numbers {
        // A ball that rolls has slips that are all rounding: the speed of its surface tells.
        let surface = self.number("ball_omega_t_rad_s").map_or(0.0, |omega_t| {
            let rates = ["ball_omega_n_rad_s", "ball_omega_b_rad_s"].map(|name| self.number(name));
            let fastest = rates.into_iter().flatten().fold(omega_t.abs(), |a, b| a.max(b.abs()));
            0.5 * MM * scene.ball_diameter_mm.unwrap_or(0.0) * fastest
        });
        let numbers = OUTPUTS.iter().filter_map(|o| Some((o.unit, self.number(o.name)?)));
        let scales = Scales::of(numbers.chain([("m/s", surface)]));
        let read = |place: usize| {
            let Quantity { columns, unit, .. } = SHOWN[place];
            let number = |column: &Output| Some(scales.clean(unit, self.number(column.name)?));
            [0, 1, 2].map(|member| columns.get(member).and_then(number))
        };
        Numbers::of(SHOWN, read, |_| true)
    }
}
