//! How far the end of a run is from that of another that is taken for the truth.

use std::collections::BTreeMap;

use super::nearest::Nearest;
use crate::record::HistoryRow;
use crate::results::{Archive, CaseResult};
use crate::store::StoreError;

/// Cells along the longest edge of the box round the particles at rest (chosen: R/8 for a ball; single particles are too coarse a sample).
const CELLS: f64 = 16.0;
/// Least share of the truth's particles in cells that have particles of the other run (chosen: cells at the surface may have none).
const COVERED: f64 = 0.9;

/// Relative errors; `None` where there is nothing to be relative to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// e_u: L2 of the mean displacement over material cells, beside the deformation there is (the displacement less its mean).
    pub deformation: Option<f64>,
    /// e_I: of the impulse on all obstacles.
    pub impulse: Option<f64>,
    /// e_W: of the energy lost to plastic flow.
    pub plastic: Option<f64>,
    /// e_K: of the kinetic energy.
    pub kinetic: Option<f64>,
}

/// The end of a run, by its particles.
pub struct Truth<const D: usize> {
    history: Option<HistoryRow>,
    start: Vec<[f32; D]>,
    moved: Vec<[f64; D]>,
    extents: [f64; D],
    /// Particles by material cell.
    cells: BTreeMap<[i64; D], f64>,
    /// Mean square of the displacement of cells less its mean [m^2].
    size: f64,
}

impl<const D: usize> Truth<D> {
    /// Reads the frames of a case.
    ///
    /// # Errors
    /// Frames that cannot be read.
    pub fn read(archive: &Archive, result: &CaseResult) -> Result<Self, StoreError> {
        let (start, moved) = displacements::<D>(archive, result)?;
        let extents = std::array::from_fn(|k| {
            let ends = |(least, greatest): (f64, f64), p: &[f32; D]| {
                (least.min(f64::from(p[k])), greatest.max(f64::from(p[k])))
            };
            let (least, greatest) = start.iter().fold((f64::INFINITY, f64::NEG_INFINITY), ends);
            greatest - least
        });
        let mut truth = Truth {
            history: result.record.history.last().cloned(),
            start,
            moved,
            extents,
            cells: BTreeMap::new(),
            size: 0.0,
        };
        let means = truth.means(&truth.start, |p, _| truth.moved[p]);
        let particles = truth.moved.len().max(1) as f64;
        let mean: [f64; D] =
            std::array::from_fn(|k| truth.moved.iter().map(|moved| moved[k]).sum::<f64>() / particles);
        let square = |moved: &[f64; D]| (0..D).map(|k| (moved[k] - mean[k]).powi(2)).sum::<f64>();
        truth.size = means.values().map(|(count, moved)| count * square(moved)).sum::<f64>() / particles;
        truth.cells = means.into_iter().map(|(cell, (count, _))| (cell, count)).collect();
        Ok(truth)
    }

    /// Errors of another run at its end.
    ///
    /// # Errors
    /// Frames that cannot be read.
    pub fn errors(&self, archive: &Archive, result: &CaseResult) -> Result<Errors, StoreError> {
        let (start, moved) = displacements::<D>(archive, result)?;
        let deformation = self.deformation_error(&start, &moved);
        let (Some(own), Some(theirs)) = (result.record.history.last(), &self.history) else {
            return Ok(Errors { deformation, ..Errors::default() });
        };
        let impulse = |row: &HistoryRow| -> Vec<f64> {
            (0..D).map(|k| row.impulses.iter().map(|impulse| impulse[k]).sum()).collect()
        };
        let norm = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let (own_impulse, their_impulse) = (impulse(own), impulse(theirs));
        let difference: Vec<f64> = own_impulse.iter().zip(&their_impulse).map(|(a, b)| a - b).collect();
        let relative = |own: f64, theirs: f64| (theirs > 0.0).then(|| (own - theirs).abs() / theirs);
        Ok(Errors {
            deformation,
            impulse: (norm(&their_impulse) > 0.0).then(|| norm(&difference) / norm(&their_impulse)),
            plastic: relative(own.plastic_loss, theirs.plastic_loss),
            kinetic: relative(own.kinetic, theirs.kinetic),
        })
    }

    /// Each particle is held against the nearest of the truth's, the means over cells of how far they are apart against the truth's deformation.
    fn deformation_error(&self, start: &[[f32; D]], moved: &[[f64; D]]) -> Option<f64> {
        let nearest = Nearest::new(&self.start, self.extents);
        let apart = self.means(start, |p, x| {
            nearest.of(x).map_or([f64::NAN; D], |n| std::array::from_fn(|k| moved[p][k] - self.moved[n][k]))
        });
        let (mut sum, mut covered, mut all) = (0.0, 0.0, 0.0);
        for (cell, count) in &self.cells {
            all += count;
            if let Some((_, apart)) = apart.get(cell) {
                covered += count;
                sum += count * apart.iter().map(|x| x * x).sum::<f64>();
            }
        }
        (self.size > 0.0 && covered >= COVERED * all).then(|| (sum / covered / self.size).sqrt())
    }

    /// Particles, and the mean of what `of` says of each, by material cell.
    fn means(
        &self,
        start: &[[f32; D]],
        of: impl Fn(usize, &[f32; D]) -> [f64; D],
    ) -> BTreeMap<[i64; D], (f64, [f64; D])> {
        let side = self.extents.iter().copied().fold(0.0, f64::max) / CELLS;
        let mut cells = BTreeMap::new();
        for (p, x) in start.iter().enumerate() {
            let (count, sum) =
                cells.entry(x.map(|x| (f64::from(x) / side).floor() as i64)).or_insert((0.0, [0.0; D]));
            *count += 1.0;
            let value = of(p, x);
            (0..D).for_each(|k| sum[k] += value[k]);
        }
        cells.into_iter().map(|(cell, (count, sum))| (cell, (count, sum.map(|x: f64| x / count)))).collect()
    }
}

/// Where particles were at first [m], and how far they have moved by the end [m].
type Displacements<const D: usize> = (Vec<[f32; D]>, Vec<[f64; D]>);

fn displacements<const D: usize>(
    archive: &Archive,
    result: &CaseResult,
) -> Result<Displacements<D>, StoreError> {
    let mut frames = archive.store.case(&result.key).read_frames::<D>()?.frames;
    let (Some(last), true) = (frames.pop(), !frames.is_empty()) else { return Ok((Vec::new(), Vec::new())) };
    let start = frames.swap_remove(0).positions;
    let moved = start.iter().zip(&last.positions);
    let moved = moved.map(|(a, b)| std::array::from_fn(|k| f64::from(b[k]) - f64::from(a[k]))).collect();
    Ok((start, moved))
}
