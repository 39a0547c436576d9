//! Tables of now against earlier ones.

use std::path::PathBuf;

use clap::Args;
use snowlab_study::compare::{Rules, compare as compare_tables};

use super::Exit;

/// What is compared, and what counts as the same.
#[derive(Debug, Args)]
pub struct CompareArguments {
    /// Folder of tables, such as results/placement, or a CSV file
    a: PathBuf,
    /// What it is held against: a folder or a file as well
    b: PathBuf,
    /// Relative tolerance: a and b differ where |a - b| > absolute + relative max(|a|, |b|)
    #[arg(long, value_name = "X", default_value = "0", value_parser = tolerance, allow_negative_numbers = true)]
    relative: f64,
    /// Absolute tolerance, in the unit of each column
    #[arg(long, value_name = "X", default_value = "0", value_parser = tolerance, allow_negative_numbers = true)]
    absolute: f64,
    /// Relative tolerance of one column in place of --relative; may be given for several
    #[arg(long = "column", value_name = "NAME=X", value_parser = column)]
    columns: Vec<(String, f64)>,
    /// A column that is not compared, such as `digest`; may be given for several
    #[arg(long = "ignore", value_name = "NAME")]
    ignored: Vec<String>,
    /// Of two files: columns that tell rows apart, with commas between; if not told, those known of a study's tables, else the number of the row
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    key: Option<Vec<String>>,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// Prints what differs, and whether anything does.
pub fn compare(arguments: CompareArguments) -> anyhow::Result<Exit> {
    let CompareArguments { a, b, relative, absolute, columns, ignored, key, json } = arguments;
    let (columns, ignored) = (columns.into_iter().collect(), ignored.into_iter().collect());
    let found = compare_tables(&a, &b, Rules { relative, absolute, columns, ignored, key })?;
    if json {
        println!("{}", serde_json::to_string_pretty(&found)?);
    } else {
        println!("{found}");
    }
    Ok(if found.same { Exit::Done } else { Exit::ExpectationFailed })
}

fn tolerance(text: &str) -> Result<f64, String> {
    let value = text.parse::<f64>().ok().filter(|value| value.is_finite() && *value >= 0.0);
    value.ok_or_else(|| "allowed: a number, 0 or more, such as 1e-9".into())
}

fn column(text: &str) -> Result<(String, f64), String> {
    let (name, value) =
        text.rsplit_once('=').ok_or("give a column and its tolerance, such as ln_neff=1e-6")?;
    Ok((name.into(), tolerance(value)?))
}
