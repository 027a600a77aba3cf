//! glTF documents made for tests.

use serde_json::{Value, json};

/// A document and what stands in its one buffer.
#[derive(Debug, Clone)]
pub(crate) struct Doc {
    pub(crate) json: Value,
    pub(crate) bin: Vec<u8>,
}

impl Doc {
    /// A leg: hip, knee, and a bare leaf; the hip at a height of 1, everything else 0.5 further down.
    pub(crate) fn leg() -> Self {
        let json = json!({
            "asset": { "version": "2.0" },
            "scene": 0,
            "scenes": [{ "nodes": [0] }],
            "nodes": [
                { "name": "hip", "translation": [0.0, 1.0, 0.0], "children": [1] },
                { "name": "knee", "translation": [0.0, -0.5, 0.0], "children": [2] },
                { "name": "knee_end", "translation": [0.0, -0.5, 0.0] },
            ],
            "skins": [{ "joints": [0, 1] }],
            "accessors": [], "bufferViews": [], "buffers": [{ "byteLength": 0 }], "animations": [],
        });
        Self { json, bin: Vec::new() }
    }

    /// The leg with a clip `bend` of 31 frames: the hip walks along z, the knee turns about x by a quarter.
    pub(crate) fn walking_leg() -> Self {
        let mut doc = Self::leg();
        let times: Vec<f32> = (0..31).map(|frame| frame as f32 / 30.0).collect();
        let places: Vec<f32> = times.iter().flat_map(|time| [0.0, 1.0, *time]).collect();
        let turns: Vec<f32> =
            times.iter().flat_map(|time| turn_x(time * std::f32::consts::FRAC_PI_2)).collect();
        doc.animation("bend");
        doc.channel(0, "translation", "LINEAR", &times, "VEC3", &places);
        doc.channel(1, "rotation", "LINEAR", &times, "VEC4", &turns);
        doc
    }

    /// Begins a clip.
    pub(crate) fn animation(&mut self, name: &str) {
        self.list("animations").push(json!({ "name": name, "channels": [], "samplers": [] }));
    }

    /// Adds a channel to the last clip.
    pub(crate) fn channel(
        &mut self,
        node: usize,
        path: &str,
        mode: &str,
        times: &[f32],
        shape: &str,
        values: &[f32],
    ) {
        let input = self.floats("SCALAR", times);
        let output = self.floats(shape, values);
        self.channel_of(node, path, mode, input, output);
    }

    /// Adds a channel whose accessors are there.
    pub(crate) fn channel_of(&mut self, node: usize, path: &str, mode: &str, input: usize, output: usize) {
        let animation = self.list("animations").last_mut().unwrap();
        let samplers = animation["samplers"].as_array_mut().unwrap();
        samplers.push(json!({ "input": input, "output": output, "interpolation": mode }));
        let sampler = samplers.len() - 1;
        let channel = json!({ "sampler": sampler, "target": { "node": node, "path": path } });
        animation["channels"].as_array_mut().unwrap().push(channel);
    }

    /// Adds an accessor of floats.
    pub(crate) fn floats(&mut self, shape: &str, values: &[f32]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        let width =
            [("SCALAR", 1), ("VEC3", 3), ("VEC4", 4)].iter().find(|(name, _)| *name == shape).unwrap().1;
        let view = self.view(&bytes);
        let count = values.len() / width;
        self.accessor(json!({ "bufferView": view, "componentType": 5126, "count": count, "type": shape }))
    }

    /// Adds an accessor.
    pub(crate) fn accessor(&mut self, accessor: Value) -> usize {
        self.list("accessors").push(accessor);
        self.list("accessors").len() - 1
    }

    /// Adds bytes and a view of them.
    pub(crate) fn view(&mut self, bytes: &[u8]) -> usize {
        let start = self.bin.len();
        self.bin.extend_from_slice(bytes);
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        self.json["buffers"][0]["byteLength"] = json!(self.bin.len());
        let view = json!({ "buffer": 0, "byteOffset": start, "byteLength": bytes.len() });
        self.list("bufferViews").push(view);
        self.list("bufferViews").len() - 1
    }

    pub(crate) fn list(&mut self, name: &str) -> &mut Vec<Value> {
        self.json[name].as_array_mut().unwrap()
    }

    /// As a GLB.
    pub(crate) fn glb(&self) -> Vec<u8> {
        glb(self.json.to_string().as_bytes(), &self.bin)
    }

    /// As a .gltf whose buffer has this address.
    pub(crate) fn text(&self, address: &str) -> Vec<u8> {
        let mut json = self.json.clone();
        json["buffers"][0]["uri"] = json!(address);
        json.to_string().into_bytes()
    }
}

/// A GLB of any two chunks.
pub(crate) fn glb(json: &[u8], bin: &[u8]) -> Vec<u8> {
    let padded = |data: &[u8], filling: u8| {
        let mut data = data.to_vec();
        data.resize(data.len().next_multiple_of(4), filling);
        data
    };
    let (json, bin) = (padded(json, b' '), padded(bin, 0));
    let mut out = b"glTF".to_vec();
    for word in [2, (28 + json.len() + bin.len()) as u32, json.len() as u32, 0x4e4f_534a] {
        out.extend_from_slice(&word.to_le_bytes());
    }
    out.extend_from_slice(&json);
    for word in [bin.len() as u32, 0x004e_4942] {
        out.extend_from_slice(&word.to_le_bytes());
    }
    out.extend_from_slice(&bin);
    out
}

/// A rotation about x as x, y, z, w.
pub(crate) fn turn_x(angle: f32) -> [f32; 4] {
    [(0.5 * angle).sin(), 0.0, 0.0, (0.5 * angle).cos()]
}
