//! Load ratings and rigidity: design tables and a catalogue.

use std::f64::consts::{FRAC_PI_4, PI};

use bsm_design::{Body, Nut};
use bsm_dyn::Material;
use serde::Deserialize;

use crate::{Check, Published, ValidateError};

const TABLES: &str = "Sobolewski (2002), by ISO/DP 9783 and 9784";
const CATALOGUE: &str = "HIWIN catalogue BS-08-2, single nuts FSC";

const MM: f64 = 1e-3;
/// N/m^1.5 of N/µm^1.5, and N/m of N/µm.
const PER_UM15: f64 = 1e9;
const PER_UM: f64 = 1e6;

/// Steel of the tables.
const STEEL: Material = Material { youngs_modulus: 206e9, poisson_ratio: 0.3 };

/// Preload of the tables over the dynamic rating, and lever arm of rolling resistance \[m\].
const PRELOAD: f64 = 0.15;
const LEVER: f64 = 0.005 * MM;

/// All checks of these sources.
pub(crate) fn checks(published: &Published) -> Result<Vec<Check>, ValidateError> {
    let mut checks = Vec::new();
    for row in published.rating_tables.rows::<Row>()? {
        checks.extend(row.checks());
    }
    for row in published.rating_catalogue.rows::<Single>()? {
        checks.extend(row.checks());
    }
    Ok(checks)
}

#[derive(Deserialize)]
#[expect(non_snake_case, reason = "columns of the table")]
struct Row {
    calculated_diameter_mm: f64,
    lead_mm: f64,
    turns: f64,
    ball_diameter_mm: f64,
    conformity: f64,
    balls_per_turn: f64,
    dynamic_load_rating_N: f64,
    rigidity_characteristic_N_um15: f64,
    total_rigidity_N_um: f64,
    outer_diameter_mm: f64,
    efficiency: f64,
}

impl Row {
    fn checks(&self) -> Vec<Check> {
        let nut = Nut {
            ball_diameter: self.ball_diameter_mm * MM,
            pitch_diameter: self.calculated_diameter_mm * MM,
            lead: self.lead_mm * MM,
            contact_angle: FRAC_PI_4,
            conformity: (self.conformity, self.conformity),
            material: (STEEL, STEEL),
            balls_per_turn: self.balls_per_turn,
            turns: self.turns,
        };
        let body =
            Body { outer: self.outer_diameter_mm * MM, youngs_modulus: STEEL.youngs_modulus };
        let rating = nut.dynamic_rating();
        let turn = nut.turn_rigidity().unwrap_or(f64::NAN);
        // A pair of nuts: twice the rigidity of one in the contacts, and in the bodies.
        let contacts = 2.0 * nut.contacts_under(PRELOAD * rating).map_or(f64::NAN, |(_, c)| c);
        let bodies = 2.0 * nut.body_rigidity(&body);
        let total = (contacts.recip() + bodies.recip()).recip();
        let check = |key: &str, claim: &str| {
            let key = format!("ratings/{key}-{}", self.calculated_diameter_mm);
            let claim = format!("{claim}, nut of {} mm", self.calculated_diameter_mm);
            Check::new(&key, TABLES, claim)
        };
        let fits = "exact Hertz in place of the fits of the table";
        vec![
            check("dynamic", "dynamic load rating").measured(rating, "N").equals(
                self.dynamic_load_rating_N,
                1.0,
                "the last printed digit, of a diameter with four",
            ),
            check("rigidity-characteristic", "rigidity characteristic of a turn")
                .measured(turn / PER_UM15, "N/um^1.5")
                .equals(
                    self.rigidity_characteristic_N_um15,
                    0.03 * self.rigidity_characteristic_N_um15,
                    fits,
                ),
            check("rigidity", "rigidity of the preloaded pair")
                .measured(total / PER_UM, "N/um")
                .equals(self.total_rigidity_N_um, 0.012 * self.total_rigidity_N_um, fits),
            check("efficiency", "efficiency").measured(nut.rolling_efficiency(LEVER), "").equals(
                self.efficiency,
                0.005,
                "two printed digits",
            ),
        ]
    }
}

#[derive(Deserialize)]
#[expect(non_snake_case, reason = "columns of the table")]
struct Single {
    nut: String,
    lead_mm: f64,
    ball_diameter_mm: f64,
    circuits: f64,
    core_mm: f64,
    dynamic_load_rating_N: f64,
    static_load_rating_N: f64,
}

impl Single {
    fn checks(&self) -> [Check; 2] {
        const CONFORMITY: f64 = 0.5203;
        let ball = self.ball_diameter_mm;
        let deep = 2.0 * (CONFORMITY - 0.5) * ball * (1.0 - FRAC_PI_4.cos());
        let pitch = self.core_mm + ball + deep;
        let nut = Nut {
            ball_diameter: ball * MM,
            pitch_diameter: pitch * MM,
            lead: self.lead_mm * MM,
            contact_angle: FRAC_PI_4,
            conformity: (CONFORMITY, CONFORMITY),
            material: (STEEL, STEEL),
            balls_per_turn: (PI * pitch).hypot(self.lead_mm) / ball,
            turns: self.circuits - 0.19,
        };
        let check = |what: &str, ours: f64, claimed: f64| {
            Check::new(
                &format!("ratings/{what}-{}", self.nut),
                CATALOGUE,
                format!("{what} load rating of {}", self.nut),
            )
            .measured(ours, "N")
            .equals(
                claimed,
                0.04 * claimed,
                "4 %: the maker's geometry is a rule that fits it",
            )
        };
        [
            check("dynamic", nut.dynamic_rating(), self.dynamic_load_rating_N),
            check("static", nut.static_rating(), self.static_load_rating_N),
        ]
    }
}
