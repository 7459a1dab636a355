//! A machine with other work to do.

use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

/// Busy threads for each core.
const BUSY: usize = 2;

/// Does some work while two threads for each core are busy.
pub fn under_load<T>(work: impl FnOnce() -> T) -> T {
    let busy = AtomicBool::new(true);
    let count = BUSY * thread::available_parallelism().map_or(1, usize::from);
    thread::scope(|scope| {
        for _ in 0..count {
            scope.spawn(|| {
                while busy.load(Ordering::Relaxed) {
                    std::hint::spin_loop();
                }
            });
        }
        let result = work();
        busy.store(false, Ordering::Relaxed);
        result
    })
}
