//! What studies ask: sweeps, claims, expectations, and profiles of them.

use super::studies::{ARMS, END, NAME};
use super::{Refused, STUDY, hold, refused, study};

const TABLE: &[Refused] = &[
    // Sweeps.
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[[sweep]]\nname = \"h\"\npath = \"numerics.spacing\"\nvalues = []\n",
        &["`sweep.0.values`", "is empty", "one value or more"],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[[sweep]]\nname = \"h\"\npath = \"numerics.spacing\"\nvalues = [0.1]\nnumbers = [1.0, 2.0]\n",
        &["`sweep.0.numbers`", "2 entries", "1 values"],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[[sweep]]\nname = \"h\"\npath = \"numerics.spacing\"\nvalues = [0.1]\nnumbers = [nan]\n",
        &["`sweep.0.numbers`", "NaN", "finite"],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[[sweep]]\nname = \"kernel\"\npath = \"numerics.kernel\"\nvalues = [\"cubic\"]\n",
        &["`sweep.0.values`", "not numbers", "give `numbers`"],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[[sweep]]\nname = \"porosity\"\npath = \"body.0.phase_shift\"\nvalues = [0.1]\n",
        &["`sweep.0.name`", "\"porosity\"", "another name"],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[[sweep]]\nname = \"a b\"\npath = \"body.0.phase_shift\"\nvalues = [0.1]\n",
        &["`sweep.0.name`", "\"a b\"", NAME],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[[sweep]]\nname = \"a\"\npath = \"body.0.phase_shift\"\nvalues = [0.1]\n[[sweep]]\nname = \"a\"\npath = \"body.0.stiffness_scale\"\nvalues = [0.1]\n",
        &["`sweep.1.name`", "\"a\""],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[[sweep]]\nname = \"a\"\npath = \"body.0.phase_shift\"\nvalues = [0.1]\n[[sweep]]\nname = \"b\"\npath = \"body.0.phase_shift\"\nvalues = [0.1]\n",
        &["`sweep.1.path`", "\"body.0.phase_shift\"", "another axis"],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[[sweep]]\nname = \"a\"\npath = \"seed\"\nvalues = [1, 2]\n",
        &["`sweep.0.path`", "`seed`", "`blocks.first`"],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[[sweep]]\nname = \"a\"\nvalues = [1.0, 2.0]\n",
        &["`sweep.0.values.0`", "a table of settings by path", "no `path`"],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[[sweep]]\nname = \"a\"\nvalues = [{ seed = 1 }]\nnumbers = [1.0]\n",
        &["`sweep.0.values.0`", "`seed`", "`blocks.first`"],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[[sweep]]\nname = \"a\"\npath = \"body.0.phase_shift\"\nvalues = [0.1]\nlabels = []\n",
        &["`sweep.0.labels`", "0 entries for 1 values", "one for each"],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[[sweep]]\nname = \"../h\"\npath = \"numerics.spacing\"\nvalues = [0.1]\n",
        &["`sweep.0.name`", "\"../h\"", NAME],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[[sweep]]\nname = \"h\"\npath = \"numerics.spacing\"\nvalues = [0.1, -0.1]\n",
        &["arm `one`", "`numerics.spacing`", "is -0.1"],
    ),
    // What settings are learnt from.
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[equivalence]\nreference = \"three\"\n",
        &["`equivalence.reference`", "\"three\"", ARMS],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[[sweep]]\nname = \"speed\"\npath = \"body.0.stiffness_scale\"\nvalues = [1.0, 2.0]\n[tradeoff]\naxis = \"scene\"\n",
        &["`tradeoff.axis`", "\"scene\"", "an axis of the sweep (speed)"],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[[sweep]]\nname = \"speed\"\npath = \"body.0.stiffness_scale\"\nvalues = [1.0, 2.0]\n[tradeoff]\naxis = \"speed\"\nheld_out = [3.0]\n",
        &["`tradeoff.held_out`", "has 3", "numbers of the axis `speed` ([1.0, 2.0])"],
    ),
    // Claims and what they need.
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[[control]]\nid = \"c\"\nsentence = \"s\"\nlargest_spacing = 0\ncontrast = { paired = { treated = \"one\", control = \"two\" } }\n",
        &["`control.0.largest_spacing`", "is 0", "allowed: above 0, at most 1e6"],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[[claim]]\nid = \"c\"\nsentence = \"s\"\ncontrast = { paired = { treated = \"one\", control = \"three\" } }\n",
        &["`claim.0.contrast`", "\"three\"", ARMS],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[[control]]\nid = \"c\"\nsentence = \"s\"\ncontrast = { paired = { treated = \"one\", control = \"one\" } }\n",
        &["`control.0.contrast`", "each named once"],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[[claim]]\nid = \"c\"\nsentence = \"s\"\ncontrast = { range = { arms = [\"one\"] } }\n",
        &["`claim.0.contrast`", "two or more arms"],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[[claim]]\nid = \"c\"\nsentence = \"s\"\ncontrast = { trend = { arms = [{ arm = \"one\", particles = 5 }, { arm = \"two\", particles = 5 }] } }\n",
        &["`claim.0.contrast`", "[5.0, 5.0]", "two of them different"],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[[claim]]\nid = \"c\"\nsentence = \"s\"\ncontrast = { weighted = { weights = { one = 1.0, two = 1.0 } } }\n",
        &["`claim.0.contrast`", "sum to 2", "cancel"],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[[claim]]\nid = \"c\"\nsentence = \"s\"\ncontrast = { pared = { treated = \"one\", control = \"two\" } }\n",
        &["`claim.0.contrast.pared`", "unknown name", "`paired`"],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[[claim]]\nid = \"c\"\nsentence = \"s\"\ncontrast = { paired = 1 }\n",
        &["`claim.0.contrast.paired`", "`1`", "expected a table"],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[[claim]]\nid = \"c\"\nsentence = \"s\"\ncontrast = { paired = { treated = \"one\", control = \"two\" }, range = { arms = [] } }\n",
        &["`claim.0.contrast`", "several keys", "give it one"],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[[claim]]\nid = \"c\"\nsentence = \"s\"\ncontrast = \"paired\"\n",
        &["`claim.0.contrast`"],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[[claim]]\nid = \"c\"\nsentence = \"s\"\ncontrast = { paired = { treated = \"one\" } }\n",
        &["`claim.0.contrast.paired`", "`control` is missing"],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[[sweep]]\nname = \"h\"\npath = \"numerics.spacing\"\nvalues = [0.1, 0.2]\n[[claim]]\nid = \"c\"\nsentence = \"s\"\ncontrast = { range = { arms = [\"one\", \"two\"] } }\n",
        &["`claim.0.contrast`", "sweep", "leave out"],
    ),
    refused("name =", "noise_floor = [\"elastic\"]\nname =", &["`noise_floor`", "\"elastic\"", ARMS]),
    // Expectations.
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[[expect]]\nmetric = \"digest\"\nrange = [0.0, 1.0]\nwhy = \"w\"\n",
        &["`expect.0.metric`", "\"digest\"", "a numeric column of `cases.csv`"],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[[expect]]\nmetric = \"damage\"\nrange = [1.0, 0.0]\nwhy = \"w\"\n",
        &["`expect.0.range`", "[1.0, 0.0]", "least first"],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[[expect]]\nmetric = \"damage\"\nrange = [nan, 0.0]\nwhy = \"w\"\n",
        &["`expect.0.range`", "NaN", "least first"],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[[expect]]\nmetric = \"damage\"\nrange = [0.0]\nwhy = \"w\"\n",
        &["`expect.0.range`", "length 1", "length 2"],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[[expect]]\nmetric = \"damage\"\narms = [\"three\"]\nrange = [0.0, 1.0]\nwhy = \"w\"\n",
        &["`expect.0.arms`", "\"three\"", ARMS],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[[expect]]\nmetric = \"damage\"\nprofiles = [\"fast\"]\nrange = [0.0, 1.0]\nwhy = \"w\"\n",
        &["`expect.0.profiles`", "\"fast\"", "the study has: default"],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[[expect]]\nmetric = \"damage\"\nstatistic = \"mode\"\nrange = [0.0, 1.0]\nwhy = \"w\"\n",
        &["`expect.0.statistic`", "`mode`", "`each`, `mean`, `median`"],
    ),
    // Profiles, whether they are chosen or not.
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[profile.cases]\n",
        &["`profile.cases`", "cases, figures, lock, manifest.json, slurm", "another"],
    ),
    refused(END, "[[arm]]\nid = \"two\"\n[profile.\"../x\"]\n", &["`profile.../x`", "\"../x\"", NAME]),
    refused(END, "[[arm]]\nid = \"two\"\n[profile.\"/etc/x\"]\n", &["`profile./etc/x`", "\"/etc/x\"", NAME]),
    refused(END, "[[arm]]\nid = \"two\"\n[profile.\"\"]\n", &["`profile.`", "is \"\"", NAME]),
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[profile.\"cases.csv\"]\n",
        &["`profile.cases.csv`", "file of results", ".csv, .html", "another name"],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[profile.quick]\narms = [\"one\", \"one\"]\n",
        &["`profile.quick.arms`", "\"one\" twice", "each once"],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[profile.quick.arm_set.two]\nseed = 1\n",
        &["`profile.quick.arm_set.two`", "`seed`", "`blocks.first`"],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[profile.quick]\narms = [\"three\"]\n",
        &["`profile.quick.arms`", "\"three\"", ARMS],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[profile.quick]\narms = []\n",
        &["`profile.quick.arms`", "is empty"],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[profile.quick.arm_set.three]\n\"numerics.spacing\" = 0.1\n",
        &["`profile.quick.arm_set`", "\"three\"", ARMS],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[profile.quick.set]\nseed = 1\n",
        &["`profile.quick.set`", "`seed`", "`blocks.first`"],
    ),
    refused(
        END,
        "[[arm]]\nid = \"two\"\n[profile.quick]\nblock = 1\n",
        &["`profile.quick.block`", "unknown key", "`blocks`"],
    ),
];

#[test]
fn questions_are_refused_with_place_value_and_remedy() {
    hold(STUDY, study, TABLE);
}
