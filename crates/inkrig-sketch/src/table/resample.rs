//! Rows at other times: linear between the rows given.

/// Rows of `width` numbers at `frames` equal steps of their times, or of their number where there are no times.
pub(super) fn at_equal_steps(
    values: &[f64],
    width: usize,
    seconds: Option<&[f64]>,
    frames: usize,
) -> Vec<f64> {
    let rows = values.len() / width;
    let time = |row: usize| match seconds {
        Some(seconds) => seconds.get(row).copied().unwrap_or(0.0),
        None => row as f64,
    };
    let (last, total) = (rows.saturating_sub(1), time(rows.saturating_sub(1)));
    let mut out = Vec::with_capacity(frames * width);
    let mut row = 0;
    for frame in 0..frames {
        // In this order rows without times that become as many frames stay exactly as they are.
        let mut place = total * frame as f64 / (frames.max(2) - 1) as f64;
        // The last frame is the last row, whatever the rounding.
        if frame > 0 && frame + 1 == frames {
            (row, place) = (last, total);
        }
        while row < last && time(row + 1) < place {
            row += 1;
        }
        let (start, end) = (time(row), time((row + 1).min(last)));
        let part = if end > start { ((place - start) / (end - start)).clamp(0.0, 1.0) } else { 0.0 };
        out.extend(
            pair(values, width, row)
                .map(|(from, to)| if part < 1.0 { from + (to - from) * part } else { to }),
        );
    }
    out
}

/// The numbers of a row beside those of the next; the last row stands beside itself.
fn pair(values: &[f64], width: usize, row: usize) -> impl Iterator<Item = (f64, f64)> + '_ {
    let from = values.get(row * width..).unwrap_or_default();
    let to = from.get(width..).filter(|rest| !rest.is_empty()).unwrap_or(from);
    from.iter().copied().zip(to.iter().copied()).take(width)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_linear_and_ends_are_kept() {
        let rows = [0.0, 10.0, 2.0, 10.0, 2.0, 30.0];
        let five = at_equal_steps(&rows, 2, None, 5);
        assert_eq!(five, [0.0, 10.0, 1.0, 10.0, 2.0, 10.0, 2.0, 20.0, 2.0, 30.0]);
        assert_eq!(at_equal_steps(&rows, 2, None, 3), rows);
        let long: Vec<f64> = (0..1000).map(|row| f64::from(row) * 0.1).collect();
        assert!((2..=1000).all(|rows| at_equal_steps(&long[..rows], 1, None, rows) == long[..rows]));
        assert_eq!(at_equal_steps(&rows, 2, None, 2), [0.0, 10.0, 2.0, 30.0]);
        assert_eq!(at_equal_steps(&rows, 2, None, 1), [0.0, 10.0]);
    }

    #[test]
    fn times_are_followed_through_pauses_and_jumps() {
        let (values, seconds) = ([0.0, 4.0, 4.0, 8.0, 1.0], [0.0, 1.0, 3.0, 3.0, 4.0]);
        assert_eq!(at_equal_steps(&values, 1, Some(&seconds), 5), [0.0, 4.0, 4.0, 4.0, 1.0]);
        assert_eq!(at_equal_steps(&values, 1, Some(&seconds), 9)[7], 4.5, "half way down from the jump");
    }

    #[test]
    fn a_jump_at_the_end_is_reached() {
        assert_eq!(at_equal_steps(&[0.0, 1.0, 9.0], 1, Some(&[0.0, 1.0, 1.0]), 3), [0.0, 0.5, 9.0]);
        assert_eq!(at_equal_steps(&[5.0, 1.0, 9.0], 1, Some(&[0.0, 0.0, 1.0]), 3), [5.0, 5.0, 9.0]);
    }
}
