//! A motion and what became of it on another character, for the eye: a page, a contact sheet.

use crate::error::CliError;
use crate::preview::{self, ControlView, Figure, HeatMap, Preview};
use crate::sheet::{SheetOptions, contact_sheet_of_two};
use inkrig_motion::{Clip, Joint, MotionError, Skeleton, TranslationTrack, kinematics::Pose};
use std::sync::Arc;

/// A motion in the size of the character that it was carried over to.
#[derive(Debug)]
pub(crate) struct SideBySide<'a> {
    source: Clip,
    result: &'a Clip,
}

impl<'a> SideBySide<'a> {
    /// `scale`: size of the result's character over that of the source's.
    pub(crate) fn of(source: &Clip, result: &'a Clip, scale: f32) -> Result<Self, CliError> {
        Ok(Self { source: scaled(&without_controls(source)?, scale)?, result })
    }

    /// The page.
    pub(crate) fn page(&self, title: &str, figures: &[Figure], notes: &[String]) -> String {
        let clip = self.result;
        let mut pose = Pose::new(clip.skeleton());
        let joint = clip.travel_joint();
        let way: Vec<[f64; 2]> = (0..clip.frames())
            .map(|frame| {
                pose.set(clip, frame);
                let place = pose.positions[joint];
                [f64::from(place.x), -f64::from(place.z)]
            })
            .collect();
        let seconds: Vec<f32> =
            (0..clip.frames()).map(|frame| (frame as f64 / clip.frame_rate()) as f32).collect();
        preview::render(&Preview {
            title,
            result: clip,
            source: &self.source,
            control: ControlView::Way(&way),
            control_rate: clip.frame_rate(),
            heat_map: HeatMap::default(),
            best_source: &seconds,
            confidence: &[],
            guide: None,
            board: &[],
            figures,
            notes,
        })
    }

    /// The contact sheet as PNG.
    pub(crate) fn sheet(&self) -> Result<Vec<u8>, CliError> {
        Ok(contact_sheet_of_two(&self.source, self.result, &SheetOptions::default())?)
    }
}

/// Without joints that are named as targets of limbs, which no body has.
fn without_controls(clip: &Clip) -> Result<Clip, MotionError> {
    let joints = clip.skeleton().joints();
    let mut kept: Vec<Option<usize>> = Vec::with_capacity(joints.len());
    let mut count = 0;
    for joint in joints {
        let control = joint.name.to_ascii_lowercase().contains("poletarget");
        let above = joint.parent.is_some_and(|parent| kept[parent].is_none());
        kept.push((!control && !above).then_some(count));
        count += usize::from(!control && !above);
    }
    if count == 0 || count == joints.len() {
        return Ok(clip.clone());
    }
    let own = joints.iter().zip(&kept).filter(|(_, kept)| kept.is_some());
    let own =
        own.map(|(joint, _)| Joint { parent: joint.parent.and_then(|parent| kept[parent]), ..joint.clone() });
    let skeleton = Skeleton::new(own.collect())?;
    let rotations = (0..clip.frames()).flat_map(|frame| {
        let turns = clip.rotations(frame).iter().zip(&kept);
        turns.filter(|(_, kept)| kept.is_some()).map(|(turn, _)| *turn).collect::<Vec<_>>()
    });
    let track = |track: &TranslationTrack| {
        Some(TranslationTrack { joint: kept[track.joint]?, values: track.values.clone() })
    };
    let tracks = clip.translations().iter().filter_map(track).collect();
    Clip::new(Arc::new(skeleton), clip.frame_rate(), rotations.collect(), tracks)
}

fn scaled(clip: &Clip, scale: f32) -> Result<Clip, MotionError> {
    let joint = |joint: &Joint| Joint { offset: scale * joint.offset, ..joint.clone() };
    let skeleton = Skeleton::new(clip.skeleton().joints().iter().map(joint).collect())?;
    let track = |track: &TranslationTrack| TranslationTrack {
        joint: track.joint,
        values: track.values.iter().map(|value| scale * *value).collect(),
    };
    let rotations = (0..clip.frames()).flat_map(|frame| clip.rotations(frame).to_vec()).collect();
    let tracks = clip.translations().iter().map(track).collect();
    Clip::new(Arc::new(skeleton), clip.frame_rate(), rotations, tracks)
}
