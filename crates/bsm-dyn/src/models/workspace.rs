//! Memory of the solves of all models.

use crate::models::ball::LubricatedWorkspace;
use crate::models::elastic::ElasticWorkspace;
use crate::models::gothic::GothicWorkspace;
use crate::models::raceway_control::RacewayWorkspace;
use crate::models::rigid::RigidWorkspace;
use crate::models::traction::TractionWorkspace;

/// Memory of the solves of all models, which one thread reuses from point to point.
#[derive(Default)]
pub struct ModelWorkspace {
    pub(crate) rigid: RigidWorkspace,
    pub(crate) raceway: RacewayWorkspace,
    pub(crate) elastic: ElasticWorkspace,
    pub(crate) traction: TractionWorkspace,
    pub(crate) gothic: GothicWorkspace,
    pub(crate) lubricated: LubricatedWorkspace,
}
