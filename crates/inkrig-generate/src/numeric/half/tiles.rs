//! Products by the tile instructions of AMX (Xeons since 2023).
//!
//! Unsafe, because these instructions exist as assembly only. Every address that a tile is read from or written to lies in a buffer that
//! was made for whole tiles right before; the test compares each shape with the plain product.
#![allow(unsafe_code)]

use super::{BLOCK, DEPTH, SIDE};
use std::arch::asm;
use std::arch::x86_64::{__cpuid, __cpuid_count};

/// The system's call that lets a process use a part of the processor's state, and that of the tiles.
const ARCH_PRCTL: usize = 158;
const REQUEST: usize = 0x1023;
const TILE_DATA: usize = 18;

/// All eight tiles of 16 rows of 64 bytes.
#[repr(C, align(64))]
struct Configuration([u8; 64]);

static CONFIGURATION: Configuration = {
    let mut bytes = [0_u8; 64];
    bytes[0] = 1;
    let mut tile = 0;
    while tile < 8 {
        bytes[16 + 2 * tile] = 64;
        bytes[48 + tile] = SIDE as u8;
        tile += 1;
    }
    Configuration(bytes)
};

pub(super) fn request() -> bool {
    // Leaf 7 has both features; before it is asked for, leaf 0 says whether there is one.
    if __cpuid(0).eax < 7 || __cpuid(1).ecx >> 27 & 1 == 0 {
        return false;
    }
    let features = __cpuid_count(7, 0).edx;
    if features >> 22 & 1 == 0 || features >> 24 & 1 == 0 {
        return false;
    }
    let answer: isize;
    // SAFETY: the call changes nothing but what this process may use; registers that it overwrites are named.
    unsafe {
        asm!(
            "syscall",
            inlateout("rax") ARCH_PRCTL => answer,
            in("rdi") REQUEST,
            in("rsi") TILE_DATA,
            lateout("rcx") _,
            lateout("r11") _,
            options(nostack),
        );
    }
    answer == 0
}

/// Runs something with the tiles set up, and lets go of them after it.
pub(super) fn configured(run: impl FnOnce()) {
    // SAFETY: only called where `request` gave leave; the 64 bytes are a valid configuration.
    unsafe {
        asm!("ldtilecfg [{}]", in(reg) CONFIGURATION.0.as_ptr(), options(nostack, readonly));
    }
    run();
    // SAFETY: as above.
    unsafe {
        asm!("tilerelease", options(nostack, nomem));
    }
}

/// 32 rows of `deep` halves, as pairs, times a block of 32 columns, into `out`, row-major.
pub(super) fn block(rows: &[u32], tiles: &[u32], deep: usize, out: &mut [f32; BLOCK * BLOCK]) {
    assert!(
        deep > 0
            && deep.is_multiple_of(DEPTH)
            && rows.len() == BLOCK * deep / 2
            && tiles.len() == SIDE * deep
    );
    // SAFETY: the assertion says that both factors are whole blocks; each turn of the loop reads one tile column of 64
    // bytes from each of 32 rows, and 2 KiB of tiles. `out` takes four tiles. `configured` is around every call.
    unsafe {
        asm!(
            "tilezero tmm0",
            "tilezero tmm1",
            "tilezero tmm2",
            "tilezero tmm3",
            "2:",
            "tileloadd tmm4, [{upper} + {stride}]",
            "tileloadd tmm6, [{tiles} + {line}]",
            "tileloadd tmm7, [{tiles} + {line} + 1024]",
            "tileloadd tmm5, [{lower} + {stride}]",
            "tdpbf16ps tmm0, tmm4, tmm6",
            "tdpbf16ps tmm1, tmm4, tmm7",
            "tdpbf16ps tmm2, tmm5, tmm6",
            "tdpbf16ps tmm3, tmm5, tmm7",
            "add {upper}, 64",
            "add {lower}, 64",
            "add {tiles}, 2048",
            "dec {turns}",
            "jnz 2b",
            "tilestored [{out} + {wide}], tmm0",
            "tilestored [{out} + {wide} + 64], tmm1",
            "tilestored [{below} + {wide}], tmm2",
            "tilestored [{below} + {wide} + 64], tmm3",
            upper = inout(reg) rows.as_ptr() => _,
            lower = inout(reg) rows.as_ptr().add(SIDE * deep / 2) => _,
            tiles = inout(reg) tiles.as_ptr() => _,
            turns = inout(reg) deep / DEPTH => _,
            stride = in(reg) 2 * deep,
            line = in(reg) 64_usize,
            out = in(reg) out.as_mut_ptr(),
            below = in(reg) out.as_mut_ptr().add(SIDE * BLOCK),
            wide = in(reg) 4 * BLOCK,
            out("tmm0") _, out("tmm1") _, out("tmm2") _, out("tmm3") _,
            out("tmm4") _, out("tmm5") _, out("tmm6") _, out("tmm7") _,
            options(nostack),
        );
    }
}
