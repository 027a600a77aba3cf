//! Letters as numbers.

/// Nothing, 26 letters, and the space between words.
pub const ALPHABET: usize = 28;
const SPACE: usize = 27;

/// The letters of a text, 1 to 26, 27 for a space or a hyphen; large and small alike. What is none is left out.
pub fn letters(text: &str) -> Vec<usize> {
    text.bytes()
        .filter_map(|byte| match byte.to_ascii_lowercase() {
            letter @ b'a'..=b'z' => Some(usize::from(letter - b'a') + 1),
            b' ' | b'-' => Some(SPACE),
            _ => None,
        })
        .collect()
}

/// The text of letters.
pub fn text(letters: &[usize]) -> String {
    letters
        .iter()
        .filter_map(|&letter| match letter {
            1..=26 => u8::try_from(letter).ok().map(|letter| char::from(b'a' + letter - 1)),
            SPACE => Some(' '),
            _ => None,
        })
        .collect()
}
