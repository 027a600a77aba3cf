//! Feet that stand, and how far they slide.

use super::size_of;
use crate::spans::spans;
use crate::{Clip, kinematics};
use glam::{DVec2, Vec3};

/// A foot is down when it is at most this far above its own lowest places, in sizes of the character.
const HEIGHT: f32 = 0.03;
/// A foot is a joint whose lowest places are at most this far above the ground, in sizes.
const REACH: f32 = 0.06;
/// A foot that stands moves slower than this, in sizes a second.
const SPEED: f32 = 0.15;
/// Speed is taken over this many seconds.
const OVER: f64 = 1.0 / 30.0;
/// Shorter contacts are passing by, seconds.
const SHORTEST: f64 = 0.08;

/// When the ends of a character's limbs stand on the ground.
#[derive(Debug, Clone, PartialEq)]
pub struct Contacts {
    /// For each contact the joint, its first frame, and its last.
    pub spans: Vec<(usize, usize, usize)>,
}

/// How far standing feet slide over the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slide {
    /// Number of contacts.
    pub contacts: usize,
    /// Mean step of a standing foot from frame to frame, millimetres.
    pub mean_step_mm: f64,
    /// The 95th percentile of these steps, millimetres.
    pub p95_step_mm: f64,
    /// Mean distance between where a foot is put down and where it is lifted, millimetres.
    pub mean_drift_mm: f64,
    /// Largest of these distances, millimetres.
    pub max_drift_mm: f64,
}

impl Contacts {
    /// Finds contacts by height and speed: joints without children (toes, paws, tips) that are low and slow for at
    /// least 0.08 s. Hands that lean on the ground count too, and so
    /// does the tip of a tail that lies still.
    pub fn of(clip: &Clip) -> Self {
        let joints = clip.skeleton().joints();
        let positions = kinematics::positions(clip);
        let size = size_of(clip.skeleton()) as f32;
        let mut ends = vec![true; joints.len()];
        for parent in joints.iter().filter_map(|joint| joint.parent) {
            ends[parent] = false;
        }
        let ends: Vec<usize> = (0..joints.len()).filter(|&joint| ends[joint]).collect();
        let lows: Vec<f32> = (ends.iter())
            .map(|&joint| low((0..clip.frames()).map(|frame| positions.frame(frame)[joint].y).collect()))
            .collect();
        let ground = lows.iter().copied().fold(f32::MAX, f32::min);
        let reach = ((0.5 * OVER * clip.frame_rate()).round() as usize).max(1);
        let shortest = (SHORTEST * clip.frame_rate()).ceil().max(2.0) as usize;
        let mut found = Vec::new();
        for (&joint, &low) in ends.iter().zip(&lows) {
            if low > ground + REACH * size {
                continue;
            }
            let stands = |frame: usize| {
                let (before, after) = (frame.saturating_sub(reach), (frame + reach).min(clip.frames() - 1));
                let step = positions.frame(after)[joint] - positions.frame(before)[joint];
                let seconds = (after - before) as f32 / clip.frame_rate() as f32;
                positions.frame(frame)[joint].y < low + HEIGHT * size
                    && step.length() < SPEED * size * seconds
            };
            let stands: Vec<bool> = (0..clip.frames()).map(stands).collect();
            found.extend(spans(&stands, shortest).into_iter().map(|(first, last)| (joint, first, last)));
        }
        Self { spans: found }
    }

    /// How far the feet slide during these contacts in a clip of the same skeleton and length; `None` without
    /// contacts.
    ///
    /// # Panics
    /// When the clip has fewer joints or frames than the one in which the contacts were found.
    pub fn slide(&self, clip: &Clip) -> Option<Slide> {
        let positions = kinematics::positions(clip);
        let place = |joint: usize, frame: usize| over_ground(positions.frame(frame)[joint]);
        let (mut steps, mut drifts) = (Vec::new(), Vec::new());
        for &(joint, first, last) in &self.spans {
            steps.extend((first..last).map(|frame| place(joint, frame).distance(place(joint, frame + 1))));
            drifts.push(place(joint, first).distance(place(joint, last)));
        }
        steps.sort_unstable_by(f64::total_cmp);
        let last = steps.len().checked_sub(1)?;
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        Some(Slide {
            contacts: self.spans.len(),
            mean_step_mm: 1e3 * mean(&steps),
            p95_step_mm: 1e3 * steps[(0.95 * last as f64).round() as usize],
            mean_drift_mm: 1e3 * mean(&drifts),
            max_drift_mm: 1e3 * drifts.iter().copied().fold(0.0, f64::max),
        })
    }
}

fn over_ground(place: Vec3) -> DVec2 {
    DVec2::new(f64::from(place.x), f64::from(place.z))
}

/// The value below which a twentieth lies.
fn low(mut heights: Vec<f32>) -> f32 {
    let rank = (heights.len() - 1) / 20;
    *heights.select_nth_unstable_by(rank, f32::total_cmp).1
}
