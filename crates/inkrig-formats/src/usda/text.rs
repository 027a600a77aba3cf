//! The text itself.

use crate::ExportOptions;
use inkrig_motion::Clip;
use inkrig_motion::glam::{DMat4, DVec3, Vec3};
use std::io::Write;

/// A file that is being written.
pub(super) struct Text<'a> {
    out: Vec<u8>,
    clip: &'a Clip,
    options: &'a ExportOptions,
}

impl<'a> Text<'a> {
    pub(super) fn new(clip: &'a Clip, options: &'a ExportOptions) -> Self {
        // A rotation and a translation take about 80 characters each.
        let cells = clip.frames().saturating_mul(clip.skeleton().len());
        Self { out: Vec::with_capacity(cells.saturating_mul(90).min(1 << 28)), clip, options }
    }

    pub(super) fn header(&mut self) {
        let (rate, last) = (self.clip.frame_rate(), self.clip.frames() - 1);
        // A file that says how long a frame lasts rounds it: 30.000000003 is 30.
        let whole = rate.round();
        let rate = if (rate - whole).abs() < 1e-6 * rate { whole } else { rate };
        let up = match self.options.up {
            crate::UpAxis::Y => "Y",
            crate::UpAxis::Z => "Z",
        };
        let unit = self.options.metres_per_unit;
        self.put(format_args!(
            "#usda 1.0\n(\n    defaultPrim = \"Character\"\n    endTimeCode = {last}\n    framesPerSecond = {rate}\n    \
             metersPerUnit = {unit}\n    startTimeCode = 0\n    timeCodesPerSecond = {rate}\n    upAxis = \"{up}\"\n)\n\n\
             def SkelRoot \"Character\"\n{{\n"
        ));
    }

    pub(super) fn skeleton(&mut self, paths: &[String]) {
        let joints = self.clip.skeleton().joints();
        let rest: Vec<DVec3> = joints.iter().map(|joint| self.place(joint.offset)).collect();
        let mut world = rest.clone();
        for (index, joint) in joints.iter().enumerate() {
            let above = joint.parent.and_then(|parent| world.get(parent)).copied().unwrap_or_default();
            if let Some(place) = world.get_mut(index) {
                *place += above;
            }
        }
        self.put(format_args!(
            "    def Skeleton \"Skeleton\" (\n        prepend apiSchemas = [\"SkelBindingAPI\"]\n    )\n    {{\n"
        ));
        self.matrices("bindTransforms", &world);
        self.tokens("        uniform token[] jointNames", joints.iter().map(|joint| joint.name.as_str()));
        self.tokens("        uniform token[] joints", paths.iter().map(String::as_str));
        self.matrices("restTransforms", &rest);
        self.put(format_args!("        rel skel:animationSource = </Character/Skeleton/Animation>\n\n"));
    }

    pub(super) fn animation(&mut self, paths: &[String]) {
        self.put(format_args!("        def SkelAnimation \"Animation\"\n        {{\n"));
        self.tokens("            uniform token[] joints", paths.iter().map(String::as_str));
        self.put(format_args!("            quatf[] rotations.timeSamples = {{\n"));
        for frame in 0..self.clip.frames() {
            self.put(format_args!("                {frame}: ["));
            let up = self.options.up;
            for (index, turn) in self.clip.rotations(frame).iter().enumerate() {
                let [x, y, z, w] = up.file_from_clip_rotation(turn.as_dquat()).as_quat().to_array();
                let comma = if index > 0 { ", " } else { "" };
                self.put(format_args!("{comma}({w}, {x}, {y}, {z})"));
            }
            self.put(format_args!("],\n"));
        }
        self.put(format_args!("            }}\n            half3[] scales = ["));
        for index in 0..paths.len() {
            self.put(format_args!("{}(1, 1, 1)", if index > 0 { ", " } else { "" }));
        }
        self.put(format_args!("]\n"));
        let mut places = vec![Vec3::ZERO; paths.len()];
        if self.clip.translations().is_empty() {
            self.put(format_args!("            float3[] translations = "));
            self.clip.local_translations(0, &mut places);
            self.places(&places);
            self.put(format_args!("\n"));
        } else {
            self.put(format_args!("            float3[] translations.timeSamples = {{\n"));
            for frame in 0..self.clip.frames() {
                self.put(format_args!("                {frame}: "));
                self.clip.local_translations(frame, &mut places);
                self.places(&places);
                self.put(format_args!(",\n"));
            }
            self.put(format_args!("            }}\n"));
        }
        self.put(format_args!("        }}\n    }}\n}}\n"));
    }

    pub(super) fn finish(self) -> Vec<u8> {
        self.out
    }

    /// A vector of the clip in the file's units and axes.
    fn place(&self, v: Vec3) -> DVec3 {
        self.options.up.file_from_clip(v.as_dvec3()) / self.options.metres_per_unit
    }

    fn places(&mut self, places: &[Vec3]) {
        self.put(format_args!("["));
        for (index, place) in places.iter().enumerate() {
            let Vec3 { x, y, z } = self.place(*place).as_vec3();
            self.put(format_args!("{}({x}, {y}, {z})", if index > 0 { ", " } else { "" }));
        }
        self.put(format_args!("]"));
    }

    /// Pure translations: rows are vectors here, so the place stands in the last one.
    fn matrices(&mut self, name: &str, places: &[DVec3]) {
        self.put(format_args!("        uniform matrix4d[] {name} = ["));
        for (index, place) in places.iter().enumerate() {
            let rows = DMat4::from_translation(*place).to_cols_array_2d();
            self.put(format_args!("{}(", if index > 0 { ", " } else { "" }));
            for (number, [a, b, c, d]) in rows.into_iter().enumerate() {
                self.put(format_args!("{}({a}, {b}, {c}, {d})", if number > 0 { ", " } else { "" }));
            }
            self.put(format_args!(")"));
        }
        self.put(format_args!("]\n"));
    }

    fn tokens<'t>(&mut self, declaration: &str, tokens: impl Iterator<Item = &'t str>) {
        self.put(format_args!("{declaration} = ["));
        for (index, token) in tokens.enumerate() {
            let comma = if index > 0 { ", " } else { "" };
            self.put(format_args!("{comma}\"{}\"", escaped(token)));
        }
        self.put(format_args!("]\n"));
    }

    fn put(&mut self, text: std::fmt::Arguments<'_>) {
        // Writing to memory does not fail.
        let _ = self.out.write_fmt(text);
    }
}

/// Text between quotes: quotes and backslashes escaped, line ends and other control characters as numbers.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            c if c.is_control() => out.push_str(&format!("\\x{:02x}", (c as u32).min(0xff))),
            c => out.push(c),
        }
    }
    out
}
