//! CPUs for which the fast engine has no kernels: they run the reference engine.

use serde::{Deserialize, Serialize};

use crate::error::{Rejection, SceneError};
use crate::geometry::Vector;
use crate::ledger::StepLedger;
use crate::real::Real;
use crate::scene::Scene;
use crate::state::State;
use crate::watchdog::StoredEnergy;

/// It has not.
pub(crate) fn is_available() -> bool {
    false
}

/// It has none.
pub(crate) fn vectors() -> &'static str {
    "none"
}

/// Numbers of any kind.
pub trait HasRegisters {}
impl<T> HasRegisters for T {}

/// Nothing to save.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Saved<T, const D: usize>(std::marker::PhantomData<T>);

impl<T: Real, const D: usize> Saved<T, D> {
    pub fn len(&self) -> usize {
        0
    }
    pub fn is_consistent(&self, _scene: &Scene<T, D>) -> bool {
        false
    }
    pub fn write(&self, _scene: &Scene<T, D>, _state: &mut State<T, D>) {}
}

/// Not to be had.
#[derive(Clone, Debug)]
pub(crate) enum Fast<T: Real, const D: usize> {
    #[expect(dead_code, reason = "never made")]
    Never(std::convert::Infallible, std::marker::PhantomData<T>),
}

impl<T: Real, const D: usize> Fast<T, D> {
    pub fn new(_scene: &Scene<T, D>, _threads: usize) -> Result<Option<Self>, SceneError> {
        Ok(None)
    }
    pub fn is_loaded(&self) -> bool {
        false
    }
    pub fn unload(&mut self) {}
    pub fn load(&mut self, _scene: &Scene<T, D>, _state: &State<T, D>) {}
    pub fn write(&self, _scene: &Scene<T, D>, _state: &mut State<T, D>) {}
    pub fn fastest(&self) -> [T; 2] {
        [T::zero(); 2]
    }
    pub fn accelerate(&mut self, _of: &impl Fn(u32) -> Vector<T, D>) -> bool {
        false
    }
    pub fn save(&self) -> Saved<T, D> {
        Saved(std::marker::PhantomData)
    }
    pub fn is_about_to_sort(&self) -> bool {
        false
    }
    pub fn take_up(&mut self, _saved: Saved<T, D>) {}
    pub fn restore(&mut self, _scene: &Scene<T, D>, _saved: Saved<T, D>) {}
    pub fn stored_energy(&self, _scene: &Scene<T, D>, _origin: &Vector<f64, D>) -> StoredEnergy {
        StoredEnergy::default()
    }
    pub fn bytes(&self) -> usize {
        0
    }
    pub fn kinetic_on_grid(&mut self, _scene: &Scene<T, D>) -> f64 {
        0.0
    }
    pub fn step(
        &mut self,
        scene: &Scene<T, D>,
        _time: f64,
        _dt: f64,
        _energies: bool,
    ) -> Result<StepLedger<D>, Rejection> {
        Ok(StepLedger::new(scene.colliders.len()))
    }
}
