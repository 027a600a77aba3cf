//! Any skeleton: what it does comes from its clips, where it goes from the drawing.
//!
//! A drawn way of the whole body lies on the ground, unless the word is of leaving it, and is as long as the clip goes in its time: a
//! drawing without a figure has no size. All frames are seen in one world; each begins where the one before has come to.

mod base;
mod find;
mod pin;
mod read;
mod travel;
mod way;

pub use read::{CreatureFrame, CreatureWay, read_creature};

use super::{Library, Retrieved};
use crate::animation::{Exact, check_length};
use crate::error::StoryboardError;
use crate::exact::{Goal, Source};
use find::Window;
use inkrig_align::{Control, ControlKind, Options, Preset, align};
use inkrig_motion::glam::{DVec2, Vec2, Vec3};
use inkrig_motion::ground::{Contacts, Trajectory, TravelOptions, in_place};
use inkrig_motion::{Clip, Features, Takes, kinematics, time};
use std::ops::ControlFlow;
use travel::Piece;
use way::World;

/// More frames a second are not made.
const MOST_RATE: f64 = 60.0;
/// A clip is played quicker or slower by at most these factors so that its feet suit the drawn speed.
const PACES: std::ops::RangeInclusive<f64> = 0.4..=2.5;
/// Frames of examples that alignment is given at most.
const MOST_ALIGNED: usize = 6000;
/// What was aligned is taken where its feet and its jerk are, in the sum of both ratios, at most so much of what was taken as it was.
const BETTER: f64 = 1.8;
/// And where its joints move so much of how they move there.
const LIVELY: std::ops::RangeInclusive<f64> = 0.75..=1.5;

/// An animation of a skeleton that is no person's.
#[derive(Debug, Clone)]
pub struct Creature {
    /// On the skeleton of the examples.
    pub clip: Clip,
    /// What came of each frame.
    pub parts: Vec<CreaturePart>,
    /// What each frame asks of the whole.
    pub goals: Vec<Vec<Goal>>,
}

/// What came of a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct CreaturePart {
    /// The first frame of the animation, and how many.
    pub begins: usize,
    /// See `begins`.
    pub frames: usize,
    /// Where it is from.
    pub retrieved: Retrieved,
    /// Mean and largest distance on the picture between drawn places and joints before they were met, metres.
    pub before: [f32; 2],
    /// The same in the animation.
    pub after: [f32; 2],
    /// Metres of a canvas unit, where a way said so.
    pub metres_per_unit: Option<f32>,
}

/// A frame on its way to be a part of the animation.
struct Segment {
    piece: Piece,
    retrieved: Retrieved,
    metres_per_unit: f32,
}

/// Makes one animation of frames; `exact` says how ways are met.
///
/// # Errors
/// When there is no frame, or a clip cannot be changed.
pub fn creature(
    library: &Library,
    frames: &[CreatureFrame],
    exact: &Exact,
) -> Result<Creature, StoryboardError> {
    let none = || StoryboardError::Examples { problem: "there is no frame".into(), todo: "Draw one".into() };
    check_length(frames.iter().map(|frame| frame.seconds))?;
    let rate = library.examples.first().map_or(30.0, |first| first.clip.frame_rate().min(MOST_RATE));
    let drawn = *exact != Exact::Off;
    let mut segments = Vec::new();
    for frame in frames {
        let world = World::of(frame).filter(|_| drawn);
        let window = find::nearest(library, frame, world.as_ref()).ok_or_else(none)?;
        let plain = plain(&window, frame, world.as_ref(), rate)?;
        let better = match &world {
            Some(world) => {
                aligned(library, &window, frame, world, rate)?.filter(|other| is_better(other, &plain))
            }
            None => None,
        };
        segments.push(better.unwrap_or(plain));
    }
    let pieces: Vec<&Piece> = segments.iter().map(|segment| &segment.piece).collect();
    let (clip, starts) = travel::placed(&pieces)?.ok_or_else(none)?;
    finished(clip, &starts, frames, &segments, exact)
}

/// Meets the ways, and says how well.
fn finished(
    mut clip: Clip,
    starts: &[usize],
    frames: &[CreatureFrame],
    segments: &[Segment],
    exact: &Exact,
) -> Result<Creature, StoryboardError> {
    let placed = clip.clone();
    let mut goals = Vec::new();
    let carrier = clip.travel_joint();
    let before = kinematics::positions(&placed);
    // How far a body was shifted at the end of the last way, and when.
    let (mut given, mut since) = (Vec3::ZERO, 0);
    for ((frame, segment), start) in frames.iter().zip(segments).zip(starts) {
        // The next way begins where the shift has left the body by then.
        let given_now = given * pin::left(placed.frame_rate(), start - since);
        let travels = if *exact == Exact::Off {
            Vec::new()
        } else {
            goals_of(&placed, frame, segment, *start, true, given_now)
        };
        if let Some(last) = travels.last().filter(|last| last.frame < before.frames()) {
            let at = before.frame(last.frame).get(carrier).copied().unwrap_or_default();
            (given, since) = (last.nearest(at) - at, last.frame);
        }
        goals.push(travels);
    }
    let pinned = matches!(exact, Exact::Pin(_));
    if pinned {
        clip = pin::carried(&clip, &goals.concat())?;
    }
    let mut limbs: Vec<Goal> = Vec::new();
    if *exact != Exact::Off {
        for (at, (frame, segment)) in frames.iter().zip(segments).enumerate() {
            let Some(start) = starts.get(at) else { continue };
            let own = goals_of(&clip, frame, segment, *start, false, Vec3::ZERO);
            limbs.extend(&own);
            if let Some(goals) = goals.get_mut(at) {
                goals.extend(own);
            }
        }
    }
    if pinned {
        let mut joints: Vec<usize> = limbs.iter().map(|goal| goal.joint).collect();
        joints.sort_unstable();
        joints.dedup();
        for joint in joints {
            clip = pin::reached(&clip, joint, &limbs)?;
        }
    }
    let after = kinematics::positions(&clip);
    let parts = segments.iter().zip(starts).zip(&goals).map(|((segment, start), goals)| CreaturePart {
        begins: *start,
        frames: segment.piece.clip.frames(),
        retrieved: segment.retrieved.clone(),
        before: missed(&before, goals),
        after: missed(&after, goals),
        metres_per_unit: (segment.metres_per_unit > 0.0).then_some(segment.metres_per_unit),
    });
    Ok(Creature { parts: parts.collect(), clip, goals })
}

fn missed(places: &kinematics::Positions, goals: &[Goal]) -> [f32; 2] {
    let off: Vec<f32> = goals
        .iter()
        .filter(|goal| goal.frame < places.frames())
        .filter_map(|goal| Some(goal.miss(*places.frame(goal.frame).get(goal.joint)?).length()))
        .collect();
    [off.iter().sum::<f32>() / off.len().max(1) as f32, off.iter().copied().fold(0.0, f32::max)]
}

/// What a frame's ways ask for: those of the body's carrier, or all others. A way begins where its joint is; `given`: how far that is
/// shifted already.
fn goals_of(
    clip: &Clip,
    frame: &CreatureFrame,
    segment: &Segment,
    start: usize,
    carrier: bool,
    given: Vec3,
) -> Vec<Goal> {
    let places = kinematics::positions(clip);
    let view = frame.camera.view_from_world();
    let axes = [view.row(0), view.row(1)];
    let mut goals = Vec::new();
    // A limb's line goes with a body whose own way is not drawn.
    let with_body = !carrier && !frame.ways.iter().any(|way| way.travels);
    let path = Trajectory::of(clip, &TravelOptions::default()).path;
    let gone = |at: usize| {
        let by = path.get(at).zip(path.get(start)).map_or(DVec2::ZERO, |(at, from)| *at - *from);
        let by = if with_body { Vec3::new(by.x as f32, 0.0, by.y as f32) } else { Vec3::ZERO };
        Vec2::new(axes[0].dot(by), axes[1].dot(by))
    };
    for way in frame.ways.iter().filter(|way| way.travels == carrier) {
        let count = ((way.seconds * clip.frame_rate()).round() as usize + 1).min(segment.piece.clip.frames());
        let Some(begin) = places.frame(start).get(way.joint).map(|place| *place + given) else { continue };
        let from = Vec2::new(axes[0].dot(begin), axes[1].dot(begin));
        let scale = segment.metres_per_unit;
        let scale = if scale > 0.0 { scale } else { scale_of_limb(clip, way, (start, count), axes) };
        let last = way.points.len() - 1;
        for number in 0..count {
            let place = last as f32 * number as f32 / (count.max(2) - 1) as f32;
            let low = (place.floor() as usize).min(last);
            let at = way.points[low].lerp(way.points[(low + 1).min(last)], place.fract());
            goals.push(Goal {
                frame: start + number,
                joint: way.joint,
                axes,
                at: from + gone(start + number) + scale * (at - way.points[0]),
                away: None,
                source: Source::Way,
            });
        }
    }
    goals
}

/// A joint's way without one of the body is as large as what the joint does in the clip, and at least a tenth of the body.
fn scale_of_limb(clip: &Clip, way: &CreatureWay, (start, count): (usize, usize), axes: [Vec3; 2]) -> f32 {
    let places = kinematics::positions(clip);
    let carrier = clip.travel_joint();
    let seen = (start..(start + count).min(clip.frames())).filter_map(|frame| {
        let pose = places.frame(frame);
        Some(*pose.get(way.joint)? - *pose.get(carrier)?)
    });
    let own = reach(seen.map(|place| Vec2::new(axes[0].dot(place), axes[1].dot(place))));
    own.max(0.1 * clip.skeleton().extent()) / reach(way.points.iter().copied()).max(f32::MIN_POSITIVE)
}

/// The diagonal of what points cover.
fn reach(points: impl Iterator<Item = Vec2>) -> f32 {
    let (low, high) =
        points.fold((Vec2::INFINITY, Vec2::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)));
    if low.x <= high.x { low.distance(high) } else { 0.0 }
}

/// The window as it is: repeated where it is short, at the pace of the drawn way.
fn plain(
    window: &Window<'_>,
    frame: &CreatureFrame,
    world: Option<&World>,
    rate: f64,
) -> Result<Segment, StoryboardError> {
    let own = time::trim(&window.of.clip, window.first..window.first + window.length)?;
    let own = if own.frame_rate() == rate { own } else { time::resample(&own, rate)? };
    let speed = base::speed(&own);
    let steps = ((frame.seconds * rate).round() as usize).max(2);
    let scale = world
        .map_or(0.0, |world| speed as f32 * world.seconds as f32 / world.length().max(f32::MIN_POSITIVE));
    let times = match world {
        Some(world) => times(world, f64::from(scale) / speed.max(1e-6), steps, rate),
        None => (0..steps).map(|step| step as f64 / rate).collect(),
    };
    let needed = (times.last().copied().unwrap_or(0.0) * rate).ceil() as usize + 1;
    let long = base::at_least(&own, needed)?;
    segment(&long, &times, (window, false), world, scale)
}

/// When of a clip each frame is: it is played as fast as the way goes. `pace`: how much of the clip's speed a canvas unit a second is.
fn times(world: &World, pace: f64, steps: usize, rate: f64) -> Vec<f64> {
    let over = 0.15;
    let mut passed = 0.0;
    let mut times = vec![0.0];
    for step in 1..steps {
        let at = step as f64 / rate;
        let (from, to) = ((at - over).max(0.0), (at + over).min(world.seconds.max(at)));
        let speed = f64::from(world.at(to).distance(world.at(from))) / (to - from).max(1e-6);
        passed += (speed * pace).clamp(*PACES.start(), *PACES.end()) / rate;
        times.push(passed);
    }
    times
}

fn segment(
    clip: &Clip,
    times: &[f64],
    (window, aligned): (&Window<'_>, bool),
    world: Option<&World>,
    metres_per_unit: f32,
) -> Result<Segment, StoryboardError> {
    let own = Trajectory::of(clip, &TravelOptions::default()).path;
    let last = own.len().saturating_sub(1);
    let path: Vec<DVec2> = times
        .iter()
        .map(|time| {
            let place = (time * clip.frame_rate()).clamp(0.0, last as f64);
            let low = place.floor() as usize;
            own[low].lerp(own[(low + 1).min(last)], place.fract())
        })
        .collect();
    let front = travel::front(clip);
    let clip = base::at_times(&in_place(clip, &TravelOptions::default())?, times)?;
    let rate = clip.frame_rate();
    let way = world.map(|world| {
        (0..clip.frames()).map(|frame| world.at(frame as f64 / rate) * metres_per_unit).collect()
    });
    let first = window.first as f64 / window.of.clip.frame_rate();
    let retrieved = Retrieved {
        example: window.of.name.clone(),
        seconds: [first, first + window.length as f64 / window.of.clip.frame_rate()],
        word: window.word,
        path: window.path,
        pose: None,
        aligned,
    };
    Ok(Segment { piece: Piece { clip, path, front, way }, retrieved, metres_per_unit })
}

/// All clips of the window's word, arranged anew so that they follow the way; nothing where they are too short or too still.
fn aligned(
    library: &Library,
    window: &Window<'_>,
    frame: &CreatureFrame,
    world: &World,
    rate: f64,
) -> Result<Option<Segment>, StoryboardError> {
    let mut clips = Vec::new();
    let mut frames = 0;
    for example in &library.examples {
        let same = super::words::distance(&frame.word, &example.said) <= window.word;
        if same && frames + example.clip.frames() <= MOST_ALIGNED {
            frames += example.clip.frames();
            clips.push(time::resample(&example.clip, rate)?);
        }
    }
    let steps = ((frame.seconds * rate).round() as usize).max(2);
    let rows: Vec<f32> = (0..steps).flat_map(|step| world.at(step as f64 / rate).to_array()).collect();
    let control = Control {
        features: Features::new(rows, 3)?,
        rate,
        cyclic: false,
        domain: None,
        kind: ControlKind::Curve,
        heard: None,
    };
    let Ok(takes) = Takes::join(&clips) else { return Ok(None) };
    let Ok(done) =
        align(&takes, &control, &Options::preset(Preset::Natural), &mut |_| ControlFlow::Continue(()))
    else {
        return Ok(None);
    };
    let speed = base::speed(&done.clip);
    let scale = speed as f32 * world.seconds as f32 / world.length().max(f32::MIN_POSITIVE);
    let times: Vec<f64> = (0..steps).map(|step| step as f64 / rate).collect();
    segment(&done.clip, &times, (window, true), Some(world), scale).map(Some)
}

/// Whether feet slide less and joints jerk less, each where it goes on its way, and it is as lively: what is played slowly slides little.
fn is_better(other: &Segment, plain: &Segment) -> bool {
    let judged = |segment: &Segment| -> Option<[f64; 3]> {
        let (clip, _) = travel::placed(&[&segment.piece]).ok()??;
        let slide = Contacts::of(&clip).slide(&clip).map_or(0.0, |slide| slide.mean_step_mm);
        Some([slide + 1.0, jerk(&clip) + 1e-9, life(&segment.piece.clip) + 1e-9])
    };
    match (judged(other), judged(plain)) {
        (Some(other), Some(plain)) => {
            other[0] / plain[0] + other[1] / plain[1] < BETTER && LIVELY.contains(&(other[2] / plain[2]))
        }
        _ => false,
    }
}

/// The mean step of all joints beside the one that carries the body, metres.
fn life(clip: &Clip) -> f64 {
    let places = kinematics::positions(clip).relative_to(clip.travel_joint());
    let (mut sum, mut count) = (0.0, 0.0_f64);
    for frame in 1..clip.frames() {
        for (a, b) in places.frame(frame - 1).iter().zip(places.frame(frame)) {
            sum += f64::from(a.distance(*b));
            count += 1.0;
        }
    }
    sum / count.max(1.0)
}

/// The mean third difference of all joints' places, metres.
fn jerk(clip: &Clip) -> f64 {
    let places = kinematics::positions(clip);
    let (mut sum, mut count) = (0.0, 0.0_f64);
    for frame in 3..clip.frames() {
        let at = |back: usize, joint: usize| places.frame(frame - back)[joint];
        for joint in 0..places.joints() {
            sum +=
                f64::from((at(0, joint) - 3.0 * at(1, joint) + 3.0 * at(2, joint) - at(3, joint)).length());
            count += 1.0;
        }
    }
    sum / count.max(1.0)
}
