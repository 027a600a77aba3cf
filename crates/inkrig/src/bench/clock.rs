//! Time that a piece of work takes.

use serde::Serialize;
use std::time::Instant;

/// A clock that runs since it was made.
#[derive(Debug, Clone, Copy)]
pub struct Clock {
    wall: Instant,
    cpu: Option<f64>,
}

/// What some work took.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Spent {
    /// Seconds that all threads of this process computed; `None` where the system does not tell. Other processes that
    /// want the same processor do not count.
    pub cpu_seconds: Option<f64>,
    /// Seconds on the wall.
    pub wall_seconds: f64,
}

impl Clock {
    /// Starts.
    pub fn start() -> Self {
        Self { cpu: cpu_seconds(), wall: Instant::now() }
    }

    /// What was spent since the start.
    pub fn spent(&self) -> Spent {
        let wall_seconds = self.wall.elapsed().as_secs_f64();
        let cpu_seconds = self.cpu.zip(cpu_seconds()).map(|(begin, end)| end - begin);
        Spent { cpu_seconds, wall_seconds }
    }
}

impl Spent {
    /// The least of both, each for itself: what a quiet machine would have taken.
    pub fn least(self, other: Self) -> Self {
        let cpu_seconds = match (self.cpu_seconds, other.cpu_seconds) {
            (Some(a), Some(b)) => Some(a.min(b)),
            (a, b) => a.or(b),
        };
        Self { cpu_seconds, wall_seconds: self.wall_seconds.min(other.wall_seconds) }
    }
}

#[cfg(unix)]
fn cpu_seconds() -> Option<f64> {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Some(time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9)
}

#[cfg(not(unix))]
fn cpu_seconds() -> Option<f64> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sleeping_takes_wall_time_only() {
        let clock = Clock::start();
        std::thread::sleep(std::time::Duration::from_millis(60));
        let spent = clock.spent();
        assert!(spent.wall_seconds >= 0.06);
        // Other tests of this process may compute meanwhile, so only what must hold is said.
        assert!(spent.cpu_seconds.is_none_or(|cpu| cpu >= 0.0));
        let less = Spent { cpu_seconds: Some(1.0), wall_seconds: 0.01 };
        assert_eq!(less.least(spent).wall_seconds, 0.01);
    }
}
