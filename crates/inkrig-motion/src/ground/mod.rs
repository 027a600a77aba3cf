//! The character over the ground: travel and sway, root bones, given paths, and feet that stand.
//!
//! "The ground" is the x-z plane as a [`DVec2`]: x to the right, z towards a viewer who looks down with x to the
//! right. A heading or direction of angle h is (sin h, cos h): 0 is +z, a turn to the left is positive.

mod contacts;
mod continuation;
mod follow;
mod in_place;
mod line;
mod low_pass;
mod path;
mod placement;
mod root_bone;
mod spine;
mod trajectory;

pub use contacts::{Contacts, Slide};
pub use continuation::continued;
pub(crate) use continuation::rounds;
pub use follow::{Followed, PathOptions, Route, follow_path};
pub use in_place::in_place;
pub use path::GroundPath;
pub use placement::{GroundMove, move_over_ground, shift};
pub use root_bone::{
    BONE_NAME, BoneChange, SkeletonChange, add_root_bone, empty_root_bone, fold_root_bone, root_bone,
};
pub use trajectory::{Trajectory, TravelOptions};

use glam::DVec2;

/// The unit vector of a direction, radians.
fn direction(angle: f64) -> DVec2 {
    DVec2::new(angle.sin(), angle.cos())
}

/// The direction of a vector, radians in -pi..=pi.
fn angle_of(vector: DVec2) -> f64 {
    vector.x.atan2(vector.y)
}

/// A vector turned to the left by an angle, radians.
fn turned(vector: DVec2, angle: f64) -> DVec2 {
    let (sin, cos) = angle.sin_cos();
    DVec2::new(vector.x * cos + vector.y * sin, vector.y * cos - vector.x * sin)
}

/// The same angle in -pi..=pi.
fn wrapped(angle: f64) -> f64 {
    angle - std::f64::consts::TAU * (angle / std::f64::consts::TAU).round()
}

/// The size that lengths on the ground are measured by: the skeleton's, or a metre for one without size.
fn size_of(skeleton: &crate::Skeleton) -> f64 {
    let extent = f64::from(skeleton.extent());
    if extent > 1e-6 { extent } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turning_left_raises_the_angle() {
        for angle in [-2.0, 0.3, 1.5] {
            let vector = turned(direction(angle) * 2.0, 0.7);
            assert!((angle_of(vector) - (angle + 0.7)).abs() < 1e-12);
            let as_rotation = glam::DQuat::from_rotation_y(angle) * glam::DVec3::Z;
            assert!(direction(angle).distance(DVec2::new(as_rotation.x, as_rotation.z)) < 1e-12);
        }
        assert!((wrapped(7.0) - (7.0 - std::f64::consts::TAU)).abs() < 1e-12);
    }
}
