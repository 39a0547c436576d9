//! A run put away between two steps and taken up again, bit by bit.
//!
//! Between two steps a run is its state, the particles as the engine keeps them, and what the watchdog remembers. Of the fast engine's particles
//! that is all only where they are about to be sorted, which is every few steps: there, and only there, a checkpoint can be made, so that making
//! one changes nothing.

use serde::{Deserialize, Serialize};

use crate::error::SceneError;
use crate::fast;
use crate::real::Real;
use crate::scene::Scene;
use crate::simulation::Simulation;
use crate::state::State;
use crate::step::Workspace;
use crate::watchdog::Watchdog;

/// A state to go back to.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(bound = "")]
pub(crate) struct Saved<T: Real, const D: usize> {
    /// Without particles where the fast engine holds them.
    pub state: State<T, D>,
    pub particles: Option<fast::Saved<T, D>>,
}

/// A run as it was put away: what is read back of a serialised [`Simulation::checkpoint`].
#[derive(Clone, Debug, Deserialize)]
#[serde(bound = "")]
pub struct Checkpoint<T: Real, const D: usize> {
    now: Saved<T, D>,
    watchdog: Watchdog<Saved<T, D>>,
}

/// The same, borrowed, to be serialised.
#[derive(Serialize)]
#[serde(bound = "")]
struct Parts<'a, T: Real, const D: usize> {
    now: Saved<T, D>,
    watchdog: &'a Watchdog<Saved<T, D>>,
}

impl<T: Real, const D: usize> Simulation<T, D> {
    /// The run as it is now, to be serialised and read back as a [`Checkpoint`]; `None` where it cannot be put away just now, but after some
    /// more steps. Nothing of the run changes by it.
    pub fn checkpoint(&self) -> Option<impl Serialize> {
        let particles = match &self.workspace.fast {
            Some(fast) if !fast.is_about_to_sort() => return None,
            Some(fast) => Some(fast.save()),
            None => None,
        };
        Some(Parts { now: Saved { state: self.state.clone(), particles }, watchdog: &self.watchdog })
    }

    /// Goes on with a run of `scene` where it was put away, on so many threads: to the same bits as if it had never been.
    ///
    /// # Errors
    /// A checkpoint that is none of this scene, or whose numbers no run can have.
    pub fn resume(
        scene: Scene<T, D>,
        checkpoint: Checkpoint<T, D>,
        threads: usize,
    ) -> Result<Self, SceneError> {
        let Checkpoint { now, watchdog } = checkpoint;
        let whole = now.whole(&scene)?;
        if let Some(accepted) = watchdog.accepted() {
            accepted.whole(&scene)?;
        }
        let mut workspace = Workspace::with_threads(&scene, &whole, threads)?;
        match (&mut workspace.fast, now.particles) {
            (Some(fast), Some(particles)) => fast.take_up(particles),
            (None, None) => {}
            _ => return Err(SceneError::Checkpoint { reason: "it was made by the other engine" }),
        }
        Ok(Simulation::of_parts(scene, now.state, workspace, watchdog))
    }
}

impl<T: Real, const D: usize> Checkpoint<T, D> {
    /// The number of particles.
    pub fn particles(&self) -> usize {
        self.now.particles.as_ref().map_or(self.now.state.len(), fast::Saved::len)
    }
}

impl<T: Real, const D: usize> Saved<T, D> {
    /// The state with its particles.
    ///
    /// # Errors
    /// What no run of `scene` can have come to.
    fn whole(&self, scene: &Scene<T, D>) -> Result<State<T, D>, SceneError> {
        let mut state = self.state.clone();
        if let Some(particles) = &self.particles {
            if !particles.is_consistent(scene) {
                return Err(SceneError::Checkpoint { reason: "its particles do not lie as they should" });
            }
            particles.write(scene, &mut state);
        }
        state.validate(scene)?;
        if !state.is_possible(scene) {
            return Err(SceneError::Checkpoint { reason: "it has numbers that no run can have" });
        }
        Ok(state)
    }
}
