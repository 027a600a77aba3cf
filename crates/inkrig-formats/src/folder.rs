//! Files beside a document, for formats that spread over several.

use std::{
    fs::File,
    io::{self, Read as _},
    path::Path,
};

/// How a reader asks for a file beside the one that it reads: by a name relative to that file's folder, parts set
/// apart by `/` and none of them `..`, with the most bytes that it takes.
pub type FileSource<'a> = &'a dyn Fn(&str, usize) -> io::Result<Vec<u8>>;

/// A [`FileSource`] without files.
///
/// # Errors
/// Always.
pub fn no_files(_: &str, _: usize) -> io::Result<Vec<u8>> {
    Err(io::Error::new(io::ErrorKind::NotFound, "no other files are at hand"))
}

/// Reads `name` below `folder`, links resolved first: what lies elsewhere is not read.
///
/// # Errors
/// When the file is not there, lies outside of the folder, is no ordinary file, or has more than `most` bytes.
pub fn read_in_folder(folder: &Path, name: &str, most: usize) -> io::Result<Vec<u8>> {
    let refuse = |why: &str| io::Error::new(io::ErrorKind::InvalidInput, why);
    let folder = folder.canonicalize()?;
    let path = folder.join(name).canonicalize()?;
    if !path.starts_with(&folder) {
        return Err(refuse("it lies outside of the document's folder"));
    }
    // A pipe would be waited for.
    if !path.metadata()?.is_file() {
        return Err(refuse("it is no ordinary file"));
    }
    let mut bytes = Vec::new();
    File::open(path)?.take((most as u64).saturating_add(1)).read_to_end(&mut bytes)?;
    if bytes.len() > most { Err(refuse("it is too large")) } else { Ok(bytes) }
}
