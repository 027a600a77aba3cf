//! The unit and the axes of a file.

use crate::{
    Evidence, Finding, ImportOptions, UpAxis,
    figure::{Placed, clip_from_file},
    import,
};
use inkrig_motion::glam::{DAffine3, DMat3, DVec3};
use ufbx::{CoordinateAxis, Scene};

/// How places of the file become places of a clip, and how that is known.
#[derive(Debug, Clone, Copy)]
pub(super) struct Axes {
    pub(super) metres_per_unit: f64,
    pub(super) unit_evidence: Evidence,
    pub(super) up: UpAxis,
    pub(super) up_evidence: Evidence,
    clip_from_file: DAffine3,
}

impl Axes {
    /// What the file declares, unless something else is given. Without a word, FBX is in centimetres and y up.
    pub(super) fn of(scene: &Scene, options: &ImportOptions, findings: &mut Vec<Finding>) -> Self {
        let settings = &scene.settings;
        let said = |name: &str| match settings.props.find_prop(name) {
            Some(_) => Evidence::Declared,
            None => Evidence::Assumed,
        };
        let declared = settings.unit_meters;
        let usable = import::check_metres_per_unit(declared).is_ok();
        let (metres_per_unit, unit_evidence) = match options.metres_per_unit {
            Some(given) => (given, Evidence::Given),
            None if usable => (declared, said("UnitScaleFactor")),
            None => {
                let message = format!("a unit of {declared} m is none; centimetres are taken");
                findings.push(Finding::warning("fbx-unit", message));
                (0.01, Evidence::Assumed)
            }
        };
        if let Some(up) = options.up {
            let clip_from_file = clip_from_file(metres_per_unit, up);
            return Self { metres_per_unit, unit_evidence, up, up_evidence: Evidence::Given, clip_from_file };
        }
        let axes = [settings.axes.right, settings.axes.up, settings.axes.front].map(axis);
        let (up, up_evidence, turn) = match known(axes) {
            Some((up, turn)) => (up, said("UpAxis"), turn),
            None => {
                let message = "the file's axes are not three that stand on each other; y is taken as up";
                findings.push(Finding::warning("fbx-axes", message.into()));
                (UpAxis::Y, Evidence::Assumed, DMat3::IDENTITY)
            }
        };
        let clip_from_file = DAffine3::from_mat3(turn * metres_per_unit);
        Self { metres_per_unit, unit_evidence, up, up_evidence, clip_from_file }
    }

    /// What the file's roots stand in.
    pub(super) fn origin(&self) -> Placed {
        Placed::origin(self.clip_from_file)
    }
}

/// The axes right, up and front of a file as rows: what turns its places into those of a clip. The axis that points up
/// is y for what cannot be said.
fn known(axes: [DVec3; 3]) -> Option<(UpAxis, DMat3)> {
    let [right, up, front] = axes;
    let turn = DMat3::from_cols(right, up, front).transpose();
    let sound = turn.determinant().abs() > 0.5;
    let named = if up.abs() == DVec3::Z { UpAxis::Z } else { UpAxis::Y };
    sound.then_some((named, turn))
}

fn axis(axis: CoordinateAxis) -> DVec3 {
    match axis {
        CoordinateAxis::PositiveX => DVec3::X,
        CoordinateAxis::NegativeX => DVec3::NEG_X,
        CoordinateAxis::PositiveY => DVec3::Y,
        CoordinateAxis::NegativeY => DVec3::NEG_Y,
        CoordinateAxis::PositiveZ => DVec3::Z,
        CoordinateAxis::NegativeZ => DVec3::NEG_Z,
        CoordinateAxis::Unknown => DVec3::ZERO,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn common_axes_become_those_of_a_clip() {
        let (up, turn) = known([DVec3::X, DVec3::Y, DVec3::Z]).unwrap();
        assert_eq!((up, turn), (UpAxis::Y, DMat3::IDENTITY));
        // Blender and 3ds Max: z up, y away from the viewer.
        let (up, turn) = known([DVec3::X, DVec3::Z, DVec3::NEG_Y]).unwrap();
        assert_eq!(up, UpAxis::Z);
        let v = DVec3::new(1.0, 2.0, 3.0);
        assert_eq!(turn * v, UpAxis::Z.clip_from_file(v));
        assert_eq!(known([DVec3::X, DVec3::X, DVec3::Z]), None);
        assert_eq!(known([DVec3::X, DVec3::Y, DVec3::ZERO]), None);
    }
}
