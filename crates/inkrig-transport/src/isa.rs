use std::sync::OnceLock;

/// The instruction level of the solvers and of [`row_softmax`](crate::row_softmax). Results are the same on every run at one
/// level; between levels they may differ in the last bits. [`matmul`](crate::matmul) and its like are the `gemm` crate's,
/// which always takes the processor's best.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Isa {
    /// What every processor of the target has.
    Portable,
    /// x86-64 with AVX2 and FMA.
    Avx2,
    /// x86-64 with AVX-512 (F, VL, DQ, BW).
    Avx512,
}

impl Isa {
    /// All levels, lowest first.
    pub const ALL: [Self; 3] = [Self::Portable, Self::Avx2, Self::Avx512];

    /// The level in use, found once per process: the best the processor has, or the one that the environment variable
    /// `INKRIG_ISA` names (`portable`, `avx2` or `avx512`). A level the processor lacks falls to the best one below it; an
    /// unknown name is ignored.
    pub fn current() -> Self {
        static CURRENT: OnceLock<Isa> = OnceLock::new();
        *CURRENT.get_or_init(|| {
            let asked = std::env::var("INKRIG_ISA").ok();
            Self::choose(asked.as_deref(), Self::detect())
        })
    }

    /// The best level this processor has.
    pub fn detect() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            let avx2 = is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma");
            let avx512 = is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512vl")
                && is_x86_feature_detected!("avx512dq")
                && is_x86_feature_detected!("avx512bw");
            if avx2 && avx512 {
                return Self::Avx512;
            }
            if avx2 {
                return Self::Avx2;
            }
        }
        Self::Portable
    }

    /// The name `INKRIG_ISA` takes.
    pub fn name(self) -> &'static str {
        match self {
            Self::Portable => "portable",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        }
    }

    /// The level of that name, in any case of letters.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|isa| isa.name().eq_ignore_ascii_case(name.trim()))
    }

    fn choose(asked: Option<&str>, best: Self) -> Self {
        asked.and_then(Self::from_name).map_or(best, |isa| isa.min(best))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_asked_level_never_exceeds_the_processor() {
        assert_eq!(Isa::choose(None, Isa::Avx2), Isa::Avx2);
        assert_eq!(Isa::choose(Some("avx512"), Isa::Avx2), Isa::Avx2);
        assert_eq!(Isa::choose(Some("Portable "), Isa::Avx512), Isa::Portable);
        assert_eq!(Isa::choose(Some("sse9"), Isa::Avx512), Isa::Avx512);
        assert_eq!(Isa::choose(Some("avx2"), Isa::Portable), Isa::Portable);
    }
}
