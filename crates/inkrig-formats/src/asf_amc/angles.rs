//! Angles about the axes of a bone's frame.

use super::bone::Dof;
use crate::{Axis, euler};
use inkrig_motion::glam::{DQuat, DVec3};

/// How rotations about three axes follow each other: `XYZ` turns about the fixed x first, about the fixed z last.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Order([usize; 3]);

impl Default for Order {
    fn default() -> Self {
        Self([0, 1, 2])
    }
}

impl Order {
    /// The order of a word such as `XYZ`: each axis once.
    pub(super) fn of(word: &[u8]) -> Option<Self> {
        let mut order = [0; 3];
        let mut seen = [false; 3];
        if word.len() != 3 {
            return None;
        }
        for (slot, byte) in order.iter_mut().zip(word) {
            let axis = b"xyz".iter().position(|axis| *axis == byte.to_ascii_lowercase())?;
            *seen.get_mut(axis).filter(|seen| !**seen)? = true;
            *slot = axis;
        }
        Some(Self(order))
    }

    /// The rotation of angles about x, y, z in degrees.
    pub(super) fn rotation(self, degrees: DVec3) -> DQuat {
        let [first, second, third] = self.0.map(|axis| about(axis, degrees));
        third * second * first
    }
}

fn about(axis: usize, degrees: DVec3) -> DQuat {
    match axis {
        0 => euler::rotation(Axis::X, degrees.x),
        1 => euler::rotation(Axis::Y, degrees.y),
        _ => euler::rotation(Axis::Z, degrees.z),
    }
}

/// The numbers of a row as angles about x, y, z and a translation.
pub(super) fn sorted(dofs: &[Dof], values: &[f64], degrees_per_unit: f64) -> (DVec3, DVec3) {
    let (mut angles, mut translation) = ([0.0; 3], [0.0; 3]);
    for (dof, &value) in dofs.iter().zip(values) {
        let (slot, value) = match dof {
            Dof::Rotation(axis) => (angles.get_mut(*axis), value * degrees_per_unit),
            Dof::Translation(axis) => (translation.get_mut(*axis), value),
            Dof::Length => (None, 0.0),
        };
        if let Some(slot) = slot {
            *slot = value;
        }
    }
    (DVec3::from_array(angles), DVec3::from_array(translation))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_order_turns_about_its_first_axis_first() {
        let turn = DVec3::new(90.0, 0.0, 90.0);
        let xyz = Order::of(b"XYZ").unwrap().rotation(turn);
        // x first: y goes to z and stays there under the turn about z.
        assert!((xyz * DVec3::Y).distance(DVec3::Z) < 1e-12);
        let zyx = Order::of(b"zyx").unwrap().rotation(turn);
        assert!((zyx * DVec3::Y).distance(DVec3::NEG_X) < 1e-12);
        for bad in ["XXY", "XY", "XYW", "XYZX", ""] {
            assert_eq!(Order::of(bad.as_bytes()), None, "{bad}");
        }
    }

    #[test]
    fn a_row_is_sorted_by_its_degrees_of_freedom() {
        let dofs = [b"TY", b"rz"].map(|word| Dof::of(word).unwrap());
        let (angles, translation) = sorted(&dofs, &[2.0, 1.0], 10.0);
        assert_eq!((angles, translation), (DVec3::new(0.0, 0.0, 10.0), DVec3::new(0.0, 2.0, 0.0)));
        assert_eq!(Dof::of(b"q"), None);
    }
}
