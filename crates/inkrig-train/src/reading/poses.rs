//! Poses out of a corpus, seen as a storyboard's artist sees them.

use crate::TrainError;
use crate::corpus::{Manifest, Split};
use crate::figures::{Chance, Conditions, Family, Picture, Style, draw, picture, seen};
use inkrig_generate::schedule::Noise;
use inkrig_motion::glam::{Quat, Vec3};
use inkrig_motion::humanml::{Camera, Joints, PARENTS, mirror, recover_positions};

/// Every pose of a split of a corpus.
#[derive(Debug, Clone)]
pub struct Poses {
    clips: Vec<Clip>,
    /// Sums of the clips' weights up to each.
    upto: Vec<f64>,
}

#[derive(Debug, Clone)]
struct Clip {
    poses: Vec<Joints>,
    key_poses: Vec<usize>,
}

impl Poses {
    /// Reads a split; clips count by the root of their length.
    ///
    /// # Errors
    /// When a part cannot be read, or the split is empty.
    pub fn read(manifest: &Manifest, split: Split) -> Result<Self, TrainError> {
        let (mut clips, mut upto, mut sum) = (Vec::new(), Vec::new(), 0.0);
        for (path, entries) in manifest.parts(split) {
            let part = Manifest::read_part(&path, entries)?;
            for entry in entries {
                let Some(clip) = part.clips.get(entry.index) else { continue };
                let poses = recover_positions(&clip.prepared.features)
                    .map_err(|error| TrainError::Device(error.to_string()))?;
                if !poses.is_empty() {
                    sum += (poses.len() as f64).sqrt();
                    upto.push(sum);
                    clips.push(Clip { poses, key_poses: entry.key_poses.clone() });
                }
            }
        }
        if clips.is_empty() {
            let name = split.name();
            return Err(TrainError::Device(format!("the corpus has no clips of the split `{name}`")));
        }
        Ok(Self { clips, upto })
    }

    /// Of poses that are there already, one clip.
    pub fn of(poses: Vec<Joints>) -> Self {
        Self { clips: vec![Clip { poses, key_poses: Vec::new() }], upto: vec![1.0] }
    }

    /// A pose that faces +z; half of them are key poses, half are mirrored.
    pub fn pose(&self, noise: &mut Noise) -> Joints {
        let place = noise.uniform() * self.upto.last().copied().unwrap_or(0.0);
        let clip = self.upto.partition_point(|&upto| upto <= place).min(self.clips.len() - 1);
        let clip = &self.clips[clip];
        let frame = match clip.key_poses.get(noise.below(clip.key_poses.len().max(1))) {
            Some(&frame) if noise.happens(0.5) => frame.min(clip.poses.len() - 1),
            _ => noise.below(clip.poses.len()),
        };
        let pose = facing(&clip.poses[frame]);
        if noise.happens(0.5) { mirror(&[pose]).first().copied().unwrap_or(pose) } else { pose }
    }

    /// A drawing of a pose, on paper.
    pub fn picture(
        &self,
        families: &[Family],
        conditions: &Conditions,
        shares: &Shares,
        noise: &mut Noise,
    ) -> Picture {
        let mut pose = self.pose(noise);
        if noise.happens(shares.bent) {
            bend(&mut pose, noise);
        }
        let turned = noise.happens(shares.turned);
        let yaw = if turned { noise.between(-180.0, 180.0) } else { noise.between(-50.0, 50.0) };
        let camera = Camera::new(noise.between(0.0, 30.0).to_radians(), yaw.to_radians());
        let pose = seen(&pose, &camera, noise.between(-10.0, 10.0).to_radians());
        let family = families.get(noise.below(families.len())).copied().unwrap_or(Family::Stick);
        let varied = shares.varied > 0.0 && noise.happens(shares.varied);
        let style = if varied { Style::varied(family, noise) } else { Style::random(family, noise) };
        picture(&draw(&pose, &style, noise), conditions, noise)
    }
}

/// Of how many drawings something holds, 0 to 1 each.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Shares {
    /// Limbs are bent further at random.
    pub bent: f64,
    /// Seen from any side; the others are from the front half, -50 to 50 degrees.
    pub turned: f64,
    /// Drawn as [`Style::varied`] does.
    pub varied: f64,
}

/// Turned about the vertical so that hips and shoulders face +z.
fn facing(pose: &Joints) -> Joints {
    let across = pose[1] - pose[2] + pose[16] - pose[17];
    let turn = Quat::from_rotation_y(across.z.atan2(across.x));
    pose.map(|joint| turn * joint)
}

/// Turns a few joints, with all that hangs on them.
fn bend(pose: &mut Joints, noise: &mut Noise) {
    for _ in 0..1 + noise.below(3) {
        let joint = [1, 2, 4, 5, 16, 17, 18, 19, 16, 17, 18, 19, 3, 12][noise.below(14)];
        let axis = Vec3::new(noise.normal(), noise.normal(), noise.normal()).normalize_or(Vec3::Y);
        let most = if matches!(joint, 3 | 12) { 0.5 } else { 1.2 };
        let turn = Quat::from_axis_angle(axis, noise.between(-most, most));
        let middle = pose[joint];
        for other in 0..pose.len() {
            let mut above = PARENTS[other];
            while above != joint && above != 0 {
                above = PARENTS[above];
            }
            if above == joint && other != joint {
                pose[other] = middle + turn * (pose[other] - middle);
            }
        }
    }
}
