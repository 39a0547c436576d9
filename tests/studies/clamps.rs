//! Bounds on J_P: what they did is counted by event and by particle.

use std::path::Path;

use snowlab_study::record::Outcome;
use snowlab_study::run::{Unobserved, run_scene};
use snowlab_study::spec;

/// A ball of 300 particles at 8 m/s on a floor, with bounds on J_P.
fn scene(bounds: &str) -> String {
    format!(
        r#"
[numerics]
spacing = 0.05
[[body]]
region = {{ kind = "ball", centre = [0.0, 0.3], radius = 0.25 }}
placement = {{ kind = "random", count = 300 }}
velocity = [0.0, -8.0]
material = {{ kind = "snow"{bounds} }}
[[collider]]
shape = {{ kind = "half-space", point = [0.0, 0.0], normal = [0.0, 1.0] }}
[output]
time_unit = "crossing"
frame_interval = 0.5
end = 1.0
"#
    )
}

#[test]
fn a_particle_that_meets_a_bound_again_and_again_counts_once() {
    let run = |bounds: &str| {
        run_scene::<2>(&spec::parse(&scene(bounds)).unwrap(), Path::new("."), 1, &mut Unobserved).unwrap()
    };
    let bounded = run(", plastic_ratio_bounds = [0.7, inf]");
    let record = &bounded.record;
    assert_eq!(record.outcome, Outcome::OkWithClamps);
    let at_bound = bounded.frames.frames.last().unwrap().plastic_ratios.iter().filter(|&&j| j <= 0.7).count();
    assert!(record.clamped_particles >= at_bound.max(1), "{} of {at_bound}", record.clamped_particles);
    assert!(record.clamped_particles < 150, "{} of 300 particles", record.clamped_particles);
    assert!(record.clamps > 5 * record.clamped_particles as u64, "{} events", record.clamps);
    assert_eq!(record.clamp_share(), record.clamped_particles as f64 / 300.0);

    let free = run("").record;
    assert_eq!((free.outcome, free.clamps, free.clamped_particles), (Outcome::Ok, 0, 0));
}
