//! One picture: the files that Mitsuba makes it of.

use std::fs::File;
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

use clap::ValueEnum;
use minijinja::Environment;
use minijinja::syntax::SyntaxConfig;
use minijinja::value::{Serde, Value};
use serde::Serialize;
use snowlab_solver::Vector;

use super::camera::Camera;
use super::grains;
use crate::export::{Density, DensityError, ExportError, Format, Snapshot};
use crate::spec::SceneSpec;
use crate::spec::scene::{BallSpec, BoxSpec, SolidSpec};
use crate::view::Viewpoint;

const TEMPLATE: &str = include_str!("scene.xml.jinja");

/// How much work a picture is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Preset {
    /// Grains alone, small and noisy: does it look at the right thing?
    Draft,
    /// Volume and grains, large: for a page of a paper
    Still,
    /// Grains alone, of middling size: many frames
    Movie,
}

/// What of it goes into the scene file.
#[derive(Clone, Copy, Debug, Serialize)]
struct Quality {
    width: u32,
    height: u32,
    samples: u32,
    /// Longest path of light.
    depth: u32,
    /// Radius of a grain over the distance between particles at rest.
    grain: f64,
    has_volume: bool,
}

impl Preset {
    /// Grains alone must close the surface; on a volume they only roughen it.
    fn quality(self) -> Quality {
        match self {
            Preset::Draft => {
                Quality { width: 480, height: 360, samples: 16, depth: 8, grain: 0.5, has_volume: false }
            }
            Preset::Movie => {
                Quality { width: 640, height: 480, samples: 48, depth: 8, grain: 0.5, has_volume: false }
            }
            Preset::Still => {
                Quality { width: 800, height: 600, samples: 40, depth: 24, grain: 0.24, has_volume: true }
            }
        }
    }
}

/// Cells of the volume over the distance between particles at rest (chosen: fewer show single particles as clouds, more blur cracks).
const CELL: f64 = 1.15;
/// Extinction of snow at rest [1/m] times the radius of a ball as heavy as the body: opaque, with a bright edge (chosen by eye). Light scatters alike in all directions: as half
/// of it forward would on twice as many ways, which costs twice as much and is not seen.
const OPTICAL_RADIUS: f64 = 10.5;
/// A density above this is drawn as this (chosen: compacted snow reaches it; the greatest of the volume sets the cost of all of it).
const MOST_DENSITY: f64 = 1.5;
/// Half the side of a floor or wall over the radius of what is looked at (chosen: its end is a horizon far behind).
const PLANE: f64 = 14.0;
/// Where the light stands from the middle, to the right, up and towards the camera, over the radius of what is looked at (chosen by eye: from the upper left, before
/// what is seen, so that cracks have shadows and the side that is looked at none).
const LIGHT: [f64; 3] = [-1.8, 2.6, 2.2];
/// Half the side of the light over the same radius (chosen by eye: shadows with soft edges).
const LIGHT_SIZE: f64 = 0.9;

/// Colours, linear: chosen by eye, snow being near white and all else dark beside it.
#[derive(Serialize)]
struct Look {
    sky: [f64; 3],
    light: [f64; 3],
    obstacle: [f64; 3],
    grain: [f64; 3],
    albedo: [f64; 3],
}

const LOOK: Look = Look {
    sky: [0.48, 0.55, 0.65],
    light: [48.0, 44.0, 37.0],
    obstacle: [0.06, 0.068, 0.08],
    grain: [0.92, 0.94, 0.97],
    albedo: [0.975, 0.98, 0.985],
};

#[derive(Serialize)]
struct Light {
    origin: [f64; 3],
    up: [f64; 3],
    half_width: f64,
}

#[derive(Serialize)]
struct Plane {
    point: [f64; 3],
    before: [f64; 3],
    along: [f64; 3],
    half_width: f64,
}

#[derive(Serialize)]
struct Volume {
    file: PathBuf,
    centre: [f64; 3],
    half_extent: [f64; 3],
    extinction: f64,
}

#[derive(Serialize)]
struct Ball {
    centre: [f64; 3],
    radius: f64,
}

#[derive(Serialize)]
struct Cuboid {
    centre: [f64; 3],
    half_extent: Vec<f64>,
    angle: f64,
}

/// What the scene file is filled with.
#[derive(Serialize)]
struct Page<'a> {
    quality: Quality,
    camera: Camera,
    light: Light,
    planes: Vec<Plane>,
    balls: Vec<Ball>,
    boxes: Vec<Cuboid>,
    grains: &'a Path,
    volume: Option<Volume>,
    look: Look,
}

/// A picture that cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// In a plane.
    #[error("pictures of this kind need three dimensions; `snowlab animate` draws two")]
    Flat,
    /// Nothing to see.
    #[error("there are no particles")]
    Empty,
    /// The density.
    #[error(transparent)]
    Density(#[from] DensityError),
    /// Its file.
    #[error(transparent)]
    Export(#[from] ExportError),
    /// The disk.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// The scene file.
    #[error("the scene file cannot be made")]
    Template(#[from] minijinja::Error),
}

/// A picture of a snapshot.
#[derive(Clone, Copy, Debug)]
pub struct Picture<'a> {
    /// The particles.
    pub snapshot: &'a Snapshot,
    /// The scene they are of, for its obstacles.
    pub scene: Option<&'a SceneSpec>,
    /// What is looked at.
    pub view: &'a Viewpoint,
    /// How much work it is.
    pub preset: Preset,
}

impl Picture<'_> {
    /// Whether there is something to draw.
    ///
    /// # Errors
    /// [`RenderError::Flat`], [`RenderError::Empty`].
    pub fn check(&self) -> Result<(), RenderError> {
        match self.snapshot {
            Snapshot { dimension: 3, positions, .. } if positions.is_empty() => Err(RenderError::Empty),
            Snapshot { dimension: 3, .. } => Ok(()),
            _ => Err(RenderError::Flat),
        }
    }

    /// Writes scene, grains and volume into `folder` under `name`; the path of the scene file.
    ///
    /// # Errors
    /// [`RenderError`].
    pub fn write(&self, folder: &Path, name: &str) -> Result<PathBuf, RenderError> {
        self.check()?;
        let Picture { snapshot, view, preset, .. } = *self;
        let quality = preset.quality();
        let grains = folder.join(format!("{name}.ply"));
        let between = snapshot.spacing_of_particles();
        put(&grains, |file| grains::write(file, snapshot, quality.grain * between))?;
        let volume = quality.has_volume.then(|| self.volume(&folder.join(format!("{name}.vol")), between));
        let camera = Camera::of(view, f64::from(quality.width) / f64::from(quality.height));
        let radius = view.radius();
        let [right, up, towards] = LIGHT;
        let origin = view.centre + radius * (right * view.right() + up * view.up + towards * view.towards);
        let light = Light { origin: origin.into(), up: view.right().into(), half_width: LIGHT_SIZE * radius };
        let (planes, balls, boxes) = (Vec::new(), Vec::new(), Vec::new());
        let volume = volume.transpose()?;
        let mut page =
            Page { quality, camera, light, planes, balls, boxes, grains: &grains, volume, look: LOOK };
        self.add_obstacles(&mut page);
        let page = Value::from(Serde(page));
        let text = environment()?.get_template(NAME)?.render(page)?;
        let path = folder.join(format!("{name}.xml"));
        put(&path, |file| io::Write::write_all(file, text.as_bytes()))?;
        Ok(path)
    }

    fn add_obstacles(&self, page: &mut Page) {
        for collider in self.scene.iter().flat_map(|scene| &scene.collider) {
            let moved = |centre: &[f64]| -> [f64; 3] {
                std::array::from_fn(|k| {
                    centre[k] + self.snapshot.time * collider.velocity.get(k).copied().unwrap_or(0.0)
                })
            };
            match &collider.shape {
                SolidSpec::HalfSpace { point, normal } => {
                    let normal = Vector::<f64, 3>::from_column_slice(normal);
                    page.planes.push(plane(&moved(point).into(), &normal, self.view));
                }
                SolidSpec::Ball(BallSpec { centre, radius }) => {
                    page.balls.push(Ball { centre: moved(centre), radius: *radius });
                }
                SolidSpec::Box(BoxSpec { centre, half_extent, angle }) => {
                    let (centre, half_extent) = (moved(centre), half_extent.clone());
                    page.boxes.push(Cuboid { centre, half_extent, angle: *angle });
                }
            }
        }
    }

    fn volume(&self, path: &Path, between: f64) -> Result<Volume, RenderError> {
        let cell = CELL * between;
        let mut density = Density::of(self.snapshot, Some(cell))?;
        for value in density.blocks.values_mut().flat_map(|block| block.iter_mut()) {
            *value = value.min(MOST_DENSITY);
        }
        let [low, high] = Format::write_density(path, &density)?;
        let middle = |k: usize| 0.5 * cell * f64::from(low[k] + high[k]);
        let half = |k: usize| 0.5 * cell * f64::from(high[k] - low[k] + 1);
        // R of a ball of this volume.
        let rest = between.powi(3) * self.snapshot.positions.len() as f64;
        let body = libm::cbrt(rest * 0.75 / std::f64::consts::PI);
        Ok(Volume {
            file: path.into(),
            centre: std::array::from_fn(middle),
            half_extent: std::array::from_fn(half),
            extinction: OPTICAL_RADIUS / body,
        })
    }
}

/// A plane as a square about the point of it that is nearest to what is looked at.
fn plane(point: &Vector<f64, 3>, normal: &Vector<f64, 3>, view: &Viewpoint) -> Plane {
    let [middle, along, _] = view.square_on(point, normal);
    Plane {
        point: middle.into(),
        before: (middle + normal.normalize()).into(),
        along: along.into(),
        half_width: PLANE * view.radius(),
    }
}

/// Its ending has names of files escaped.
const NAME: &str = "scene.xml";

fn environment() -> Result<Environment<'static>, RenderError> {
    let mut environment = Environment::new();
    environment.set_syntax(SyntaxConfig::builder().trim_blocks(true).lstrip_blocks(true).build()?);
    environment.add_filter("list3", |values: Vec<f64>| {
        values.iter().map(|value| format!("{value:?}")).collect::<Vec<_>>().join(", ")
    });
    environment.add_template(NAME, TEMPLATE)?;
    Ok(environment)
}

fn put(path: &Path, write: impl FnOnce(&mut dyn io::Write) -> io::Result<()>) -> Result<(), RenderError> {
    let all = || {
        let mut file = BufWriter::new(File::create(path)?);
        write(&mut file)?;
        io::Write::flush(&mut file)
    };
    all().map_err(|source| RenderError::Io { path: path.into(), source })
}
