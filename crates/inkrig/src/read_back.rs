//! A file that was written, read again and compared with what it was made of.

use inkrig_formats::{ClipChoice, ExportOptions, Format, ImportOptions, no_files, read_motion};
use inkrig_motion::{Clip, kinematics};
use serde::Serialize;
use std::collections::BTreeMap;

/// Positions are kept when they are off by no more than this share of the figure's size.
const KEPT: f64 = 1e-4;

/// How near a written file is to its motion; the names are stable.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(crate) struct ReadBack {
    /// Joints that were compared, by their names.
    pub(crate) joints: usize,
    /// Largest distance of a joint from where it should be, over all frames, millimetres.
    pub(crate) position_max_mm: f64,
    /// Whether that is no more than a ten-thousandth of the figure's size.
    pub(crate) kept: bool,
}

impl ReadBack {
    /// Reads a file again; `None` for formats that are not read, and where frames or joints cannot be told to be the same.
    pub(crate) fn of(bytes: &[u8], format: Format, clip: &Clip, options: &ExportOptions) -> Option<Self> {
        let named = matches!(format, Format::Glb | Format::Gltf | Format::Fbx);
        if !named && format != Format::Bvh {
            return None;
        }
        let import = ImportOptions {
            // A BVH does not say its unit.
            metres_per_unit: (format == Format::Bvh).then_some(options.metres_per_unit),
            up: (format == Format::Bvh).then_some(options.up),
            clip: options.name.clone().filter(|_| named).map(ClipChoice::Name),
            ..ImportOptions::default()
        };
        let mut read = read_motion(bytes, format, &import, &no_files).ok()?;
        // In a file that had a clip of that name, the new one is a later one with a number behind it.
        let name = options.name.as_deref().unwrap_or_default();
        let latest = read.clips.iter().rposition(|clip| clip.name.starts_with(name));
        if named && latest != read.clip_index {
            let clip = Some(ClipChoice::Number(latest? + 1));
            read = read_motion(bytes, format, &ImportOptions { clip, ..import }, &no_files).ok()?;
        }
        let again = read.clip;
        if again.frames() != clip.frames() {
            return None;
        }
        // Several joints may have one name: they are told apart by their order.
        let mut places: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
        for (index, joint) in again.skeleton().joints().iter().enumerate().rev() {
            places.entry(&joint.name).or_default().push(index);
        }
        let joints = clip.skeleton().joints().iter().enumerate().filter(|(_, joint)| !joint.end_site);
        let pairs: Vec<(usize, usize)> = joints
            .map(|(index, joint)| Some((index, places.get_mut(joint.name.as_str())?.pop()?)))
            .collect::<Option<_>>()?;
        let (a, b) = (kinematics::positions(clip), kinematics::positions(&again));
        let mut most = 0.0_f64;
        for frame in 0..clip.frames() {
            let (own, other) = (a.frame(frame), b.frame(frame));
            for &(joint, place) in &pairs {
                most = most.max(own[joint].as_dvec3().distance(other[place].as_dvec3()));
            }
        }
        let size = f64::from(clip.skeleton().extent()).max(0.1);
        Some(Self { joints: pairs.len(), position_max_mm: 1e3 * most, kept: most <= KEPT * size })
    }

    /// What is to be said where the file is not what it should be.
    pub(crate) fn warning(&self) -> Option<String> {
        (!self.kept).then(|| {
            format!(
                "read again, joints of the file are up to {:.1} mm from where they should be",
                self.position_max_mm
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use inkrig_formats::{read_bvh, write_motion};
    use inkrig_motion::time;

    #[test]
    fn a_file_is_compared_with_its_motion() {
        let bytes = inkrig_samples::find("person").unwrap().bytes;
        let import = read_bvh(bytes, &ImportOptions::default()).unwrap();
        let clip = time::trim(&import.clip, 0..40).unwrap();
        for format in [Format::Bvh, Format::Glb, Format::Fbx] {
            let options = ExportOptions {
                name: Some("walk".into()),
                ..ExportOptions::in_format(format, &import.source)
            };
            let written = write_motion(&clip, format, &options).unwrap().bytes;
            let found = ReadBack::of(&written, format, &clip, &options).unwrap();
            assert!(found.kept && found.warning().is_none(), "{format:?}: {found:?}");
            assert_eq!(found.joints, 22);
            let later = time::trim(&import.clip, 20..60).unwrap();
            let other = ReadBack::of(&written, format, &later, &options).unwrap();
            assert!(!other.kept && other.warning().unwrap().contains("mm from where they should be"));
        }
        let options = ExportOptions::default();
        let text = write_motion(&clip, Format::Usda, &options).unwrap().bytes;
        assert_eq!(ReadBack::of(&text, Format::Usda, &clip, &options), None);
    }
}
