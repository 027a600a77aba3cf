//! What a table was measured on.

use inkrig_transport::Isa;
use serde::Serialize;

/// What decides times, and the last bits of results.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Machine {
    /// Program and version.
    pub program: &'static str,
    /// Operating system and processor family.
    pub system: String,
    /// Processor cores that this process may use.
    pub cores: usize,
    /// Threads that align was given.
    pub threads: usize,
    /// The instruction set that the solver uses.
    pub instruction_set: &'static str,
}

impl Machine {
    /// This machine, with align on that many threads.
    pub fn this(threads: usize) -> Self {
        Self {
            program: concat!("inkrig ", env!("CARGO_PKG_VERSION")),
            system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            cores: std::thread::available_parallelism().map_or(1, std::num::NonZero::get),
            threads,
            instruction_set: Isa::current().name(),
        }
    }
}

impl std::fmt::Display for Machine {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { program, system, cores, threads, instruction_set } = self;
        write!(f, "{program}, {system}, {cores} cores, {threads} threads, {instruction_set}")
    }
}
