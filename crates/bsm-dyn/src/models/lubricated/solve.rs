//! Steady state of a lubricated ball with raceway control or traction, including the heat balance
//! of the lubricant.
//!
//! Theory: `docs/theory/17-lubricant.md`, equations (Y22), (Y23), (Y28) to (Y31).

use std::iter::successors;

use bsm_kin::{Motion, Scalar};
use bsm_newton::Bracket;

use crate::contact::{BallOrbit, Lubricant, OutsidePower, Temperature, ZERO_CELSIUS, magnitude};
use crate::ellipse::{Integrate, Placement, Quadrature};
use crate::models::ball::{
    BallLoads, BallState, EhlLoss, EhlPoint, ElasticContacts, ElasticPoint, ErrorBound, Evidence,
    FilmLoss, LubricatedScrew, LubricatedState, Model, Reason, ResultUnits, Solution, SolveFailure,
    SteadyRoot, SteadyState, Transmission, to_both,
};
use crate::models::raceway_control::RacewayControl;
use crate::models::traction::{Traction, TrainBall};
use crate::models::workspace::ModelWorkspace;
use crate::outcome::named;

named! {
    /// Method by which the raceway-control model evaluates the friction law.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
    pub enum RacewayFriction {
        /// The friction coefficient is calculated from pressure and slip at each point of the
        /// contact ellipses.
        #[default]
        Local = "local",
        /// Each contact has a single friction coefficient (Y23).
        PerContact = "contact",
    }
}

/// Model of a lubricated ball. The friction coefficient of the operating point is ignored.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LubricatedModel<D = f64> {
    /// Raceway control: the ball rolls, and its force balance does not include friction.
    RacewayControl(RacewayControl<D>, RacewayFriction),
    /// Traction: the force balance of the ball includes friction.
    Traction(Traction<D>),
}

/// A lubricated screw at an operating point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LubricatedBall<D = f64> {
    /// Lubricant that determines the friction.
    pub lubricant: Lubricant<D>,
    /// Model that describes the lubricated ball.
    pub model: LubricatedModel<D>,
}

impl RacewayFriction {
    /// Returns the accuracy of the quadrature. A coarser quadrature suffices if each contact has a
    /// single friction coefficient.
    pub(super) fn accuracy(self) -> f64 {
        match self {
            Self::Local => Traction::ACCURACY,
            Self::PerContact => RacewayControl::ACCURACY,
        }
    }
}

/// Returns the power loss of both contacts, in scaled units and divided by `$W$`.
pub(super) fn contact_power_loss<D: Scalar>(losses: &[EhlLoss<D>; 2]) -> D {
    let [nut, screw] = losses;
    nut.sliding + nut.rolling + screw.sliding + screw.rolling
}

impl RacewayFriction {
    /// Calculates the forces, moments and power losses at both contacts of a rolling ball. Also
    /// returns the sliding powers for a friction coefficient of one.
    pub(super) fn losses<P: Scalar, D: Integrate<P>>(
        self,
        ehl: &EhlPoint<P>,
        contacts: &ElasticContacts<P>,
        (loaded, to_nut): (&BallLoads<D>, &Motion<D>),
        rules: [&Quadrature; 2],
    ) -> ([D; 2], [EhlLoss<D>; 2]) {
        let [oil, dry] = rules.map(Placement::from);
        let (motions, creep) = (to_both(to_nut, &loaded.frame), RacewayControl::CREEP);
        let unit = contacts.unit_powers(loaded, to_nut, creep, [dry; 2]);
        let ball = (contacts, loaded);
        let losses = match self {
            Self::Local => ehl.losses(ball, &motions, creep, [oil; 2]),
            Self::PerContact => {
                std::array::from_fn(|i| ehl.mean_loss(i, ball, &motions[i], creep, unit[i]))
            }
        };
        (unit, losses)
    }
}

impl<D: Scalar> LubricatedBall<D> {
    /// Returns the screw at its operating point.
    pub(crate) fn screw(&self) -> &ElasticPoint<D> {
        match &self.model {
            LubricatedModel::RacewayControl(case, _) => &case.screw,
            LubricatedModel::Traction(case) => &case.screw,
        }
    }

    /// Returns the power losses of the screw outside the ball contacts \[W\].
    pub(super) fn outside(
        &self,
        contacts: &ElasticContacts<D>,
        steady: &LubricatedState<D>,
    ) -> OutsidePower<D> {
        let screw = self.screw();
        let speed = screw.point.drive.relative_speed();
        let motion = contacts.absolute(&steady.to_nut, &steady.loaded.frame);
        let sliding_speed = motion.across_groove(&steady.loaded.frame.k) * speed;
        let ball = BallOrbit {
            sliding_speed: sliding_speed.dot(&sliding_speed).sqrt(),
            rate: magnitude(motion.precession * speed - screw.point.drive.nut_speed),
            relative_speed: magnitude(speed),
            radius: screw.point.ball.radius,
            mass: screw.point.ball.mass,
            pitch_radius: screw.point.helix.radius,
            arc: screw.point.helix.arc_length_per_radian(),
            balls: screw.point.load.balls,
        };
        self.lubricant.losses.power(&ball, self.lubricant.oil.density)
    }
}

/// Temperature step of the search for the lubricant temperature \[K\]. The search proceeds upward
/// from the ambient temperature.
const TEMPERATURE_STEP: f64 = 5.0;

/// Maximum lubricant temperature that the search considers \[K\].
const MAX_TEMPERATURE: f64 = ZERO_CELSIUS + 180.0;

/// Tolerance of the lubricant temperature \[K\].
const TEMPERATURE_TOLERANCE: f64 = 1e-9;

impl LubricatedBall {
    /// Returns the model that describes the lubricated ball.
    pub fn name(&self) -> Model {
        match self.model {
            LubricatedModel::RacewayControl(..) => Model::RacewayControl,
            LubricatedModel::Traction(_) => Model::Traction,
        }
    }

    /// Solves for the steady motion and the power loss of the lubricated ball.
    pub fn solve(&self, work: &mut ModelWorkspace) -> Solution {
        let solved = match self.lubricant.temperature {
            Temperature::Known(kelvin) => self.at(kelvin, work),
            Temperature::Balance { heat_transfer, ambient } => {
                self.in_heat_balance(heat_transfer, ambient, work)
            }
        };
        Solution::new(self.name(), solved)
    }

    /// Creates a lubricated ball in a ball train. Returns `None` if the model is not traction, if
    /// the temperature is not given, or if the motion without push forces is not found.
    ///
    /// * `free`: steady state of the ball without push forces.
    /// * `contact_friction`: friction coefficient between balls.
    pub fn in_train(
        &self,
        free: &BallState,
        contact_friction: f64,
        work: &mut ModelWorkspace,
    ) -> Option<TrainBall> {
        let LubricatedModel::Traction(case) = &self.model else { return None };
        let Temperature::Known(kelvin) = self.lubricant.temperature else { return None };
        let ehl = EhlPoint::new(&case.screw, &self.lubricant, kelvin).ok()?;
        TrainBall::of(case, Some(&ehl), free, contact_friction, work)
    }

    /// Returns the steady state at the lowest lubricant temperature at which power loss equals
    /// cooling power (Y28).
    ///
    /// * `heat_transfer`: product of heat transfer coefficient and area \[W/K\].
    /// * `ambient`: ambient temperature \[K\].
    fn in_heat_balance(
        &self,
        heat_transfer: f64,
        ambient: f64,
        work: &mut ModelWorkspace,
    ) -> Result<SteadyState, SolveFailure> {
        let mut surplus_cooling = |kelvin: f64| {
            let solved = self.at(kelvin, work)?;
            let seal = solved.film.map_or(f64::NAN, |film| film.outside.seal);
            let heat = solved.transmission.power.map_or(f64::NAN, |power| power.dissipated) + seal;
            // hA (T − T₀) = Σ P(T)                                        (Y28)
            Ok((heat_transfer * (kelvin - ambient) - heat, solved))
        };
        let places =
            successors(Some(ambient + TEMPERATURE_STEP), |kelvin| Some(kelvin + TEMPERATURE_STEP))
                .take_while(|kelvin| *kelvin <= MAX_TEMPERATURE);
        let begin = (ambient, surplus_cooling(ambient)?.0);
        let change =
            Bracket::first_sign_change(begin, places, |kelvin| Ok(surplus_cooling(kelvin)?.0))?;
        let Some(bracket) = change else {
            let evidence = Evidence::Scanned { step: TEMPERATURE_STEP };
            let reason = Reason::LubricantRunsAway { max_temperature: MAX_TEMPERATURE };
            return Err(SolveFailure::no_solution(evidence, reason));
        };
        let mut result = Err(SolveFailure::SEARCH_FAILED);
        let ends = bracket.ends;
        let found = Bracket { x_tol: TEMPERATURE_TOLERANCE / ends[1], ..bracket }.root(|kelvin| {
            match surplus_cooling(kelvin) {
                Ok((value, solved)) => {
                    result = Ok(solved);
                    value
                }
                Err(error) => {
                    result = Err(error);
                    f64::NAN
                }
            }
        });
        // If the root is an end of the bracket, `result` may have been calculated at a different
        // temperature.
        match found.root() {
            Some(root) if ends.contains(&root.x) => Ok(surplus_cooling(root.x)?.1),
            _ => result,
        }
    }

    /// Returns the steady state at a lubricant temperature \[K\].
    fn at(&self, kelvin: f64, work: &mut ModelWorkspace) -> Result<SteadyState, SolveFailure> {
        let screw = self.screw();
        let ehl = EhlPoint::new(screw, &self.lubricant, kelvin)?;
        let found = match &self.model {
            LubricatedModel::RacewayControl(case, friction) => {
                let ModelWorkspace { raceway, lubricated, .. } = work;
                let contacts = screw.scaled()?;
                let rolling_ball = raceway.rolling_ball(&contacts, case.control)?;
                let (loaded, to_nut) = (rolling_ball.loaded, rolling_ball.to_nut);
                let creep = RacewayControl::CREEP;
                let contacts =
                    contacts.with_friction(ehl.friction_scale(&contacts, &loaded, &to_nut, creep));
                let rules = lubricated.rules.oil_and_dry(friction.accuracy());
                let (unit, losses) = friction.losses(&ehl, &contacts, (&loaded, &to_nut), rules);
                let (_, torque) = screw.rolling_torques(contact_power_loss(&losses));
                let steady = LubricatedState { loaded, to_nut, losses, torque };
                let (skid, info, control) = rolling_ball.solve_info(&contacts);
                SteadyRoot {
                    contacts,
                    steady,
                    unit,
                    skid,
                    info,
                    control: Some(control),
                    error: None,
                }
            }
            LubricatedModel::Traction(case) => {
                case.lubricated(&ehl, &mut work.traction, &mut work.lubricated)?
            }
        };
        self.results(&ehl, &found)
    }

    /// Converts a root of the model equations into a steady state in SI units.
    fn results(&self, ehl: &EhlPoint, found: &SteadyRoot) -> Result<SteadyState, SolveFailure> {
        let (screw, SteadyRoot { contacts, steady, .. }) = (self.screw(), found);
        let LubricatedState { loaded, to_nut, losses, torque } = steady;
        let ResultUnits { torque: unit, speed, .. } = screw.point.units();
        let outside = self.outside(contacts, steady);
        let in_balance = matches!(self.model, LubricatedModel::Traction(_));
        let ball = screw.ball_state(contacts, loaded, to_nut, in_balance)?;
        let torque = torque + outside.torque(speed);
        let ideal = screw.point.ideal_torque();
        let transmission = Transmission::of(contacts.direction.is_back(), ideal, torque, speed);
        let films = [0, 1].map(|i| {
            let (EhlLoss { film, sliding, rolling, .. }, load) = (&losses[i], loaded.loads[i]);
            FilmLoss {
                film: *film,
                sliding: *sliding,
                unit: found.unit[i],
                rolling: *rolling,
                semi_axes: contacts.hertz[i].semi_axes(load * ehl.units.load),
                min_to_central_ratio: ehl.min_to_central_ratio(i, load, film),
                load_parameter: ehl.load_parameter(i, load, film),
            }
        });
        let lubricated = LubricatedScrew {
            power_unit: unit * speed,
            balls: screw.point.load.balls,
            outside,
            back: contacts.direction.is_back(),
            tan_a: screw.point.helix.lead_angle.tan(),
            efficiency: transmission.efficiency,
        };
        let film = ehl.state(&films, lubricated);
        let power_loss = film.sliding_power + film.rolling_power + outside.of_balls();
        let transmission = match self.model {
            LubricatedModel::Traction(_) => {
                transmission.with_power_balance(power_loss).balanced()?
            }
            LubricatedModel::RacewayControl(..) => transmission,
        };
        Ok(SteadyState {
            skid: Some(found.skid),
            info: Some(found.info),
            control: found.control,
            film: Some(film),
            contact_power: Some(screw.in_watts(losses.map(|loss| loss.sliding + loss.rolling))),
            error: found
                .error
                .map(|error| ErrorBound::of(contacts.direction, transmission.efficiency, error)),
            ..SteadyState::new(&ball, transmission)
        })
    }
}
