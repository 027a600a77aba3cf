//! From a description to the actions in it.

use super::VERBS;

/// The longest phrase of the list, words.
const LONGEST: usize = 3;

/// The actions of a description, as places in [`VERBS`], in the order in which they are named, each once. Of several
/// readings the longest counts: "sit ups" are no sitting down.
pub fn actions_in(text: &str) -> Vec<usize> {
    let words = words(text);
    let mut found = Vec::new();
    let mut at = 0;
    while at < words.len() {
        let longest = (1..=LONGEST.min(words.len() - at)).rev();
        let read = longest.filter_map(|count| Some((phrase(&words[at..at + count])?, count))).next();
        let (verb, count) = read.map_or((None, 1), |(verb, count)| (Some(verb), count));
        if let Some(verb) = verb.filter(|verb| !found.contains(verb)) {
            found.push(verb);
        }
        at += count;
    }
    found
}

/// The verbs whose names or words are spelled most like a word, best first: what to offer for one that is not known.
pub fn nearest_verbs(word: &str, count: usize) -> Vec<&'static str> {
    // Longer ones are not words, and the distance takes their length squared.
    let word: String = word.to_lowercase().chars().take(40).collect();
    let distance = |name: &str| {
        let steps = edits(&word, name) as f64;
        steps / word.chars().count().max(name.chars().count()).max(1) as f64
    };
    let mut all: Vec<(f64, &str)> = VERBS
        .iter()
        .map(|verb| {
            let spelled = std::iter::once(verb.name).chain(verb.words.iter().copied());
            (spelled.map(distance).fold(f64::INFINITY, f64::min), verb.name)
        })
        .collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    all.into_iter().take(count).map(|(_, name)| name).collect()
}

/// The description of the mirrored motion: left and right change places, in `WalkLeft` too.
pub fn mirrored(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let (mut word, mut before) = (String::new(), ' ');
    for letter in text.chars() {
        if !letter.is_alphabetic() || (letter.is_uppercase() && before.is_lowercase()) {
            push_mirrored(&mut out, &word);
            word.clear();
        }
        if letter.is_alphabetic() {
            word.push(letter);
        } else {
            out.push(letter);
        }
        before = letter;
    }
    push_mirrored(&mut out, &word);
    out
}

fn push_mirrored(out: &mut String, word: &str) {
    let lower = word.to_lowercase();
    let sides = [("left", "right"), ("right", "left")];
    // Lower case may have another length than the word itself; these two have not.
    let side =
        sides.into_iter().find(|(from, _)| lower.starts_with(from) && word.is_char_boundary(from.len()));
    let Some((from, to)) = side else {
        out.push_str(word);
        return;
    };
    let (own, rest) = word.split_at(from.len());
    for (place, letter) in to.chars().enumerate() {
        let capital = own.chars().nth(place.min(own.len() - 1)).is_some_and(char::is_uppercase);
        out.push(if capital { letter.to_ascii_uppercase() } else { letter });
    }
    out.push_str(rest);
}

/// Words in lower case; `WalkToSit_02` is four.
fn words(text: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut before = ' ';
    for letter in text.chars() {
        let begins = letter.is_uppercase() && before.is_lowercase();
        if (begins || !letter.is_alphabetic()) && words.last().is_some_and(|word| !word.is_empty()) {
            words.push(String::new());
        }
        if letter.is_alphabetic()
            && let Some(word) = words.last_mut()
        {
            word.extend(letter.to_lowercase());
        }
        before = letter;
    }
    words.retain(|word| !word.is_empty());
    words
}

/// The action that some words in a row are.
fn phrase(words: &[String]) -> Option<usize> {
    let is = |listed: &str| {
        listed.split(' ').count() == words.len()
            && listed.split(' ').zip(words).all(|(plain, word)| is_form(word, plain))
    };
    VERBS.iter().position(|verb| is(verb.name) || verb.words.iter().any(|word| is(word)))
}

/// Whether a word is a form of a plain one: kick, kicks, kicked, kicking; carries; running; dancing; lying.
fn is_form(word: &str, plain: &str) -> bool {
    if word == plain {
        return true;
    }
    let with = |stem: &str, endings: &[&str]| {
        word.strip_prefix(stem).is_some_and(|ending| endings.contains(&ending))
    };
    let last = plain.chars().next_back().unwrap_or_default();
    let short = plain.get(..plain.len() - last.len_utf8()).unwrap_or_default();
    let doubled = || format!("{plain}{last}");
    with(plain, &["s", "es", "ed", "ing", "er", "ers"])
        || (last == 'e' && with(short, &["ing", "ed"]))
        || (last == 'y' && with(short, &["ies", "ied"]))
        || (!"aeiouywx".contains(last) && with(&doubled(), &["ing", "ed", "er"]))
        || IRREGULAR.iter().any(|&(form, of)| form == word && of == plain)
}

/// Forms that no rule makes.
const IRREGULAR: &[(&str, &str)] = &[
    ("ran", "run"),
    ("threw", "throw"),
    ("thrown", "throw"),
    ("caught", "catch"),
    ("sat", "sit"),
    ("stood", "stand"),
    ("lying", "lie"),
    ("lay", "lie"),
    ("bent", "bend"),
    ("spun", "spin"),
    ("swung", "swing"),
    ("held", "hold"),
    ("drank", "drink"),
    ("ate", "eat"),
    ("fell", "fall"),
    ("went", "go"),
    ("got", "get"),
    ("hung", "hang"),
    ("leapt", "leap"),
    ("knelt", "kneel"),
    ("struck", "strike"),
    ("swept", "sweep"),
    ("spoke", "speak"),
    ("told", "tell"),
    ("strode", "stride"),
    ("flung", "fling"),
    ("swam", "swim"),
    ("dove", "dive"),
    ("bit", "bite"),
    ("dancer", "dance"),
    ("dancers", "dance"),
    ("rose", "rise"),
    ("shot", "shoot"),
    ("dying", "die"),
    ("crept", "creep"),
];

/// Letters to put in, take out or replace to make one word of the other (Levenshtein).
fn edits(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, own) in a.chars().enumerate() {
        let mut diagonal = row.first().copied().unwrap_or(0);
        if let Some(first) = row.first_mut() {
            *first = i + 1;
        }
        for (j, other) in b.iter().enumerate() {
            let (left, above) = (row[j], row[j + 1]);
            row[j + 1] = (diagonal + usize::from(own != *other)).min(left + 1).min(above + 1);
            diagonal = above;
        }
    }
    row.last().copied().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(text: &str) -> Vec<&'static str> {
        actions_in(text).into_iter().map(|index| VERBS[index].name).collect()
    }

    #[test]
    fn forms_phrases_and_names_of_files_are_understood() {
        assert_eq!(names("a person kicks."), ["kick"]);
        assert_eq!(names("walk, veer left; walking; WALKED"), ["walk", "turn"]);
        assert_eq!(names("RunToSitDown_02"), ["run", "sit down"]);
        assert_eq!(names("Rig_Medium|Sit_Ups"), ["exercise"], "the longest reading counts");
        assert_eq!(names("jumping jacks"), ["jump"]);
        assert_eq!(
            names("swimming, dancing, carries, lying down, getting up"),
            ["dive", "dance", "carry", "lie down", "stand up"]
        );
        assert_eq!(names("cart wheel"), ["cartwheel"]);
        assert_eq!(
            names("picks up a box, jumps in place, take 001"),
            ["pick up", "jump"],
            "things are no actions"
        );
        assert_eq!(names("knelt, leapt and swam"), ["crouch", "jump", "dive"]);
        assert_eq!(names("subject cal 2 \u{0}\u{fffd} ßtraße"), [""; 0]);
        assert_eq!(names(""), [""; 0]);
    }

    #[test]
    fn no_word_stands_for_two_actions() {
        let mut all: Vec<&str> =
            VERBS.iter().flat_map(|verb| verb.words.iter().copied().chain([verb.name])).collect();
        all.sort_unstable();
        assert!(all.windows(2).all(|pair| pair[0] != pair[1]), "{all:?}");
        for (place, verb) in VERBS.iter().enumerate() {
            for word in verb.words.iter().chain([&verb.name]) {
                assert_eq!(actions_in(word), [place], "{word}");
                assert!(word.split(' ').count() <= LONGEST);
            }
        }
    }

    #[test]
    fn a_word_that_is_not_known_gets_its_nearest() {
        assert_eq!(nearest_verbs("kik", 2)[0], "kick");
        assert_eq!(nearest_verbs("cartweel", 1), ["cartwheel"]);
        assert_eq!(nearest_verbs("sprnt", 1), ["run"]);
        assert_eq!(nearest_verbs("", 3).len(), 3);
        assert_eq!(nearest_verbs(&"x".repeat(1_000_000), 1).len(), 1);
    }

    #[test]
    fn left_and_right_change_places() {
        assert_eq!(mirrored("Left hook, right_jab"), "Right hook, left_jab");
        assert_eq!(mirrored("kick leftwards"), "kick rightwards");
        assert_eq!(mirrored(&mirrored("walk turn Left90")), "walk turn Left90");
        assert_eq!(mirrored("bright"), "bright");
        assert_eq!(mirrored("WalkLeft"), "WalkRight");
        assert_eq!(mirrored("KICK RIGHT"), "KICK LEFT");
        assert_eq!(mirrored("\u{212a}left \u{130}right lefts"), "\u{212a}left \u{130}right rights");
    }
}
