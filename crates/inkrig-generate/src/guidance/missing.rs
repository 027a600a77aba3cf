//! By how much joints and poses miss where they are asked to be, as ways in space, and the way back for gradients.

use super::target::View;
use inkrig_motion::glam::{Vec2, Vec3};
use inkrig_motion::humanml::{JOINTS, Joints};

/// The way from one place to another as far as it is seen.
pub(crate) fn between(view: View, from: Vec3, to: Vec3) -> Vec3 {
    match view {
        View::Space => to - from,
        View::Plane(camera) => back(view, to.truncate() - camera.project(from)),
    }
}

fn back(view: View, by: Vec2) -> Vec3 {
    match view {
        View::Space => Vec3::ZERO,
        View::Plane(camera) => camera.view_from_world().transpose() * by.extend(0.0),
    }
}

/// Of all joints, the pelvis at its place; in space heights are what they are.
pub(crate) fn of_pose(view: View, now: &Joints, wanted: &Joints) -> Vec<f32> {
    let by = now.iter().zip(wanted).map(|(now_at, wanted_at)| match view {
        View::Space => {
            let root = |pose: &Joints| Vec3::new(pose[0].x, 0.0, pose[0].z);
            (*wanted_at - root(wanted)) - (*now_at - root(now))
        }
        View::Plane(camera) => {
            let seen = |place: Vec3| camera.project(place);
            let relative = wanted_at.truncate() - wanted[0].truncate();
            back(view, relative - (seen(*now_at) - seen(now[0])))
        }
    });
    by.flat_map(|by| by.to_array()).collect()
}

/// What of a way in space is seen.
pub(crate) fn seen_part(view: View, by: Vec3) -> Vec3 {
    match view {
        View::Space => by,
        View::Plane(camera) => back(view, camera.project(by)),
    }
}

/// What of a way is away from the camera, or towards it.
pub(crate) fn away(view: View, by: Vec3) -> Vec3 {
    match view {
        View::Space => Vec3::ZERO,
        View::Plane(camera) => {
            let axis = camera.view_from_world().row(2);
            axis * axis.dot(by)
        }
    }
}

/// From the gradient of [`of_pose`] to that of the joints before they were [`augment`]ed.
pub(crate) fn of_pose_back(view: View, grad: &[f32]) -> Joints {
    let mut of = [Vec3::ZERO; JOINTS];
    let mut root = Vec3::ZERO;
    for (of, grad) in of.iter_mut().zip(grad.chunks_exact(3)) {
        let by = seen_part(view, Vec3::new(grad[0], grad[1], grad[2]));
        *of = -by;
        root += if view == View::Space { Vec3::new(by.x, 0.0, by.z) } else { by };
    }
    of[0] += root;
    // Points on the line between two others.
    for (point, (from, to), share) in
        [(16, (13, 18), 0.5), (17, (14, 19), 0.5), (6, (3, 12), 1.0 / 3.0), (9, (3, 12), 2.0 / 3.0)]
    {
        let by = std::mem::replace(&mut of[point], Vec3::ZERO);
        of[from] += (1.0 - share) * by;
        of[to] += share * by;
    }
    of
}
