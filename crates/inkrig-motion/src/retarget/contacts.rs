//! When feet stand, and whether the ground goes along under them.

use super::figure::Figure;
use super::reference::Reference;
use crate::kinematics::Positions;
use crate::spans::spans;
use glam::Vec3;

/// A foot is down when its ankle is at most this far above its own lowest place, in leg lengths.
const HEIGHT: f32 = 0.06;
/// A foot that stands moves slower than this, leg lengths a second.
const SPEED: f32 = 0.25;
/// A foot goes with a ground that goes along when it is at least so much of its speed on its way.
const WITH: f32 = 0.3;
/// Shorter contacts are passing by, and shorter gaps between two are none, seconds.
const SHORTEST: f64 = 0.1;

/// How the source stands.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Standing {
    /// Leg, first frame, last frame.
    pub(super) contacts: Vec<(usize, usize, usize)>,
    /// The figure goes where it is, and its feet slide while they are down, as in games: how the ground goes along under
    /// them, metres a second.
    pub(super) treadmill: Option<Vec3>,
    /// Frames of a T-pose at the beginning, in which nothing is held.
    pub(super) rest_pose_frames: usize,
    /// For each leg's ankle and ball, the height at which it stands, metres.
    pub(super) low: Vec<[Option<f32>; 2]>,
}

impl Standing {
    /// Height of the ground in the source: where feet stand, less how high they are over it in the reference pose. Where
    /// none stands, the lowest place that a foot came to.
    pub(super) fn ground(&self, figure: &Figure, reference: &Reference) -> f32 {
        let places = &reference.pose.positions;
        let sole = figure.sole(&reference.pose);
        let mut found = Vec::new();
        for (leg, low) in figure.legs.iter().zip(&self.low) {
            for (joint, low) in [leg.foot, leg.toes].into_iter().zip(low) {
                if let (Some(joint), Some(low)) = (joint, low) {
                    found.push(low - (places[joint].y - sole));
                }
            }
        }
        if found.is_empty() {
            return reference.ground;
        }
        found.iter().sum::<f32>() / found.len() as f32
    }
}

/// Finds contacts of the feet in the source; none in its first `rest_pose_frames`.
pub(super) fn find(
    positions: &Positions,
    figure: &Figure,
    ground: f32,
    leg: f32,
    rate: f64,
    rest_pose_frames: usize,
) -> Standing {
    let treadmill = treadmill(positions, figure, ground, leg, rate);
    let frames = positions.frames();
    let shortest = (SHORTEST * rate).ceil().max(2.0) as usize;
    let mut contacts = Vec::new();
    for (index, own) in figure.legs.iter().enumerate() {
        // The lower of ankle and ball decides: heels lift before the foot does.
        let mut stands = vec![false; frames];
        for joint in own.sole() {
            let Some(lowest) = lowest(positions, joint, ground, leg) else { continue };
            for (frame, slot) in stands.iter_mut().enumerate() {
                let (step, seconds) = step(positions, joint, frame, rate);
                let low = positions.frame(frame)[joint].y < lowest + HEIGHT * leg;
                let still = SPEED * leg * seconds;
                // On the spot a foot that stands goes with the ground, however evenly, and one that swings against it.
                let stays = treadmill.map_or(step.length() < still, |ground| {
                    step.y.abs() < still && step.dot(ground) > WITH * ground.length_squared() * seconds
                });
                *slot |= low && stays;
            }
        }
        // A T-pose at the beginning stands somewhere else.
        stands.iter_mut().take(rest_pose_frames).for_each(|slot| *slot = false);
        contacts.extend(spans(&stands, shortest).into_iter().map(|(first, last)| (index, first, last)));
    }
    let low = (figure.legs.iter().enumerate())
        .map(|(index, own)| {
            [own.foot, own.toes].map(|joint| standing_height(positions, joint?, index, &contacts))
        })
        .collect();
    Standing { contacts, treadmill, rest_pose_frames, low }
}

/// The lowest place of a joint; `None` where it never comes near the ground.
fn lowest(positions: &Positions, joint: usize, ground: f32, leg: f32) -> Option<f32> {
    let heights = (0..positions.frames()).map(|frame| positions.frame(frame)[joint].y);
    Some(heights.fold(f32::INFINITY, f32::min)).filter(|&lowest| lowest <= ground + 0.35 * leg)
}

/// How far a joint comes around a frame, and in how many seconds.
fn step(positions: &Positions, joint: usize, frame: usize, rate: f64) -> (Vec3, f32) {
    let (before, after) = (frame.saturating_sub(1), (frame + 1).min(positions.frames() - 1));
    let step = positions.frame(after)[joint] - positions.frame(before)[joint];
    (step, ((after - before).max(1) as f64 / rate) as f32)
}

/// How fast and where feet slide in the mean, metres a second, of a figure that stays where it is while they slide one way
/// and come back through the air; `None` for others. How fast they slide need not be even.
fn treadmill(positions: &Positions, figure: &Figure, ground: f32, leg: f32, rate: f64) -> Option<Vec3> {
    let frames = positions.frames();
    let seconds = (frames.saturating_sub(1) as f64 / rate) as f32;
    if figure.legs.is_empty() || seconds <= 0.0 {
        return None;
    }
    let mut speeds = Vec::new();
    for joint in figure.legs.iter().filter_map(|own| own.sole().next()) {
        let Some(lowest) = lowest(positions, joint, ground, leg) else { continue };
        for frame in 1..frames.saturating_sub(1) {
            if positions.frame(frame)[joint].y < lowest + 0.5 * HEIGHT * leg {
                let (step, seconds) = step(positions, joint, frame, rate);
                speeds.push(step.with_y(0.0) / seconds);
            }
        }
    }
    let count = speeds.len() as f32;
    let mean = speeds.iter().sum::<Vec3>() / count.max(1.0);
    let all = speeds.iter().map(|speed| speed.length()).sum::<f32>() / count.max(1.0);
    let middle = |frame: usize| figure.middle(positions.frame(frame)).with_y(0.0);
    let travels = middle(frames - 1).distance(middle(0)) / seconds;
    // Feet of one who travels stand; those of one who dances on the spot go all ways.
    let slides = all > 2.0 * SPEED * leg && mean.length() > 0.6 * all && travels < 0.25 * mean.length();
    slides.then_some(mean)
}

/// The height at which a joint is while its foot stands: a tenth of the contacts' frames are lower.
fn standing_height(
    positions: &Positions,
    joint: usize,
    leg: usize,
    contacts: &[(usize, usize, usize)],
) -> Option<f32> {
    let frames = contacts.iter().filter(|contact| contact.0 == leg).flat_map(|contact| contact.1..=contact.2);
    let mut heights: Vec<f32> = frames.map(|frame| positions.frame(frame)[joint].y).collect();
    heights.sort_unstable_by(f32::total_cmp);
    heights.get(heights.len() / 10).copied()
}
