//! What pictures of a storyboard show: every frame's drawing, and its part of the motion through its camera.

use super::Made;
use super::marks::marks;
use super::sheet::Rgb;
use inkrig_motion::glam::{Quat, Vec2, Vec3};
use inkrig_motion::humanml::{Camera, Joints, NAMES};
use inkrig_motion::kinematics::{Positions, positions};
use inkrig_motion::{Clip, Skeleton, rig};
use inkrig_sketch::storyboard::{Frame, Storyboard};
use inkrig_storyboard::{Creature, CreatureFrame, Figure, Goal, Kept, Source, Understood};

const LEFT: Rgb = [200, 50, 40];
const RIGHT: Rgb = [40, 80, 200];
pub(super) const MIDDLE: Rgb = [90, 90, 96];
/// Metres from top to bottom of a cell for a person, and for others in sizes of the body.
const PERSON: f32 = 2.3;
const OTHERS: f32 = 1.9;

/// A motion and the drawings that it was made of.
pub(super) struct Scene<'a> {
    pub(super) parts: Vec<Part<'a>>,
    pub(super) frame_rate: f64,
    pub(super) frames: usize,
    /// Metres that a cell shows from top to bottom.
    pub(super) metres: f32,
    /// From joint, to joint, and the colour.
    pub(super) bones: Vec<(usize, usize, Rgb)>,
    /// Neck and head of a person, who gets a round head.
    pub(super) head: Option<[usize; 2]>,
    places: Positions,
}

/// A frame of the storyboard.
pub(super) struct Part<'a> {
    pub(super) drawing: &'a Frame,
    pub(super) figure: Option<&'a Figure>,
    pub(super) begins: usize,
    pub(super) frames: usize,
    /// As its camera sees them.
    pub(super) goals: Vec<Goal>,
    pub(super) constraints: &'a [Kept],
    /// What carries the body.
    root: usize,
    camera: Camera,
    /// From the motion's world to the frame's own.
    back: Quat,
}

impl<'a> Scene<'a> {
    pub(super) fn of_person(board: &'a Storyboard, understood: &'a [Understood], made: &'a Made) -> Self {
        let joined = &made.animation.joined;
        let motion = positions(&made.animation.clip);
        let parts = board.frames.iter().zip(understood).enumerate().filter_map(|(at, (drawing, read))| {
            let plan = &made.clips.get(at)?.plan;
            let (camera, back) = (plan.camera, joined.placements.get(at)?.0.inverse());
            let goals = made.animation.goals.get(at)?.iter();
            let goals = goals.map(|goal| match goal.source {
                // A path is as high as the body.
                Source::Path if goal.frame < motion.frames() => {
                    let place = goal.nearest(motion.frame(goal.frame)[goal.joint]);
                    Goal { at: camera.project(back * place), ..*goal }
                }
                _ => *goal,
            });
            Some(Part {
                drawing,
                figure: read.figure.as_ref(),
                begins: *joined.starts.get(at)?,
                frames: plan.frames,
                goals: goals.collect(),
                constraints: made.animation.constraints.get(at).map(Vec::as_slice).unwrap_or_default(),
                root: 0,
                camera,
                back,
            })
        });
        let parts = parts.collect();
        let clip = &made.animation.clip;
        let name = |joint: usize| NAMES.get(joint).copied().unwrap_or_default().to_owned();
        let bones = bones(clip.skeleton(), true, &name);
        Self { head: Some([12, 15]), ..Self::new(clip, parts, PERSON, bones) }
    }

    pub(super) fn of_creature(board: &'a Storyboard, read: &[CreatureFrame], made: &'a Creature) -> Self {
        let root = made.clip.travel_joint();
        let parts = board.frames.iter().zip(read).zip(made.parts.iter().zip(&made.goals));
        let parts = parts.map(|((drawing, read), (part, goals))| Part {
            drawing,
            figure: None,
            begins: part.begins,
            frames: part.frames,
            goals: goals.clone(),
            constraints: &[],
            root,
            camera: read.camera,
            back: Quat::IDENTITY,
        });
        let parts = parts.collect();
        let skeleton = made.clip.skeleton();
        let name =
            |joint: usize| skeleton.joints().get(joint).map(|joint| joint.name.clone()).unwrap_or_default();
        Self::new(&made.clip, parts, OTHERS * skeleton.extent(), bones(skeleton, false, &name))
    }

    fn new(clip: &Clip, parts: Vec<Part<'a>>, metres: f32, bones: Vec<(usize, usize, Rgb)>) -> Self {
        Self {
            parts,
            frame_rate: clip.frame_rate(),
            frames: clip.frames(),
            metres,
            bones,
            head: None,
            places: positions(clip),
        }
    }

    /// All joints as a part's camera sees them, and the floor under the body.
    pub(super) fn seen(&self, part: &Part<'_>, frame: usize) -> Option<(Vec<Vec2>, Vec2)> {
        if frame >= self.frames {
            return None;
        }
        let pose = self.places.frame(frame);
        let see = |place: Vec3| part.camera.project(part.back * place);
        let under = pose.get(part.root)?.with_y(0.0);
        Some((pose.iter().map(|place| see(*place)).collect(), see(under)))
    }

    /// Lines that show which constraints hold at a frame of a person's motion.
    pub(super) fn marks(&self, part: &Part<'_>, frame: usize) -> Vec<Vec<Vec2>> {
        let pose: Option<Joints> =
            (frame < self.frames).then(|| self.places.frame(frame).try_into().ok()).flatten();
        let Some(pose) = pose else { return Vec::new() };
        let see = |place: Vec3| part.camera.project(part.back * place);
        let held = part.constraints.iter().filter(|kept| kept.constraint.frames.contains(&frame));
        let lines = held.flat_map(|kept| marks(&kept.constraint.rule, &pose));
        lines.map(|line| line.into_iter().map(see).collect()).collect()
    }

    /// The part that a frame of the motion belongs to.
    pub(super) fn part_at(&self, frame: usize) -> Option<&Part<'a>> {
        self.parts.iter().rev().find(|part| part.begins <= frame).or(self.parts.first())
    }
}

/// What is drawn of a skeleton. The model's `person` has a root that is its pelvis; of others, bones from the root hold the body up.
fn bones(skeleton: &Skeleton, person: bool, name: &dyn Fn(usize) -> String) -> Vec<(usize, usize, Rgb)> {
    let joints = skeleton.joints().iter().enumerate();
    let handles = rig::controls(skeleton);
    // A bone from the world's origin to what carries the body is none that anybody would draw.
    joints
        .filter_map(|(number, joint)| Some((joint.parent?, number, side_of(&name(number)))))
        .filter(|(parent, own, _)| !handles[*own] && !handles[*parent])
        .filter(|(parent, ..)| {
            person || skeleton.joints().get(*parent).is_some_and(|joint| joint.parent.is_some())
        })
        .collect()
}

/// The colour of a person's joint.
pub(super) fn side(joint: usize) -> Rgb {
    NAMES.get(joint).map_or(MIDDLE, |name| side_of(name))
}

/// The colour of a joint of that name.
fn side_of(name: &str) -> Rgb {
    let name = name.to_lowercase();
    let is = |word: &str, letter: char| {
        name.contains(word) || ['.', '_', ' '].iter().any(|sign| name.ends_with(&format!("{sign}{letter}")))
    };
    if is("left", 'l') {
        LEFT
    } else if is("right", 'r') {
        RIGHT
    } else {
        MIDDLE
    }
}
