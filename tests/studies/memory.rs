//! What a case is said to take beside what it takes.

use std::path::Path;
use std::process::Command;

use snowlab_study::memory::{of_case, side_by_side};
use snowlab_study::spec;

fn scene(dimension: usize, count: usize, numerics: &str) -> String {
    let zeros = if dimension == 3 { ", 0.0" } else { "" };
    let (x, v) = (format!("[0.0, 0.3{zeros}]"), format!("[0.0, -8.0{zeros}]"));
    format!(
        r#"
[scene]
dimension = {dimension}
[scene.numerics]
{numerics}
[[scene.body]]
region = {{ kind = "ball", centre = {x}, radius = 0.25 }}
placement = {{ kind = "random", count = {count} }}
velocity = {v}
[scene.output]
frame_interval = 1e-4
end = 3e-4
"#
    )
}

/// Peak memory of a program that runs the one case [bytes].
fn taken(scene: &str, spacing: f64) -> f64 {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("one.toml");
    let study = format!(
        "name = \"one\"\nquestion = \"How much?\"\n[blocks]\nfirst = 1\ncount = 1\n[measure]\nlargest_spacing = {spacing}\n{scene}[[arm]]\nid = \"only\"\n"
    );
    std::fs::write(&file, study).unwrap();
    let run = |verb: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_snowlab"));
        command.args([verb, "one.toml", "--out", "out"]).current_dir(folder.path()).output().unwrap()
    };
    let output = run("run");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let timings = std::fs::read_to_string(folder.path().join("out/one/timings.csv")).unwrap();
    let mut lines = timings.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let (names, values) = (lines.next().unwrap(), lines.next().unwrap());
    let column = names.iter().position(|name| *name == "peak_memory").unwrap();
    values[column].parse().unwrap()
}

#[test]
fn a_case_takes_what_it_is_said_to_take() {
    for (dimension, count, spacing, wider, numerics) in [
        (2, 100_000, 0.0035, 1.0, "precision = \"f32\""),
        (3, 100_000, 0.017, 1.0, "precision = \"f64\"\ntransfer = \"apic\""),
        (3, 100_000, 0.017, 1.0, "precision = \"f32\"\ntransfer = \"mls\""),
        (3, 30_000, 0.026, 1.0, "precision = \"f32\"\ntransfer = \"mls\""),
        (
            3,
            100_000,
            0.017,
            1.0,
            "precision = \"f32\"\ntransfer = \"mls\"\nintegrator = { kind = \"semi-implicit\" }",
        ),
        (2, 1000, 0.02, 1.0, ""),
        // By the ruler of a grid four times as coarse.
        (2, 50_000, 0.005, 4.0, "precision = \"f32\""),
    ] {
        let text = scene(dimension, count, &format!("spacing = {spacing}\n{numerics}"));
        let scene_alone = text.replace("[scene]\n", "").replace("[[scene.", "[[").replace("[scene.", "[");
        let said =
            of_case(&spec::parse(&scene_alone).unwrap(), Path::new("."), Some(wider * spacing)).unwrap();
        let taken = taken(&text, wider * spacing);
        println!("{dimension}D, {count} particles: {:.0} MB, said {:.0}", taken / 1e6, said / 1e6);
        assert!(taken / said < 1.5 && said / taken < 1.5, "{taken:e} bytes, said {said:e}");
    }
}

#[test]
fn no_more_cases_run_at_a_time_than_memory_holds() {
    assert_eq!(side_by_side(None, 9, 7), Ok(7), "nothing is known of a file's particles");
    assert_eq!(side_by_side(Some(1e6), 3, 7), Ok(3));
    let refusal = side_by_side(Some(1e18), 9, 7).unwrap_err();
    assert!(refusal.contains("1000000000.0 GB") && refusal.contains("fewer particles"), "{refusal}");
}
