//! The joints of a character and how they hang together.

use crate::MotionError;
use glam::Vec3;

/// One joint of a [`Skeleton`].
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// The name exactly as in the file; names may repeat and may hold spaces.
    pub name: String,
    /// Index of the parent, which stands before this joint; `None` for a root.
    pub parent: Option<usize>,
    /// Offset from the parent in the rest pose, in the parent's space, metres.
    pub offset: Vec3,
    /// The tip of a chain: it has a place but no rotation of its own.
    pub end_site: bool,
}

impl Joint {
    /// A joint that can turn. `offset` is in metres, in the parent's space.
    pub fn new(name: impl Into<String>, parent: Option<usize>, offset: Vec3) -> Self {
        Self { name: name.into(), parent, offset, end_site: false }
    }

    /// The tip of a chain below `parent`. By convention its name is the parent's with `_end` behind it.
    pub fn end(name: impl Into<String>, parent: usize, offset: Vec3) -> Self {
        Self { name: name.into(), parent: Some(parent), offset, end_site: true }
    }
}

/// A forest of joints, parents before children. Cannot be changed once made.
#[derive(Debug, Clone, PartialEq)]
pub struct Skeleton {
    joints: Vec<Joint>,
}

impl Skeleton {
    /// Checks and keeps `joints`.
    ///
    /// # Errors
    /// When there is no joint, when a parent does not stand before its child, or when an offset is not finite.
    pub fn new(joints: Vec<Joint>) -> Result<Self, MotionError> {
        if joints.is_empty() {
            return Err(MotionError::EmptySkeleton);
        }
        for (index, joint) in joints.iter().enumerate() {
            if let Some(parent) = joint.parent.filter(|&p| p >= index) {
                return Err(MotionError::ParentAfterChild { joint: index, name: joint.name.clone(), parent });
            }
            if !joint.offset.is_finite() {
                return Err(MotionError::NotFinite { what: "an offset", joint: index, frame: 0 });
            }
        }
        Ok(Self { joints })
    }

    /// All joints, parents before children.
    pub fn joints(&self) -> &[Joint] {
        &self.joints
    }

    /// How many joints there are, end sites included. Never 0.
    #[expect(clippy::len_without_is_empty, reason = "a skeleton is never empty")]
    pub fn len(&self) -> usize {
        self.joints.len()
    }

    /// Indices of the joints without a parent.
    pub fn roots(&self) -> impl Iterator<Item = usize> + '_ {
        self.joints.iter().enumerate().filter(|(_, joint)| joint.parent.is_none()).map(|(index, _)| index)
    }

    /// Index of the first joint of that name.
    pub fn find(&self, name: &str) -> Option<usize> {
        self.joints.iter().position(|joint| joint.name == name)
    }

    /// Number of joints between each joint and its root; 0 for a root.
    pub fn depths(&self) -> Vec<usize> {
        let mut depths: Vec<usize> = Vec::with_capacity(self.len());
        for joint in &self.joints {
            depths.push(joint.parent.map_or(0, |parent| depths[parent] + 1));
        }
        depths
    }

    /// Which joints stand above a joint, the joint itself not included.
    pub fn ancestors(&self, joint: usize) -> Vec<bool> {
        let mut above = vec![false; self.len()];
        let mut next = self.joints.get(joint).and_then(|joint| joint.parent);
        while let Some(index) = next {
            above[index] = true;
            next = self.joints[index].parent;
        }
        above
    }

    /// Where the joints are when nothing is turned, in metres, each root at its own offset.
    pub fn rest_positions(&self) -> Vec<Vec3> {
        let mut positions: Vec<Vec3> = Vec::with_capacity(self.len());
        for joint in &self.joints {
            positions.push(joint.parent.map_or(Vec3::ZERO, |parent| positions[parent]) + joint.offset);
        }
        positions
    }

    /// The longest side of the rest pose's bounding box, in metres: the character's size whatever it is
    /// (a standing person's height, a dog's length). 0 when all joints coincide.
    pub fn extent(&self) -> f32 {
        let positions = self.figure_positions();
        let low = positions.iter().copied().fold(Vec3::MAX, Vec3::min);
        let high = positions.iter().copied().fold(Vec3::MIN, Vec3::max);
        (high - low).max_element()
    }

    /// Rest positions without what only places the figure in the world: the offset of a root, and that of the hips
    /// when they hang alone below a still root.
    fn figure_positions(&self) -> Vec<Vec3> {
        let mut children = vec![0_usize; self.len()];
        for parent in self.joints.iter().filter_map(|joint| joint.parent) {
            children[parent] += 1;
        }
        let mut positions: Vec<Vec3> = Vec::with_capacity(self.len());
        for (index, joint) in self.joints.iter().enumerate() {
            let Some(parent) = joint.parent else {
                positions.push(Vec3::ZERO);
                continue;
            };
            let hips = self.joints[parent].parent.is_none() && children[parent] == 1 && children[index] > 1;
            positions.push(positions[parent] + if hips { Vec3::ZERO } else { joint.offset });
        }
        positions
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parents_stand_before_children() {
        let joints = vec![Joint::new("a", Some(1), Vec3::ZERO), Joint::new("b", None, Vec3::ZERO)];
        assert!(matches!(
            Skeleton::new(joints),
            Err(MotionError::ParentAfterChild { joint: 0, parent: 1, .. })
        ));
        assert_eq!(Skeleton::new(vec![]), Err(MotionError::EmptySkeleton));
    }

    #[test]
    fn a_hip_far_below_a_still_root_does_not_make_the_figure_larger() {
        let skeleton = Skeleton::new(vec![
            Joint::new("root", None, Vec3::ZERO),
            Joint::new("hips", Some(0), Vec3::new(0.0, 0.9, -450.0)),
            Joint::new("spine", Some(1), Vec3::new(0.0, 0.5, 0.0)),
            Joint::new("leg", Some(1), Vec3::new(0.0, -0.9, 0.0)),
        ])
        .unwrap();
        assert!((skeleton.extent() - 1.4).abs() < 1e-6);
        assert_eq!(skeleton.rest_positions()[2], Vec3::new(0.0, 1.4, -450.0));
    }
}
