//! Studies.

use snowlab_study::check::check;
use snowlab_study::spec::{self, StudySpec};
use snowlab_study::sweep::Study;

use super::{Refused, STUDY, hold, hold_message, refused, study};

pub const NAME: &str = "1 to 64 of the characters";
pub const ARMS: &str = "the study has: one, two";
pub const END: &str = "[[arm]]\nid = \"two\"\n";

const TABLE: &[Refused] = &[
    // Names, some of which become files and folders.
    refused("\"tiny\"", "\"a/b\"", &["`name`", "\"a/b\"", NAME]),
    refused("\"tiny\"", "\"..\"", &["`name`", "\"..\"", "no dot first"]),
    refused("\"tiny\"", "\"\"", &["`name`", NAME]),
    refused("\"tiny\"", "\"../x\"", &["`name`", "\"../x\"", NAME]),
    refused("\"tiny\"", "\"/etc/x\"", &["`name`", "\"/etc/x\"", NAME]),
    refused("\"tiny\"", "\".\"", &["`name`", "\".\"", NAME]),
    refused("\"tiny\"", "\"con\\u0000\"", &["`name`", "\"con\\0\"", NAME]),
    refused("\"tiny\"", "\"a\\u001b[2J\"", &["`name`", "\"a\\u{1b}[2J\"", NAME]),
    refused("\"tiny\"", "\"a\\\\b\"", &["`name`", "\"a\\b\"", NAME]),
    refused("\"tiny\"", "\"~\"", &["`name`", "\"~\"", NAME]),
    refused("\"tiny\"", "\"Tiny\"", &["`name`", "\"Tiny\"", NAME]),
    refused(
        "\"tiny\"",
        "\"aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa\"",
        &["`name`", NAME],
    ),
    refused("\"two\"", "\"two/..\"", &["`arm.1.id`", "\"two/..\"", NAME]),
    refused(
        END,
        "[[arm]]\nid = \"two\"\npicture = \"../figure\"\n",
        &["`arm.1.picture`", "\"../figure\"", NAME],
    ),
    refused("\"two\"", "\"/etc/x\"", &["`arm.1.id`", "\"/etc/x\"", NAME]),
    // Keys.
    refused(
        "question =",
        "questions = \"?\"\nquestion =",
        &["line 3", "`questions`", "unknown key", "`question`"],
    ),
    refused("name = \"tiny\"", "", &["`name` is missing"]),
    refused("count = 2\n", "count = 2.5\n", &["`blocks.count`", "2.5", "a whole number"]),
    refused("count = 2\n", "", &["`blocks`", "`count` is missing"]),
    refused("largest_spacing = 0.05", "", &["`measure`", "`largest_spacing` is missing"]),
    // Arms.
    refused("\"two\"", "\"one\"", &["`arm.1.id`", "\"one\"", "stands twice", "its own id"]),
    refused("[[arm]]\nid = \"one\"\n[[arm]]\nid = \"two\"\n", "[profile]\n", &["`arm` is missing"]),
    refused(
        END,
        "[[arm]]\nid = \"two\"\ntrade = { reference = \"three\", family = \"f\" }\n",
        &["`arm.1.trade.reference`", "\"three\"", ARMS],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\ntrade = { reference = \"two\", family = \"f\" }\n",
        &["`arm.1.trade.reference`", "is \"two\"", "the arm itself", "name the one whose results"],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[[feature]]\nname = \"f\"\non = \"one\"\noff = \"three\"\n",
        &["`feature.0.off`", "\"three\"", ARMS],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[[feature]]\nname = \"f\"\non = \"one\"\noff = \"one\"\n",
        &["`feature.0.off`", "is \"one\"", "name one that does without"],
    ),
    // Conditions under which arms are run again.
    refused(
        END,
        "[[condition]]\nid = \"c\"\narms = []\n",
        &["`condition.0.arms`", "is empty", "name the arms"],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[[condition]]\nid = \"c\"\narms = [\"three\"]\n",
        &["`condition.0.arms`", "\"three\"", ARMS],
    ),
    refused(
        END,
        "[[condition]]\nid = \"c\"\narms = [\"one\", \"one\"]\n",
        &["`condition.0.arms`", "\"one\" twice", "each once"],
    ),
    refused(
        END,
        "[[condition]]\nid = \"c\"\narms = [\"one\"]\n[[condition]]\nid = \"c\"\narms = [\"one\"]\n",
        &["`condition.1.id`", "stands twice"],
    ),
    refused(END, "[[condition]]\nid = \"a@b\"\narms = [\"one\"]\n", &["`condition.0.id`", "a@b"]),
    refused(
        END,
        "[[condition]]\nid = \"c\"\narms = [\"one\"]\narm_set = { two = { \"numerics.spacing\" = 0.1 } }\n",
        &["`condition.0.arm_set`", "\"two\"", "the condition has: one"],
    ),
    refused(
        END,
        "[[condition]]\nid = \"c\"\narms = [\"one\"]\nset = { seed = 3 }\n",
        &["`condition.0.set`", "`seed`", "`blocks.first`"],
    ),
    refused(
        END,
        "[[condition]]\nid = \"c\"\narms = [\"one\"]\nset = { \"numerics.spacing\" = -1.0 }\n",
        &["line 23, arm `one@c`", "`numerics.spacing`", "above 0"],
    ),
    refused(
        END,
        "[[condition]]\nid = \"c\"\narms = [\"one\"]\n[profile.p]\nconditions = [\"d\"]\n",
        &["`profile.p.conditions`", "\"d\"", "the study has: c"],
    ),
    refused(
        END,
        "[[condition]]\nid = \"c\"\narms = [\"one\"]\ncheck = \"half-step\"\n[[condition]]\nid = \"d\"\narms = [\"one\"]\ncheck = \"half-step\"\n",
        &["`condition.1.check`", "\"c\" checks", "remove one"],
    ),
    refused(
        END,
        "[[condition]]\nid = \"c\"\narms = [\"one\"]\ncheck = \"half-step\"\n",
        &["arm `one@c`, `check`", "nothing is changed", "`wave_courant`"],
    ),
    refused(
        END,
        "[[condition]]\nid = \"c\"\narms = [\"one\"]\ncheck = \"other-transfer\"\nset = { \"numerics.transfer\" = \"apic\", \"numerics.spacing\" = 0.1 }\n",
        &["arm `one@c`, `check`", "more is changed", "`numerics.transfer`"],
    ),
    refused(
        END,
        "[[condition]]\nid = \"c\"\narms = [\"one\"]\ncheck = \"quarter-step\"\n",
        &["`condition.0.check`", "`quarter-step`", "`half-step`"],
    ),
    refused(
        END,
        "[[density_noise]]\nnoisy = \"one\"\nlattice = \"two\"\nrandom = \"one\"\n",
        &["`density_noise.0`", "\"two\""],
    ),
    // Points that fill a box.
    refused(
        END,
        "[[sweep]]\nname = \"s\"\n[sweep.sample]\npoints = 0\n[[sweep.sample.factor]]\nname = \"v\"\npath = \"body.0.stiffness_scale\"\nrange = [1.0, 2.0]\n",
        &["`sweep.0.sample.points`", "is 0", "1 to 65536"],
    ),
    refused(
        END,
        "[[sweep]]\nname = \"s\"\n[sweep.sample]\npoints = 4\n[[sweep.sample.factor]]\nname = \"v\"\npath = \"body.0.stiffness_scale\"\nrange = [2.0, 1.0]\n",
        &["`sweep.0.sample.factor.0.range`", "[2.0, 1.0]", "least first"],
    ),
    refused(
        END,
        "[[sweep]]\nname = \"s\"\n[sweep.sample]\npoints = 4\n[[sweep.sample.factor]]\nname = \"v\"\npath = \"body.0.stiffness_scale\"\nrange = [0.0, 1.0]\nscale = \"logarithmic\"\n",
        &["`sweep.0.sample.factor.0.range`", "above 0 where the scale is"],
    ),
    refused(
        END,
        "[[sweep]]\nname = \"s\"\n[sweep.sample]\npoints = 4\n[[sweep.sample.factor]]\nname = \"steps\"\npath = \"body.0.stiffness_scale\"\nrange = [1.0, 2.0]\n",
        &["`sweep.0.sample.factor.0.name`", "a column of the tables has already"],
    ),
    refused(
        END,
        "[[sweep]]\nname = \"s\"\nvalues = [1.0]\n[sweep.sample]\npoints = 4\n[[sweep.sample.factor]]\nname = \"v\"\npath = \"body.0.stiffness_scale\"\nrange = [1.0, 2.0]\n",
        &["`sweep.0.values`", "`sample`", "remove one"],
    ),
    refused(
        END,
        "[[sweep]]\nname = \"s\"\n[sweep.sample]\npoints = 4\n[[sweep.sample.factor]]\nname = \"v\"\npath = \"seed\"\nrange = [1.0, 2.0]\n",
        &["`sweep.0.sample.factor.0.path`", "`blocks.first`"],
    ),
    refused(
        END,
        "[[sweep]]\nname = \"s\"\n[sweep.sample]\npoints = 4\n[[sweep.sample.factor]]\nname = \"v\"\npath = \"body.0.stiffness_scale\"\nrange = [1.0, 2.0]\narms = [\"two\"]\n",
        &["`sweep.0.sample.factor.0.arms`", "\"two\""],
    ),
    refused(
        END,
        "[[sweep]]\nname = \"s\"\n[sweep.sample]\npoints = 4\nfactor = []\n",
        &["`sweep.0.sample.factor`", "has 0 entries", "1 to 20"],
    ),
    // The scene, as each arm has it.
    refused(
        "spacing = 0.05\n[[scene",
        "[[scene",
        &["line 9, arm `one`", "`numerics`", "`spacing` is missing"],
    ),
    refused(
        "radius = 0.25",
        "radius = -1.0",
        &["line 12, arm `one`", "`body.0.region.radius`", "is -1.0", "above 0"],
    ),
    refused(
        "radius = 0.25",
        "radius = \"big\"",
        &["arm `one`", "`body.0.region.radius`", "\"big\"", "a number"],
    ),
    refused(
        "radius = 0.25",
        "radius = 0.25, wobble = 1",
        &["arm `one`", "`body.0.region.wobble`", "unknown key"],
    ),
    refused(
        "[scene.numerics]",
        "[scene]\nseed = 5\n[scene.numerics]",
        &["`scene.seed`", "number of the block", "`blocks.first`"],
    ),
    // Paths that lead nowhere.
    refused(
        END,
        "[[arm]]\nid = \"two\"\nset = { \"numerics.spacin\" = 0.1 }\n",
        &["line 22, arm `two`", "`numerics.spacin`", "unknown key"],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\nset = { \"body.3.velocity\" = [0.0, 1.0] }\n",
        &["line 22, arm `two`", "`body.3.velocity`", "1 entries"],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\nset = { \"body.first.velocity\" = [0.0, 1.0] }\n",
        &["arm `two`", "`first`", "must be a number"],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\nset = { \"numerics.spacing.x\" = 0.1 }\n",
        &["arm `two`", "`numerics.spacing`", "single value"],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\nset = { \"body..x\" = 0.1 }\n",
        &["arm `two`", "`body..x`", "empty part"],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\nset = { \"numerics.spacing\" = \"fine\" }\n",
        &["line 22, arm `two`", "`numerics.spacing`", "\"fine\"", "a number"],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\nset = { \"body.0.material\" = { kind = \"snow\", poisson = 0.5 } }\n",
        &["line 22, arm `two`", "`body.0.material.poisson`", "is 0.5", "below 0.5"],
    ),
    refused(END, "[[arm]]\nid = \"two\"\nset = { seed = 4 }\n", &["`arm.1.set`", "`seed`", "`blocks.first`"]),
    // Too much.
    refused("count = 2\n", "count = 1000000000\n", &["2000000000 cases", "1000000", "fewer"]),
    refused(
        "count = 2\n",
        "count = 400000\n",
        &["800000 cases with", "values in all their scenes", "10000000", "smaller"],
    ),
];

#[test]
fn studies_are_refused_with_place_value_and_remedy() {
    hold(STUDY, study, TABLE);
}

/// The line is that of the setting that holds in the case that is refused, wherever in the file that is.
#[test]
fn the_line_is_where_the_value_was_set_last() {
    let lines = STUDY.matches('\n').count();
    let refused = |more: &str, profile, line: usize| {
        let message = Study::parse(&format!("{STUDY}{more}"), profile).unwrap_err().to_string();
        hold_message(&message, more, &[&format!("line {}, arm `", lines + line), "`numerics.spacing`: is -"]);
    };
    refused("[[sweep]]\nname = \"h\"\npath = \"numerics.spacing\"\nvalues = [0.1, -1.0]\n", None, 4);
    let points = "[[sweep]]\nname = \"h\"\nnumbers = [1]\nvalues = [\n{ \"numerics.spacing\" = -1.0 },\n]\n";
    refused(points, None, 5);
    refused("set = { \"numerics.spacing\" = -1.0 }\n", None, 1);
    refused("[profile.p.set]\n\"numerics.spacing\" = -1.0\n", Some("p"), 2);
    refused("[profile.default.arm_set.two]\n\"numerics.spacing\" = -1.0\n", None, 2);
}

#[test]
fn a_profile_that_is_not_there_is_named_with_those_that_are() {
    let spec: StudySpec = spec::parse(&format!("{STUDY}[profile.quick]\n[profile.slow]\n")).unwrap();
    let message = Study::expand(spec, Some("fast")).unwrap_err().to_string();
    hold_message(&message, "fast", &["profile `fast`", "quick, slow"]);
    let message = Study::expand(spec::parse(STUDY).unwrap(), Some("fast")).unwrap_err().to_string();
    hold_message(&message, "fast", &["profile `fast`", "it has: none"]);
}

#[test]
fn arms_and_axes_have_their_limits() {
    let lines = |count: usize, line: &dyn Fn(usize) -> String| (0..count).map(line).collect::<String>();
    let none = STUDY.replace("[[arm]]\nid = \"one\"\n[[arm]]\nid = \"two\"\n", "");
    hold_message(
        &study(&format!("arm = []\n{none}")).unwrap_err().to_string(),
        "no arm",
        &["line 1, `arm`", "is empty", "one [[arm]] or more"],
    );
    let arms = lines(1001, &|k| format!("[[arm]]\nid = \"a-{k}\"\n"));
    let message = study(&format!("{none}{arms}")).unwrap_err().to_string();
    hold_message(&message, "arms", &["`arm`", "1001 entries", "1 to 1000 [[arm]]", "two studies"]);
    let axes =
        lines(21, &|k| format!("[[sweep]]\nname = \"a-{k}\"\npath = \"numerics.spacing\"\nvalues = [0.1]\n"));
    let message = study(&format!("{STUDY}{axes}")).unwrap_err().to_string();
    hold_message(&message, "axes", &["`sweep`", "21 axes", "allowed: 20", "leave some out"]);
}

/// Each of these took more time than there is, before it was refused or read.
#[test]
fn a_crowd_that_names_one_another_is_read_soon() {
    let names = vec!["\"three\""; 500_000].join(", ");
    let message = study(&format!("noise_floor = [{names}]\n{STUDY}")).unwrap_err().to_string();
    hold_message(&message, "a long list of arms", &["line 1, `noise_floor`", "\"three\"", ARMS]);
    let arms: Vec<String> = (0..20_000).map(|k| format!("[[arm]]\nid = \"a-{k}\"\n")).collect();
    let message = study(&format!("{STUDY}{}", arms.concat())).unwrap_err().to_string();
    hold_message(&message, "many arms", &["`arm`", "20002 entries"]);
    let conditions: Vec<String> =
        (0..20_000).map(|k| format!("[[condition]]\nid = \"c-{k}\"\narms = [\"one\"]\n")).collect();
    let message = study(&format!("{STUDY}{}", conditions.concat())).unwrap_err().to_string();
    hold_message(&message, "many conditions", &["`condition`", "20000 arms", "make two studies"]);
}

/// A thousand million cases, by three axes of a thousand values: refused before any is made.
#[test]
fn too_many_cases_are_counted_and_not_made() {
    let values: Vec<String> = (1..=1000).map(|k| format!("{k}.0")).collect();
    let axis = |name: &str, path: &str| {
        format!("[[sweep]]\nname = \"{name}\"\npath = \"{path}\"\nvalues = [{}]\n", values.join(", "))
    };
    let axes = [
        axis("a", "body.0.stiffness_scale"),
        axis("b", "body.0.material.young"),
        axis("c", "numerics.greatest_step"),
    ];
    let message = study(&format!("{STUDY}{}", axes.concat())).unwrap_err().to_string();
    hold_message(
        &message,
        "10^9 points",
        &["4000000000 cases", "1000000000 points", "make the sweep or the blocks fewer"],
    );
}

#[test]
fn a_path_without_end_is_refused() {
    let path = vec!["a"; 100_000].join(".");
    let message = study(&format!("{STUDY}set = {{ \"{path}\" = 1 }}\n")).unwrap_err().to_string();
    hold_message(&message, "a long path", &["arm `two`, path `a.a.a", "more than 32 parts"]);
}

/// What a profile leaves out on purpose is not missed; what it should have run is.
#[test]
fn an_expectation_that_no_case_is_there_for_is_not_met() {
    let expect = "[[expect]]\nmetric = \"damage\"\narms = [\"two\"]\nrange = [0.0, 1.0]\nwhy = \"w\"\n";
    let text = format!("{STUDY}{expect}[profile.part]\narms = [\"one\"]\n");
    let found = |profile| check(&Study::expand(spec::parse(&text).unwrap(), profile).unwrap(), &[]);
    let whole = found(None);
    assert!(!whole[0].holds && whole[0].line.contains("`damage` matches no case"), "{whole:?}");
    assert_eq!(found(Some("part")), []);
}

#[test]
fn a_message_names_the_line_of_a_metric_that_is_none() {
    let text = format!("{STUDY}[[expect]]\nmetric = \"damages\"\nrange = [0.0, 1.0]\nwhy = \"w\"\n");
    let message = spec::parse::<StudySpec>(&text).unwrap_err().to_string();
    hold_message(&message, "damages", &["line 23, `expect.0.metric`", "\"damages\"", "such as damage"]);
}
