//! The `snowlab` command line.

fn main() {}
