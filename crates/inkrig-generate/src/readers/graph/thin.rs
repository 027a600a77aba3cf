//! Lines of any width become lines of one pixel (Zhang and Suen 1984).

/// Thins in place: rows of `width` pixels. What touches the border is taken away; less than a row stays as it is.
pub fn thin(lines: &mut [bool], width: usize) {
    if width == 0 || lines.len() < width {
        return;
    }
    let height = lines.len() / width;
    // The border has no neighbours to judge by.
    for (at, line) in lines.iter_mut().enumerate() {
        let (x, y) = (at % width, at / width);
        *line &= x > 0 && y > 0 && x + 1 < width && y + 1 < height;
    }
    loop {
        let mut changed = false;
        for second in [false, true] {
            let taken: Vec<usize> =
                (0..lines.len()).filter(|&at| lines[at] && removable(lines, width, at, second)).collect();
            changed |= !taken.is_empty();
            for at in taken {
                lines[at] = false;
            }
        }
        if !changed {
            return;
        }
    }
}

fn removable(lines: &[bool], width: usize, at: usize, second: bool) -> bool {
    // Above, then round to the right.
    let around = [
        at - width,
        at - width + 1,
        at + 1,
        at + width + 1,
        at + width,
        at + width - 1,
        at - 1,
        at - width - 1,
    ]
    .map(|at| lines[at]);
    let count = around.iter().filter(|line| **line).count();
    let rises = (0..8).filter(|&at| !around[at] && around[(at + 1) % 8]).count();
    if !(2..=6).contains(&count) || rises != 1 {
        return false;
    }
    let [up, right, down, left] = [around[0], around[2], around[4], around[6]];
    // On one pass what stands out below and to the right, on the other what stands out above and to the left.
    if second { !(up && left && (right || down)) } else { !(right && down && (up || left)) }
}
