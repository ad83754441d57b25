//! Threads of the window. A page has a single thread: its jobs are futures that run between frames,
//! and a job that waits lets the next frame be drawn.

#[cfg(not(target_arch = "wasm32"))]
pub use native::{named, pause, start};
#[cfg(target_arch = "wasm32")]
pub use page::{named, pause, start, wait};

#[cfg(not(target_arch = "wasm32"))]
mod native {
    use std::{
        io,
        thread::{self, JoinHandle},
        time::Duration,
    };

    use pollster::FutureExt as _;

    /// Stack of a thread: a picture of many effects takes more than the 8 MiB of the main thread
    /// where nothing is optimized. What is not used takes no memory.
    const STACK_BYTES: usize = 16 << 20;

    /// A thread of this name that draws.
    pub fn named(name: &str) -> thread::Builder {
        thread::Builder::new()
            .name(name.into())
            .stack_size(STACK_BYTES)
    }

    /// Starts work on a thread of this name. What is returned waits for its end; there is nothing to
    /// wait for in a page.
    ///
    /// # Errors
    /// The system has no room for a thread.
    pub fn start<F: Future<Output = ()> + 'static>(
        name: &str,
        work: impl FnOnce() -> F + Send + 'static,
    ) -> io::Result<Option<JoinHandle<()>>> {
        named(name).spawn(move || work().block_on()).map(Some)
    }

    /// Waits so long.
    pub async fn pause(wait: Duration) {
        thread::sleep(wait);
    }
}

#[cfg(target_arch = "wasm32")]
mod page {
    use std::{io, thread::JoinHandle, time::Duration};

    use js_sys::{Function, Promise, Reflect};
    use wasm_bindgen::{JsCast as _, JsValue};
    use wasm_bindgen_futures::{JsFuture, spawn_local};

    /// A thread of this name, which a page cannot start.
    pub fn named(name: &str) -> std::thread::Builder {
        std::thread::Builder::new().name(name.into())
    }

    pub fn start<F: Future<Output = ()> + 'static>(
        _: &str,
        work: impl FnOnce() -> F + 'static,
    ) -> io::Result<Option<JoinHandle<()>>> {
        spawn_local(async move {
            // The frame that asked for it is shown first.
            pause(Duration::ZERO).await;
            work().await;
        });
        Ok(None)
    }

    pub async fn pause(wait: Duration) {
        let _ = JsFuture::from(self::wait(wait)).await;
    }

    /// Ends after so long.
    pub fn wait(wait: Duration) -> Promise {
        let ms = i32::try_from(wait.as_millis()).unwrap_or(i32::MAX);
        let mut begin = |resolve: Function, _: Function| {
            // Windows and workers both have `setTimeout`. Without it the promise would never resolve.
            let timeout = Reflect::get(&js_sys::global(), &"setTimeout".into());
            if let Some(timeout) = timeout.ok().and_then(|timeout| timeout.dyn_into().ok()) {
                let timeout: Function = timeout;
                let _ = timeout.call2(&JsValue::UNDEFINED, &resolve, &ms.into());
            }
        };
        Promise::new(&mut begin)
    }
}

/// What the future gives, or the panic that ended it.
pub async fn caught<T>(work: impl Future<Output = T>) -> std::thread::Result<T> {
    use std::{
        future::poll_fn,
        panic::{AssertUnwindSafe, catch_unwind},
        pin::pin,
        task::Poll,
    };
    let mut work = pin!(work);
    poll_fn(
        |context| match catch_unwind(AssertUnwindSafe(|| work.as_mut().poll(context))) {
            Ok(Poll::Pending) => Poll::Pending,
            Ok(Poll::Ready(done)) => Poll::Ready(Ok(done)),
            Err(panic) => Poll::Ready(Err(panic)),
        },
    )
    .await
}
