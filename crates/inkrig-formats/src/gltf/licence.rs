//! What a glTF or VRM file says about its use.

use super::container;
use crate::finding::clean;
use serde::Deserialize;
use serde_json::Value;

/// Where files say it, and what to call the place.
const PLACES: [(&str, &str); 13] = [
    ("/asset/copyright", "asset.copyright"),
    ("/asset/extras/license", "asset.extras.license"),
    ("/asset/extras/author", "asset.extras.author"),
    ("/extensions/VRM/meta/author", "VRM author"),
    ("/extensions/VRM/meta/licenseName", "VRM licenseName"),
    ("/extensions/VRM/meta/otherLicenseUrl", "VRM otherLicenseUrl"),
    ("/extensions/VRMC_vrm/meta/authors", "VRM authors"),
    ("/extensions/VRMC_vrm/meta/licenseUrl", "VRM licenseUrl"),
    ("/extensions/VRMC_vrm/meta/copyrightInformation", "VRM copyrightInformation"),
    ("/extensions/VRMC_vrm/meta/otherLicenseUrl", "VRM otherLicenseUrl"),
    ("/extensions/VRMC_vrm/meta/creditNotation", "VRM creditNotation"),
    ("/extensions/VRMC_vrm/meta/commercialUsage", "VRM commercialUsage"),
    ("/extensions/VRMC_vrm/meta/modification", "VRM modification"),
];

/// Longest text that is given back, characters.
const MOST: usize = 300;

/// The parts of a document in which such things stand; the rest is skipped while it is read.
#[derive(Deserialize)]
struct Parts {
    #[serde(default)]
    asset: Value,
    #[serde(default)]
    extensions: Extensions,
}

#[derive(Deserialize, Default)]
struct Extensions {
    #[serde(rename = "VRM", default)]
    vrm0: Meta,
    #[serde(rename = "VRMC_vrm", default)]
    vrm1: Meta,
}

#[derive(Deserialize, Default)]
struct Meta {
    #[serde(default)]
    meta: Value,
}

/// What a glTF or VRM file says about its author and licence: the field, and its text without control characters, at most
/// 300 characters. Empty where it says nothing or cannot be read.
pub fn gltf_licence(bytes: &[u8]) -> Vec<(&'static str, String)> {
    /// Such texts are short, and their values are kept in memory.
    const MOST_BYTES: usize = 64 << 20;
    let Ok(container) = container::open(bytes) else { return Vec::new() };
    if container.json.len() > MOST_BYTES {
        return Vec::new();
    }
    let Ok(parts) = serde_json::from_slice::<Parts>(container.json) else { return Vec::new() };
    let document = serde_json::json!({
        "asset": parts.asset,
        "extensions": { "VRM": { "meta": parts.extensions.vrm0.meta }, "VRMC_vrm": { "meta": parts.extensions.vrm1.meta } },
    });
    let said = |(pointer, name): (&str, &'static str)| {
        let text = match document.pointer(pointer)? {
            Value::String(text) => text.clone(),
            Value::Array(list) => {
                let texts = list.iter().filter_map(Value::as_str).take(20);
                texts.collect::<Vec<_>>().join(", ")
            }
            _ => return None,
        };
        let text = clean(text.trim(), MOST);
        (!text.is_empty()).then_some((name, text))
    };
    PLACES.into_iter().filter_map(said).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn author_and_licence_are_found() {
        let text = br#"{"asset":{"version":"2.0","copyright":" CC-BY\u0007 Someone "},"nodes":[{"x":1}],
            "extensions":{"VRMC_vrm":{"meta":{"authors":["A","B"],"licenseUrl":"https://vrm.dev/licenses/1.0/","name":"x"}},"Y":7}}"#;
        let expected = [
            ("asset.copyright", "CC-BY\u{fffd} Someone"),
            ("VRM authors", "A, B"),
            ("VRM licenseUrl", "https://vrm.dev/licenses/1.0/"),
        ];
        assert_eq!(gltf_licence(text), expected.map(|(field, text)| (field, text.to_string())));
        let vrm0 =
            br#"{"asset":{"version":"2.0"},"extensions":{"VRM":{"meta":{"licenseName":"CC0","author":7}}}}"#;
        assert_eq!(gltf_licence(vrm0), [("VRM licenseName", "CC0".to_string())]);
        for nothing in [&b"{}"[..], b"", b"glTF", br#"{"asset":3,"extensions":[]}"#] {
            assert!(gltf_licence(nothing).is_empty());
        }
    }
}
