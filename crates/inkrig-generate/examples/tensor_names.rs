//! Names and shapes of all tensors of a model as published, one a line:
//!
//!     cargo run -p inkrig-generate --example tensor_names
#![allow(clippy::print_stdout, reason = "an example")]

use inkrig_generate::networks::{Parts, Sizes, tensors};

fn main() {
    for spec in tensors(&Sizes::full(), Parts::ALL) {
        let shape: Vec<String> = spec.shape.iter().map(ToString::to_string).collect();
        println!("{}\t{}", spec.name, shape.join(","));
    }
}
