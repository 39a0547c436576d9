//! How fragments respond to the factors of a placement: a response surface from the points of a sampled axis, and the placement that it proposes
//! for a wanted fragmentation.
//!
//! ```text
//! cases.csv + factors -> Data -> Quadratic |
//!                             -> Process   |-> the better by leave-point-out interval score -> Surface -> propose
//! ```

mod data;
mod process;
mod propose;
mod quadratic;
mod score;
mod search;
mod surface;
mod tables;
pub mod validate;

pub use data::{Data, DataError, Metric, Point, sampled_arms};
pub use process::Process;
pub use propose::{Proposal, Refusal, Wanted, band, propose};
pub use quadratic::Quadratic;
pub use score::{Skill, interval_score};
pub use surface::{Kind, LEVEL, Prediction, Surface};
pub use tables::{effects, models};
