//! What lies under every figure: letters, ticks, and plotters on a drawing.

use plotters::chart::ChartBuilder;
use plotters::drawing::IntoDrawingArea;
use plotters::element::{Circle, PathElement, Rectangle};
use plotters::series::LineSeries;
use plotters::style::{BLACK, Color, RED, TRANSPARENT};
use snowlab_study::figure::Drawing;
use snowlab_study::figure::axis::{Axis, Scale};
use snowlab_study::figure::drawing::Anchor;
use snowlab_study::figure::style::Ink;

#[test]
fn letters_keep_their_left_bearing() {
    // Without its bearing the j of "ij" would start left of where the i ends and touch it.
    let mut drawing = Drawing::new(200.0, 100.0);
    drawing.text("ij", [50.0, 60.0], 40.0, Ink::hex(0), Anchor::Start);
    let image = drawing.paint();
    let dark = |column: usize| (0..100).any(|row| image.pixel(column, row)[0] < 128);
    let columns: Vec<usize> = (0..200).filter(|c| dark(*c)).collect();
    let gaps = columns.windows(2).filter(|pair| pair[1] > pair[0] + 1).count();
    assert_eq!(gaps, 1, "i and j are two separate strokes: {columns:?}");
    assert!(columns[0] > 50, "the i starts after its bearing, not at the origin");
}

#[test]
fn ticks_are_round_and_inside() {
    let axis = Axis { scale: Scale::Linear, low: -0.33, high: 0.71 };
    let labels: Vec<String> = axis.ticks(6).into_iter().map(|tick| tick.label).collect();
    assert_eq!(labels, ["\u{2212}0.2", "0.0", "0.2", "0.4", "0.6"]);
    let axis = Axis { scale: Scale::Logarithmic, low: 0.5, high: 2000.0 };
    let labels: Vec<String> =
        axis.ticks(6).into_iter().map(|tick| tick.label).filter(|label| !label.is_empty()).collect();
    assert_eq!(labels, ["1", "10", "100", "1000"]);
    assert_eq!(axis.share(0.0), None, "0 has no place on a logarithmic axis");
    assert!((axis.share(2000.0).expect("its end") - 1.0).abs() < 1e-12);
}

#[test]
fn plotters_draws_on_a_drawing_without_snapping_to_pixels() {
    // The drawing claims to be finer than it is, so that a shape of plotters may end inside a pixel.
    let mut drawing = Drawing::new(20.0, 10.0);
    let area = (&mut drawing).into_drawing_area();
    let fine = (area.dim_in_pixel().0 / 20) as i32;
    assert!(fine >= 16, "{fine} steps to a pixel");
    assert_eq!(area.dim_in_pixel(), (20 * fine as u32, 10 * fine as u32));
    let rectangle = [(2 * fine, 3 * fine), (6 * fine + fine / 2, 7 * fine)];
    area.draw(&Rectangle::new(rectangle, BLACK.filled())).expect("a rectangle");
    area.draw(&Circle::new((14 * fine, 5 * fine), 3 * fine, RED.filled())).expect("a disc");
    area.draw(&PathElement::new(
        [(0, fine / 2), (20 * fine, fine / 2)],
        TRANSPARENT.stroke_width(fine as u32),
    ))
    .expect("nothing");
    drop(area);
    let image = drawing.paint();
    assert_eq!(image.pixel(5, 5), [0; 3], "inside the rectangle");
    assert_eq!(image.pixel(6, 5), [128; 3], "half a pixel at its right edge");
    assert_eq!([image.pixel(7, 5), image.pixel(5, 7), image.pixel(1, 5)], [[255; 3]; 3], "outside");
    assert_eq!(image.pixel(0, 0), [255; 3], "what is transparent leaves nothing");
    let disc: f64 = (10..20)
        .flat_map(|column| (0..10).map(move |row| (column, row)))
        .map(|(column, row)| 1.0 - f64::from(image.pixel(column, row)[1]) / 255.0)
        .sum();
    let area = 9.0 * std::f64::consts::PI;
    assert!((disc - area).abs() < 0.02 * area, "the disc covers {disc} pixels, {area} are asked");
}

#[test]
fn a_chart_of_plotters_lies_where_its_builder_says() {
    // The line from corner to corner of a plot area of 100 by 50 pixels with its lower left corner at (30, 60).
    let mut drawing = Drawing::new(140.0, 80.0);
    let area = (&mut drawing).into_drawing_area();
    let fine = area.dim_in_pixel().0 / 140;
    let x = Axis { scale: Scale::Logarithmic, low: 1.0, high: 100.0 };
    let y = Axis { scale: Scale::Linear, low: -1.0, high: 1.0 };
    let mut chart = ChartBuilder::on(&area)
        .margin_left(30 * fine)
        .margin_right(10 * fine)
        .margin_top(10 * fine)
        .margin_bottom(20 * fine)
        .build_cartesian_2d(x, y)
        .expect("a chart");
    let points = [(1.0, -1.0), (10.0, 0.0), (100.0, 1.0)];
    chart.draw_series(LineSeries::new(points, BLACK.stroke_width(2 * fine))).expect("a line");
    let middle = chart.backend_coord(&(10.0, 0.0));
    let exact = (80 * fine as i32, 35 * fine as i32);
    assert!((middle.0 - exact.0).abs() <= 1 && (middle.1 - exact.1).abs() <= 1, "{middle:?}, not {exact:?}");
    drop(chart);
    drop(area);
    let image = drawing.paint();
    let dark = |column: usize, row: usize| image.pixel(column, row)[0] < 128;
    assert!(dark(79, 35) && dark(31, 59) && dark(128, 10), "the line goes from corner to corner");
    assert!(!dark(79, 40) && !dark(20, 62) && !dark(133, 8), "and nowhere else");
}
