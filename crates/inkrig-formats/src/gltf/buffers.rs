//! The bytes behind a document: the chunk of a GLB, data in the text itself, or files beside it.

use super::{container::Container, damaged, document::Document};
use crate::{FileSource, FormatError, ImportOptions, finding::shown};
use base64::{
    Engine as _, alphabet,
    engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig},
};
use std::{borrow::Cow, collections::HashMap};

/// Base64 with or without its padding: both are met.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &alphabet::STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// The buffers that were asked for.
#[derive(Debug)]
pub(super) struct Buffers<'a> {
    /// What was loaded; several buffers may be one file.
    loaded: Vec<Cow<'a, [u8]>>,
    /// Place in `loaded` of a buffer.
    places: HashMap<u32, usize>,
}

impl<'a> Buffers<'a> {
    /// Loads the buffers with these indices and no others: images may lie in them.
    pub(super) fn load(
        wanted: impl IntoIterator<Item = u32>,
        document: &Document,
        container: &Container<'a>,
        options: &ImportOptions,
        files: FileSource<'_>,
    ) -> Result<Self, FormatError> {
        let mut out = Self { loaded: Vec::new(), places: HashMap::new() };
        let mut by_address: HashMap<&str, usize> = HashMap::new();
        // All files together may be as large as one.
        let mut left = options.limits.bytes;
        for index in wanted {
            if out.places.contains_key(&index) {
                continue;
            }
            let part = format!("buffer {index}");
            let Some(buffer) = document.buffers.0.get(index as usize) else {
                let what = "there is no such buffer";
                return Err(damaged("gltf-index", part, what, "the file is damaged; export it again"));
            };
            let place = match &buffer.uri {
                Some(address) => match by_address.get(address.as_str()) {
                    Some(&place) => place,
                    None => {
                        let bytes = fetch(address, &part, left, files)?;
                        left = left.saturating_sub(bytes.len());
                        out.loaded.push(Cow::Owned(bytes));
                        by_address.insert(address, out.loaded.len() - 1);
                        out.loaded.len() - 1
                    }
                },
                None => {
                    let Some(bin) = container.bin.filter(|_| index == 0) else {
                        let hint = "the file is cut off or damaged; export it again";
                        return Err(damaged("gltf-buffer", part, "its bytes are nowhere", hint));
                    };
                    out.loaded.push(Cow::Borrowed(bin));
                    out.loaded.len() - 1
                }
            };
            out.places.insert(index, place);
        }
        Ok(out)
    }

    /// Bytes that did not lie in the file itself, or lay there in another form.
    pub(super) fn bytes(&self) -> usize {
        let owned = |bytes: &Cow<'_, [u8]>| if matches!(bytes, Cow::Owned(_)) { bytes.len() } else { 0 };
        self.loaded.iter().map(owned).sum()
    }

    /// The bytes of a buffer that was loaded, as many as it announces or has.
    pub(super) fn get(&self, index: u32, document: &Document) -> Option<&[u8]> {
        let bytes = self.loaded.get(*self.places.get(&index)?)?;
        let announced = document.buffers.0.get(index as usize)?.byte_length;
        bytes.get(..announced.min(bytes.len()))
    }
}

fn fetch(address: &str, part: &str, most: usize, files: FileSource<'_>) -> Result<Vec<u8>, FormatError> {
    if address.get(..5).is_some_and(|scheme| scheme.eq_ignore_ascii_case("data:")) {
        return data(address).ok_or_else(|| {
            let hint = "the file is damaged; export it as GLB";
            damaged("gltf-data", part, "the data in the text is not base64", hint)
        });
    }
    let refused = |why: &str| {
        let what = format!("it lies at `{}`: {why}", shown(address));
        damaged("gltf-address", part, what, "put the file beside the .gltf, or export as GLB")
    };
    let name = relative_name(address).map_err(refused)?;
    files(&name, most).map_err(|why| {
        let what = format!("its file `{}` cannot be read: {why}", shown(&name));
        damaged("gltf-file", part, what, "put the file beside the .gltf, or export as GLB")
    })
}

/// What `data:...;base64,` holds.
fn data(address: &str) -> Option<Vec<u8>> {
    let (head, body) = address.split_once(',')?;
    if !head.get(head.len().checked_sub(7)?..)?.eq_ignore_ascii_case(";base64") {
        return None;
    }
    BASE64.decode(body).ok()
}

/// The name of a file inside of the document's own folder, or why the address does not stay there.
fn relative_name(address: &str) -> Result<String, &'static str> {
    if address.len() > 1024 {
        return Err("the address is too long");
    }
    let name = percent_decoded(address).ok_or("the address is not UTF-8")?;
    if name.contains(':') {
        return Err("only files beside the document are read");
    }
    if name.contains('\\') || name.chars().any(char::is_control) {
        return Err("such signs do not stand in an address");
    }
    if name.split('/').any(|part| part == ".." || part.is_empty()) {
        return Err("it leads out of the document's folder");
    }
    Ok(name)
}

fn percent_decoded(address: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(address.len());
    let mut rest = address.as_bytes();
    while let Some((&first, tail)) = rest.split_first() {
        let digits = tail.get(..2).and_then(|two| std::str::from_utf8(two).ok());
        let decoded = digits.filter(|_| first == b'%').and_then(|two| u8::from_str_radix(two, 16).ok());
        bytes.push(decoded.unwrap_or(first));
        rest = if decoded.is_some() { tail.get(2..).unwrap_or(&[]) } else { tail };
    }
    String::from_utf8(bytes).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_stay_in_the_folder() {
        assert_eq!(relative_name("walk.bin").as_deref(), Ok("walk.bin"));
        assert_eq!(relative_name("data/walk%20now.bin").as_deref(), Ok("data/walk now.bin"));
        for address in [
            "../x",
            "a/../../x",
            "%2e%2e/x",
            "a/%2E%2E/x",
            "/etc/passwd",
            "%2fetc/passwd",
            "file:///etc/passwd",
            "file:x",
            "http://a/b",
            "HTTPS://a",
            "//server/x",
            "C:\\x",
            "c:x",
            "a\\..\\x",
            "a%00b",
            "a%0Ab",
            "",
            "..",
            "%ff",
            "a//b",
        ] {
            assert!(relative_name(address).is_err(), "{address}");
        }
        assert!(relative_name(&"x".repeat(2000)).is_err());
    }

    #[test]
    fn data_in_the_text() {
        assert_eq!(data("data:application/octet-stream;base64,AQID").unwrap(), [1, 2, 3]);
        assert_eq!(data("data:;base64,AQ==").unwrap(), [1]);
        assert_eq!(data("data:;base64,AQ").unwrap(), [1]);
        assert_eq!(data("data:,AQ"), None);
        assert_eq!(data("data:;base64,A*"), None);
    }
}
