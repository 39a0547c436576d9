//! Snow by the material point method (Stomakhin et al. 2013, "S13"; Park & Shen 2017, "PS17").
//!
//! The crate knows no file format, no clock, no random number and no study: it takes a [`Scene`] (what does not
//! change in a run) and a [`State`] (what does), and advances the state.

pub mod geometry;
