//! Data that is missing or contradicts itself.

use snowlab_study::figure::FigureError;
use snowlab_study::figure::axis::{Axis, Scale};
use snowlab_study::figure::curves::{self, Curve, Curves, Quantity, Spread};
use snowlab_study::figure::energy::{Energy, EnergyCase, energy};
use snowlab_study::figure::pilot::{Pilot, PilotArm, pilot};
use snowlab_study::figure::sizes::{SizeArm, sizes};
use snowlab_study::figure::snowballs::{self, Snapshot, Snowball};
use snowlab_study::figure::strips::{self, Endpoint, Strip, Strips};

use super::keep;
use super::snowballs::figure;

#[test]
fn missing_data_leave_a_note_and_contradictions_an_error() {
    let nan = [f64::NAN; 3];
    let none = Snapshot {
        positions: &[],
        fragments: &[],
        ln_plastic_volume_ratio: &[],
        count: 0,
        largest_share: f64::NAN,
        obstacles: &[],
    };
    let lost = Snapshot {
        positions: &[[f64::NAN, 1.0]],
        fragments: &[None],
        ln_plastic_volume_ratio: &[f64::NAN],
        ..none
    };
    let balls = [Snowball { arm: "empty", spacing: 0.01, before: none, after: lost }];
    keep("empty-snowballs", &snowballs::fragments(&figure(&balls)).expect("empty is no error"));
    keep("empty-volume", &snowballs::plastic_volume(&figure(&balls)).expect("empty is no error"));
    let short = Snapshot { fragments: &[], ..lost };
    let wrong = [Snowball { arm: "short", spacing: 0.01, before: short, after: none }];
    let error = snowballs::fragments(&figure(&wrong)).expect_err("one position, no label");
    assert!(error.to_string().contains("`fragments` of `short` has 0 values, 1 are needed"), "{error}");
    assert!(matches!(snowballs::fragments(&figure(&[])), Err(FigureError::Nothing { .. })));

    let strip = [Strip { values: &nan, summary: None }, Strip { values: &[1.0], summary: None }];
    let endpoint = [
        Endpoint { label: "D", scale: Scale::Linear, hold: &[], strips: &strip },
        Endpoint { label: "N", scale: Scale::Logarithmic, hold: &[], strips: &[strip[0]; 2] },
    ];
    let figure = Strips { title: "", arms: &["a", "b"], endpoints: &endpoint, note: "" };
    keep("empty-strips", &strips::strips(&figure).expect("values may be missing"));
    let three = Strips { arms: &["a", "b", "c"], ..figure };
    assert!(matches!(strips::strips(&three), Err(FigureError::LengthMismatch { .. })));

    let curve = Curve { arm: "a", x: &[0.0, 1.0, 2.0], middle: &nan, low: &nan, high: &nan };
    let one = Curve { arm: "b", x: &[1.0], middle: &[2.0], low: &[1.0], high: &[3.0] };
    for (name, lines) in [("empty-curves", vec![curve]), ("one-point", vec![one, curve])] {
        let quantity = Quantity {
            label: "y",
            scale: Scale::Logarithmic,
            hold: &[],
            level: None,
            guides: &[],
            curves: &lines,
        };
        let figure = Curves {
            title: name,
            x_label: "x",
            x_scale: Scale::Linear,
            mark: None,
            spread: Spread::Band,
            note: "",
            quantities: &[quantity],
        };
        keep(name, &curves::curves(&figure).expect("values may be missing"));
    }
    let quantity =
        Quantity { label: "y", scale: Scale::Linear, hold: &[], level: None, guides: &[], curves: &[] };
    let marked = Curves {
        title: "",
        x_label: "link / h",
        x_scale: Scale::Linear,
        mark: Some((0.4, "link used")),
        spread: Spread::Band,
        note: "",
        quantities: &[quantity],
    };
    let nothing = curves::curves(&marked).expect_err("a mark alone is no figure");
    assert!(matches!(nothing, FigureError::Nothing { what: "curve" }), "{nothing}");
    keep(
        "empty-sizes",
        &sizes("", &[SizeArm { arm: "none", cases: &[&[]] }]).expect("no fragments is no error"),
    );
    for scale in [Scale::Linear, Scale::Logarithmic] {
        let alone = Axis::around(scale, [2.0], 0.0);
        assert!(alone.low < 2.0 && alone.high > 2.0, "a value alone has room: {alone:?}");
        assert!(Axis { scale, low: 2.0, high: 2.0 }.ticks(9).is_empty(), "no length, no ticks");
    }
    let cases = [EnergyCase { arm: "a", time: &[0.0, 1.0, 2.0], parts: &[&nan] }];
    let parts =
        Energy { title: "", x_label: "t", y_label: "E", parts: &["kinetic"], cases: &cases, note: "" };
    keep("empty-energy", &energy(&parts).expect("values may be missing"));
    let arms = [PilotArm { arm: "a", damage: &[&nan] }];
    let speeds = Pilot {
        title: "",
        speeds: &[5.0],
        arms: &arms,
        target: 0.25,
        accepted: [0.05, 0.6],
        chosen: None,
        note: "",
    };
    keep("empty-pilot", &pilot(&speeds).expect("values may be missing"));
}
