//! inkrig
fn main() {}
