//! Small clips for unit tests.

use inkrig_motion::glam::{Quat, Vec3};
use inkrig_motion::{Clip, Joint, Skeleton, TranslationTrack};
use std::sync::Arc;

/// Walks ahead and swings an arm, more and more widely, then turns.
pub(crate) fn swinging(seconds: f64, rate: f64) -> Clip {
    let skeleton = Skeleton::new(vec![
        Joint::new("hips", None, Vec3::ZERO),
        Joint::new("arm", Some(0), Vec3::Y * 0.5),
        Joint::new("hand", Some(1), Vec3::X * 0.4),
        Joint::end("hand_end", 2, Vec3::X * 0.2),
    ]);
    let frames = (seconds * rate).round() as usize + 1;
    let (mut rotations, mut values) = (Vec::new(), Vec::new());
    for frame in 0..frames {
        let t = frame as f32 / rate as f32;
        let swing = (0.2 + 0.1 * t) * (4.0 * t).sin();
        rotations.extend([
            Quat::from_rotation_y(0.1 * t * t),
            Quat::from_rotation_z(swing),
            Quat::from_rotation_z(0.5 * swing) * Quat::from_rotation_x(0.3 * (1.7 * t).cos()),
            Quat::IDENTITY,
        ]);
        values.push(Vec3::new(0.2 * t, 0.9 + 0.02 * (8.0 * t).sin(), t));
    }
    let track = TranslationTrack { joint: 0, values };
    Clip::new(Arc::new(skeleton.unwrap()), rate, rotations, vec![track]).unwrap()
}
