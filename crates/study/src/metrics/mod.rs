//! Fragments: what has broken into what, measured six ways, since the ruler matters as much as the snow.
//!
//! | metric | joined are | file |
//! |---|---|---|
//! | friends-of-friends | particles at most a link apart | [`mod@friends_of_friends`] |
//! | bond graph | particles bonded at t = 0 whose bond still holds | [`mod@bond_graph`] |
//! | flood fill | raster cells dense enough, side by side | [`mod@flood_fill`] |
//! | kernel graph | particles that share a grid node | [`mod@kernel_graph`] |
//! | N(link) | friends-of-friends at every link at once | [`mod@link_curve`] |
//!
//! Each yields a [`FragmentAnalysis`], from which the study's endpoints are
//! read. Whether a metric may be believed is asked by the [`gate`] at t = 0 and by the [`calibration`] under
//! stretch; arms of different particle numbers are made equal by [`thinning`]. [`spread`] and [`sizes`]
//! measure the debris and its pieces. [`oracle`] restates each definition over all pairs, for the tests.
//!
//! All lengths are in metres, all arithmetic is f64, the dimension `D` is 2 or 3. Bad input is refused with a
//! [`MetricError`]; no input makes a metric panic.

pub mod bond_graph;
pub mod calibration;
pub mod cell_list;
pub mod error;
pub mod exact_sum;
pub mod flood_fill;
pub mod fragments;
pub mod friends_of_friends;
pub mod gate;
pub mod interior;
pub mod kernel_graph;
pub mod link_curve;
pub mod oracle;
pub mod sizes;
pub mod spread;
pub mod thinning;
pub mod union_find;

pub use bond_graph::{BondAnalysis, BondGraph, InteriorDegree};
pub use calibration::{breaking_stretch, stretch_curve, stretches_agree};
pub use error::MetricError;
pub use flood_fill::{FloodRaster, flood_fill};
pub use fragments::{FragmentAnalysis, equivalent_diameter};
pub use friends_of_friends::friends_of_friends;
pub use gate::{Gate, GateVerdict, least_random_particles_per_cell};
pub use kernel_graph::kernel_graph;
pub use link_curve::{LinkCurve, LinkState};
pub use sizes::{BandPoint, Ordinate, distribution_band, mass_grid};
pub use spread::{Extent, Spread, mass_shares_above};
pub use thinning::{Thinning, mean_over_subsets};
