//! Waiting by the clock, never by a number of frames: on a busy machine a frame may take a minute, and a thread that loads a file
//! may not run for as long.

use std::time::{Duration, Instant};

/// How long anything is waited for. It only decides when a test that hangs is given up, so it is generous.
pub const PATIENCE: Duration = Duration::from_secs(300);
/// Attempts that are made however long they take: the first frame with a new shader is slow on a software renderer.
const ATTEMPTS: u32 = 100;

/// Repeats `step` until it returns something. Panics with `what` when the patience is at an end.
pub fn until<T>(what: &str, mut step: impl FnMut() -> Option<T>) -> T {
    let begun = Instant::now();
    let mut attempts = 0;
    loop {
        if let Some(found) = step() {
            return found;
        }
        attempts += 1;
        assert!(
            attempts < ATTEMPTS || begun.elapsed() < PATIENCE,
            "{what}: not there after {:?} and {attempts} attempts",
            begun.elapsed()
        );
        std::thread::sleep(Duration::from_millis(2));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slow_step_is_waited_for() {
        let mut left = 3;
        let found = until("three steps", || {
            left -= 1;
            (left == 0).then_some("there")
        });
        assert_eq!((found, left), ("there", 0));
    }
}
