//! What metrics of a run are measured by: its own first frame, and the kernel of its scene.

use std::path::Path;

use snowlab_study::measure::{Metrics, measure};
use snowlab_study::run::{Unobserved, run_scene};
use snowlab_study::spec::study::MeasureSpec;
use snowlab_study::spec::{self, SceneSpec};

fn metrics(text: &str, folder: &Path) -> Metrics {
    let scene: SceneSpec = spec::parse(text).unwrap();
    let rule: MeasureSpec = toml::from_str("largest_spacing = 0.0625").unwrap();
    let run = run_scene::<2>(&scene, folder, 1, &mut Unobserved).unwrap();
    measure(&rule, &scene, &run.frames, &run.record).unwrap()
}

#[test]
fn run_out_is_measured_from_where_the_body_began() {
    let at = |x: f64| {
        let text = format!(
            r#"
[numerics]
spacing = 0.0625
[[body]]
region = {{ kind = "ball", centre = [{x:?}, 0.3], radius = 0.25 }}
placement = {{ kind = "lattice", count = 200 }}
velocity = [0.0, -8.0]
[[collider]]
shape = {{ kind = "half-space", point = [0.0, 0.0], normal = [0.0, 1.0] }}
[output]
frame_interval = 0.03
end = 0.06
"#
        );
        metrics(&text, Path::new(".")).run_out
    };
    let (here, there) = (at(0.0), at(8.0));
    assert!(here > 0.2 && here < 0.6, "{here} m");
    assert!((here - there).abs() < 1e-3, "{here} m at x = 0, {there} m at x = 8 m");
}

/// Two particles at rest, 3.39 h apart: the supports of cubic kernels have a node in common, those of quadratic ones have not.
#[test]
fn the_kernel_graph_has_the_reach_of_the_scene_s_kernel() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("two.csv"), "x,y\n0.000625,0.0\n0.2125,0.0\n").unwrap();
    let pieces = |kernel: &str| {
        let text = format!(
            r#"
[numerics]
spacing = 0.0625
kernel = "{kernel}"
[[body]]
placement = {{ kind = "file", path = "two.csv", filled_volume = 0.002 }}
[output]
frame_interval = 0.01
end = 0.01
"#
        );
        metrics(&text, folder.path()).ln_neff_kernel.exp().round()
    };
    assert_eq!((pieces("cubic"), pieces("quadratic")), (1.0, 2.0));
}
