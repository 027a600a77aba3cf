//! Accessors and the bytes behind them, put one after the other.

use inkrig_motion::glam::{Quat, Vec3};
use serde_json::{Value, json};

/// What will be added to a document. Indices go on from those that are there.
#[derive(Debug, Default)]
pub(super) struct Parts {
    pub(super) bin: Vec<u8>,
    pub(super) views: Vec<Value>,
    pub(super) accessors: Vec<Value>,
    /// Accessors, views and bytes that the document has already, and the buffer that these bytes belong to.
    pub(super) first_accessor: usize,
    pub(super) first_view: usize,
    pub(super) first_byte: usize,
    pub(super) buffer: usize,
}

/// What vertex data is for, as glTF numbers it.
#[derive(Debug, Clone, Copy)]
pub(super) enum Target {
    Vertices = 34962,
    Indices = 34963,
}

impl Parts {
    /// Seconds, with the smallest and largest, which samplers must have.
    pub(super) fn times(&mut self, times: &[f32]) -> usize {
        let view = self.view(times.iter().flat_map(|time| time.to_le_bytes()), None);
        let low = times.iter().copied().fold(f32::MAX, f32::min);
        let high = times.iter().copied().fold(f32::MIN, f32::max);
        self.accessor(json!({
            "bufferView": view, "componentType": 5126, "count": times.len(), "type": "SCALAR",
            "min": [low], "max": [high],
        }))
    }

    pub(super) fn rotations(&mut self, values: &[Quat]) -> usize {
        let view = self.view(floats(values.iter().flat_map(Quat::to_array)), None);
        self.accessor(
            json!({ "bufferView": view, "componentType": 5126, "count": values.len(), "type": "VEC4" }),
        )
    }

    pub(super) fn vectors(&mut self, values: &[Vec3], target: Option<Target>) -> usize {
        let view = self.view(floats(values.iter().flat_map(Vec3::to_array)), target);
        self.accessor(
            json!({ "bufferView": view, "componentType": 5126, "count": values.len(), "type": "VEC3" }),
        )
    }

    /// Places of vertices, with their box.
    pub(super) fn places(&mut self, values: &[Vec3]) -> usize {
        let index = self.vectors(values, Some(Target::Vertices));
        let low = values.iter().copied().fold(Vec3::MAX, Vec3::min).to_array();
        let high = values.iter().copied().fold(Vec3::MIN, Vec3::max).to_array();
        if let Some(Value::Object(accessor)) = self.accessors.last_mut() {
            accessor.insert("min".into(), json!(low));
            accessor.insert("max".into(), json!(high));
        }
        index
    }

    /// Any other accessor of whole bytes.
    pub(super) fn other(
        &mut self,
        bytes: impl Iterator<Item = u8>,
        mut accessor: Value,
        target: Option<Target>,
    ) -> usize {
        let view = self.view(bytes, target);
        if let Value::Object(accessor) = &mut accessor {
            accessor.insert("bufferView".into(), json!(view));
        }
        self.accessor(accessor)
    }

    fn accessor(&mut self, accessor: Value) -> usize {
        self.accessors.push(accessor);
        self.first_accessor + self.accessors.len() - 1
    }

    fn view(&mut self, bytes: impl Iterator<Item = u8>, target: Option<Target>) -> usize {
        let start = self.bin.len();
        self.bin.extend(bytes);
        let length = self.bin.len() - start;
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        let mut view =
            json!({ "buffer": self.buffer, "byteOffset": self.first_byte + start, "byteLength": length });
        if let (Some(target), Value::Object(view)) = (target, &mut view) {
            view.insert("target".into(), json!(target as u32));
        }
        self.views.push(view);
        self.first_view + self.views.len() - 1
    }
}

fn floats(values: impl Iterator<Item = f32>) -> impl Iterator<Item = u8> {
    values.flat_map(f32::to_le_bytes)
}
