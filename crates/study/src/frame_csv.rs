//! A frame as CSV in full precision: id, position [m], velocity [m/s], mass [kg or kg/m], volume at rest [m^3 or m^2], J_P, and the elastic
//! deformation gradient row by row.

use std::fmt::Write;

use snowlab_solver::{Real, State};

/// Particles in the order of their ids; digits that read back to the same numbers.
pub fn frame_csv<T: Real, const D: usize>(state: &State<T, D>) -> String {
    let axes = &["x", "y", "z"][..D];
    let mut text = String::from("id");
    axes.iter().for_each(|axis| text.push_str(&format!(",{axis}")));
    axes.iter().for_each(|axis| text.push_str(&format!(",v{axis}")));
    text.push_str(",mass,volume,jp");
    for i in axes {
        for j in axes {
            text.push_str(&format!(",f{i}{j}"));
        }
    }
    text.push('\n');
    for p in state.by_id() {
        let (motion, constants) = (&state.motion, &state.constants);
        text.push_str(&constants.id[p].to_string());
        let position = state.world_position(p);
        let scalars = [constants.mass[p], constants.volume[p], motion.plastic_ratio[p]].map(Real::as_f64);
        let deformation = motion.deformation[p].transpose();
        let numbers = position
            .iter()
            .copied()
            .chain(motion.velocity[p].iter().map(|v| v.as_f64()))
            .chain(scalars)
            .chain(deformation.iter().map(|f| f.as_f64()));
        numbers.for_each(|number| write!(text, ",{number:?}").expect("a string takes all"));
        text.push('\n');
    }
    text
}
