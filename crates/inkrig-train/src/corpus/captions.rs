//! What HumanML3D says of a clip: `texts/NAME.txt`, a line a caption: `caption#tokens#start#end`.

use inkrig_generate::text::actions_in;
use std::io::Read as _;
use std::path::Path;

/// Bytes of a file of captions; those of HumanML3D have less than 2000.
const MOST_BYTES: u64 = 64 << 10;
/// Parts of one motion that have captions of their own.
const MOST_SPANS: usize = 64;

/// What is done in a motion, or in a part of it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Captioned {
    /// Seconds; `None` for the whole.
    pub span: Option<(f64, f64)>,
    pub text: String,
}

/// The captions of a motion, one for each part of it in the order of the file: of several for the same part the first that
/// names a verb of the lexicon, else the first. Nothing where there is no such file.
///
/// # Errors
/// What is wrong with the file, and where.
pub(super) fn read(path: &Path) -> Result<Option<Vec<Captioned>>, String> {
    let Ok(kind) = std::fs::metadata(path) else { return Ok(None) };
    if !kind.is_file() {
        return Err("its captions are no file".into());
    }
    let mut text = String::new();
    let file = std::fs::File::open(path).map_err(|error| format!("its captions: {error}"))?;
    file.take(MOST_BYTES + 1).read_to_string(&mut text).map_err(|error| format!("its captions: {error}"))?;
    if text.len() as u64 > MOST_BYTES {
        return Err(format!("its captions have more than {} kB", MOST_BYTES >> 10));
    }
    parse(&text).map(Some)
}

fn parse(text: &str) -> Result<Vec<Captioned>, String> {
    let mut all: Vec<Captioned> = Vec::new();
    for (index, line) in text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()) {
        let wrong = |what: String| format!("line {} of its captions: {what}", index + 1);
        let (caption, span) = caption(line).map_err(wrong)?;
        if let Some(own) = all.iter_mut().find(|own| own.span == span) {
            if actions_in(&own.text).is_empty() && !actions_in(&caption).is_empty() {
                own.text = caption;
            }
        } else if all.len() == MOST_SPANS {
            return Err(wrong(format!("more than {MOST_SPANS} parts")));
        } else {
            all.push(Captioned { span, text: caption });
        }
    }
    Ok(all)
}

#[allow(clippy::type_complexity, reason = "a caption and its span")]
fn caption(line: &str) -> Result<(String, Option<(f64, f64)>), String> {
    let mut fields = line.split('#');
    let (Some(caption), Some(_), Some(start), Some(end), None) =
        (fields.next(), fields.next(), fields.next(), fields.next(), fields.next())
    else {
        return Err("it must be caption#tokens#start#end".into());
    };
    let seconds = |text: &str| match text.trim().parse::<f64>() {
        // Lists that were joined say nothing so.
        Ok(number) if number.is_nan() => Ok(0.0),
        Ok(number) if (0.0..1e6).contains(&number) => Ok(number),
        _ => Err(format!("`{}` is no time in seconds", text.trim().chars().take(20).collect::<String>())),
    };
    let (start, end) = (seconds(start)?, seconds(end)?);
    let whole = start == 0.0 && end == 0.0;
    if !whole && end <= start {
        return Err(format!("the part from {start} to {end} seconds ends before it begins"));
    }
    Ok((caption.trim().to_string(), (!whole).then_some((start, end))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_gets_the_first_caption_that_names_a_verb() {
        let text = "someone is there#x/NOUN#0.0#0.0\na person kicks.#kick/VERB#0.0#0.0\nthen walks#walk/VERB#2.0#4.5\n\
                    \na man jumps#jump/VERB#nan#nan\n";
        let all = parse(text).unwrap();
        let seen: Vec<_> = all.iter().map(|own| (own.text.as_str(), own.span)).collect();
        assert_eq!(seen, [("a person kicks.", None), ("then walks", Some((2.0, 4.5)))]);
        for (text, said) in [
            ("just words", "line 1 of its captions: it must be caption#tokens#start#end"),
            ("a#b#0#0#9", "it must be"),
            ("a#b#0.0#0.0\na#b#x#1", "line 2 of its captions: `x` is no time"),
            ("a#b#-1#1", "no time"),
            ("a#b#0#inf", "no time"),
            ("a#b#3#2", "ends before it begins"),
        ] {
            let error = parse(text).unwrap_err();
            assert!(error.contains(said), "{error}");
        }
        let many: String = (1..70).map(|end| format!("a#b#0#{end}\n")).collect();
        assert!(parse(&many).unwrap_err().contains("more than 64 parts"));
        assert_eq!(read(Path::new("nowhere.txt")), Ok(None));
    }
}
