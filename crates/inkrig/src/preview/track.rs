//! Where the joints of a clip are over time, small enough to be sent with a page.

use super::encode::{base64, decimals};
use inkrig_motion::{Clip, capsules::Body, glam::Vec3, kinematics::Pose};
use serde::Serialize;

/// Most coordinates that are sent of one clip: 4 MB of text.
const MOST_VALUES: usize = 1_500_000;

/// Joint positions of a clip. A joint is at `origin + scale * offset`; the origin follows the character, so that
/// 16 bits are fine enough however far it travels.
#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Track {
    /// Frames a second of what is sent.
    rate: f64,
    frames: usize,
    joints: usize,
    /// frames x 3 little-endian f32 in base64, metres, from where the clip begins, height above the ground.
    origins: String,
    /// frames x joints x 3 little-endian i16 in base64.
    offsets: String,
    scale: f64,
}

impl Track {
    /// Takes frames of the clip so that there are at most `most_rate` a second and the page stays small.
    pub(super) fn of(clip: &Clip, body: &Body, most_rate: f64) -> Self {
        let step = step(clip, body, most_rate);
        let (origins, offsets) = sample(clip, body, step);
        let largest = offsets.iter().map(|offset| offset.abs().max_element()).fold(0.0, f32::max);
        let scale = f64::from(largest.max(f32::MIN_POSITIVE)) / f64::from(i16::MAX);
        let mut coded = Vec::with_capacity(offsets.len() * 6);
        for value in offsets.iter().flat_map(Vec3::to_array) {
            coded.extend(((f64::from(value) / scale).round() as i16).to_le_bytes());
        }
        let places = origins.iter().flat_map(Vec3::to_array).flat_map(f32::to_le_bytes);
        Self {
            rate: decimals(clip.frame_rate() / step as f64, 6),
            frames: origins.len(),
            joints: body.joints.len(),
            origins: base64(&places.collect::<Vec<u8>>()),
            offsets: base64(&coded),
            scale,
        }
    }
}

/// Every which frame of the clip is sent.
fn step(clip: &Clip, body: &Body, most_rate: f64) -> usize {
    let for_rate = (clip.frame_rate() / most_rate - 1e-3).ceil().max(1.0) as usize;
    let frames = (MOST_VALUES / (3 * body.joints.len())).max(1);
    for_rate.max(clip.frames().div_ceil(frames))
}

/// Origins, and for every frame the offsets of all drawn joints from its origin.
fn sample(clip: &Clip, body: &Body, step: usize) -> (Vec<Vec3>, Vec<Vec3>) {
    let (mut origins, mut offsets, mut lows) = (Vec::new(), Vec::new(), Vec::new());
    let mut pose = Pose::new(clip.skeleton());
    for frame in (0..clip.frames()).step_by(step) {
        pose.set(clip, frame);
        let origin = usable(pose.positions[body.travel_joint]);
        let places = body.joints.iter().map(|&joint| usable(pose.positions[joint]));
        lows.push(places.clone().map(|place| place.y).fold(f32::MAX, f32::min));
        offsets.extend(places.map(|place| place - origin));
        origins.push(origin);
    }
    let first = origins.first().copied().unwrap_or(Vec3::ZERO);
    let start = Vec3::new(first.x, ground(&mut lows, body.size), first.z);
    origins.iter_mut().for_each(|origin| *origin -= start);
    (origins, offsets)
}

/// Height of the ground from the lowest joint of every pose: jumps and a few feet below the floor do not move it.
pub(crate) fn ground(lows: &mut [f32], size: f32) -> f32 {
    const FOOT: f32 = 0.008;
    if lows.is_empty() {
        return 0.0;
    }
    let rank = (lows.len() - 1) / 20;
    let (_, &mut low, _) = lows.select_nth_unstable_by(rank, f32::total_cmp);
    low - FOOT * size
}

/// A place that can be drawn: finite and not farther than light goes in an hour.
pub(crate) fn usable(place: Vec3) -> Vec3 {
    if place.is_finite() { place.clamp(Vec3::splat(-1e12), Vec3::splat(1e12)) } else { Vec3::ZERO }
}
