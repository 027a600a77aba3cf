//! Stored results of the published code, where they are at hand.
#![allow(dead_code, clippy::unwrap_used, clippy::panic, clippy::print_stdout, reason = "shared by tests")]

use safetensors::{Dtype, SafeTensors};
use std::path::PathBuf;

/// One file of the reference folder.
pub(crate) struct Vectors {
    bytes: Vec<u8>,
}

impl Vectors {
    /// `None`, said in one line, where the folder is not there.
    pub(crate) fn open(name: &str) -> Option<Self> {
        let beside = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared");
        let folder =
            std::env::var_os("INKRIG_REFERENCE").map_or_else(|| PathBuf::from(beside), PathBuf::from);
        let file = folder.join("vectors/sketch2anim").join(name).with_extension("safetensors");
        match std::fs::read(&file) {
            Ok(bytes) => Some(Self { bytes }),
            Err(error) => {
                assert_ne!(std::env::var("CI").as_deref(), Ok("true"), "{}: {error}", file.display());
                println!("skipped: no reference vectors at {}", file.display());
                None
            }
        }
    }

    /// Those of a file of this repository.
    pub(crate) fn of(bytes: &[u8]) -> Self {
        Self { bytes: bytes.to_vec() }
    }

    pub(crate) fn shape(&self, name: &str) -> Vec<usize> {
        SafeTensors::deserialize(&self.bytes).unwrap().tensor(name).unwrap().shape().to_vec()
    }

    /// Numbers of any kind; truth is 1.
    pub(crate) fn numbers(&self, name: &str) -> Vec<f32> {
        let file = SafeTensors::deserialize(&self.bytes).unwrap();
        let tensor = file.tensor(name).unwrap_or_else(|_| panic!("{name}"));
        let data = tensor.data();
        match tensor.dtype() {
            Dtype::F32 => data.chunks_exact(4).map(|b| f32::from_le_bytes(b.try_into().unwrap())).collect(),
            Dtype::F64 => {
                data.chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().unwrap()) as f32).collect()
            }
            Dtype::I64 => {
                data.chunks_exact(8).map(|b| i64::from_le_bytes(b.try_into().unwrap()) as f32).collect()
            }
            Dtype::BOOL => data.iter().map(|&b| f32::from(b)).collect(),
            other => panic!("{name} is {other:?}"),
        }
    }

    pub(crate) fn whole(&self, name: &str) -> Vec<usize> {
        self.numbers(name).into_iter().map(|x| x as usize).collect()
    }
}

/// The largest difference, as a part of the largest number that was expected.
pub(crate) fn off(got: &[f32], expected: &[f32]) -> f32 {
    assert_eq!(got.len(), expected.len());
    let size = expected.iter().fold(0.0_f32, |most, x| most.max(x.abs()));
    got.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max) / size.max(f32::MIN_POSITIVE)
}

/// Fails, with a name, when numbers are further off than they may be; says how far in any case.
pub(crate) fn assert_near(what: &str, got: &[f32], expected: &[f32], most: f32) {
    let off = off(got, expected);
    println!("{what}: {off:.1e} of the largest number off at most");
    assert!(off < most, "{what}: {off:e}, allowed {most:e}");
}
