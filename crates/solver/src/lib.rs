//! Snow by the material point method (Stomakhin et al. 2013, "S13"; Park & Shen 2017, "PS17").
//!
//! The crate knows no file format (a run can be serialised: [`Checkpoint`]), no clock, no random number and no study: it takes a [`Scene`] (what does not
//! change in a run) and a [`State`] (what does), and advances the state. One source serves 2D and 3D (`D`), `f32` and `f64`
//! (`T`). Read [`step::step`] first.

pub mod checkpoint;
pub mod collision;
mod deformation;
pub mod diagnostics;
pub mod error;
#[cfg(target_arch = "x86_64")]
mod fast;
#[cfg(not(target_arch = "x86_64"))]
#[path = "fast/absent.rs"]
mod fast;
pub mod geometry;
pub mod grid;
pub mod implicit;
pub mod kernel;
pub mod ledger;
pub mod material;
pub mod math;
mod mirror;
mod momentum;
pub mod particles;
pub mod real;
pub mod scene;
pub mod simulation;
mod sort;
pub mod state;
pub mod stencil;
pub mod step;
pub mod timestep;
mod transfer;
mod watchdog;

pub use checkpoint::Checkpoint;
pub use collision::{Collider, Contact};
pub use error::{SceneError, SimulationError};
pub use geometry::{Matrix, Shape, Vector};
pub use implicit::krylov::Method;
pub use kernel::KernelKind;
pub use material::{Elastic, Lame, Material, Snow};
pub use real::Real;
pub use scene::{
    Advection, Engine, FlipShare, Integrator, LinearSolve, Scene, StepLength, TimeStepControl, Transfer,
};
pub use simulation::Simulation;
pub use state::{InitialParticle, State};
