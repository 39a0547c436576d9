//! What meets what, and how fast, told from positions and velocities at the start.

use snowlab_solver::{Collider, Scene, State, Vector};

/// What comes together within the run.
#[derive(Clone, Debug, PartialEq)]
pub struct Approach {
    /// The greatest speed at which it does [m/s]; 0 where nothing does.
    pub speed: f64,
    /// When the first of it does [s]; infinite where nothing does.
    pub time: f64,
    /// Particles that lie in an obstacle at the start, by the obstacle's number.
    pub buried: Vec<(usize, usize)>,
}

/// Each particle on its own, in free fall along the normal of each obstacle, and bodies by their means. Exact for half-spaces; an obstacle of
/// finite size is taken for the half-space that touches it at the point next to the particle, if the particle's path leads into it.
pub fn approach<const D: usize>(scene: &Scene<f64, D>, state: &State<f64, D>, duration: f64) -> Approach {
    let mut found = Approach { speed: 0.0, time: f64::INFINITY, buried: Vec::new() };
    for (number, collider) in scene.colliders.iter().enumerate() {
        let (mut buried, mut first) = (0, vec![None; scene.materials.len()]);
        for p in 0..state.len() {
            let (x, v) = (&state.motion.position[p], &state.motion.velocity[p]);
            if collider.contains(x, 0.0) {
                buried += 1;
            } else {
                sooner(
                    &mut first[usize::from(state.constants.material[p])],
                    fall(collider, x, v, &scene.gravity),
                );
            }
        }
        // What comes behind the first particle of a body is slowed by it.
        first.into_iter().for_each(|meeting| found.add(meeting, duration));
        if buried > 0 {
            found.buried.push((number, buried));
        }
    }
    let bodies = bodies(scene, state);
    for (k, one) in bodies.iter().enumerate() {
        bodies[..k].iter().for_each(|other| found.add(one.meets(other), duration));
    }
    found
}

impl Approach {
    fn add(&mut self, meeting: Option<(f64, f64)>, duration: f64) {
        if let Some((time, speed)) = meeting.filter(|(time, _)| *time <= duration) {
            self.time = self.time.min(time);
            self.speed = self.speed.max(speed);
        }
    }
}

/// Takes the earlier of two meetings, the faster of two at the same time.
fn sooner(first: &mut Option<(f64, f64)>, meeting: Option<(f64, f64)>) {
    let rank = |&(time, speed): &(f64, f64)| (time, -speed);
    if let Some(meeting) = meeting
        && first.as_ref().is_none_or(|first| rank(&meeting) < rank(first))
    {
        *first = Some(meeting);
    }
}

/// When a particle in free fall reaches the obstacle [s], and its speed against the normal then [m/s].
fn fall<const D: usize>(
    collider: &Collider<f64, D>,
    x: &Vector<f64, D>,
    v: &Vector<f64, D>,
    gravity: &Vector<f64, D>,
) -> Option<(f64, f64)> {
    let surface = collider.shape.surface(x);
    let speed = -(v - collider.velocity).dot(&surface.normal);
    let acceleration = -gravity.dot(&surface.normal);
    // distance = speed t + acceleration t^2 / 2, in the form that does not lose digits where the acceleration is small.
    let root = speed * speed + 2.0 * acceleration * surface.distance;
    if root < 0.0 || (speed <= 0.0 && acceleration <= 0.0) {
        return None;
    }
    let time = 2.0 * surface.distance / (speed + root.sqrt());
    let place = x + (v * time) + gravity * (0.5 * time * time);
    // chosen: a hundredth of the way, for the round-off of a point that lies on the surface.
    let near =
        collider.shape.surface(&(place - collider.velocity * time)).distance <= 0.01 * surface.distance;
    (time.is_finite() && near).then_some((time, root.sqrt()))
}

/// A body as a ball.
struct Body<const D: usize> {
    centre: Vector<f64, D>,
    velocity: Vector<f64, D>,
    radius: f64,
}

impl<const D: usize> Body<D> {
    /// When this ball and another touch [s], and how fast they come together [m/s].
    fn meets(&self, other: &Self) -> Option<(f64, f64)> {
        let (apart, closing) = (other.centre - self.centre, self.velocity - other.velocity);
        let reach = self.radius + other.radius;
        let (a, b) = (closing.norm_squared(), apart.dot(&closing));
        let c = apart.norm_squared() - reach * reach;
        if b <= 0.0 {
            return None;
        }
        if c <= 0.0 {
            return Some((0.0, a.sqrt()));
        }
        let root = b * b - a * c;
        (root >= 0.0).then(|| (c / (b + root.sqrt()), a.sqrt()))
    }
}

/// The bodies of a scene, each a material of its own.
fn bodies<const D: usize>(scene: &Scene<f64, D>, state: &State<f64, D>) -> Vec<Body<D>> {
    let of = |number: usize| {
        let own = || (0..state.len()).filter(move |&p| usize::from(state.constants.material[p]) == number);
        let count = own().count().max(1) as f64;
        let centre = own().map(|p| state.motion.position[p]).sum::<Vector<f64, D>>() / count;
        let velocity = own().map(|p| state.motion.velocity[p]).sum::<Vector<f64, D>>() / count;
        let radius = own().map(|p| (state.motion.position[p] - centre).norm()).fold(0.0, f64::max);
        Body { centre, velocity, radius }
    };
    (0..scene.materials.len()).map(of).collect()
}

#[cfg(test)]
mod tests {
    use snowlab_solver::{Contact, Shape};

    use super::*;

    fn floor() -> Collider<f64, 2> {
        Collider {
            shape: Shape::HalfSpace { point: Vector::zeros(), normal: Vector::from([0.0, 1.0]) },
            contact: Contact::Separate,
            friction: 0.0,
            velocity: Vector::zeros(),
        }
    }

    #[test]
    fn a_fall_takes_as_long_as_gravity_says() {
        let g = Vector::from([0.0, -9.81]);
        let (time, speed) = fall(&floor(), &Vector::from([0.0, 1.0]), &Vector::zeros(), &g).unwrap();
        assert!(
            (time - (2.0_f64 / 9.81).sqrt()).abs() < 1e-12 && (speed - (2.0_f64 * 9.81).sqrt()).abs() < 1e-12
        );
        // Thrown up first: it comes back.
        let up = fall(&floor(), &Vector::from([0.0, 1.0]), &Vector::from([0.0, 2.0]), &g).unwrap();
        let exact = (2.0 + (4.0 + 2.0 * 9.81_f64).sqrt()) / 9.81;
        assert!((up.0 - exact).abs() < 1e-12, "{} for {exact}", up.0);
        assert_eq!(
            fall(&floor(), &Vector::from([0.0, 1.0]), &Vector::from([3.0, 0.0]), &Vector::zeros()),
            None
        );
    }

    #[test]
    fn what_flies_past_does_not_meet() {
        let ball = Collider { shape: Shape::Ball { centre: Vector::zeros(), radius: 0.5 }, ..floor() };
        let from =
            |y: f64| fall(&ball, &Vector::from([-3.0, y]), &Vector::from([2.0, 0.0]), &Vector::zeros());
        assert!(
            from(0.0).is_some_and(|(time, speed)| (time - 1.25).abs() < 1e-12 && (speed - 2.0).abs() < 1e-12)
        );
        assert_eq!(from(2.0), None);
        let disc = |x: f64, v: f64| Body {
            centre: Vector::from([x, 0.0]),
            velocity: Vector::from([v, 0.0]),
            radius: 0.5,
        };
        assert_eq!(disc(0.0, 1.0).meets(&disc(3.0, -1.0)), Some((1.0, 2.0)));
        assert_eq!(disc(0.0, -1.0).meets(&disc(3.0, 1.0)), None);
    }
}
