//! Obstacles: contact with friction on grid nodes and on particles (S13 sections 8 and 4.1 steps 5 and 9).

use crate::error::SceneError;
use crate::geometry::{Shape, Vector, is_zero};
use crate::grid::{Grid, NodeMotion};
use crate::ledger::{StepLedger, impulse_energy};
use crate::particles::{ParticleConstants, ParticleMotion};
use crate::real::Real;
use crate::scene::Scene;

/// What happens to the velocity relative to an obstacle inside it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Contact {
    /// Free to leave; Coulomb friction while pressed on.
    Separate,
    /// The normal component vanishes, leaving included; Coulomb friction.
    Slip,
    /// The whole relative velocity vanishes.
    Sticky,
    /// A plane of symmetry on a row of nodes.
    Mirror,
}

/// An obstacle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Collider<T: Real, const D: usize> {
    /// Its solid at t = 0.
    pub shape: Shape<T, D>,
    /// What touching it does.
    pub contact: Contact,
    /// Coulomb coefficient mu >= 0.
    pub friction: T,
    /// Constant velocity [m/s].
    pub velocity: Vector<T, D>,
}

/// An axis-aligned plane of nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MirrorPlane {
    /// The axis it is normal to.
    pub axis: usize,
    /// Index of its nodes on that axis.
    pub node: i32,
    /// Whether the material lies at greater coordinates.
    pub material_above: bool,
}

impl<T: Real, const D: usize> Collider<T, D> {
    /// The obstacle's effect on a point of the material at `x` moving with `v`, at time `time` [s]: the new velocity, or
    /// `None` where there is no contact.
    #[inline]
    pub fn respond(&self, x: &Vector<T, D>, v: &Vector<T, D>, time: f64) -> Option<Vector<T, D>> {
        let place = x - self.velocity * T::of(time);
        if self.shape.is_far_from(&place) {
            return None;
        }
        let surface = self.shape.surface(&place);
        if surface.distance > T::zero() {
            return None;
        }
        let relative = v - self.velocity;
        let normal_speed = relative.dot(&surface.normal);
        let leaving = normal_speed >= T::zero();
        let answer = match self.contact {
            Contact::Sticky => Vector::zeros(),
            Contact::Separate | Contact::Mirror if leaving => return None,
            Contact::Separate | Contact::Slip | Contact::Mirror => {
                let tangential = relative - surface.normal * normal_speed;
                rub(&tangential, normal_speed, self.friction)
            }
        };
        Some(answer + self.velocity)
    }

    /// As [`Collider::respond`], without friction.
    pub(crate) fn keep_out(&self, x: &Vector<T, D>, v: &Vector<T, D>, time: f64) -> Option<Vector<T, D>> {
        Collider { friction: T::zero(), ..*self }.respond(x, v, time)
    }

    /// Whether `x` [m] lies in the obstacle or on it at time `time` [s].
    pub fn contains(&self, x: &Vector<T, D>, time: f64) -> bool {
        self.shape.surface(&(x - self.velocity * T::of(time))).distance <= T::zero()
    }

    /// The unit normal out of the obstacle at `x` [m], at time `time` [s].
    pub fn normal_at(&self, x: &Vector<T, D>, time: f64) -> Vector<T, D> {
        self.shape.surface(&(x - self.velocity * T::of(time))).normal
    }

    /// The mirror's plane on a grid of the given spacing.
    ///
    /// # Errors
    /// Where the obstacle is not a static half-space along an axis with its plane on a row of nodes.
    pub fn mirror_plane(&self, spacing: T) -> Result<MirrorPlane, SceneError> {
        let refuse = |reason: String| Err(SceneError::Mirror { reason });
        let Shape::HalfSpace { point, normal } = &self.shape else {
            return refuse("it is not a half-space".into());
        };
        if !is_zero(&self.velocity) {
            return refuse("it moves".into());
        }
        let Some(axis) = (0..D).find(|&k| normal[k].abs() == T::one()) else {
            return refuse("its normal is not along an axis".into());
        };
        let row = point[axis].as_f64() / spacing.as_f64();
        // chosen: a plane within 1e-4 of a cell of a row of nodes is meant to lie on it.
        if (row - row.round()).abs() > 1e-4 {
            return refuse(format!("its plane lies at {row} cells; move it to a whole number of them"));
        }
        Ok(MirrorPlane { axis, node: row.round() as i32, material_above: normal[axis] > T::zero() })
    }
}

/// The tangential velocity after friction: |v_t| falls by mu |v_n|, at most to zero (S13 section 8). A collider that
/// is left (v_n >= 0, contact `slip`) does not press and does not rub.
#[inline]
fn rub<T: Real, const D: usize>(tangential: &Vector<T, D>, normal_speed: T, friction: T) -> Vector<T, D> {
    let grip = -friction * normal_speed.min(T::zero());
    let speed = tangential.norm();
    if speed <= grip { Vector::zeros() } else { tangential * (T::one() - grip / speed) }
}

/// Stage 4: obstacles act on the velocity of grid nodes.
///
/// The energy booked is what the contact takes from the material: the change of the node's kinetic energy from v^n to v^{n+1}, less the
/// work of its forces. Those have changed the elastic energy through v^{n+1}, so their work is I . v^{n+1}, I = m (v* - v^n) their impulse. A
/// floor that merely bears a load then loses nothing, for v^n = v^{n+1} = 0 there; and a node that the transfer sets in motion towards the floor
/// at every step, however short, leaves no work unbooked.
pub(crate) fn collide_grid<T: Real, const D: usize>(
    scene: &Scene<T, D>,
    grid: &mut Grid<T, D>,
    time: f64,
    empty: T,
    ledger: &mut StepLedger<D>,
) {
    if scene.colliders.iter().all(|c| c.contact == Contact::Mirror) {
        return;
    }
    for index in 0..grid.node_count() {
        let mass = grid.sums[index].mass;
        if mass > empty {
            let x = grid.position(index);
            collide_node(scene, &x, mass, &mut grid.motion[index], time, ledger);
        }
    }
}

/// The velocity with which material passes a node at `x` [m] in the middle of a trapezoidal step: `middle`, the mean of those at both ends,
/// but for what would lead into an obstacle, where the impulse has come at once.
pub(crate) fn keep_middle_out<T: Real, const D: usize>(
    scene: &Scene<T, D>,
    x: &Vector<T, D>,
    middle: Vector<T, D>,
    time: f64,
) -> Vector<T, D> {
    let obstacles = scene.colliders.iter().filter(|c| c.contact != Contact::Mirror);
    obstacles.fold(middle, |v, obstacle| obstacle.keep_out(x, &v, time).unwrap_or(v))
}

/// Obstacles act on a node at `x` [m].
pub(crate) fn collide_node<T: Real, const D: usize>(
    scene: &Scene<T, D>,
    x: &Vector<T, D>,
    mass: T,
    motion: &mut NodeMotion<T, D>,
    time: f64,
    ledger: &mut StepLedger<D>,
) {
    let by_forces = motion.change;
    let mut touched = false;
    for (number, collider) in scene.colliders.iter().enumerate().filter(|(_, c)| c.contact != Contact::Mirror)
    {
        let Some(velocity) = collider.respond(x, &motion.velocity, time) else { continue };
        let change = velocity - motion.velocity;
        if is_zero(&change) {
            continue;
        }
        let momentum = change * mass;
        let mut energy = impulse_energy(&momentum, &motion.velocity, &velocity)
            - impulse_energy(&momentum, &by_forces, &by_forces);
        if !touched {
            let impulse = by_forces * mass;
            energy -= impulse_energy(&impulse, &by_forces, &Vector::zeros());
            touched = true;
        }
        ledger.push(number, &momentum, energy);
        motion.velocity = velocity;
        motion.change += change;
    }
}

/// The time a step ends [s], and its length [s].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Interval<T> {
    pub arrival: f64,
    pub dt: T,
}

/// Stage 8: obstacles act on particles: on the velocity a particle keeps and on the one that moves it. Contact is tested
/// where the particle would arrive, so that none ends a step inside a flat face that it was outside of; into a ball of radius R it may slide
/// by the sagitta (v dt)^2 / 2R.
pub(crate) fn collide_particles<T: Real, const D: usize>(
    scene: &Scene<T, D>,
    constants: &ParticleConstants<T>,
    position: &[Vector<T, D>],
    next: &mut ParticleMotion<T, D>,
    advecting: &mut [Vector<T, D>],
    interval: Interval<T>,
    ledger: &mut StepLedger<D>,
) {
    if scene.colliders.is_empty() {
        return;
    }
    for p in 0..position.len() {
        let (kept, mover) = (&mut next.velocity[p], &mut advecting[p]);
        collide_particle(scene, constants.mass[p], &position[p], kept, mover, interval, ledger);
    }
}

/// Obstacles act on a particle that was at `x` [m]: on the velocity it keeps and on the one that moves it.
pub(crate) fn collide_particle<T: Real, const D: usize>(
    scene: &Scene<T, D>,
    mass: T,
    x: &Vector<T, D>,
    kept: &mut Vector<T, D>,
    advecting: &mut Vector<T, D>,
    interval: Interval<T>,
    ledger: &mut StepLedger<D>,
) {
    let Interval { arrival, dt } = interval;
    for (number, collider) in scene.colliders.iter().enumerate() {
        let target = x + *advecting * dt;
        let place = target - collider.velocity * T::of(arrival);
        if collider.shape.is_far_from(&place) || collider.shape.surface(&place).distance > T::zero() {
            continue;
        }
        if let Some(velocity) = collider.respond(&target, kept, arrival) {
            let momentum = (velocity - *kept) * mass;
            ledger.push(number, &momentum, impulse_energy(&momentum, kept, &velocity));
            *kept = velocity;
        }
        if let Some(velocity) = collider.respond(&target, advecting, arrival) {
            *advecting = velocity;
        }
    }
}
