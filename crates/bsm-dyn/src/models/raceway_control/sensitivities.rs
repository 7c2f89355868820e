//! Derivatives of the efficiency and the torque of the raceway-control model.
//!
//! Theory: `docs/theory/12-sensitivities.md`.

use bsm_kin::{Jet, Motion};

use super::{Balance, RacewayControl, RacewayWorkspace, RollingBall, STATIC_UNKNOWNS};
use crate::contact::efficiency;
use crate::ellipse::{Placement, Quadrature};
use crate::models::ball::{
    BallLoads, ElasticContacts, Performance, SolveFailure, Workspace, moving_root,
};

/// An operating point with the loads and the motion of the ball.
type BallInMotion<D> = (ElasticContacts<D>, BallLoads<D>, Motion<D>);

impl<const M: usize> RacewayControl<Jet<M>> {
    /// Returns the efficiency and the torque with their derivatives with respect to the inputs, for
    /// a fixed controlling raceway.
    pub(crate) fn sensitivities(
        &self,
        RacewayWorkspace { newton, quadrature, sensitivity_quadrature }: &mut RacewayWorkspace,
    ) -> Result<Performance<Jet<M>>, SolveFailure> {
        let (inputs, loaded, to_nut) = self.moving(newton)?;
        let transmitted = |rule: &Quadrature| {
            let nodes = [Placement::from(rule); 2];
            let creep = RacewayControl::<f64>::CREEP;
            let [nut, screw] = inputs.friction_powers(&loaded, &to_nut, creep, nodes);
            let (ideal, torque) = self.screw.rolling_torques(nut + screw);
            [efficiency(inputs.direction.is_back(), ideal, torque), torque]
        };
        // Derivatives need a finer quadrature rule, because they neglect the motion of the
        // quadrature nodes.
        let (values, slopes) = (transmitted(quadrature), transmitted(sensitivity_quadrature));
        let [efficiency, torque] =
            std::array::from_fn(|i| Jet { re: values[i].re, eps: slopes[i].eps });
        Ok(Performance { efficiency, screw_torque: Some(torque) })
    }

    /// Returns the operating point with the loads and the motion of the ball, all with derivatives.
    fn moving(
        &self,
        newton: &mut Workspace<STATIC_UNKNOWNS>,
    ) -> Result<BallInMotion<Jet<M>>, SolveFailure> {
        let (inputs, point) = (self.screw.scaled()?, self.screw.values().scaled()?);
        let RollingBall { control, unknowns, .. } = RollingBall::of(&point, self.control, newton)?;
        let system = Balance::new(&point, control);
        let equations = Balance::new(&inputs, control);
        let residual = |x: &_| Ok(equations.equations(x));
        let x = moving_root(&system, &unknowns, &system.weights(), residual, newton)?;
        let loaded = equations.loaded(&x);
        let to_nut = equations.rolling(&loaded);
        Ok((inputs, loaded, to_nut))
    }

    /// Returns the operating point with the loads and the motion of the ball, all with derivatives.
    /// The solver uses the buffers of the given workspace.
    pub(crate) fn rolling_ball(
        &self,
        work: &mut RacewayWorkspace,
    ) -> Result<BallInMotion<Jet<M>>, SolveFailure> {
        self.moving(&mut work.newton)
    }
}
