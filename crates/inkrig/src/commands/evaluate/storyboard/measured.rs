//! What is measured of a motion that was made of a drawing.

use super::{Drawing, EvaluationWindow, Understood};
use inkrig_generate::measures::{jerk, pose_error_2d, skating};
use inkrig_motion::glam::Vec2;
use inkrig_motion::humanml::{Camera, Joints};
use inkrig_motion::kinematics;
use inkrig_storyboard::{Animation, Proportioned, Source, misses};
use serde::Serialize;

/// A place on the picture that is as exact as lines are met, metres.
const WITHIN: f32 = 0.01;

/// Of one clip. Lengths in metres, on the picture.
pub(super) struct Measured {
    /// Mean distance of the drawn pose's joints from those of the real one, pelvis at its place.
    pose: f64,
    /// Mean distance of drawn ways' joints from the real ones, the picture moved to fit.
    way: Option<f64>,
    /// Mean and largest distance from what was drawn.
    off: [f32; 2],
    /// How far drawn poses and ways were moved for a body at most.
    moved: Proportioned,
    jerk: Vec<f64>,
    skating: f64,
}

impl Measured {
    pub(super) fn real(window: &EvaluationWindow) -> Self {
        let motion = &window.joints;
        let skating = skating(motion).ratio;
        let moved = Proportioned::default();
        Self { pose: 0.0, way: None, off: [0.0; 2], moved, jerk: jerk(motion), skating }
    }

    pub(super) fn of(
        window: &EvaluationWindow,
        drawing: &Drawing,
        read: &Understood,
        made: &Animation,
    ) -> Self {
        let places = kinematics::positions(&made.clip);
        let motion: Vec<Joints> =
            (0..made.clip.frames()).filter_map(|frame| places.frame(frame).try_into().ok()).collect();
        let key = read.plan.key_frame();
        // Frames of a clip that is longer or shorter than the real one, in its time.
        let real = |frame: usize| {
            let (own, all) = (window.joints.len(), motion.len().max(2));
            window.joints.get(frame * own.saturating_sub(1) / (all - 1))
        };
        let pose = match (motion.get(key), real(key)) {
            (Some(own), Some(real)) => pose_error_2d(own, real, &drawing.camera),
            _ => 0.0,
        };
        let goals = made.goals.concat();
        let asked: Vec<(usize, usize)> = goals
            .iter()
            .filter(|goal| goal.source == Source::Way && drawing.joints.contains(&goal.joint))
            .map(|goal| (goal.frame, goal.joint))
            .collect();
        let pairs = asked
            .iter()
            .filter_map(|(frame, joint)| Some((motion.get(*frame)?[*joint], real(*frame)?[*joint])));
        let way = apart(&pairs.collect::<Vec<_>>(), &drawing.camera);
        let off = misses(&motion, &goals);
        let moved = made.proportioned.first().copied().unwrap_or_default();
        Self { pose, way, off, moved, jerk: jerk(&motion), skating: skating(&motion).ratio }
    }
}

/// The mean distance of pairs on the picture, their mean difference taken away.
fn apart(pairs: &[(inkrig_motion::glam::Vec3, inkrig_motion::glam::Vec3)], camera: &Camera) -> Option<f64> {
    let off: Vec<Vec2> = pairs.iter().map(|(own, real)| camera.project(*own - *real)).collect();
    let mean = off.iter().copied().sum::<Vec2>() / off.len().max(1) as f32;
    let sum: f32 = off.iter().map(|off| off.distance(mean)).sum();
    (!off.is_empty()).then(|| f64::from(sum) / off.len() as f64)
}

/// All clips of one kind.
pub(super) struct Row {
    pub(super) name: String,
    clips: Vec<Measured>,
}

impl Row {
    pub(super) fn named(name: &str) -> Self {
        Self { name: name.to_owned(), clips: Vec::new() }
    }

    pub(super) fn add(&mut self, measured: Measured) {
        self.clips.push(measured);
    }

    pub(super) fn clips(&self) -> usize {
        self.clips.len()
    }

    fn mean(&self, of: impl Fn(&Measured) -> f64) -> f64 {
        self.clips.iter().map(of).sum::<f64>() / self.clips.len().max(1) as f64
    }

    pub(super) fn pose(&self) -> f64 {
        self.mean(|clip| clip.pose)
    }

    pub(super) fn way(&self) -> f64 {
        let ways: Vec<f64> = self.clips.iter().filter_map(|clip| clip.way).collect();
        ways.iter().sum::<f64>() / ways.len().max(1) as f64
    }

    pub(super) fn off(&self) -> f64 {
        self.mean(|clip| f64::from(clip.off[0]))
    }

    pub(super) fn worst(&self) -> f64 {
        self.clips.iter().map(|clip| f64::from(clip.off[1])).fold(0.0, f64::max)
    }

    /// How far drawn poses were moved for a body, the mean of the farthest joints, and in how many clips ways were by more than a
    /// centimetre.
    pub(super) fn moved(&self) -> (f64, usize) {
        let ways = self.clips.iter().filter(|clip| clip.moved.ways > WITHIN).count();
        (self.mean(|clip| f64::from(clip.moved.poses)), ways)
    }

    /// Clips that are nowhere farther from the drawing than a centimetre.
    pub(super) fn within(&self) -> usize {
        self.clips.iter().filter(|clip| clip.off[1] <= WITHIN).count()
    }

    /// The 99th percentile over all moments of all clips, metres a frame^3.
    pub(super) fn jerk(&self) -> f64 {
        let mut all: Vec<f64> = self.clips.iter().flat_map(|clip| clip.jerk.iter().copied()).collect();
        all.sort_by(f64::total_cmp);
        all.get((0.99 * all.len() as f64) as usize).copied().unwrap_or(0.0)
    }

    pub(super) fn skating(&self) -> f64 {
        self.mean(|clip| clip.skating)
    }
}

impl Serialize for Row {
    fn serialize<S: serde::Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Figures<'a> {
            name: &'a str,
            clips: usize,
            mpjpe_2d_metres: f64,
            average_error_2d_metres: f64,
            off_the_drawing_metres: f64,
            worst_metres: f64,
            clips_within_a_centimetre: usize,
            poses_moved_metres: f64,
            clips_with_moved_ways: usize,
            jerk_p99: f64,
            skating: f64,
        }
        let (poses_moved_metres, clips_with_moved_ways) = self.moved();
        Figures {
            poses_moved_metres,
            clips_with_moved_ways,
            name: &self.name,
            clips: self.clips(),
            mpjpe_2d_metres: self.pose(),
            average_error_2d_metres: self.way(),
            off_the_drawing_metres: self.off(),
            worst_metres: self.worst(),
            clips_within_a_centimetre: self.within(),
            jerk_p99: self.jerk(),
            skating: self.skating(),
        }
        .serialize(to)
    }
}
