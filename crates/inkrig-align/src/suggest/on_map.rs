//! A drawing over the map of a clip means the moments that it passes.

use super::{Candidate, MotionMap};
use crate::{Key, Place};

/// Weight of the keys. Over six drawings on the maps of two clips, mean distance on the map between where the drawing is
/// and the moment that is used: .88 without keys, .22 with this weight, .21 when the control's scale is learned too.
const WEIGHT: f64 = 3.0;

/// Soft keys that tie a drawing to a map: for each candidate, its place on the map means its pose. What lies between
/// follows by its distances. For a curve in the map's own coordinates, best with
/// [`Norm::Learned`](crate::Norm::Learned) for the control, since a drawing seldom covers the whole map.
pub fn keys_on_map(map: &MotionMap, candidates: &[Candidate]) -> Vec<Key> {
    let keys = candidates.iter().filter_map(|candidate| {
        let frame = candidate.moment.frame;
        let place = Place::Value(map.place_of(frame)?.to_vec());
        Some(Key::Soft { place, pose: frame.into(), weight: WEIGHT })
    });
    keys.collect()
}
