use super::*;
use inkrig_generate::schedule::Noise;

/// A font of bars: every letter is a line as high as its place in the alphabet says.
fn bars() -> String {
    let glyph = |letter: char| {
        let high = 300 + 10 * (u32::from(letter) % 32);
        format!("<glyph unicode='{letter}' horiz-adv-x='200' d='M 50 0 L 50 {high} L 120 {high}'/>")
    };
    let glyphs: String = ('a'..='z').chain('A'..='Z').map(glyph).collect();
    format!(
        "<svg xmlns='http://www.w3.org/2000/svg'><font><glyph unicode=' ' horiz-adv-x='150'/>{glyphs}</font></svg>"
    )
}

#[test]
fn fonts_are_read_and_words_written_by_their_seed() {
    let folder = tempfile::tempdir().unwrap();
    let error = read_fonts(folder.path()).unwrap_err().to_string();
    assert!(error.contains("no font of Latin letters"), "{error}");
    std::fs::write(folder.path().join("bars.svg"), bars()).unwrap();
    std::fs::write(folder.path().join("broken.ttf"), b"no font").unwrap();
    std::fs::write(folder.path().join("drawing.svg"), "<svg xmlns='http://www.w3.org/2000/svg'/>").unwrap();
    let fonts = read_fonts(folder.path()).unwrap();
    assert_eq!(fonts.len(), 1);
    assert!(fonts[0].single_line && fonts[0].name == "bars");
    for (seed, case) in [Case::Small, Case::First, Case::Large].into_iter().enumerate() {
        let ink = |seed: usize| write_word("sit down", case, &fonts[0], &mut Noise::new(seed as u64));
        assert_eq!(ink(seed), ink(seed));
        assert_ne!(ink(seed), ink(seed + 10));
        let dark = ink(seed).pixels.iter().filter(|pixel| **pixel > 0.5).count();
        assert!((100..4000).contains(&dark), "{dark}");
    }
}
