//! The rest pose: that in which meshes were bound, where the file has it. The nodes' own places are often those of the
//! frame at which the file was written.

use super::{bones::Bones, pose};
use crate::{
    Finding,
    figure::{Figure, Placed},
    lexer::LARGEST_NUMBER,
};
use inkrig_motion::glam::{DAffine3, DMat3, DVec3};
use ufbx::{Matrix, Scene};

/// How far lengths of bones may differ between the two, all together: else one of them is of another figure.
const MISFIT: f64 = 0.01;

/// Places the figure at rest; whether that was reckoned apart from the nodes' own places.
pub(super) fn rest(
    scene: &Scene,
    bones: &Bones<'_>,
    figure: &Figure,
    origin: Placed,
    findings: &mut Vec<Finding>,
) -> (Vec<Placed>, bool) {
    let mut own = vec![Placed::STILL; bones.nodes.len()];
    pose::place(bones, figure, &bones.locals, None, origin, &mut own);
    let bound = bound(scene, bones);
    if bound.iter().all(Option::is_none) {
        return (own, false);
    }
    let mut rest = own.clone();
    pose::place(bones, figure, &bones.locals, Some(&bound), origin, &mut rest);
    let length = |placed: &[Placed], node: usize, parent: usize| {
        Some(placed.get(node)?.world.translation.distance(placed.get(parent)?.world.translation))
    };
    let (mut total, mut off) = (0.0, 0.0);
    for joint in &figure.joints {
        let Some(parent) = joint.parent.and_then(|parent| figure.joints.get(parent)) else { continue };
        let lengths = (length(&own, joint.node, parent.node), length(&rest, joint.node, parent.node));
        if let (Some(own), Some(bound)) = lengths {
            total += own;
            off += (own - bound).abs();
        }
    }
    if off <= MISFIT * total {
        // What is the same to the last digits was reckoned at once.
        return (rest, off > 1e-9 * total);
    }
    let message = "bones have other lengths in the pose in which the mesh was bound; \
        the rest pose is that of the file's nodes";
    findings.push(Finding::info("fbx-bind-pose", message.into()));
    (own, false)
}

/// Where nodes were in the file's world when meshes were bound to them.
fn bound(scene: &Scene, bones: &Bones<'_>) -> Vec<Option<DAffine3>> {
    let mut bound = vec![None; bones.nodes.len()];
    let poses = scene.poses.iter().filter(|pose| pose.is_bind_pose);
    let poses = poses.flat_map(|pose| pose.bone_poses.iter());
    let of_poses = poses.map(|pose| (pose.bone_node.element.element_id, &pose.bone_to_world));
    let of_skins = scene
        .skin_clusters
        .iter()
        .filter_map(|cluster| Some((cluster.bone_node.as_ref()?.element.element_id, &cluster.bind_to_world)));
    // What a mesh hangs on counts most.
    for (element, matrix) in of_poses.chain(of_skins) {
        let slot = bones.place(element).and_then(|place| bound.get_mut(place));
        if let (Some(slot), Some(matrix)) = (slot, affine(matrix)) {
            *slot = Some(matrix);
        }
    }
    bound
}

/// A matrix that can be undone.
fn affine(m: &Matrix) -> Option<DAffine3> {
    let turn = DMat3::from_cols(
        DVec3::new(m.m00, m.m10, m.m20),
        DVec3::new(m.m01, m.m11, m.m21),
        DVec3::new(m.m02, m.m12, m.m22),
    );
    let place = DVec3::new(m.m03, m.m13, m.m23);
    let usable = |v: DVec3| v.is_finite() && v.abs().max_element() <= LARGEST_NUMBER;
    let sound = [turn.x_axis, turn.y_axis, turn.z_axis, place].into_iter().all(usable);
    (sound && turn.determinant().abs() > 1e-12).then(|| DAffine3::from_mat3_translation(turn, place))
}
