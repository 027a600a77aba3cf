//! Frames of the finished motion that are settled exactly, and how the rest goes over into them.

use crate::reconstruct::Ends;
use inkrig_motion::glam::{Quat, Vec3};
use inkrig_motion::root::{RootMotion, wrap_angle};
use inkrig_motion::rotation::twist_angle;
use inkrig_motion::{Clip, MotionError, TranslationTrack};
use std::ops::Range;

/// What the finished motion is exactly; frames at the source's own rate.
#[derive(Debug, Clone, PartialEq)]
pub enum Anchor<'a> {
    /// The pose of a frame of the source.
    Frame {
        /// Frame of the result.
        at: usize,
        /// Frame of the source.
        source: usize,
    },
    /// A part of another clip of that skeleton and rate, place in the world included.
    Clip {
        /// Frames of the result, which are the same frames of the clip.
        at: Range<usize>,
        /// The clip; it may be longer than the part.
        clip: &'a Clip,
    },
}

impl Anchor<'_> {
    /// Its first frame in the result.
    pub fn first(&self) -> usize {
        match self {
            Self::Frame { at, .. } => *at,
            Self::Clip { at, .. } => at.start,
        }
    }

    /// Its last frame in the result.
    pub fn last(&self) -> usize {
        match self {
            Self::Frame { at, .. } => *at,
            Self::Clip { at, .. } => at.end.max(at.start + 1) - 1,
        }
    }
}

/// How much of each frame an anchor's own movement makes up.
pub(crate) struct Fades {
    /// First and last frame, and how far each reaches before and after.
    spans: Vec<(isize, isize, f64, f64)>,
    ring: Option<isize>,
}

/// The share of an anchor in a frame.
pub(crate) struct Fade {
    /// Which anchor.
    pub(crate) anchor: usize,
    /// The frame, counted on beyond the ends of a loop so that it lies beside the anchor.
    pub(crate) frame: isize,
    /// 0..=1, and 1 on the anchor itself.
    pub(crate) share: f32,
}

impl Fades {
    /// For anchors in order of time. Each reaches over at most `reach` frames and never onto the next one, so that all
    /// are exact and their shares never sum to more than 1.
    pub(crate) fn new(anchors: &[Anchor<'_>], frames: usize, ends: Ends, reach: f64) -> Self {
        let ring = (ends == Ends::Loop).then_some(frames as isize);
        let at = |anchor: &Anchor<'_>| (anchor.first() as isize, anchor.last() as isize);
        let gap = |before: Option<&Anchor<'_>>, after: Option<&Anchor<'_>>| {
            let gap = match (before, after, ring) {
                (Some(before), Some(after), _) => at(after).0 - at(before).1,
                // Around the seam, from the last to the first.
                (_, _, Some(frames)) => {
                    let (first, last) =
                        (anchors.first().map_or(0, |a| at(a).0), anchors.last().map_or(0, |a| at(a).1));
                    frames - last + first
                }
                _ => return reach.max(1.0),
            };
            (gap as f64).clamp(1.0, reach.max(1.0))
        };
        let spans = anchors.iter().enumerate().map(|(index, anchor)| {
            let before = index.checked_sub(1).and_then(|before| anchors.get(before));
            let (first, last) = at(anchor);
            (first, last, gap(before, Some(anchor).filter(|_| before.is_some())), {
                let after = anchors.get(index + 1);
                gap(Some(anchor).filter(|_| after.is_some()), after)
            })
        });
        Self { spans: spans.collect(), ring }
    }

    /// The anchors that have a share in a frame.
    pub(crate) fn at(&self, frame: usize) -> impl Iterator<Item = Fade> + '_ {
        let shifts = self.ring.map_or([0; 3], |frames| [0, -frames, frames]);
        self.spans.iter().enumerate().filter_map(move |(anchor, &(first, last, before, after))| {
            let place = |shift: isize| {
                let frame = frame as isize + shift;
                let (early, late) = ((first - frame).max(0) as f64, (frame - last).max(0) as f64);
                (frame, (early / before).max(late / after))
            };
            let (frame, away) = shifts.into_iter().map(place).min_by(|a, b| a.1.total_cmp(&b.1))?;
            let share = (0.5 * std::f64::consts::PI * away.min(1.0)).cos().powi(2) as f32;
            (away < 1.0).then_some(Fade { anchor, frame, share })
        })
    }
}

/// Puts clips that are anchors into a motion exactly, and moves the parts around them so that its way joins on: what
/// comes before the first and after the last goes along as it is, between two the way is bent evenly to meet both.
pub(crate) fn join(result: &Clip, travel_joint: usize, anchors: &[Anchor<'_>]) -> Result<Clip, MotionError> {
    let parts: Vec<(&Range<usize>, &Clip)> = (anchors.iter())
        .filter_map(|anchor| if let Anchor::Clip { at, clip } = anchor { Some((at, *clip)) } else { None })
        .collect();
    if parts.is_empty() {
        return Ok(result.clone());
    }
    let own = RootMotion::of_joint(&result.clone().into(), travel_joint);
    let way = way(&own, &parts, travel_joint);
    let skeleton = result.skeleton();
    let above = skeleton.ancestors(travel_joint);
    let carried: Vec<bool> = (skeleton.joints().iter().enumerate())
        .map(|(joint, data)| data.parent.is_none() && joint != travel_joint && !above[joint])
        .collect();
    let into_parent = own.world_from_parent.inverse();
    let part_of = |frame: usize| parts.iter().find(|(at, _)| at.contains(&frame)).map(|(_, clip)| *clip);
    let mut rotations = Vec::with_capacity(result.frames() * skeleton.len());
    for (frame, (turn, _)) in way.iter().enumerate() {
        if let Some(clip) = part_of(frame) {
            rotations.extend_from_slice(clip.rotations(frame));
            continue;
        }
        let turn = Quat::from_rotation_y(*turn);
        let local = result.rotations(frame).iter().enumerate();
        rotations.extend(local.map(|(joint, &rotation)| match joint {
            _ if joint == travel_joint => into_parent * (turn * own.rotations[frame]),
            _ if carried[joint] => turn * rotation,
            _ => rotation,
        }));
    }
    let translations = (result.translations().iter())
        .map(|track| TranslationTrack {
            joint: track.joint,
            values: (track.values.iter().enumerate())
                .map(|(frame, &value)| {
                    let (turn, place) = way[frame];
                    if let Some(clip) = part_of(frame) {
                        let offset = skeleton.joints()[track.joint].offset;
                        clip.track(track.joint).map_or(offset, |values| values[frame])
                    } else if track.joint == travel_joint {
                        into_parent * (place - own.parent_in_world)
                    } else if carried[track.joint] {
                        place + Quat::from_rotation_y(turn) * (value - own.places[frame])
                    } else {
                        value
                    }
                })
                .collect(),
        })
        .collect();
    Clip::new(skeleton.clone(), result.frame_rate(), rotations, translations)
}

/// The turn about the vertical and the new place of every frame.
fn way(own: &RootMotion, parts: &[(&Range<usize>, &Clip)], travel_joint: usize) -> Vec<(f32, Vec3)> {
    let frames = own.places.len();
    let mut way: Vec<(f32, Vec3)> = own.places.iter().map(|&place| (0.0, place)).collect();
    // Where the part has the frame, and by how much it is turned against the motion as it was put together.
    let meet = |clip: &Clip, frame: usize| {
        let there = RootMotion::of_joint(&clip.clone().into(), travel_joint);
        let turn = twist_angle(there.rotations[frame] * own.rotations[frame].inverse(), Vec3::Y);
        (frame, wrap_angle(turn), there.places[frame])
    };
    let carried = |(at, turn, place): (usize, f32, Vec3), frame: usize| {
        let moved = place + Quat::from_rotation_y(turn) * (own.places[frame] - own.places[at]);
        (turn, Vec3::new(moved.x, own.places[frame].y, moved.z))
    };
    let mut before = None;
    for (at, clip) in parts {
        let (first, last) = (meet(clip, at.start), meet(clip, at.end - 1));
        match before {
            None => (0..at.start).for_each(|frame| way[frame] = carried(first, frame)),
            Some(before) => bend(own, before, first, &mut way),
        }
        before = Some(last);
    }
    if let Some(last) = before {
        (last.0 + 1..frames).for_each(|frame| way[frame] = carried(last, frame));
    }
    way
}

/// The way between two frames whose turn and place are given: turned little by little, then moved by what is missing.
fn bend(own: &RootMotion, from: (usize, f32, Vec3), to: (usize, f32, Vec3), way: &mut [(f32, Vec3)]) {
    let span = (to.0 - from.0) as f32;
    let share = |frame: usize| {
        let u = (frame - from.0) as f32 / span;
        u * u * u * (10.0 + u * (6.0 * u - 15.0))
    };
    let turned = wrap_angle(to.1 - from.1);
    let mut place = from.2;
    let between = || from.0 + 1..to.0 + 1;
    for (frame, spot) in between().zip(&mut way[between()]) {
        let turn = from.1 + turned * share(frame);
        let step = own.places[frame] - own.places[frame - 1];
        place += Quat::from_rotation_y(turn) * step;
        *spot = (turn, place);
    }
    let missing = to.2 - place;
    for (frame, spot) in between().zip(&mut way[between()]) {
        let moved = spot.1 + missing * share(frame);
        spot.1 = Vec3::new(moved.x, own.places[frame].y, moved.z);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::swinging;
    use inkrig_motion::time;

    #[test]
    fn anchors_are_exact_and_shares_never_exceed_one() {
        let frame = |at| Anchor::Frame { at, source: 0 };
        let anchors = [frame(2), frame(5), frame(20)];
        for ends in [Ends::Open, Ends::Loop] {
            let fades = Fades::new(&anchors, 24, ends, 6.0);
            for at in 0..24 {
                let shares: Vec<Fade> = fades.at(at).collect();
                let total: f32 = shares.iter().map(|fade| fade.share).sum();
                assert!(total <= 1.0 + 1e-6, "{at}: {total}");
                let exact = [2, 5, 20].contains(&at);
                assert_eq!(exact, shares.iter().any(|fade| fade.share == 1.0), "{at}");
                assert!(!exact || shares.len() == 1, "{at}");
            }
        }
        // The last reaches over the seam of a loop: frame 1 counts as 25.
        let ring = Fades::new(&anchors[1..], 24, Ends::Loop, 8.0);
        assert!(ring.at(1).any(|fade| fade.anchor == 1 && fade.frame == 25 && fade.share > 0.1));
        assert_eq!(Fades::new(&anchors[1..], 24, Ends::Open, 8.0).at(23).count(), 1);
    }

    #[test]
    fn parts_stay_where_they_are_and_the_way_joins_on() {
        let clip = swinging(4.0, 30.0);
        let moved = |turn: f32, shift: Vec3| {
            let turn = Quat::from_rotation_y(turn);
            let mut rotations: Vec<Quat> =
                (0..clip.frames()).flat_map(|f| clip.rotations(f).to_vec()).collect();
            rotations.iter_mut().step_by(4).for_each(|rotation| *rotation = turn * *rotation);
            let values = clip.track(0).unwrap().iter().map(|&place| turn * place + shift).collect();
            let track = TranslationTrack { joint: 0, values };
            Clip::new(clip.skeleton().clone(), 30.0, rotations, vec![track]).unwrap()
        };
        let (one, two) = (moved(2.0, Vec3::new(5.0, 0.0, 1.0)), moved(-2.5, Vec3::new(1.0, 0.0, 4.0)));
        let anchors = [Anchor::Clip { at: 20..40, clip: &one }, Anchor::Clip { at: 80..100, clip: &two }];
        let joined = join(&clip, 0, &anchors).unwrap();
        for (at, part) in [(20..40, &one), (80..100, &two)] {
            for frame in at {
                assert_eq!(joined.rotations(frame), part.rotations(frame));
                assert_eq!(joined.track(0).unwrap()[frame], part.track(0).unwrap()[frame]);
            }
        }
        let steps = |clip: &Clip| -> Vec<f32> {
            clip.track(0).unwrap().windows(2).map(|pair| pair[0].distance(pair[1])).collect()
        };
        let (before, after) = (steps(&clip), steps(&joined));
        for frame in (0..39).chain(99..120) {
            assert!(
                (before[frame] - after[frame]).abs() < 1e-4,
                "what is outside goes along as it is: {frame}"
            );
        }
        // 4 m have to be made up in 40 steps.
        assert!(after[39..80].iter().all(|step| *step < 0.4), "{after:?}");
        let turns = (0..120).map(|f| joined.rotations(f)[0].angle_between(joined.rotations(f + 1)[0]));
        assert!(turns.fold(0.0, f32::max) < 0.2);
        assert_eq!(join(&clip, 0, &[Anchor::Frame { at: 3, source: 4 }]).unwrap(), clip);
        assert_eq!(time::trim(&joined, 20..40).unwrap(), time::trim(&one, 20..40).unwrap());
    }
}
