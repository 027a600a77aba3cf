//! Ways over the ground. A line that comes down the picture may be a body that sinks, or one that comes nearer: where the word is of going
//! somewhere, it is the latter, and the pelvis stays as high as it is drawn.

use crate::plan::Plan;
use inkrig_generate::guidance::Ask;
use inkrig_motion::glam::{Mat2, Vec2, Vec3};
use inkrig_motion::humanml::Camera;

/// Words of going somewhere.
const GOING: [&str; 8] = ["walk", "run", "jog", "march", "limp", "sneak", "step", "turn"];
/// A camera that looks less down than this, as a sine, sees no ground to speak of.
const FLAT: f32 = 0.08;

impl Plan {
    /// Where in the world the pelvis is on its way over the ground; nothing where the plan has no such way.
    pub(crate) fn over_ground(&self) -> Vec<Ask> {
        let going = GOING.iter().any(|word| self.word.split_whitespace().any(|own| own == *word));
        if !going || !self.placed {
            return Vec::new();
        }
        let ways = self.ways.iter().filter(|(joint, ..)| *joint == 0);
        ways.flat_map(|(joint, first, places)| {
            let height = places.first().map_or(0.0, |begin| height(&self.camera, *begin));
            let at = move |(number, place): (usize, &Vec2)| {
                let place = on_level(&self.camera, *place, height)?;
                Some(Ask { frame: first + number, joint: *joint, place })
            };
            places.iter().enumerate().filter_map(at)
        })
        .collect()
    }
}

/// How high a place over the origin is.
pub(crate) fn height(camera: &Camera, begin: Vec2) -> f32 {
    begin.y / camera.project(Vec3::Y).y.max(0.1)
}

/// The place of a height that is seen there; `None` where the camera hardly looks down.
pub(crate) fn on_level(camera: &Camera, seen: Vec2, height: f32) -> Option<Vec3> {
    let across = Mat2::from_cols(camera.project(Vec3::X), camera.project(Vec3::Z));
    if across.determinant().abs() < FLAT {
        return None;
    }
    let flat = across.inverse() * (seen - camera.project(Vec3::Y * height));
    Some(Vec3::new(flat.x, height, flat.y))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(word: &str, pitch: f32) -> (Plan, Vec<Vec3>) {
        let camera = Camera::new(pitch, 0.5);
        let places: Vec<Vec3> =
            (0..20).map(|i| Vec3::new(0.03, 0.0, 0.06) * i as f32 + 0.95 * Vec3::Y).collect();
        let seen = places.iter().map(|place| camera.project(*place)).collect();
        let ways = vec![(0, 3, seen), (20, 0, vec![Vec2::ZERO; 5])];
        let plan = Plan { ways, ..Plan::of_word(word.into(), 40, camera) };
        (plan, places)
    }

    #[test]
    fn a_walk_comes_nearer_where_its_line_comes_down() {
        let (plan, places) = plan("walk", 0.35);
        let asks = plan.over_ground();
        assert_eq!(asks.len(), places.len());
        for (ask, place) in asks.iter().zip(&places) {
            assert!(ask.joint == 0 && ask.place.distance(*place) < 1e-4, "{ask:?} is not at {place}");
        }
        assert_eq!((asks[0].frame, asks[19].frame), (3, 22));
    }

    #[test]
    fn nothing_is_said_of_jumps_and_by_a_camera_that_does_not_look_down() {
        assert!(plan("jump", 0.35).0.over_ground().is_empty());
        assert!(plan("walk", 0.0).0.over_ground().is_empty());
        assert!(Plan { placed: false, ..plan("walk", 0.35).0 }.over_ground().is_empty());
    }
}
