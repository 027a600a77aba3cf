//! On a character that somebody else made.

use crate::support::{MODEL, board, generated, understood};
use inkrig_formats::{Format, ImportOptions, no_files, read_motion};
use inkrig_motion::retarget::{Certificate, CertificateLimits, RetargetOptions, retarget, standing_pose};
use inkrig_storyboard::{Exact, MeetOptions, animation};
use std::path::PathBuf;

#[test]
fn a_storyboard_goes_onto_a_character_with_a_certificate() {
    let Some(bytes) = reference("creatures/human-model.glb") else { return };
    let model = &*MODEL;
    let read: Vec<_> = board("kick").frames.iter().map(|frame| understood(frame).unwrap()).collect();
    let clips: Vec<_> =
        read.iter().enumerate().map(|(at, read)| generated(read, at + 1, &model.sampling, true)).collect();
    let made = animation(&clips, None, &model.body, &Exact::Pin(MeetOptions::default())).unwrap();
    let character = read_motion(&bytes, Format::Glb, &ImportOptions::default(), &no_files).unwrap().clip;
    let options = RetargetOptions { stance: standing_pose(&character), ..RetargetOptions::default() };
    let moved = retarget(&made.clip, character.skeleton(), &options).unwrap();
    let certificate = Certificate::of(&made.clip, &moved);
    let broken = certificate.broken(&CertificateLimits::default());
    println!(
        "on human-model.glb: {} joints led, limits that are not kept: {broken:?}",
        certificate.pairs.len()
    );
    assert!(certificate.pairs.len() > 15 && moved.clip.frames() == made.clip.frames());
    assert!(broken.is_empty(), "{broken:?}");
}

pub(crate) fn reference(path: &str) -> Option<Vec<u8>> {
    let beside = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared");
    let folder = std::env::var_os("INKRIG_REFERENCE").map_or_else(|| PathBuf::from(beside), PathBuf::from);
    let file = folder.join("data").join(path);
    let read = std::fs::read(&file);
    assert!(read.is_ok() || std::env::var("CI").as_deref() != Ok("true"), "{}", file.display());
    if read.is_err() {
        println!("skipped: no reference data at {}", file.display());
    }
    read.ok()
}
