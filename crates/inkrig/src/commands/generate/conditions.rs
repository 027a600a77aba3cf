//! Files of key poses and trajectories in space.

use crate::commands::joint_map::nearest_names;
use crate::error::CliError;
use crate::load;
use crate::printable;
use inkrig_generate::guidance::Ask;
use inkrig_motion::glam::Vec3;
use inkrig_motion::humanml::{FRAME_RATE, JOINTS, Joints, NAMES, PARENTS, augment};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use std::collections::BTreeSet;
use std::path::Path;

/// How far a point may lie from the origin along an axis, metres.
const FARTHEST: f32 = 1000.0;

/// How many times longer or shorter than the model's the bones of a key pose may be: beyond that it is in other units.
const MOST_TIMES: f32 = 4.0;
/// How far from the origin a joint may be when the motion begins, metres, and how fast it may go away from there, metres a
/// second: a little more than the fastest runner.
const REACH: f32 = 4.0;
const FASTEST: f32 = 12.5;

/// A pose that a frame shall have; its joints are [augmented](augment) ones.
pub(super) struct KeyPose {
    pub(super) frame: usize,
    pub(super) joints: Joints,
}

/// Reads a key pose for a clip of some frames, of somebody of about the size of `bones`, each from its parent.
///
/// # Errors
/// When the file cannot be read, is no pose of 22 points, is of another size, or its frame lies beyond the clip.
pub(super) fn keypose(path: &Path, frames: usize, bones: &Joints) -> Result<KeyPose, CliError> {
    let bytes = load::drawing(path)?;
    parse_keypose(&bytes, frames, bones).map_err(|cause| CliError::Condition { path: path.into(), cause })
}

/// Reads trajectories for a clip of some frames.
///
/// # Errors
/// When the file cannot be read, names no joint, or asks for what the clip does not have.
pub(super) fn trajectory(path: &Path, frames: usize) -> Result<Vec<Ask>, CliError> {
    let bytes = load::drawing(path)?;
    parse_trajectory(&bytes, frames).map_err(|cause| CliError::Condition { path: path.into(), cause })
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a list of 22 points, or {\"frame\": 12, \"joints\": [22 points]}")]
struct PoseFile {
    #[serde(default)]
    frame: usize,
    joints: Vec<[f32; 3]>,
}

#[derive(Deserialize)]
#[serde(
    deny_unknown_fields,
    expecting = "{\"joint\": \"right_foot\", \"points\": [points]}, or a list of such"
)]
struct JointFile {
    joint: serde_json::Value,
    frames: Option<Vec<usize>>,
    points: Vec<[f32; 3]>,
}

fn parse_keypose(bytes: &[u8], frames: usize, bones: &Joints) -> Result<KeyPose, String> {
    let file: PoseFile =
        if is_list(bytes) { PoseFile { frame: 0, joints: json(bytes)? } } else { json(bytes)? };
    if file.joints.len() != JOINTS {
        return Err(format!(
            "it has {} joints, but a pose has {JOINTS}: {}",
            file.joints.len(),
            NAMES.join(", ")
        ));
    }
    check_frame(file.frame, frames)?;
    let mut joints = [Vec3::ZERO; JOINTS];
    for ((joint, numbers), name) in joints.iter_mut().zip(file.joints).zip(NAMES) {
        *joint = point(numbers, name)?;
    }
    let own: f32 = PARENTS.iter().zip(&joints).map(|(parent, joint)| joint.distance(joints[*parent])).sum();
    let usual: f32 = bones.iter().map(|bone| bone.length()).sum();
    if own > MOST_TIMES * usual {
        let times = own / usual.max(f32::MIN_POSITIVE);
        return Err(format!(
            "its bones are {times:.0} times as long as the body's ({own:.1} m in all, not about {usual:.1} m): are these centimetres? Give metres"
        ));
    }
    if own * MOST_TIMES < usual {
        return Err(format!(
            "its bones are {own:.2} m long in all, and the body's {usual:.1} m: its points lie too near to each other to be a pose. Give metres"
        ));
    }
    Ok(KeyPose { frame: file.frame, joints: augment(&joints) })
}

fn parse_trajectory(bytes: &[u8], frames: usize) -> Result<Vec<Ask>, String> {
    let files: Vec<JointFile> = if is_list(bytes) { json(bytes)? } else { vec![json(bytes)?] };
    let (mut asks, mut seen) = (Vec::new(), BTreeSet::new());
    for file in files {
        let joint = joint(&file.joint)?;
        let name = NAMES.get(joint).copied().unwrap_or_default();
        let places: Vec<usize> = file.frames.unwrap_or_else(|| (0..file.points.len()).collect());
        if places.len() != file.points.len() {
            return Err(format!("{name} has {} frames, but {} points", places.len(), file.points.len()));
        }
        for (frame, numbers) in places.into_iter().zip(file.points) {
            check_frame(frame, frames).map_err(|what| format!("{name}: {what}"))?;
            if !seen.insert((joint, frame)) {
                return Err(format!("{name} is given twice at frame {frame}: leave one out"));
            }
            let place = point(numbers, name)?;
            let seconds = frame as f32 / FRAME_RATE as f32;
            let most = REACH + FASTEST * seconds;
            if place.length() > most {
                return Err(format!(
                    "{name} is to be {:.0} m from the origin at frame {frame}, after {seconds:.1} s, where nobody gets farther than {most:.0} m: are these centimetres? Give metres",
                    place.length()
                ));
            }
            asks.push(Ask { frame, joint, place });
        }
    }
    if asks.is_empty() { Err("it has no point".into()) } else { Ok(asks) }
}

fn is_list(bytes: &[u8]) -> bool {
    bytes.trim_ascii_start().starts_with(b"[")
}

fn json<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, String> {
    serde_json::from_slice(bytes).map_err(|error| printable::json_error(&error))
}

fn check_frame(frame: usize, frames: usize) -> Result<(), String> {
    if frame < frames {
        return Ok(());
    }
    Err(format!("frame {frame} is beyond the motion, whose {frames} frames are counted from 0: see --length"))
}

fn point(numbers: [f32; 3], name: &str) -> Result<Vec3, String> {
    if numbers.iter().all(|number| (-FARTHEST..=FARTHEST).contains(number)) {
        return Ok(numbers.into());
    }
    Err(format!("{name} is at {numbers:?}: give metres, at most {FARTHEST} from the origin"))
}

/// A joint by its name, in any case and with blanks for underscores, or by its number.
fn joint(said: &serde_json::Value) -> Result<usize, String> {
    if let Some(number) = said.as_u64() {
        let joint = usize::try_from(number).ok().filter(|joint| *joint < JOINTS);
        return joint.ok_or_else(|| format!("there is no joint {number}: they are 0 to {}", JOINTS - 1));
    }
    let said = said.as_str().ok_or("a joint is a name such as \"right_foot\", or a number")?;
    let plain = said.trim().to_lowercase().replace([' ', '-'], "_");
    NAMES.iter().position(|name| *name == plain).ok_or_else(|| {
        let near = nearest_names(NAMES.into_iter(), &plain).join(", ");
        format!("there is no joint {}; the nearest names are {near}", printable::text(said))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pose(first: &str) -> String {
        format!("[{first}{}]", ",[0,1,0]".repeat(JOINTS - 1))
    }

    fn parse_keypose(bytes: &[u8], frames: usize) -> Result<KeyPose, String> {
        super::parse_keypose(bytes, frames, &[0.15 * Vec3::Y; JOINTS])
    }

    #[test]
    fn poses_and_trajectories_are_read_in_all_their_forms() {
        let list = parse_keypose(pose("[1,2,3]").as_bytes(), 40).unwrap();
        assert_eq!((list.frame, list.joints[0]), (0, Vec3::new(1.0, 2.0, 3.0)));
        let at = format!(" {{\"frame\": 39, \"joints\": {}}}", pose("[1,2,3]"));
        assert_eq!(parse_keypose(at.as_bytes(), 40).unwrap().frame, 39);
        let several = br#"[{"joint": "Right Foot", "frames": [7, 3], "points": [[1,0,0],[2,0,0]]},
                           {"joint": 0, "points": [[0,1,0]]}]"#;
        let asks = parse_trajectory(several, 8).unwrap();
        let plain: Vec<_> = asks.iter().map(|ask| (ask.frame, ask.joint, ask.place.x)).collect();
        assert_eq!(plain, [(7, 11, 1.0), (3, 11, 2.0), (0, 0, 0.0)]);
    }

    #[test]
    fn what_is_wrong_is_said() {
        for (text, part) in [
            (pose("[NaN,0,0]"), "line 1"),
            (pose("[1e999,0,0]"), "out of range"),
            (pose("[1e300,0,0]"), "out of range"),
            (pose("[1e30,0,0]"), "pelvis is at"),
            (pose("[1,2]"), "length 2"),
            (pose("[0,100,0]"), "are these centimetres"),
            (pose("[0,1,0]"), "too near to each other"),
            ("[]".into(), "0 joints, but a pose has 22"),
            (String::new(), "line 1"),
            (format!("{{\"frame\": 40, \"joints\": {}}}", pose("[0,0,0]")), "frame 40 is beyond"),
            (format!("{{\"frame\": -1, \"joints\": {}}}", pose("[0,0,0]")), "-1"),
            (format!("{{\"joint\": {}}}", pose("[0,0,0]")), "unknown field `joint`"),
            ("[".repeat(100_000), "line 1"),
        ] {
            let error = parse_keypose(text.as_bytes(), 40).map(|_| ()).unwrap_err();
            assert!(error.contains(part), "{part}: {error}");
        }
        for (text, part) in [
            (r#"{"joint": "rigth_foot", "points": [[0,0,0]]}"#, "nearest names are right_foot"),
            (r#"{"joint": 22, "points": [[0,0,0]]}"#, "0 to 21"),
            (r#"{"joint": -1, "points": [[0,0,0]]}"#, "a name such as"),
            (r#"{"joint": null, "points": [[0,0,0]]}"#, "a name such as"),
            (r#"{"joint": "head", "points": []}"#, "no point"),
            ("[]", "no point"),
            (r#"{"joint": "head", "frames": [1], "points": [[0,0,0],[0,0,0]]}"#, "1 frames, but 2 points"),
            (r#"{"joint": "head", "frames": [4], "points": [[0,0,0]]}"#, "frame 4 is beyond"),
            (r#"{"joint": "head", "frames": [1, 1], "points": [[0,0,0],[0,0,0]]}"#, "twice at frame 1"),
            (r#"{"joint": "head", "points": [[0,NaN,0]]}"#, "line 1"),
            (r#"{"joint": "head", "points": [[0,-1e30,0]]}"#, "at most 1000"),
            (r#"{"joint": "head", "points": [[10,160,5]]}"#, "are these centimetres"),
        ] {
            let error = parse_trajectory(text.as_bytes(), 4).unwrap_err();
            assert!(error.contains(part), "{part}: {error}");
        }
    }
}
