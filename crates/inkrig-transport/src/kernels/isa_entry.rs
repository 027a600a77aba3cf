// A function compiled for AVX is unsafe to call on a processor without it; this file makes sure, once, that it has it.
#![allow(unsafe_code)]

use super::Kernel;
use crate::Isa;

pub(super) fn run<K: Kernel>(isa: Isa, kernel: K) -> K::Output {
    match isa {
        #[cfg(target_arch = "x86_64")]
        Isa::Avx512 => {
            debug_assert!(Isa::detect() >= isa);
            // SAFETY: an `Isa` above what `Isa::detect` reported is never made outside tests' `Isa::ALL`, which filter by
            // it, so the processor has these instructions.
            unsafe { avx512(kernel) }
        }
        #[cfg(target_arch = "x86_64")]
        Isa::Avx2 => {
            debug_assert!(Isa::detect() >= isa);
            // SAFETY: as above.
            unsafe { avx2(kernel) }
        }
        _ => portable(kernel),
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx512dq,avx512bw,avx2,fma")]
fn avx512<K: Kernel>(kernel: K) -> K::Output {
    kernel.run::<true>()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn avx2<K: Kernel>(kernel: K) -> K::Output {
    kernel.run::<true>()
}

fn portable<K: Kernel>(kernel: K) -> K::Output {
    // Without hardware FMA `mul_add` is a slow library call; 64-bit Arm always has it.
    kernel.run::<{ cfg!(target_arch = "aarch64") }>()
}
