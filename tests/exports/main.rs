//! Frames for other programs: written here, read by the readers that other people have written.
//!
//! Those are Python modules, which the test installs into a folder of the build where it can; where it cannot it says so, and with `SNOWLAB_NEEDS_READERS` set it fails.

#[path = "../desk/mod.rs"]
mod desk;
mod film;
mod grids;
mod pictures;
mod readers;
mod refusals;

/// Four pieces of different size, two of which meet a floor.
const SCENE: &str = r#"
dimension = 3
[numerics]
spacing = 0.02
[[body]]
region = { kind = "ball", centre = [0.0, 0.12, 0.0], radius = 0.1 }
placement = { kind = "random", count = 3000 }
velocity = [1.0, -8.0, 0.0]
[[body]]
region = { kind = "ball", centre = [0.3, 0.12, -0.2], radius = 0.06 }
placement = { kind = "random", count = 800 }
velocity = [2.0, -8.0, 1.0]
[[body]]
region = { kind = "box", centre = [-0.3, 0.1, 0.1], half_extent = [0.03, 0.03, 0.03] }
placement = { kind = "jittered", count = 200 }
[[body]]
region = { kind = "box", centre = [-0.3, 0.3, 0.1], half_extent = [0.03, 0.02, 0.02] }
placement = { kind = "jittered", count = 100 }
[[collider]]
shape = { kind = "half-space", point = [0.0, 0.0, 0.0], normal = [0.0, 1.0, 0.0] }
friction = 0.5
[output]
frame_interval = 0.01
end = 0.03
"#;
/// Frames of it.
const FRAMES: usize = 4;
