//! An address as a code for a camera, in half blocks of text.

use qrcodegen::{QrCode, QrCodeEcc};

/// Border of a code, as cameras want it.
const BORDER: i32 = 2;

/// Dark on light, whatever the terminal's colours are.
pub(super) fn code(text: &str) -> String {
    let Ok(code) = QrCode::encode_text(text, QrCodeEcc::Low) else { return String::new() };
    let size = code.size();
    let mut out = String::new();
    for row in (-BORDER..size + BORDER).step_by(2) {
        out.push_str("\x1b[30;47m");
        for column in -BORDER..size + BORDER {
            out.push(match (code.get_module(column, row), code.get_module(column, row + 1)) {
                (true, true) => '█',
                (true, false) => '▀',
                (false, true) => '▄',
                (false, false) => ' ',
            });
        }
        out.push_str("\x1b[0m\n");
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_code_has_a_border_and_a_corner() {
        let text = code("http://192.168.178.20:4747/?token=0123456789abcdef0123456789abcdef");
        let lines: Vec<&str> = text.lines().collect();
        assert!(lines[0].trim_start_matches("\x1b[30;47m").starts_with("    "), "{text}");
        // The finder in the corner: seven dark modules.
        assert!(lines[1].contains("  █▀▀▀▀▀█ "), "{text}");
    }
}
