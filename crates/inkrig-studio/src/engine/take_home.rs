//! Results as files, and on other characters.

use super::results::{Finished, ResultFacts, ResultKind, Used, Verdict};
use crate::StudioError;
use crate::engine::gauges::BadFrames;
use inkrig_align::{KeyRow, at_frame_rate, exact_frames};
use inkrig_formats::{ExportOptions, Format, Import, SourceInfo, write_motion};
use inkrig_motion::Clip;
use inkrig_motion::keyframes::{RotationForm, SparseOptions, sparse, stepped};
use inkrig_motion::retarget::{
    Certificate, CertificateLimits, RetargetOptions, Spread, retarget as carry_over, standing_pose,
};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Which keys a file gets.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(tag = "kind", rename_all = "camelCase")]
pub enum Bake {
    /// One a frame.
    #[default]
    Dense,
    /// Few, with tangents.
    Sparse {
        /// Joints stay as near as that.
        millimetres: f64,
        /// And as near as that.
        degrees: f64,
    },
    /// Poses that are held.
    Stepped {
        /// For so many frames.
        frames: f64,
    },
}

/// A result or a clip, to be taken home.
#[derive(Debug, Clone)]
pub(crate) struct Motion {
    pub(crate) clip: Clip,
    pub(crate) written_as: SourceInfo,
    pub(crate) is_loop: bool,
    /// What it is called.
    pub(crate) name: String,
    /// Of a result, what was said of its keys: exact poses stay in the file, whatever its rate and its keys.
    pub(crate) keys: Vec<KeyRow>,
}

/// A motion as a file.
///
/// # Errors
/// When the format is not written, or cannot hold it.
pub(crate) fn file(
    Motion { clip, written_as, is_loop, mut keys, .. }: Motion,
    format: Format,
    fps: Option<f64>,
    name: &str,
    bake: Bake,
) -> Result<Vec<u8>, StudioError> {
    let clip = match fps {
        Some(rate) => {
            if !(1.0..=1000.0).contains(&rate) {
                return Err(StudioError::invalid("frames a second have to be from 1 to 1000"));
            }
            at_frame_rate(&clip, &mut keys, rate, is_loop)?
        }
        None => clip,
    };
    let options =
        ExportOptions { name: Some(name.to_string()), ..ExportOptions::in_format(format, &written_as) };
    let exact = exact_frames(&clip, &keys);
    let few = match bake {
        Bake::Dense => None,
        Bake::Sparse { millimetres, degrees } => {
            if !(1e-3..=1e3).contains(&millimetres) || !(1e-3..=90.0).contains(&degrees) {
                return Err(StudioError::invalid(
                    "a tolerance is from 0.001 to 1000 mm and from 0.001 to 90 degrees",
                ));
            }
            let form = match format {
                Format::Fbx => RotationForm::Angles { axes: options.up.clip_from_file_turn() },
                _ => RotationForm::Quaternion,
            };
            let (metres, radians) = (millimetres / 1000.0, degrees.to_radians());
            Some(sparse(&clip, &SparseOptions { metres, radians, given: exact, form }))
        }
        Bake::Stepped { frames } => {
            if !(1.0..=1000.0).contains(&frames) {
                return Err(StudioError::invalid("a pose is held for 1 to 1000 frames"));
            }
            Some(stepped(&clip, frames, &exact))
        }
    };
    let written = match few {
        None => write_motion(&clip, format, &options)?,
        Some(keys) => {
            let baked = keys.clip()?;
            write_motion(&baked, format, &ExportOptions { keys: Some(keys), ..options })?
        }
    };
    Ok(written.bytes)
}

/// How exact a motion on another character is.
#[derive(Debug, Clone, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct CertificateFacts {
    /// Good where every limit is kept, else fair.
    pub verdict: Verdict,
    /// Limits that are not kept.
    pub broken: Vec<BrokenLimit>,
    /// Length of the character over that of the one in the motion.
    pub scale: f64,
    /// Joints of the character, each with the joint of the motion that it follows.
    #[schema(value_type = Vec<(String, String)>)]
    pub pairs: Vec<[String; 2]>,
    /// Joints of the character that keep their rest.
    pub unmapped: Vec<String>,
    /// Joints of the motion that lead none.
    pub unused: Vec<String>,
    /// Rows of the certificate.
    pub rows: Vec<CertificateRow>,
    /// How often a foot stands.
    pub contacts: usize,
    /// The motion goes on the spot.
    pub on_the_spot: bool,
}

/// A limit that is not kept.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct BrokenLimit {
    /// What of.
    pub what: &'static str,
    /// What it is.
    pub value: f64,
    /// What it should be at most.
    pub limit: f64,
}

/// One measured thing.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct CertificateRow {
    /// What was measured.
    pub name: String,
    /// `mm` or `degrees`.
    pub unit: &'static str,
    /// Over all frames.
    pub mean: f64,
    /// 95 of 100 are below.
    pub p95: f64,
    /// Largest.
    pub max: f64,
    /// Limit of what it is judged by, where there is one.
    pub limit: Option<f64>,
}

/// Puts a motion on another character.
///
/// # Errors
/// When the two characters have nothing to do with each other.
pub(crate) fn retarget(
    motion: &Motion,
    character: &Import,
    options: (bool, Option<f64>),
    facts: (String, u32, String),
) -> Result<(Finished, CertificateFacts), StudioError> {
    let (keep_feet, scale) = options;
    let (id, revision, onto) = facts;
    let options = RetargetOptions {
        scale: scale.map(|scale| scale as f32),
        keep_feet,
        stance: standing_pose(&character.clip),
        map: None,
    };
    let moved = carry_over(&motion.clip, character.clip.skeleton(), &options)?;
    let certificate = Certificate::of(&motion.clip, &moved);
    let moved = moved.clip;
    let facts = ResultFacts {
        id,
        revision,
        kind: ResultKind::Retarget,
        frames: moved.frames(),
        frame_rate: moved.frame_rate(),
        seconds: moved.duration(),
        clip_for_skeleton: onto,
        cyclic: motion.is_loop,
        used: Used::default(),
        gauges: Vec::new(),
        bad_frames: BadFrames::default(),
        keys: Vec::new(),
        mirror_symmetry: 0.0,
        ambiguous: false,
        notes: Vec::new(),
        objective: None,
        distance: None,
        report: serde_json::Value::Object(serde_json::Map::new()),
    };
    let finished = Finished {
        facts,
        clip: moved,
        written_as: character.source.clone(),
        plan: None,
        key_rows: motion.keys.clone(),
        used: Vec::new(),
    };
    Ok((finished, CertificateFacts::of(&certificate)))
}

impl CertificateFacts {
    fn of(certificate: &Certificate) -> Self {
        let limits = CertificateLimits::default();
        let broken = certificate.broken(&limits);
        let row = |name: &str, unit, of: Spread, limit: Option<f64>| CertificateRow {
            name: name.into(),
            unit,
            mean: of.mean,
            p95: of.p95,
            max: of.max,
            limit,
        };
        let mut rows = vec![
            row("limbs point off", "degrees", certificate.direction, Some(limits.direction_degrees)),
            row("trunk points off", "degrees", certificate.trunk, Some(limits.trunk_degrees)),
            row("standing feet slide", "mm", certificate.slide, Some(limits.slide_mm)),
            row("standing feet float", "mm", certificate.floating, Some(limits.floating_mm)),
            row("below the ground", "mm", certificate.penetration, Some(limits.penetration_mm)),
            row("off the way", "mm", certificate.drift, Some(limits.drift_mm)),
        ];
        rows.extend(
            certificate
                .limbs
                .iter()
                .map(|limb| row(&limb.bone, "degrees", limb.degrees, Some(limits.direction_degrees))),
        );
        rows.extend(certificate.joints.iter().map(|joint| row(&joint.joint, "mm", joint.millimetres, None)));
        Self {
            verdict: if broken.is_empty() { Verdict::Good } else { Verdict::Fair },
            broken: broken
                .iter()
                .map(|one| BrokenLimit { what: one.what, value: one.value, limit: one.limit })
                .collect(),
            scale: f64::from(certificate.scale),
            pairs: certificate.pairs.iter().map(|(own, other)| [own.clone(), other.clone()]).collect(),
            unmapped: certificate.unmapped.clone(),
            unused: certificate.unused.clone(),
            rows,
            contacts: certificate.contacts,
            on_the_spot: certificate.on_the_spot,
        }
    }
}
