//! Obstacles as they are drawn: outlines in the plane.

use crate::spec::scene::{BallSpec, BoxSpec, ColliderSpec, SolidSpec};

/// Reach of a half-space on the paper [m] (chosen: beyond any picture).
const FAR: f64 = 1e4;
/// Corners of a circle (chosen: its sides deviate by 5e-4 of the radius).
const CORNERS: usize = 96;

/// The outline of an obstacle at `time` [s], in the world's coordinates [m].
pub fn outline(collider: &ColliderSpec, time: f64) -> Vec<[f64; 2]> {
    let moved = [0, 1].map(|k| time * collider.velocity.get(k).copied().unwrap_or(0.0));
    let at = |centre: &[f64], offset: [f64; 2]| [0, 1].map(|k| centre[k] + offset[k] + moved[k]);
    match &collider.shape {
        SolidSpec::HalfSpace { point, normal } => {
            let length = libm::hypot(normal[0], normal[1]);
            let [nx, ny] = [FAR * normal[0] / length, FAR * normal[1] / length];
            [[-ny, nx], [ny, -nx], [ny - nx, -nx - ny], [-ny - nx, nx - ny]].map(|o| at(point, o)).to_vec()
        }
        SolidSpec::Ball(BallSpec { centre, radius }) => circle(at(centre, [0.0; 2]), *radius),
        SolidSpec::Box(BoxSpec { centre, half_extent, angle }) => {
            let (sin, cos) = libm::sincos(angle.to_radians());
            let corner = |[x, y]: [f64; 2]| {
                let (x, y) = (x * half_extent[0], y * half_extent[1]);
                at(centre, [cos * x - sin * y, sin * x + cos * y])
            };
            [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(corner).to_vec()
        }
    }
}

/// A circle as a polygon [m].
pub(super) fn circle(centre: [f64; 2], radius: f64) -> Vec<[f64; 2]> {
    let corner = |k: usize| {
        let (sin, cos) = libm::sincos(k as f64 * std::f64::consts::TAU / CORNERS as f64);
        [centre[0] + radius * cos, centre[1] + radius * sin]
    };
    (0..CORNERS).map(corner).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn collider(shape: SolidSpec) -> ColliderSpec {
        let text = "shape = { kind = \"ball\", centre = [0.0, 0.0], radius = 1.0 }";
        ColliderSpec { shape, ..toml::from_str(text).expect("a collider") }
    }

    #[test]
    fn a_box_turned_by_45_degrees_stands_on_its_corner() {
        let shape =
            SolidSpec::Box(BoxSpec { centre: vec![1.0, 0.0], half_extent: vec![0.1, 0.1], angle: 45.0 });
        let corners = outline(&collider(shape), 0.0);
        let top = corners.iter().fold([0.0, 0.0_f64], |top, p| if p[1] > top[1] { *p } else { top });
        assert!((top[0] - 1.0).abs() < 1e-12 && (top[1] - 0.1 * std::f64::consts::SQRT_2).abs() < 1e-12);
    }

    #[test]
    fn a_floor_lies_under_its_surface_and_moves_with_its_velocity() {
        let shape = SolidSpec::HalfSpace { point: vec![0.0, 0.5], normal: vec![0.0, 2.0] };
        let moving = ColliderSpec { velocity: vec![0.0, 3.0], ..collider(shape) };
        let heights: Vec<f64> = outline(&moving, 2.0).iter().map(|p| p[1]).collect();
        assert_eq!(heights.iter().copied().fold(f64::MIN, f64::max), 6.5);
        assert!(heights.contains(&(6.5 - FAR)));
    }
}
