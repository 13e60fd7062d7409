//! Effects that a model may lack, each a few lines of the spec language for every place where it
//! makes sense.
//!
//! | file | idea |
//! |---|---|
//! | `library.rs` | the effects that are shipped |
//! | `effect.rs` | what the file of an effect says |
//! | `site.rs` | the places in a mechanism, and the words that stand for them |
//! | `candidate.rs` | an effect at a place: names, items to add, values to look for |
//! | `drive.rs` | what inputs push along a pseudo-velocity, and the inertia there |
//! | `model.rs` | a mechanism with many candidates, derived at once; at its nominal values the mechanism itself |

mod candidate;
mod drive;
mod effect;
mod library;
mod model;
mod site;

pub(crate) use candidate::Part;
pub use candidate::{Acts, Candidate};
pub(crate) use drive::Drive;
pub use effect::{Effect, EffectError, Family};
pub use library::shipped;
pub(crate) use model::ACTING;
pub use model::{EffectModel, ModelError, candidates, with_candidates};
pub use site::{Scales, SiteKind};
