//! Which tables are held against which.

use std::collections::BTreeSet;
use std::io;
use std::path::Path;

use super::{CompareError, Rules, Sheet};

/// Tables that know a clock, which no two runs have alike.
const CLOCKED: [&str; 1] = ["timings"];

/// A table of two sides, or of one.
#[derive(Clone, Debug)]
pub struct Pair {
    /// Name of the table, by which the columns are known that tell its rows apart.
    pub table: String,
    /// That of the first side.
    pub a: Option<Sheet>,
    /// That of the second side.
    pub b: Option<Sheet>,
}

/// The tables of two folders, or two files.
pub(super) fn read(a: &Path, b: &Path) -> Result<Vec<Pair>, CompareError> {
    let is_folder = |path: &Path| {
        let failed = |source| CompareError::Io { path: path.into(), source };
        std::fs::metadata(path).map(|what| what.is_dir()).map_err(failed)
    };
    match (is_folder(a)?, is_folder(b)?) {
        (true, true) => of_folders(a, b),
        (false, false) => {
            let table = if a.file_name() == b.file_name() { stem(a) } else { in_both(a, b) };
            Ok(vec![Pair { table, a: Some(Sheet::read(a)?), b: Some(Sheet::read(b)?) }])
        }
        (folder, _) => {
            let (folder, file) = if folder { (a, b) } else { (b, a) };
            let message =
                format!("is a folder, and {} a file; give two folders or two files", file.display());
            Err(CompareError::place(folder, message))
        }
    }
}

fn in_both(a: &Path, b: &Path) -> String {
    format!("{} and {}", a.display(), b.display())
}

fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

fn of_folders(a: &Path, b: &Path) -> Result<Vec<Pair>, CompareError> {
    let names = [names(a)?, names(b)?];
    let read = |folder: &Path, name: &String, names: &BTreeSet<String>| {
        names.contains(name).then(|| Sheet::read(&folder.join(format!("{name}.csv")))).transpose()
    };
    let both: BTreeSet<&String> = names.iter().flatten().collect();
    both.into_iter()
        .map(|name| {
            Ok(Pair { table: name.clone(), a: read(a, name, &names[0])?, b: read(b, name, &names[1])? })
        })
        .collect()
}

/// The tables in a folder.
fn names(folder: &Path) -> Result<BTreeSet<String>, CompareError> {
    let entries = std::fs::read_dir(folder).and_then(Iterator::collect::<io::Result<Vec<_>>>);
    let entries = entries.map_err(|source| CompareError::Io { path: folder.into(), source })?;
    let paths = entries.into_iter().map(|entry| entry.path());
    let tables = paths.filter(|path| path.extension().is_some_and(|ending| ending == "csv"));
    let names: BTreeSet<String> =
        tables.map(|path| stem(&path)).filter(|name| !CLOCKED.contains(&name.as_str())).collect();
    if names.is_empty() {
        let message = "has no table, no file *.csv but one of times; give a folder such as results/placement";
        return Err(CompareError::place(folder, message));
    }
    Ok(names)
}

/// Refuses options that name columns which no table has: a slip of the pen would leave the tolerance unused.
pub(super) fn hold_names(pairs: &[Pair], rules: &Rules) -> Result<(), CompareError> {
    let sheets = || pairs.iter().flat_map(|pair| pair.a.iter().chain(&pair.b));
    let tolerances = rules.columns.keys().map(|column| ("--column", column));
    let ignored = rules.ignored.iter().map(|column| ("--ignore", column));
    for (option, column) in tolerances.chain(ignored) {
        if !sheets().any(|sheet| sheet.column(column).is_some()) {
            let path = sheets().next().map_or(Path::new("cases.csv"), |sheet| &sheet.path);
            let message =
                format!("no table has it; look at the first line of one, such as {}", path.display());
            return Err(CompareError::Name { option, column: column.clone(), message });
        }
    }
    Ok(())
}
