//! The outline of a tapered capsule in the picture plane.

use inkrig_motion::glam::Vec2;
use tiny_skia::{Path, PathBuilder};

/// Adds the hull of two circles, in pixels, always wound the same way.
pub(super) fn add_capsule(path: &mut PathBuilder, from: Vec2, from_radius: f32, to: Vec2, to_radius: f32) {
    let axis = to - from;
    let length = axis.length();
    if length <= (from_radius - to_radius).abs() + 1e-3 {
        let (centre, radius) = if from_radius > to_radius { (from, from_radius) } else { (to, to_radius) };
        path.push_circle(centre.x, centre.y, radius);
        return;
    }
    let along = axis.y.atan2(axis.x);
    // Where the common tangents touch, as angles from the axis.
    let touch = ((from_radius - to_radius) / length).clamp(-1.0, 1.0).acos();
    let turn = std::f32::consts::TAU;
    let back = arc(from, from_radius, along + touch, along + turn - touch);
    let front = arc(to, to_radius, along - touch, along + touch);
    for (index, point) in back.chain(front).enumerate() {
        if index == 0 {
            path.move_to(point.x, point.y);
        } else {
            path.line_to(point.x, point.y);
        }
    }
    path.close();
}

/// [`add_capsule`] as a path of its own. `None` when it is empty or not finite.
pub(super) fn capsule(from: Vec2, from_radius: f32, to: Vec2, to_radius: f32) -> Option<Path> {
    let mut path = PathBuilder::new();
    add_capsule(&mut path, from, from_radius, to, to_radius);
    path.finish()
}

/// A [`capsule`] without its round ends.
pub(super) fn band(from: Vec2, from_radius: f32, to: Vec2, to_radius: f32) -> Option<Path> {
    let across = (to - from).normalize_or(Vec2::Y).perp();
    let corners = [
        from + across * from_radius,
        to + across * to_radius,
        to - across * to_radius,
        from - across * from_radius,
    ];
    let mut path = PathBuilder::new();
    path.move_to(corners[0].x, corners[0].y);
    for corner in &corners[1..] {
        path.line_to(corner.x, corner.y);
    }
    path.close();
    path.finish()
}

fn arc(centre: Vec2, radius: f32, begin: f32, end: f32) -> impl Iterator<Item = Vec2> {
    let steps = (radius.abs().min(200.0) as usize).clamp(8, 64);
    (0..=steps).map(move |step| {
        centre + radius * Vec2::from_angle(begin + (end - begin) * step as f32 / steps as f32)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_capsule_reaches_around_both_ends() {
        let path = capsule(Vec2::new(10.0, 0.0), 3.0, Vec2::new(20.0, 0.0), 1.0).unwrap();
        let bounds = path.bounds();
        assert!((bounds.left() - 7.0).abs() < 0.1 && (bounds.right() - 21.0).abs() < 0.1, "{bounds:?}");
        assert!((bounds.top() + 3.0).abs() < 0.1 && (bounds.bottom() - 3.0).abs() < 0.1, "{bounds:?}");
    }

    #[test]
    fn a_circle_inside_another_is_not_seen() {
        let path = capsule(Vec2::ZERO, 5.0, Vec2::X, 1.0).unwrap();
        assert!((path.bounds().right() - 5.0).abs() < 1e-3);
    }
}
