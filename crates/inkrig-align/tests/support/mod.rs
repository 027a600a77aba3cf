//! Real clips and sounds, and the gates that a result on them must pass.
#![allow(dead_code, reason = "every suite takes what it needs")]

use inkrig_align::{Alignment, Control, ControlKind, Options, Preset, Report, align};
use inkrig_formats::{ImportOptions, read_amc, read_bvh};
use inkrig_motion::{Clip, time};
use inkrig_sound::Sound;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

/// A clip of this project.
pub(crate) fn sample(name: &str) -> Clip {
    read_bvh(inkrig_samples::find(name).unwrap().bytes, &ImportOptions::default()).unwrap().clip
}

/// A motion of the reference folder; `None`, said in one line, where that is not there.
pub(crate) fn reference(path: &str) -> Option<Clip> {
    let bytes = bytes(path)?;
    if !path.ends_with(".amc") {
        return Some(read_bvh(&bytes, &ImportOptions::default()).unwrap().clip);
    }
    // Its skeleton is named by the folder: 05/05.asf.
    let folder = Path::new(path).parent().unwrap();
    let skeleton = folder.join(folder.file_name().unwrap()).with_extension("asf");
    let options = ImportOptions { skeleton: self::bytes(skeleton.to_str().unwrap()), ..Default::default() };
    Some(read_amc(&bytes, &options).unwrap().clip)
}

/// A file of the reference data; `None`, said in one line, where the folder is not there.
fn bytes(path: &str) -> Option<Vec<u8>> {
    let beside = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared");
    let folder = std::env::var_os("INKRIG_REFERENCE").map_or_else(|| PathBuf::from(beside), PathBuf::from);
    let file = folder.join("data").join(path);
    match std::fs::read(&file) {
        Ok(bytes) => Some(bytes),
        Err(error) => {
            assert_ne!(std::env::var("CI").as_deref(), Ok("true"), "{}: {error}", file.display());
            println!("skipped: no reference data at {}", file.display());
            None
        }
    }
}

/// The first seconds of a reference motion.
pub(crate) fn motion(path: &str, seconds: f64) -> Option<Clip> {
    let clip = reference(path)?;
    let frames = (seconds * clip.frame_rate()).round() as usize;
    Some(time::trim(&clip, 0..clip.frames().min(frames)).unwrap())
}

/// A reference sound.
pub(crate) fn sound(path: &str) -> Option<Sound> {
    Some(inkrig_sound::decode(&bytes(path)?, path.rsplit('.').next().unwrap()).unwrap().sound)
}

/// A control by the preset of its kind, its figures printed.
pub(crate) fn follow(name: &str, clip: &Clip, control: &Control) -> Alignment {
    follow_with(name, clip, control, &Options::for_control(control.kind, Preset::Follow))
}

/// The same with other options.
pub(crate) fn follow_with(name: &str, clip: &Clip, control: &Control, options: &Options) -> Alignment {
    let result = align(&clip.clone().into(), control, options, &mut |_| ControlFlow::Continue(())).unwrap();
    let r = &result.report;
    println!(
        "{name}: structure {:.2} (stretched {:.2}), nearest {:.2}, speed {:.2}, jump {:.2}, coverage {:.2}",
        r.structure_pearson,
        r.structure_pearson_warp,
        r.nearest_patch,
        r.speed_mean_ratio,
        r.jump_q999_ratio,
        r.coverage
    );
    if let Some(sound) = &r.sound {
        println!(
            "    before smoothing {:.2}; loudness {:.2} at {:+.2} s (stretched {:.2}), onsets {:.2} at {:+.2} s (stretched {:.2}), on the beat {:.2} (stretched {:.2})",
            sound.structure_pearson_unsmoothed,
            sound.loudness_correlation,
            sound.loudness_lag,
            sound.loudness_correlation_warp,
            sound.onset_correlation,
            sound.onset_lag,
            sound.onset_correlation_warp,
            sound.beat_alignment,
            sound.beat_alignment_warp
        );
    }
    result
}

/// What every result must reach: `least` is the structure that a published or independent reference has on this case,
/// less what two runs may differ by.
pub(crate) fn assert_gates(name: &str, kind: ControlKind, least: f64, report: &Report) {
    let gain = report.structure_pearson - report.structure_pearson_warp;
    assert!(gain >= 0.4, "{name}: only {gain:.3} above the stretched clip");
    assert!(report.structure_pearson >= least, "{name}: structure {:.3}", report.structure_pearson);
    let (near, slow) = if kind == ControlKind::Sound { (0.35, 0.5) } else { (0.30, 0.45) };
    assert!(report.nearest_patch <= near, "{name}: nearest patch {:.3}", report.nearest_patch);
    assert!(report.jump_q999_ratio <= 2.0, "{name}: jump {:.2}", report.jump_q999_ratio);
    let speed = report.speed_mean_ratio;
    assert!((slow..=2.0).contains(&speed), "{name}: speed {speed:.2}");
}
