//! The network's layers.

use super::KEY_POINTS;
use crate::readers::network::{Plan, Shape, Value};

/// Pixels of a side of what the network sees.
pub const SIDE: usize = 160;
/// Paper around the ink, as a share of its longer side, on each side.
pub const MARGIN: f32 = 0.1;
/// Cells of a side of its heat maps.
pub const CELLS: usize = 40;

/// The tables that come out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Outputs {
    /// [`CELLS`] x [`CELLS`] x [`KEY_POINTS`]: how much speaks for a key point there, as logarithms.
    pub heat: Value,
    /// [`KEY_POINTS`]: whether it is drawn at all, as logits.
    pub presence: Value,
}

/// Cells of 4 pixels, then 20, 10 and 5 cells a side, and back up with what was seen on the way down. What is seen of each cell is
/// taken thrice from the paper: briefly for the way down, with twice the channels for where exactly a line ends or bends, and of
/// cells of 2 pixels for what is finer than that. Then all of it is looked at once more (`again`): with what was found, down to 20 and 10
/// cells and back up, which tells limbs apart.
pub fn plan() -> (Plan, Outputs) {
    let mut plan = Plan::new(Shape { height: SIDE, width: SIDE, channels: 1 });
    let a = plan.patch("stem", 0, [8, 8], [4, 4], [2, 2], 32);
    let a = plan.block("fine.0", a, 5, 64);
    let down = |plan: &mut Plan, name: &str, from, channels| {
        plan.patch(name, from, [2, 2], [2, 2], [0, 0], channels)
    };
    let blocks = |plan: &mut Plan, name: &str, from, kernel, hidden, which: std::ops::Range<usize>| {
        which.fold(from, |from, at| plan.block(&format!("{name}.{at}"), from, kernel, hidden))
    };
    let b = down(&mut plan, "down.0", a, 96);
    let b = blocks(&mut plan, "middle", b, 5, 192, 0..2);
    let c = down(&mut plan, "down.1", b, 128);
    let c = blocks(&mut plan, "coarse", c, 7, 384, 0..3);
    let d = down(&mut plan, "down.2", c, 192);
    let d = blocks(&mut plan, "whole", d, 5, 576, 0..2);
    let up = plan.join("up.0", d, c);
    let up = blocks(&mut plan, "coarse", up, 7, 384, 3..7);
    let up = plan.join("up.1", up, b);
    let middle = blocks(&mut plan, "middle", up, 7, 192, 2..6);
    let exact = plan.patch("exact.stem", 0, [8, 8], [4, 4], [2, 2], 64);
    let sharp = plan.patch("sharp.stem", 0, [4, 4], [2, 2], [1, 1], 16);
    let sharp = plan.block("sharp.0", sharp, 3, 32);
    let exact = plan.shrink("sharp.down", sharp, exact);
    let exact = plan.block("exact.0", exact, 5, 128);
    let up = plan.join("exact.up", middle, exact);
    let up = plan.block("exact.1", up, 7, 128);
    let up = plan.block("exact.2", up, 5, 128);
    let exact = plan.block("exact.3", up, 7, 128);
    let again = plan.shrink("again.down.0", exact, middle);
    let again = plan.block("again.middle.0", again, 7, 192);
    let whole = down(&mut plan, "again.down.1", again, 192);
    let whole = blocks(&mut plan, "again.coarse", whole, 7, 768, 0..4);
    let up = plan.join("again.up.0", whole, again);
    let up = blocks(&mut plan, "again.middle", up, 7, 192, 1..3);
    let up = plan.join("again.up.1", up, exact);
    let up = plan.block("again.exact.0", up, 7, 128);
    let up = plan.block("again.exact.1", up, 5, 128);
    let up = plan.norm("exact.norm", up);
    let heat = plan.linear("exact.heat", up, KEY_POINTS);
    let mean = plan.mean(d);
    let mean = plan.norm("presence.norm", mean);
    let presence = plan.linear("presence", mean, KEY_POINTS);
    (plan, Outputs { heat, presence })
}
