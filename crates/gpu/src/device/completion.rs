//! Completion of submitted work. Natively a device goes on while a thread polls it, so that these
//! functions block: the only ones here that do. In a page the browser drives the device, and they
//! give the thread back until it calls.

#[cfg(not(target_arch = "wasm32"))]
pub use native::{Mapping, idle};
#[cfg(target_arch = "wasm32")]
pub use page::{Mapping, idle};

#[cfg(not(target_arch = "wasm32"))]
mod native {
    use std::{
        sync::{
            Arc,
            atomic::{AtomicBool, Ordering},
        },
        time::Duration,
    };

    use crate::device::{adapter::Gpu, error::RenderError};

    /// A card that does not answer for so long counts as lost.
    const PATIENCE: Duration = Duration::from_secs(60);
    /// The same of a software adapter, which has no watchdog, and which may share a busy processor
    /// while it draws a large picture.
    const SOFTWARE_PATIENCE: Duration = Duration::from_secs(600);

    /// Returns when the queue is idle.
    pub async fn idle(gpu: &Gpu) -> Result<(), RenderError> {
        let patience = if gpu.summary.software {
            SOFTWARE_PATIENCE
        } else {
            PATIENCE
        };
        match gpu.device.poll(wgpu::PollType::Wait {
            submission_index: None,
            timeout: Some(patience),
        }) {
            Ok(_) if !gpu.is_lost() => Ok(()),
            _ => Err(RenderError::Lost),
        }
    }

    /// A buffer that is being mapped to be read.
    pub struct Mapping(Arc<AtomicBool>);

    impl Mapping {
        /// Asks for a buffer, after what writes it was submitted.
        pub fn begin(staging: &wgpu::Buffer) -> Self {
            let ready = Arc::<AtomicBool>::default();
            let called = ready.clone();
            staging.map_async(wgpu::MapMode::Read, .., move |result| {
                called.store(result.is_ok(), Ordering::Release)
            });
            Self(ready)
        }

        /// Can it be read? True some time after it can, and only while a thread polls the device.
        pub fn is_ready(&self) -> bool {
            self.0.load(Ordering::Acquire)
        }

        /// Returns when it can be read.
        pub async fn ready(&self, gpu: &Gpu) -> Result<(), RenderError> {
            idle(gpu).await
        }
    }
}

#[cfg(target_arch = "wasm32")]
mod page {
    use std::{
        future::poll_fn,
        sync::{Arc, Mutex, MutexGuard, PoisonError},
        task::{Poll, Waker},
    };

    use crate::device::{adapter::Gpu, error::RenderError};

    /// Returns when the queue is idle.
    pub async fn idle(gpu: &Gpu) -> Result<(), RenderError> {
        let done = Callback::default();
        let called = done.clone();
        gpu.queue.on_submitted_work_done(move || called.call(true));
        done.called(gpu).await
    }

    /// A buffer that is being mapped to be read.
    pub struct Mapping(Callback);

    impl Mapping {
        /// Asks for a buffer, after what writes it was submitted.
        pub fn begin(staging: &wgpu::Buffer) -> Self {
            let ready = Callback::default();
            let called = ready.clone();
            staging.map_async(wgpu::MapMode::Read, .., move |result| {
                called.call(result.is_ok())
            });
            Self(ready)
        }

        /// Can it be read?
        pub fn is_ready(&self) -> bool {
            self.0.state().is_good == Some(true)
        }

        /// Returns when it can be read.
        pub async fn ready(&self, gpu: &Gpu) -> Result<(), RenderError> {
            self.0.called(gpu).await
        }
    }

    /// What the browser will call.
    #[derive(Clone, Default)]
    struct Callback(Arc<Mutex<State>>);

    #[derive(Default)]
    struct State {
        /// With what it was called.
        is_good: Option<bool>,
        waker: Option<Waker>,
    }

    impl Callback {
        fn state(&self) -> MutexGuard<'_, State> {
            self.0.lock().unwrap_or_else(PoisonError::into_inner)
        }

        fn call(&self, is_good: bool) {
            let mut state = self.state();
            state.is_good = Some(is_good);
            state.waker.take().into_iter().for_each(Waker::wake);
        }

        async fn called(&self, gpu: &Gpu) -> Result<(), RenderError> {
            let is_good = poll_fn(|context| {
                let mut state = self.state();
                match state.is_good {
                    Some(is_good) => Poll::Ready(is_good),
                    None => {
                        state.waker = Some(context.waker().clone());
                        Poll::Pending
                    }
                }
            });
            if is_good.await && !gpu.is_lost() {
                Ok(())
            } else {
                Err(RenderError::Lost)
            }
        }
    }
}
