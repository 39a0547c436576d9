//! `compare` on the tables of a tiny study, and on tables made for it.

use super::{ARMS, Desk, study};

const CASES: &str = "arm,speed,block,particles,ln_neff,failure\nfew,1.0,1,300,1.5,\nfew,1.0,2,300,1.25,\nmany,1.0,1,900,0.5,late\n";

/// Two folders with a table of cases each.
fn folders(a: &str, b: &str) -> Desk {
    let desk = Desk::new();
    for (folder, text) in [("a", a), ("b", b)] {
        std::fs::create_dir(desk.path(folder)).unwrap();
        desk.write(&format!("{folder}/cases.csv"), text);
    }
    desk
}

/// A study that runs again gives the same tables, whatever its clock says; one of other particles does not.
#[test]
fn a_study_is_the_same_as_itself_and_not_as_another() {
    let desk = Desk::with(&[("study.toml", &study(ARMS))]);
    desk.expect(0, "run study.toml --jobs 2 --out one");
    desk.expect(0, "run study.toml --jobs 1 --out two");
    desk.write("two/tiny/timings.csv", "arm\nno time at all\n");
    let printed = desk.expect(0, "compare one/tiny two/tiny");
    assert!(printed.starts_with("the same: 0 of 5 tables differ, "), "{printed}");
    assert!(printed.ends_with(" rows compared, tolerances relative 0.0 and absolute 0.0\n"), "{printed}");

    desk.write("study.toml", &study(ARMS).replace("count = 300", "count = 310"));
    desk.expect(0, "run study.toml --jobs 2 --out other");
    let printed = desk.expect(1, "compare one/tiny other/tiny --relative 0.01");
    let says = "cases, particles: 6 of 6 rows differ, most of arm random, block 1: 300 in A, 310 in B";
    assert!(printed.contains(says), "{printed}");
    assert!(printed.lines().last().unwrap().starts_with("different: "), "{printed}");
    let line = "compare one/tiny/cases.csv other/tiny/cases.csv --ignore key --ignore digest --relative 1000";
    let printed = desk.expect(0, line);
    assert!(printed.starts_with("the same: 0 of 1 tables differ, 6 rows compared"), "{printed}");
}

#[test]
fn one_line_tells_of_each_column_that_differs() {
    let b = CASES.replace("1.5,", "1.5015,").replace("0.5,late", "0.5001,").replace("1.25", "1.25000001");
    let desk = folders(CASES, &b);
    assert_eq!(
        desk.expect(1, "compare a b"),
        "cases, ln_neff: 3 of 3 rows differ, most of arm few, speed 1.0, block 1: 1.5 in A, 1.5015 in B (by 1.500e-3, relative 9.990e-4)\n\
         cases, failure: 1 of 3 rows differ, that of arm many, speed 1.0, block 1: `late` in A, nothing in B\n\
         different: 1 of 1 tables differ, 3 rows compared, tolerances relative 0.0 and absolute 0.0\n"
    );
    for (code, line) in [
        (1, "compare a b --relative 0.001"),
        (0, "compare a b --relative 0.001 --ignore failure"),
        (1, "compare a b --relative 0.0009 --ignore failure"),
        (0, "compare a b --column ln_neff=0.001 --ignore failure"),
        (1, "compare a b --relative 1 --column ln_neff=1e-9 --ignore failure"),
        (0, "compare a b --absolute 0.0016 --ignore failure"),
        (1, "compare a b --absolute 0.0014 --ignore failure"),
        (0, "compare a/cases.csv b/cases.csv --ignore failure --ignore ln_neff --key arm,block"),
    ] {
        desk.expect(code, line);
    }
    let printed = desk.expect(0, "compare a b --column ln_neff=1e-3 --ignore failure");
    assert!(printed.ends_with(", ln_neff relative 0.001, without failure\n"), "{printed}");
}

#[test]
fn what_is_missing_is_a_difference() {
    let b = CASES.replace("few,1.0,2,300,1.25,\n", "").replace("failure", "why");
    let desk = folders(CASES, &b);
    desk.write("a/claims.csv", "\n");
    desk.write("b/points.csv", "x,y\n1,2\n");
    assert_eq!(
        desk.expect(1, "compare a b"),
        "cases: columns only in A: failure\n\
         cases: columns only in B: why\n\
         cases: 1 row only in A: arm few, speed 1.0, block 2\n\
         claims: only in A\n\
         points: only in B\n\
         different: 3 of 3 tables differ, 2 rows compared, tolerances relative 0.0 and absolute 0.0\n"
    );
}

#[test]
fn json_has_the_same_to_say() {
    let desk = folders(CASES, &CASES.replace("1.25", "2.5"));
    let read = |code: i32, line: &str| -> serde_json::Value {
        serde_json::from_str(&desk.expect(code, line)).expect("JSON")
    };
    let found = read(1, "compare a b --json");
    assert_eq!(found["same"], false);
    let column = &found["tables"][0]["differences"][0];
    assert_eq!([&column["column"], &column["greatest"]["b"]], ["ln_neff", "2.5"]);
    assert_eq!([&column["rows"], &column["of"]], [1, 3]);
    assert_eq!([&column["greatest"]["absolute"], &column["greatest"]["relative"]], [1.25, 0.5]);
    let key = serde_json::json!([["arm", "few"], ["speed", "1.0"], ["block", "2"]]);
    assert_eq!(column["greatest"]["key"], key);
    assert_eq!(read(0, "compare a a --json")["same"], true);
}

#[test]
fn two_where_nothing_can_be_compared() {
    let desk = folders(CASES, &CASES.replace("few,1.0,2", "few,1.0,1"));
    std::fs::create_dir(desk.path("empty")).unwrap();
    desk.write("empty/timings.csv", "arm\n");
    desk.write("none.csv", "");
    desk.write("short.csv", "x,y\n1,2\n3\n");
    desk.write("open.csv", "x\n1\n\"2\n3\n");
    for (line, says) in [
        ("compare a", "required arguments"),
        (
            "compare a nowhere",
            "snowlab: nowhere: cannot be read; give two folders of tables or two CSV files",
        ),
        ("compare a empty", "snowlab: empty: has no table"),
        ("compare a b/cases.csv", "snowlab: a: is a folder, and b/cases.csv a file; give two folders or two"),
        (
            "compare a b",
            "snowlab: b/cases.csv: line 3: arm few, speed 1.0, block 1 stands in line 2 already;",
        ),
        ("compare none.csv none.csv", "snowlab: none.csv: line 1: the file is empty"),
        ("compare short.csv short.csv", "snowlab: short.csv: line 3: 1 field(s), but the first line names 2"),
        ("compare open.csv open.csv", "snowlab: open.csv: line 3: from this row on a quote is left open"),
        (
            "compare a/cases.csv a/cases.csv --key arms",
            "line 1: there is no column `arms`, which `--key` names",
        ),
        ("compare a a --key arm", "`--key` names the columns that tell the rows of two files apart"),
        ("compare a a --ignore digst", "`--ignore` names the column `digst`; no table has it"),
        ("compare a a --column digst=1", "`--column` names the column `digst`; no table has it"),
        ("compare a a --ignore block", "`--ignore` names the column `block`; by it rows"),
        ("compare a a --relative -1", "'-1' for '--relative <X>': allowed: a number, 0 or more"),
        ("compare a a --absolute nan", "'nan' for '--absolute <X>': allowed: a number, 0 or more"),
        ("compare a a --column ln_neff", "give a column and its tolerance, such as ln_neff=1e-6"),
        ("compare a a --column ln_neff=much", "allowed: a number, 0 or more"),
    ] {
        let printed = desk.expect(2, line);
        assert!(printed.contains(says), "snowlab {line}\n{printed}");
    }
}
