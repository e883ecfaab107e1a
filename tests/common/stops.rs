//! Renders that are stopped before their end.

use std::ops::ControlFlow;
use std::time::Duration;

use etendue::Cancel;
use etendue::render::{Render, Summary};

/// Runs a render to its end while it is stopped again and again: first with its first report, then from outside after `delay`, and later
/// each time, so that it reaches its end. Returns the number of stops and the summary.
pub fn run_with_stops(render: &mut Render, delay: Duration) -> (u32, Summary) {
    for stops in 0.. {
        let cancel = Cancel::new();
        render.set_cancel(cancel.clone());
        let from_outside = cancel.clone();
        let stopper = (stops > 0).then(|| {
            std::thread::spawn(move || {
                std::thread::sleep(delay * (1 << (stops - 1)));
                from_outside.cancel();
            })
        });
        let summary = render
            .run(&mut |_| {
                if stops == 0 {
                    cancel.cancel();
                }
                ControlFlow::Continue(())
            })
            .unwrap();
        stopper.into_iter().for_each(|stopper| stopper.join().unwrap());
        if !summary.stopped {
            return (stops, summary);
        }
    }
    unreachable!("delays double until the render is done before")
}
