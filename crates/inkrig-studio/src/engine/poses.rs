//! Motions and plans as bytes for the page: little endian, quaternions as four 16-bit numbers.

use inkrig_motion::Clip;

/// What a block of poses is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PoseKind {
    /// A clip of the project.
    Clip = 0,
    /// A preview.
    Live = 1,
    /// A finished result.
    Result = 2,
}

/// What stands before the poses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoseHead {
    /// What it is of.
    pub kind: PoseKind,
    /// Revision of the document that it answers.
    pub revision: u32,
    /// Number of the stroke, 0 for none.
    pub stroke: u32,
    /// Messages of points of that stroke that are in it.
    pub message: u32,
    /// 1 is the coarsest.
    pub level: u16,
    /// Number of levels.
    pub levels: u16,
    /// No better one will come of this update.
    pub is_final: bool,
    /// The last frame is followed by the first.
    pub is_loop: bool,
    /// It went on from the last update.
    pub warm: bool,
    /// From the arrival of the newest message to now.
    pub milliseconds: f32,
    /// Control samples a second.
    pub sample_rate: f32,
}

impl PoseHead {
    /// For what is no answer to a stroke.
    pub fn of(kind: PoseKind, revision: u32, is_loop: bool) -> Self {
        Self {
            kind,
            revision,
            stroke: 0,
            message: 0,
            level: 1,
            levels: 1,
            is_final: true,
            is_loop,
            warm: false,
            milliseconds: 0.0,
            sample_rate: 0.0,
        }
    }
}

const MAGIC: u32 = 0x3150_4B49;

/// The poses of a clip. `used` says for every control sample which source frame it uses most.
pub fn encode(clip: &Clip, head: &PoseHead, used: &[u32]) -> Vec<u8> {
    let (frames, joints, tracks) = (clip.frames(), clip.skeleton().len(), clip.translations());
    let mut out = Vec::with_capacity(64 + frames * (joints * 8 + tracks.len() * 12) + 4 * used.len() + 8);
    let flags = u32::from(head.is_final)
        | u32::from(head.is_loop) << 1
        | u32::from(head.warm) << 2
        | u32::from(head.kind == PoseKind::Result) << 3;
    let integers = [
        MAGIC,
        head.kind as u32,
        head.revision,
        head.stroke,
        head.message,
        frames as u32,
        joints as u32,
        tracks.len() as u32,
    ];
    integers.into_iter().for_each(|value| out.extend(value.to_le_bytes()));
    out.extend((clip.frame_rate() as f32).to_le_bytes());
    out.extend(head.level.to_le_bytes());
    out.extend(head.levels.to_le_bytes());
    out.extend(flags.to_le_bytes());
    out.extend(head.milliseconds.to_le_bytes());
    out.extend((used.len() as u32).to_le_bytes());
    out.extend(head.sample_rate.to_le_bytes());
    out.extend([0; 8]);
    tracks.iter().for_each(|track| out.extend((track.joint as u16).to_le_bytes()));
    pad(&mut out);
    for frame in 0..frames {
        for track in tracks {
            let value = track.values.get(frame).copied().unwrap_or_default();
            value.to_array().into_iter().for_each(|number| out.extend(number.to_le_bytes()));
        }
    }
    for frame in 0..frames {
        for rotation in clip.rotations(frame) {
            let short = rotation.to_array().map(|number| (number.clamp(-1.0, 1.0) * 32767.0).round() as i16);
            short.into_iter().for_each(|number| out.extend(number.to_le_bytes()));
        }
    }
    pad(&mut out);
    used.iter().for_each(|frame| out.extend(frame.to_le_bytes()));
    out
}

fn pad(out: &mut Vec<u8>) {
    out.resize(out.len().next_multiple_of(4), 0);
}

#[cfg(test)]
mod tests {
    use super::*;
    use inkrig_motion::glam::{Quat, Vec3};
    use inkrig_motion::{Joint, Skeleton, TranslationTrack};
    use std::sync::Arc;

    #[test]
    fn poses_lie_where_the_page_looks_for_them() {
        let joints = vec![
            Joint::new("a", None, Vec3::ZERO),
            Joint::new("b", Some(0), Vec3::X),
            Joint::end("c", 1, Vec3::Y),
        ];
        let turn = Quat::from_rotation_z(0.5);
        let track = TranslationTrack { joint: 0, values: vec![Vec3::new(1.0, 2.0, 3.0), Vec3::ZERO] };
        let rotations = vec![turn, Quat::IDENTITY, Quat::IDENTITY, Quat::IDENTITY, turn, Quat::IDENTITY];
        let clip = Clip::new(Arc::new(Skeleton::new(joints).unwrap()), 60.0, rotations, vec![track]).unwrap();
        let head = PoseHead {
            stroke: 7,
            level: 2,
            levels: 4,
            sample_rate: 30.0,
            ..PoseHead::of(PoseKind::Live, 9, true)
        };
        let bytes = encode(&clip, &head, &[5, 6]);
        let int = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
        let float = |at: usize| f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
        let short = |at: usize| i16::from_le_bytes(bytes[at..at + 2].try_into().unwrap());
        assert_eq!((&bytes[..4], int(4), int(8), int(12)), (b"IKP1".as_slice(), 1, 9, 7));
        assert_eq!((int(20), int(24), int(28), float(32)), (2, 3, 1, 60.0));
        assert_eq!((short(36), short(38), int(40), int(48), float(52)), (2, 4, 3, 2, 30.0));
        let translations = 64 + 4;
        assert_eq!((float(translations), float(translations + 8)), (1.0, 3.0));
        let rotations = translations + 2 * 12;
        let second = rotations + (3 + 1) * 8;
        assert!((f32::from(short(second + 4)) / 32767.0 - turn.z).abs() < 2e-5);
        assert_eq!(bytes.len(), rotations + 6 * 8 + 2 * 4);
        assert_eq!(int(bytes.len() - 4), 6);
    }
}
