//! Measures of a placement: spacing, spread of particles per cell and of the grid density, pair correlation.
