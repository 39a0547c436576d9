//! index: a page over the reports of several studies.

use std::path::PathBuf;

use clap::Args;
use snowlab_study::present::listing;
use snowlab_study::report::index;
use snowlab_study::spec::{self, StudySpec};
use snowlab_study::store::write_whole;

use super::Exit;

/// Which studies, and where their results are.
#[derive(Debug, Args)]
pub struct IndexArguments {
    /// Study files
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// Folder of results; the page is `index.html` in it
    #[arg(long, default_value = "results")]
    out: PathBuf,
}

/// Writes the page.
pub fn write(arguments: &IndexArguments) -> anyhow::Result<Exit> {
    let IndexArguments { files, out } = arguments;
    let read = |file: &PathBuf| spec::read::<StudySpec>(file).map(|(spec, _)| spec);
    let studies = files.iter().map(read).collect::<Result<Vec<_>, _>>()?;
    let page = index::index(&listing(&studies, out)?)?;
    std::fs::create_dir_all(out)?;
    let path = out.join("index.html");
    write_whole(&path, page.as_bytes())?;
    println!("{}", path.display());
    Ok(Exit::Done)
}
