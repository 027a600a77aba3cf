//! What wraps a glTF file: the chunks of a GLB, or nothing around a text file.

use super::damaged;
use crate::FormatError;

const GLB_HEADER: usize = 12;
const CHUNK_HEADER: usize = 8;
const JSON_CHUNK: u32 = 0x4e4f_534a;
const BIN_CHUNK: u32 = 0x004e_4942;

/// The parts of a file.
#[derive(Debug, Clone, Copy)]
pub(super) struct Container<'a> {
    /// The JSON text.
    pub(super) json: &'a [u8],
    /// What the first buffer holds when it has no address.
    pub(super) bin: Option<&'a [u8]>,
    /// Whether it is a GLB.
    pub(super) binary: bool,
}

/// Takes a file apart. Bytes after the announced end, and chunks of unknown kinds, are left alone.
pub(super) fn open(bytes: &[u8]) -> Result<Container<'_>, FormatError> {
    if !bytes.starts_with(b"glTF") {
        return text(bytes);
    }
    let hint = "the file is cut off or damaged; export it again";
    let (Some(version), Some(length)) = (word(bytes, 4), word(bytes, 8)) else {
        return Err(damaged("glb-header", "the GLB header", "it is cut off", hint));
    };
    if version != 2 {
        let what = format!("it says version {version}");
        return Err(damaged("glb-version", "the GLB header", what, "export the file as glTF 2.0"));
    }
    let Some(body) = bytes.get(GLB_HEADER..length as usize) else {
        let what = format!("it announces {length} bytes, and the file has {}", bytes.len());
        return Err(damaged("glb-length", "the GLB header", what, hint));
    };
    let (mut rest, mut json, mut bin) = (body, None, None);
    // A few stray bytes at the end hold no chunk.
    while rest.len() >= CHUNK_HEADER {
        let (length, kind) = (word(rest, 0).unwrap_or(0) as usize, word(rest, 4).unwrap_or(0));
        let Some(data) = rest.get(CHUNK_HEADER..CHUNK_HEADER.saturating_add(length)) else {
            let what =
                format!("a chunk announces {length} bytes, and {} are left", rest.len() - CHUNK_HEADER);
            return Err(damaged("glb-chunk", "the GLB chunks", what, hint));
        };
        match kind {
            JSON_CHUNK if json.is_none() => json = Some(data),
            BIN_CHUNK if bin.is_none() => bin = Some(data),
            _ => {}
        }
        rest = rest.get(CHUNK_HEADER + length..).unwrap_or(&[]);
    }
    match json {
        Some(json) => Ok(Container { json, bin, binary: true }),
        None => Err(damaged("glb-no-json", "the GLB chunks", "there is no JSON chunk", hint)),
    }
}

fn text(bytes: &[u8]) -> Result<Container<'_>, FormatError> {
    let json = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    if json.iter().find(|byte| !byte.is_ascii_whitespace()) != Some(&b'{') {
        let hint =
            "a GLB begins with the letters glTF, a .gltf with an opening brace; is this another format?";
        return Err(damaged("gltf-start", "the start of the file", "neither a GLB nor JSON text", hint));
    }
    Ok(Container { json, bin: None, binary: false })
}

/// Puts a GLB together.
pub(super) fn glb(json: &[u8], bin: &[u8]) -> Result<Vec<u8>, FormatError> {
    let json_length = json.len().next_multiple_of(4);
    let bin_length = bin.len().next_multiple_of(4);
    let bin_chunk = if bin.is_empty() { 0 } else { CHUNK_HEADER + bin_length };
    let total = GLB_HEADER + CHUNK_HEADER + json_length + bin_chunk;
    let Ok(announced) = u32::try_from(total) else {
        let what = format!("the GLB would have {total} bytes, and it holds up to 4 GiB");
        return Err(FormatError::Write { what, hint: "cut the motion into shorter ones".into() });
    };
    let mut out = Vec::with_capacity(total);
    out.extend_from_slice(b"glTF");
    out.extend_from_slice(&2_u32.to_le_bytes());
    out.extend_from_slice(&announced.to_le_bytes());
    chunk(&mut out, JSON_CHUNK, json, b' ');
    if !bin.is_empty() {
        chunk(&mut out, BIN_CHUNK, bin, 0);
    }
    Ok(out)
}

/// One chunk, filled up to whole words. It is no longer than the file, whose length was checked.
fn chunk(out: &mut Vec<u8>, kind: u32, data: &[u8], filling: u8) {
    let length = data.len().next_multiple_of(4);
    out.extend_from_slice(&(length as u32).to_le_bytes());
    out.extend_from_slice(&kind.to_le_bytes());
    out.extend_from_slice(data);
    out.extend(std::iter::repeat_n(filling, length - data.len()));
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    let word = bytes.get(at..at.checked_add(4)?)?;
    Some(u32::from_le_bytes(word.try_into().ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_glb_comes_apart_as_it_was_put_together() {
        let file = glb(b"{}", b"abcde").unwrap();
        assert_eq!(file.len() % 4, 0);
        let parts = open(&file).unwrap();
        assert_eq!((parts.json, parts.bin, parts.binary), (&b"{}  "[..], Some(&b"abcde\0\0\0"[..]), true));
        assert_eq!(open(&glb(b"{}", b"").unwrap()).unwrap().bin, None);
    }

    #[test]
    fn damaged_wrapping_is_said() {
        let file = glb(b"{}", b"abcde").unwrap();
        let said = |bytes: &[u8]| open(bytes).unwrap_err().to_string();
        assert!(said(&file[..10]).starts_with("the GLB header: it is cut off"));
        assert!(said(&file[..30]).starts_with("the GLB header: it announces 40 bytes, and the file has 30"));
        assert!(said(b"HIERARCHY").starts_with("the start of the file: neither a GLB nor JSON text"));
        let mut long = file.clone();
        long[12..16].copy_from_slice(&u32::MAX.to_le_bytes());
        assert!(said(&long).contains("a chunk announces 4294967295 bytes, and 20 are left"));
        let mut old = file;
        old[4] = 1;
        assert!(said(&old).contains("version 1"));
    }
}
