//! Poses worth a key, and the map of the source.

use super::Prepared;
use super::media::Media;
use crate::StudioError;
use crate::document::Document;
use crate::project::Folder;
use inkrig_align::{Moments, MotionMap, Options, candidates};
use serde::Serialize;
use utoipa::ToSchema;

/// Poses worth a key, and the map of the source.
#[derive(Debug, Serialize, ToSchema)]
pub struct Suggestions {
    /// The best first.
    pub candidates: Vec<Suggestion>,
    /// All moments, in order.
    pub map: MapInfo,
}

/// A pose worth a key.
#[derive(Debug, Serialize, ToSchema)]
pub struct Suggestion {
    /// Id of its clip.
    pub clip: String,
    /// Its frame.
    pub frame: usize,
    /// Since the beginning of the clip.
    pub seconds: f64,
    /// Share of the source that it stands for, 0..1.
    pub share: f64,
    /// How far the farthest of that share is, in mean distances.
    pub radius: f64,
    /// On the map.
    pub x: f64,
    /// On the map.
    pub y: f64,
}

/// Moments on a plane: what is alike is near. The unit is the mean distance of two moments.
#[derive(Debug, Serialize, ToSchema)]
pub struct MapInfo {
    /// In order.
    pub frames: Vec<MapPlace>,
    /// What the plane does not show, 0..1.
    pub stress: f64,
}

/// A moment on the map.
#[derive(Debug, Serialize, ToSchema)]
pub struct MapPlace {
    /// Id of its clip.
    pub clip: String,
    /// Its frame.
    pub frame: usize,
    /// Place.
    pub x: f32,
    /// Place.
    pub y: f32,
}

/// Of the source of a document.
///
/// # Errors
/// When there is no source, or it does not move.
pub(crate) fn suggestions(
    document: &Document,
    folder: &Folder,
    media: &Media,
    count: usize,
) -> Result<Suggestions, StudioError> {
    let prepared = Prepared::source(document, folder, media)?;
    let moments = Moments::of(&prepared.takes, &Options::default())?;
    let map = MotionMap::of(&moments)?;
    let place = |frame| prepared.map.to_clip(frame).unwrap_or_default();
    let rate = |id: &str| {
        document
            .clip(id)
            .and_then(|entry| media.clip(folder, entry).ok())
            .map_or(30.0, |import| import.clip.frame_rate())
    };
    let found = candidates(&moments, count)?.into_iter().map(|candidate| {
        let (clip, frame) = place(candidate.moment.frame);
        let [x, y] = map.place_of(candidate.moment.frame).unwrap_or_default();
        let seconds = frame as f64 / rate(clip);
        Suggestion {
            clip: clip.into(),
            frame,
            seconds,
            share: candidate.share,
            radius: candidate.radius,
            x,
            y,
        }
    });
    let candidates = found.collect();
    let frames = map.frames.iter().map(|at| {
        let (clip, frame) = place(at.moment.frame);
        MapPlace { clip: clip.into(), frame, x: at.place[0] as f32, y: at.place[1] as f32 }
    });
    let info = MapInfo { frames: frames.collect(), stress: map.stress };
    Ok(Suggestions { candidates, map: info })
}
