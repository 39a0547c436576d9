//! Particles in space in the light of one lamp, so that their surface is seen.

use std::collections::HashMap;

use snowlab_solver::Vector;

use crate::figure::style::Ink;

use super::Viewpoint;

type Point = Vector<f64, 3>;

/// Direction to the lamp: to the right, upright, towards who looks (chosen: from the upper left, before what is seen, as pictures by Mitsuba have it).
const LAMP: [f64; 3] = [-1.8, 2.6, 2.2];
/// Light on what is turned away from the lamp over that on what is turned to it (chosen: colours of fragments are still told apart).
const SHADOW: f64 = 0.35;
/// Lightness of what is furthest from the eye over that of what is nearest (chosen: depth is seen).
const FAR: f64 = 0.7;
/// Side of the cells by which the surface is found over the spacing (chosen: 27 of them tell its direction, and cracks a few particles wide are seen).
const CELL: f64 = 2.4;
/// Light is told apart in so many steps (chosen: none is seen, and moving pictures have few colours).
const STEPS: f64 = 16.0;

/// The light that falls on each particle, from 0 to 1: by half the cosine of the angle to the lamp and a half, on a surface that turns away from the middle of
/// what is around, and less of it far from the eye. `positions` [m], `spacing` of them at rest [m].
pub(super) fn lights(positions: &[[f64; 3]], spacing: f64, view: &Viewpoint) -> Vec<f64> {
    let side = CELL * spacing;
    let cell = |x: &Point| x.map(|value| libm::floor(value / side) as i64);
    let mut cells: HashMap<Vector<i64, 3>, (f64, Point)> = HashMap::new();
    let offsets: Vec<Point> = positions.iter().map(|x| Point::from(*x) - view.centre).collect();
    for x in &offsets {
        let (count, sum) = cells.entry(cell(x)).or_insert((0.0, Point::zeros()));
        *count += 1.0;
        *sum += x;
    }
    let lamp = Point::from(LAMP).normalize();
    let light = |x: &Point| {
        let (mut count, mut sum) = (0.0, Point::zeros());
        for number in 0..27 {
            let beside = Vector::<i64, 3>::new(number % 3 - 1, number / 3 % 3 - 1, number / 9 - 1);
            if let Some((particles, positions)) = cells.get(&(cell(x) + beside)) {
                count += particles;
                sum += positions;
            }
        }
        let outward = view.seen(&(x - sum / count));
        // Inside there is no surface: what is around is even, and the direction is chance; it has half of the light.
        let turned = 0.5 + 0.5 * outward.dot(&lamp) / outward.norm().max(0.5 * side);
        let near = (0.5 + 0.5 * view.seen(x).z / view.radius()).clamp(0.0, 1.0);
        let light = (SHADOW + (1.0 - SHADOW) * turned) * (FAR + (1.0 - FAR) * near);
        (STEPS * light).round() / STEPS
    };
    offsets.iter().map(light).collect()
}

/// A colour in so much light.
pub(super) fn lit(ink: Ink, light: f64) -> Ink {
    Ink { rgb: ink.rgb.map(|channel| (f64::from(channel) * light).round() as u8), ..ink }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ball of particles: lit where it is turned to the lamp, dark on the other side; the darkest of all is far and turned away.
    #[test]
    fn a_ball_is_bright_towards_the_lamp() {
        let cube =
            (0..17 * 17 * 17).map(|k| [k % 17, k / 17 % 17, k / 289].map(|n| f64::from(n) / 8.0 - 1.0));
        let ball: Vec<[f64; 3]> = cube.filter(|x| Point::from(*x).norm() <= 1.0).collect();
        let view = Viewpoint::of(None, &[&ball]);
        let lights = lights(&ball, 0.125, &view);
        let lamp = Point::from(LAMP).normalize();
        let towards = |p: usize| view.seen(&Point::from(ball[p])).dot(&lamp);
        let ends = (0..ball.len()).fold((0, 0), |(dark, bright), p| {
            (
                if towards(p) < towards(dark) { p } else { dark },
                if towards(p) > towards(bright) { p } else { bright },
            )
        });
        assert!(lights[ends.1] > 0.85 && lights[ends.0] < 0.35, "{} {}", lights[ends.1], lights[ends.0]);
        assert!(lights.iter().all(|light| (0.0..=1.0).contains(light)));
        assert_eq!(lit(Ink::hex(0xc86400), 0.5).rgb, [100, 50, 0]);
    }
}
