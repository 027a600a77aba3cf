//! Left and right, read from the names of joints.

use crate::Skeleton;
use std::collections::HashSet;

/// Side of the body that a limb belongs to, as far as joint names tell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// The character's left.
    Left,
    /// Its right.
    Right,
    /// Neither, or not known.
    Middle,
}

/// The side of every joint. A joint without a side in its name is on that of its parent. A skeleton that names
/// only one of both sides has none: the names mean something else.
pub(super) fn sides(skeleton: &Skeleton) -> Vec<Side> {
    let names: HashSet<String> =
        skeleton.joints().iter().map(|joint| joint.name.to_ascii_lowercase()).collect();
    let mut sides: Vec<Side> = Vec::with_capacity(skeleton.len());
    for joint in skeleton.joints() {
        let named = named_side(&joint.name).or_else(|| prefixed_side(&joint.name, &names));
        let parent = joint.parent.map_or(Side::Middle, |parent| sides[parent]);
        sides.push(named.unwrap_or(parent));
    }
    if sides.contains(&Side::Left) && sides.contains(&Side::Right) {
        sides
    } else {
        vec![Side::Middle; skeleton.len()]
    }
}

/// `LeftArm`, `arm.l`, `Bip01 R Thigh`, `hand_right`: the side is a word of its own or the words left and right.
fn named_side(name: &str) -> Option<Side> {
    words(name).iter().find_map(|word| match word.as_str() {
        "l" | "lf" | "lft" => Some(Side::Left),
        "r" | "rt" | "rgt" => Some(Side::Right),
        word if word.starts_with("left") || word.ends_with("left") => Some(Side::Left),
        word if word.starts_with("right") || word.ends_with("right") => Some(Side::Right),
        _ => None,
    })
}

/// `lfemur`: only when there is an `rfemur` too, since `lowerback` is not on the left.
fn prefixed_side(name: &str, names: &HashSet<String>) -> Option<Side> {
    let name = name.to_ascii_lowercase();
    let partner = |other: &str, rest: &str| !rest.is_empty() && names.contains(&format!("{other}{rest}"));
    match (name.strip_prefix('l'), name.strip_prefix('r')) {
        (Some(rest), _) if partner("r", rest) => Some(Side::Left),
        (_, Some(rest)) if partner("l", rest) => Some(Side::Right),
        _ => None,
    }
}

/// Lower-case words of a joint's name: cut at signs, digits kept, and where capitals begin a word.
fn words(name: &str) -> Vec<String> {
    let letters: Vec<char> = name.chars().take(256).collect();
    let mut words = vec![String::new()];
    for (index, &letter) in letters.iter().enumerate() {
        let before = index.checked_sub(1).and_then(|i| letters.get(i)).copied().unwrap_or(' ');
        let after = letters.get(index + 1).copied().unwrap_or(' ');
        let begins = letter.is_uppercase() && (!before.is_uppercase() || after.is_lowercase());
        if begins || !letter.is_alphanumeric() {
            words.push(String::new());
        }
        if let Some(word) = words.last_mut().filter(|_| letter.is_alphanumeric()) {
            word.extend(letter.to_lowercase());
        }
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Joint;
    use glam::Vec3;

    #[test]
    fn names_tell_sides() {
        for (name, side) in [
            ("LeftUpLeg", Some(Side::Left)),
            ("mixamorig:RightArm", Some(Side::Right)),
            ("Bip01 L Thigh", Some(Side::Left)),
            ("hand.r", Some(Side::Right)),
            ("LHipJoint", Some(Side::Left)),
            ("rThumb1", Some(Side::Right)),
            ("Leftover", Some(Side::Left)),
            ("Lumbar", None),
            ("L5", None),
            ("Root", None),
            ("lowerback", None),
        ] {
            assert_eq!(named_side(name), side, "{name}");
        }
        let names = ["lfemur", "rfemur", "lowerback", "root"].map(String::from).into();
        assert_eq!(prefixed_side("lfemur", &names), Some(Side::Left));
        assert_eq!(prefixed_side("rfemur", &names), Some(Side::Right));
        assert_eq!(prefixed_side("lowerback", &names), None);
        assert_eq!(prefixed_side("root", &names), None);
    }

    #[test]
    fn one_side_alone_is_no_side() {
        let joints = vec![Joint::new("R", None, Vec3::ZERO), Joint::new("b", Some(0), Vec3::Y)];
        assert_eq!(sides(&Skeleton::new(joints).unwrap()), [Side::Middle; 2]);
    }
}
