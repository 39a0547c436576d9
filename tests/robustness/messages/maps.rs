//! Maps, and arms of a sweep.

use super::studies::{ARMS, NAME};
use super::{Refused, STUDY, hold, refused, study};

/// Two axes, of which "two" is run along one, and a map of "one".
const MAPPED: &str = r#"
[[sweep]]
name = "young"
path = "body.0.stiffness_scale"
values = [1.0, 2.0]
arms = ["one", "two"]
[[sweep]]
name = "step"
path = "numerics.fixed_step"
values = [1e-4, 1e-3]
arms = ["one"]
[[map]]
id = "m"
title = "t"
x = "step"
y = "young"
sound = { metric = "damage", range = [0.0, 0.5], otherwise = "broken" }
"#;

const TABLE: &[Refused] = &[
    refused("arms = [\"one\"]\n", "arms = [\"three\"]\n", &["`sweep.1.arms`", "\"three\"", ARMS]),
    refused("id = \"m\"", "id = \"../m\"", &["`map.0.id`", "\"../m\"", NAME]),
    refused(
        "[[map]]",
        "[[map]]\nid = \"m\"\ntitle = \"t\"\nx = \"step\"\ny = \"young\"\n[[map]]",
        &["`map.1.id`", "\"m\"", "stands twice", "its own id"],
    ),
    refused("x = \"step\"", "x = \"steps\"", &["`map.0.x`", "\"steps\"", "young, step"]),
    refused("y = \"young\"", "y = \"step\"", &["`map.0.y`", "is \"step\" as `x` is", "another axis"]),
    refused("x = \"step\"\n", "", &["`map.0`", "`x` is missing"]),
    refused("title = \"t\"", "title = \"t\"\narms = [\"three\"]", &["`map.0.arms`", "\"three\"", ARMS]),
    refused(
        "title = \"t\"",
        "title = \"t\"\narms = [\"two\"]",
        &["`map.0.arms`", "\"two\" is run along: young", "set `arms` of the axes"],
    ),
    refused(
        "arms = [\"one\"]\n[[map]]",
        "arms = [\"one\"]\n[[sweep]]\nname = \"c\"\npath = \"numerics.greatest_step\"\nvalues = [1.0]\n[[map]]",
        &["`map.0.arms`", "\"one\" is run along: young, step, c", "of no other"],
    ),
    refused(
        "arms = [\"one\", \"two\"]",
        "arms = [\"two\"]",
        &["`map.0.arms`", "no arm is run along both \"step\" and \"young\"", "name one"],
    ),
    refused("\"damage\"", "\"damages\"", &["`map.0.sound.metric`", "\"damages\"", "such as damage"]),
    refused("[0.0, 0.5]", "[0.5, 0.0]", &["`map.0.sound.range`", "[0.5, 0.0]", "least first"]),
    refused("otherwise", "else", &["`map.0.sound", "`else`", "unknown key"]),
];

#[test]
fn maps_are_refused_with_place_value_and_remedy() {
    hold(&format!("{STUDY}{MAPPED}"), study, TABLE);
}
