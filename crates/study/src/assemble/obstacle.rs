//! Obstacles.

use snowlab_solver::{Collider, Contact, Real, Shape, Vector};

use crate::spec::SpecError;
use crate::spec::scene::{BallSpec, BoxSpec, ColliderSpec, ContactName, SolidSpec};

use super::vector::{vector, vector_or_zero};

pub(super) fn collider<T: Real, const D: usize>(
    spec: &ColliderSpec,
    number: usize,
    origin: &Vector<f64, D>,
    spacing: f64,
) -> Result<Collider<T, D>, SpecError> {
    let key = format!("collider.{number}");
    let at = |values: &[f64], name: &str| vector::<D>(values, &format!("{key}.shape.{name}"));
    let shape = match &spec.shape {
        SolidSpec::HalfSpace { point, normal } => {
            half_space(at(point, "point")? - origin, at(normal, "normal")?, spacing)
        }
        SolidSpec::Ball(BallSpec { centre, radius }) => {
            Shape::Ball { centre: (at(centre, "centre")? - origin).map(T::of), radius: T::of(*radius) }
        }
        SolidSpec::Box(BoxSpec { centre, half_extent, angle }) => Shape::Box {
            centre: (at(centre, "centre")? - origin).map(T::of),
            half_extent: at(half_extent, "half_extent")?.map(T::of),
            orientation: snowlab_sampler::rotation::<D>(angle.to_radians()).map(T::of),
        },
    };
    let collider = Collider {
        shape,
        contact: match spec.contact {
            ContactName::Separate => Contact::Separate,
            ContactName::Slip => Contact::Slip,
            ContactName::Sticky => Contact::Sticky,
            ContactName::Mirror => Contact::Mirror,
        },
        friction: T::of(spec.friction),
        velocity: vector_or_zero::<D>(&spec.velocity, &format!("{key}.velocity"))?.map(T::of),
    };
    if collider.contact == Contact::Mirror {
        collider
            .mirror_plane(T::of(spacing))
            .map_err(|error| SpecError::value(format!("`{key}`"), error.to_string()))?;
    }
    Ok(collider)
}

/// A plane across an axis that lies on a row of nodes to within 1e-6 of a cell is put exactly where the grid puts that row,
/// so that the nodes on it are in contact whatever the rounding.
pub(super) fn half_space<T: Real, const D: usize>(
    mut point: Vector<f64, D>,
    normal: Vector<f64, D>,
    spacing: f64,
) -> Shape<T, D> {
    // Times a power of two, which leaves all bits: the squares of very small components are nothing.
    let normal = normal.map(|component| libm::scalbn(component, -libm::ilogb(normal.amax()))).normalize();
    let mut local = point.map(T::of);
    if let Some(axis) = (0..D).find(|&k| normal[k].abs() == 1.0) {
        let row = (point[axis] / spacing).round();
        if (point[axis] / spacing - row).abs() < 1e-6 && row.abs() < f64::from(i32::MAX) {
            point[axis] = row * spacing;
            local[axis] = T::of_index(row as i32) * T::of(spacing);
        }
    }
    Shape::HalfSpace { point: local, normal: normal.map(T::of) }
}
