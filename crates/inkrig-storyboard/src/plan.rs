//! What the model is asked for by a frame.

use crate::attach::{Way, attach};
use crate::calibrate::Calibration;
use crate::error::{Problem, StoryboardError};
use crate::exact::Source;
use crate::figure::Figure;
use crate::page::Page;
use crate::path;
use crate::space::Space;
use crate::timing::{LEAST, timed, usual_speed};
use inkrig_generate::guidance::Ask;
use inkrig_generate::readers::network::Work;
use inkrig_generate::readers::word::{WordReader, line};
use inkrig_motion::glam::{Vec2, Vec3};
use inkrig_motion::humanml::{Camera, FRAME_RATE, JOINTS, Joints, NAMES};
use inkrig_sketch::storyboard::{End, Frame, FramePath, Stroke};
use inkrig_sketch::{Ends, smooth};

/// Frames of a clip of which nothing else says how long it is: what the model was trained with.
const USUAL_FRAMES: usize = 40;
/// Joints of a key pose that a motion is asked for. Hips and collars are drawn where they suit the artist.
const ASKED: [usize; 14] = [0, 3, 4, 5, 7, 8, 10, 11, 12, 15, 18, 19, 20, 21];
/// For each of [`ASKED`] after the pelvis: the joint before it, and the bones between, whose lengths are the longest line.
const CHAINS: [(usize, usize, &[usize]); 13] = [
    (3, 0, &[3]),
    (4, 0, &[1, 4]),
    (5, 0, &[2, 5]),
    (12, 3, &[6, 9, 12]),
    (15, 12, &[15]),
    (7, 4, &[7]),
    (8, 5, &[8]),
    (10, 7, &[10]),
    (11, 8, &[11]),
    (18, 12, &[13, 16, 18]),
    (19, 12, &[14, 17, 19]),
    (20, 18, &[20]),
    (21, 19, &[21]),
];
/// A pinned line may be longer than its bones by this share.
const LONGER: f32 = 1.05;
/// Hand tremor is smoothed over so many frames, as a standard deviation.
const TREMOR: f64 = 1.5;
/// Frames over which a way that begins beside a pinned joint is led to it.
const LED: usize = 6;
/// A named way that begins farther than this from its joint is moved there as a whole, metres.
const BESIDE: f32 = 0.3;
/// Views that the networks were taught, and a little more, degrees.
const PITCHES: std::ops::RangeInclusive<f64> = -5.0..=40.0;
const YAWS: std::ops::RangeInclusive<f64> = -50.0..=50.0;
/// Likelihood below which a read joint is left to the model.
const FAINT: f32 = 0.15;

/// A joint of a key pose, its place, and whether the user has pinned it.
pub type KeyJoint = (usize, Vec2, bool);

/// A frame in the model's terms. Places are on the picture, metres.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// What is done; empty where the frame does not say.
    pub word: String,
    /// Frames of the clip, 20 a second.
    pub frames: usize,
    /// The camera.
    pub camera: Camera,
    /// Whether it looks from where the networks were taught to look from.
    pub usual_view: bool,
    /// All joints of the figure, also those that nothing is asked of.
    pub pose: Vec<(usize, Vec2)>,
    /// The frame of the key pose, and its joints.
    pub keypose: Option<(usize, Vec<KeyJoint>)>,
    /// Ways of joints: joint, first frame, a place a frame.
    pub ways: Vec<(usize, usize, Vec<Vec2>)>,
    /// Whose way over the ground it takes over.
    pub follows: Option<FramePath>,
    /// That way, once it is made: where in the clip's own space the pelvis is, a place a frame; its height is told to the model, and no
    /// goal asks for it. See [`along`](Self::along).
    pub path: Option<Vec<Vec3>>,
    /// Whether the places are where a clip that begins at the origin has them. A figure at the end of its way stands where
    /// the motion will have taken it, which is known only when there is one.
    pub placed: bool,
    /// What is said of the motion in space, which no sampling sees: the motion is moved to it afterwards.
    pub space: Space,
}

/// A frame, and what was made of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Understood {
    /// What the model is asked for.
    pub plan: Plan,
    /// The figure, where one is drawn.
    pub figure: Option<Figure>,
    /// Whose ways the trajectories are.
    pub attached: Vec<Way>,
    /// What the user should know.
    pub notes: Vec<String>,
}

impl Plan {
    /// Nothing but a word.
    pub fn of_word(word: String, frames: usize, camera: Camera) -> Self {
        Self {
            word,
            frames,
            camera,
            usual_view: true,
            pose: Vec::new(),
            keypose: None,
            ways: Vec::new(),
            follows: None,
            path: None,
            placed: true,
            space: Space::default(),
        }
    }

    /// All that is asked for: frame, joint, place and what asks. A joint has one place a frame: its way's before its pose's.
    pub fn wanted(&self) -> Vec<(usize, usize, Vec2, Source)> {
        let mut all: Vec<(usize, usize, Vec2, Source)> = Vec::new();
        for (joint, first, places) in &self.ways {
            let way = places.iter().enumerate().map(|(at, place)| (first + at, *joint, *place, Source::Way));
            all.extend(way);
        }
        if let Some((frame, joints)) = &self.keypose {
            for (joint, at, pinned) in joints {
                // Where a path leads the body, the drawn pose goes along; where its pelvis is on the picture follows.
                let led = *joint == 0 && self.path.is_some() && !*pinned;
                if !led && !all.iter().any(|other| (other.0, other.1) == (*frame, *joint)) {
                    all.push((*frame, *joint, *at, if *pinned { Source::Pin } else { Source::Pose }));
                }
            }
        }
        all
    }

    /// The same in the form of guidance's targets.
    pub fn asks(&self) -> Vec<Ask> {
        let ask =
            |(frame, joint, at, _): (usize, usize, Vec2, Source)| Ask { frame, joint, place: at.extend(0.0) };
        self.wanted().into_iter().map(ask).collect()
    }

    /// Whether a trajectory asks for it.
    pub(crate) fn on_way(&self, ask: &Ask) -> bool {
        let own = |(joint, first, places): &(usize, usize, Vec<Vec2>)| {
            *joint == ask.joint && (*first..first + places.len()).contains(&ask.frame)
        };
        self.ways.iter().any(own)
    }

    /// All places moved on the picture.
    pub fn moved(&self, by: Vec2) -> Self {
        let mut plan = self.clone();
        plan.keypose.iter_mut().flat_map(|(_, joints)| joints).for_each(|(_, at, _)| *at += by);
        plan.pose.iter_mut().for_each(|(_, at)| *at += by);
        plan.ways.iter_mut().flat_map(|(_, _, places)| places).for_each(|at| *at += by);
        plan
    }

    /// Where the figure stands: the key pose's frame, or the first.
    pub fn key_frame(&self) -> usize {
        self.keypose.as_ref().map_or(0, |(frame, _)| *frame)
    }
}

/// Makes a plan of a frame (`number`, from 1). `body`: the bone that ends at each joint, metres. `words` reads a word
/// that was written by hand.
///
/// # Errors
/// [`StoryboardError::Frame`] with what cannot be understood, and what to do.
pub fn understand(
    frame: &Frame,
    number: usize,
    figure: Option<Figure>,
    body: &Joints,
    words: Option<&WordReader>,
) -> Result<Understood, StoryboardError> {
    let read = plan(frame, figure, body, words).and_then(|mut read| {
        path::check(frame.path, number, read.attached.iter().any(|way| way.joint == 0))?;
        let scale = read.figure.as_ref().and_then(|figure| Calibration::of(figure, body, &read.plan.camera));
        read.plan.space = Space::of(frame, &read.plan, body, scale.as_ref())?;
        Ok(read)
    });
    read.map_err(|problem| problem.of_frame(number))
}

fn plan(
    frame: &Frame,
    figure: Option<Figure>,
    body: &Joints,
    words: Option<&WordReader>,
) -> Result<Understood, Problem> {
    let mut notes = figure.as_ref().map_or_else(Vec::new, |figure| figure.notes.clone());
    let word = word(frame, words)?;
    if word.is_empty() && figure.is_none() && frame.trajectories.is_empty() && frame.path.is_none() {
        return Err(Problem::new(
            "it has no figure, no trajectory and no word",
            "Draw or type something, or delete it",
        ));
    }
    if word.is_empty() {
        notes.push(
            "there is no word: the motion follows the drawing alone. Type one, such as walk or kick".into(),
        );
    }
    let camera = Camera::new(
        frame.camera.pitch_degrees.to_radians() as f32,
        frame.camera.yaw_degrees.to_radians() as f32,
    );
    let said = frame.seconds.map(|seconds| ((seconds * FRAME_RATE).round() as usize).max(2));
    let usual_view =
        PITCHES.contains(&frame.camera.pitch_degrees) && YAWS.contains(&frame.camera.yaw_degrees);
    let empty =
        Plan { usual_view, follows: frame.path, ..Plan::of_word(word, said.unwrap_or(USUAL_FRAMES), camera) };
    let Some(figure) = figure else {
        if frame.trajectories.is_empty() {
            return Ok(Understood { plan: empty, figure: None, attached: Vec::new(), notes });
        }
        return Err(Problem::new(
            "there are trajectories, but no figure that says how large they are",
            "Draw a figure, however rough, or pin pelvis, neck and ankles",
        ));
    };
    let scale = Calibration::of(&figure, body, &camera).ok_or_else(|| {
        Problem::new("the figure's size cannot be told", "Draw a trunk and legs, or pin pelvis and neck")
    })?;
    pins_can_be(&figure, &scale, body)?;
    let attached = attach(frame, &empty.word, &figure, &scale)?;
    let pose = proportioned(&figure, &scale, body);
    let drawn: Vec<_> =
        attached.iter().map(|way| (way, duration(frame, way, &empty.word, &scale, &attached))).collect();
    let longest = drawn.iter().map(|(_, timed)| timed.frames()).max().unwrap_or(0);
    let frames = said.unwrap_or(longest.max(USUAL_FRAMES));
    let ends = attached.first().is_some_and(|way| way.figure == End::End);
    let key = if ends { frames - 1 } else { 0 };
    let whole = pose.iter().enumerate().filter_map(|(joint, at)| Some((joint, (*at)?))).collect();
    let mut plan = Plan { frames, pose: whole, ..empty };
    let mut joints: Vec<KeyJoint> = ASKED
        .into_iter()
        .filter_map(|joint| {
            let found = figure.joints[joint].filter(|found| found.pinned || found.confidence > FAINT)?;
            Some((joint, pose[joint]?, found.pinned))
        })
        .collect();
    for (way, timed) in drawn {
        let own = timed.frames().min(frames).max(LEAST.min(frames));
        if timed.frames() > frames {
            notes.push(format!(
                "trajectory {} takes {:.1} s as it is drawn; it is made to fit the frame's {:.1} s",
                way.trajectory + 1,
                timed.frames() as f64 / FRAME_RATE,
                frames as f64 / FRAME_RATE
            ));
        }
        let mut places = smoothed(&timed.points(own), &scale);
        let first = if ends { frames - own } else { 0 };
        let at = if ends { own - 1 } else { 0 };
        if let (Some(key), Some(begin)) = (pose[way.joint], places.get(at).copied()) {
            let off = key - begin;
            let pinned = figure.joints[way.joint].is_some_and(|found| found.pinned);
            if off.length() > BESIDE {
                places.iter_mut().for_each(|place| *place += off);
                notes.push(format!(
                    "trajectory {} is moved to {}, whose way it is said to be",
                    way.trajectory + 1,
                    NAMES.get(way.joint).copied().unwrap_or_default()
                ));
            } else if pinned {
                for (number, place) in places.iter_mut().enumerate() {
                    let away = number.abs_diff(at);
                    *place += off * (LED.saturating_sub(away) as f32 / LED as f32);
                }
            } else if let Some((_, place, _)) = joints.iter_mut().find(|(joint, _, _)| *joint == way.joint) {
                *place = begin;
            }
        }
        plan.ways.push((way.joint, first, places));
    }
    if ends {
        plan.placed = false;
        // The way of the pelvis itself says from where it came.
        if let Some((_, 0, places)) = plan.ways.iter().find(|(joint, _, _)| *joint == 0)
            && let Some(begin) = places.first()
        {
            let by = scale.origin - *begin;
            plan.keypose = Some((key, joints));
            plan = Plan { placed: true, ..plan.moved(by) };
            return Ok(Understood { plan, figure: Some(figure), attached, notes });
        }
    }
    plan.keypose = Some((key, joints));
    Ok(Understood { plan, figure: Some(figure), attached, notes })
}

/// The typed word, or the written one.
fn word(frame: &Frame, words: Option<&WordReader>) -> Result<String, Problem> {
    let typed = frame.word.trim();
    let (true, Some(words)) = (typed.is_empty(), words) else { return Ok(typed.to_owned()) };
    let Some(line) = Page::of(&frame.lettering).and_then(|page| line(&page.ink)) else {
        return Ok(String::new());
    };
    let reading = words.read(&line, &mut Work::default());
    match reading.verbs.first() {
        Some((verb, _, sure)) if *sure > reading.unknown => Ok((*verb).to_owned()),
        _ => {
            let near: Vec<&str> = reading.verbs.iter().take(3).map(|(verb, _, _)| *verb).collect();
            Err(Problem::new(
                format!("the written word reads as {:?}, which is no action that is known", reading.letters),
                format!("Near ones are {}; type one as \"word\"", near.join(", ")),
            ))
        }
    }
}

/// The time of a way, with the lines of speed that are nearer to it than to another.
fn duration(frame: &Frame, way: &Way, word: &str, scale: &Calibration, all: &[Way]) -> crate::timing::Timed {
    let points = |way: &Way| {
        frame.trajectories.get(way.trajectory).map_or(&[][..], |line| line.points.points.as_slice())
    };
    let middle = |dash: &Stroke| dash.points.get(dash.points.len() / 2).copied().unwrap_or_default();
    let away = |way: &Way, dash: &Stroke| {
        let at = middle(dash);
        let distances = points(way).iter().map(|point| crate::page::distance(*point, at));
        distances.fold(f64::INFINITY, f64::min)
    };
    let own = |dash: &&Stroke| all.iter().all(|other| away(way, dash) <= away(other, dash));
    let beside: Vec<&Stroke> = frame.speed_lines.iter().filter(own).collect();
    let empty = Stroke::default();
    let line = frame.trajectories.get(way.trajectory).map_or(&empty, |line| &line.points);
    timed(line, f64::from(usual_speed(way.joint, word)) * scale.units, &beside)
}

/// On the picture, without the hand's tremor; ends stay.
fn smoothed(points: &[[f64; 2]], scale: &Calibration) -> Vec<Vec2> {
    let plain: Vec<Vec2> = points.iter().map(|point| scale.picture(*point)).collect();
    let wide: Vec<[f64; 2]> = plain.iter().map(|at| [f64::from(at.x), f64::from(at.y)]).collect();
    let soft = smooth(&wide, TREMOR, Ends::Open);
    soft.map_or(plain, |soft| soft.iter().map(|[x, y]| Vec2::new(*x as f32, *y as f32)).collect())
}

/// Refuses pins of one limb that lie farther apart than its bones are long.
fn pins_can_be(figure: &Figure, scale: &Calibration, body: &Joints) -> Result<(), Problem> {
    let pinned = |joint: usize| figure.joints[joint].filter(|found| found.pinned).map(|found| found.at);
    for (joint, parent, bones) in CHAINS {
        let (Some(a), Some(b)) = (pinned(joint), pinned(parent)) else { continue };
        let long: f32 = bones.iter().map(|bone| body[*bone].length()).sum();
        let drawn = scale.picture(a).distance(scale.picture(b));
        if drawn > LONGER * long + 0.02 {
            return Err(Problem::new(
                format!(
                    "the pins of {} and {} contradict each other: they are {:.0} cm apart on a person of usual size, whose bones there are {:.0} cm long",
                    NAMES[parent],
                    NAMES[joint],
                    100.0 * drawn,
                    100.0 * long
                ),
                format!("Move {} nearer to {}, or leave one of them out", NAMES[joint], NAMES[parent]),
            ));
        }
    }
    Ok(())
}

/// The joints on the picture, lines that are longer than their bones shortened, so that a person can stand so.
fn proportioned(figure: &Figure, scale: &Calibration, body: &Joints) -> [Option<Vec2>; JOINTS] {
    let drawn: [Option<Vec2>; JOINTS] =
        std::array::from_fn(|joint| figure.at(joint).map(|at| scale.picture(at)));
    let mut pose = drawn;
    pose[0] = Some(drawn[0].unwrap_or(scale.origin));
    for (joint, parent, bones) in CHAINS {
        if figure.joints[joint].is_some_and(|found| found.pinned) {
            continue;
        }
        let long: f32 = bones.iter().map(|bone| body[*bone].length()).sum();
        pose[joint] = match (drawn[joint], drawn[parent], pose[parent]) {
            (Some(own), Some(before), Some(moved)) => {
                let line = own - before;
                Some(moved + line.clamp_length_max(0.995 * long))
            }
            (own, _, _) => own,
        };
    }
    pose
}

/// Where a camera sees a joint.
pub(crate) fn seen(camera: &Camera, place: Vec3) -> Vec2 {
    camera.project(place)
}
