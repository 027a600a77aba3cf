//! The MOTION part: frame count, frame time, rows.

use super::{
    FRAME_TIMES,
    hierarchy::Hierarchy,
    rows::{Rows, Scale, shape},
};
use crate::lexer::{Lexer, NotANumber, Word};
use crate::{Finding, FormatError, ImportOptions};
use inkrig_motion::{TranslationTrack, glam::Quat};

/// The rows of a file as the parts of a clip.
#[derive(Debug)]
pub(super) struct Motion {
    pub(super) frame_rate: f64,
    pub(super) frame_time: Option<f64>,
    pub(super) rotations: Vec<Quat>,
    pub(super) translations: Vec<TranslationTrack>,
}

/// Reads everything after the word MOTION.
pub(super) fn parse(
    lexer: &mut Lexer<'_>,
    hierarchy: &Hierarchy,
    scale: Scale,
    options: &ImportOptions,
    findings: &mut Vec<Finding>,
) -> Result<Motion, FormatError> {
    let header = header(lexer)?;
    lexer.skip_space();
    let (at_rows, width) = (lexer.peek(), hierarchy.width());
    if width == 0 {
        let hint = "the file holds a skeleton only; export it again with its animation";
        return Err(lexer.error("bvh-no-channels", &at_rows, None, "no joint has channels", hint));
    }
    if at_rows.text.is_empty() {
        let hint = "the file holds a skeleton only; export it again with its animation";
        return Err(lexer.error("bvh-no-frames", &at_rows, None, "there are no frames after MOTION", hint));
    }
    let shape = shape(lexer, width, header.frames.map(|(count, _)| count));
    let joints = hierarchy.joints.len();
    let limit = options.limits.cells_for(lexer.rest().len());
    if shape.rows.saturating_mul(joints) > limit {
        return Err(FormatError::Limit {
            what: format!(
                "{} frames of {joints} joints make {} rotations",
                shape.rows,
                shape.rows.saturating_mul(joints)
            ),
            limit,
            place: Some(lexer.place(&at_rows, None)),
            hint: "cut the motion into shorter ones".into(),
        });
    }
    let mut rows = Rows::new(hierarchy, scale, shape.rows);
    if shape.wrapped {
        let message = "frames do not end with their lines; the numbers are taken in order";
        findings.push(Finding::warning("bvh-wrapped-rows", message.into()).at(lexer.place(&at_rows, None)));
    }
    rows.read(lexer, shape.wrapped, findings)?;
    findings.extend(count_finding(&header, rows.count, lexer));
    let frame_rate = frame_rate(lexer, &header, &at_rows, rows.count, options, findings)?;
    let frame_time =
        header.time.and_then(|time| time.number().ok()).filter(|time| FRAME_TIMES.contains(time));
    Ok(Motion { frame_rate, frame_time, rotations: rows.rotations, translations: rows.translations })
}

/// Reads what stands between MOTION and the rows; the number of frames that it announces.
pub(super) fn frame_count_of_header(lexer: &mut Lexer<'_>) -> Result<Option<f64>, FormatError> {
    Ok(header(lexer)?.frames.map(|(count, _)| count))
}

/// What stands between MOTION and the rows.
#[derive(Default)]
struct Header<'a> {
    frames: Option<(f64, Word<'a>)>,
    time: Option<Word<'a>>,
}

fn header<'a>(lexer: &mut Lexer<'a>) -> Result<Header<'a>, FormatError> {
    let mut header = Header::default();
    loop {
        let first = lexer.peek();
        if !first.text.get(..5).is_some_and(|start| start.eq_ignore_ascii_case(b"frame")) {
            return Ok(header);
        }
        lexer.skip_space();
        let line = lexer.line();
        let (key, value) = line.split_at_colon();
        let key = key.split(u8::is_ascii_whitespace).collect::<Vec<_>>().concat().to_ascii_lowercase();
        let earlier = match key.as_slice() {
            b"frames" => header.frames.replace((frame_count(lexer, &value)?, value)).is_some(),
            b"frametime" => header.time.replace(value).is_some(),
            _ => {
                let what = format!("expected `Frames:` or `Frame Time:`, found {}", line.shown());
                let hint = "after MOTION come these two lines, then the rows";
                return Err(lexer.error("bvh-keyword", &first, None, what, hint));
            }
        };
        if earlier {
            let what = format!("{} a second time", first.shown());
            return Err(lexer.error("bvh-twice", &first, None, what, "leave one of them out"));
        }
    }
}

fn frame_count(lexer: &Lexer<'_>, word: &Word<'_>) -> Result<f64, FormatError> {
    // Larger than any limit on numbers is fine here: the rows that are there count.
    let count = std::str::from_utf8(word.text).ok().and_then(|text| text.parse::<f64>().ok());
    count.filter(|count| count.is_finite() && *count >= 0.0 && count.fract() == 0.0).ok_or_else(|| {
        let what = format!("expected the number of frames, found {}", word.shown_value());
        lexer.error(
            "bvh-frame-count",
            word,
            None,
            what,
            "write the number of rows that follow, such as `Frames: 120`",
        )
    })
}

fn count_finding(header: &Header<'_>, rows: usize, lexer: &Lexer<'_>) -> Option<Finding> {
    let Some((announced, word)) = &header.frames else {
        let message = format!("there is no line `Frames:`; rows found and used: {rows}");
        return Some(Finding::warning("bvh-row-count", message));
    };
    let message = format!("announced frames: {announced}; rows found and used: {rows}");
    let finding = Finding::warning("bvh-row-count", message).at(lexer.place(word, None));
    (*announced != rows as f64).then_some(finding)
}

fn frame_rate(
    lexer: &Lexer<'_>,
    header: &Header<'_>,
    at_rows: &Word<'_>,
    rows: usize,
    options: &ImportOptions,
    findings: &mut Vec<Finding>,
) -> Result<f64, FormatError> {
    if let Some(rate) = options.frame_rate {
        return Ok(rate);
    }
    let time = header.time.map(|word| (word, word.number()));
    if let Some((_, Ok(time))) = time
        && FRAME_TIMES.contains(&time)
    {
        return Ok(1.0 / time);
    }
    let what = match &time {
        None => "there is no frame time".into(),
        Some((word, Err(NotANumber::Text | NotANumber::Comma))) => {
            format!("expected the frame time, found {}", word.shown_value())
        }
        Some((word, _)) => {
            let (least, most) = (FRAME_TIMES.start(), FRAME_TIMES.end());
            format!("the frame time is {}, not between {least} and {most} seconds", word.shown_value())
        }
    };
    let word = header.time.as_ref().unwrap_or(at_rows);
    if rows == 1 {
        let message = format!("{what}; the single frame is taken at 30 frames a second");
        findings.push(Finding::info("bvh-frame-time", message).at(lexer.place(word, None)));
        return Ok(30.0);
    }
    let comma = matches!(time, Some((_, Err(NotANumber::Comma))));
    let decimals = if comma { "write decimals with a point, or" } else { "" };
    let hint = format!("{decimals} give the frame rate with `--source-fps`, such as `--source-fps 30`");
    Err(lexer.error("bvh-frame-time", word, None, what, hint.trim_start()))
}
