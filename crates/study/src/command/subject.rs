//! Runs that are drawn: of a study's arms, or wherever frames are.

use std::path::{Path, PathBuf};

use clap::Args;
use snowlab_study::animate::Pieces;
use snowlab_study::film::Source;
use snowlab_study::fragments_command::DEFAULT_MIN_MASS_SHARE;
use snowlab_study::results::Archive;
use snowlab_study::sweep::Study;

/// Which runs.
#[derive(Debug, Args)]
pub struct SubjectArguments {
    /// A study (.toml), whose arms with a `picture` are drawn, or frames: folders of `simulate` or of cases, files of points (.csv, .ply)
    #[arg(required = true)]
    subjects: Vec<PathBuf>,
    /// A named variation of the study
    #[arg(long)]
    profile: Option<String>,
    /// Folder of the study's results
    #[arg(long, default_value = "results")]
    results: PathBuf,
    /// Arms of the study, by commas, in place of those with a `picture`
    #[arg(long, value_delimiter = ',')]
    arms: Vec<String>,
}

/// A run that is to be drawn.
pub struct Subject {
    /// What is written above it.
    pub name: String,
    /// What files of it are called: the arm, or the folder.
    pub id: String,
    /// Its frames.
    pub source: Source,
    /// What the study calls a fragment; a link of `None` is for who draws to choose.
    pub pieces: Option<Pieces>,
    /// Time of contact, and the unit of time [s] with its name.
    pub clock: (f64, f64, &'static str),
}

impl SubjectArguments {
    /// Opens them.
    pub fn open(&self) -> anyhow::Result<Vec<Subject>> {
        let is_study = |path: &PathBuf| path.extension().is_some_and(|ending| ending == "toml");
        match &self.subjects[..] {
            [study] if is_study(study) => self.of_study(study),
            paths => paths.iter().map(|path| of_frames(path)).collect(),
        }
    }

    /// The first block of each arm that has a picture or is asked for.
    fn of_study(&self, path: &Path) -> anyhow::Result<Vec<Subject>> {
        let (study, _) = Study::read(path, self.profile.as_deref())?;
        let archive = Archive::open(&study, &self.results, path.parent().unwrap_or(Path::new(".")))?;
        if let Some(unknown) = self.arms.iter().find(|id| !study.spec.arm.iter().any(|arm| arm.id == **id)) {
            anyhow::bail!("`--arms`: the study has no arm `{unknown}`");
        }
        let is_wanted = |id: &str, picture: bool| match &self.arms[..] {
            [] => picture,
            asked => asked.iter().any(|arm| arm == id),
        };
        let mut subjects = Vec::new();
        for arm in study.spec.arm.iter().filter(|arm| is_wanted(&arm.id, arm.picture.is_some())) {
            let Some(index) = (0..study.cases.len()).find(|&index| study.cases[index].arm == arm.id) else {
                // An arm that the profile leaves out.
                continue;
            };
            anyhow::ensure!(
                archive.is_done(index),
                "{}: the first case of arm `{}` has not been run; `snowlab run` with the same study and profile runs it",
                path.display(),
                arm.id
            );
            let result = archive.result(index)?;
            let measure = &study.measure;
            subjects.push(Subject {
                name: study.label(&arm.id),
                id: arm.id.clone(),
                source: Source::open(archive.case_folder(index).path())?,
                pieces: Some(Pieces {
                    link: measure.link_ratio * measure.largest_spacing,
                    least_share: measure.min_mass_share,
                }),
                clock: (
                    result.record.contact_time.unwrap_or(0.0),
                    result.record.time_unit,
                    "R/v after contact",
                ),
            });
        }
        anyhow::ensure!(
            !subjects.is_empty(),
            "{}: no arm has a `picture`; name arms with `--arms`",
            path.display()
        );
        Ok(subjects)
    }
}

fn of_frames(path: &Path) -> anyhow::Result<Subject> {
    let source = Source::open(path)?;
    let spacing = source.scene().map(|scene| scene.numerics.spacing);
    let pieces =
        spacing.map(|h| Pieces { link: super::export::LINK * h, least_share: DEFAULT_MIN_MASS_SHARE });
    let id = path.file_stem().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
    Ok(Subject { name: id.clone(), id, source, pieces, clock: (0.0, 1e-3, "ms") })
}
