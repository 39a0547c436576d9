//! The fragments of any file of points, whoever made it: what `snowlab fragments` prints.

use std::fmt;
use std::path::{Path, PathBuf};

use serde::Serialize;
use thiserror::Error;

use crate::metrics::error::LENGTH_RANGE;
use crate::metrics::{FragmentAnalysis, MetricError, friends_of_friends};
use crate::points::{AnyPointCloud, PointCloud, PointsError, read_any};

/// The least share of the mass of a fragment that is not dust, where none is given: the m_cut of the studies.
pub const DEFAULT_MIN_MASS_SHARE: f64 = 0.002;

/// Sizes that the plain text lists. Chosen: one line.
const SIZES_LISTED: usize = 12;

/// The fragments of a file of points. Serialised, its fields are the keys of `--json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FragmentReport {
    /// The file, as it was named.
    pub file: String,
    /// The number of points.
    pub points: usize,
    /// 2 or 3; 2 where every z is 0.
    pub dimension: usize,
    /// Whether masses come from the file; else every point has mass 1.
    pub masses_from_file: bool,
    /// Linking length [the file's unit of length, in our own files m].
    pub link: f64,
    /// The number of fragments of any size.
    pub fragments: usize,
    /// Points in the fragment that has most of them; 0 without points.
    pub largest: usize,
    /// Mass share of the heaviest fragment, M_1/M; 0 without points.
    pub largest_share: f64,
    /// N_eff = 1 / sum (M_k/M)^2 over all fragments; 0 without points.
    pub effective_number: f64,
    /// The least mass share of a fragment that is not dust.
    pub min_mass_share: f64,
    /// The number of fragments with at least that share.
    pub fragments_above_cut: usize,
    /// The mass share of all the others.
    pub dust_share: f64,
    /// Points per fragment, descending.
    pub sizes: Vec<usize>,
}

/// Why the fragments of a file cannot be told.
#[derive(Debug, Error)]
pub enum FragmentsError {
    /// The file cannot be used.
    #[error(transparent)]
    Points(#[from] PointsError),
    /// The metric refuses its points.
    #[error("{}: {refusal}", path.display())]
    Metric {
        /// The file.
        path: PathBuf,
        /// What is refused.
        refusal: MetricError,
    },
    /// The link is no length.
    #[error(
        "`--link` is {value:?}; allowed: above 0, at most {:e}: the distance within which points are joined, in \
         their unit of length",
        LENGTH_RANGE[1]
    )]
    Link {
        /// The value given.
        value: f64,
    },
    /// The least mass share is no share.
    #[error("`--min-mass-share` is {value:?}; allowed: 0 to 1, such as {DEFAULT_MIN_MASS_SHARE}")]
    MinMassShare {
        /// The value given.
        value: f64,
    },
}

/// Reads the points of a CSV or PLY file, in 2D or 3D as the file has it, and finds their fragments by
/// [`friends_of_friends`] at linking length `link`, in the file's unit of length. Points weigh what the file's column
/// `mass` says, else 1 each. Fragments of less than `min_mass_share` of the mass are dust. A file of no points has no
/// fragments.
///
/// # Errors
/// A file that cannot be used; a link that is not finite and positive; a least mass share outside 0 to 1.
pub fn fragments_of_file(
    path: &Path,
    link: f64,
    min_mass_share: f64,
) -> Result<FragmentReport, FragmentsError> {
    if !(link > 0.0 && (LENGTH_RANGE[0]..=LENGTH_RANGE[1]).contains(&link)) {
        return Err(FragmentsError::Link { value: link });
    }
    if !(0.0..=1.0).contains(&min_mass_share) {
        return Err(FragmentsError::MinMassShare { value: min_mass_share });
    }
    let (dimension, masses_from_file, analysis) = match read_any(path)? {
        AnyPointCloud::Two(cloud) => (2, cloud.masses.is_some(), analyse(cloud, link)),
        AnyPointCloud::Three(cloud) => (3, cloud.masses.is_some(), analyse(cloud, link)),
    };
    let analysis = analysis.map_err(|refusal| FragmentsError::Metric { path: path.into(), refusal })?;
    let cut = least_mass_above(&analysis, min_mass_share);
    let mut sizes = analysis.particle_counts().to_vec();
    sizes.sort_unstable_by(|a, b| b.cmp(a));
    Ok(FragmentReport {
        file: path.display().to_string(),
        points: sizes.iter().sum(),
        dimension,
        masses_from_file,
        link,
        fragments: analysis.components(),
        largest: sizes.first().copied().unwrap_or(0),
        largest_share: analysis.largest_share(),
        effective_number: analysis.effective_number(),
        min_mass_share,
        fragments_above_cut: analysis.count(cut),
        dust_share: analysis.dust_share(cut),
        sizes,
    })
}

fn analyse<const D: usize>(cloud: PointCloud<D>, link: f64) -> Result<FragmentAnalysis, MetricError> {
    let masses = cloud.masses.unwrap_or_else(|| vec![1.0; cloud.positions.len()]);
    friends_of_friends(&cloud.positions, &masses, link)
}

/// The mass of the lightest fragment with at least `share` of the mass, infinity without one. The quotient M_k/M is
/// compared, and not M_k with the product share * M: it alone rounds 3/30 to the same number as 0.1.
fn least_mass_above(analysis: &FragmentAnalysis, share: f64) -> f64 {
    let above = analysis.shares().take_while(|&own| own >= share).count();
    above.checked_sub(1).map_or(f64::INFINITY, |last| analysis.masses()[last])
}

impl fmt::Display for FragmentReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let masses = if self.masses_from_file { "masses of the file" } else { "equal masses" };
        writeln!(
            f,
            "{}: {} points in {}D, {masses}, link {}",
            self.file, self.points, self.dimension, self.link
        )?;
        let percent = |share: f64| format!("{:.4} %", 100.0 * share);
        writeln!(f, "  fragments         {}", self.fragments)?;
        writeln!(
            f,
            "  above the cut     {}, with {} of the mass or more",
            self.fragments_above_cut,
            percent(self.min_mass_share)
        )?;
        writeln!(f, "  dust              {} of the mass", percent(self.dust_share))?;
        writeln!(f, "  effective number  {:.4}", self.effective_number)?;
        writeln!(f, "  largest           {} points", self.largest)?;
        writeln!(f, "  heaviest          {} of the mass", percent(self.largest_share))?;
        let listed: Vec<String> = self.sizes.iter().take(SIZES_LISTED).map(usize::to_string).collect();
        write!(f, "  points in each    {}", listed.join(" "))?;
        match self.sizes.len().saturating_sub(SIZES_LISTED) {
            0 => Ok(()),
            more => write!(f, " and {more} more"),
        }
    }
}
