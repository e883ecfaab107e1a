//! Work on the rows of an image by several threads, which end with the work.

use std::thread;

/// What `row` gives for the rows 0 to `height` - 1, in order, computed by at most `threads` threads with the calling one. A thread
/// that the system does not give is done without.
pub(crate) fn rows<T: Send>(height: u32, threads: usize, row: impl Fn(u32) -> T + Sync) -> Vec<T> {
    let parts = (threads.clamp(1, 64) as u32).min(height).max(1);
    let part = |i: u32| {
        let bound = |i: u32| (u64::from(height) * u64::from(i) / u64::from(parts)) as u32;
        (bound(i)..bound(i + 1)).map(&row).collect::<Vec<T>>()
    };
    if parts == 1 {
        return part(0);
    }
    let part = &part;
    thread::scope(|scope| {
        let start =
            |i: u32| thread::Builder::new().name("etendue-rows".to_owned()).spawn_scoped(scope, move || part(i));
        let started: Vec<_> = (1..parts).map(|i| (i, start(i))).collect();
        let mut all = part(0);
        for (i, thread) in started {
            let values = match thread {
                Ok(thread) => thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)),
                Err(_) => part(i),
            };
            all.extend(values);
        }
        all
    })
}

#[cfg(test)]
mod tests {
    use super::rows;

    #[test]
    fn rows_come_in_order_whatever_the_threads() {
        for height in [0, 1, 2, 7, 100] {
            for threads in [0, 1, 2, 3, 1000] {
                let expected: Vec<u32> = (0..height).map(|y| y * y).collect();
                assert_eq!(rows(height, threads, |y| y * y), expected, "{height} rows, {threads} threads");
            }
        }
    }
}
