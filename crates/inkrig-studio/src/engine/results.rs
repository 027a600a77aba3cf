//! Finished motions and what is said of them.

use super::plan::PlacedPlan;
use super::{SourceMap, Wishes};
use crate::document::Document;
use crate::engine::gauges::{BadFrames, Gauge, gauges};
use crate::engine::poses::{PoseHead, PoseKind, encode};
use inkrig_align::{AMBIGUOUS, Alignment, Alternative, Explanation, KeyRow, Options};
use inkrig_formats::SourceInfo;
use inkrig_motion::Clip;
use serde::Serialize;
use std::collections::VecDeque;
use std::sync::Arc;
use utoipa::ToSchema;

/// Results that are kept.
const MOST: usize = 16;

/// A finished motion.
#[derive(Debug)]
pub struct Finished {
    /// What is told of it.
    pub facts: ResultFacts,
    /// The motion.
    pub clip: Clip,
    /// How it is written.
    pub written_as: SourceInfo,
    /// Which source patches each control patch is made of; none for what was retargeted.
    pub plan: Option<PlacedPlan>,
    /// The engine's words on the keys that counted; exact poses are found by them.
    pub key_rows: Vec<KeyRow>,
    /// For every control sample the source frame that it uses most, all clips counted through.
    pub used: Vec<u32>,
}

/// What is told of a result.
#[derive(Debug, Clone, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct ResultFacts {
    /// Its id.
    pub id: String,
    /// Revision of the document that it is of.
    pub revision: u32,
    /// How it came about.
    pub kind: ResultKind,
    /// Number of frames.
    pub frames: usize,
    /// Frames a second.
    pub frame_rate: f64,
    /// Its length.
    pub seconds: f64,
    /// Id of a clip of the same character.
    pub clip_for_skeleton: String,
    /// Whether its last frame is followed by the first.
    #[serde(rename = "loop")]
    pub cyclic: bool,
    /// What it is made of.
    pub used: Used,
    /// How good it is.
    pub gauges: Vec<Gauge>,
    /// Where it is not.
    pub bad_frames: BadFrames,
    /// How well each key was met, those that count in the order of the document.
    pub keys: Vec<KeyFacts>,
    /// How nearly the control is a mirror image of itself, 0..1.
    pub mirror_symmetry: f64,
    /// Whether there is another solution about as good.
    pub ambiguous: bool,
    /// What a person should know.
    pub notes: Vec<String>,
    /// Of several solutions: lower is better.
    pub objective: Option<f64>,
    /// Of several solutions: how far it is from the first, in mean distances of the clip's moments.
    pub distance: Option<f64>,
    /// The engine's whole report.
    #[schema(value_type = Object)]
    pub report: serde_json::Value,
}

/// How a result came about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub enum ResultKind {
    /// A clip follows a control.
    Align,
    /// A motion was put on another character.
    Retarget,
}

/// For every control sample the frame that it uses most; columns of equal length.
#[derive(Debug, Clone, Default, Serialize, ToSchema)]
pub struct Used {
    /// Samples a second.
    pub rate: f64,
    /// Id of a clip.
    pub clip: Vec<String>,
    /// Frame of that clip.
    pub frame: Vec<usize>,
    /// Share of the sample's weight within a quarter second of that frame, 0..1.
    pub confidence: Vec<f64>,
}

/// How well a key was met.
#[derive(Debug, Clone, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct KeyFacts {
    /// The key.
    pub id: String,
    /// `soft`, `avoid`, `hard`, `never` or `fixed`.
    pub kind: &'static str,
    /// Where it was measured.
    pub seconds: f64,
    /// From the pose, in mean distances of the clip's moments.
    pub distance: Option<f64>,
    /// For soft keys: 1 is all that it wants.
    pub correlation: Option<f64>,
    /// Over the fastest of the clip; above 2 it jumps.
    pub jump: Option<f64>,
    /// In a word.
    pub met: Verdict,
    /// Why it could not count, where it could not.
    pub waits: Option<String>,
}

/// In a word.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub enum Verdict {
    /// As one wants it.
    Good,
    /// Worth a look.
    Fair,
    /// Not as one wants it.
    Poor,
}

/// What a result is of.
pub(crate) struct Origin<'a> {
    pub(crate) id: String,
    pub(crate) revision: u32,
    pub(crate) document: &'a Document,
    pub(crate) map: &'a SourceMap,
    pub(crate) wishes: &'a Wishes,
    pub(crate) written_as: SourceInfo,
}

impl Finished {
    /// An alignment; `clip` is its motion after what is done over the ground.
    pub(crate) fn of(
        solution: Alternative,
        clip: Clip,
        several: bool,
        notes: Vec<String>,
        origin: Origin<'_>,
    ) -> Self {
        let Origin { id, revision, document, map, wishes, written_as } = origin;
        let options = &wishes.options;
        let Alternative { alignment, objective, distance } = solution;
        let used = used(&alignment, options, map);
        let (gauges, bad_frames) = gauges(&alignment, &clip);
        let report = &alignment.report;
        let counted =
            alignment.used.iter().map(|moment| map.counted_through(moment.frame).unwrap_or(0) as u32);
        let facts = ResultFacts {
            id,
            revision,
            kind: ResultKind::Align,
            frames: clip.frames(),
            frame_rate: clip.frame_rate(),
            seconds: clip.duration(),
            clip_for_skeleton: document.source.clips.first().cloned().unwrap_or_default(),
            cyclic: document.settings.cyclic,
            used,
            gauges,
            bad_frames,
            keys: keys(document, wishes, &alignment),
            mirror_symmetry: report.mirror_symmetry,
            ambiguous: report.mirror_symmetry >= AMBIGUOUS,
            notes: report.notes.iter().cloned().chain(notes).collect(),
            objective: several.then_some(objective),
            distance: several.then_some(distance),
            report: serde_json::to_value(report).unwrap_or_default(),
        };
        let used = counted.collect();
        let plan = Some(PlacedPlan::of(&alignment, map, options.patch()));
        Self { facts, clip, written_as, plan, key_rows: alignment.report.keys, used }
    }

    /// Its poses as bytes.
    pub fn poses(&self) -> Vec<u8> {
        let head = PoseHead {
            sample_rate: self.facts.used.rate as f32,
            ..PoseHead::of(PoseKind::Result, self.facts.revision, self.facts.cyclic)
        };
        encode(&self.clip, &head, &self.used)
    }
}

/// Results by their ids; the oldest go.
#[derive(Debug, Default)]
pub struct Results {
    kept: VecDeque<Arc<Finished>>,
    next: u64,
}

impl Results {
    /// An id that no other has.
    pub fn new_id(&mut self) -> String {
        self.next += 1;
        format!("r{}", self.next)
    }

    /// Keeps a result.
    pub fn put(&mut self, result: Arc<Finished>) {
        self.kept.push_back(result);
        while self.kept.len() > MOST {
            self.kept.pop_front();
        }
    }

    /// The newest that follows the document.
    pub fn newest(&self) -> Option<String> {
        let mut aligned = self.kept.iter().rev().filter(|result| result.facts.kind == ResultKind::Align);
        aligned.next().map(|result| result.facts.id.clone())
    }

    /// The result of that id.
    pub fn get(&self, id: &str) -> Option<Arc<Finished>> {
        self.kept.iter().find(|result| result.facts.id == id).cloned()
    }
}

fn used(alignment: &Alignment, options: &Options, map: &SourceMap) -> Used {
    let explanation = Explanation::of(alignment, options);
    let mut used = Used { rate: explanation.rate, confidence: explanation.confidence, ..Used::default() };
    for frame in explanation.frame {
        let (clip, frame) = map.to_clip(frame).unwrap_or_default();
        used.clip.push(clip.to_string());
        used.frame.push(frame);
    }
    used
}

fn keys(document: &Document, wishes: &Wishes, alignment: &Alignment) -> Vec<KeyFacts> {
    let verdict = |good: bool, fair: bool| match (good, fair) {
        (true, _) => Verdict::Good,
        (_, true) => Verdict::Fair,
        _ => Verdict::Poor,
    };
    let counted = |id: &String, row: &KeyRow| {
        let distance = row.distance.unwrap_or(0.0);
        let asked = row.asked.unwrap_or(0.0);
        let met = match row.kind {
            "soft" => {
                row.correlation.map_or(verdict(distance < 0.3, distance < 0.7), |c| verdict(c > 0.6, c > 0.3))
            }
            "avoid" | "never" => verdict(distance >= 0.9 * asked, distance >= 0.5 * asked),
            _ => row.jump.map_or(Verdict::Good, |jump| verdict(jump <= 2.0, jump <= 4.0)),
        };
        KeyFacts {
            id: id.clone(),
            kind: row.kind,
            seconds: row.seconds,
            distance: row.distance,
            correlation: row.correlation,
            jump: row.jump,
            met,
            waits: None,
        }
    };
    let waiting = wishes.waiting.iter().map(|key| KeyFacts {
        id: key.id.clone(),
        kind: key.kind,
        seconds: key.seconds,
        distance: None,
        correlation: None,
        jump: None,
        met: Verdict::Poor,
        waits: Some(key.why.clone()),
    });
    let rows = wishes.counting.iter().zip(&alignment.report.keys);
    let mut facts: Vec<KeyFacts> = rows.map(|(id, row)| counted(id, row)).chain(waiting).collect();
    facts.sort_by_key(|facts| document.keys.iter().position(|key| key.id == facts.id));
    facts
}
