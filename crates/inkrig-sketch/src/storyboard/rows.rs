//! Strokes as rows of numbers: `[x, y]`, `[x, y, seconds]` or `[x, y, seconds, pressure]`, as many in every row.

use super::Stroke;
use serde::de::{Error, SeqAccess, Visitor};
use serde::ser::SerializeSeq;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;

impl Serialize for Stroke {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut rows = serializer.serialize_seq(Some(self.points.len()))?;
        for (at, [x, y]) in self.points.iter().enumerate() {
            let value = |list: &Option<Vec<f64>>| list.as_ref().and_then(|list| list.get(at).copied());
            match (value(&self.seconds), value(&self.pressure)) {
                (Some(time), Some(pressure)) => rows.serialize_element(&[x, y, &time, &pressure])?,
                (Some(time), None) => rows.serialize_element(&[x, y, &time])?,
                (None, _) => rows.serialize_element(&[x, y])?,
            }
        }
        rows.end()
    }
}

impl<'de> Deserialize<'de> for Stroke {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_seq(Rows)
    }
}

struct Rows;

impl<'de> Visitor<'de> for Rows {
    type Value = Stroke;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a stroke: a list of points [x, y], [x, y, seconds] or [x, y, seconds, pressure]")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut rows: A) -> Result<Stroke, A::Error> {
        let (mut stroke, mut seconds, mut pressure) = (Stroke::default(), Vec::new(), Vec::new());
        let mut width = None;
        while let Some(Row { numbers: [x, y, time, force], width: own }) = rows.next_element()? {
            if *width.get_or_insert(own) != own {
                return Err(A::Error::custom("all points of a stroke have as many numbers as its first"));
            }
            stroke.points.push([x, y]);
            if own > 2 {
                seconds.push(time);
            }
            if own > 3 {
                pressure.push(force);
            }
        }
        let some = |list: Vec<f64>| if list.is_empty() { None } else { Some(list) };
        (stroke.seconds, stroke.pressure) = (some(seconds), some(pressure));
        Ok(stroke)
    }
}

/// One point; no list is made for it.
struct Row {
    numbers: [f64; 4],
    width: usize,
}

impl<'de> Deserialize<'de> for Row {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_seq(Numbers)
    }
}

struct Numbers;

impl<'de> Visitor<'de> for Numbers {
    type Value = Row;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a point of two to four numbers: x, y, seconds, pressure")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut values: A) -> Result<Row, A::Error> {
        let mut row = Row { numbers: [0.0; 4], width: 0 };
        while let Some(number) = values.next_element::<f64>()? {
            let place = row.numbers.get_mut(row.width);
            *place.ok_or_else(|| A::Error::invalid_length(5, &self))? = number;
            row.width += 1;
        }
        if row.width < 2 { Err(A::Error::invalid_length(row.width, &self)) } else { Ok(row) }
    }
}
