//! Pictures of one moment: all of a view, at one scale, with the floor under what lies on it.

use snowlab_study::figure::FigureError;
use snowlab_study::figure::moment::{Moment, View, bounds, moment};
use snowlab_study::figure::style::{DUST, OKABE_ITO};

use super::keep;

/// A floor from far left to far right, its top at 0.
fn floor() -> Vec<Vec<[f64; 2]>> {
    vec![vec![[-9.0, 0.0], [9.0, 0.0], [9.0, -9.0], [-9.0, -9.0]]]
}

/// A square of particles, its lower left corner at `corner`.
fn square(corner: [f64; 2]) -> Vec<[f64; 2]> {
    (0..400).map(|k| [corner[0] + 0.01 * (k % 20) as f64, corner[1] + 0.01 * (k / 20) as f64]).collect()
}

#[test]
fn a_view_holds_all_boxes_and_the_floor() {
    let boxes: Vec<_> =
        [[-0.5, 0.1], [0.3, 0.05]].iter().filter_map(|corner| bounds(&square(*corner))).collect();
    assert_eq!(boxes[0], [[-0.5, 0.1], [-0.5 + 0.01 * 19.0, 0.1 + 0.01 * 19.0]]);
    let view = View::of(&boxes, &floor(), 0.0).expect("there is something to see");
    assert!(
        view.low[0] < -0.5 && view.high[0] > 0.49 && view.low[1] < 0.0 && view.high[1] > 0.29,
        "{view:?}"
    );
    assert!(view.low[0] > -0.6 && view.high[0] < 0.6 && view.low[1] > -0.2, "the floor's ends are far away");
    let alone = View::of(&boxes, &[], 0.0).expect("there is something to see");
    assert!(alone.low[1] > view.low[1], "without a floor there is none to be shown");
    assert_eq!(View::of(&[], &floor(), 0.0), None);
    let dot = View::of(&[[[0.1, 0.2]; 2]], &[], 0.5).expect("there is something to see");
    assert!(
        (dot.high[0] - dot.low[0] - 0.5).abs() < 1e-12 && dot.low[1] < 0.2 && dot.high[1] > 0.2,
        "{dot:?}"
    );
    assert_eq!(bounds(&[]), None);
}

/// One particle far out of a thousand and more does not shrink the others.
#[test]
fn specks_do_not_widen_a_view() {
    let mut positions: Vec<[f64; 2]> = (0..10).flat_map(|_| square([0.0, 0.1])).collect();
    let before = bounds(&positions);
    positions.push([50.0, 50.0]);
    assert_eq!(bounds(&positions), before);
}

#[test]
fn particles_stand_at_their_places_in_the_order_given() {
    let (low, high) = (square([-0.5, 0.1]), square([0.3, 0.0]));
    let view = View::of(&[bounds(&low).unwrap(), bounds(&high).unwrap()], &floor(), 0.0).unwrap();
    let over: Vec<[f64; 2]> = low.iter().chain(&high).chain(&high).copied().collect();
    let inks: Vec<_> = (0..over.len()).map(|k| [OKABE_ITO[0], DUST, OKABE_ITO[3]][k / 400]).collect();
    let data =
        Moment { positions: &over, inks: &inks, spacing: 0.01, obstacles: &floor(), obstacles_behind: false };
    let drawing = moment(&data, &view, 330).expect("the data is sound");
    keep("moment", &drawing);
    let image = drawing.paint();
    assert_eq!(image.width, 330);
    let at = |x: f64, y: f64| {
        let scale = 330.0 / (view.high[0] - view.low[0]);
        let (column, row) = ((x - view.low[0]) * scale, image.height as f64 - (y - view.low[1]) * scale);
        image.pixel(column as usize, row as usize)
    };
    let near = |a: [u8; 3], b: [u8; 3]| a.iter().zip(b).all(|(a, b)| a.abs_diff(b) < 30);
    assert!(near(at(-0.4, 0.2), OKABE_ITO[0].rgb), "{:?}", at(-0.4, 0.2));
    assert!(near(at(0.4, 0.1), OKABE_ITO[3].rgb), "what comes last lies above: {:?}", at(0.4, 0.1));
    assert!(near(at(0.0, 0.2), [0xf6, 0xf7, 0xf9]), "air: {:?}", at(0.0, 0.2));
    assert!(near(at(0.0, -0.03), [0xdf, 0xe3, 0xe7]), "the floor: {:?}", at(0.0, -0.03));
}

#[test]
fn what_cannot_be_drawn_is_refused() {
    let positions = square([0.0, 0.1]);
    let inks = vec![DUST; 400];
    let view = View::of(&[bounds(&positions).unwrap()], &[], 0.0).unwrap();
    let data =
        Moment { positions: &positions, inks: &inks, spacing: 0.01, obstacles: &[], obstacles_behind: false };
    let few = Moment { inks: &inks[1..], ..data };
    assert!(matches!(
        moment(&few, &view, 330),
        Err(FigureError::LengthMismatch { expected: 400, found: 399, .. })
    ));
    let flat = Moment { spacing: 0.0, ..data };
    assert!(matches!(moment(&flat, &view, 330), Err(FigureError::NotPositive { what: "spacing", .. })));
    let nowhere = View { high: view.low, ..view };
    assert!(matches!(moment(&data, &nowhere, 330), Err(FigureError::NotPositive { .. })));
}
