//! What hangs on the animal and follows late: tail and ears.

use super::{
    super::figure::{Pose, turn},
    Trunk,
    hound::TAIL,
};

impl Trunk {
    /// Turns the tail and the ears.
    pub(super) fn trail(&self, pose: &mut Pose<'_>, frame: usize) {
        let before = |values: &[f64], frames: f64| {
            let place = (frame as f64 - frames).max(0.0);
            let low = place.floor() as usize;
            let high = (low + 1).min(values.len() - 1);
            values[low] + (place - low as f64) * (values[high] - values[low])
        };
        for (index, name) in TAIL.into_iter().enumerate() {
            let late = 2.0 * index as f64;
            let fall = 1.0 - 0.15 * index as f64;
            let bounce = before(&self.bounce, late + 2.0) - before(&self.bounce, late + 5.0);
            let dragged = before(&self.headings[0], late + 6.0) - self.headings[0][frame];
            let rotation = turn(
                (0.35 * before(&self.wag, late) - 0.25 * dragged) * (0.6 + 0.2 * index as f64),
                0.28 * fall * before(&self.lift, late)
                    + 1.1 * bounce
                    + if index == 0 { -0.25 } else { -0.02 },
                0.0,
            );
            if let Some(joint) = pose.rig().find(name) {
                pose.local[joint] = rotation;
            }
        }
        let flap = before(&self.bounce, 1.0) - before(&self.bounce, 3.5);
        let laid = 0.12 * (before(&self.lift, 6.0) / 0.16).min(5.0);
        for (name, sign) in [("LeftEar", 1.0), ("RightEar", -1.0)] {
            if let Some(joint) = pose.rig().find(name) {
                pose.local[joint] = turn(0.0, -laid - 3.0 * flap, sign * (-0.1 - 2.0 * flap));
            }
        }
    }
}
