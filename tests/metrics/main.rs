//! What the metrics of fragments must give, against definitions over all pairs, closed forms and shapes of known pieces.

mod against_oracle;
mod cracks;
mod debris;
mod fragments_command;
mod percolation;
mod shapes;
mod support;
