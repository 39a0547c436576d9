//! Maps of how cases end.

use snowlab_study::figure::FigureError;
use snowlab_study::figure::drawing::Mark;
use snowlab_study::figure::outcomes::{Kind, OutcomePanel, Outcomes, Places, inks, outcomes};

use super::keep;

const X: [f64; 5] = [0.25, 0.5, 1.0, 2.0, 4.0];
const Y: [f64; 3] = [0.1, 1.0, 10.0];
const KINDS: [Kind<'_>; 3] = [
    Kind { words: "ok", ink: inks::SOUND },
    Kind { words: "ok, but torn", ink: inks::UNSOUND },
    Kind { words: "stopped(energy-rise)", ink: inks::STOPPED[0] },
];

fn figure<'a>(panels: &'a [OutcomePanel<'a>]) -> Outcomes<'a> {
    let (x, y) = (Places { label: "dt c / h", values: &X }, Places { label: "speed [m/s]", values: &Y });
    Outcomes { title: "", x, y, kinds: &KINDS, panels, note: "made up" }
}

/// Every cell that was run is painted in the colour of its kind, and the derived limit stands in every row that has one.
#[test]
fn every_cell_has_the_colour_of_its_end() {
    let row = vec![Some(0), Some(0), Some(1), Some(2), None];
    let (cells, limits) = (vec![row; 3], [Some(0.8), Some(0.8), None]);
    let panels: Vec<OutcomePanel> = ["cubic, FLIP", "cubic, APIC", "cubic, MLS", "quadratic, FLIP"]
        .map(|arm| OutcomePanel { arm, cells: &cells, limits: &limits })
        .to_vec();
    let drawing = outcomes(&figure(&panels)).expect("the data is sound");
    keep("outcomes", &drawing);
    let painted = |ink| {
        drawing
            .marks
            .iter()
            .filter(|mark| matches!(mark, Mark::Polygon { ink: own, .. } if *own == ink))
            .count()
    };
    // One more of each in the legend.
    let found = KINDS.map(|kind| painted(kind.ink) - 1);
    assert_eq!(found, [4 * 3 * 2, 4 * 3, 4 * 3]);
}

#[test]
fn data_that_contradicts_itself_is_an_error() {
    let (short, limits) = (vec![vec![Some(0); 4]; 3], [None; 3]);
    let panels = [OutcomePanel { arm: "short", cells: &short, limits: &limits }];
    let error = outcomes(&figure(&panels)).expect_err("four cells for five places");
    assert!(error.to_string().contains("`cells` of `short` has 4 values, 5 are needed"), "{error}");
    assert!(matches!(outcomes(&figure(&[])), Err(FigureError::Nothing { .. })));
    // A kind that is not there leaves its cell white.
    let cells = vec![vec![Some(9); 5]; 3];
    let panels = [OutcomePanel { arm: "unknown", cells: &cells, limits: &limits }];
    keep("outcomes-unknown", &outcomes(&figure(&panels)).expect("it is no error"));
}
