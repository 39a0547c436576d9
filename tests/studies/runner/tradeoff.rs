//! `snowlab tradeoff` and `snowlab recommend`: what settings cost and how far they are off, from the cases of a study.

use super::{Desk, rows, study};

/// Three settings of which one is the reference's own, four scenes of which one is held out, and the reference on coarser grids.
const SETTINGS: &str = r#"
[tradeoff]
axis = "scene"
held_out = [4]
[[arm]]
id = "reference"
set = { "numerics.spacing" = 0.025 }
[[arm]]
id = "near"
set = { "numerics.spacing" = 0.035 }
trade = { reference = "reference", family = "coarser", coarser = 1.4 }
[[arm]]
id = "far"
set = { "numerics.spacing" = 0.05 }
trade = { reference = "reference", family = "coarser", coarser = 2.0 }
[[arm]]
id = "close"
set = { "numerics.spacing" = 0.025, "numerics.wave_courant" = 0.2 }
trade = { reference = "reference", family = "settings" }
[[arm]]
id = "cheap"
set = { "numerics.spacing" = 0.1, "numerics.kernel" = "quadratic" }
trade = { reference = "reference", family = "settings" }
[[sweep]]
name = "scene"
path = "body.0.velocity"
values = [[0.0, -4.0], [0.0, -6.0], [0.0, -8.0], [2.0, -5.0]]
numbers = [1, 2, 3, 4]
"#;

fn desk() -> Desk {
    let text = study(SETTINGS)
        .replace("kind = \"random\"", "kind = \"lattice\"")
        .replace("count = 2\n", "count = 1\n");
    let desk = Desk::with(&[("study.toml", &text.replace("end = 1.0", "end = 0.5"))]);
    desk.expect(0, "run study.toml --jobs 2");
    desk.expect(0, "report study.toml");
    desk.expect(0, "tradeoff study.toml --rounds 1");
    desk
}

fn number(row: &std::collections::BTreeMap<String, String>, column: &str) -> f64 {
    row[column].parse().unwrap_or_else(|_| panic!("`{column}` in {row:?}"))
}

#[test]
fn settings_have_the_errors_of_their_cases() {
    let desk = desk();
    let settings = rows(&desk.read("results/tiny/settings.csv"));
    assert_eq!(settings.iter().map(|row| row["arm"].as_str()).collect::<Vec<_>>(), ["close", "cheap"]);
    let trades = rows(&desk.read("results/tiny/trade.csv"));
    let its_error = {
        let reference = rows(&desk.read("results/tiny/reference.csv"));
        assert_eq!(reference.len(), 4);
        let mut errors: Vec<f64> = reference.iter().map(|row| number(row, "error")).collect();
        errors.sort_by(f64::total_cmp);
        0.5 * (errors[1] + errors[2])
    };
    for row in &settings {
        // One block in each scene: the largest of the three is that of the means. It goes like 1 over the speed at which the ball comes down.
        let in_scene = |trade: &&std::collections::BTreeMap<String, String>| {
            let errors = ["error_u", "error_impulse", "error_kinetic"].map(|e| number(trade, e));
            let speed = [4.0, 6.0, 8.0, 5.0][number(trade, "scene") as usize - 1];
            errors.into_iter().fold(0.0, f64::max) * speed / 4.0
        };
        let own: Vec<_> = trades.iter().filter(|trade| trade["arm"] == row["arm"]).collect();
        let logs: Vec<f64> = own.iter().filter(|t| t["scene"] != "4.0").map(|t| in_scene(t).ln()).collect();
        assert_eq!(logs.len(), 3);
        let mean = logs.iter().sum::<f64>() / 3.0;
        let spread = (logs.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / 2.0).sqrt();
        // t of 2 degrees of freedom at 95 %.
        let upper = (mean + 2.919_986 * spread * (4.0_f64 / 3.0).sqrt()).exp();
        assert!((number(row, "error") / mean.exp() - 1.0).abs() < 1e-9, "{row:?}");
        assert!((number(row, "error_upper") / upper - 1.0).abs() < 1e-5, "{row:?}: {upper}");
        assert!((number(row, "error_bound") - upper - its_error).abs() < 1e-5 * upper, "{row:?}");
        let held_out = in_scene(own.iter().find(|trade| trade["scene"] == "4.0").unwrap());
        assert_eq!(number(row, "held_out_below"), f64::from(u8::from(held_out <= upper)), "{row:?}");
        let machs = ["mach", "mach_least", "mach_greatest"].map(|column| number(row, column));
        // sqrt((lambda + 2 mu) / rho) of E = 0.14 MPa, nu = 0.2, 400 kg / m^3.
        let wave_speed = (1.4e5_f64 * 0.8 / (1.2 * 0.6) / 400.0).sqrt();
        for (mach, speed) in machs.iter().zip([4.0, 4.0, 8.0]) {
            assert!((mach * wave_speed / speed - 1.0).abs() < 1e-3, "{row:?}");
        }
    }
    let [close, cheap] = &settings[..] else { panic!("{settings:?}") };
    assert!(number(close, "error") < number(cheap, "error"), "{settings:?}");
    assert!(number(close, "cells_across") == 20.0 && number(cheap, "cells_across") == 5.0, "{settings:?}");
    assert!(close["numerics"].contains("wave_courant = 0.2") && !close["numerics"].contains("spacing"));
}

#[test]
fn the_cheapest_that_is_close_enough_is_recommended() {
    let desk = desk();
    let settings = rows(&desk.read("results/tiny/settings.csv"));
    let ask = |code: i32, what: &str| {
        desk.expect(code, &format!("recommend --settings results/tiny/settings.csv {what}"))
    };
    let bounds: Vec<f64> = settings.iter().map(|row| number(row, "error_bound")).collect();
    let (close, cheap) = (bounds[0].min(bounds[1]), bounds[0].max(bounds[1]));
    assert!(ask(0, &format!("--error {}", 1.01 * cheap)).contains("nothing: it is the cheapest of all"));
    assert!(ask(0, &format!("--error {}", 1.01 * close)).contains("close: 20 cells across"));
    assert!(ask(2, &format!("--error {}", 0.9 * close)).contains("the closest, `close`, keeps it below"));
    assert!(ask(2, "--spread 0.3").contains("0 settings have been tried on fragments"));
    assert!(ask(2, "").contains("--error NUMBER, --spread NUMBER or --preset NAME"));
    assert!(ask(2, "--error 0").contains("--error: allowed: numbers above 0"));
    // In a scene of one's own, a block 0.4 m by 0.2 m in space.
    desk.write(
        "own.toml",
        "dimension = 3\n[numerics]\nspacing = 0.05\n[[body]]\nregion = { kind = \"box\", centre = [0.0, 0.0, 0.0], half_extent = [0.2, 0.1, 0.1] }\n\
         placement = { kind = \"lattice\", count = 1024 }\nvelocity = [1.0, 0.0, 0.0]\n[output]\nframe_interval = 0.01\nend = 0.01\n",
    );
    let json: serde_json::Value = serde_json::from_str(&ask(
        0,
        &format!("--error {} --scene own.toml --write made.toml --json", 1.01 * close),
    ))
    .unwrap();
    assert_eq!(json["set"]["spacing"], 0.01, "20 cells across 0.2 m");
    // 8 to a cell now; 300 on 78.5 cells in the study.
    let wanted = number(&settings[0], "particles_per_cell") * 0.016 / 1e-6;
    let count = json["set"]["count"][0].as_f64().unwrap();
    assert!((count / wanted - 1.0).abs() < 0.01, "{count} for {wanted}");
    assert!(json["seconds"].as_f64().unwrap() > 0.0);
    let made = desk.read("made.toml");
    assert!(made.contains("wave_courant = 0.2") && made.contains(&format!("count = {count}")), "{made}");
    desk.expect(0, "simulate made.toml --out frames");
    // Half as fast as the study's first scene its errors are twice as large; a preset is the same setting in every scene.
    desk.write(
        "slow.toml",
        "[numerics]\nspacing = 0.05\n[[body]]\nregion = { kind = \"ball\", centre = [0.0, 0.3], radius = 0.25 }\nplacement = { kind = \"lattice\", count = 300 }\n\
         velocity = [0.0, -2.0]\n[[collider]]\nshape = { kind = \"half-space\", point = [0.0, 0.0], normal = [0.0, 1.0] }\n[output]\nframe_interval = 0.1\nend = 0.1\n",
    );
    let told = ask(2, &format!("--error {} --scene slow.toml", 1.9 * close));
    assert!(told.contains("at an impact of Mach 0.10"), "{told}");
    let told = ask(0, &format!("--error {} --scene slow.toml --json", 2.1 * close));
    let json: serde_json::Value = serde_json::from_str(&told).unwrap();
    let of = |key: &str| json["setting"][key].as_f64().unwrap();
    assert!((of("error_bound") / 2.0 / close - 1.0).abs() < 1e-3, "{told}");
    assert!(ask(0, &format!("--error {} --scene slow.toml", 2.1 * close)).contains("that of this scene"));
    // Voids and their sizes are the scene's, and a fixed step gives way.
    desk.write(
        "voids.toml",
        "[numerics]\nspacing = 0.02\nfixed_step = 1e-6\n[[body]]\nregion = { kind = \"ball\", centre = [0.0, 0.0], radius = 0.25 }\n\
         placement = { kind = \"random\", count = 2000 }\nvoids = { kind = \"circles\" }\n[output]\nframe_interval = 0.001\nend = 0.001\n",
    );
    ask(0, &format!("--error {} --scene voids.toml --write made.toml", 1.01 * close));
    let made = desk.read("made.toml");
    assert!(made.contains("judged_at = 0.02") && !made.contains("fixed_step"), "{made}");
    // A mesh is found from wherever the scene is written to.
    desk.write("cube.obj", CUBE);
    desk.write(
        "mesh.toml",
        "dimension = 3\n[numerics]\nspacing = 0.1\n[[body]]\nregion = { kind = \"mesh\", path = \"cube.obj\", scale = 0.3 }\n\
         placement = { kind = \"lattice\", count = 216 }\n[output]\nframe_interval = 0.001\nend = 0.001\n",
    );
    std::fs::create_dir(desk.path("elsewhere")).expect("a new folder");
    ask(0, &format!("--error {} --scene mesh.toml --write elsewhere/mesh.toml", 1.01 * close));
    desk.expect(0, "preflight elsewhere/mesh.toml");
    ask(0, &format!("--error {} --scene mesh.toml --write beside.toml", 1.01 * close));
    assert!(desk.read("beside.toml").contains("path = \"cube.obj\""), "beside it the name is enough");
    desk.write("frame.csv", "x,y\n0,0\n0.1,0\n");
    desk.write(
        "file.toml",
        "[numerics]\nspacing = 0.05\n[[body]]\nplacement = { kind = \"file\", path = \"frame.csv\", filled_volume = 0.01 }\n[output]\nframe_interval = 1.0\nend = 1.0\n",
    );
    assert!(ask(2, "--error 100 --scene file.toml").contains("particles of a file stay as they are"));
}

/// A cube of side 1.
const CUBE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n\
    f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

#[test]
fn what_has_no_settings_says_so() {
    let plain = Desk::with(&[("study.toml", &study("[[arm]]\nid = \"one\"\n"))]);
    assert!(plain.expect(2, "tradeoff study.toml").contains("has no [tradeoff]"));
    let told = plain.expect(2, "recommend --error 0.1");
    assert!(
        told.contains("results/tradeoff/settings.csv") && told.contains("run `snowlab tradeoff`"),
        "{told}"
    );
}

/// An arm that is the reference again has its every fragment.
#[test]
fn arms_are_held_against_one_by_distribution() {
    let arms = "[equivalence]\nreference = \"one\"\n[[arm]]\nid = \"one\"\n[[arm]]\nid = \"again\"\n[[arm]]\nid = \"small\"\n\
        set = { \"body.0.region.radius\" = 0.2 }\n";
    let desk = Desk::with(&[("study.toml", &study(arms).replace("count = 2\n", "count = 5\n"))]);
    desk.expect(0, "run study.toml --jobs 2");
    desk.expect(0, "report study.toml");
    let found = rows(&desk.read("results/tiny/equivalence.csv"));
    let of = |arm: &str, metric: &str| {
        found.iter().find(|row| row["arm"] == arm && row["metric"] == metric).unwrap()
    };
    let again = of("again", "ln_extent");
    assert_eq!((number(again, "d"), number(again, "distance")), (0.0, 0.0), "{again:?}");
    assert_eq!(again["likeness"], "unresolved", "five balls do not show that");
    let small = of("small", "ln_extent");
    assert_eq!(small["likeness"], "different", "{small:?}");
    assert!(number(small, "d") < -0.3, "{small:?}");
    assert!(number(of("small", "density_map"), "d") > number(of("again", "density_map"), "d"));
}
