//! Statistics of the study: pure functions on plain values, the same bytes for the same input.
//!
//! Resampling draws from ChaCha8 with the seed given as an argument; `exp`, `ln` and the gamma and error
//! functions come from `libm`. Every function takes finite values; where a sample is too small for the
//! answer to exist the result is `None`.

mod bootstrap;
mod cliffs_delta;
mod descriptive;
mod distributions;
mod fieller;
mod holm;
mod incomplete;
mod interval;
mod operating_speed;
mod permutation;
mod proportion;
mod replicates;
mod student;
mod summary;

pub use bootstrap::Bootstrap;
pub use cliffs_delta::cliffs_delta;
pub use descriptive::{least_squares_slope, mean, median, quantile, standard_deviation};
pub use distributions::{
    beta_quantile, chi_square_cdf, chi_square_quantile, normal_cdf, normal_quantile, student_t_cdf,
    student_t_quantile,
};
pub use fieller::{FiellerSet, ratio_of_means};
pub use holm::holm_adjusted;
pub use interval::Interval;
pub use operating_speed::{OperatingSpeed, SpeedTrial, operating_speed};
pub use permutation::{range_of_means, range_permutation_p, sign_flip_p};
pub use proportion::{clopper_pearson, wilson};
pub use replicates::{ReplicatePlan, replicate_plan, standard_deviation_upper_limit};
pub use student::{t_interval, t_lower_bound, t_upper_bound};
pub use summary::{Summary, summarise};
