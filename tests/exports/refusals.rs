//! What `simulate --export` and `convert` refuse, and in which words.

use super::desk::{Desk, SCENE as FLAT};

#[test]
fn refusals_name_the_place_and_the_remedy() {
    let desk = Desk::with(&[("flat.toml", FLAT), ("points.csv", "x,y,z\n0,0,0\n0.1,0,1\n")]);
    std::fs::create_dir(desk.path("empty")).unwrap();
    for (line, words) in [
        (
            "simulate flat.toml --out run --export vdb",
            "`--export vdb`: a density on a grid needs three dimensions",
        ),
        ("simulate flat.toml --out run --export ply,pyl", "`pyl` is not a format; there are csv, ply, vtp"),
        ("simulate flat.toml --out run --cell 0", "`--cell` is 0.0; allowed: above 0"),
        ("convert points.csv --out out --export vol", "give the side of the cells as `--cell`"),
        ("convert points.csv --out out --export vol --cell 0.1", "add a column `mass`"),
        ("convert points.csv --out out --export xyz --link nan", "`--link` is NaN"),
        ("convert points.csv --out out --export xyz --frame 1", "has 1 frames, counted from 0"),
        ("convert empty --out out", "it has no `frames.snowlab`"),
        ("convert flat.toml --out out", "nor a file of points"),
        ("convert nowhere.csv --out out", "nowhere.csv"),
    ] {
        let printed = desk.expect(2, line);
        assert!(printed.contains(words), "{line}\n{printed}");
        assert!(!desk.path("run").exists() && !desk.path("out").exists(), "{line} leaves nothing");
    }
    desk.expect(0, "convert points.csv --out out --export xyz,vtp --link 2");
    assert!(desk.read("out/frame-00000.xyz").lines().nth(2).unwrap().ends_with(" 1"), "one fragment");
}
