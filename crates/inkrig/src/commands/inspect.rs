//! `inkrig inspect`: what is in a motion file.

use crate::cli::InspectArgs;
use crate::console::Console;
use crate::error::CliError;
use crate::load;
use crate::printable::{self, counted, fixed};
use crate::span::seconds;
use inkrig_formats::{Evidence, Import, Severity, UpAxis};
use inkrig_motion::{Skeleton, lead_in, root::RootMotion};
use serde::Serialize;
use std::fmt::Write;

/// Clips that are listed.
const MOST_CLIPS: usize = 400;

/// Joints that are drawn as a tree; a hostile file shall not flood the terminal.
const MOST_JOINTS: usize = 400;

pub(super) fn run(args: &InspectArgs, console: &Console) -> Result<(), CliError> {
    let stage = console.stage(format!("reading {}", printable::path(&args.file)));
    let import = load::motion(&args.file, &args.import)?;
    let facts = Facts::of(&import);
    drop(stage);
    console.say(format!("{}\n{}", printable::path(&args.file), facts.text()))?;
    console.say(tree(import.clip.skeleton()))?;
    console.result(&facts)
}

/// What is said of a file; the names are stable.
#[derive(Serialize)]
struct Facts {
    format: &'static str,
    joints: usize,
    end_sites: usize,
    roots: usize,
    frames: usize,
    frame_rate: f64,
    seconds: f64,
    metres_per_unit: f64,
    unit_evidence: &'static str,
    up: &'static str,
    size_metres: f32,
    travel_joint: String,
    travel_metres: f32,
    rest_pose_frames: usize,
    problems: Vec<String>,
    remarks: Vec<String>,
    clips: Vec<ClipFacts>,
    skeleton: Vec<JointFacts>,
}

#[derive(Serialize)]
struct ClipFacts {
    name: String,
    read: bool,
}

#[derive(Serialize)]
struct JointFacts {
    name: String,
    parent: Option<usize>,
    offset_metres: [f32; 3],
    end_site: bool,
}

impl Facts {
    fn of(import: &Import) -> Self {
        let (clip, skeleton) = (&import.clip, import.clip.skeleton());
        let root = RootMotion::of(&clip.clone().into());
        // An empty sum is -0.0.
        let travel = root.places.windows(2).map(|pair| pair[0].distance(pair[1])).sum::<f32>() + 0.0;
        let findings = |severity| {
            import
                .findings
                .iter()
                .filter(|finding| finding.severity == severity)
                .map(ToString::to_string)
                .collect()
        };
        Self {
            format: import.source.format.name(),
            joints: skeleton.len(),
            end_sites: skeleton.joints().iter().filter(|joint| joint.end_site).count(),
            roots: skeleton.roots().count(),
            frames: clip.frames(),
            frame_rate: clip.frame_rate(),
            seconds: seconds(clip),
            metres_per_unit: import.source.metres_per_unit,
            unit_evidence: match import.source.unit_evidence {
                Evidence::Declared => "declared in the file",
                Evidence::Given => "given by you",
                Evidence::Guessed => "a guess from the figure's size; --unit says otherwise",
                Evidence::Assumed => "assumed",
            },
            up: match import.source.up {
                UpAxis::Y => "y",
                UpAxis::Z => "z",
            },
            size_metres: skeleton.extent(),
            travel_joint: skeleton
                .joints()
                .get(root.joint)
                .map(|joint| joint.name.clone())
                .unwrap_or_default(),
            travel_metres: travel,
            rest_pose_frames: lead_in::rest_pose_frames(clip),
            problems: findings(Severity::Warning),
            remarks: findings(Severity::Info),
            clips: (import.clips.iter().enumerate())
                .map(|(index, clip)| ClipFacts {
                    name: clip.name.clone(),
                    read: import.clip_index == Some(index),
                })
                .collect(),
            skeleton: (skeleton.joints().iter())
                .map(|joint| JointFacts {
                    name: joint.name.clone(),
                    parent: joint.parent,
                    offset_metres: joint.offset.to_array(),
                    end_site: joint.end_site,
                })
                .collect(),
        }
    }

    fn text(&self) -> String {
        let mut text = String::new();
        let mut line = |name: &str, value: String| {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "  {name:<12} {value}");
        };
        let roots = if self.roots == 1 { String::new() } else { format!(", {} roots", self.roots) };
        let metres = |length: f32| fixed(f64::from(length), 2);
        line("format", self.format.to_string());
        line(
            "joints",
            format!("{} and {}{roots}", self.joints - self.end_sites, counted(self.end_sites, "end site")),
        );
        line("frames", format!("{} at {:.3} a second, {:.2} s", self.frames, self.frame_rate, self.seconds));
        line("unit", format!("{} m ({})", self.metres_per_unit, self.unit_evidence));
        line("up", self.up.to_string());
        line("size", format!("{} m", metres(self.size_metres)));
        let joint = printable::text(&self.travel_joint);
        line("travels", format!("{} m, by joint `{joint}`", metres(self.travel_metres)));
        match self.rest_pose_frames {
            0 => {}
            1 => line("rest pose", "the first frame is a T-pose; align leaves it out".to_string()),
            count => {
                line("rest pose", format!("the first {count} frames are a T-pose; align leaves them out"));
            }
        }
        if self.problems.is_empty() {
            line("problems", "none".to_string());
        }
        for problem in &self.problems {
            line("problem", printable::text(problem));
        }
        text.push_str(&clips(&self.clips));
        text.trim_end().to_string()
    }
}

/// The clips by number, the one that the other lines are about marked.
fn clips(clips: &[ClipFacts]) -> String {
    let mut text = String::new();
    for (index, clip) in clips.iter().enumerate().take(MOST_CLIPS) {
        let heading = if index == 0 { "clips" } else { "" };
        let read = if clip.read { "  <- read here" } else { "" };
        let _ = writeln!(text, "  {heading:<12} {:>3}  {}{read}", index + 1, printable::text(&clip.name));
    }
    if clips.len() > MOST_CLIPS {
        let _ = writeln!(text, "  {:<12} ... and {} more", "", clips.len() - MOST_CLIPS);
    }
    text
}

/// The joints as an indented tree.
fn tree(skeleton: &Skeleton) -> String {
    let mut text = String::from("skeleton");
    for (joint, depth) in skeleton.joints().iter().zip(skeleton.depths()).take(MOST_JOINTS) {
        let _ =
            write!(text, "\n  {:indent$}{}", "", printable::text(&joint.name), indent = 2 * depth.min(40));
    }
    if skeleton.len() > MOST_JOINTS {
        let _ = write!(text, "\n  ... and {} more", skeleton.len() - MOST_JOINTS);
    }
    text
}
