//! The HIERARCHY part: joints, offsets, channels.

use crate::{Channel, Finding, Place};
use inkrig_motion::glam::DVec3;

/// The joints of a file in file order, which is depth first.
#[derive(Debug, Default)]
pub(super) struct Hierarchy {
    pub(super) joints: Vec<RawJoint>,
    /// Where the first name is that is not UTF-8.
    pub(super) first_broken_name: Option<Place>,
    /// Where the first name should be that is missing.
    pub(super) first_empty_name: Option<Place>,
}

/// A joint in the file's units and axes.
#[derive(Debug)]
pub(super) struct RawJoint {
    pub(super) name: String,
    pub(super) parent: Option<usize>,
    pub(super) offset: DVec3,
    pub(super) end_site: bool,
    pub(super) channels: Vec<Channel>,
}

impl Hierarchy {
    /// Number of values in a row.
    pub(super) fn width(&self) -> usize {
        self.joints.iter().map(|joint| joint.channels.len()).sum()
    }

    /// The joint and the channel that a value of a row belongs to.
    pub(super) fn owner(&self, value: usize) -> Option<(&RawJoint, Channel)> {
        let mut all =
            self.joints.iter().flat_map(|joint| joint.channels.iter().map(move |&channel| (joint, channel)));
        all.nth(value)
    }

    /// What there is to say about names.
    pub(super) fn findings(&self) -> Vec<Finding> {
        let broken = self.first_broken_name.clone().map(|place| {
            let message = "a joint name is not UTF-8; its unreadable bytes are replaced".into();
            Finding::warning("bvh-name-encoding", message).at(place)
        });
        let empty = self
            .first_empty_name
            .clone()
            .map(|place| Finding::warning("bvh-empty-name", "a joint has no name".into()).at(place));
        broken.into_iter().chain(empty).collect()
    }
}
