//! A joint's name as words: without what programs put around them.

use super::Side;

/// A name taken apart.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Words {
    /// The words that are left, in lower case, joined; digits are in `number`.
    pub(super) text: String,
    /// The side that the name says.
    pub(super) side: Option<Side>,
    /// The last number in it.
    pub(super) number: Option<u32>,
    /// Said by the name to be a helper: a twist or roll bone, a target, an end.
    pub(super) helper: bool,
    /// The helper is one that shares a limb's twist; its words without that are in `text`.
    pub(super) twist: bool,
    /// The helper is the tip of a chain.
    pub(super) tip: bool,
}

/// What stands before the names of all joints in some programs' skeletons, a number behind it or not.
const PREFIXES: [&str; 14] = [
    "mixamorig",
    "bip",
    "valvebiped",
    "character",
    "quickrigcharacter",
    "ccbase",
    "def",
    "org",
    "jbip",
    "mavg",
    "favg",
    "smpl",
    "human",
    "skeleton",
];

/// Words that say nothing: what a joint is in a program, or that it is in the middle.
const NOISE: [&str; 14] = [
    "jnt", "joint", "bone", "bn", "bind", "skin", "skel", "rig", "armature", "c", "m", "mid", "center",
    "centre",
];

/// Words that make a joint a helper of another.
const HELPERS: [&str; 13] = [
    "target",
    "pole",
    "ik",
    "mch",
    "effector",
    "slot",
    "ctrl",
    "control",
    "helper",
    "dummy",
    "socket",
    "corrective",
    "tweak",
];

/// Words of a joint that only ends a chain.
const TIPS: [&str; 5] = ["end", "nub", "tip", "leaf", "site"];

/// Words of a joint that shares the twist of a limb.
const TWISTS: [&str; 3] = ["twist", "roll", "twistcor"];

/// The words of a name in lower case. `Bip01 L UpperArm` is bip, 01, l, upper, arm.
pub(super) fn tokens(name: &str) -> Vec<String> {
    split(name.rsplit([':', '|', '/']).next().unwrap_or(name))
}

/// The words that nearly all names of a skeleton begin with: a prefix of nobody's convention.
pub(super) fn shared_prefix(names: &[Vec<String>]) -> usize {
    let mut count = 0;
    // Few joints may begin alike for another reason.
    if names.len() < 8 {
        return 0;
    }
    loop {
        let word = |name: &'_ Vec<String>| name.get(count).cloned();
        let Some(first) = names.iter().find_map(word) else { return count };
        let alike = names.iter().filter(|name| name.len() > count + 1 && name[count] == first).count();
        if 5 * alike < 4 * names.len() {
            return count;
        }
        count += 1;
    }
}

/// Takes a name's tokens apart. `Bip01 L UpperArm` is upperarm, left; `mixamorig:LeftForeArm` forearm, left; `spine_03`
/// spine, 3.
pub(super) fn words(mut tokens: Vec<String>) -> Words {
    drop_prefixes(&mut tokens);
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
    let has = |list: &[&str]| tokens.iter().any(|token| list.contains(&token.as_str()));
    let (twist, tip) = (has(&TWISTS), has(&TIPS));
    let helper = twist || tip || has(&HELPERS);
    // The hip joint of CMU's skeletons stands above the thigh.
    let keep = tokens.concat() == "hipjoint";
    tokens.retain(|token| keep || !(NOISE.contains(&token.as_str()) || TWISTS.contains(&token.as_str())));
    Words { text: tokens.concat(), side, number, helper, twist, tip }
}

/// Words by anything that is no letter or digit, by upper case after lower case, and by digits.
pub(super) fn split(name: &str) -> Vec<String> {
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
    tokens.into_iter().flat_map(side_apart).collect()
}

/// `leftarm` and `armleft` are two words.
fn side_apart(token: String) -> Vec<String> {
    for side in ["left", "right"] {
        if token.len() == side.len() {
            continue;
        }
        if let Some(rest) = token.strip_prefix(side) {
            return vec![side.to_string(), rest.to_string()];
        }
        if let Some(rest) = token.strip_suffix(side) {
            return vec![rest.to_string(), side.to_string()];
        }
    }
    vec![token]
}

/// Leaves out programs' prefixes with the numbers behind them, unless nothing else is there.
fn drop_prefixes(tokens: &mut Vec<String>) {
    let is_number = |token: &String| token.parse::<u32>().is_ok();
    'more: loop {
        for count in (1..=3.min(tokens.len().saturating_sub(1))).rev() {
            let joined = tokens.get(..count).map(<[String]>::concat).unwrap_or_default();
            if PREFIXES.contains(&joined.as_str()) {
                tokens.drain(..count);
                while tokens.len() > 1 && tokens.first().is_some_and(is_number) {
                    tokens.remove(0);
                }
                continue 'more;
            }
        }
        return;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(name: &str) -> (String, Option<Side>, Option<u32>) {
        let words = words(tokens(name));
        (words.text, words.side, words.number)
    }

    #[test]
    fn names_of_many_programs_are_taken_apart() {
        let (left, right) = (Some(Side::Left), Some(Side::Right));
        let cases = [
            ("mixamorig:LeftForeArm", "forearm", left, None),
            ("mixamorig12:LeftForeArm", "forearm", left, None),
            ("Bip01 L UpperArm", "upperarm", left, None),
            ("Bip001 R Toe0", "toe", right, Some(0)),
            ("spine_03", "spine", None, Some(3)),
            ("upperarm_l", "upperarm", left, None),
            ("DEF-upper_arm.R", "upperarm", right, None),
            ("lShldr", "shldr", left, None),
            ("RHipJoint", "hipjoint", right, None),
            ("J_Bip_L_LowerLeg", "lowerleg", left, None),
            ("J_Bip_C_Hips", "hips", None, None),
            ("ValveBiped.Bip01_R_Thigh", "thigh", right, None),
            ("Character1_LeftUpLegRoll", "upleg", left, None),
            ("Hips", "hips", None, None),
            ("right_knee", "knee", right, None),
            ("Neck1", "neck", None, Some(1)),
            ("rig|arm.L.001", "arm", left, Some(1)),
            ("lfemur", "lfemur", None, None),
            ("l_elbow_jnt", "elbow", left, None),
            ("leftshoulder", "shoulder", left, None),
        ];
        for (name, text, side, number) in cases {
            assert_eq!(read(name), (text.to_string(), side, number), "{name}");
        }
        let of = |name: &str| words(tokens(name));
        assert!(of("upperarm_twist_01_l").twist && of("Bip001 LUpArmTwist").twist);
        assert!(of("head_end").tip && !of("LeftHand").helper && of("MCH-spine").helper);
    }

    #[test]
    fn what_all_names_begin_with_is_no_part_of_them() {
        let names = ["Hips", "Spine", "Chest", "Neck", "Head", "LeftArm", "RightArm", "LeftLeg", "RightLeg"];
        let with = |prefix: &str| names.map(|name| tokens(&format!("{prefix}{name}"))).to_vec();
        assert_eq!(shared_prefix(&with("")), 0);
        assert_eq!(shared_prefix(&with("Ninja_")), 1);
        assert_eq!(shared_prefix(&with("old_Ninja_")), 2);
    }
}
