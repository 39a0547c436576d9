//! Meshes that the tests make.
#![allow(dead_code, reason = "each test program uses its part")]

pub mod shapes;
pub mod written;
