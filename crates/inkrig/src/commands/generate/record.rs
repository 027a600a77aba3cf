//! What is said of a motion that was generated.

use super::ground::GroundRecord;
use super::{Made, Wanted};
use crate::cli::GenerateArgs;
use crate::printable::{self, counted, fixed, json_path};
use crate::provenance::PROGRAM;
use crate::read_back::ReadBack;
use crate::span::seconds;
use inkrig_generate::checkpoint::ModelHeader;
use inkrig_generate::guidance::Ask;
use inkrig_generate::sampling::{SamplingOptions, Steps};
use inkrig_generate::text::{VERBS, actions_in};
use inkrig_motion::glam::Vec3;
use inkrig_motion::humanml::{JOINTS, Joints, augment};
use inkrig_motion::{Clip, kinematics};
use serde::Serialize;
use std::fmt::Write;
use std::path::Path;

/// What `--report` and `--json` hold; the names are stable.
#[derive(Serialize)]
pub(super) struct Record {
    program: &'static str,
    model: ModelRecord,
    word: String,
    /// Actions of the list that the word is read as.
    actions: Vec<&'static str>,
    seed: u64,
    /// Kind of steps, and how many.
    sampler: &'static str,
    steps: usize,
    output: String,
    frames: usize,
    frame_rate: f64,
    seconds: f64,
    keypose: Option<KeyposeRecord>,
    trajectory: Option<TrajectoryRecord>,
    /// How feet were put on the floor; none where they were left as they came.
    ground: Option<GroundRecord>,
    /// The file read again and compared, for formats that are read.
    read_back: Option<ReadBack>,
    warnings: Vec<String>,
}

#[derive(Serialize)]
struct ModelRecord {
    file: String,
    name: String,
    data: String,
    licence: String,
    sha256: String,
}

#[derive(Serialize)]
struct KeyposeRecord {
    frame: usize,
    /// Mean distance of the joints from the pose, both above the same place, metres.
    mean_error_metres: f64,
}

#[derive(Serialize)]
struct TrajectoryRecord {
    points: usize,
    /// Mean distance of the joints from their points, metres.
    mean_error_metres: f64,
    /// Whether the motion was drawn to them at every step, and how often it was looked at for that.
    guided: bool,
    evaluations: usize,
}

impl Record {
    pub(super) fn of(
        args: &GenerateArgs,
        (path, header): (&Path, &ModelHeader),
        (wanted, options): (&Wanted, &SamplingOptions),
        made: &Made,
        (read_back, warnings): (Option<ReadBack>, Vec<String>),
    ) -> Self {
        let clip = &made.clip;
        let (sampler, steps) = match options.steps {
            Steps::Ddim(steps) => ("ddim", steps),
            Steps::Lcm(steps) => ("lcm", steps),
        };
        let poses = clip_poses(clip);
        let keypose = wanted.keypose.as_ref().map(|pose| {
            let own = poses.get(pose.frame).map_or([Vec3::ZERO; JOINTS], |own| centred(&augment(own)));
            let sum: f32 =
                own.iter().zip(centred(&pose.joints)).map(|(own, wanted)| own.distance(wanted)).sum();
            KeyposeRecord { frame: pose.frame, mean_error_metres: f64::from(sum) / JOINTS as f64 }
        });
        let trajectory = wanted.trajectory.as_ref().map(|asks| TrajectoryRecord {
            points: asks.len(),
            mean_error_metres: trajectory_error(&poses, asks),
            guided: options.guidance.is_some(),
            evaluations: made.guided.iter().map(|guided| guided.evaluations).sum(),
        });
        Self {
            program: PROGRAM,
            model: ModelRecord {
                file: json_path(path),
                name: header.name.clone(),
                data: header.data.clone(),
                licence: header.licence.clone(),
                sha256: header.sha256.clone(),
            },
            word: args.word.clone(),
            actions: actions_in(&args.word)
                .into_iter()
                .filter_map(|verb| Some(VERBS.get(verb)?.name))
                .collect(),
            seed: args.seed,
            sampler,
            steps,
            output: json_path(&args.out),
            frames: clip.frames(),
            frame_rate: clip.frame_rate(),
            seconds: seconds(clip),
            keypose,
            trajectory,
            ground: made.ground.clone(),
            read_back,
            warnings,
        }
    }

    pub(super) fn text(&self) -> String {
        let mut text = format!(
            "wrote {}: {} s, {} at {} a second; model {}, seed {}",
            printable::text(&self.output),
            fixed(self.seconds, 1),
            counted(self.frames, "frame"),
            self.frame_rate,
            printable::text(&self.model.name),
            self.seed,
        );
        // Writing to a string cannot fail.
        if let Some(KeyposeRecord { frame, mean_error_metres }) = &self.keypose {
            let _ =
                write!(text, "\n  key pose at frame {frame}: {} cm off", fixed(1e2 * mean_error_metres, 1));
        }
        if let Some(TrajectoryRecord { points, mean_error_metres, .. }) = &self.trajectory {
            let (points, off) = (counted(*points, "point"), fixed(1e2 * mean_error_metres, 1));
            let _ = write!(text, "\n  trajectory, {points}: {off} cm off");
        }
        if let Some(ground) = &self.ground {
            let _ = write!(text, "\n  {}", ground.text());
        }
        if !self.model.licence.is_empty() {
            let _ = write!(text, "\n  licence of the model: {}", printable::text(&self.model.licence));
        }
        text
    }
}

/// Mean distance of joints from where they were asked to be, metres.
pub(super) fn trajectory_error(motion: &[Joints], asks: &[Ask]) -> f64 {
    let distance = |ask: &Ask| {
        let own = motion.get(ask.frame).and_then(|pose| pose.get(ask.joint));
        own.map_or(0.0, |own| f64::from(own.distance(ask.place)))
    };
    asks.iter().map(distance).sum::<f64>() / asks.len().max(1) as f64
}

/// The joints of a clip that was generated, a row a frame.
pub(super) fn clip_poses(clip: &Clip) -> Vec<Joints> {
    let places = kinematics::positions(clip);
    (0..clip.frames()).filter_map(|frame| places.frame(frame).try_into().ok()).collect()
}

/// Above the origin.
fn centred(pose: &Joints) -> Joints {
    let root = Vec3::new(pose[0].x, 0.0, pose[0].z);
    pose.map(|place| place - root)
}
