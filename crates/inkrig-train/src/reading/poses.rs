//! Poses out of a corpus, seen as a storyboard's artist sees them.

use crate::TrainError;
use crate::corpus::{Manifest, Split};
use crate::figures::{Chance, Conditions, Family, Picture, Style, draw, picture, seen};
use inkrig_generate::schedule::Noise;
use inkrig_motion::glam::{Quat, Vec3};
use inkrig_motion::humanml::{Camera, Joints, PARENTS, mirror, recover_positions};

/// Of how many characters are drawn as people draw those that shall be animated: upright, arms out to the sides.
const SPREAD: f64 = 0.5;

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
        let character = shares.characters > 0.0 && noise.happens(shares.characters);
        let families = if character { &[Family::Character] } else { families };
        if character && noise.happens(SPREAD) {
            spread(&mut pose, noise);
        }
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
    /// Of [`Family::Character`], and not of the families that are asked for.
    pub characters: f64,
}

/// Turned about the vertical so that hips and shoulders face +z.
fn facing(pose: &Joints) -> Joints {
    let across = pose[1] - pose[2] + pose[16] - pose[17];
    let turn = Quat::from_rotation_y(across.z.atan2(across.x));
    pose.map(|joint| turn * joint)
}

/// Stands upright and faces +z, arms anywhere at its sides.
fn spread(pose: &mut Joints, noise: &mut Noise) {
    let old = *pose;
    let lean = noise.between(-8.0, 8.0_f32).to_radians();
    let both = [noise.between(-70.0, 50.0_f32), noise.between(0.0, 15.0), noise.between(20.0, 90.0)];
    let same = noise.happens(0.6);
    for joint in 1..pose.len() {
        // Left is +x.
        let side = if matches!(joint, 1 | 4 | 7 | 10 | 13 | 16 | 18 | 20) { 1.0 } else { -1.0 };
        let mut own = |both: f32, near: f32| {
            let other = noise.between(-near, near);
            (if same { both + 0.3 * other } else { both + other }).to_radians()
        };
        let way = match joint {
            1 | 2 => Vec3::new(side, -0.5, 0.0),
            13 | 14 => Vec3::new(0.6 * side, 0.8, 0.0),
            16 | 17 => Vec3::new(side, 0.0, 0.0),
            // Up from the horizontal.
            18..=21 => {
                let up = own(both[0], if joint < 20 { 20.0 } else { 45.0 });
                Vec3::new(side * up.cos(), up.sin(), 0.0)
            }
            // Out from the vertical.
            4 | 5 | 7 | 8 => {
                let out = own(both[1], 8.0);
                Vec3::new(side * out.sin(), -out.cos(), 0.0)
            }
            // Out from straight ahead.
            10 | 11 => {
                let out = own(both[2], 20.0);
                Vec3::new(side * out.sin(), -0.2, out.cos())
            }
            _ => Vec3::new(lean.sin(), lean.cos(), 0.0),
        };
        let parent = PARENTS[joint];
        let length = (old[joint] - old[parent]).length();
        pose[joint] = pose[parent] + length * way.normalize_or(Vec3::Y);
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use inkrig_motion::humanml::RAW_DIRECTIONS;

    fn sitting() -> Joints {
        let mut pose = [Vec3::ZERO; 22];
        for joint in 1..pose.len() {
            let way = if matches!(joint, 4 | 5) { Vec3::Z } else { RAW_DIRECTIONS[joint] };
            pose[joint] = pose[PARENTS[joint]] + (0.1 + 0.01 * joint as f32) * way;
        }
        pose
    }

    #[test]
    fn who_is_spread_stands_with_the_arms_at_the_sides_and_keeps_all_lengths() {
        let old = sitting();
        for seed in 0..50 {
            let mut pose = old;
            spread(&mut pose, &mut Noise::new(seed));
            for joint in 1..pose.len() {
                let length = |pose: &Joints| (pose[joint] - pose[PARENTS[joint]]).length();
                assert!((length(&pose) - length(&old)).abs() < 1e-4, "{seed} {joint}");
            }
            assert!(pose[20].x > pose[16].x && pose[21].x < pose[17].x, "{seed}");
            assert!(pose[7].y < pose[4].y && pose[4].y < pose[1].y && pose[15].y > pose[0].y, "{seed}");
        }
    }

    #[test]
    fn characters_come_where_they_are_asked_for() {
        let poses = Poses::of(vec![sitting()]);
        let drawing = |characters: f64, family: Family, seed: u64| {
            let shares = Shares { characters, ..Shares::default() };
            poses.picture(&[family], &Conditions::READ, &shares, &mut Noise::new(seed))
        };
        for seed in 0..10 {
            // Whatever families are asked for beside them.
            let own = drawing(1.0, Family::Stick, seed);
            assert_eq!(own, drawing(1.0, Family::Filled, seed));
            assert_ne!(own, drawing(0.0, Family::Stick, seed));
        }
    }
}
