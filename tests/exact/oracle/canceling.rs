//! Canceled work of the oracle ends within a moment, whatever it is doing, and gives no picture.

use std::{
    sync::Arc,
    thread,
    time::{Duration, Instant},
};

use rasterlab::{
    effects::{Effect, EnabledEffect},
    preset::Preset,
    work::Work,
};

use super::*;

/// Runs work that takes minutes, cancels it, and holds that it ends. The limit is far above what is
/// promised to a person, since tests share the machine.
fn ends_when_canceled<T>(what: &str, after: Duration, work: impl FnOnce() -> T) {
    let shared = Arc::new(Work::default());
    let canceler = thread::spawn({
        let shared = shared.clone();
        move || {
            // Sleeps and asks for the real time: work is canceled in its middle and ends soon after.
            thread::sleep(after);
            shared.cancel();
            Instant::now()
        }
    });
    let result = shared.run(work);
    let canceled_at = canceler.join().expect("it only sleeps");
    assert!(result.is_none(), "{what}: canceled work gives a picture");
    let took = canceled_at.elapsed();
    assert!(
        took < Duration::from_secs(5),
        "{what}: {took:?} from canceling to the end"
    );
}

#[test]
fn a_canceled_picture_ends_at_its_next_row_or_triangle() {
    let scene = scene(&[sphere(64), ground(4.0, -1.2)]);
    let view = Preset::default().view(&scene, [6000, 6000]);
    let enabled = |name: &str| EnabledEffect::new(Effect::find(name).expect("an effect"));
    for names in [vec!["lambert"], vec!["shadow", "outline"], vec!["xray"]] {
        let stack = Stack(names.iter().map(|name| enabled(name)).collect());
        for after_ms in [5, 400] {
            let what = format!("{names:?} after {after_ms} ms");
            ends_when_canceled(&what, Duration::from_millis(after_ms), || {
                (0..100).try_for_each(|_| render(&scene, &view, &stack).map(drop))
            });
        }
    }
}

#[test]
fn canceled_references_end() {
    let scene = scene(&[sphere(64)]);
    let view = Preset::default().view(&scene, [4000, 4000]);
    ends_when_canceled(
        "references at several sizes",
        Duration::from_millis(200),
        || {
            oracle::references(&scene, &view, &Stack::default(), &[1.0, 2.0, 4.0])
                .map(|references| references.smooth.is_some())
        },
    );
}
