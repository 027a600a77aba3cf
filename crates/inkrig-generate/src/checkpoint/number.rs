//! The kinds of numbers that tensors are made of.

/// A kind of number. Networks compute in single precision; whole numbers are only counted, never read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NumberKind {
    /// Double precision.
    F64,
    /// Single precision.
    F32,
    /// Half precision.
    F16,
    /// The upper half of single precision.
    Bf16,
    /// Whole numbers of so many bytes, or truth values.
    Whole(u8),
}

impl NumberKind {
    /// Bytes of one.
    pub fn size(self) -> usize {
        match self {
            Self::F64 => 8,
            Self::F32 => 4,
            Self::F16 | Self::Bf16 => 2,
            Self::Whole(bytes) => bytes.into(),
        }
    }

    /// The nearest half precision number's bits.
    pub(crate) fn half(number: f32) -> u16 {
        to_half(number)
    }

    /// By its name in a safetensors header.
    pub(super) fn of_safetensors(name: &str) -> Option<Self> {
        Some(match name {
            "F64" => Self::F64,
            "F32" => Self::F32,
            "F16" => Self::F16,
            "BF16" => Self::Bf16,
            "I64" | "U64" => Self::Whole(8),
            "I32" | "U32" => Self::Whole(4),
            "I16" | "U16" => Self::Whole(2),
            "I8" | "U8" | "BOOL" => Self::Whole(1),
            _ => return None,
        })
    }

    /// Of a class of `torch`, such as `FloatStorage`.
    pub(super) fn of_storage(name: &str) -> Option<Self> {
        Some(match name {
            "DoubleStorage" => Self::F64,
            "FloatStorage" => Self::F32,
            "HalfStorage" => Self::F16,
            "BFloat16Storage" => Self::Bf16,
            "LongStorage" => Self::Whole(8),
            "IntStorage" => Self::Whole(4),
            "ShortStorage" => Self::Whole(2),
            "CharStorage" | "ByteStorage" | "BoolStorage" => Self::Whole(1),
            _ => return None,
        })
    }

    /// Whether these are the numbers of a weight.
    pub fn is_float(self) -> bool {
        !matches!(self, Self::Whole(_))
    }

    /// Adds the numbers of whole little-endian bytes; whole numbers are converted too.
    pub(super) fn decode(self, bytes: &[u8], out: &mut Vec<f32>) {
        match self {
            Self::F64 => {
                out.extend(bytes.as_chunks().0.iter().map(|bytes| f64::from_le_bytes(*bytes) as f32));
            }
            Self::F32 => out.extend(bytes.as_chunks().0.iter().map(|bytes| f32::from_le_bytes(*bytes))),
            Self::F16 => {
                out.extend(bytes.as_chunks().0.iter().map(|bytes| from_half(u16::from_le_bytes(*bytes))));
            }
            Self::Bf16 => {
                let wide = |bytes: &[u8; 2]| f32::from_bits(u32::from(u16::from_le_bytes(*bytes)) << 16);
                out.extend(bytes.as_chunks().0.iter().map(wide));
            }
            Self::Whole(8) => {
                out.extend(bytes.as_chunks().0.iter().map(|bytes| i64::from_le_bytes(*bytes) as f32));
            }
            Self::Whole(4) => {
                out.extend(bytes.as_chunks().0.iter().map(|bytes| i32::from_le_bytes(*bytes) as f32));
            }
            Self::Whole(2) => {
                out.extend(bytes.as_chunks().0.iter().map(|bytes| f32::from(i16::from_le_bytes(*bytes))));
            }
            Self::Whole(_) => out.extend(bytes.iter().map(|&byte| f32::from(byte))),
        }
    }
}

/// A half precision number (IEEE 754 binary16), exactly.
pub(super) fn from_half(bits: u16) -> f32 {
    let sign = u32::from(bits >> 15) << 31;
    let (exponent, fraction) = (u32::from(bits >> 10 & 0x1f), u32::from(bits & 0x3ff));
    match exponent {
        // 2^-24 is the step of the smallest ones.
        0 => f32::from_bits((fraction as f32 * 2.0_f32.powi(-24)).to_bits() | sign),
        31 => f32::from_bits(sign | 0x7f80_0000 | fraction << 13),
        _ => f32::from_bits(sign | (exponent + 112) << 23 | fraction << 13),
    }
}

/// The nearest half precision number, ties to even; beyond its range infinity.
pub fn to_half(number: f32) -> u16 {
    let bits = number.to_bits();
    let sign = (bits >> 16 & 0x8000) as u16;
    let size = bits & 0x7fff_ffff;
    if size > 0x7f80_0000 {
        return sign | 0x7e00;
    }
    if size < 0x3880_0000 {
        // Below the normal range: adding 0.5 leaves the steps of 2^-24 in the lowest bits, rounded to even.
        let shifted = f32::from_bits(size) + 0.5;
        return sign | (shifted.to_bits() - 0.5_f32.to_bits()) as u16;
    }
    let rounded = size + 0xfff + (size >> 13 & 1);
    sign | if rounded >= 0x4780_0000 { 0x7c00 } else { ((rounded - 0x3800_0000) >> 13) as u16 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_precision_goes_there_and_back() {
        for bits in 0..=u16::MAX {
            let number = from_half(bits);
            if !number.is_nan() {
                assert_eq!(to_half(number), bits, "{number}");
            }
        }
        assert_eq!(from_half(0x3c01), 1.000_976_6);
        assert_eq!(from_half(0x0001), 2.0_f32.powi(-24));
        // Half way between two neighbours: the even one.
        assert_eq!(to_half(1.0 + 2.0_f32.powi(-11)), 0x3c00);
        assert_eq!(to_half(1.0 + 3.0 * 2.0_f32.powi(-11)), 0x3c02);
        assert_eq!((to_half(65_519.0), to_half(65_520.0)), (0x7bff, 0x7c00));
        assert_eq!(to_half(2.0_f32.powi(-25)), 0);
        assert!(from_half(to_half(f32::NAN)).is_nan());
    }

    #[test]
    fn every_kind_is_read() {
        let mut out = Vec::new();
        NumberKind::F64.decode(&1.5_f64.to_le_bytes(), &mut out);
        NumberKind::F32.decode(&(-2.0_f32).to_le_bytes(), &mut out);
        NumberKind::F16.decode(&0x4200_u16.to_le_bytes(), &mut out);
        NumberKind::Bf16.decode(&0x4080_u16.to_le_bytes(), &mut out);
        NumberKind::Whole(8).decode(&(-5_i64).to_le_bytes(), &mut out);
        NumberKind::Whole(1).decode(&[6], &mut out);
        assert_eq!(out, [1.5, -2.0, 3.0, 4.0, -5.0, 6.0]);
    }
}
