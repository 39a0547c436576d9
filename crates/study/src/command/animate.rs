//! animate: runs side by side as an animated GIF.

use std::path::PathBuf;

use anyhow::Context;
use clap::Args;
use snowlab_study::animate::{Pieces, Run, view_of};
use snowlab_study::figure::gif::gif;
use snowlab_study::figure::moving::{Moving, drawings};
use snowlab_study::fragments_command::DEFAULT_MIN_MASS_SHARE;
use snowlab_study::store::put_whole;

use super::Exit;
use super::subject::{Subject, SubjectArguments};

/// Beside each other where nobody says (chosen: two balls of 30 thousand particles stay legible at 800 pixels).
const COLUMNS: usize = 2;
/// The last picture stands for so long [hundredths of a second].
const REST: u16 = 200;

/// What to draw, and how.
#[derive(Debug, Args)]
pub struct AnimateArguments {
    #[command(flatten)]
    subjects: SubjectArguments,
    /// The file, .gif
    #[arg(short, long)]
    output: PathBuf,
    /// Linking length of the fragments [m]; by default the study's, or twice the spacing of the scene's grid
    #[arg(long)]
    link: Option<f64>,
    /// Width [pixels]
    #[arg(long, default_value_t = 800, value_parser = clap::value_parser!(u32).range(100..=4000))]
    width: u32,
    /// Runs beside each other
    #[arg(long, default_value_t = COLUMNS)]
    columns: usize,
    /// Take every so many-th frame
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..))]
    every: u64,
    /// Frames a second
    #[arg(long, default_value_t = 12, value_parser = clap::value_parser!(u16).range(1..=50))]
    rate: u16,
}

/// Draws.
pub fn animate(arguments: &AnimateArguments) -> anyhow::Result<Exit> {
    let mut subjects = arguments.subjects.open()?;
    let count = subjects.iter().map(|subject| subject.source.frames()).min().unwrap_or(0);
    anyhow::ensure!(count > 0, "there is no frame to draw");
    let numbers: Vec<usize> = (0..count).step_by(arguments.every as usize).collect();
    let mut times = Vec::new();
    for &number in &numbers {
        let (contact, unit, name) = subjects[0].clock;
        let time = subjects[0].source.snapshot(number)?.time;
        times.push(format!("{:.1} {name}", (time - contact) / unit));
    }
    let mut runs = Vec::new();
    for subject in &mut subjects {
        let pieces = arguments.pieces(subject)?;
        runs.push(Run::of(&subject.name, &mut subject.source, &numbers, &pieces)?);
    }
    let view = view_of(&runs).context("there are no particles to draw")?;
    let tracks: Vec<_> = runs.iter().map(Run::track).collect();
    let AnimateArguments { width, columns, rate, .. } = *arguments;
    let moving = Moving { tracks: &tracks, times: &times, view: &view, width, columns };
    let bytes = gif(&drawings(&moving)?, 100 / rate, REST)?;
    put_whole(&arguments.output, |file| file.write_all(&bytes))?;
    println!("{}: {} frames, {:.1} MB", arguments.output.display(), numbers.len(), bytes.len() as f64 / 1e6);
    Ok(Exit::Done)
}

impl AnimateArguments {
    fn pieces(&self, subject: &Subject) -> anyhow::Result<Pieces> {
        if let Some(link) = self.link {
            anyhow::ensure!(
                link > 0.0 && link.is_finite(),
                "`--link` is {link:?}; allowed: above 0: a length in metres"
            );
            let least_share = subject.pieces.map_or(DEFAULT_MIN_MASS_SHARE, |pieces| pieces.least_share);
            return Ok(Pieces { link, least_share });
        }
        subject.pieces.ok_or_else(|| {
            anyhow::anyhow!("{}: nothing says how long links are; give `--link` [m], above 0", subject.name)
        })
    }
}
