//! Regions: their volumes against independent counts, their boxes, their depths.

use snowlab_sampler::rng::{ChaCha8Rng, uniform_vector};
use snowlab_sampler::{Purpose, Region, SamplerError, Streams, rotation};
use snowlab_solver::geometry::{Matrix, Vector};

use crate::support::ball;

fn turned_box<const D: usize>() -> Region<D> {
    Region::Box {
        centre: Vector::<f64, D>::repeat(0.3),
        half_extent: Vector::<f64, D>::from_fn(|axis, _| 0.1 + 0.07 * axis as f64),
        orientation: rotation(0.7),
    }
}

fn turned_ellipsoid<const D: usize>() -> Region<D> {
    Region::Ellipsoid {
        centre: Vector::<f64, D>::repeat(-0.2),
        semi_axes: Vector::<f64, D>::from_fn(|axis, _| 0.3 - 0.08 * axis as f64),
        orientation: rotation(-1.1),
    }
}

fn difference<const D: usize>(solid: Region<D>, removed: Region<D>) -> Region<D> {
    Region::Difference { solid: Box::new(solid), removed: Box::new(removed) }
}

/// Volume by throwing points into a cube of side 4 about the origin, and the standard error of it.
fn thrown_volume<const D: usize>(region: &Region<D>, rng: &mut ChaCha8Rng) -> (f64, f64) {
    let throws = 400_000;
    let cube = 4.0_f64.powi(D as i32);
    let inside = (0..throws)
        .filter(|_| region.contains(&(uniform_vector::<D>(rng).add_scalar(-0.5) * 4.0)))
        .count() as f64;
    let share = inside / throws as f64;
    (share * cube, cube * (share * (1.0 - share) / throws as f64).sqrt())
}

fn volumes_agree_with_throws<const D: usize>() {
    let mut rng = Streams::new(5).stream(Purpose::Noise);
    let regions = [
        ball::<D>(0.1, 0.9),
        turned_box::<D>(),
        turned_ellipsoid::<D>(),
        Region::Union(vec![ball::<D>(-0.5, 0.7), ball::<D>(0.4, 0.6), turned_box::<D>()]),
        difference(ball::<D>(0.0, 1.0), Region::Union(vec![turned_box::<D>(), turned_ellipsoid::<D>()])),
    ];
    for region in regions {
        let volume = region.volume(region.volume_raster()).unwrap();
        let (thrown, error) = thrown_volume(&region, &mut rng);
        assert!((volume - thrown).abs() < 4.0 * error, "{region:?}: {volume}, thrown {thrown} +- {error}");
    }
}

#[test]
fn volumes_agree_with_throws_in_2d() {
    volumes_agree_with_throws::<2>();
}

#[test]
fn volumes_agree_with_throws_in_3d() {
    volumes_agree_with_throws::<3>();
}

/// A lens of two unit discs at distance 1 has area `2 pi / 3 - sqrt(3) / 2`; the union has what both have less that,
/// the difference what one has less that.
#[test]
fn union_and_difference_of_two_discs_have_the_area_of_plane_geometry() {
    let disc = std::f64::consts::PI;
    let lens = 2.0 * disc / 3.0 - 3.0_f64.sqrt() / 2.0;
    let union = Region::Union(vec![ball::<2>(0.0, 1.0), ball::<2>(1.0, 1.0)]);
    let crescent = difference(ball::<2>(0.0, 1.0), ball::<2>(1.0, 1.0));
    assert!((union.volume(0.002).unwrap() / (2.0 * disc - lens) - 1.0).abs() < 2e-4);
    assert!((crescent.volume(0.002).unwrap() / (disc - lens) - 1.0).abs() < 2e-4);
}

fn bounding_boxes_are_tight<const D: usize>() {
    let mut rng = Streams::new(6).stream(Purpose::Noise);
    for region in [ball::<D>(0.2, 0.5), turned_box::<D>(), turned_ellipsoid::<D>()] {
        let bounds = region.bounding_box();
        let (mut low, mut high) = (bounds.max, bounds.min);
        for _ in 0..400_000 {
            let point = uniform_vector::<D>(&mut rng).add_scalar(-0.5) * 2.5;
            if region.contains(&point) {
                low = low.inf(&point);
                high = high.sup(&point);
            }
        }
        let side = (bounds.max - bounds.min).min();
        assert!((low - bounds.min).min() >= 0.0 && (bounds.max - high).min() >= 0.0, "{region:?} sticks out");
        assert!(
            (low - bounds.min).max() < 0.2 * side && (bounds.max - high).max() < 0.2 * side,
            "{region:?} is loose"
        );
    }
}

#[test]
fn bounding_boxes_are_tight_in_2d() {
    bounding_boxes_are_tight::<2>();
}

#[test]
fn bounding_boxes_are_tight_in_3d() {
    bounding_boxes_are_tight::<3>();
}

/// A sphere of the radius `depth` about any inner point must lie inside, for every kind of region.
#[test]
fn depth_is_a_distance_that_stays_inside() {
    let mut rng = Streams::new(7).stream(Purpose::Noise);
    let regions = [
        ball::<3>(0.0, 0.6),
        turned_box::<3>(),
        turned_ellipsoid::<3>(),
        Region::Union(vec![ball::<3>(-0.3, 0.5), turned_ellipsoid::<3>()]),
        difference(ball::<3>(0.0, 0.7), turned_box::<3>()),
    ];
    for region in regions {
        let mut tested = 0;
        for _ in 0..20_000 {
            let point = uniform_vector::<3>(&mut rng).add_scalar(-0.5) * 1.6;
            let depth = region.depth(&point);
            if depth > 0.0 {
                tested += 1;
                let nearby = point + snowlab_sampler::rng::direction::<3>(&mut rng) * (depth * 0.999_999);
                assert!(region.contains(&nearby), "{region:?}: depth {depth} at {point}");
            }
        }
        assert!(tested > 100, "{region:?}: only {tested} points inside");
    }
    let centre = Vector::<f64, 3>::zeros();
    assert_eq!(ball::<3>(0.0, 0.6).depth(&centre), 0.6);
}

#[test]
fn bad_regions_are_named_with_their_numbers() {
    let flat = Region::Box {
        centre: Vector::<f64, 2>::zeros(),
        half_extent: Vector::<f64, 2>::new(1.0, -0.5),
        orientation: Matrix::<f64, 2>::identity(),
    };
    let message = flat.validate().unwrap_err().to_string();
    assert!(message.contains("half extent of a box") && message.contains("-0.5"), "{message}");

    let skewed = Region::Ellipsoid {
        centre: Vector::<f64, 2>::zeros(),
        semi_axes: Vector::<f64, 2>::new(1.0, 0.5),
        orientation: Matrix::<f64, 2>::new(1.0, 0.1, 0.0, 1.0),
    };
    assert!(matches!(skewed.validate(), Err(SamplerError::Orientation { shape: "ellipsoid", .. })));
    assert_eq!(Region::<2>::Union(vec![]).validate(), Err(SamplerError::EmptyUnion));
    assert!(matches!(ball::<2>(f64::NAN, 1.0).validate(), Err(SamplerError::OutOfRange { .. })));
    assert!(matches!(ball::<3>(0.0, f64::INFINITY).validate(), Err(SamplerError::OutOfRange { .. })));
    let nested = (0..40).fold(ball::<2>(0.0, 1.0), |inner, _| Region::Union(vec![inner]));
    assert!(matches!(nested.validate(), Err(SamplerError::NestedTooDeep { .. })));
    let holed = difference(ball::<2>(0.0, 1.0), ball::<2>(0.0, 0.5));
    assert!(matches!(holed.volume(1e-9), Err(SamplerError::RasterTooFine { .. })));
    assert!(matches!(holed.volume(0.0), Err(SamplerError::OutOfRange { .. })));
}
