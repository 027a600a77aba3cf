//! Opening a file with `ufbx`.

use super::{budget::Budget, damaged};
use crate::{FormatError, finding::shown};
use ufbx::{AllocatorOpts, Error, ErrorType, FileFormat, LoadOpts, SceneRoot};

/// How a binary file begins.
const BINARY: &[u8] = b"Kaydara FBX Binary  ";

/// Bytes in which a text says that it is FBX, and a file that it is encrypted.
const HEAD: usize = 4096;

/// Parses the file; meshes, embedded pictures and whatever lies in other files are left out.
pub(super) fn open(bytes: &[u8], budget: &Budget) -> Result<SceneRoot, FormatError> {
    let head = bytes.get(..HEAD.min(bytes.len())).unwrap_or_default();
    if bytes.is_empty() {
        return Err(damaged("fbx-empty", "the file", "it is empty", "export or copy it again"));
    }
    if !head.starts_with(BINARY) && find(head, b"FBX").is_none() {
        let what = "it does not begin as an FBX file does, binary or text";
        return Err(damaged(
            "fbx-header",
            "the file",
            what,
            "check that it is one, and that it is not packed",
        ));
    }
    if is_encrypted(head) {
        let hint = "export it again without a password";
        return Err(damaged("fbx-encrypted", "the file", "it is encrypted", hint));
    }
    let memory = |memory_limit: usize| AllocatorOpts {
        memory_limit,
        allocation_limit: budget.pieces(),
        // Else a small file would take some large chunks.
        max_chunk_size: 1 << 20,
        ..AllocatorOpts::default()
    };
    let options = LoadOpts {
        temp_allocator: memory(budget.working_bytes()),
        result_allocator: memory(budget.scene_bytes()),
        file_format: FileFormat::Fbx,
        ignore_geometry: true,
        ignore_embedded: true,
        skip_skin_vertices: true,
        skip_mesh_parts: true,
        evaluate_skinning: false,
        evaluate_caches: false,
        load_external_files: false,
        ..LoadOpts::default()
    };
    ufbx::load_memory(bytes, options).map_err(|error| told(&error, budget))
}

/// What `ufbx` says, as we say it.
fn told(error: &Error, budget: &Budget) -> FormatError {
    let again = "export or copy it again";
    let file = |code, what: &str, hint: &str| damaged(code, "the file", what, hint);
    match error.type_ {
        ErrorType::TruncatedFile | ErrorType::EmptyFile => {
            file("fbx-truncated", "it ends in the middle of something", again)
        }
        ErrorType::MemoryLimit | ErrorType::AllocationLimit | ErrorType::OutOfMemory => FormatError::Limit {
            what: "what the file unpacks to takes more bytes than a file of its size may".into(),
            limit: budget.working_bytes(),
            place: None,
            hint: "export only the skeleton and one clip".into(),
        },
        ErrorType::UnsupportedVersion => {
            let hint = "save it as FBX 7.4 (2014) or later, with Autodesk's FBX Converter for example";
            file("fbx-version", "it is of a version that inkrig does not read", hint)
        }
        ErrorType::UnrecognizedFileFormat => {
            file("fbx-header", "it does not begin as an FBX file does, binary or text", again)
        }
        _ => {
            let said = shown(error.description.as_ref());
            file("fbx-damaged", &format!("it is damaged ({said})"), again)
        }
    }
}

/// Whether the header says so: `EncryptionType` other than 0.
fn is_encrypted(head: &[u8]) -> bool {
    let Some(at) = find(head, b"EncryptionType") else { return false };
    let after = head.get(at + b"EncryptionType".len()..).unwrap_or_default();
    match after {
        [b'I', number @ ..] => number.get(..4).is_some_and(|number| number != [0; 4]),
        [b':', text @ ..] => {
            text.iter().find(|byte| **byte != b' ').is_some_and(|digit| (b'1'..=b'9').contains(digit))
        }
        _ => false,
    }
}

fn find(bytes: &[u8], wanted: &[u8]) -> Option<usize> {
    bytes.windows(wanted.len()).position(|window| window == wanted)
}
