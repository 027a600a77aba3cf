//! Curves in JSON. Points go straight into the curve; no document tree is built.

use std::fmt;

use serde::de::{DeserializeSeed, Deserializer, Error, IgnoredAny, MapAccess, SeqAccess, Visitor};

use crate::builder::{CurveBuilder, Refusal, Sample};
use crate::{Curve, Origin, SketchError};

pub(super) fn read(text: &str) -> Result<Curve, SketchError> {
    let mut reader = Reader::default();
    let mut json = serde_json::Deserializer::from_str(text);
    let read = json.deserialize_any(Document(&mut reader)).and_then(|()| json.end());
    match read {
        Ok(()) => reader.builder.finish(Origin::Sampled),
        Err(_) if reader.full => Err(SketchError::TooManyPoints),
        Err(error) => {
            let message = error.to_string();
            // The place is told apart from the problem: serde_json ends its message with it.
            let problem = message.rsplit_once(" at line ").map_or(message.as_str(), |(problem, _)| problem);
            Err(SketchError::Json {
                line: error.line(),
                column: error.column(),
                point: reader.builder.point_count(),
                problem: problem.to_owned(),
            })
        }
    }
}

#[derive(Default)]
struct Reader {
    builder: CurveBuilder,
    full: bool,
}

impl Reader {
    fn push<E: Error>(&mut self, sample: Sample) -> Result<(), E> {
        self.builder.push(sample).map_err(|refusal| match refusal {
            Refusal::Full => {
                self.full = true;
                E::custom("too many points")
            }
            Refusal::Wrong(_, problem) => E::custom(problem),
        })
    }
}

/// The whole file: points, or an object that holds points or strokes.
struct Document<'a>(&'a mut Reader);

impl<'de> Visitor<'de> for Document<'_> {
    type Value = ();

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("[[x, y], ...], {\"points\": [...]} or {\"strokes\": [[...], ...]}")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<(), A::Error> {
        Stroke(self.0).visit_seq(seq)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        let (mut found, mut is_map) = (false, false);
        while let Some(key) = map.next_key::<String>()? {
            match key.as_str() {
                "points" | "strokes" if found => {
                    return Err(A::Error::custom("more than one of points and strokes"));
                }
                "points" => map.next_value_seed(Stroke(self.0))?,
                "strokes" => map.next_value_seed(Strokes(self.0))?,
                other => {
                    is_map |= other == "map_stress";
                    map.next_value::<IgnoredAny>()?;
                    continue;
                }
            }
            found = true;
        }
        if found {
            Ok(())
        } else if is_map {
            let what = "this is a clip's map and no drawing; write the map as .svg and draw a line over it";
            Err(A::Error::custom(what))
        } else {
            Err(A::Error::custom("the object has neither \"points\" nor \"strokes\""))
        }
    }
}

/// An array of strokes.
struct Strokes<'a>(&'a mut Reader);

impl<'de> DeserializeSeed<'de> for Strokes<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_seq(self)
    }
}

impl<'de> Visitor<'de> for Strokes<'_> {
    type Value = ();

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("an array of strokes, each an array of points")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<(), A::Error> {
        while seq.next_element_seed(Stroke(&mut *self.0))?.is_some() {}
        Ok(())
    }
}

/// An array of points: one stroke.
struct Stroke<'a>(&'a mut Reader);

impl<'de> DeserializeSeed<'de> for Stroke<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Stroke<'_> {
    type Value = ();

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("an array of points [x, y], [x, y, t] or {\"x\": .., \"y\": ..}")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<(), A::Error> {
        self.0.builder.begin_stroke();
        while seq.next_element_seed(Point(&mut *self.0))?.is_some() {}
        Ok(())
    }
}

/// One point, as an array or an object.
struct Point<'a>(&'a mut Reader);

impl<'de> DeserializeSeed<'de> for Point<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Point<'_> {
    type Value = ();

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a point [x, y], [x, y, t] or {\"x\": .., \"y\": ..}")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<(), A::Error> {
        let (Some(Number(x)), Some(Number(y))) = (seq.next_element()?, seq.next_element()?) else {
            return Err(A::Error::custom("a point needs two numbers, x and y"));
        };
        let seconds = seq.next_element()?.map(|Number(t)| t);
        if seq.next_element::<IgnoredAny>()?.is_some() {
            return Err(A::Error::custom("a point has at most three numbers: x, y and t"));
        }
        self.0.push(Sample { point: [x, y], seconds, pressure: None })
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        let (mut x, mut y, mut seconds, mut pressure) = (None, None, None, None);
        while let Some(key) = map.next_key::<String>()? {
            match key.as_str() {
                "x" => x = Some(map.next_value()?),
                "y" => y = Some(map.next_value()?),
                "t" | "time" => seconds = map.next_value()?,
                "pressure" => pressure = map.next_value()?,
                _ => {
                    map.next_value::<IgnoredAny>()?;
                }
            }
        }
        let (Some(Number(x)), Some(Number(y))) = (x, y) else {
            return Err(A::Error::custom("a point needs the numbers x and y"));
        };
        let plain = |number: Option<Number>| number.map(|Number(value)| value);
        self.0.push(Sample { point: [x, y], seconds: plain(seconds), pressure: plain(pressure) })
    }
}

/// A number, with a message that speaks of points.
struct Number(f64);

impl<'de> serde::Deserialize<'de> for Number {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_f64(NumberVisitor(STROKES)).map(Number)
    }
}

/// What was expected where a number of a point was not one.
const STROKES: &str = "a number (several strokes are written {\"strokes\": [[...], ...]})";

/// Takes any number as f64; the text says what was expected otherwise.
pub(crate) struct NumberVisitor(pub(crate) &'static str);

impl Visitor<'_> for NumberVisitor {
    type Value = f64;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.0)
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<f64, E> {
        Ok(value)
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<f64, E> {
        Ok(value as f64)
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<f64, E> {
        Ok(value as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shape_is_read() {
        let plain = [[0.0, 1.0], [2.0, -3.5]];
        for text in [
            "[[0,1],[2,-3.5]]",
            "[[0,1,10],[2,-3.5,11]]",
            r#"[{"x":0,"y":1},{"y":-3.5,"x":2,"tilt":[1,{"a":null}]}]"#,
            r#"{"name":"a","points":[[0,1],[2,-3.5]],"more":{}}"#,
            r#"{"strokes":[[[0,1]],[],[{"x":2,"y":-3.5,"t":null}]]}"#,
        ] {
            assert_eq!(read(text).unwrap().points(), plain, "{text}");
        }
    }

    #[test]
    fn time_pressure_and_strokes_are_kept() {
        let curve = read(r#"{"strokes":[[[0,0,5],[1,0,6]],[[1,1,8]]]}"#).unwrap();
        assert_eq!(curve.stroke_count(), 2);
        assert_eq!(curve.seconds(), Some([0.0, 1.0, 3.0].as_slice()));
        let curve =
            read(r#"[{"x":0,"y":0,"time":1,"pressure":0.5},{"x":1,"y":0,"t":2,"pressure":1}]"#).unwrap();
        assert_eq!(curve.seconds(), Some([0.0, 1.0].as_slice()));
        assert_eq!(curve.pressure(), Some([0.5, 1.0].as_slice()));
    }
}
