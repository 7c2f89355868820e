//! Checks of load ratings and stiffness against the tables of Sobolewski (2002).

use std::f64::consts::FRAC_PI_4;

use bsm_case::units::{MM, UM};
use bsm_design::catalog::{BALL_GAP, loaded_balls};
use bsm_design::{Nut, NutBody, NutSet, PRELOAD, ROLLING_LEVER, Thread};
use bsm_dyn::{Conformities, Material, Materials};
use serde::Deserialize;

use crate::report::largest;
use crate::{Check, PublishedData, ValidateError};

const TABLES: &str = "Sobolewski (2002), according to ISO/DP 9783 and 9784";
const PAPER: &str = "Sobolewski (2002)";

/// Steel of the nuts in the tables of Sobolewski (2002).
const STEEL: Material = Material { youngs_modulus: 206e9, poisson_ratio: 0.3 };

/// Returns all checks of load ratings and stiffness.
pub(crate) fn checks(published: &PublishedData) -> Result<Vec<Check>, ValidateError> {
    let mut checks = Vec::new();
    let rows = published.rating_tables.rows::<Row>()?;
    checks.extend(QUANTITIES.iter().map(|quantity| quantity.check(&rows)));
    checks.extend(statements(&rows));
    Ok(checks)
}

#[derive(Deserialize)]
#[expect(non_snake_case, reason = "columns of the table")]
struct Row {
    nominal_diameter_mm: f64,
    calculated_diameter_mm: f64,
    lead_mm: f64,
    turns: f64,
    ball_diameter_mm: f64,
    groove_radius_mm: f64,
    conformity: f64,
    groove_offset_mm: f64,
    dynamic_load_rating_N: f64,
    stiffness_characteristic_N_um15: f64,
    preloaded_stiffness_N_um: f64,
    outer_diameter_mm: f64,
    nut_length_mm: f64,
    mass_kg: f64,
    efficiency: f64,
}

impl Row {
    fn name(&self) -> String {
        format!(
            "{} x {} mm, ball {} mm, {} turns, conformity {}",
            self.calculated_diameter_mm,
            self.lead_mm,
            self.ball_diameter_mm,
            self.turns,
            self.conformity
        )
    }

    fn nut(&self) -> Nut {
        let (nominal, lead) = (self.nominal_diameter_mm * MM, self.lead_mm * MM);
        let ball_diameter = self.ball_diameter_mm * MM;
        let (pitch_diameter, balls_per_turn) = loaded_balls(nominal, lead, ball_diameter, BALL_GAP);
        Nut {
            ball_diameter,
            pitch_diameter,
            lead,
            contact_angle: FRAC_PI_4,
            conformity: Conformities::alike(self.conformity),
            material: Materials::alike(STEEL),
            starts: 1.0,
            balls_per_turn,
            turns: self.turns,
        }
    }
}

/// Returns the stiffness of a nut pair at the preload that the tables assume \[N/um\].
fn pair_stiffness(nut: &Nut) -> f64 {
    let preload = PRELOAD * nut.dynamic_rating().rating;
    let elasticity = nut.elasticity(&NutBody::usual(nut, NutSet::Single));
    elasticity.map_or(f64::NAN, |elasticity| elasticity.preloaded_pair(preload) * UM)
}

/// A column of the tables, and the function that calculates its values.
struct Column {
    key: &'static str,
    what: &'static str,
    unit: &'static str,
    printed: fn(&Row) -> f64,
    ours: fn(&Nut) -> f64,
    /// Absolute and relative tolerance of the values in the column.
    tolerance: (f64, f64),
    reason: &'static str,
}

/// Each column is written as `key printed ["unit"] "what": ours; absolute + relative, "reason";`
macro_rules! columns {
    ($($key:literal $printed:ident [$unit:literal] $what:literal: $ours:expr; $absolute:literal + $relative:literal, $reason:literal;)*) => {
        &[$(Column {
            key: $key,
            what: $what,
            unit: $unit,
            printed: |row| row.$printed,
            ours: $ours,
            tolerance: ($absolute, $relative),
            reason: $reason,
        }),*]
    };
}

const QUANTITIES: &[Column] = columns! {
    "diameter" calculated_diameter_mm ["mm"] "pitch circle diameter at which the balls fill the circumference": |nut| nut.pitch_diameter / MM;
        1e-3 + 0.0, "steps of 0.01 mm";
    "groove-radius" groove_radius_mm ["mm"] "groove radius": |nut| thread(nut).nut.radius / MM;
        5e-3 + 0.0, "two printed decimals";
    "groove-offset" groove_offset_mm ["mm"] "offset of the arc centers, eq. 1": |nut| thread(nut).nut.offset / MM;
        5e-3 + 0.0, "two printed decimals";
    "dynamic" dynamic_load_rating_N ["N"] "dynamic load rating": |nut| nut.dynamic_rating().rating;
        1.0 + 0.0, "one unit of the last printed digit; the diameter has four digits";
    "stiffness-characteristic" stiffness_characteristic_N_um15 ["N/um^1.5"] "stiffness characteristic of one turn":
        |nut| nut.elasticity(&NutBody::usual(nut, NutSet::Single)).map_or(f64::NAN, |e| e.turn_constant * 1e-9);
        0.0 + 0.02, "2 %: exact Hertzian contacts are used instead of fits that the source does not print; all five rows with conformity 0.52 are 1.5 to 1.8 % too low";
    "stiffness" preloaded_stiffness_N_um ["N/um"] "stiffness of the preloaded pair": pair_stiffness;
        0.0 + 0.012, "1.2 %: two thirds of the error of the stiffness characteristic";
    "outer-diameter" outer_diameter_mm ["mm"] "outer diameter": |nut| NutBody::usual(nut, NutSet::Single).outer / MM;
        1e-3 + 0.0, "steps of 0.01 mm";
    "length" nut_length_mm ["mm"] "length of the nut": |nut| NutBody::usual(nut, NutSet::Single).length / MM;
        1e-3 + 0.0, "a whole number of leads";
    "mass" mass_kg ["kg"] "mass of the nut": |nut| NutBody::usual(nut, NutSet::Single).mass(nut, &thread(nut));
        0.0 + 0.052, "the source does not state how the mass is calculated; none of 360 tested rules agrees to within 3.8 % for all rows";
    "efficiency" efficiency [""] "efficiency": |nut| nut.rolling_efficiency(ROLLING_LEVER);
        5e-3 + 0.0, "two printed digits; neither the formula nor the lever arm is published, and the arm was fitted to these rows";
};

/// Returns the thread of a nut without play. The lands of the thread have their default width.
fn thread(nut: &Nut) -> Thread {
    nut.thread(0.0, nut.usual_lands())
}

impl Column {
    fn tolerance_of(&self, row: &Row) -> f64 {
        self.tolerance.0 + self.tolerance.1 * (self.printed)(row)
    }

    /// Compares a column of the tables with calculated values. The check states the row with the
    /// largest ratio of deviation to tolerance, and the details list all rows.
    fn check(&self, rows: &[Row]) -> Check {
        let Self { printed, ours, .. } = self;
        let off = |row: &Row| {
            let off = (ours(&row.nut()) - printed(row)).abs() / self.tolerance_of(row);
            // If a number is missing, the deviation counts as infinite.
            if off.is_nan() { f64::INFINITY } else { off }
        };
        let worst = rows.iter().max_by(|a, b| off(a).total_cmp(&off(b)));
        let worst = worst.expect("a table without rows is rejected earlier");
        let line = |row: &Row| {
            let (claimed, ours) = (printed(row), ours(&row.nut()));
            let off = 100.0 * (ours / claimed - 1.0);
            format!("{}: {claimed} printed, {ours:.5} calculated, {off:+.2} %", row.name())
        };
        let ratios = || rows.iter().map(|row| 100.0 * (ours(&row.nut()) / printed(row) - 1.0));
        let (low, high) =
            (ratios().fold(f64::INFINITY, f64::min), ratios().fold(f64::NEG_INFINITY, f64::max));
        let mut check = Check::new(
            &format!("ratings/{}", self.key),
            TABLES,
            format!("{} of {} rows", self.what, rows.len()),
        )
        .measured(ours(&worst.nut()), self.unit)
        .equals(printed(worst), self.tolerance_of(worst), self.reason)
        .note(format!(
            "row with the largest deviation among {} rows: {}; all deviations are from {low:+.2} to {high:+.2} %",
            rows.len(),
            worst.name()
        ));
        check.details = rows.iter().map(line).collect::<Vec<_>>().join("; ");
        check
    }
}

/// Checks two statements of the paper: in every row, load rating and stiffness decrease if the
/// contact angle is reduced from 45 deg, and they also decrease if the conformity is increased from
/// 0.51.
fn statements(rows: &[Row]) -> [Check; 2] {
    let angle = |row: &Row, i: i32| Nut {
        contact_angle: FRAC_PI_4 - f64::from(i).to_radians(),
        ..row.nut()
    };
    let conformity = |row: &Row, i: i32| {
        let f = 0.51 + 0.01 * f64::from(i);
        Nut { conformity: Conformities::alike(f), ..row.nut() }
    };
    let largest_step = |nut: &dyn Fn(&Row, i32) -> Nut, steps: i32| {
        let numbers: [fn(&Nut) -> f64; 2] = [|nut| nut.dynamic_rating().rating, pair_stiffness];
        let step = |row: &Row, i: i32| {
            largest(numbers.iter().map(|of| of(&nut(row, i + 1)) / of(&nut(row, i))))
        };
        let steps = rows.iter().flat_map(|row| (0..steps).map(move |i| (row, i)));
        largest(steps.map(|(row, i)| step(row, i)))
    };
    let check = |key: &str, claim: &str, largest: f64| {
        Check::new(key, PAPER, claim)
            .measured(largest, "")
            .at_most(1.0, "largest ratio of consecutive values in all rows, for both quantities")
    };
    [
        check(
            "ratings/contact-angle",
            "load rating and stiffness decrease if the contact angle decreases from 45 to 30 deg",
            largest_step(&angle, 15),
        ),
        check(
            "ratings/conformity",
            "load rating and stiffness decrease if the conformity increases from 0.51 to 0.57",
            largest_step(&conformity, 6),
        ),
    ]
}
