//! A build uses as many threads as it was allowed, whatever other devices of the process use.

#[cfg(target_os = "linux")]
mod linux {
    use std::collections::HashSet;
    use std::process::Command;
    use std::sync::Mutex;
    use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
    use std::thread::{self, ThreadId};
    use std::time::Duration;

    use etendue::embree::{Device, DeviceOptions, SceneBuilder, SceneOptions};

    use crate::build::terrain;

    const CHILD: &str = "ETENDUE_TEST_COUNT_THREADS";

    fn tasks() -> usize {
        std::fs::read_dir("/proc/self/task").map_or(0, Iterator::count)
    }

    /// Builds once. Returns the most threads beyond those there were, and the ids of those that built.
    fn build(device: &Device) -> (usize, HashSet<ThreadId>) {
        let mut builder = SceneBuilder::new(device, SceneOptions::default()).unwrap();
        builder.add_triangles(terrain(300)).unwrap();
        let builders = Mutex::new(HashSet::new());
        let report = |_: f64| {
            builders.lock().unwrap().insert(thread::current().id());
            true
        };
        let most = AtomicUsize::new(0);
        let done = AtomicBool::new(false);
        // The last build's counting thread may still be on its way out.
        thread::sleep(Duration::from_millis(10));
        let before = tasks();
        thread::scope(|scope| {
            scope.spawn(|| {
                while !done.load(Ordering::Acquire) {
                    most.fetch_max(tasks(), Ordering::Relaxed);
                    thread::sleep(Duration::from_micros(200));
                }
            });
            builder.commit(Some(&report)).unwrap();
            done.store(true, Ordering::Release);
        });
        // The one that counts is not the build's.
        (most.into_inner().saturating_sub(before + 1), builders.into_inner().unwrap())
    }

    /// Other tests start threads of their own, so the counting is done in a process that runs nothing else.
    #[test]
    fn a_build_keeps_to_its_threads() {
        if std::env::var_os(CHILD).is_none() {
            let exe = std::env::current_exe().unwrap();
            let output = Command::new(exe)
                .args(["--exact", "threads::linux::a_build_keeps_to_its_threads", "--nocapture", "--test-threads=1"])
                .env(CHILD, "1")
                .output()
                .unwrap();
            let text = [output.stdout, output.stderr].concat();
            let text = String::from_utf8_lossy(&text);
            assert!(output.status.success() && text.contains("1 passed"), "{text}");
            return;
        }
        let at_rest = tasks();
        let me = HashSet::from([thread::current().id()]);
        let one = Device::new(&DeviceOptions { threads: 1, ..DeviceOptions::default() }).unwrap();
        assert_eq!(build(&one), (0, me.clone()));

        // A device with more threads beside it uses them, and does not change what the first may use.
        let two = Device::new(&DeviceOptions { threads: 2, ..DeviceOptions::default() }).unwrap();
        let cores = thread::available_parallelism().unwrap().get();
        assert_eq!(two.threads(), 2.min(cores));
        let mut helped = false;
        for _ in 0..20 {
            let (added, builders) = build(&two);
            // The calling thread waits beside a large build, so one thread more is there; but none more works.
            assert!(added <= two.threads() && builders.len() <= two.threads(), "{added} new, {builders:?}");
            helped |= builders.len() == 2;
            assert_eq!(build(&one), (0, me.clone()));
        }
        assert_eq!(helped, two.threads() == 2, "two threads were allowed on {cores} cores");

        // All there are, of which no more are ever started than the last build may use.
        let all = Device::new(&DeviceOptions::default()).unwrap();
        assert_eq!(all.threads(), cores);
        let (_, builders) = build(&all);
        assert!(builders.len() <= cores);
        drop((two, all));
        assert_eq!(build(&one), (0, me));
        // A thread that was joined may take a moment to leave the list.
        let settled = (0..100).any(|_| {
            thread::sleep(Duration::from_millis(10));
            tasks() < at_rest + cores
        });
        assert!(settled, "{} threads stay, {at_rest} were there", tasks());
    }
}
