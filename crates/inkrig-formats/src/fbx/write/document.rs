//! Nodes with values one inside of the other: what an FBX file is made of.

use crate::FormatError;
use fbxcel::{
    low::FbxVersion,
    writer::v7400::binary::{Error, FbxFooter, Writer},
};
use std::io::Cursor;

/// What files end with whose time of creation is the one that [`super::header`] writes; the format derives one from
/// the other.
const FOOTER: [u8; 16] =
    [0xfa, 0xbc, 0xab, 0x09, 0xd0, 0xc8, 0xd4, 0x66, 0xb1, 0x76, 0xfb, 0x83, 0x1c, 0xf7, 0x26, 0x7e];

/// A value of a node.
#[derive(Debug, Clone, Copy)]
pub(super) enum Value<'v> {
    Flag(bool),
    Int(i32),
    Long(i64),
    Double(f64),
    Text(&'v str),
    Bytes(&'v [u8]),
    Ints(&'v [i32]),
    Longs(&'v [i64]),
    Floats(&'v [f32]),
    Doubles(&'v [f64]),
}

/// A file in the making.
pub(super) struct Document {
    writer: Writer<Cursor<Vec<u8>>>,
}

impl Document {
    pub(super) fn new() -> Result<Self, FormatError> {
        let writer =
            Writer::new(Cursor::new(Vec::new()), FbxVersion::V7_4).map_err(|error| too_large(&error))?;
        Ok(Self { writer })
    }

    /// Begins a node; what follows until [`Self::close`] is inside of it.
    pub(super) fn open(&mut self, name: &str, values: &[Value<'_>]) -> Result<(), FormatError> {
        self.begin(name, values).map_err(|error| too_large(&error))
    }

    pub(super) fn close(&mut self) -> Result<(), FormatError> {
        self.writer.close_node().map_err(|error| too_large(&error))
    }

    /// A node with nothing inside.
    pub(super) fn leaf(&mut self, name: &str, values: &[Value<'_>]) -> Result<(), FormatError> {
        self.open(name, values)?;
        self.close()
    }

    /// A property: its name, its type in two words, its flags, its value.
    pub(super) fn property(
        &mut self,
        name: &str,
        [kind, label, flags]: [&str; 3],
        values: &[Value<'_>],
    ) -> Result<(), FormatError> {
        let mut all = vec![Value::Text(name), Value::Text(kind), Value::Text(label), Value::Text(flags)];
        all.extend_from_slice(values);
        self.leaf("P", &all)
    }

    /// The whole file.
    pub(super) fn finish(self) -> Result<Vec<u8>, FormatError> {
        let footer = FbxFooter { unknown1: Some(&FOOTER), ..FbxFooter::default() };
        Ok(self.writer.finalize(&footer).map_err(|error| too_large(&error))?.into_inner())
    }

    fn begin(&mut self, name: &str, values: &[Value<'_>]) -> Result<(), Error> {
        let mut node = self.writer.new_node(name)?;
        for value in values {
            match *value {
                Value::Flag(value) => node.append_bool(value)?,
                Value::Int(value) => node.append_i32(value)?,
                Value::Long(value) => node.append_i64(value)?,
                Value::Double(value) => node.append_f64(value)?,
                Value::Text(text) => node.append_string_direct(text)?,
                Value::Bytes(bytes) => node.append_binary_direct(bytes)?,
                Value::Ints(values) => node.append_arr_i32_from_iter(None, values.iter().copied())?,
                Value::Longs(values) => node.append_arr_i64_from_iter(None, values.iter().copied())?,
                Value::Floats(values) => node.append_arr_f32_from_iter(None, values.iter().copied())?,
                Value::Doubles(values) => node.append_arr_f64_from_iter(None, values.iter().copied())?,
            }
        }
        Ok(())
    }
}

/// An object's name with its class behind it, as the format wants it.
pub(super) fn object_name(name: &str, class: &str) -> String {
    format!("{name}\0\u{1}{class}")
}

/// Writing to memory fails for sizes only.
fn too_large(error: &Error) -> FormatError {
    FormatError::Write {
        what: format!("the motion does not fit into an FBX file ({error})"),
        hint: "write a part of it, or another format".into(),
    }
}
