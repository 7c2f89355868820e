//! Checks of claims in Lin, Velinsky and Ravani (1994) about the closed-form solution and the exact
//! theory.

mod statements;

use std::collections::BTreeMap;

use bsm_case::Case;
use bsm_dyn::{
    Direction, Model, ModelWorkspace, Problem, Status,
    angles::{Angles, Optimum},
};
use serde::Deserialize;

use crate::{Check, PublishedData, ValidateError};
use bsm_design::search::{minimum_of, root_of};

const SOURCE: &str = "Lin, Velinsky and Ravani 1994";

/// Returns all checks of this paper.
pub(crate) fn checks(published: &PublishedData) -> Result<Vec<Check>, ValidateError> {
    let claims = Claims::read(published)?;
    let lin = published.lin_case.case()?;
    let mut checks = Vec::new();
    for direction in [Direction::RotaryToLinear, Direction::LinearToRotary] {
        checks.extend(reached(&lin, direction, &claims)?);
    }
    checks.extend(optimum(&claims)?);
    checks.extend(self_locking());
    checks.extend(existence(&lin, &claims)?);
    checks.extend(statements::checks(&lin)?);
    Ok(checks)
}

/// Returns the case of Fig 5 of the paper, in which the ball radius is a tenth of the pitch circle
/// radius.
pub(crate) fn slender(lin: &Case) -> Case {
    let pitch = lin.pitch_circle_diameter_mm;
    Case { ball_diameter_mm: pitch.map(|pitch| 0.1 * pitch), ..lin.clone() }
}

/// Claims in the file `claims.csv`. The map contains the value and the text of each claim, by key.
struct Claims(BTreeMap<String, (f64, String)>);

impl Claims {
    fn read(published: &PublishedData) -> Result<Self, ValidateError> {
        #[derive(Deserialize)]
        struct Row {
            key: String,
            claimed: f64,
            statement: String,
        }
        let rows: Vec<Row> = published.lin_claims.rows()?;
        let rows = rows.into_iter().map(|r| (r.key, (r.claimed, r.statement))).collect();
        Ok(Self(rows))
    }

    fn get(&self, key: &'static str) -> Result<&(f64, String), ValidateError> {
        let none = || ValidateError::of("lin1994/claims.csv", format!("no claim `{key}`"));
        self.0.get(key).ok_or_else(none)
    }
}

/// Finds the load per ball and the speed at which the efficiency error of the closed-form solution
/// reaches a given value. For the load, this value is the published error bound for all lead angles
/// or for all contact angles. For the speed, the value is one percentage point.
fn reached(lin: &Case, direction: Direction, claims: &Claims) -> Result<Vec<Check>, ValidateError> {
    let (suffix, equation) = match direction {
        Direction::RotaryToLinear => ("rotary-to-linear", "Eq 14"),
        Direction::LinearToRotary => ("linear-to-rotary", "Eq 17"),
    };
    let source = format!("{SOURCE}, {equation} against Eqs 5-9");
    let mut lin = lin.clone();
    lin.screw_speed_rpm = lin.screw_speed_rpm.map(|rpm| direction.sign() * rpm);
    let mut checks = Vec::new();
    for (key, input, degrees) in [
        ("lead-angle-bound", "lead_angle_deg", 1..=60),
        ("contact-angle-bound", "contact_angle_deg", 5..=85),
    ] {
        let (bound, _) = claims.get(key)?;
        // The unknown of the search is the logarithm of the load.
        let search = |log_load: f64| {
            let load = Some(10.0_f64.powf(log_load));
            let mut case = Case { axial_load_N: load, ..lin.clone() };
            let mut largest = 0.0_f64;
            for value in degrees.clone() {
                case.set(input, f64::from(value))?;
                largest = largest.max(deviation(&case)?.unwrap_or(0.0));
            }
            Ok::<_, ValidateError>(largest - bound)
        };
        let load = 10.0_f64.powf(root_of(search, 0.0, 3.3)?);
        let claim =
            format!("load per ball at which the deviation reaches {bound} percentage points");
        checks.push(
            Check::new(&format!("lin1994/{key}-{suffix}-load"), &source, claim)
                .measured(load, "N")
                .note("at 2000 rpm; for comparison, the load in the paper is 2113 N"),
        );
    }
    let search = |log_rpm: f64| {
        let rpm = direction.sign() * 10.0_f64.powf(log_rpm);
        let case = Case { screw_speed_rpm: Some(rpm), ..lin.clone() };
        Ok::<_, ValidateError>(deviation(&case)?.unwrap_or(f64::INFINITY) - 1.0)
    };
    let rpm = 10.0_f64.powf(root_of(search, 3.3, 5.5)?);
    let key = format!("lin1994/speed-of-one-percent-{suffix}");
    let claim = "speed at which the deviation reaches 1 percentage point, at 2113 N";
    checks.push(Check::new(&key, &source, claim).measured(rpm, "rpm"));
    Ok(checks)
}

/// Returns the difference between the efficiencies of the closed-form solution and of the rigid
/// model, in percentage points. Returns `None` if the rigid model has no solution.
fn deviation(case: &Case) -> Result<Option<f64>, ValidateError> {
    let efficiency = |model: Model| -> Result<_, ValidateError> {
        Ok(case.problem(&model.into())?.solve(&mut ModelWorkspace::default()).efficiency())
    };
    let both = efficiency(Model::Rigid)?.zip(efficiency(Model::ClosedForm)?);
    Ok(both.map(|(exact, closed)| 100.0 * (exact - closed).abs()))
}

/// Compares the formula for the optimum contact angle with the numerical maximum of Eqs 14 and 17.
fn optimum(claims: &Claims) -> Result<Vec<Check>, ValidateError> {
    const F: f64 = 0.075;
    let mut checks = Vec::new();
    let (best, statement) = claims.get("best-efficiency")?;
    for (direction, suffix, source) in [
        (Direction::RotaryToLinear, "rotary-to-linear", format!("{SOURCE}, Eqs 14-15")),
        (Direction::LinearToRotary, "linear-to-rotary", format!("{SOURCE}, Eqs 17-18")),
    ] {
        let (mut eta, mut constant_off, mut condition_off) = (*best, 0.0_f64, 0.0_f64);
        let mut leads = 0;
        for lead_deg in 1..=40 {
            let lead = f64::from(lead_deg).to_radians();
            if Optimum::of(direction, lead, F).is_none() {
                continue;
            }
            leads += 1;
            let loss = |contact: f64| {
                Ok::<_, ValidateError>(1.0 - Angles { lead, contact }.efficiency(direction, F))
            };
            let contact = minimum_of(loss, 0.3, 1.57)?;
            let angles = Angles { lead, contact };
            let (s, d) = (contact.sin(), angles.slip_factor());
            let percent = 100.0 * angles.efficiency(direction, F);
            if (percent - best).abs() > (eta - best).abs() {
                eta = percent;
            }
            constant_off =
                constant_off.max((lead.cos() * s - Optimum::constant(direction, F)).abs());
            let condition = d * d - s * s + direction.sign() * 2.0 * F * s * d;
            condition_off = condition_off.max(condition.abs());
        }
        let over = format!("numerical maximum for {leads} lead angles from 1 deg");
        checks.push(
            Check::new(&format!("lin1994/best-efficiency-{suffix}"), &source, statement)
                .measured(eta, "%")
                .note(format!("the value farthest from the claim is shown; {over}"))
                .equals(*best, 0.05, "three printed digits"),
        );
        // A function is flat near its maximum, so the location of the maximum is accurate only to
        // the square root of the relative rounding error.
        let located = "the location of a maximum is accurate only to the square root of the rounding error, 1e-7";
        checks.push(
            Check::new(
                &format!("lin1994/optimum-constant-{suffix}"),
                &source,
                "cos(lead angle) sin(contact angle) is constant at the optimum (closed form derived in this project)",
            )
            .measured(constant_off, "largest deviation")
            .note(over.clone())
            .at_most(1e-6, located),
        );
        checks.push(
            Check::new(
                &format!("lin1994/optimum-condition-{suffix}"),
                &source,
                "the published condition for the optimum holds (Eq 18, with the missing factor D restored)",
            )
            .measured(condition_off, "largest residual")
            .note(over)
            .at_most(1e-6, located),
        );
    }
    Ok(checks)
}

/// Checks on a grid of angles and friction coefficients that the screw is self-locking according to
/// Eqs 16 and 19 exactly where the efficiency of Eqs 14 and 17 is not positive.
fn self_locking() -> Vec<Check> {
    let mut checks = Vec::new();
    for (direction, suffix, equation) in [
        (Direction::RotaryToLinear, "rotary-to-linear", "Eq 16"),
        (Direction::LinearToRotary, "linear-to-rotary", "Eq 19"),
    ] {
        let (mut wrong, mut locked, mut points) = (0, 0, 0);
        for lead in 1..60 {
            for contact in 1..90 {
                for friction in 1..=20 {
                    let (a, b) = (f64::from(lead), f64::from(contact));
                    let angles = Angles { lead: a.to_radians(), contact: b.to_radians() };
                    let f = 0.05 * f64::from(friction);
                    points += 1;
                    let locks = angles.self_locking(direction, f);
                    locked += i32::from(locks);
                    wrong += i32::from(locks != (angles.efficiency(direction, f) <= 0.0));
                }
            }
        }
        checks.push(
            Check::new(
                &format!("lin1994/self-locking-{suffix}"),
                &format!("{SOURCE}, {equation}"),
                "the screw is self-locking exactly where the efficiency is not positive",
            )
            .measured(f64::from(wrong), "points that differ")
            .note(format!("{locked} of {points} points are self-locking"))
            .at_most(0.0, "an equivalence"),
        );
    }
    checks
}

/// Checks the critical lead angle, below which no solution must be returned.
fn existence(lin: &Case, claims: &Claims) -> Result<Vec<Check>, ValidateError> {
    let work = &mut ModelWorkspace::default();
    let source = format!("{SOURCE}, Eqs 5-9; derivation in docs/theory/04-rigid.md");
    // The published critical lead angle is valid only for small inertia forces, so the speed is
    // low.
    let slow = Case { screw_speed_rpm: Some(20.0), lead_angle_deg: Some(5.0), ..lin.clone() };
    let problem = slow.problem(&Model::Rigid.into())?;
    let Problem::Rigid(rigid) = problem else { unreachable!("the model was fixed") };
    let critical = rigid.critical_lead_angle().map_or(f64::NAN, f64::to_degrees);
    let (claimed, statement) = claims.get("critical-lead-angle")?;

    let mut wrong = 0;
    for tenth in 10..=200 {
        let degrees = 0.1 * f64::from(tenth) + 0.05;
        let case = Case { lead_angle_deg: Some(degrees), ..slow.clone() };
        let status = case.problem(&Model::Rigid.into())?.solve(work).status();
        let expected = if degrees < critical { Status::NoSolution } else { Status::Converged };
        wrong += i32::from(status != expected);
    }
    Ok(vec![
        Check::new("lin1994/critical-lead-angle", &source, statement)
            .measured(critical, "deg")
            .equals(*claimed, 0.005, "two printed decimals"),
        Check::new(
            "lin1994/no-false-root",
            &source,
            "no solution is returned below the critical lead angle, and a solution is returned above it",
        )
        .measured(f64::from(wrong), "wrong results at 191 points")
        .note("lead angles of 1.05 to 20.05 deg; the root at infinity is never returned")
        .at_most(0.0, "the program decides exactly whether a solution exists"),
    ])
}
