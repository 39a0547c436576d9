//! convert: frames for other programs; and what `simulate` asks of it.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use anyhow::Context;
use clap::{Args, ValueEnum};
use snowlab_study::export::{Exporter, Format, Snapshot};
use snowlab_study::film::Source;

use super::Exit;

/// Links are so many spacings of the grid long where none is given: the links of the studies (docs/experiment.md).
pub const LINK: f64 = 2.0;

/// Formats, by commas.
#[derive(Clone, Debug)]
pub struct Formats(Vec<Format>);

impl FromStr for Formats {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "none" {
            return Ok(Formats(Vec::new()));
        }
        let format = |name: &str| {
            Format::from_str(name, true).map_err(|_| {
                let all: Vec<&str> = Format::value_variants().iter().map(|format| format.ending()).collect();
                format!("`{name}` is not a format; there are {}, and `none`", all.join(", "))
            })
        };
        text.split(',').map(|name| format(name.trim())).collect::<Result<_, _>>().map(Formats)
    }
}

/// What to write for other programs.
#[derive(Debug, Args)]
pub struct ExportArguments {
    /// Formats, by commas: csv, ply, vtp, xyz, vol, vdb, parquet; or none
    #[arg(long, default_value = "csv")]
    export: Formats,
    /// Side of the cells of vol and vdb [m]; by default the spacing of the scene's grid
    #[arg(long)]
    cell: Option<f64>,
    /// Linking length of the fragments [m]; by default twice the spacing of the scene's grid
    #[arg(long)]
    pub link: Option<f64>,
}

impl ExportArguments {
    /// Refuses what cannot be had of a scene, before it is run.
    pub fn check(&self, dimension: usize) -> anyhow::Result<()> {
        let grid = self.export.0.iter().find(|format| format.is_grid() && dimension != 3);
        if let Some(format) = grid {
            anyhow::bail!(
                "`--export {}`: a density on a grid needs three dimensions; `ply`, `vtp` and `xyz` take two",
                format.ending()
            );
        }
        for (name, value) in [("--cell", self.cell), ("--link", self.link)] {
            if let Some(length) = value.filter(|length| !(*length > 0.0 && length.is_finite())) {
                anyhow::bail!("`{name}` is {length:?}; allowed: above 0: a length in metres");
            }
        }
        Ok(())
    }

    /// Who writes into `folder`.
    pub fn exporter(&self, folder: &Path) -> Exporter {
        Exporter::new(folder, &self.export.0, self.cell)
    }
}

/// Finds fragments at `link` [m], or at what the studies take.
pub fn find_fragments(snapshot: &mut Snapshot, link: Option<f64>) -> anyhow::Result<()> {
    if let Some(link) = link.or(snapshot.spacing.map(|h| LINK * h)) {
        snapshot.find_fragments(link)?;
    }
    Ok(())
}

/// What to convert, and into what.
#[derive(Debug, Args)]
pub struct ConvertArguments {
    /// Frames: a folder of `simulate`, the folder of a study's case, or a file of points (.csv, .ply)
    frames: PathBuf,
    /// Folder for the files
    #[arg(long)]
    out: PathBuf,
    /// Only this frame, counted from 0
    #[arg(long)]
    frame: Option<usize>,
    #[command(flatten)]
    export: ExportArguments,
}

/// Writes frames in the formats of other programs.
pub fn convert(arguments: &ConvertArguments) -> anyhow::Result<Exit> {
    let ConvertArguments { frames, out, frame, export } = arguments;
    let mut source = Source::open(frames)?;
    let all = source.frames();
    let chosen: Vec<usize> = match *frame {
        Some(number) if number >= all => {
            anyhow::bail!("`--frame` is {number}; {} has {all} frames, counted from 0", frames.display())
        }
        Some(number) => vec![number],
        None => (0..all).collect(),
    };
    let mut exporter = export.exporter(out);
    for &number in &chosen {
        let mut snapshot = source.snapshot(number)?;
        export.check(snapshot.dimension)?;
        if exporter.tells_fragments() {
            find_fragments(&mut snapshot, export.link)
                .with_context(|| format!("{}, frame {number}", frames.display()))?;
        }
        exporter.add(number, &snapshot)?;
    }
    exporter.end()?;
    println!("{}: {} frames", out.display(), chosen.len());
    Ok(Exit::Done)
}
