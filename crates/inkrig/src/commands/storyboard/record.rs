//! What is said of an animation that was made of a storyboard.

use super::space::SpaceRecord;
use super::{Asked, Made};
use crate::cli::{EngineArg, ExactArg, StoryboardArgs};
use crate::commands::certificate::CertificateRecord;
use crate::commands::generate::Model;
use crate::preview::Figure;
use crate::printable::{self, counted, fixed, json_path};
use crate::provenance::PROGRAM;
use crate::span::seconds;
use inkrig_generate::measures::{jerk, peak_jerk, skating};
use inkrig_motion::humanml::{Joints, NAMES};
use inkrig_motion::{Clip, kinematics};
use inkrig_sketch::storyboard::{End, FramePath, Sides};
use inkrig_storyboard::{Animation, Goal, Retrieved, Source, misses};
use serde::Serialize;

/// A pin that is farther away than this, metres, is said to be missed.
const MISSED_PIN: f32 = 0.3;

/// What `--report` and `--json` hold; the names are stable. Lengths are metres.
#[derive(Serialize)]
pub(super) struct Record {
    program: &'static str,
    storyboard: String,
    model: String,
    model_sha256: String,
    licence: String,
    seed: u64,
    exact: &'static str,
    engine: &'static str,
    output: String,
    seconds: f64,
    frame_rate: f64,
    frames: usize,
    parts: Vec<Part>,
    /// Steps that were taken to meet the lines after sampling.
    meeting: Option<usize>,
    /// The share of moments in which a standing foot slides.
    skating: f64,
    /// The largest third difference of a joint's place, metres per frame^3.
    peak_jerk: f64,
    /// How exact it is on a character, where one was given.
    certificate: Option<CertificateRecord>,
    /// The same storyboard by each engine, where several were asked.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    engines: Vec<EngineRecord>,
    pub(super) warnings: Vec<String>,
}

/// One frame of the storyboard.
#[derive(Serialize)]
pub(in crate::commands) struct Part {
    pub(in crate::commands) word: String,
    /// Where in the animation it begins, frames.
    pub(in crate::commands) begins: usize,
    pub(in crate::commands) frames: usize,
    /// Which of its own frames has the drawn pose.
    pub(in crate::commands) key_frame: Option<usize>,
    /// What was read of the figure, on the canvas.
    pub(in crate::commands) joints: Vec<Joint>,
    /// How left and right may be told, the likeliest first.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    sides: Vec<SideRecord>,
    pub(in crate::commands) trajectories: Vec<WayRecord>,
    /// Whose way over the ground it goes.
    #[serde(skip_serializing_if = "Option::is_none")]
    path: Option<PathRecord>,
    candidate: usize,
    /// Its place among all motions that were made of the frame, the best first, and how many these are.
    take: usize,
    takes: usize,
    evaluations: usize,
    /// Mean and largest distance on the picture between asked places and joints, as sampled.
    sampled: [f32; 2],
    /// The same in the animation.
    pub(in crate::commands) result: [f32; 2],
    /// How far joints of the drawn pose were moved at most to be those of a person, metres.
    proportioned: f32,
    /// How far drawn ways that part farther than a limb is long were brought together at most, metres.
    ways_moved: f32,
    /// What was said in space, and where the clip is.
    #[serde(flatten)]
    pub(in crate::commands) space: SpaceRecord,
    /// Where it is from, where it is from an example.
    #[serde(skip_serializing_if = "Option::is_none")]
    example: Option<ExampleRecord>,
}

/// One way to tell left from right.
#[derive(Serialize)]
struct SideRecord {
    name: &'static str,
    /// What the frame says for it.
    sides: Sides,
    /// How likely the reader takes it to be.
    share: f32,
}

/// A way over the ground that was taken over.
#[derive(Serialize)]
struct PathRecord {
    /// The frame that it is from.
    of: usize,
    /// Whether it goes on from there, rather than the same way again.
    continues: bool,
    /// Mean and largest distance of the pelvis from it over the ground.
    result: [f32; 2],
}

impl PathRecord {
    fn text(&self) -> String {
        let [mean, most] = self.result.map(|miss| fixed(100.0 * f64::from(miss), 1));
        let how = if self.continues { "on along" } else { "again" };
        format!("; {how} the path of frame {}, {mean} cm off it, {most} at most", self.of)
    }
}

/// Where a frame's motion is from.
#[derive(Debug, Serialize)]
pub(super) struct ExampleRecord {
    name: String,
    /// From and to, seconds of the example.
    seconds: [f64; 2],
    /// How far its word, way and pose are from what was asked for: see docs/storyboard.md.
    word: f32,
    path: Option<f32>,
    pose: Option<f32>,
    /// `window` (as it is), or `aligned` (arranged anew).
    arranged: &'static str,
}

impl ExampleRecord {
    pub(super) fn of(retrieved: &Retrieved) -> Self {
        let Retrieved { example, seconds, word, path, pose, aligned } = retrieved.clone();
        let arranged = if aligned { "aligned" } else { "window" };
        Self { name: example, seconds, word, path, pose, arranged }
    }

    pub(super) fn text(&self) -> String {
        let [from, to] = self.seconds.map(|seconds| fixed(seconds, 1));
        format!("{}, {from} to {to} s, {}", printable::text(&self.name), self.arranged)
    }
}

/// A storyboard by one engine.
#[derive(Serialize)]
pub(super) struct EngineRecord {
    pub(super) engine: &'static str,
    /// What it took, which is another time each time: it is said, and not written.
    #[serde(skip)]
    pub(super) seconds: f64,
    pub(super) skating: f64,
    /// Metres per frame^3.
    pub(super) peak_jerk: f64,
    /// Mean and largest distance on the picture of each frame, as made, metres.
    pub(super) sampled: Vec<[f32; 2]>,
    /// The same in the animation.
    pub(super) result: Vec<[f32; 2]>,
}

impl EngineRecord {
    pub(super) fn of(engine: EngineArg, seconds: f64, made: &Made) -> Self {
        let motion = poses(&made.animation.clip);
        Self {
            engine: engine_name(engine),
            seconds,
            skating: skating(&motion).ratio,
            peak_jerk: peak_jerk(&jerk(&motion)),
            sampled: made.clips.iter().map(|clip| [clip.error, clip.worst]).collect(),
            result: made.animation.goals.iter().map(|goals| misses(&motion, goals)).collect(),
        }
    }

    fn text(&self) -> String {
        let frames: Vec<String> = self
            .result
            .iter()
            .map(|misses| misses.map(|miss| fixed(100.0 * f64::from(miss), 1)).join("/"))
            .collect();
        format!(
            "  {:8} {:>6} s, feet slide {:>3} %, jerk {}, cm off (mean/most) {}",
            self.engine,
            fixed(self.seconds, 1),
            fixed(100.0 * self.skating, 0),
            fixed(self.peak_jerk, 3),
            frames.join(", ")
        )
    }
}

pub(super) fn exact_name(exact: ExactArg) -> &'static str {
    match exact {
        ExactArg::Off => "off",
        ExactArg::Soft => "soft",
        ExactArg::Pin => "pin",
    }
}

pub(super) fn engine_name(engine: EngineArg) -> &'static str {
    match engine {
        EngineArg::Learned => "learned",
        EngineArg::Example => "example",
        EngineArg::Both => "both",
    }
}

#[derive(Serialize)]
pub(in crate::commands) struct Joint {
    pub(in crate::commands) name: &'static str,
    pub(in crate::commands) x: f64,
    pub(in crate::commands) y: f64,
    pub(in crate::commands) confidence: f32,
    pub(in crate::commands) pinned: bool,
}

#[derive(Serialize)]
pub(in crate::commands) struct WayRecord {
    pub(in crate::commands) joint: &'static str,
    /// `start` or `end`: where on the line the figure is.
    pub(in crate::commands) figure: &'static str,
    /// First of the frame's own frames, and how many.
    pub(in crate::commands) first: usize,
    pub(in crate::commands) frames: usize,
}

impl Record {
    pub(super) fn of(
        args: &StoryboardArgs,
        model: &Model,
        (frames, made): (&[Asked<'_>], &Made),
        certificate: Option<CertificateRecord>,
        mut warnings: Vec<String>,
    ) -> Self {
        let Animation { clip: whole, met, .. } = &made.animation;
        let motion = poses(whole);
        let parts = parts(frames, made, args.exact, &mut warnings);
        Self {
            program: PROGRAM,
            storyboard: json_path(&args.board),
            model: model.header.name.clone(),
            model_sha256: model.header.sha256.clone(),
            licence: model.header.licence.clone(),
            seed: args.seed,
            exact: exact_name(args.exact),
            engine: engine_name(args.engine),
            output: json_path(&args.out),
            seconds: seconds(whole),
            frame_rate: whole.frame_rate(),
            frames: whole.frames(),
            parts,
            meeting: met.as_ref().map(|met| met.steps),
            skating: skating(&motion).ratio,
            peak_jerk: peak_jerk(&jerk(&motion)),
            certificate,
            engines: Vec::new(),
            warnings,
        }
    }

    /// What is known of examples, and of other engines.
    pub(super) fn add_engines(&mut self, retrieved: &[Retrieved], engines: Vec<EngineRecord>) {
        for (part, retrieved) in self.parts.iter_mut().zip(retrieved) {
            part.example = Some(ExampleRecord::of(retrieved));
        }
        self.engines = engines;
    }

    /// For the page.
    pub(super) fn figures(&self) -> Vec<Figure> {
        let figure =
            |name: &str, value: String, note: &str| Figure { name: name.into(), value, note: note.into() };
        let mut figures = Vec::new();
        for (at, part) in self.parts.iter().enumerate() {
            if part.key_frame.is_some() || !part.trajectories.is_empty() {
                let [mean, most] = part.result.map(|miss| fixed(100.0 * f64::from(miss), 1));
                figures.push(figure(
                    &format!(
                        "Frame {}, {}",
                        at + 1,
                        if part.word.is_empty() { "no word" } else { &part.word }
                    ),
                    format!("{mean} cm"),
                    &format!("Mean distance from what was drawn; {most} cm at most."),
                ));
            }
        }
        let slides = format!("{} %", fixed(100.0 * self.skating, 0));
        figures.push(figure("Sliding feet", slides, "Share of moments in which a standing foot slides."));
        if let Some(certificate) = &self.certificate {
            figures.extend(certificate.figures());
        }
        figures
    }

    pub(super) fn text(&self) -> String {
        let mut text = format!(
            "wrote {}: {} s, {}; model {}, seed {}",
            printable::text(&self.output),
            fixed(self.seconds, 1),
            counted(self.frames, "frame"),
            printable::text(&self.model),
            self.seed,
        );
        for (at, part) in self.parts.iter().enumerate() {
            let word = if part.word.is_empty() { "(no word)" } else { &part.word };
            let ways: Vec<&str> = part.trajectories.iter().map(|way| way.joint).collect();
            let [mean, most] = part.result.map(|miss| fixed(100.0 * f64::from(miss), 1));
            text += &format!("\n  {} {}: {}", at + 1, printable::text(word), counted(part.frames, "frame"));
            if !ways.is_empty() {
                text += &format!(", way of {}", ways.join(", "));
            }
            if part.key_frame.is_some() || !ways.is_empty() {
                text += &format!("; {mean} cm off the drawing, {most} at most");
            }
            if part.take > 0 {
                text += &format!("; motion {} of {}", part.take + 1, part.takes);
            }
            text += &part.path.as_ref().map(PathRecord::text).unwrap_or_default();
            text += &part.space.text();
            if let Some(example) = &part.example {
                text += &format!("; from {}", example.text());
            }
        }
        for engine in &self.engines {
            text += "\n";
            text += &engine.text();
        }
        if let Some(certificate) = &self.certificate {
            text += "\n";
            text += &certificate.text();
        }
        text
    }
}

/// What came of each frame; what the user should know of one goes to `warnings`, its number before it.
pub(in crate::commands) fn parts(
    frames: &[Asked<'_>],
    made: &Made,
    exact: ExactArg,
    warnings: &mut Vec<String>,
) -> Vec<Part> {
    let Animation { clip: whole, joined, goals, proportioned, .. } = &made.animation;
    let motion = poses(whole);
    let name = |joint: usize| NAMES.get(joint).copied().unwrap_or_default();
    let mut parts = Vec::new();
    for (at, asked) in frames.iter().enumerate() {
        let frame = asked.read;
        let (Some(clip), Some(ranked), Some(start), Some(goals)) =
            (made.clips.get(at), made.ranked.get(at), joined.starts.get(at), goals.get(at))
        else {
            continue;
        };
        let joints = frame.figure.iter().flat_map(|figure| {
            figure.joints.iter().enumerate().filter_map(|(joint, found)| {
                let found = (*found)?;
                let ([x, y], confidence, pinned) = (found.at, found.confidence, found.pinned);
                Some(Joint { name: name(joint), x, y, confidence, pinned })
            })
        });
        let trajectories = frame.attached.iter().zip(&clip.plan.ways).map(|(way, (joint, first, places))| {
            let figure = if way.figure == End::Start { "start" } else { "end" };
            WayRecord { joint: name(*joint), figure, first: *first, frames: places.len() }
        });
        let of = |path: bool| -> Vec<Goal> {
            let own = goals.iter().filter(|goal| goal.source != Source::Edit);
            own.filter(|goal| (goal.source == Source::Path) == path).copied().collect()
        };
        let result = misses(&motion, &of(false));
        let path = clip.plan.path_of(asked.number).map(|frame| PathRecord {
            of: frame,
            continues: clip.plan.follows == Some(FramePath::Continue),
            result: misses(&motion, &of(true)),
        });
        let space = SpaceRecord::of(at, &made.animation, &motion, &clip.plan.space);
        warnings
            .extend(space.warnings(exact).into_iter().map(|told| format!("frame {}: {told}", asked.number)));
        if let Some((joint, miss)) = missed_pin(&motion, goals) {
            warnings.push(format!(
                "frame {}: the pin of {} is missed by {} cm, farther than the motion can be brought: move it nearer to the figure, or leave it out",
                asked.number,
                name(joint),
                fixed(100.0 * f64::from(miss), 0)
            ));
        }
        let moved = proportioned.get(at).copied().unwrap_or_default();
        if exact == ExactArg::Pin && moved.ways > 0.01 {
            warnings.push(format!(
                "frame {}: nobody can follow all trajectories at once: they part farther than limbs are long, and were brought together by up to {} cm. Look at the sheet, and name their joints if one was taken for another's",
                asked.number,
                fixed(100.0 * f64::from(moved.ways), 1)
            ));
        }
        if exact == ExactArg::Pin && result[1] > 0.01 {
            warnings.push(format!(
                "frame {}: the lines are missed by up to {} cm: a person cannot be everywhere that is drawn at once. Look at the sheet for pins and lines that contradict each other",
                asked.number,
                fixed(100.0 * f64::from(result[1]), 1)
            ));
        }
        parts.push(Part {
            word: clip.plan.word.clone(),
            begins: *start,
            frames: clip.plan.frames,
            key_frame: clip.plan.keypose.as_ref().map(|(frame, _)| *frame),
            joints: joints.collect(),
            sides: frame
                .figure
                .iter()
                .flat_map(|figure| &figure.alternatives)
                .map(|own| SideRecord { name: own.name(), sides: own.sides, share: own.share })
                .collect(),
            trajectories: trajectories.collect(),
            path,
            candidate: clip.candidate,
            take: ranked.iter().position(|own| own.candidate == clip.candidate).unwrap_or(0),
            takes: ranked.len(),
            evaluations: clip.evaluations,
            sampled: [clip.error, clip.worst],
            result,
            proportioned: moved.poses,
            ways_moved: moved.ways,
            space,
            example: None,
        });
    }
    parts
}

/// The joint whose pin is missed most, and by how much, metres, where that is more than a motion is meant to miss one by.
fn missed_pin(motion: &[Joints], goals: &[Goal]) -> Option<(usize, f32)> {
    let pins = goals.iter().filter(|goal| goal.source == Source::Pin);
    let missed = pins.map(|goal| (goal.joint, misses(motion, std::slice::from_ref(goal))[1]));
    missed.filter(|(_, miss)| *miss > MISSED_PIN).max_by(|a, b| a.1.total_cmp(&b.1))
}

pub(in crate::commands) fn poses(clip: &Clip) -> Vec<Joints> {
    let places = kinematics::positions(clip);
    (0..clip.frames()).filter_map(|frame| places.frame(frame).try_into().ok()).collect()
}
