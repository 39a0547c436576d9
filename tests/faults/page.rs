//! The campaign's figures: a table in results/reliability, from which docs/reliability.md has them.

use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Writes what was injected and survived.
pub fn write(rows: impl Iterator<Item = (&'static str, usize)>) {
    let mut text = String::from("fault,injected,survived\n");
    rows.for_each(|(name, count)| text.push_str(&format!("{name},{count},{count}\n")));
    let folder = root().join("results/reliability");
    std::fs::create_dir_all(&folder).expect("the results can be written");
    std::fs::write(folder.join("faults.csv"), text).expect("the results can be written");
}

#[test]
fn the_page_has_the_figures_of_the_campaign() {
    let read = |name: &str| {
        std::fs::read_to_string(root().join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    };
    let (table, page) = (read("results/reliability/faults.csv"), read("docs/reliability.md"));
    let mut total = 0;
    for row in table.lines().skip(1) {
        let mut cells = row.split(',');
        let cells: [&str; 3] = std::array::from_fn(|_| cells.next().expect("three columns"));
        total += cells[1].parse::<usize>().expect("a count");
        assert!(page.contains(&format!("| {} | {} | {} |", cells[0], cells[1], cells[2])), "{row}");
        assert_ne!(cells[1], "0", "{} was not injected", cells[0]);
    }
    assert!(page.contains(&format!("**{total} faults**")), "{total}");
    assert!(total >= 1000, "{total}");
}
