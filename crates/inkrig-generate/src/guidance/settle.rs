//! Feet that stand do not slide: latents are moved a little, at the end, until what they decode to has such feet.
//!
//! Not in the papers. What is sampled is near to motion, and a foot that should stand goes on by some centimetres from frame to frame. The nearest latent
//! whose feet do not is found by steps along a gradient through the decoder, so that the whole body gives way and stays smooth;
//! what was asked for is held meanwhile.

use super::guide::Guide;
use super::missing::{of_pose, of_pose_back};
use super::target::View;
use crate::GenerateError;
use inkrig_motion::glam::Vec3;
use inkrig_motion::humanml::{FRAME_RATE, JOINTS, Joints, augment};

/// Numbers of a frame's places.
const PLACES: usize = 3 * JOINTS;
/// Joints that stand: the balls of the feet.
const FEET: [usize; 2] = [10, 11];
/// A foot of this height, metres, as likely stands as it swings, and over how much that changes.
const HEIGHT: f64 = 0.06;
const SOFT: f64 = 0.01;
/// A foot that stands may be as quick as this, metres a second: real ones roll.
const ROLLS: f64 = 0.15;
/// Below this, metres, distances count by their square.
const ROUNDED: f64 = 0.01;
/// Decay of the two means of Adam.
const DECAY: (f64, f64) = (0.9, 0.99);

/// How latents are settled.
#[derive(Debug, Clone, PartialEq)]
pub struct SettleOptions {
    /// Steps, of a decoding and its gradient each.
    pub steps: usize,
    /// How far a number goes in a step, in deviations of latents.
    pub rate: f64,
    /// Weight of sliding: the mean over frames of the metres a second of both feet.
    pub slides: f64,
    /// Of what is asked for: the mean distance, metres.
    pub asked: f64,
    /// Of key poses: the mean distance of their joints, the pelvis at its place, metres.
    pub keypose: f64,
    /// Of the mean distance over ground of the pelvis from where it was, metres, in clips of which nothing is asked: a walk whose feet slide shall step
    /// farther, not stand.
    pub way: f64,
    /// Of the mean square by which a latent's numbers change.
    pub moved: f64,
}

impl Default for SettleOptions {
    fn default() -> Self {
        Self { steps: 40, rate: 0.03, slides: 1.0, asked: 10.0, keypose: 20.0, way: 3.0, moved: 0.3 }
    }
}

/// Means of gradients and of their squares.
#[derive(Debug, Clone, Copy, Default)]
struct Means {
    first: f64,
    second: f64,
}

impl Guide<'_> {
    /// Moves clean latents. `poses` are the key poses of clips, augmented joints in space or on the picture, with their frames.
    ///
    /// # Errors
    /// When the numbers of clips and latents differ, or a clip is too long.
    pub fn settle(
        &mut self,
        latents: &mut [f32],
        poses: &[Option<&(usize, Joints)>],
        options: &SettleOptions,
    ) -> Result<(), GenerateError> {
        self.hold(poses);
        self.forget_ways();
        let before = latents.to_vec();
        let each = latents.len() / self.count().max(1);
        let mut means = vec![Means::default(); latents.len()];
        let mut gradient = vec![0.0; latents.len()];
        let decay = |mean: f64, decay: f64, value: f64| decay * mean + (1.0 - decay) * value;
        for step in 1..=options.steps as i32 {
            self.settling(latents, options, &mut gradient)?;
            let unbiased = (1.0 - DECAY.0.powi(step), 1.0 - DECAY.1.powi(step));
            let numbers = latents.iter_mut().zip(&before).zip(&gradient).zip(&mut means);
            for (((latent, before), gradient), means) in numbers {
                let back = 2.0 * options.moved * f64::from(*latent - before) / each as f64;
                let slope = f64::from(*gradient) + back;
                means.first = decay(means.first, DECAY.0, slope);
                means.second = decay(means.second, DECAY.1, slope * slope);
                let length = (means.second / unbiased.1).sqrt() + 1e-8;
                *latent -= (options.rate * means.first / unbiased.0 / length) as f32;
            }
        }
        Ok(())
    }
}

/// Adds the gradient of sliding, times `weight`, to that of joints (frames x 66); gives how much feet slide, the mean over frames of the metres a
/// second of both. Heights have no gradient: a foot shall stand still, not be lifted.
pub(super) fn slides(joints: &[f64], weight: f64, gradient: &mut [f64]) -> f64 {
    let frames = joints.len() / PLACES;
    let share = 1.0 / frames.max(1) as f64;
    let mut sum = 0.0;
    for frame in 1..frames {
        for foot in FEET {
            let [before, now] = [(frame - 1) * PLACES + 3 * foot, frame * PLACES + 3 * foot];
            let (x, z) = (joints[now] - joints[before], joints[now + 2] - joints[before + 2]);
            let length = x.hypot(z);
            let speed = length * FRAME_RATE;
            if speed <= ROLLS {
                continue;
            }
            let high = joints[now + 1].max(joints[before + 1]);
            let stands = 1.0 / (1.0 + ((high - HEIGHT) / SOFT).exp());
            sum += share * stands * (speed - ROLLS);
            let slope = weight * share * stands * FRAME_RATE / length;
            for (axis, apart) in [(0, x), (2, z)] {
                gradient[now + axis] += slope * apart;
                gradient[before + axis] -= slope * apart;
            }
        }
    }
    sum
}

/// Adds the gradient of the pelvis's mean distance over ground from `way` (x and z, frame by frame), times `weight`, to that of joints; gives the distance,
/// metres.
pub(super) fn strays(joints: &[f64], way: &[[f64; 2]], weight: f64, gradient: &mut [f64]) -> f64 {
    let share = 1.0 / way.len().max(1) as f64;
    let mut sum = 0.0;
    let frames = joints.chunks_exact(PLACES).zip(gradient.chunks_exact_mut(PLACES));
    for ((joints, gradient), [x, z]) in frames.zip(way) {
        let off = [joints[0] - x, joints[2] - z];
        let length = (off[0] * off[0] + off[1] * off[1] + ROUNDED * ROUNDED).sqrt();
        sum += share * (length - ROUNDED);
        gradient[0] += weight * share * off[0] / length;
        gradient[2] += weight * share * off[1] / length;
    }
    sum
}

/// Where the pelvis is over ground, frame by frame.
pub(super) fn way(joints: &[f64]) -> Vec<[f64; 2]> {
    joints.chunks_exact(PLACES).map(|pose| [pose[0], pose[2]]).collect()
}

/// Adds the gradient of a key pose's mean distance, times `weight`, to that of joints; gives the distance, metres.
pub(super) fn misses_pose(
    joints: &[f64],
    view: View,
    (frame, wanted): &(usize, Joints),
    weight: f64,
    gradient: &mut [f64],
) -> f64 {
    let first = frame * PLACES;
    let (Some(own), Some(of)) = (joints.get(first..first + PLACES), gradient.get_mut(first..first + PLACES))
    else {
        return 0.0;
    };
    let mut now = [Vec3::ZERO; JOINTS];
    for (now, place) in now.iter_mut().zip(own.chunks_exact(3)) {
        *now = Vec3::new(place[0] as f32, place[1] as f32, place[2] as f32);
    }
    let mut by = of_pose(view, &augment(&now), wanted);
    let mut sum = 0.0;
    for way in by.chunks_exact_mut(3) {
        let square: f64 = way.iter().map(|x| f64::from(x * x)).sum();
        let length = (square + ROUNDED * ROUNDED).sqrt();
        sum += (length - ROUNDED) / JOINTS as f64;
        way.iter_mut().for_each(|x| *x *= (weight / length / JOINTS as f64) as f32);
    }
    let of_joints = of_pose_back(view, &by);
    for (of, by) in of.iter_mut().zip(of_joints.iter().flat_map(Vec3::to_array)) {
        *of += f64::from(by);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use inkrig_motion::humanml::Camera;

    #[test]
    fn the_gradient_of_a_key_pose_is_a_difference() {
        let place = |joint: usize| Vec3::new(0.1, 0.05 * joint as f32, 0.02 * (joint % 3) as f32);
        let joints: Vec<f64> =
            (0..2 * JOINTS).flat_map(|at| place(at % JOINTS).to_array()).map(f64::from).collect();
        let mut wanted: Joints = std::array::from_fn(place);
        wanted[7].y += 0.3;
        wanted[20].x -= 0.2;
        for view in [View::Space, View::Plane(Camera::default())] {
            let pose = (1, wanted);
            let mut gradient = vec![0.0; joints.len()];
            misses_pose(&joints, view, &pose, 2.0, &mut gradient);
            assert!(gradient[..PLACES].iter().all(|x| *x == 0.0) && gradient.iter().any(|x| x.abs() > 1e-3));
            for at in PLACES..2 * PLACES {
                let value = |by: f64| {
                    let mut moved = joints.clone();
                    moved[at] += by;
                    2.0 * misses_pose(&moved, view, &pose, 0.0, &mut vec![0.0; joints.len()])
                };
                let slope = (value(1e-3) - value(-1e-3)) / 2e-3;
                assert!((slope - gradient[at]).abs() < 0.01, "{at}: {slope} {}", gradient[at]);
            }
        }
        assert_eq!(misses_pose(&joints, View::Space, &(2, wanted), 1.0, &mut vec![0.0; joints.len()]), 0.0);
    }

    /// Both feet at a height, going along x at so many metres a second.
    fn walk(height: f64, speed: f64) -> Vec<f64> {
        let mut joints = vec![0.9; 6 * PLACES];
        for (frame, pose) in joints.chunks_exact_mut(PLACES).enumerate() {
            for foot in FEET {
                pose[3 * foot] = speed * frame as f64 / FRAME_RATE + 0.01 * (frame * frame) as f64;
                pose[3 * foot + 1] = height;
            }
        }
        joints
    }

    #[test]
    fn low_feet_slide_and_high_or_slow_ones_do_not() {
        let of = |joints: &[f64]| slides(joints, 1.0, &mut vec![0.0; joints.len()]);
        assert!(of(&walk(0.02, 1.0)) > 1.0);
        assert!(of(&walk(0.15, 1.0)) < 1e-2);
        assert_eq!(of(&vec![0.01; 6 * PLACES]), 0.0);
        assert_eq!(of(&[]), 0.0);
    }

    #[test]
    fn a_pelvis_is_drawn_back_to_its_way() {
        let joints = walk(0.02, 1.0);
        let own: Vec<[f64; 2]> = (0..6).map(|frame| [0.9 + 0.02 * f64::from(frame), 0.8]).collect();
        assert_eq!(strays(&joints, &way(&joints), 2.0, &mut vec![0.0; joints.len()]), 0.0);
        let mut gradient = vec![0.0; joints.len()];
        strays(&joints, &own, 2.0, &mut gradient);
        for at in (0..joints.len()).step_by(11) {
            let value = |by: f64| {
                let mut moved = joints.clone();
                moved[at] += by;
                2.0 * strays(&moved, &own, 0.0, &mut vec![0.0; joints.len()])
            };
            let slope = (value(1e-6) - value(-1e-6)) / 2e-6;
            assert!((slope - gradient[at]).abs() < 1e-6, "{at}: {slope} {}", gradient[at]);
        }
    }

    #[test]
    fn its_gradient_is_a_difference() {
        let joints = walk(0.055, 0.8);
        let mut gradient = vec![0.0; joints.len()];
        slides(&joints, 3.0, &mut gradient);
        let value = |at: usize, by: f64| {
            let mut moved = joints.clone();
            moved[at] += by;
            3.0 * slides(&moved, 0.0, &mut vec![0.0; joints.len()])
        };
        for at in (0..joints.len()).filter(|at| at % 3 != 1) {
            let slope = (value(at, 1e-6) - value(at, -1e-6)) / 2e-6;
            assert!((slope - gradient[at]).abs() < 1e-5, "{at}: {slope} {}", gradient[at]);
        }
    }
}
