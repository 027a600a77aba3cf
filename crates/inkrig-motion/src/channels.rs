//! Poses as numbers that may be averaged, and back: how blended motion becomes a clip again.
//!
//! What must not drift is stored as it is (height, rotations), what must not jump as steps (travel over the
//! ground, turning), so that a weighted mean of rows from anywhere in a clip is a pose of a continuous motion.

use crate::rotation::{from_6d, to_6d};
use crate::{
    Clip, Features, MotionError, Skeleton, Takes, TranslationTrack, VelocityFrame, root::RootMotion,
};
use glam::{Quat, Vec3};
use std::sync::Arc;

/// The meaning of a row of pose channels:
/// `[step x, height, step z | yaw rate | other translations, 3 each | rotations, 6 each]`.
///
/// Steps and heights are metres (a frame), the yaw rate (heading frame only) radians a frame; an ordinary other
/// translation is local, that of a second root is its difference to the travelling joint. End sites have no
/// rotation. In the heading frame, steps and everything without a parent are seen from where the character is
/// headed.
#[derive(Debug, Clone)]
pub struct PoseChannels {
    skeleton: Arc<Skeleton>,
    frame: VelocityFrame,
    travel_joint: usize,
    travels: bool,
    /// Joints above the travelling one: they stand still in the world and know no heading.
    above: Vec<bool>,
    world_from_parent: Quat,
    parent_in_world: Vec3,
    start: Vec3,
    tracks: Vec<usize>,
    width: usize,
}

/// Where a motion that comes in pieces has got to; the default is before its beginning.
#[derive(Debug, Clone, Default)]
pub struct Journey {
    place: Vec3,
    heading: f32,
    /// The last rotations.
    pose: Vec<Quat>,
}

impl PoseChannels {
    /// The layout for a character's takes, and their own rows (frames x width).
    pub fn of(takes: &Takes, frame: VelocityFrame) -> (Self, Features) {
        let (clip, root) = (takes.clip(), RootMotion::of(takes));
        let tracks: Vec<usize> = clip
            .translations()
            .iter()
            .map(|track| track.joint)
            .filter(|&joint| joint != root.joint)
            .collect();
        let turning = clip.skeleton().joints().iter().filter(|joint| !joint.end_site).count();
        let mut layout = Self {
            skeleton: clip.skeleton().clone(),
            frame,
            travel_joint: root.joint,
            travels: clip.track(root.joint).is_some(),
            above: clip.skeleton().ancestors(root.joint),
            world_from_parent: root.world_from_parent,
            parent_in_world: root.parent_in_world,
            start: root.places.first().copied().unwrap_or(Vec3::ZERO),
            tracks,
            width: 0,
        };
        layout.width = 3 + usize::from(layout.in_heading_frame()) + 3 * layout.tracks.len() + 6 * turning;
        let rows = layout.rows(takes);
        (layout, rows)
    }

    /// Numbers per row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// The joint that carries the character through the world.
    pub fn travel_joint(&self) -> usize {
        self.travel_joint
    }

    /// The rows of other takes of that character. Headings count from their first frame.
    ///
    /// # Panics
    /// When the skeleton has fewer joints.
    pub fn rows(&self, takes: &Takes) -> Features {
        let root = RootMotion::of_joint(takes, self.travel_joint);
        let mut values = Vec::with_capacity(self.width * takes.clip().frames());
        self.encode(takes.clip(), &root, &mut values);
        Features::from_parts(values, self.width)
    }

    /// Puts rows (frames x [`Self::width`]) together to a motion: averaged rotations are projected to the nearest
    /// rotation, steps are integrated from the original clip's first place. A rotation whose average has no
    /// direction keeps that of the frame before.
    ///
    /// # Errors
    /// When the table is empty or ragged, holds a number that is not finite, or the frame rate is not usable.
    pub fn to_clip(&self, rows: &[f32], frame_rate: f64) -> Result<Clip, MotionError> {
        self.to_clip_from(rows, frame_rate, &mut Journey::default())
    }

    /// As [`to_clip`](Self::to_clip), for a motion that comes in pieces: each goes on where the one before it ended.
    ///
    /// # Errors
    /// As for [`to_clip`](Self::to_clip).
    pub fn to_clip_from(
        &self,
        rows: &[f32],
        frame_rate: f64,
        journey: &mut Journey,
    ) -> Result<Clip, MotionError> {
        let rows = Features::new(rows.to_vec(), self.width)?;
        let joints = self.skeleton.joints();
        let mut rotations = vec![Quat::IDENTITY; rows.frames() * joints.len()];
        let mut travel = Vec::with_capacity(rows.frames());
        let mut others: Vec<Vec<Vec3>> = vec![Vec::with_capacity(rows.frames()); self.tracks.len()];
        let begun = journey.pose.len() == joints.len();
        let (mut place, mut heading) =
            if begun { (journey.place, journey.heading) } else { (self.start, 0.0) };
        for frame in 0..rows.frames() {
            let mut row = Row(rows.row(frame));
            let step = row.vector();
            if self.in_heading_frame() {
                let [yaw_rate] = row.take();
                heading += if frame > 0 || begun { yaw_rate } else { 0.0 };
            }
            let facing = Quat::from_rotation_y(heading);
            if frame > 0 || begun {
                place += facing * Vec3::new(step.x, 0.0, step.z);
            }
            place.y = step.y;
            travel.push(self.world_from_parent.inverse() * (place - self.parent_in_world));
            for (&joint, values) in self.tracks.iter().zip(&mut others) {
                let value = row.vector();
                values.push(if self.is_other_root(joint) { place + facing * value } else { value });
            }
            for (index, _) in joints.iter().enumerate().filter(|(_, joint)| !joint.end_site) {
                let slot = frame * joints.len() + index;
                let before = match frame {
                    0 if begun => journey.pose[index],
                    0 => Quat::IDENTITY,
                    _ => rotations[slot - joints.len()],
                };
                rotations[slot] = match from_6d(row.six()) {
                    None => before,
                    Some(rotation) if index == self.travel_joint => {
                        self.world_from_parent.inverse() * (facing * rotation)
                    }
                    Some(rotation) if self.is_other_root(index) => facing * rotation,
                    Some(rotation) => rotation,
                };
            }
        }
        (journey.place, journey.heading) = (place, heading);
        journey.pose = rotations[rotations.len() - joints.len()..].to_vec();
        let mut translations: Vec<TranslationTrack> = (self.tracks.iter().zip(others))
            .map(|(&joint, values)| TranslationTrack { joint, values })
            .collect();
        if self.travels {
            translations.push(TranslationTrack { joint: self.travel_joint, values: travel });
            translations.sort_by_key(|track| track.joint);
        }
        Clip::new(self.skeleton.clone(), frame_rate, rotations, translations)
    }

    /// A root that is not above the travelling joint: another character, a prop. It goes where that one goes.
    fn is_other_root(&self, joint: usize) -> bool {
        joint != self.travel_joint && !self.above[joint] && self.skeleton.joints()[joint].parent.is_none()
    }

    fn in_heading_frame(&self) -> bool {
        self.frame == VelocityFrame::Heading
    }

    fn encode(&self, clip: &Clip, root: &RootMotion, values: &mut Vec<f32>) {
        let (velocities, yaw_rates) = (root.velocities(), root.yaw_rates());
        let joints = clip.skeleton().joints();
        for frame in 0..clip.frames() {
            let heading = if self.in_heading_frame() { root.headings[frame] } else { 0.0 };
            let facing = Quat::from_rotation_y(-heading);
            let step = facing * velocities[frame];
            values.extend([step.x, root.places[frame].y, step.z]);
            if self.in_heading_frame() {
                values.push(yaw_rates[frame]);
            }
            for &joint in &self.tracks {
                let value = clip.track(joint).map_or(joints[joint].offset, |track| track[frame]);
                let other = self.is_other_root(joint);
                let relative = if other { facing * (value - root.places[frame]) } else { value };
                values.extend(relative.to_array());
            }
            let local = clip.rotations(frame);
            for (index, _) in joints.iter().enumerate().filter(|(_, joint)| !joint.end_site) {
                values.extend(to_6d(if index == self.travel_joint {
                    facing * root.rotations[frame]
                } else if self.is_other_root(index) {
                    facing * local[index]
                } else {
                    local[index]
                }));
            }
        }
    }
}

/// Reads a row from left to right. Rows are as wide as the layout says: [`Features`] has checked it.
struct Row<'a>(&'a [f32]);

impl Row<'_> {
    fn take<const N: usize>(&mut self) -> [f32; N] {
        let (head, rest) = self.0.split_at(N);
        self.0 = rest;
        std::array::from_fn(|index| head[index])
    }

    fn vector(&mut self) -> Vec3 {
        Vec3::from_array(self.take::<3>())
    }

    fn six(&mut self) -> [f32; 6] {
        self.take::<6>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Joint, kinematics::positions};

    /// A skater on a circle with a prop (a second root) beside her, below a root that lies on its side.
    fn skater() -> Clip {
        let skeleton = Skeleton::new(vec![
            Joint::new("world", None, Vec3::new(300.0, 0.0, -7.0)),
            Joint::new("hips", Some(0), Vec3::ZERO),
            Joint::new("head", Some(1), Vec3::Z),
            Joint::end("head_end", 2, Vec3::Z * 0.2),
            Joint::new("prop", None, Vec3::ZERO),
        ]);
        let tilt = Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2);
        let (mut rotations, mut hips, mut prop) = (vec![], vec![], vec![]);
        for frame in 0..40 {
            let angle = 0.2 * frame as f32;
            let turn = Quat::from_rotation_z(angle);
            let nod = Quat::from_rotation_x(0.3 * angle.sin());
            rotations.extend([tilt, turn, nod, Quat::IDENTITY, Quat::from_rotation_y(angle)]);
            hips.push(turn * Vec3::X * 2.0 + Vec3::Z);
            prop.push(Vec3::new(300.0, 0.0, -7.0) + tilt * (turn * Vec3::X * 2.5));
        }
        let tracks =
            vec![TranslationTrack { joint: 1, values: hips }, TranslationTrack { joint: 4, values: prop }];
        Clip::new(Arc::new(skeleton.unwrap()), 30.0, rotations, tracks).unwrap()
    }

    #[test]
    fn rows_give_the_clip_back() {
        let clip = skater();
        for frame in [VelocityFrame::World, VelocityFrame::Heading] {
            let (layout, rows) = PoseChannels::of(&clip.clone().into(), frame);
            let back = layout.to_clip(rows.as_slice(), 30.0).unwrap();
            let (expected, got) = (positions(&clip), positions(&back));
            for frame in 0..clip.frames() {
                for (a, b) in expected.frame(frame).iter().zip(got.frame(frame)) {
                    assert!(a.distance(*b) < 2e-3, "frame {frame}: {a} became {b}");
                }
            }
        }
    }

    #[test]
    fn pieces_go_on_where_the_one_before_ended() {
        let clip = skater();
        for frame in [VelocityFrame::World, VelocityFrame::Heading] {
            let (layout, rows) = PoseChannels::of(&clip.clone().into(), frame);
            let whole = layout.to_clip(rows.as_slice(), 30.0).unwrap();
            let mut journey = Journey::default();
            for range in [0..7, 7..8, 8..40] {
                let part = &rows.as_slice()[range.start * layout.width()..range.end * layout.width()];
                let piece = layout.to_clip_from(part, 30.0, &mut journey).unwrap();
                for (frame, at) in range.enumerate() {
                    assert_eq!(piece.rotations(frame), whole.rotations(at));
                    assert_eq!(piece.track(1).unwrap()[frame], whole.track(1).unwrap()[at]);
                }
            }
        }
    }

    #[test]
    fn what_stands_above_the_travelling_joint_stays_where_it_is() {
        let clip = skater();
        for frame in [VelocityFrame::World, VelocityFrame::Heading] {
            let (layout, rows) = PoseChannels::of(&clip.clone().into(), frame);
            // The second half first: headings differ from those of the frames that the rows come from.
            let turned: Vec<f32> = (0..40).flat_map(|frame| rows.row((frame + 20) % 40).to_vec()).collect();
            let back = layout.to_clip(&turned, 30.0).unwrap();
            let positions = positions(&back);
            for frame in 0..40 {
                assert!(back.rotations(frame)[0].dot(clip.rotations(frame)[0]).abs() > 1.0 - 1e-6);
                assert!(positions.frame(frame)[0].distance(Vec3::new(300.0, 0.0, -7.0)) < 1e-3);
                let apart = positions.frame(frame)[1].distance(positions.frame(frame)[4]);
                assert!((apart - 1.118).abs() < 1e-2, "the prop goes along: {apart} m away");
            }
        }
    }

    #[test]
    fn a_mean_without_direction_keeps_the_pose_before() {
        let clip = skater();
        let (layout, rows) = PoseChannels::of(&clip.clone().into(), VelocityFrame::World);
        let mut values = rows.into_vec();
        let last = values.len() - 6;
        values[last..].fill(0.0);
        let back = layout.to_clip(&values, 30.0).unwrap();
        assert!(back.rotations(39)[4].dot(clip.rotations(38)[4]).abs() > 1.0 - 1e-6);
        assert!(layout.to_clip(&values[1..], 30.0).is_err());
        values[0] = f32::NAN;
        assert!(layout.to_clip(&values, 30.0).is_err());
    }
}
