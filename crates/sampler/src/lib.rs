//! Placements of material points.
