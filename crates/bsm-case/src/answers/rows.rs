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

/// The numbers of a record that people see, in their order: label, first output, and how many there are of nut, screw and
/// minor contact.
const SHOWN: &[Quantity] = &[
    shown("efficiency, all balls", Key::efficiency, 1),
    shown("screw torque, all balls", Key::screw_torque_Nm, 1),
    shown("input power", Key::input_power_W, 1),
    shown("output power", Key::output_power_W, 1),
    shown("dissipated power", Key::dissipated_power_W, 1),
    shown("  sliding at the contacts", Key::sliding_power_W, 1),
    shown("  rolling resistance", Key::rolling_power_W, 1),
    shown("  balls on each other", Key::ball_contact_power_W, 1),
    shown("  ball returns", Key::return_power_W, 1),
    shown("  drag", Key::drag_power_W, 1),
    shown("equivalent friction coefficient", Key::equivalent_friction_coefficient, 1),
    shown("friction coefficient of catalogues", Key::catalogue_friction_coefficient, 1),
    shown("temperature of the lubricant", Key::lubricant_temperature_C, 1),
    shown("viscosity", Key::viscosity_mPas, 1),
    shown("pressure-viscosity coefficient", Key::pressure_viscosity_1_GPa, 1),
    shown("heating of the film", Key::film_heating_K, 1),
    shown("error of the efficiency, at most", Key::efficiency_error_bound, 1),
    shown("error over this dissipated power, at most", Key::loss_error_bound, 1),
    shown("axial displacement of the nut", Key::axial_displacement_um, 1),
    shown("ball precession about the axis", Key::ball_precession_rad_s, 1),
    shown("ball rotation along the helix t", Key::ball_omega_t_rad_s, 1),
    shown("ball rotation towards the axis n", Key::ball_omega_n_rad_s, 1),
    shown("ball rotation along the binormal b", Key::ball_omega_b_rad_s, 1),
    shown("skid number", Key::skid_number, 1),
    shown("skid onset number", Key::onset_number, 1),
    shown("normal load per ball", Key::nut_normal_load_N, 3),
    shown("contact angle", Key::nut_contact_angle_deg, 2),
    shown("slip speed", Key::nut_slip_velocity_m_s, 3),
    shown("direction of friction", Key::nut_slip_angle_deg, 3),
    shown("spin about the normal", Key::nut_spin_rad_s, 2),
    shown("largest pressure", Key::nut_max_pressure_MPa, 2),
    shown("ellipse across the groove", Key::nut_ellipse_a_mm, 2),
    shown("ellipse along the groove", Key::nut_ellipse_b_mm, 2),
    shown("elastic approach", Key::nut_approach_um, 2),
    shown("film", Key::nut_film_um, 2),
    shown("film over roughness", Key::nut_film_ratio, 2),
    shown("share of asperities", Key::nut_asperity_share, 2),
    shown("friction coefficient", Key::nut_friction_coefficient, 2),
    shown("rolling moment", Key::nut_rolling_moment_Nmm, 2),
    shown("entrainment", Key::nut_entrainment_m_s, 2),
];

/// A quantity of one output, or of several that follow each other.
const fn shown(label: &'static str, first: Key, count: usize) -> Quantity {
    let columns = OUTPUTS.split_at(first as usize).1.split_at(count).0;
    Quantity {
        name: columns[0].name,
        unit: columns[0].unit,
        symbol: "",
        about: label,
        title: if count == 1 { "" } else { "contact" },
        of: if count == 1 { Of::Whole } else { Of::Contacts },
        columns,
        needs: &[],
    }
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
