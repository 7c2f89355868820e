//! Tests of nuts: identities, reference cases, and campaigns with random nuts.

mod campaign;
mod identities;
mod nuts;
mod public;
mod third_contact;
mod train;
mod warm;
