//! From a drawn way to places in space.

use super::read::{CreatureFrame, CreatureWay};
use crate::ground::on_level;
use inkrig_generate::text::{VERBS, actions_in};
use inkrig_motion::glam::{Vec2, Vec3};

/// Words of leaving the ground: a line that goes up the picture then goes up.
const UP: [&str; 8] = ["jump", "climb", "fall", "dive", "flip", "hang", "sit down", "lie down"];
/// The same, of animals.
const UP_OF_ANIMALS: [&str; 3] = ["fly", "flap", "soar"];

/// The way of a body from where it begins, in canvas units.
pub(super) struct World {
    /// Evenly over time, from the origin.
    pub(super) places: Vec<Vec3>,
    pub(super) seconds: f64,
    /// Whether the line is read as one on the ground, and not as one in the picture's plane.
    pub(super) over_ground: bool,
}

impl World {
    /// The way of the frame's whole body, if it has one that goes anywhere.
    pub(super) fn of(frame: &CreatureFrame) -> Option<Self> {
        let way = frame.ways.iter().find(|way| way.travels)?;
        let from = way.points.first()?;
        let flat: Option<Vec<Vec3>> = Some(!goes_up(&frame.word))
            .filter(|flat| *flat)
            .and_then(|_| way.points.iter().map(|at| on_level(&frame.camera, *at - *from, 0.0)).collect());
        let over_ground = flat.is_some();
        let places = flat.unwrap_or_else(|| in_picture(frame, way, *from));
        let own = Self { places, seconds: way.seconds, over_ground };
        (own.length() > 0.0 && own.places.len() > 1).then_some(own)
    }

    /// Canvas units.
    pub(super) fn length(&self) -> f32 {
        self.places.windows(2).map(|pair| pair[0].distance(pair[1])).sum()
    }

    /// The place at a time; the last one behind the end.
    pub(super) fn at(&self, seconds: f64) -> Vec3 {
        let last = self.places.len() - 1;
        let place = (seconds / self.seconds.max(1e-6)).clamp(0.0, 1.0) * last as f64;
        let low = (place.floor() as usize).min(last);
        self.places[low].lerp(self.places[(low + 1).min(last)], place.fract() as f32)
    }
}

/// Up the picture is up.
fn in_picture(frame: &CreatureFrame, way: &CreatureWay, from: Vec2) -> Vec<Vec3> {
    let right = frame.camera.view_from_world().row(0);
    let up = frame.camera.project(Vec3::Y).y.max(0.1);
    way.points.iter().map(|at| right * (at.x - from.x) + Vec3::Y * ((at.y - from.y) / up)).collect()
}

fn goes_up(word: &str) -> bool {
    let verbs = actions_in(word);
    let known = verbs.iter().filter_map(|at| VERBS.get(*at)).any(|verb| UP.contains(&verb.name));
    known
        || word
            .to_lowercase()
            .split_whitespace()
            .any(|own| UP_OF_ANIMALS.iter().any(|up| own.starts_with(up)))
}
