//! The body of a bare skeleton as a mesh.

use super::parts::{Parts, Target};
use crate::body::body;
use inkrig_motion::Clip;
use serde_json::{Value, json};

/// The mesh of a clip's skeleton at rest. `skin_place` is the place of each joint in the skin.
pub(super) fn mesh(clip: &Clip, skin_place: &[Option<u16>], parts: &mut Parts) -> Value {
    let place = |joint: usize| skin_place.get(joint).copied().flatten();
    let body = body(clip, &|joint| place(joint).is_some());
    let vertices = body.places.len();
    let position = parts.places(&body.places);
    let normal = parts.vectors(&body.normals, Some(Target::Vertices));
    let bones =
        body.bones.iter().flat_map(|&bone| [place(bone).unwrap_or(0), 0, 0, 0]).flat_map(u16::to_le_bytes);
    let described = json!({ "componentType": 5123, "count": vertices, "type": "VEC4" });
    let joints = parts.other(bones, described, Some(Target::Vertices));
    let described = json!({ "componentType": 5121, "normalized": true, "count": vertices, "type": "VEC4" });
    let weights = parts.other((0..vertices).flat_map(|_| [255, 0, 0, 0]), described, Some(Target::Vertices));
    let described = json!({ "componentType": 5125, "count": body.indices.len(), "type": "SCALAR" });
    let indices = body.indices.iter().flat_map(|index| index.to_le_bytes());
    let indices = parts.other(indices, described, Some(Target::Indices));
    let attributes =
        json!({ "POSITION": position, "NORMAL": normal, "JOINTS_0": joints, "WEIGHTS_0": weights });
    json!({ "name": "body", "primitives": [{ "attributes": attributes, "indices": indices, "material": 0 }] })
}
