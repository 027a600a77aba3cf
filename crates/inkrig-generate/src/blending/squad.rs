//! The classical way, for comparison: spherical quadrangles between the poses around a gap (Shoemake 1987).

use crate::GenerateError;
use inkrig_motion::glam::{Quat, Vec3};
use inkrig_motion::{Clip, TranslationTrack};
use std::ops::Range;

/// A clip whose frames in `gap` are made of those around it: rotations by spherical quadrangles, translations by cubics.
///
/// # Errors
/// When the gap leaves no frame before it or behind it.
pub fn squad(clip: &Clip, gap: Range<usize>) -> Result<Clip, GenerateError> {
    if gap.start == 0 || gap.end >= clip.frames() || gap.is_empty() {
        let (setting, value) = ("the gap", format!("{gap:?}"));
        return Err(GenerateError::Setting { setting, value, needed: "some frames inside the clip" });
    }
    // Four poses a gap apart, as far as the clip goes.
    let length = gap.len() + 1;
    let (left, right) = (gap.start - 1, gap.end);
    let knots = [left.saturating_sub(length), left, right, (right + length).min(clip.frames() - 1)];
    let share = |frame: usize| (frame - left) as f32 / length as f32;
    let joints = clip.skeleton().len();
    let mut rotations: Vec<Quat> =
        (0..clip.frames()).flat_map(|frame| clip.rotations(frame).to_vec()).collect();
    for joint in 0..joints {
        let curve = Quadrangle::new(knots.map(|knot| clip.rotations(knot)[joint]));
        for frame in gap.clone() {
            rotations[frame * joints + joint] = curve.at(share(frame));
        }
    }
    let translations = clip.translations().iter().map(|track| {
        let mut values = track.values.clone();
        let [from, to] = [left, right].map(|at| track.values[at]);
        // Speeds just outside the gap, over its length.
        let leaving = (from - track.values[left.saturating_sub(1)]) * length as f32;
        let arriving = (track.values[(right + 1).min(clip.frames() - 1)] - to) * length as f32;
        for frame in gap.clone() {
            values[frame] = hermite([from, to], [leaving, arriving], share(frame));
        }
        TranslationTrack { joint: track.joint, values }
    });
    let translations = translations.collect();
    Ok(Clip::new(clip.skeleton().clone(), clip.frame_rate(), rotations, translations)?)
}

/// Between the second and third of four rotations.
struct Quadrangle {
    ends: [Quat; 2],
    inner: [Quat; 2],
}

impl Quadrangle {
    fn new(knots: [Quat; 4]) -> Self {
        let mut near = knots;
        for at in 1..4 {
            if near[at - 1].dot(near[at]) < 0.0 {
                near[at] = -near[at];
            }
        }
        let inner = |at: usize| {
            let back = near[at].inverse();
            let bend = (back * near[at + 1]).to_scaled_axis() + (back * near[at - 1]).to_scaled_axis();
            near[at] * Quat::from_scaled_axis(-0.25 * bend)
        };
        Self { ends: [near[1], near[2]], inner: [inner(1), inner(2)] }
    }

    fn at(&self, share: f32) -> Quat {
        let along = self.ends[0].slerp(self.ends[1], share);
        let inside = self.inner[0].slerp(self.inner[1], share);
        along.slerp(inside, 2.0 * share * (1.0 - share)).normalize()
    }
}

fn hermite([from, to]: [Vec3; 2], [leaving, arriving]: [Vec3; 2], t: f32) -> Vec3 {
    let (square, cube) = (t * t, t * t * t);
    from * (2.0 * cube - 3.0 * square + 1.0)
        + leaving * (cube - 2.0 * square + t)
        + to * (3.0 * square - 2.0 * cube)
        + arriving * (cube - square)
}

#[cfg(test)]
mod tests {
    use super::*;
    use inkrig_motion::{Joint, Skeleton};
    use std::sync::Arc;

    #[test]
    fn a_steady_turn_and_a_steady_way_go_on_through_the_gap() {
        let joints = vec![Joint::new("root", None, Vec3::ZERO), Joint::new("arm", Some(0), Vec3::X)];
        let skeleton = Arc::new(Skeleton::new(joints).unwrap());
        let turn = |frame: usize| Quat::from_rotation_y(0.1 * frame as f32);
        let way = |frame: usize| Vec3::new(0.2 * frame as f32, 1.0, 0.0);
        let rotations = (0..60).flat_map(|frame| [turn(frame), turn(2 * frame)]).collect();
        let track = TranslationTrack { joint: 0, values: (0..60).map(way).collect() };
        let clip = Clip::new(skeleton, 20.0, rotations, vec![track]).unwrap();
        let filled = squad(&clip, 25..35).unwrap();
        for frame in 0..60 {
            assert!(filled.rotations(frame)[0].angle_between(turn(frame)) < 2e-3);
            assert!(filled.rotations(frame)[1].angle_between(turn(2 * frame)) < 2e-3);
            assert!(filled.track(0).unwrap()[frame].distance(way(frame)) < 1e-5);
        }
        assert!(squad(&clip, 0..5).is_err() && squad(&clip, 50..60).is_err());
    }
}
