//! render: pictures of runs in space, by Mitsuba 3.

use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Args;
use snowlab_study::render::{Mitsuba, Picture, Preset};
use snowlab_study::view::Viewpoint;

use super::Exit;
use super::subject::{Subject, SubjectArguments};

/// What to draw, and how.
#[derive(Debug, Args)]
pub struct RenderArguments {
    #[command(flatten)]
    subjects: SubjectArguments,
    /// How much work a picture is
    #[arg(long, value_enum, default_value_t = Preset::Draft)]
    preset: Preset,
    /// Folder for the pictures
    #[arg(long)]
    out: PathBuf,
    /// Frames to draw, by commas, counted from 0; by default the last, and all for a movie
    #[arg(long, value_delimiter = ',')]
    frame: Vec<usize>,
    /// Seed of the picture's noise: the same seed, the same picture
    #[arg(long, default_value_t = 1)]
    seed: u32,
    /// Python that has Mitsuba
    #[arg(long, default_value = "python3")]
    python: PathBuf,
    /// Keep scene files, grains and volumes beside the pictures
    #[arg(long)]
    keep: bool,
}

/// Draws frames. All pictures are seen from the same place, from which the first frame and all that are drawn can be seen.
pub fn render(arguments: &RenderArguments) -> anyhow::Result<Exit> {
    let RenderArguments { preset, out, python, .. } = arguments;
    let mut subjects = arguments.subjects.open()?;
    let mitsuba = Mitsuba::find(python)?;
    let mut seen = Vec::new();
    for subject in &mut subjects {
        let chosen = arguments.chosen(subject)?;
        for number in [Some(&0), chosen.first(), chosen.last()].into_iter().flatten() {
            seen.push(subject.source.snapshot(*number)?.positions);
        }
    }
    let scene = subjects.first().and_then(|subject| subject.source.scene());
    let seen: Vec<_> = seen.iter().map(Vec::as_slice).collect();
    let view = Viewpoint::of(scene.as_ref(), &seen);
    let scratch = tempfile::tempdir()?;
    for subject in &mut subjects {
        for number in arguments.chosen(subject)? {
            arguments.draw(&mitsuba, subject, number, &view, scratch.path())?;
        }
    }
    if *preset == Preset::Movie {
        println!(
            "as a film, where ffmpeg is installed: ffmpeg -framerate 24 -pattern_type glob -i '{}/*.png' -pix_fmt yuv420p {}/film.mp4",
            out.display(),
            out.display()
        );
    }
    Ok(Exit::Done)
}

impl RenderArguments {
    /// One at a time: grains of a picture are some hundred megabytes.
    fn draw(
        &self,
        mitsuba: &Mitsuba,
        subject: &mut Subject,
        number: usize,
        view: &Viewpoint,
        scratch: &Path,
    ) -> anyhow::Result<()> {
        let name = format!("{}-{number:05}", subject.id);
        let folder = if self.keep { self.out.as_path() } else { scratch };
        let (snapshot, scene) = (subject.source.snapshot(number)?, subject.source.scene());
        let picture = Picture { snapshot: &snapshot, scene: scene.as_ref(), view, preset: self.preset };
        picture.check().with_context(|| subject.id.clone())?;
        std::fs::create_dir_all(&self.out)?;
        let file = picture.write(folder, &name)?;
        let target = self.out.join(format!("{name}.png"));
        mitsuba.render(&[(file, target)], self.seed, |line| println!("{line}"))?;
        if !self.keep {
            for entry in std::fs::read_dir(scratch)? {
                std::fs::remove_file(entry?.path())?;
            }
        }
        Ok(())
    }

    fn chosen(&self, subject: &Subject) -> anyhow::Result<Vec<usize>> {
        let all = subject.source.frames();
        anyhow::ensure!(all > 0, "{} has no frame", subject.id);
        if let Some(number) = self.frame.iter().find(|number| **number >= all) {
            anyhow::bail!("`--frame` is {number}; {} has {all} frames, counted from 0", subject.id);
        }
        Ok(match (&self.frame[..], self.preset) {
            ([], Preset::Movie) => (0..all).collect(),
            ([], _) => vec![all - 1],
            (asked, _) => asked.to_vec(),
        })
    }
}
