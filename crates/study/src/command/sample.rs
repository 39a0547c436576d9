//! The particles of a scene, without running it.

use std::path::Path;

use snowlab_study::assemble::assemble;
use snowlab_study::points;
use snowlab_study::spec::{self, SceneSpec};

use super::Exit;

/// Writes the placed particles to `output`.
pub fn sample(path: &Path, output: &Path) -> anyhow::Result<Exit> {
    let (scene, _) = spec::read::<SceneSpec>(path)?;
    match scene.dimension {
        3 => sample_in::<3>(&scene, path, output),
        _ => sample_in::<2>(&scene, path, output),
    }
}

fn sample_in<const D: usize>(scene: &SceneSpec, path: &Path, output: &Path) -> anyhow::Result<Exit> {
    let folder = path.parent().unwrap_or(Path::new("."));
    let assembly = assemble::<f64, D>(scene, folder).map_err(|error| error.within(path.display()))?;
    let positions: Vec<_> = (0..assembly.state.len()).map(|p| assembly.state.world_position(p)).collect();
    points::write(output, &positions)?;
    let made = &assembly.made;
    println!(
        "{}: {} particles, {:.2} per cell, {} voids, porosity {:.4}",
        output.display(),
        made.particles,
        made.particles_per_cell,
        made.voids,
        made.porosity
    );
    Ok(Exit::Done)
}
