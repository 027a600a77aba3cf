//! NumPy's files of one table: only plain tables of numbers.

use super::{CheckpointError, NumberKind};

const MAGIC: &[u8] = b"\x93NUMPY";
/// Bytes of a file of statistics: a hundred times what there is to say.
pub const MOST_NPY_BYTES: usize = 1 << 20;

/// Reads a table: its shape, and its numbers row by row. `name` stands in messages.
///
/// # Errors
/// [`CheckpointError::Npy`] for anything but finite `f4` and `f8` numbers, of at most 4 axes, in C order, of at most 1 MiB.
pub fn read_npy(bytes: &[u8], name: &str) -> Result<(Vec<usize>, Vec<f32>), CheckpointError> {
    if bytes.len() > MOST_NPY_BYTES {
        let what = "is larger than a megabyte: it holds no statistics".into();
        return Err(CheckpointError::Npy { name: name.into(), what });
    }
    read_table(bytes, name)
}

/// The same of a table of any size: what it needs is at most what `bytes` has.
///
/// # Errors
/// As for [`read_npy`], but for the size.
pub fn read_table(bytes: &[u8], name: &str) -> Result<(Vec<usize>, Vec<f32>), CheckpointError> {
    let (kind, shape, data) = parts(bytes, name)?;
    let wrong = |what: &str| CheckpointError::Npy { name: name.into(), what: what.into() };
    if !kind.is_float() {
        return Err(wrong("holds something other than f4 or f8 numbers"));
    }
    let mut out = Vec::with_capacity(data.len() / kind.size());
    kind.decode(data, &mut out);
    if out.iter().any(|number| !number.is_finite()) {
        return Err(wrong("holds what is no finite number"));
    }
    Ok((shape, out))
}

/// Reads a single number, which may be a whole one.
///
/// # Errors
/// [`CheckpointError::Npy`] for anything else.
pub(super) fn read_number(bytes: &[u8], name: &str) -> Result<f32, CheckpointError> {
    let (kind, shape, data) = parts(bytes, name)?;
    let mut out = Vec::new();
    if shape.iter().product::<usize>() == 1 {
        kind.decode(data, &mut out);
    }
    match out[..] {
        [number] if number.is_finite() => Ok(number),
        _ => Err(CheckpointError::Npy { name: name.into(), what: "is no single finite number".into() }),
    }
}

/// The kind of a table's numbers, its shape, and its bytes, which are as many as the shape says.
fn parts<'a>(bytes: &'a [u8], name: &str) -> Result<(NumberKind, Vec<usize>, &'a [u8]), CheckpointError> {
    let wrong = |what: &str| CheckpointError::Npy { name: name.into(), what: what.into() };
    let cut = || wrong("is cut off");
    let rest = bytes.strip_prefix(MAGIC).ok_or_else(|| wrong("is no NumPy file"))?;
    let (&[version, _], rest) = rest.split_first_chunk::<2>().ok_or_else(cut)?;
    let (length, rest) = if version == 1 {
        let (length, rest) = rest.split_first_chunk().ok_or_else(cut)?;
        (usize::from(u16::from_le_bytes(*length)), rest)
    } else {
        let (length, rest) = rest.split_first_chunk().ok_or_else(cut)?;
        (u32::from_le_bytes(*length) as usize, rest)
    };
    let (header, data) = rest.split_at_checked(length).ok_or_else(cut)?;
    let header = str::from_utf8(header).map_err(|_| wrong("has a header that is no text"))?;
    let descr = field(header, "'descr':").and_then(|text| text.strip_prefix('\''));
    let kind = match descr.and_then(|text| text.split_once('\'')).map(|(kind, _)| kind) {
        Some("<f4") => NumberKind::F32,
        Some("<f8") => NumberKind::F64,
        Some("<i8" | "<u8") => NumberKind::Whole(8),
        Some("<i4" | "<u4") => NumberKind::Whole(4),
        Some("<i2" | "<u2") => NumberKind::Whole(2),
        Some("|u1") => NumberKind::Whole(1),
        _ => return Err(wrong("holds something other than f4 or f8 numbers")),
    };
    if !field(header, "'fortran_order':").is_some_and(|text| text.starts_with("False")) {
        return Err(wrong("is in Fortran's order: save it by numpy.ascontiguousarray"));
    }
    let no_shape = || wrong("has no shape");
    let shape = field(header, "'shape':").and_then(|text| text.strip_prefix('('));
    let (shape, _) = shape.and_then(|text| text.split_once(')')).ok_or_else(no_shape)?;
    let axes = shape.split(',').map(str::trim).filter(|axis| !axis.is_empty()).take(5);
    let shape: Vec<usize> = axes.map(str::parse).collect::<Result<_, _>>().map_err(|_| no_shape())?;
    let numbers = shape.iter().try_fold(kind.size(), |product, &length| product.checked_mul(length));
    if shape.len() > 4 || numbers != Some(data.len()) {
        return Err(wrong("has other numbers than its shape says"));
    }
    Ok((kind, shape, data))
}

/// What follows a key of the header.
fn field<'a>(header: &'a str, key: &str) -> Option<&'a str> {
    header.split_once(key).map(|(_, rest)| rest.trim_start())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn npy(header: &str, data: &[u8]) -> Vec<u8> {
        let mut bytes = [MAGIC, &[1, 0], &(header.len() as u16).to_le_bytes()].concat();
        bytes.extend_from_slice(header.as_bytes());
        bytes.extend_from_slice(data);
        bytes
    }

    #[test]
    fn tables_are_read_and_all_else_is_refused() {
        let numbers: Vec<u8> = [1.0_f32, 2.0, 3.5].iter().flat_map(|x| x.to_le_bytes()).collect();
        let good = "{'descr': '<f4', 'fortran_order': False, 'shape': (3,), }          \n";
        assert_eq!(read_npy(&npy(good, &numbers), "Mean.npy").unwrap(), (vec![3], vec![1.0, 2.0, 3.5]));
        for (header, data, said) in [
            (good.replace("(3,)", "(2, 2)"), &numbers[..], "other numbers than its shape"),
            (good.replace("(3,)", "(99999999999999999999,)"), &numbers, "no shape"),
            (good.replace("(3,)", "(4294967296, 4294967296)"), &numbers, "other numbers"),
            (good.replace("'<f4'", "'|O'"), &numbers, "other than f4 or f8"),
            (good.replace("'<f4'", "'<i4'"), &numbers, "other than f4 or f8"),
            (good.replace("False", "True"), &numbers, "Fortran"),
            (good.to_owned(), &numbers[..11], "other numbers"),
            (good.replace("(3,)", "(1,)"), &f32::NAN.to_le_bytes(), "finite"),
        ] {
            let error = read_npy(&npy(&header, data), "Mean.npy").unwrap_err().to_string();
            assert!(error.starts_with("Mean.npy ") || error.starts_with("Mean.npy: "), "{error}");
            assert!(error.contains(said), "{error}");
        }
        assert!(read_npy(b"\x93NUMPY\x01\x00\xff", "x").unwrap_err().to_string().contains("cut off"));
        assert!(read_npy(b"PK", "x").is_err());
        let one = good.replace("(3,)", "()").replace("<f4", "<i8");
        assert_eq!(read_number(&npy(&one, &120_i64.to_le_bytes()), "fps").unwrap(), 120.0);
        assert!(read_number(&npy(good, &numbers), "fps").unwrap_err().to_string().contains("single"));
    }
}
