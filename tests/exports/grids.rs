//! Densities on a grid.

use snowlab_study::export::{Density, DensityError, Snapshot};

fn particles(positions: Vec<[f64; 3]>) -> Snapshot {
    let count = positions.len();
    Snapshot {
        dimension: 3,
        spacing: Some(0.1),
        ids: (0..count as u32).collect(),
        positions,
        masses: Some((0..count).map(|p| 1.0 + p as f64).collect()),
        volumes: Some(vec![0.01; count]),
        ..Snapshot::default()
    }
}

/// Masses and first moments are kept wherever the particles lie, on block's edges and below 0 too.
#[test]
fn the_mass_and_its_middle_are_kept() {
    let snapshot = particles(vec![[0.0; 3], [0.79, 0.8, 0.81], [-0.05, -7.33, 1.6], [3.3, 0.2, -0.8]]);
    let masses = snapshot.masses.clone().unwrap();
    let total: f64 = masses.iter().sum();
    for cell in [0.1, 0.037] {
        let density = Density::of(&snapshot, Some(cell)).unwrap();
        assert!((density.unit - total / 0.04).abs() < 1e-9);
        let per_value = density.unit * cell * cell * cell;
        let sum: f64 = density.values().map(|(_, value)| value * per_value).sum();
        assert!((sum - total).abs() < 1e-12 * total, "{sum}");
        for axis in 0..3 {
            let moment: f64 =
                density.values().map(|(node, value)| f64::from(node[axis]) * cell * value * per_value).sum();
            let expected: f64 = snapshot.positions.iter().zip(&masses).map(|(x, m)| x[axis] * m).sum();
            assert!((moment - expected).abs() < 1e-12 * total, "axis {axis}: {moment} and {expected}");
        }
    }
}

#[test]
fn one_particle_on_a_node_by_hand() {
    // The cubic B-spline is 2/3 at its middle and 1/6 one node away.
    let mut snapshot = particles(vec![[0.8, 0.0, -0.1]]);
    snapshot.volumes = None;
    let density = Density::of(&snapshot, Some(0.1)).unwrap();
    let at =
        |wanted: [i32; 3]| density.values().find(|(node, _)| *node == wanted).map(|(_, value)| value * 1e-3);
    let expected = |factor: f64| factor * (2.0_f64 / 3.0).powi(2);
    assert!((at([8, 0, -1]).unwrap() - expected(2.0 / 3.0)).abs() < 1e-12);
    assert!((at([7, 0, -1]).unwrap() - expected(1.0 / 6.0)).abs() < 1e-12);
    assert!((at([8, 0, -2]).unwrap() - expected(1.0 / 6.0)).abs() < 1e-12);
    assert_eq!(density.bounds(2).unwrap(), Some([[5, -3, -4], [11, 3, 2]]));
}

#[test]
fn what_has_no_grid_is_refused() {
    let refused = |change: fn(&mut Snapshot), cell: Option<f64>| {
        let mut snapshot = particles(vec![[0.5; 3]]);
        change(&mut snapshot);
        Density::of(&snapshot, cell).unwrap_err().to_string()
    };
    assert!(refused(|s| s.dimension = 2, None).contains("three dimensions"));
    assert!(refused(|s| s.spacing = None, None).contains("--cell"));
    assert!(refused(|s| s.masses = None, None).contains("`mass`"));
    assert!(refused(|_| (), Some(0.0)).contains("side above 0"));
    assert!(refused(|_| (), Some(1e-10)).contains("1e9"));
    let far = Density::of(&particles(vec![[0.0; 3], [90.0; 3]]), None).unwrap();
    assert!(matches!(far.bounds(0), Err(DensityError::TooFine(nodes)) if nodes > 7e8));
}
