//! page: text with numbers from tables.

use std::path::PathBuf;

use anyhow::Context;
use clap::Args;
use snowlab_study::store::write_whole;
use snowlab_study::template;

use super::Exit;

/// Which page.
#[derive(Debug, Args)]
pub struct PageArguments {
    /// Source: Markdown with the markup of minijinja
    source: PathBuf,
    /// The page to write
    #[arg(short, long)]
    output: PathBuf,
    /// Folder that the names of tables in the source count from
    #[arg(long, default_value = ".")]
    root: PathBuf,
}

/// Writes the page.
pub fn page(arguments: &PageArguments) -> anyhow::Result<Exit> {
    let PageArguments { source, output, root } = arguments;
    let text =
        std::fs::read_to_string(source).with_context(|| format!("cannot read {}", source.display()))?;
    let page = template::page(&text, root).with_context(|| source.display().to_string())?;
    write_whole(output, page.as_bytes())?;
    println!("{}", output.display());
    Ok(Exit::Done)
}
