//! What placements and void fields must do, against theory, plain sums over all pairs and pinned numbers.

mod errors;
mod gaussian_field;
mod heterogeneity;
mod lattices;
mod meshes;
mod placements;
mod poisson_disk;
mod quality;
mod regions;
mod streams;
mod support;
mod void_fields;

#[path = "../meshes/mod.rs"]
mod made;
