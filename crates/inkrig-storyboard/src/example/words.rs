//! Whether a clip is of a word.

use inkrig_generate::text::{VERBS, actions_in};

/// Gaits and ways of going that people have no word for, with the nearest action of people.
const OF_ANIMALS: [(&str, &str); 12] = [
    ("gallop", "run"),
    ("canter", "run"),
    ("slither", "walk"),
    ("flap", "fly"),
    ("glide", "fly"),
    ("soar", "fly"),
    ("graze", "eat"),
    ("howl", "call"),
    ("bark", "call"),
    ("sleep", "lie down"),
    ("rest", "stand"),
    ("strike", "attack"),
];
/// Words that make another movement of a clip than its verb alone, and how much one counts that was not asked for.
const MANNERS: &[&str] = &[
    "back",
    "backward",
    "backwards",
    "left",
    "right",
    "sideways",
    "strafe",
    "crouch",
    "crouched",
    "injured",
    "start",
    "stop",
    "end",
];
const OTHER_MANNER: f32 = 0.15;
/// Ways of going: for one of them another is better than none.
const GOING: [&str; 9] = ["walk", "run", "jog", "march", "sneak", "step", "limp", "skip", "crawl"];

/// How far what is said of a clip is from a word: 0 is of it, 1 has nothing to do with it.
pub(super) fn distance(word: &str, said: &str) -> f32 {
    let (asked, known) = (plain(word), plain(said));
    if asked.is_empty() {
        return 0.0;
    }
    let has = |words: &[String], manner: &str| words.iter().any(|own| own == manner);
    let other = MANNERS.iter().any(|manner| has(&known, manner) && !has(&asked, manner));
    let other = if other { OTHER_MANNER } else { 0.0 };
    if asked.iter().all(|own| known.iter().any(|other| alike(own, other))) {
        return other;
    }
    let (wanted, has) = (actions(&asked), actions(&known));
    let common = wanted.iter().filter(|verb| has.contains(verb)).count();
    if common > 0 {
        return 0.1 + 0.4 * (wanted.len() - common) as f32 / wanted.len() as f32 + other;
    }
    let goes = |verbs: &[&str]| verbs.iter().any(|verb| GOING.contains(verb));
    if goes(&wanted) && goes(&has) { 0.6 } else { 1.0 }
}

/// Words in lower case, `Gallop_Jump2` being two; words that say nothing are left out.
fn plain(text: &str) -> Vec<String> {
    let mut words: Vec<String> = vec![String::new()];
    let mut before = ' ';
    for letter in text.chars() {
        if !letter.is_alphabetic() || (letter.is_uppercase() && before.is_lowercase()) {
            words.push(String::new());
        }
        if letter.is_alphabetic()
            && let Some(word) = words.last_mut()
        {
            word.extend(letter.to_lowercase());
        }
        before = letter;
    }
    words.retain(|word| word.chars().count() > 1 && !["and", "the", "then"].contains(&word.as_str()));
    words
}

/// Forms of one word: walk, walks, walking.
fn alike(a: &str, b: &str) -> bool {
    let (short, long) = if a.len() <= b.len() { (a, b) } else { (b, a) };
    short == long
        || (short.len() > 2
            && long.strip_prefix(short).is_some_and(|end| ["s", "ing", "ed", "er"].contains(&end)))
}

fn actions(words: &[String]) -> Vec<&'static str> {
    let replaced: Vec<&str> = words
        .iter()
        .map(|word| {
            OF_ANIMALS.iter().find(|(own, _)| alike(own, word)).map_or(word.as_str(), |(_, plain)| plain)
        })
        .collect();
    let verbs = actions_in(&replaced.join(" "));
    verbs.into_iter().filter_map(|at| VERBS.get(at).map(|verb| verb.name)).collect()
}

#[cfg(test)]
mod tests {
    use super::distance;

    #[test]
    fn words_synonyms_and_gaits_are_near_and_others_far() {
        for (word, said) in
            [("gallop", "Gallop"), ("walk", "wolf Walk_02"), ("", "x"), ("kicking", "SideKick kick")]
        {
            assert_eq!(distance(word, said), 0.0, "{word} {said}");
        }
        let run = distance("run", "Gallop_Jump");
        assert!((0.01..0.5).contains(&run), "{run}");
        assert!(distance("sprint", "run fast") < 0.5);
        assert!(distance("run", "walk") > distance("run", "gallop"));
        assert_eq!(distance("kick", "walk"), 1.0);
        assert!(distance("walk", "Walking_Backwards") > distance("walk", "Walking_A"));
        assert_eq!(distance("walk backwards", "Walking_Backwards"), 0.0);
        assert!(distance("walk and wave", "walk") < 0.6);
    }
}
