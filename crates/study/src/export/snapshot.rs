//! Particles at one moment, in two or three dimensions, with all that is known of them.

use snowlab_solver::material::ConstitutiveModel;
use snowlab_solver::math::determinant;
use snowlab_solver::{Material, Matrix, Real, State, Vector};

use crate::frames::Frames;
use crate::metrics::{MetricError, friends_of_friends};
use crate::points::{AnyPointCloud, PointCloud};

/// Vectors have three components, the last 0 in 2D; matrices stand by rows, in 2D with what plane strain has along the depth.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Snapshot {
    /// 2 or 3.
    pub dimension: usize,
    /// Time [s].
    pub time: f64,
    /// Spacing of the scene's grid [m], where it is known.
    pub spacing: Option<f64>,
    /// Numbers of the particles in their initial order.
    pub ids: Vec<u32>,
    /// Positions [m].
    pub positions: Vec<[f64; 3]>,
    /// Velocities [m/s].
    pub velocities: Option<Vec<[f64; 3]>>,
    /// Masses [kg].
    pub masses: Option<Vec<f64>>,
    /// Rest volumes [m^D].
    pub volumes: Option<Vec<f64>>,
    /// Plastic volume ratios J_P.
    pub plastic_ratios: Option<Vec<f64>>,
    /// Elastic deformation gradients F_E.
    pub deformations: Option<Vec<[f64; 9]>>,
    /// Cauchy stresses tau / (J_E J_P) [Pa], J_E = det F_E: forces over areas as they are now (S13 section 6).
    pub stresses: Option<Vec<[f64; 9]>>,
    /// The fragment of each particle, 1 being the heaviest.
    pub fragments: Option<Vec<u32>>,
}

/// A quantity that particles have.
#[derive(Clone, Copy, Debug)]
pub struct Field<'a> {
    /// Its name in files.
    pub name: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// One value a particle.
    pub values: Values<'a>,
}

/// Values of a field.
#[derive(Clone, Copy, Debug)]
pub enum Values<'a> {
    /// Whole numbers.
    Labels(&'a [u32]),
    /// Numbers.
    Scalars(&'a [f64]),
    /// Vectors.
    Vectors(&'a [[f64; 3]]),
    /// Matrices by rows.
    Matrices(&'a [[f64; 9]]),
}

impl Values<'_> {
    /// Numbers a particle.
    pub fn components(&self) -> usize {
        match self {
            Values::Labels(_) | Values::Scalars(_) => 1,
            Values::Vectors(_) => 3,
            Values::Matrices(_) => 9,
        }
    }

    /// Component `k` of particle `p`.
    pub fn get(&self, p: usize, k: usize) -> f64 {
        match self {
            Values::Labels(values) => f64::from(values[p]),
            Values::Scalars(values) => values[p],
            Values::Vectors(values) => values[p][k],
            Values::Matrices(values) => values[p][k],
        }
    }
}

impl Snapshot {
    /// The particles of a run, in the order of their ids; `materials` are the scene's.
    pub fn of_state<T: Real, const D: usize>(
        state: &State<T, D>,
        materials: &[Material<T>],
        spacing: f64,
    ) -> Self {
        let order = state.by_id();
        let (motion, constants) = (&state.motion, &state.constants);
        let scalars = |values: &[T]| Some(order.iter().map(|&p| values[p].as_f64()).collect());
        let stress = |p: usize| {
            let material = &materials[usize::from(constants.material[p])];
            cauchy(material, &motion.deformation[p], motion.stiffness[p], motion.plastic_ratio[p])
        };
        Snapshot {
            dimension: D,
            time: state.time,
            spacing: Some(spacing),
            ids: order.iter().map(|&p| constants.id[p]).collect(),
            positions: order.iter().map(|&p| padded(&state.world_position(p))).collect(),
            velocities: Some(
                order.iter().map(|&p| padded(&motion.velocity[p].map(|v| v.as_f64()))).collect(),
            ),
            masses: scalars(&constants.mass),
            volumes: scalars(&constants.volume),
            plastic_ratios: scalars(&motion.plastic_ratio),
            deformations: Some(
                order.iter().map(|&p| by_rows(&motion.deformation[p].map(|f| f.as_f64()), 1.0)).collect(),
            ),
            stresses: Some(order.iter().map(|&p| stress(p)).collect()),
            fragments: None,
        }
    }

    /// Frame number `number` of a case, which keeps positions and J_P.
    pub fn of_case<const D: usize>(frames: &Frames<D>, number: usize, spacing: f64) -> Self {
        let frame = &frames.frames[number];
        Snapshot {
            dimension: D,
            time: frame.time,
            spacing: Some(spacing),
            ids: (0..frame.positions.len() as u32).collect(),
            positions: frame.points().iter().map(|point| padded(&(point + frames.origin))).collect(),
            masses: Some(frames.masses.clone()),
            plastic_ratios: Some(frame.plastic_ratios.iter().map(|&j| f64::from(j)).collect()),
            ..Snapshot::default()
        }
    }

    /// The points of a file.
    pub fn of_points(cloud: &AnyPointCloud) -> Self {
        match cloud {
            AnyPointCloud::Two(cloud) => Self::of_cloud(cloud),
            AnyPointCloud::Three(cloud) => Self::of_cloud(cloud),
        }
    }

    fn of_cloud<const D: usize>(cloud: &PointCloud<D>) -> Self {
        let vectors = |values: &[Vector<f64, D>]| values.iter().map(padded).collect::<Vec<_>>();
        Snapshot {
            dimension: D,
            ids: (0..cloud.positions.len() as u32).collect(),
            positions: vectors(&cloud.positions),
            velocities: cloud.velocities.as_deref().map(vectors),
            masses: cloud.masses.clone(),
            volumes: cloud.volumes.clone(),
            plastic_ratios: cloud.plastic_ratios.clone(),
            deformations: cloud
                .deformations
                .as_ref()
                .map(|all| all.iter().map(|f| by_rows(f, 1.0)).collect()),
            ..Snapshot::default()
        }
    }

    /// Finds the fragments by friends-of-friends at `link` [m]; particles without a mass weigh the same.
    ///
    /// # Errors
    /// As [`friends_of_friends`].
    pub fn find_fragments(&mut self, link: f64) -> Result<(), MetricError> {
        let equal = || vec![1.0; self.positions.len()];
        let masses = self.masses.clone().unwrap_or_else(equal);
        let analysis = if self.dimension == 2 {
            let flat: Vec<_> = self.positions.iter().map(|x| Vector::<f64, 2>::new(x[0], x[1])).collect();
            friends_of_friends(&flat, &masses, link)
        } else {
            let points: Vec<_> = self.positions.iter().map(|x| Vector::<f64, 3>::from(*x)).collect();
            friends_of_friends(&points, &masses, link)
        }?;
        self.fragments = Some(analysis.labels().iter().map(|label| label + 1).collect());
        Ok(())
    }

    /// Between particles at rest [m], by their volumes; where they are not known, as if there were four to a cell.
    pub fn spacing_of_particles(&self) -> f64 {
        let count = self.positions.len().max(1) as f64;
        let d = self.dimension.max(1) as f64;
        let volume = self.volumes.as_ref().map(|volumes| volumes.iter().sum::<f64>() / count);
        let volume = volume.or(self.spacing.map(|h| libm::pow(h, d) / 4.0));
        libm::pow(volume.unwrap_or(1e-6), 1.0 / d)
    }

    /// What is known beside the positions.
    pub fn fields<'a>(&'a self) -> Vec<Field<'a>> {
        let mut fields = vec![Field { name: "id", unit: "-", values: Values::Labels(&self.ids) }];
        let mut add = |name, unit, values: Option<Values<'a>>| {
            fields.extend(values.map(|values| Field { name, unit, values }));
        };
        add("velocity", "m/s", self.velocities.as_deref().map(Values::Vectors));
        add("mass", "kg", self.masses.as_deref().map(Values::Scalars));
        add("volume", "m^D", self.volumes.as_deref().map(Values::Scalars));
        add("jp", "-", self.plastic_ratios.as_deref().map(Values::Scalars));
        add("deformation", "-", self.deformations.as_deref().map(Values::Matrices));
        add("stress", "Pa", self.stresses.as_deref().map(Values::Matrices));
        add("fragment", "-", self.fragments.as_deref().map(Values::Labels));
        fields
    }
}

/// Cauchy stress tau / (J_E J_P) [Pa] of snow with elastic deformation gradient `f` (S13 section 6). In plane strain the depth is not stretched: of the law only the
/// pressure is left along it.
fn cauchy<T: Real, const D: usize>(
    material: &Material<T>,
    f: &Matrix<T, D>,
    stiffness: T,
    plastic_ratio: T,
) -> [f64; 9] {
    let j = determinant(f);
    let tau = material.kirchhoff(f, stiffness);
    let lame = ConstitutiveModel::<T, D>::lame(material);
    let along = stiffness * lame.lambda * (j - T::one()) / plastic_ratio;
    by_rows(&tau.map(|value| (value / (j * plastic_ratio)).as_f64()), along.as_f64())
}

fn padded<const D: usize>(vector: &Vector<f64, D>) -> [f64; 3] {
    std::array::from_fn(|k| if k < D { vector[k] } else { 0.0 })
}

/// By rows; in 2D with `along` as the entry of the depth.
fn by_rows<const D: usize>(matrix: &Matrix<f64, D>, along: f64) -> [f64; 9] {
    std::array::from_fn(|n| match (n / 3, n % 3) {
        (i, j) if i < D && j < D => matrix[(i, j)],
        (2, 2) => along,
        _ => 0.0,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use snowlab_solver::{Elastic, Lame};

    /// Snow in plane strain is snow in space whose depth is not stretched: all nine stresses are those of the law in space.
    #[test]
    fn the_stress_of_plane_strain_is_that_of_space_without_stretch_along_the_depth() {
        let material = Material::Elastic(Elastic { lame: Lame::from_young(1.4e5, 0.2) });
        let flat = Matrix::<f64, 2>::new(1.04, 0.03, -0.06, 0.97);
        let mut space = Matrix::<f64, 3>::identity();
        space.fixed_view_mut::<2, 2>(0, 0).copy_from(&flat);
        let (a, b) = (cauchy(&material, &flat, 1.3, 0.9), cauchy(&material, &space, 1.3, 0.9));
        assert!(b[8].abs() > 10.0 && b[0].abs() > 10.0, "there is a stress to compare: {b:?}");
        for (a, b) in a.iter().zip(b) {
            assert!((a - b).abs() < 1e-9 * 1.4e5, "{a} {b}");
        }
    }
}
