//! Waves as samples in CSV and JSON.

use std::fmt;

use csv::StringRecord;
use serde::de::{DeserializeSeed, Deserializer, Error, IgnoredAny, MapAccess, SeqAccess, Visitor};

use super::MAX_RATE;
use crate::read::csv::{Stop, each_row, is_header, number};
use crate::read::json::NumberVisitor;
use crate::table::{Refusal, TableBuilder, field_count, is_time, located, text_of};
use crate::{Format, SketchError, Table};

const WHAT: &str = "wave";

/// Reads a wave's samples from the bytes of a file: a [`Table`] of one column.
///
/// CSV has rows `value` or `t,value` with t in seconds; a header may name them in another order (`t` or `time`, and any
/// name for the value). JSON is `[0, 0.5, ...]`, or `{"rate": 100, "values": [0, 0.5, ...]}` with the rate in samples a
/// second. Without t or rate, n samples are n frames.
///
/// # Errors
/// Any [`SketchError`] that says what the file holds and where: too large, not UTF-8, malformed, fewer than two samples,
/// more than [`crate::limits::MAX_FRAMES`], values that are not finite, times that go back, nothing that moves. SVG is
/// refused with [`SketchError::NotFromSvg`].
pub fn read_wave(bytes: &[u8], format: Format) -> Result<Table, SketchError> {
    if format == Format::Svg {
        return Err(SketchError::NotFromSvg { what: "a wave" });
    }
    let text = text_of(bytes, WHAT)?;
    if format == Format::Json { from_json(text) } else { from_csv(text) }
}

/// Which field is what, counted from 0.
struct Columns {
    time: Option<usize>,
    value: usize,
}

fn from_csv(text: &str) -> Result<Table, SketchError> {
    let mut builder = TableBuilder::new(WHAT, 1, Vec::new());
    let mut columns = None;
    each_row(text, &SketchError::TooManyRows { what: WHAT }, |row| {
        let columns = match &columns {
            Some(columns) => columns,
            None if is_header(row) => {
                let header = Columns::of(row, row.iter().position(is_time))?;
                if row.get(header.value).is_some_and(is_time) {
                    return Err(Stop::At(
                        header.value + 1,
                        "a second column is named as the time; name the value otherwise".into(),
                    ));
                }
                columns = Some(header);
                return Ok(());
            }
            None => &*columns.insert(Columns::of(row, (field_count(row) == 2).then_some(0))?),
        };
        columns.push(row, &mut builder)
    })?;
    builder.finish()
}

impl Columns {
    fn of(row: &StringRecord, time: Option<usize>) -> Result<Self, Stop> {
        let value = if time == Some(0) { 1 } else { 0 };
        let width = field_count(row);
        let needed = 1 + usize::from(time.is_some());
        if width > needed {
            let problem =
                "a row of a wave is value or t,value; only a curve may have more columns".to_owned();
            return Err(Stop::At(needed + 1, problem));
        }
        Ok(Self { time, value })
    }

    fn push(&self, row: &StringRecord, builder: &mut TableBuilder) -> Result<(), Stop> {
        let needed = 1 + usize::from(self.time.is_some());
        if field_count(row) > needed {
            let problem = format!("the row has more fields than the {needed} of the first row");
            return Err(Stop::At(needed + 1, problem));
        }
        let required = |column: usize, name: &str| {
            number(row, column, name)?.ok_or_else(|| (column + 1, format!("{name} is missing")))
        };
        let time = self.time.map(|column| required(column, "t")).transpose()?;
        let value = required(self.value, "the value")?;
        let column = self.time.unwrap_or(self.value) + 1;
        builder.begin_row(time).map_err(|refusal| (column, refusal))?;
        builder.push("the value", value).map_err(|refusal| (self.value + 1, refusal))?;
        Ok(())
    }
}

fn from_json(text: &str) -> Result<Table, SketchError> {
    if text.trim().is_empty() {
        return Err(SketchError::TooFewRows { what: WHAT, rows: 0 });
    }
    let mut reader = Reader { builder: TableBuilder::new(WHAT, 1, Vec::new()), rate: None, full: None };
    let mut json = serde_json::Deserializer::from_str(text);
    let read = json.deserialize_any(Document(&mut reader)).and_then(|()| json.end());
    match (read, reader) {
        (Ok(()), Reader { builder, rate: Some(rate), .. }) => builder.finish_at_rate(rate),
        (Ok(()), Reader { builder, .. }) => builder.finish(),
        (Err(_), Reader { full: Some(error), .. }) => Err(error),
        (Err(error), Reader { builder, .. }) => Err(located(&error, text, "sample", builder.row_count())),
    }
}

struct Reader {
    builder: TableBuilder,
    rate: Option<f64>,
    /// What made the file too large.
    full: Option<SketchError>,
}

/// The whole file: numbers, or an object that holds them.
struct Document<'a>(&'a mut Reader);

impl<'de> Visitor<'de> for Document<'_> {
    type Value = ();

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("[0, 0.5, ...] or {\"rate\": 100, \"values\": [0, 0.5, ...]}")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<(), A::Error> {
        Values(self.0).visit_seq(seq)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        let mut found = false;
        while let Some(key) = map.next_key::<String>()? {
            match key.as_str() {
                "values" if found => return Err(A::Error::custom("a second \"values\"")),
                "values" => {
                    found = true;
                    map.next_value_seed(Values(self.0))?;
                }
                "rate" => {
                    let rate: f64 = map.next_value()?;
                    if !(rate > 0.0 && rate <= MAX_RATE) {
                        return Err(A::Error::custom(format!(
                            "rate is {rate}; samples a second, above 0 to {MAX_RATE}, are expected"
                        )));
                    }
                    self.0.rate = Some(rate);
                }
                _ => {
                    map.next_value::<IgnoredAny>()?;
                }
            }
        }
        if found { Ok(()) } else { Err(A::Error::custom("the object has no \"values\"")) }
    }
}

/// An array of samples.
struct Values<'a>(&'a mut Reader);

impl<'de> DeserializeSeed<'de> for Values<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_seq(self)
    }
}

impl<'de> Visitor<'de> for Values<'_> {
    type Value = ();

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("an array of numbers")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<(), A::Error> {
        let Reader { builder, full, .. } = self.0;
        while let Some(Sample(value)) = seq.next_element()? {
            let pushed = builder.begin_row(None).and_then(|()| builder.push("the sample", value));
            pushed.map_err(|refusal| match refusal {
                Refusal::Wrong(problem) => A::Error::custom(problem),
                Refusal::Full(error) => {
                    *full = Some(error);
                    A::Error::custom("too many samples")
                }
            })?;
        }
        Ok(())
    }
}

/// One number, with a message that speaks of samples.
struct Sample(f64);

impl<'de> serde::Deserialize<'de> for Sample {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_f64(NumberVisitor("a number: a wave has one for each sample")).map(Sample)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_form_is_read() {
        for (text, format, seconds) in [
            ("0\n0.5\n-1\n", Format::Csv, None),
            ("height\n0\n0.5\n-1\n", Format::Csv, None),
            ("0,0\n0.1,0.5\n0.2,-1\n", Format::Csv, Some([0.0, 0.1, 0.2])),
            ("y;Time\n0;0\n0.5;0.1\n-1;0.2\n", Format::Csv, Some([0.0, 0.1, 0.2])),
            ("[0, 0.5, -1]", Format::Json, None),
            ("{\"values\": [0, 0.5, -1], \"unit\": {}, \"rate\": 10}", Format::Json, Some([0.0, 0.1, 0.2])),
        ] {
            let wave = read_wave(text.as_bytes(), format).unwrap();
            assert_eq!((wave.width(), wave.values()), (1, [0.0, 0.5, -1.0].as_slice()), "{text}");
            assert_eq!(wave.seconds(), seconds.as_ref().map(<[f64; 3]>::as_slice), "{text}");
        }
    }
}
