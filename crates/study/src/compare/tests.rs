//! Small tables held against each other.

use std::path::Path;

use super::{CompareError, Comparison, Pair, Rules, Sheet, Side, TableComparison};

fn sheet(side: &str, text: &str) -> Sheet {
    Sheet::parse(Path::new(side), text.as_bytes()).expect("a table")
}

fn compared(table: &str, a: &str, b: &str, rules: Rules) -> Result<TableComparison, CompareError> {
    let pair = Pair { table: table.into(), a: Some(sheet("a.csv", a)), b: Some(sheet("b.csv", b)) };
    let found = Comparison::of(&[pair], rules)?;
    assert_eq!(found.same, found.tables[0].is_same());
    Ok(found.tables.into_iter().next().expect("one table"))
}

fn found(table: &str, a: &str, b: &str) -> TableComparison {
    compared(table, a, b, Rules::default()).expect("two tables")
}

/// What is said of two tables that cannot be compared.
fn refusal(table: &str, a: &str, b: &str, rules: Rules) -> String {
    compared(table, a, b, rules).expect_err("they cannot be compared").to_string()
}

fn columns(found: &TableComparison) -> Vec<(&str, usize, &str, &str)> {
    found
        .differences
        .iter()
        .map(|d| (d.column.as_str(), d.rows, d.greatest.a.as_str(), d.greatest.b.as_str()))
        .collect()
}

#[test]
fn rows_are_matched_by_what_they_are_of_and_not_by_where_they_stand() {
    let a = "arm,speed,block,x\nfew,1.0,1,0.1\nfew,2.0,1,0.2\nmany,1.0,1,0.3\n";
    let b = "arm,speed,block,x\nmany,1.0,1,0.3\nfew,2.0,1,0.25\nfew,1.0,1,0.1\n";
    let found = found("cases", a, b);
    assert_eq!(columns(&found), [("x", 1, "0.2", "0.25")]);
    let key = [("arm", "few"), ("speed", "2.0"), ("block", "1")].map(|(n, v)| (n.to_string(), v.to_string()));
    assert_eq!(found.differences[0].greatest.key, key);
    // A table that is not known goes by the number of the row.
    let by_row = self::found("points", a, b);
    assert_eq!(columns(&by_row), [("arm", 2, "few", "many"), ("x", 3, "0.1", "0.3")]);
}

#[test]
fn the_greatest_difference_is_the_relatively_greatest_and_words_before_all() {
    let a = "arm,block,x,y\nr,1,100,1\nr,2,1,2\nr,3,7,3\n";
    let b = "arm,block,x,y\nr,1,110,1.5\nr,2,1.5,\nr,3,7,9\n";
    let found = found("cases", a, b);
    assert_eq!(columns(&found), [("x", 2, "1", "1.5"), ("y", 3, "2", "")]);
    let [x, y] = [0, 1].map(|k| &found.differences[k]);
    assert_eq!((x.of, x.greatest.absolute), (3, Some(0.5)));
    assert!((x.greatest.relative.unwrap() - 1.0 / 3.0).abs() < 1e-15);
    assert_eq!((y.greatest.absolute, y.greatest.relative), (None, None));
}

#[test]
fn frames_of_a_case_are_counted() {
    let a = "arm,block,time\nr,1,0\nr,1,0.1\nr,2,0\n";
    let b = "arm,block,time\nr,1,0\nr,1,0.1001\nr,2,0\nr,2,0.1\n";
    let found = found("frames", a, b);
    assert_eq!(columns(&found), [("time", 1, "0.1", "0.1001")]);
    assert_eq!(found.rows_missing.len(), 1);
    assert_eq!(found.rows_missing[0].first, ["arm r, block 2, frame 2"]);
    assert_eq!(found.rows_missing[0].side, Side::B);
}

#[test]
fn what_one_side_alone_has_is_told() {
    let a = "arm,block,x,old\nr,1,1,1\nr,2,1,1\n";
    let b = "arm,block,new,x\nr,1,1,1\n";
    let found = found("cases", a, b);
    assert_eq!((found.rows, columns(&found).len(), found.is_same()), (1, 0, false));
    let names: Vec<_> = found.columns_missing.iter().map(|m| (m.side, m.first.join(" "))).collect();
    assert_eq!(names, [(Side::A, "old".into()), (Side::B, "new".into())]);
    assert_eq!(found.rows_missing[0].first, ["arm r, block 2"]);
}

/// A table without rows is written without columns.
#[test]
fn a_table_without_rows_lacks_the_rows_of_the_other() {
    let full = "family,claim,p\nclaim,one,0.5\nclaim,two,0.5\nclaim,three,1\nclaim,four,1\n";
    for (a, b, side) in [("\n", full, Side::B), (full, "\n", Side::A)] {
        let found = found("claims", a, b);
        assert_eq!((found.rows_missing[0].side, found.rows_missing[0].count), (side, 4));
        assert_eq!(found.rows_missing[0].first.len(), 3);
    }
    assert!(found("claims", "\n", "\n").is_same());
}

#[test]
fn tables_of_other_axes_are_not_compared() {
    let found = found("cases", "arm,block,x\nr,1,1\n", "arm,speed,block,x\nr,2,1,1\n");
    let [a, b] = found.keys_differ.as_ref().expect("other axes");
    assert_eq!((a.join(" "), b.join(" ")), ("arm block".into(), "arm speed block".into()));
    assert!(!found.is_same() && found.rows == 0);
}

#[test]
fn columns_have_tolerances_of_their_own_and_may_be_left_out() {
    let (a, b) = ("arm,block,x,y\nr,1,100,100\n", "arm,block,x,y\nr,1,101,101\n");
    let rules = |x: f64| Rules { relative: 0.001, columns: [("x".into(), x)].into(), ..Rules::default() };
    assert_eq!(columns(&compared("cases", a, b, rules(0.01)).unwrap()), [("y", 1, "100", "101")]);
    assert_eq!(columns(&compared("cases", a, b, rules(0.001)).unwrap()).len(), 2);
    let ignored = Rules { ignored: ["y".into()].into(), ..rules(0.01) };
    assert!(compared("cases", a, b, ignored.clone()).unwrap().is_same());
    // Nor is it missing then.
    assert!(compared("cases", "arm,block,x\nr,1,100\n", b, ignored).unwrap().is_same());
    let absolute = Rules { absolute: 1.0, ..Rules::default() };
    assert!(compared("cases", a, b, absolute).unwrap().is_same());
}

#[test]
fn clocks_are_left_out_and_the_dictionary_is_words() {
    let (a, b) =
        ("arm,blocks,seconds,on_front\nr,1,3.5,true\n", "arm,blocks,seconds,on_front\nr,1,9,false\n");
    assert!(found("trade", a, b).is_same());
    assert!(!found("cases", a, b).is_same());
    let (a, b) = ("table,column,unit,meaning\nt,c,-,1\n", "table,column,unit,meaning\nt,c,-,1.0\n");
    let wide = Rules { relative: 1.0, absolute: 1.0, ..Rules::default() };
    assert!(!compared("dictionary", a, b, wide.clone()).unwrap().is_same());
    assert!(compared("summary", a, b, wide).unwrap().is_same());
}

#[test]
fn rules_that_do_not_fit_are_refused() {
    let text = "arm,block,x\nr,1,1\nr,2,1\n";
    let key = |names: &[&str]| Rules {
        key: Some(names.iter().map(ToString::to_string).collect()),
        ..Rules::default()
    };
    assert!(compared("cases", text, text, key(&["block"])).unwrap().is_same());
    assert_eq!(
        refusal("cases", text, text, key(&["blok"])),
        "a.csv: line 1: there is no column `blok`, which `--key` names; there are arm, block, x"
    );
    let twice = refusal("points", text, text, key(&["arm"]));
    assert!(twice.starts_with("a.csv: line 3: arm r stands in line 2 already;"), "{twice}");
    let ignored = |name: &str| Rules { ignored: [name.into()].into(), ..Rules::default() };
    let refused = refusal("cases", text, text, ignored("block"));
    assert!(refused.starts_with("`--ignore` names the column `block`; by it rows"), "{refused}");
    let refused = refusal("cases", text, text, ignored("y"));
    assert_eq!(
        refused,
        "`--ignore` names the column `y`; no table has it; look at the first line of one, such as a.csv"
    );
}

#[test]
fn what_is_no_table_is_refused_with_its_line() {
    for (text, says) in [
        (&b""[..], "t.csv: line 1: the file is empty"),
        (b"a,b\n1,2\n1\n", "t.csv: line 3: 1 field(s), but the first line names 2 columns"),
        (b"a,b,a\n1,2,3\n", "t.csv: line 1: the column `a` stands twice"),
        (b"a,b\n1,2\n\"1,2\n3,4\n", "t.csv: line 3: 1 field(s), but"),
        (b"a\n1\n\"2\n3\n", "t.csv: line 3: from this row on a quote is left open"),
        (b"a,b\n1,\xff\n", "t.csv: line 2: field 2 is not UTF-8"),
        (b"a,\xff\n1,2\n", "t.csv: line 1: field 2 is not UTF-8"),
    ] {
        let said = Sheet::parse(Path::new("t.csv"), text).expect_err("no table").to_string();
        assert!(said.starts_with(says), "{:?}: {said}", String::from_utf8_lossy(text));
    }
    let sheet = sheet("t.csv", "\u{feff}a,b\r\n\"x, \"\"y\"\"\nz\",2\r\n");
    assert_eq!((sheet.columns[0].as_str(), &sheet.rows[0][0]), ("a", "x, \"y\"\nz"));
}
