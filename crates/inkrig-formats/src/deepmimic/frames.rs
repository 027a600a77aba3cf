//! The rows of a motion.

use super::character::{Character, Kind};
use super::{Scale, error, unreadable, warning};
use crate::{Finding, FormatError, Limits, lexer::LARGEST_NUMBER};
use inkrig_motion::TranslationTrack;
use inkrig_motion::glam::{DQuat, DVec3, Quat, Vec3};
use serde::Deserialize;

/// A motion as the parts of a clip.
pub(super) struct Motion {
    pub(super) frame_rate: f64,
    pub(super) frame_time: Option<f64>,
    pub(super) rotations: Vec<Quat>,
    pub(super) translation: TranslationTrack,
}

#[derive(Deserialize)]
struct File {
    #[serde(rename = "Frames")]
    frames: Vec<Vec<f64>>,
}

/// Durations that a frame may have, seconds.
const DURATIONS: std::ops::RangeInclusive<f64> = 1e-5..=10.0;

pub(super) fn read(
    bytes: &[u8],
    character: &Character,
    scale: Scale,
    limits: &Limits,
    findings: &mut Vec<Finding>,
) -> Result<Motion, FormatError> {
    let hint = "a DeepMimic motion is JSON with Frames, a list of rows of numbers";
    let file: File =
        serde_json::from_slice(bytes).map_err(|cause| unreadable("deepmimic-json", &cause, hint))?;
    let (joints, width) = (character.joints.len(), character.width());
    let cells = file.frames.len().saturating_mul(joints);
    let limit = limits.cells_for(bytes.len());
    if cells > limit {
        return Err(FormatError::Limit {
            what: format!("{} frames of {joints} joints make {cells} rotations", file.frames.len()),
            limit,
            place: None,
            hint: "cut the motion into shorter ones".into(),
        });
    }
    for (index, row) in file.frames.iter().enumerate() {
        if row.len() != width {
            let what = format!("row {index} has {} numbers, the character needs {width}", row.len());
            let hint = "give the character that belongs to this motion";
            return Err(error("deepmimic-width", None, what, hint));
        }
        if row.iter().any(|number| number.abs() > LARGEST_NUMBER) {
            let what = format!("row {index} has a number beyond 1e12");
            return Err(error("deepmimic-number", None, what, "export the motion again"));
        }
    }
    let times = times(&file.frames)?;
    let steps = times.len() - 1;
    let mut durations: Vec<f64> =
        times.windows(2).filter_map(|pair| Some(pair.get(1)? - pair.first()?)).collect();
    durations.sort_by(f64::total_cmp);
    let usual = durations.get(steps / 2).copied().unwrap_or(1.0 / 30.0);
    let same = durations.iter().all(|duration| (duration / usual - 1.0).abs() < 1e-3);
    let mut motion = Motion {
        frame_rate: 1.0 / usual,
        frame_time: same.then_some(usual),
        rotations: Vec::new(),
        translation: TranslationTrack { joint: 0, values: Vec::new() },
    };
    let poses: Vec<(DVec3, Vec<DQuat>)> = file
        .frames
        .iter()
        .enumerate()
        .map(|(index, row)| pose(row, index, character))
        .collect::<Result<_, _>>()?;
    let last = times.last().copied().unwrap_or_default();
    let count = if same { poses.len() } else { (last / usual + 1e-6).floor() as usize + 1 };
    if !same {
        if count.saturating_mul(joints) > limit {
            let what = "frames of very unequal length".to_string();
            return Err(error("deepmimic-duration", None, what, "export the motion at an even rate"));
        }
        let message = format!(
            "frames are not of equal length; the motion was brought to {:.3} frames a second",
            1.0 / usual
        );
        findings.push(warning("deepmimic-duration", message));
    }
    for frame in 0..count {
        let time = if same { times.get(frame).copied().unwrap_or(last) } else { frame as f64 * usual };
        let after = times.partition_point(|&own| own <= time).clamp(1, steps.max(1));
        let pair = (times.get(after - 1), times.get(after), poses.get(after - 1), poses.get(after));
        let (place, turns) = match pair {
            (Some(&from), Some(&to), Some(a), Some(b)) if to > from => {
                between(a, b, ((time - from) / (to - from)).clamp(0.0, 1.0))
            }
            (_, _, Some(only), _) => only.clone(),
            _ => break,
        };
        let begin = motion.rotations.len();
        motion.rotations.resize(begin + joints, Quat::IDENTITY);
        for (mover, turn) in character.movers.iter().zip(turns) {
            if let Some(slot) = motion.rotations.get_mut(begin + mover.joint) {
                *slot = scale.up.clip_from_file_rotation(turn).as_quat();
            }
        }
        let place: Vec3 = scale.metres(place).as_vec3();
        motion.translation.values.push(place);
    }
    Ok(motion)
}

/// When each frame begins. The last one's duration means nothing.
fn times(rows: &[Vec<f64>]) -> Result<Vec<f64>, FormatError> {
    if rows.is_empty() {
        return Err(error(
            "deepmimic-no-frames",
            None,
            "there are no frames".into(),
            "export the motion again",
        ));
    }
    let mut times = vec![0.0];
    let mut time = 0.0;
    for (index, row) in rows.iter().enumerate().take(rows.len() - 1) {
        let duration = row.first().copied().unwrap_or_default();
        if !DURATIONS.contains(&duration) {
            let what = format!("frame {index} lasts {duration} s");
            return Err(error("deepmimic-duration", None, what, "durations go from 0.00001 to 10 seconds"));
        }
        time += duration;
        times.push(time);
    }
    Ok(times)
}

/// The root's place and the local rotations of a row, in the file's axes.
fn pose(row: &[f64], index: usize, character: &Character) -> Result<(DVec3, Vec<DQuat>), FormatError> {
    let mut rest = row.get(1..).unwrap_or_default();
    let mut take = |count: usize| {
        let (taken, left) = rest.split_at_checked(count).unwrap_or_default();
        rest = left;
        taken
    };
    let place = match take(3) {
        &[x, y, z] => DVec3::new(x, y, z),
        _ => DVec3::ZERO,
    };
    let mut turns = Vec::with_capacity(character.movers.len());
    for mover in &character.movers {
        let turn = match mover.kind {
            Kind::Fixed => DQuat::IDENTITY,
            Kind::Revolute => DQuat::from_rotation_z(take(1).first().copied().unwrap_or_default()),
            Kind::Root | Kind::Spherical => match take(4) {
                &[w, x, y, z] if w * w + x * x + y * y + z * z > 1e-12 => {
                    DQuat::from_xyzw(x, y, z, w).normalize()
                }
                _ => {
                    let name = character.joints.get(mover.joint).map(|joint| joint.name.as_str());
                    let what = format!("row {index} has a rotation of zero length");
                    return Err(error("deepmimic-rotation", name, what, "export the motion again"));
                }
            },
        };
        turns.push(mover.frame * turn);
    }
    Ok((place, turns))
}

fn between(a: &(DVec3, Vec<DQuat>), b: &(DVec3, Vec<DQuat>), part: f64) -> (DVec3, Vec<DQuat>) {
    if part == 0.0 {
        return a.clone();
    }
    if part == 1.0 {
        return b.clone();
    }
    (a.0.lerp(b.0, part), a.1.iter().zip(&b.1).map(|(a, b)| a.slerp(*b, part)).collect())
}
