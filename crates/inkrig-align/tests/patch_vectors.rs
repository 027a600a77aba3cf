//! Patch distances and blending against numbers computed elsewhere, in double precision.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may panic, and says when it is skipped")]

use inkrig_align::Layout;
use inkrig_align::blend::{Window, frame_weights};
use inkrig_align::patches::{PatchScratch, patch_distances};
use inkrig_transport::{Mat, matmul};
use std::path::PathBuf;

fn table(value: &serde_json::Value) -> Mat<f64> {
    let rows: Vec<Vec<f64>> = serde_json::from_value(value.clone()).unwrap();
    Mat::from_vec(rows.len(), rows[0].len(), rows.concat()).unwrap()
}

fn largest_difference(a: &Mat<f64>, b: &Mat<f64>) -> f64 {
    assert_eq!((a.rows(), a.cols()), (b.rows(), b.cols()));
    a.as_slice().iter().zip(b.as_slice()).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
}

#[test]
fn patch_blend() {
    let beside = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared");
    let folder = std::env::var_os("INKRIG_REFERENCE").map_or_else(|| PathBuf::from(beside), PathBuf::from);
    let file = folder.join("vectors/mamm/patch_blend.json");
    let Ok(bytes) = std::fs::read(&file) else {
        assert_ne!(std::env::var("CI").as_deref(), Ok("true"), "{} is missing", file.display());
        println!("skipped: reference vectors not found at {}", file.display());
        return;
    };
    let vectors: serde_json::Value = serde_json::from_slice(&bytes).unwrap();
    let patch = vectors["patch"].as_u64().unwrap() as usize;
    let (x, y) = (table(&vectors["x"]), table(&vectors["y"]));

    let mut distances = Mat::zeros(0, 0);
    let (rows, columns) = (Layout::open(y.rows(), patch), Layout::open(x.rows(), patch));
    let (motion, clip) = ((y.view(), &rows), (x.view(), &columns));
    patch_distances(motion, clip, 1.0, &mut PatchScratch::new(), &mut distances, 1).unwrap();
    let error = largest_difference(&distances, &table(&vectors["patch_dist"]));
    println!("largest difference of patch distances: {error:e}");
    assert!(error < 1e-10);

    let mut plan = table(&vectors["T_rows_sum_1"]);
    let mass = 1.0 / plan.rows() as f64;
    plan.as_mut_slice().iter_mut().for_each(|value| *value *= mass);
    let (mut weights, mut blended) = (Mat::zeros(0, 0), Mat::zeros(0, 0));
    frame_weights(plan.view(), (&rows, &columns), Window::Box, &mut weights, 1);
    matmul(weights.view(), x.view(), &mut blended, 1).unwrap();
    let error = largest_difference(&blended, &table(&vectors["blend"]));
    println!("largest difference of blended frames: {error:e}");
    assert!(error < 1e-10);
}
