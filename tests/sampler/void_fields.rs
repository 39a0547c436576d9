//! Void fields of circles and ellipses: porosity, sizes, gaps, one solid, and what arms share.

use snowlab_sampler::rng::{self, uniform_vector};
use snowlab_sampler::{
    DrawnVoids, InclusionField, InclusionShape, Orientation, Purpose, Region, SamplerError, Streams,
    VoidField, draw_voids,
};
use snowlab_solver::geometry::Vector;

use crate::support::{ball, snowball};

const H: f64 = 0.0072;

fn drawn<const D: usize>(field: InclusionField, h: f64, seed: u64) -> DrawnVoids<D> {
    draw_voids(&snowball::<D>(), &VoidField::Inclusions(field), h, &Streams::new(seed)).unwrap()
}

/// Coarser in 3D, to be quick: a ball of 31 cells with a few voids.
const H3: f64 = 0.016;
const FIELD3: InclusionField = InclusionField { porosity: 0.06, ..InclusionField::ellipses(H3) };

fn void_share<const D: usize>(voids: &DrawnVoids<D>, throws: usize) -> (f64, f64) {
    let region = snowball::<D>();
    let mut rng = Streams::new(77).stream(Purpose::Noise);
    let (mut inside, mut void) = (0.0, 0.0);
    for _ in 0..throws {
        let point = uniform_vector::<D>(&mut rng).add_scalar(-0.5) * 0.5;
        if region.contains(&point) {
            inside += 1.0;
            void += f64::from(voids.contains(&point));
        }
    }
    let share: f64 = void / inside;
    (share, (share * (1.0 - share) / inside).sqrt())
}

/// The porosity reported is within 1 % of the one asked for, and true: thrown points find the same share of void.
#[test]
fn porosity_is_met_and_reported_truly() {
    for porosity in [0.05, 0.2] {
        for field in [InclusionField::circles(H), InclusionField::ellipses(H)] {
            let voids = drawn::<2>(InclusionField { porosity, ..field }, H, 1);
            assert!((voids.porosity / porosity - 1.0).abs() < 0.01, "{} for {porosity}", voids.porosity);
            let (share, error) = void_share(&voids, 400_000);
            assert!(
                (share - voids.porosity).abs() < 4.0 * error,
                "{share} +- {error}, said {}",
                voids.porosity
            );
        }
    }
}

#[test]
fn porosity_is_met_and_reported_truly_in_3d() {
    for shape in [InclusionShape::Circles, InclusionShape::Ellipses] {
        let voids = drawn::<3>(InclusionField { shape, ..FIELD3 }, H3, 1);
        assert!((voids.porosity / FIELD3.porosity - 1.0).abs() < 0.01);
        let (share, error) = void_share(&voids, 400_000);
        assert!((share - voids.porosity).abs() < 4.0 * error, "{share} +- {error}, said {}", voids.porosity);
    }
}

fn arms_share_their_voids<const D: usize>(field: InclusionField, h: f64, seeds: u64) {
    for seed in 0..seeds {
        let with = |shape| drawn::<D>(InclusionField { shape, ..field }, h, seed);
        let (circles, ellipses) = (with(InclusionShape::Circles), with(InclusionShape::Ellipses));
        assert_eq!(
            circles.inclusions(),
            ellipses.inclusions(),
            "centres and equal-area radii, to the last bit"
        );
        assert_eq!((circles.draws, circles.count), (ellipses.draws, ellipses.count));
        // What the rasters see of each void's area is the same to 1 %, although the shapes differ.
        assert!((circles.mean_radius / ellipses.mean_radius - 1.0).abs() < 0.005);
        assert!(ellipses.least_width < 0.95 * circles.least_width, "stretched voids are narrower");
    }
}

#[test]
fn circles_and_ellipses_of_a_seed_share_centres_and_areas_in_2d() {
    arms_share_their_voids::<2>(InclusionField::circles(H), H, 2);
}

#[test]
fn circles_and_ellipses_of_a_seed_share_centres_and_areas_in_3d() {
    arms_share_their_voids::<3>(FIELD3, H3, 1);
}

/// A void on its own raster: equal-area radius, extent along and across the long axis, all independent of the library.
#[test]
fn every_void_has_its_area_and_its_aspect() {
    let field = InclusionField {
        irregularity: 0.0,
        orientation: Orientation::Aligned(0.5),
        ..InclusionField::ellipses(H)
    };
    let voids = drawn::<2>(field, H, 3);
    let long = Vector::<f64, 2>::new(0.5_f64.cos(), 0.5_f64.sin());
    let short = Vector::<f64, 2>::new(-long[1], long[0]);
    for (centre, radius) in voids.inclusions() {
        let (a, b) = (radius * 2.0_f64.sqrt(), radius / 2.0_f64.sqrt());
        for (direction, semi_axis) in [(long, a), (-long, a), (short, b), (-short, b)] {
            assert!(voids.contains(&(centre + direction * (semi_axis * 0.999))));
            assert!(!voids.contains(&(centre + direction * (semi_axis * 1.001))));
        }
        assert!(2.0 * radius >= 4.0 * H, "diameter {}", 2.0 * radius);
    }
    let sum: f64 = voids.inclusions().iter().map(|(_, radius)| radius * radius).sum();
    assert!((sum / (0.15 * 0.25 * 0.25) - 1.0).abs() < 1e-12, "areas add up to the porosity exactly");
}

/// The outline of a void is star-shaped; its radius over many directions has the area and the irregularity asked for.
#[test]
fn outlines_are_irregular_at_constant_area() {
    let mut squares = Vec::new();
    for seed in 0..2 {
        let voids = drawn::<2>(InclusionField::circles(H), H, seed);
        for (centre, radius) in voids.inclusions() {
            let radii: Vec<f64> = (0..360)
                .map(|degree| {
                    let angle = f64::from(degree).to_radians();
                    let direction = Vector::<f64, 2>::new(angle.cos(), angle.sin());
                    let (mut low, mut high) = (0.0, 2.0 * radius);
                    for _ in 0..30 {
                        let middle = 0.5 * (low + high);
                        if voids.contains(&(centre + direction * middle)) {
                            low = middle
                        } else {
                            high = middle
                        }
                    }
                    low / radius
                })
                .collect();
            let area = radii.iter().map(|rho| rho * rho).sum::<f64>() / 360.0;
            assert!((area - 1.0).abs() < 1e-4, "area {area}");
            squares.push(radii.iter().map(|rho| (rho - 1.0).powi(2)).sum::<f64>() / 360.0);
        }
    }
    let irregularity = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    // The share of the waves that is constant over an outline goes into its area, hence a little below 0.1.
    assert!(
        (0.08..0.105).contains(&irregularity),
        "irregularity {irregularity} over {} voids",
        squares.len()
    );
}

/// Probes on circles of radius `gap / 2` about random points: where two voids, or a void and the outside, are nearer
/// than the gap, some point of the solid between them has both within half a gap.
#[test]
fn voids_keep_their_gap() {
    for shape in [InclusionShape::Circles, InclusionShape::Ellipses] {
        let voids = drawn::<2>(InclusionField { shape, ..InclusionField::circles(H) }, H, 5);
        let inclusions = voids.inclusions();
        let owner = |point: &Vector<f64, 2>| {
            if point.norm() > 0.25 {
                return Some(usize::MAX);
            }
            // Voids are star-shaped: the way to a void's own centre stays inside it.
            let leads_home = |centre: &Vector<f64, 2>| {
                (0..=40).all(|step| voids.contains(&(point + (centre - point) * (f64::from(step) / 40.0))))
            };
            inclusions.iter().position(|(centre, _)| leads_home(centre))
        };
        let mut rng = Streams::new(6).stream(Purpose::Noise);
        for _ in 0..15_000 {
            let centre = uniform_vector::<2>(&mut rng).add_scalar(-0.5) * 0.5;
            if owner(&centre).is_some() {
                continue;
            }
            // 0.95 allows for outlines being compared at points.
            let mut owners: Vec<usize> = (0..24)
                .filter_map(|step| {
                    let angle = std::f64::consts::TAU * f64::from(step) / 24.0;
                    owner(&(centre + Vector::<f64, 2>::new(angle.cos(), angle.sin()) * (0.95 * H)))
                })
                .collect();
            owners.sort_unstable();
            owners.dedup();
            assert!(owners.len() <= 1, "{shape:?}: {owners:?} about {centre}");
        }
    }
}

/// Flood fill over a raster of its own, h/5, with the discs that fit into the solid; their radius is 0.8 h, so that the
/// centre line of a neck 2 h wide is a path of cells.
#[test]
fn the_solid_stays_in_one_piece_when_opened() {
    for seed in 0..2 {
        let voids = drawn::<2>(InclusionField { porosity: 0.2, ..InclusionField::ellipses(H) }, H, seed);
        let (cell, side) = (H / 5.0, 360_i32);
        let at = |i: i32, j: i32| Vector::<f64, 2>::new(f64::from(i - 180) * cell, f64::from(j - 180) * cell);
        let rim: Vec<Vector<f64, 2>> = (0..32)
            .map(|step| std::f64::consts::TAU * f64::from(step) / 32.0)
            .map(|angle| Vector::<f64, 2>::new(angle.cos(), angle.sin()) * (0.8 * H))
            .collect();
        let fits = |i: i32, j: i32| {
            rim.iter().all(|offset| {
                let point = at(i, j) + offset;
                point.norm() <= 0.25 && !voids.contains(&point)
            }) && !voids.contains(&at(i, j))
        };
        let mut open: Vec<bool> = (0..side * side).map(|flat| fits(flat % side, flat / side)).collect();
        let mut pieces = 0;
        while let Some(start) = open.iter().position(|&open| open) {
            pieces += 1;
            open[start] = false;
            let mut stack = vec![start as i32];
            while let Some(flat) = stack.pop() {
                for step in [-1, 1, -side, side] {
                    let next = (flat + step) as usize;
                    if open[next] {
                        open[next] = false;
                        stack.push(next as i32);
                    }
                }
            }
        }
        assert_eq!(pieces, 1, "seed {seed}");
    }
}

#[test]
fn reported_measures_agree_with_the_voids() {
    let voids = drawn::<2>(InclusionField::circles(H), H, 9);
    let inclusions = voids.inclusions();
    let radii: Vec<f64> = inclusions.iter().map(|(_, radius)| *radius).collect();
    let mean = radii.iter().sum::<f64>() / radii.len() as f64;
    let least = radii.iter().copied().fold(f64::INFINITY, f64::min);
    assert_eq!(voids.count, inclusions.len());
    assert!((voids.mean_radius / mean - 1.0).abs() < 0.005, "{} {mean}", voids.mean_radius);
    assert!((voids.least_diameter / (2.0 * least) - 1.0).abs() < 0.02, "{} {least}", voids.least_diameter);
    assert!(voids.least_width < voids.least_diameter && voids.least_width > 0.6 * voids.least_diameter);
    let rejected = voids.rejections;
    let sum = rejected.crowded + rejected.small_void + rejected.broken_solid + rejected.porosity;
    assert_eq!(voids.draws, 1 + sum);
}

/// Sizes spread as asked for about the mean asked for.
#[test]
fn sizes_follow_their_distribution() {
    let radii: Vec<f64> = (0..6)
        .flat_map(|seed| drawn::<2>(InclusionField::circles(H), H, seed).inclusions())
        .map(|(_, radius)| radius / H)
        .collect();
    let mean = radii.iter().sum::<f64>() / radii.len() as f64;
    let spread =
        (radii.iter().map(|radius| (radius - mean).powi(2)).sum::<f64>() / radii.len() as f64).sqrt() / mean;
    // About 120 radii: standard errors of 0.055 and 0.013.
    assert!((mean - 3.0).abs() < 0.2, "mean {mean}");
    assert!((spread - 0.2).abs() < 0.05, "spread {spread}");
}

#[test]
fn the_seed_alone_decides_and_a_shift_moves_the_field() {
    let field = VoidField::Inclusions(InclusionField::ellipses(H));
    let at = |x, seed| draw_voids(&ball::<2>(x, 0.25), &field, H, &Streams::new(seed)).unwrap();
    let (here, there) = (at(0.0, 1), at(0.0051, 1));
    assert_eq!(here, at(0.0, 1));
    assert_ne!(here.inclusions(), at(0.0, 2).inclusions());
    let shift = Vector::<f64, 2>::new(0.0051, 0.0);
    for ((a, _), (b, _)) in here.inclusions().iter().zip(there.inclusions()) {
        assert!((a + shift - b).norm() < 1e-12);
    }
    let mut rng = Streams::new(1).stream(Purpose::Noise);
    for _ in 0..20_000 {
        let point = rng::uniform_vector::<2>(&mut rng).add_scalar(-0.5) * 0.5;
        assert_eq!(here.contains(&point), there.contains(&(point + shift)));
    }
}

/// These numbers pin the stream and the drawing of a field: if they change, every arm with voids changes.
#[test]
fn the_first_void_is_pinned() {
    let (centre, radius) = drawn::<2>(InclusionField::ellipses(H), H, 1).inclusions()[0];
    let pinned = [-0.13737052673345146, -0.09573172204233676, 0.02767477114411504];
    let found = [centre[0], centre[1], radius];
    assert!(found.iter().zip(pinned).all(|(found, pinned)| (found - pinned).abs() < 1e-15), "{found:?}");
}

/// A body of two parts keeps both: they count as one solid each.
#[test]
fn bodies_of_two_parts_may_have_voids() {
    let part = |x| Region::Ball { centre: Vector::<f64, 2>::new(x, 0.0), radius: 0.15 };
    let region = Region::Union(vec![part(-0.3), part(0.3)]);
    let field = InclusionField { porosity: 0.1, ..InclusionField::circles(H) };
    let voids = draw_voids(&region, &VoidField::Inclusions(field), H, &Streams::new(1)).unwrap();
    assert!((voids.porosity / 0.1 - 1.0).abs() < 0.01);
    assert!(voids.inclusions().iter().any(|(centre, _)| centre[0] < 0.0));
    assert!(voids.inclusions().iter().any(|(centre, _)| centre[0] > 0.0));
}

#[test]
fn a_field_without_room_says_why() {
    let field = InclusionField { porosity: 0.6, ..InclusionField::circles(H) };
    let error = draw_voids(&snowball::<2>(), &VoidField::Inclusions(field), H, &Streams::new(1)).unwrap_err();
    let message = error.to_string();
    let SamplerError::FieldRejected { draws, rejections, .. } = error else { panic!("{message}") };
    assert_eq!((draws, rejections.crowded), (100, 100));
    assert!(message.contains("porosity 0.6") && message.contains("100 had no room"), "{message}");
}

/// The porosity takes one void of radius 1.9 h: 3.8 h wide, it is refused on the field in all 1000 draws.
#[test]
fn voids_the_grid_cannot_see_are_refused() {
    let region = Region::Ball { centre: Vector::<f64, 2>::zeros(), radius: 12.0 * H };
    let field = InclusionField {
        mean_radius: 2.0 * H,
        radius_spread: 0.0,
        porosity: (1.9_f64 / 12.0).powi(2),
        ..InclusionField::circles(H)
    };
    let error = draw_voids(&region, &VoidField::Inclusions(field), H, &Streams::new(1)).unwrap_err();
    let SamplerError::FieldRejected { draws, rejections, .. } = error else { panic!("{error}") };
    assert_eq!((draws, rejections.small_void), (1000, 1000));
}
