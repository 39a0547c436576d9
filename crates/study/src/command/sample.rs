//! The particles of a scene, without running it.

use std::path::Path;

use snowlab_study::assemble::{Assembly, assemble};
use snowlab_study::points;
use snowlab_study::spec::{self, SceneSpec};

use super::Exit;

/// Writes the placed particles to `output`.
pub fn sample(path: &Path, output: &Path) -> anyhow::Result<Exit> {
    let (scene, text) = spec::read::<SceneSpec>(path)?;
    let folder = path.parent().unwrap_or(Path::new("."));
    let done = match scene.dimension {
        3 => assemble::<f64, 3>(&scene, folder).map(|assembly| write(&assembly, output)),
        _ => assemble::<f64, 2>(&scene, folder).map(|assembly| write(&assembly, output)),
    };
    done.map_err(|error| error.in_text(&text).within(path.display()))?
}

fn write<const D: usize>(assembly: &Assembly<f64, D>, output: &Path) -> anyhow::Result<Exit> {
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
