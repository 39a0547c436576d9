//! `snowlab design`: what a response surface learns, proposes, refuses, and how it is held against what comes out.

use snowlab_study::response::{Data, Kind, Metric, Refusal, Surface, Wanted, band, propose};
use snowlab_study::spec;
use snowlab_study::spec::study::StudySpec;
use snowlab_study::sweep::Study;
use snowlab_study::template::Record;

use super::{Desk, rows};

const SAMPLED: &str = r#"
[[arm]]
id = "solid"
[[sweep]]
name = "point"
[sweep.sample]
points = 40
[[sweep.sample.factor]]
name = "speed"
path = "body.0.velocity"
range = [2.0, 12.0]
scale = "logarithmic"
along = [0.0, -1.0]
[[sweep.sample.factor]]
name = "xi"
path = "body.0.material.hardening"
range = [5.0, 15.0]
[[sweep.sample.factor]]
name = "scale"
path = "body.0.stiffness_scale"
range = [0.5, 2.0]
scale = "logarithmic"
"#;

/// The usual study, whose ball names its material.
fn study(rest: &str) -> String {
    super::study(rest).replace("[[scene.body]]\n", "[[scene.body]]\nmaterial = { kind = \"snow\" }\n")
}

/// Rows of `cases.csv` whose response is `truth` of the shares of the factors' ranges, plus noise of a known spread.
fn table(spec: &StudySpec, noise: f64, truth: impl Fn(&[f64]) -> f64) -> Vec<Record> {
    let study = Study::expand(spec.clone(), None).unwrap();
    let sample = spec.sweep[0].sample.as_ref().unwrap();
    let row = |(k, case): (usize, &snowlab_study::sweep::Case)| -> Record {
        let at: Vec<f64> = sample.factor.iter().map(|f| f.share(case.number(&f.name).unwrap())).collect();
        // Uniform noise of the standard deviation asked for, from the golden ratio's multiples.
        let uniform = (k as f64 * 0.618_033_988_749_895).fract() - 0.5;
        let value = truth(&at) + noise * 12.0_f64.sqrt() * uniform;
        let mut row: Record =
            case.point().map(|(name, number)| (name.to_string(), format!("{number}"))).collect();
        row.extend(
            [("arm", "solid".to_string()), ("outcome", "ok".into()), ("ln_neff", format!("{value}"))]
                .map(|(a, b)| (a.to_string(), b)),
        );
        row
    };
    study.cases.iter().enumerate().map(row).collect()
}

fn surface(noise: f64, truth: impl Fn(&[f64]) -> f64) -> Surface {
    let spec: StudySpec = spec::parse(&study(SAMPLED)).unwrap();
    let rows = table(&spec, noise, truth);
    Surface::fit(Data::of(&spec, "solid", Metric::EffectiveNumber, &rows).unwrap()).unwrap()
}

fn bowl(at: &[f64]) -> f64 {
    1.0 + 0.8 * at[0] - 0.5 * at[1] * at[0] + 0.4 * (at[2] - 0.3).powi(2)
}

#[test]
fn a_quadratic_response_is_learnt_as_one() {
    let surface = surface(0.05, bowl);
    assert_eq!(surface.kind, Kind::Quadratic);
    for at in [[0.2, 0.3, 0.9], [0.5, 0.5, 0.5], [0.8, 0.1, 0.4]] {
        let prediction = surface.predict(&at);
        assert!((prediction.mean - bowl(&at)).abs() < 0.05, "{at:?}: {prediction:?}");
        assert!((0.04..0.08).contains(&prediction.deviation), "{prediction:?}");
    }
    let [quadratic, _, none] = surface.skills;
    assert!((0.65..0.95).contains(&quadratic.coverage), "{quadratic:?}");
    assert!(quadratic.score < 0.5 * none.score && quadratic.explained > 0.9, "{:?}", surface.skills);
}

/// A step that no quadratic follows.
#[test]
fn a_response_of_another_shape_is_learnt_by_the_process() {
    let step = |at: &[f64]| libm::tanh(8.0 * (at[0] - 0.5));
    let surface = surface(0.02, step);
    assert_eq!(surface.kind, Kind::Process, "{:?}", surface.skills);
    for share in [0.1, 0.3, 0.5, 0.7, 0.9] {
        let mean = surface.predict(&[share, 0.5, 0.5]).mean;
        assert!((mean - step(&[share])).abs() < 0.25, "{share}: {mean}");
    }
}

/// Where factors do nothing, none is seen to do something.
#[test]
fn noise_teaches_nothing() {
    let surface = surface(0.3, |_| 1.0);
    let [quadratic, process, none] = surface.skills;
    assert!(quadratic.explained < 0.2 && process.explained < 0.2, "{:?}", surface.skills);
    assert!(process.score < 1.15 * none.score, "{:?}", surface.skills);
}

#[test]
fn a_proposal_is_where_the_wanted_response_is() {
    let surface = surface(0.05, bowl);
    let band = band(&surface, &Default::default()).unwrap();
    let middle = 0.5 * (band.lower + band.upper);
    let given = [("xi".to_string(), 7.0)].into();
    let proposal = propose(&surface, &Wanted { response: middle, given }).unwrap();
    let factors = &surface.data.factors;
    let at: Vec<f64> = factors.iter().zip(&proposal.numbers).map(|(f, n)| f.share(*n)).collect();
    assert_eq!(proposal.numbers[1], 7.0);
    assert!((bowl(&at) - middle).abs() < 0.08, "{} for {middle}", bowl(&at));
    assert!(proposal.interval.contains(middle));
    let far = Wanted { response: band.upper + 1.0, ..Wanted::default() };
    assert!(matches!(propose(&surface, &far), Err(Refusal::OutOfReach { .. })));
    let named =
        |name: &str, number: f64| Wanted { response: middle, given: [(name.to_string(), number)].into() };
    let told = |wanted: Wanted| propose(&surface, &wanted).unwrap_err().to_string();
    assert_eq!(told(named("angle", 1.0)), "`angle` is no factor of the arm; it has: speed, xi, scale");
    assert!(told(named("speed", 20.0)).contains("`speed` is 20; allowed: 2 to 12"));
}

/// A ball beside the other, whose size alone says what N_eff is.
const SECOND_BALL: &str = r#"
[[scene.body]]
region = { kind = "ball", centre = [0.8, 0.3], radius = 0.1 }
placement = { kind = "random", count = 100 }
velocity = [0.0, -8.0]
"#;

/// From a study to a scene that runs, and from targets to a score, by the command alone.
#[test]
fn from_a_study_to_a_scene_and_a_score() {
    let scale =
        "name = \"scale\"\npath = \"body.0.stiffness_scale\"\nrange = [0.5, 2.0]\nscale = \"logarithmic\"\n";
    let size = "name = \"size\"\npath = \"body.1.region.radius\"\nrange = [0.1, 0.2]\n";
    let text = study(&SAMPLED.replace("points = 40", "points = 18").replace(scale, size))
        .replace("[[scene.collider]]", &format!("{SECOND_BALL}[[scene.collider]]"))
        .replace("min_mass_share = 0.01", "min_mass_share = 0.01\nbodies = 2");
    let desk = Desk::with(&[("study.toml", &text)]);
    let told = desk.expect(2, "design study.toml --neff 2 --speed 8");
    assert!(told.contains("cases.csv") && told.contains("run the study"), "{told}");
    desk.expect(0, "run study.toml --jobs 2");
    desk.expect(0, "report study.toml");
    let models = rows(&desk.read("results/tiny/response_models.csv"));
    assert!(models.iter().any(|row| row["response"] == "D" && row["chosen"] == "yes"), "{models:?}");
    let told = desk.expect(2, "design study.toml --neff 1000");
    assert!(told.contains("out of reach") && told.contains("5 to 95 %"), "{told}");
    assert!(desk.expect(2, "design study.toml").contains("--neff NUMBER"), "what is wanted is asked for");
    // The last line is "  solid  LOWER to UPPER".
    let words: Vec<&str> = told.lines().last().unwrap().split_whitespace().collect();
    let [_, lower, "to", upper] = words[..] else { panic!("{told}") };
    let [lower, upper] = [lower, upper].map(|number| number.parse::<f64>().unwrap());
    let wanted = (lower * upper).sqrt();
    let json: serde_json::Value = serde_json::from_str(
        &desk.expect(0, &format!("design study.toml --neff {wanted} --scene proposed.toml --json")),
    )
    .unwrap();
    assert_eq!(json["arm"], "solid");
    desk.expect(0, "simulate proposed.toml --out frames");
    // Two balls that stay whole have N_eff = (a + b)^2 / (a^2 + b^2) of areas a and b.
    let area = |radius: f64| radius * radius;
    let (one, two) = (area(0.25), area(json["factors"]["size"].as_f64().unwrap()));
    let found = (one + two).powi(2) / (one * one + two * two);
    assert!((found / wanted - 1.0).abs() < 0.01, "{found} for {wanted}");
    assert!(
        desk.read("proposed.toml").contains(&format!("radius = {}", json["factors"]["size"])),
        "it is set"
    );
    assert!(
        desk.expect(0, "design study.toml --validation targets.toml --targets 3")
            .contains("3 targets, 8 balls")
    );
    desk.expect(0, "run targets.toml --jobs 2");
    desk.expect(0, "report targets.toml");
    let told = desk.expect(0, "design study.toml --score targets.toml");
    assert!(told.contains("of 24 balls in the 80 % interval"), "{told}");
    let validation = rows(&desk.read("results/tiny-validation/validation.csv"));
    let inside: u32 = validation.iter().map(|row| row["inside"].parse::<u32>().unwrap()).sum();
    assert_eq!(validation.len(), 3);
    let summary = rows(&desk.read("results/tiny-validation/validation_summary.csv"));
    assert_eq!(summary[0]["inside"], inside.to_string());
}
