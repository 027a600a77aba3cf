//! A joint's name as words: without what programs put around them.

use super::Side;

/// A name taken apart.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Words {
    /// The words that are left, in lower case, joined; digits at the end are in `number`.
    pub(super) text: String,
    /// The side that the name says.
    pub(super) side: Option<Side>,
    /// The number at its end, where there is one.
    pub(super) number: Option<u32>,
    /// Said by the name to be a helper: a twist or roll bone, a target, an end.
    pub(super) helper: bool,
}

/// What stands before the name of every joint in some programs' skeletons.
const PREFIXES: [&str; 14] = [
    "mixamorig",
    "bip001",
    "bip01",
    "bip1",
    "bip",
    "valvebiped",
    "character1",
    "cc_base",
    "def",
    "org",
    "mch",
    "joint",
    "j_bip",
    "skeleton",
];

/// Words that make a joint a helper of another.
const HELPERS: [&str; 16] = [
    "twist", "roll", "target", "pole", "ik", "end", "nub", "tip", "leaf", "effector", "site", "slot", "ctrl",
    "helper", "dummy", "socket",
];

/// Takes a name apart. `Bip01 L UpperArm` is upperarm, left; `mixamorig:LeftForeArm` forearm, left; `spine_03` spine, 3.
pub(super) fn words(name: &str) -> Words {
    let plain = name.rsplit([':', '|', '/']).next().unwrap_or(name);
    let mut tokens = split(plain);
    drop_prefix(&mut tokens);
    let mut side = None;
    // A side is a word of its own; where it is the only word, it is none.
    if tokens.len() > 1 {
        tokens.retain(|token| match Side::of_word(token) {
            Some(own) if side.is_none() => {
                side = Some(own);
                false
            }
            _ => true,
        });
    }
    let number = tokens.iter().rev().find_map(|token| token.parse().ok());
    tokens.retain(|token| token.parse::<u32>().is_err());
    let helper = tokens.iter().any(|token| HELPERS.contains(&token.as_str()));
    Words { text: tokens.concat(), side, number, helper }
}

/// Words by anything that is no letter or digit, by upper case after lower case, and by digits.
fn split(name: &str) -> Vec<String> {
    let mut tokens: Vec<String> = Vec::new();
    let (mut open, mut before) = (false, ' ');
    let letters: Vec<char> = name.chars().take(256).collect();
    for (index, &c) in letters.iter().enumerate() {
        if !c.is_alphanumeric() {
            open = false;
        } else {
            let next_is_lower = letters.get(index + 1).is_some_and(|next| next.is_lowercase());
            // `LFoot` is L Foot, but `IKLeg` is IK Leg.
            let begins = (c.is_uppercase()
                && (before.is_lowercase() || (before.is_uppercase() && next_is_lower)))
                || (c.is_ascii_digit() != before.is_ascii_digit());
            if !open || begins {
                tokens.push(String::new());
            }
            open = true;
            if let Some(token) = tokens.last_mut() {
                token.extend(c.to_lowercase());
            }
        }
        before = c;
    }
    tokens
}

/// Leaves out a program's prefix, unless nothing else is there.
fn drop_prefix(tokens: &mut Vec<String>) {
    for count in (1..=3.min(tokens.len().saturating_sub(1))).rev() {
        let joined = tokens.get(..count).map(<[String]>::concat).unwrap_or_default();
        if PREFIXES.iter().any(|prefix| prefix.replace('_', "") == joined) {
            tokens.drain(..count);
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(name: &str) -> (String, Option<Side>, Option<u32>) {
        let words = words(name);
        (words.text, words.side, words.number)
    }

    #[test]
    fn names_of_many_programs_are_taken_apart() {
        let (left, right) = (Some(Side::Left), Some(Side::Right));
        let cases = [
            ("mixamorig:LeftForeArm", "forearm", left, None),
            ("Bip01 L UpperArm", "upperarm", left, None),
            ("Bip001 R Toe0", "toe", right, Some(0)),
            ("spine_03", "spine", None, Some(3)),
            ("upperarm_l", "upperarm", left, None),
            ("DEF-upper_arm.R", "upperarm", right, None),
            ("lShldr", "shldr", left, None),
            ("RHipJoint", "hipjoint", right, None),
            ("J_Bip_L_LowerLeg", "lowerleg", left, None),
            ("Hips", "hips", None, None),
            ("right_knee", "knee", right, None),
            ("Neck1", "neck", None, Some(1)),
            ("rig|arm.L.001", "arm", left, Some(1)),
            ("lfemur", "lfemur", None, None),
        ];
        for (name, text, side, number) in cases {
            assert_eq!(read(name), (text.to_string(), side, number), "{name}");
        }
        assert!(words("upperarm_twist_01_l").helper && words("head_end").helper && !words("LeftHand").helper);
    }
}
