//! Reusable buffers for solving all models.

use crate::models::ball::LubricatedWorkspace;
use crate::models::elastic::ElasticWorkspace;
use crate::models::gothic::GothicWorkspace;
use crate::models::raceway_control::RacewayWorkspace;
use crate::models::rigid::RigidWorkspace;
use crate::models::traction::TractionWorkspace;

/// Reusable buffers for solving all models. Each thread uses one workspace for all its points.
#[derive(Default)]
pub struct ModelWorkspace {
    pub(crate) rigid: RigidWorkspace,
    pub(crate) raceway: RacewayWorkspace,
    pub(crate) elastic: ElasticWorkspace,
    pub(crate) traction: TractionWorkspace,
    pub(crate) gothic: GothicWorkspace,
    pub(crate) lubricated: LubricatedWorkspace,
}
