//! Joint names as USD wants them: letters, digits and underscores, in paths from the root.

use inkrig_motion::Skeleton;
use std::collections::HashSet;

/// The path of every joint, and how many names had to be changed. Siblings never share a name.
pub(super) fn joint_paths(skeleton: &Skeleton) -> (Vec<String>, usize) {
    let mut paths: Vec<String> = Vec::with_capacity(skeleton.len());
    let mut taken = HashSet::with_capacity(skeleton.len());
    let mut renamed = 0;
    for joint in skeleton.joints() {
        let above = joint.parent.and_then(|parent| paths.get(parent)).map(|path| format!("{path}/"));
        let above = above.unwrap_or_default();
        let plain = identifier(&joint.name);
        let mut path = format!("{above}{plain}");
        let mut number = 1;
        while taken.contains(&path) {
            number += 1;
            path = format!("{above}{plain}_{number}");
        }
        renamed += usize::from(path.get(above.len()..) != Some(joint.name.as_str()));
        taken.insert(path.clone());
        paths.push(path);
    }
    (paths, renamed)
}

fn identifier(name: &str) -> String {
    let clean = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    let plain: String = name.chars().map(clean).collect();
    if plain.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_') { plain } else { format!("_{plain}") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use inkrig_motion::{Joint, glam::Vec3};

    #[test]
    fn names_become_paths_of_plain_words() {
        let joint = |name: &str, parent| Joint::new(name, parent, Vec3::ZERO);
        let skeleton = Skeleton::new(vec![
            joint("mixamorig:Hips", None),
            joint("1", Some(0)),
            joint("é", Some(0)),
            joint("_", Some(0)),
            joint("plain", Some(3)),
            joint("", None),
        ]);
        let (paths, renamed) = joint_paths(&skeleton.unwrap());
        let hips = "mixamorig_Hips";
        let expected = [
            hips.to_string(),
            format!("{hips}/_1"),
            format!("{hips}/_"),
            format!("{hips}/__2"),
            format!("{hips}/__2/plain"),
            "_".to_string(),
        ];
        assert_eq!(paths, expected);
        assert_eq!(
            renamed, 5,
            "the prefix, the digit, the letter with its accent, the doubled one, the empty one"
        );
    }
}
