//! Decimal numbers for people and for readers: as short as the wanted precision allows.

use std::io::Write;

/// Appends `value` with at most `decimals` decimals (0 to 12), without trailing zeros and without a negative zero.
pub(crate) fn push_decimal(out: &mut Vec<u8>, value: f64, decimals: u32) {
    let scaled = value * 10_f64.powi(decimals as i32);
    // Whole numbers of this size are exact in f64.
    if scaled.abs() < 9e15 {
        let rounded = scaled.round() as i64;
        push_scaled(out, rounded, decimals);
        return;
    }
    let start = out.len();
    // Writing to memory does not fail.
    let _ = write!(out, "{value:.*}", decimals as usize);
    if out.iter().skip(start).any(|&byte| byte == b'.') {
        while out.last() == Some(&b'0') {
            out.pop();
        }
        if out.last() == Some(&b'.') {
            out.pop();
        }
    }
}

/// Appends `number` / 10^`decimals`, digit by digit from the last.
fn push_scaled(out: &mut Vec<u8>, number: i64, decimals: u32) {
    let (mut left, mut places) = (number.unsigned_abs(), decimals);
    while places > 0 && left.is_multiple_of(10) {
        left /= 10;
        places -= 1;
    }
    let start = out.len();
    if places > 0 {
        for _ in 0..places {
            out.push(b'0' + (left % 10) as u8);
            left /= 10;
        }
        out.push(b'.');
    }
    loop {
        out.push(b'0' + (left % 10) as u8);
        left /= 10;
        if left == 0 {
            break;
        }
    }
    if number < 0 {
        out.push(b'-');
    }
    out.get_mut(start..).unwrap_or_default().reverse();
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let cases = [
            (0.0, "0"),
            (-0.0, "0"),
            (-1e-9, "0"),
            (1.0, "1"),
            (100.0, "100"),
            (-0.5, "-0.5"),
            (0.008_333_3, "0.008333"),
            (-12.340_000_4, "-12.34"),
            (123_456_789_012_345.0, "123456789012345"),
            (0.999_999_9, "1"),
        ];
        for (value, text) in cases {
            let mut out = b" ".to_vec();
            push_decimal(&mut out, value, 6);
            assert_eq!(String::from_utf8(out).unwrap(), format!(" {text}"));
        }
    }
}
