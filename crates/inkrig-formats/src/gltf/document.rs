//! The parts of a glTF document that a motion needs, as they stand in the JSON. All else is skipped unseen.
//!
//! Own types and not those of a glTF crate: every list is bounded while it is parsed, and no element takes much more
//! memory than its text.

use super::bounded::{Bounded, BoundedMap};
use crate::{FormatError, Place, finding};
use serde::{Deserialize, de::IgnoredAny};

/// Most nodes, skins, clips and buffers.
const SOME: usize = 1 << 16;
/// Most accessors, buffer views, channels, joints: a library of clips has many.
const MANY: usize = 1 << 22;

/// The whole document.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Document {
    #[serde(default)]
    pub(super) nodes: Bounded<Node, SOME>,
    #[serde(default)]
    pub(super) skins: Bounded<Skin, SOME>,
    #[serde(default)]
    pub(super) animations: Bounded<Animation, SOME>,
    #[serde(default)]
    pub(super) accessors: Bounded<Accessor, MANY>,
    #[serde(default)]
    pub(super) buffer_views: Bounded<BufferView, MANY>,
    #[serde(default)]
    pub(super) buffers: Bounded<Buffer, SOME>,
    #[serde(default)]
    pub(super) extensions: Extensions,
}

#[derive(Debug, Deserialize)]
pub(super) struct Node {
    #[serde(default)]
    pub(super) name: String,
    #[serde(default)]
    pub(super) children: Bounded<u32, SOME>,
    pub(super) matrix: Option<Box<[f64; 16]>>,
    pub(super) translation: Option<[f64; 3]>,
    pub(super) rotation: Option<[f64; 4]>,
    pub(super) scale: Option<[f64; 3]>,
    mesh: Option<IgnoredAny>,
    camera: Option<IgnoredAny>,
    extensions: Option<IgnoredAny>,
}

impl Node {
    /// Nothing but a place: no children, mesh, camera or light.
    pub(super) fn is_bare(&self) -> bool {
        self.children.0.is_empty()
            && self.mesh.is_none()
            && self.camera.is_none()
            && self.extensions.is_none()
    }

    pub(super) fn has_mesh(&self) -> bool {
        self.mesh.is_some()
    }
}

#[derive(Debug, Deserialize)]
pub(super) struct Skin {
    pub(super) joints: Bounded<u32, MANY>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Animation {
    #[serde(default)]
    pub(super) name: String,
    #[serde(default)]
    pub(super) channels: Bounded<Channel, MANY>,
    #[serde(default)]
    pub(super) samplers: Bounded<Sampler, MANY>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Channel {
    pub(super) sampler: u32,
    pub(super) target: Target,
}

#[derive(Debug, Deserialize)]
pub(super) struct Target {
    pub(super) node: Option<u32>,
    pub(super) path: Path,
}

/// What of a node a channel moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) enum Path {
    Translation,
    Rotation,
    Scale,
    /// Weights of a face, or what an extension knows.
    #[serde(other)]
    Other,
}

#[derive(Debug, Deserialize)]
pub(super) struct Sampler {
    pub(super) input: u32,
    pub(super) output: u32,
    #[serde(default)]
    pub(super) interpolation: Interpolation,
}

/// How values between keys are found.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "UPPERCASE")]
pub(super) enum Interpolation {
    #[default]
    Linear,
    Step,
    CubicSpline,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Accessor {
    pub(super) buffer_view: Option<u32>,
    #[serde(default)]
    pub(super) byte_offset: usize,
    pub(super) component_type: u32,
    pub(super) count: usize,
    #[serde(rename = "type")]
    pub(super) shape: Shape,
    #[serde(default)]
    pub(super) normalized: bool,
    pub(super) sparse: Option<Box<Sparse>>,
}

/// How many numbers an element has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "UPPERCASE")]
pub(super) enum Shape {
    Scalar,
    Vec3,
    Vec4,
    /// No motion uses them.
    #[serde(other)]
    Other,
}

#[derive(Debug, Deserialize)]
pub(super) struct Sparse {
    pub(super) count: usize,
    pub(super) indices: SparseIndices,
    pub(super) values: SparseValues,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparseIndices {
    pub(super) buffer_view: u32,
    #[serde(default)]
    pub(super) byte_offset: usize,
    pub(super) component_type: u32,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparseValues {
    pub(super) buffer_view: u32,
    #[serde(default)]
    pub(super) byte_offset: usize,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct BufferView {
    pub(super) buffer: u32,
    #[serde(default)]
    pub(super) byte_offset: usize,
    pub(super) byte_length: usize,
    pub(super) byte_stride: Option<usize>,
    #[serde(default)]
    extensions: BufferViewExtensions,
}

impl BufferView {
    /// Whether its bytes are only there after unpacking.
    pub(super) fn is_packed(&self) -> bool {
        self.extensions.meshopt.is_some()
    }
}

#[derive(Debug, Default, Deserialize)]
struct BufferViewExtensions {
    #[serde(rename = "EXT_meshopt_compression", alias = "KHR_meshopt_compression")]
    meshopt: Option<IgnoredAny>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Buffer {
    pub(super) byte_length: usize,
    pub(super) uri: Option<String>,
}

#[derive(Debug, Default, Deserialize)]
pub(super) struct Extensions {
    /// VRM 0.x
    #[serde(rename = "VRM")]
    pub(super) vrm0: Option<Vrm0>,
    /// VRM 1.0
    #[serde(rename = "VRMC_vrm")]
    pub(super) vrm1: Option<Vrm1>,
    #[serde(rename = "VRMC_vrm_animation")]
    pub(super) vrm_animation: Option<Vrm1>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Vrm0 {
    pub(super) humanoid: Option<Vrm0Humanoid>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Vrm0Humanoid {
    #[serde(default)]
    pub(super) human_bones: Bounded<Vrm0Bone, 256>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Vrm0Bone {
    pub(super) bone: String,
    /// -1 where there is none.
    pub(super) node: i64,
}

#[derive(Debug, Deserialize)]
pub(super) struct Vrm1 {
    pub(super) humanoid: Option<Vrm1Humanoid>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Vrm1Humanoid {
    pub(super) human_bones: Option<BoundedMap<Vrm1Bone, 256>>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Vrm1Bone {
    pub(super) node: Option<u32>,
}

/// Parses the JSON.
pub(super) fn parse(json: &[u8]) -> Result<Document, FormatError> {
    serde_json::from_slice(json).map_err(|error| {
        let message = error.to_string();
        let what = message.rsplit_once(" at line ").map_or(message.as_str(), |(what, _)| what);
        FormatError::Read {
            code: "gltf-json",
            place: Place { line: error.line(), column: error.column(), joint: None },
            what: format!("in the JSON: {}", finding::clean(what, 160)),
            hint: "the file is damaged or not glTF 2.0; export it again".into(),
        }
    })
}
