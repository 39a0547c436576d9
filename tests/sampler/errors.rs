//! Bad input: refused with the name, the value and the range; never a panic, never an endless loop.

use snowlab_sampler::{
    DrawnVoids, GaussianField, InclusionField, MOST_PARTICLES, Orientation, Region, Sampler, SamplerError,
    Streams, VoidField, draw_voids, place,
};
use snowlab_solver::geometry::{Matrix, Vector};

use crate::support::{ball, snowball};

const H: f64 = 0.0072;
const HOSTILE: [f64; 8] =
    [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0, 0.0, 1e-300, 1e300, f64::MIN_POSITIVE / 4.0];

fn refused(field: VoidField) -> String {
    draw_voids(&snowball::<2>(), &field, H, &Streams::new(1)).unwrap_err().to_string()
}

#[test]
fn counts_are_refused_with_their_range() {
    for count in [0, MOST_PARTICLES + 1, usize::MAX] {
        let error = place(&snowball::<2>(), &Sampler::Random, None, count, &Streams::new(1)).unwrap_err();
        assert!(matches!(error, SamplerError::CountOutOfRange { value, .. } if value == count));
        assert!(error.to_string().contains("number of particles is"), "{error}");
    }
}

#[test]
fn parameters_of_fields_are_refused_with_name_value_and_range() {
    let circles = InclusionField::circles(H);
    let inclusions = |field: InclusionField| refused(VoidField::Inclusions(field));
    for (message, parts) in [
        (inclusions(InclusionField { porosity: 0.7, ..circles }), ["porosity is 0.7", "at most 0.6"]),
        (inclusions(InclusionField { porosity: 0.0, ..circles }), ["porosity is 0;", "above 0"]),
        (
            inclusions(InclusionField { mean_radius: -0.1, ..circles }),
            ["mean radius of the voids [m] is -0.1", "above 0"],
        ),
        (
            inclusions(InclusionField { radius_spread: 2.0, ..circles }),
            ["radius spread of the voids is 2", "0 to 1"],
        ),
        (
            inclusions(InclusionField { irregularity: 0.3, ..circles }),
            ["irregularity of the voids is 0.3", "0 to 0.2"],
        ),
        (inclusions(InclusionField { aspect: 0.5, ..circles }), ["aspect of the voids is 0.5", "1 to 5"]),
        (inclusions(InclusionField { gap: -0.001, ..circles }), ["gap between voids [m] is -0.001", "0 to"]),
        (
            inclusions(InclusionField { orientation: Orientation::Aligned(f64::NAN), ..circles }),
            ["orientation of the voids [rad] is NaN", "-1e3 to 1e3"],
        ),
        (
            refused(VoidField::Gaussian(GaussianField { porosity: 0.15, correlation_length: 0.0 })),
            ["correlation length of a void field [m] is 0", "above 0"],
        ),
        (
            inclusions(InclusionField { mean_radius: 1e-5, ..circles }),
            ["mean radius of the voids [m] is 0.00001", "2 h or more"],
        ),
        (
            inclusions(InclusionField { mean_radius: 0.2, ..circles }),
            ["mean radius of the voids [m] is 0.2", "single void"],
        ),
        (
            refused(VoidField::Gaussian(GaussianField { porosity: 0.15, correlation_length: 2.0 })),
            ["correlation length of a void field [m] is 2", "longest side"],
        ),
    ] {
        assert!(parts.iter().all(|part| message.contains(part)), "{message} lacks {parts:?}");
    }
}

/// Every hostile number in every place ends in a value or an error.
#[test]
fn hostile_numbers_never_panic_or_hang() {
    let streams = Streams::new(u64::MAX);
    let small = ball::<2>(0.0, 0.05);
    let field = InclusionField::circles(0.005);
    for value in HOSTILE {
        assert!(
            place(&ball::<2>(0.0, value), &Sampler::Random, None, 10, &streams).is_err()
                || value == 1e-300
                || value > 0.0
        );
        for sampler in [Sampler::Lattice { angle: value }, Sampler::Jittered { angle: value }] {
            let placed = place(&small, &sampler, None, 10, &streams);
            assert_eq!(placed.is_ok(), value.abs() <= 1e3, "angle {value}");
        }
        let fields = [
            InclusionField { porosity: value, ..field },
            InclusionField { mean_radius: value, ..field },
            InclusionField { radius_spread: value, ..field },
            InclusionField { irregularity: value, ..field },
            InclusionField { aspect: value, ..field },
            InclusionField { gap: value, ..field },
            InclusionField { orientation: Orientation::Aligned(value), ..field },
        ];
        for inclusions in fields {
            if let Ok(voids) = draw_voids(&small, &VoidField::Inclusions(inclusions), 0.005, &streams) {
                assert!((voids.porosity / inclusions.porosity - 1.0).abs() < 0.01);
            }
        }
        assert!(draw_voids(&small, &VoidField::Inclusions(field), value, &streams).is_err(), "h {value}");
        let gaussian = GaussianField { porosity: 0.15, correlation_length: value };
        assert!(
            draw_voids(&small, &VoidField::Gaussian(gaussian), 0.01, &streams).is_err(),
            "length {value}"
        );
    }
}

#[test]
fn empty_regions_are_refused() {
    let nothing =
        Region::Difference { solid: Box::new(ball::<2>(0.0, 0.2)), removed: Box::new(ball::<2>(0.0, 0.3)) };
    let sliver = Region::Box {
        centre: Vector::<f64, 2>::zeros(),
        half_extent: Vector::<f64, 2>::new(1.0, 1e-5),
        orientation: snowlab_sampler::rotation(0.7),
    };
    for sampler in [Sampler::Random, Sampler::Lattice { angle: 0.3 }, Sampler::PoissonDisk] {
        for region in [&nothing, &sliver] {
            let error = place(region, &sampler, None, 100, &Streams::new(1)).unwrap_err();
            assert!(matches!(error, SamplerError::EmptyRegion { .. }), "{error}");
        }
    }
    let field = VoidField::Inclusions(InclusionField::circles(H));
    assert!(matches!(
        draw_voids(&nothing, &field, H, &Streams::new(1)),
        Err(SamplerError::EmptyRegion { .. })
    ));
}

/// A long thin plate is no error: all samplers fill it.
#[test]
fn thin_regions_are_filled() {
    let plate = Region::Box {
        centre: Vector::<f64, 3>::zeros(),
        half_extent: Vector::<f64, 3>::new(0.5, 0.5, 0.002),
        orientation: Matrix::<f64, 3>::identity(),
    };
    for sampler in [
        Sampler::Random,
        Sampler::Jittered { angle: 0.0 },
        Sampler::Lattice { angle: 0.4 },
        Sampler::PoissonDisk,
    ] {
        let placed = place(&plate, &sampler, None, 1_000, &Streams::new(1)).unwrap();
        assert_eq!(placed.positions.len(), 1_000);
        assert!(placed.positions.iter().all(|point| plate.contains(point)), "{sampler:?}");
    }
}

/// Voids drawn for another region leave nothing of this one.
#[test]
fn a_region_that_is_all_void_is_given_up() {
    let field = VoidField::Inclusions(InclusionField::circles(H));
    let voids: DrawnVoids<2> = draw_voids(&snowball::<2>(), &field, H, &Streams::new(1)).unwrap();
    let (centre, radius) = voids.inclusions()[0];
    let inside_a_void = Region::Ball { centre, radius: 0.3 * radius };
    for sampler in [Sampler::Random, Sampler::Jittered { angle: 0.1 }, Sampler::PoissonDisk] {
        let error = place(&inside_a_void, &sampler, Some(&voids), 50, &Streams::new(1)).unwrap_err();
        assert!(matches!(error, SamplerError::CannotPlace { placed: 0, wanted: 50, .. }), "{error}");
    }
}
