//! Real walks as few keys.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "functions beside the tests may fail too, and print"
)]

mod common;

use inkrig_formats::{ExportOptions, ImportOptions, no_files, read_bvh, read_gltf, write_glb};
use inkrig_motion::{
    keyframes::{SparseOptions, deviation, sparse},
    lead_in, time,
};

/// A millimetre and half a degree on every frame, with a quarter of the keys: one of each is a rotation or a translation of
/// one joint, and channels that never change do not count. All of them as they come out of the file that is written.
#[test]
fn walks_need_a_quarter_of_their_keys() {
    let Some(files) = common::reference_files("bvh") else { return };
    // The last is short, quick, and noisier than the others.
    let walks = ["07/07_02", "07/07_03", "35/35_01", "35/35_12", "35/35_29", "07/07_12"];
    println!(
        "{:<10}{:>8}{:>10}{:>8}{:>8}{:>8}{:>8}{:>9}{:>8}",
        "walk", "frames", "channels", "dense", "keys", "%", "mm", "degrees", "smooth"
    );
    for name in walks {
        let path = files.iter().find(|file| file.ends_with(format!("cmu/{name}.bvh"))).unwrap();
        let clip = read_bvh(&std::fs::read(path).unwrap(), &ImportOptions::default()).unwrap().clip;
        // In some channels nothing moves but from the rest pose to the walk.
        let clip = time::trim(&clip, lead_in::rest_pose_frames(&clip)..clip.frames()).unwrap();
        let keyed = sparse(&clip, &SparseOptions::default());
        let count = keyed.count();
        let options = ExportOptions { keys: Some(keyed.clone()), ..ExportOptions::default() };
        let written = write_glb(&keyed.clip().unwrap(), &options).unwrap();
        let rate = ImportOptions { frame_rate: Some(clip.frame_rate()), ..ImportOptions::default() };
        let back = read_gltf(&written.bytes, &rate, &no_files).unwrap().clip;
        let apart = deviation(&clip, &back).unwrap();
        let percent = 100.0 * count.keys as f64 / count.dense as f64;
        println!(
            "{name:<10}{:>8}{:>10}{:>8}{:>8}{percent:>8.1}{:>8.3}{:>9.3}{:>8.2}",
            clip.frames(),
            count.channels,
            count.dense,
            count.keys,
            1e3 * apart.metres,
            apart.radians.to_degrees(),
            count.smooth as f64 / count.keys as f64
        );
        assert!(apart.metres <= 1e-3 && apart.radians <= 0.5_f64.to_radians(), "{name}: {apart:?}");
        assert!(4 * count.keys <= count.dense, "{name}: {count:?}");
    }
}
