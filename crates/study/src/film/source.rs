//! Frames wherever they are: a film, a case of a study, or one file of points.

use std::path::{Path, PathBuf};

use super::{FILM, Film, FilmError};
use crate::export::Snapshot;
use crate::frames::Frames;
use crate::points::{PointsError, read_any};
use crate::spec::{self, SceneSpec};
use crate::store::{Asked, CASE, CaseFolder, FRAMES, StoreError};

/// Frames that are read one by one.
#[derive(Debug)]
pub enum Source {
    /// What `snowlab simulate` wrote.
    Film(Box<Film>),
    /// A case of a study.
    Case(Box<CaseFrames>),
    /// A file of points.
    Points(Box<Snapshot>),
}

/// Frames of a case and the scene that they are of.
#[derive(Debug)]
pub struct CaseFrames {
    scene: SceneSpec,
    /// Volume of all particles at rest [m^D], where the run has ended.
    volume: Option<f64>,
    frames: AnyFrames,
}

#[derive(Debug)]
enum AnyFrames {
    Two(Frames<2>),
    Three(Frames<3>),
}

/// Frames that cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum SourceError {
    /// A film.
    #[error(transparent)]
    Film(#[from] FilmError),
    /// A case.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// A file of points.
    #[error(transparent)]
    Points(#[from] PointsError),
    /// Nothing that has frames.
    #[error(
        "{}: neither a folder that `snowlab simulate` wrote (it has no `{FILM}`), nor the folder of a case of a study (no `{FRAMES}`), nor a file of \
         points (.csv or .ply)",
        .0.display()
    )]
    None(PathBuf),
}

impl Source {
    /// Opens what is there.
    ///
    /// # Errors
    /// [`SourceError`].
    pub fn open(path: &Path) -> Result<Self, SourceError> {
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
        if path.is_dir() {
            let film = path.join(FILM);
            if film.is_file() {
                return Ok(Source::Film(Box::new(Film::open(&film)?)));
            }
            if path.join(FRAMES).is_file() {
                return Ok(Source::Case(Box::new(CaseFrames::read(path)?)));
            }
            return Err(SourceError::None(path.into()));
        }
        match ending.as_deref() {
            Some("snowlab") => Ok(Source::Film(Box::new(Film::open(path)?))),
            Some("csv" | "ply") => Ok(Source::Points(Box::new(Snapshot::of_points(&read_any(path)?)))),
            _ => Err(SourceError::None(path.into())),
        }
    }

    /// The number of frames.
    pub fn frames(&self) -> usize {
        match self {
            Source::Film(film) => film.frames(),
            Source::Case(case) => case.len(),
            Source::Points(_) => 1,
        }
    }

    /// Frame number `number`, below [`Source::frames`].
    ///
    /// # Errors
    /// The disk's.
    pub fn snapshot(&mut self, number: usize) -> Result<Snapshot, SourceError> {
        match self {
            Source::Film(film) => Ok(film.snapshot(number)?),
            Source::Case(case) => Ok(case.snapshot(number)),
            Source::Points(points) => Ok((**points).clone()),
        }
    }

    /// The scene that the frames are of, where it is known.
    pub fn scene(&self) -> Option<SceneSpec> {
        match self {
            Source::Film(film) => spec::parse(&film.header().scene).ok(),
            Source::Case(case) => Some(case.scene.clone()),
            Source::Points(_) => None,
        }
    }
}

impl CaseFrames {
    fn read(path: &Path) -> Result<Self, SourceError> {
        // The folder is named by its key, which a path such as `.` hides.
        let path = path.canonicalize().map_err(|source| StoreError::Io { path: path.into(), source })?;
        let folder = CaseFolder::at(&path);
        let asked = folder
            .read_json::<Asked>(CASE)?
            .ok_or_else(|| StoreError::Damaged { path: path.join(CASE), reason: "it is missing".into() })?;
        let frames = match asked.scene.dimension {
            3 => AnyFrames::Three(folder.read_frames()?),
            _ => AnyFrames::Two(folder.read_frames()?),
        };
        let record = folder.read_run()?;
        Ok(CaseFrames { scene: asked.scene, volume: record.map(|record| record.made.filled_volume), frames })
    }

    fn len(&self) -> usize {
        match &self.frames {
            AnyFrames::Two(frames) => frames.frames.len(),
            AnyFrames::Three(frames) => frames.frames.len(),
        }
    }

    fn snapshot(&self, number: usize) -> Snapshot {
        let spacing = self.scene.numerics.spacing;
        let mut snapshot = match &self.frames {
            AnyFrames::Two(frames) => Snapshot::of_case(frames, number, spacing),
            AnyFrames::Three(frames) => Snapshot::of_case(frames, number, spacing),
        };
        // A case does not keep them: they go with the masses.
        snapshot.volumes = self.volume.zip(snapshot.masses.as_ref()).map(|(volume, masses)| {
            let total: f64 = masses.iter().sum();
            masses.iter().map(|mass| volume * mass / total).collect()
        });
        snapshot
    }
}
