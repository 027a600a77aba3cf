//! The camera that a drawing is seen through.

use glam::{Mat3, Vec2, Vec3};

/// An orthographic camera without place or scale: metres stay metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    view_from_world: Mat3,
}

impl Default for Camera {
    /// The three-quarter view: 20 degrees down, 30 degrees round.
    fn default() -> Self {
        Self::new(20_f32.to_radians(), 30_f32.to_radians())
    }
}

impl Camera {
    /// Turned round the vertical by `yaw`, then tilted by `pitch`, radians.
    pub fn new(pitch: f32, yaw: f32) -> Self {
        Self { view_from_world: Mat3::from_rotation_x(pitch) * Mat3::from_rotation_y(yaw) }
    }

    /// Where a point of the world is on the picture: x to the right, y up, metres.
    pub fn project(&self, point: Vec3) -> Vec2 {
        (self.view_from_world * point).truncate()
    }

    /// The rotation itself.
    pub fn view_from_world(&self) -> Mat3 {
        self.view_from_world
    }
}
