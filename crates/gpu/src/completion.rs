//! Completion of submitted work. Natively a device goes on while a thread polls it, so that these functions block: the only ones here that
//! do. In a page the browser drives the device, and they give the thread back until it calls.

#[cfg(not(target_arch = "wasm32"))]
pub use native::{idle, mapped};
#[cfg(target_arch = "wasm32")]
pub use page::{idle, mapped};

#[cfg(not(target_arch = "wasm32"))]
mod native {
    use std::time::Duration;

    use crate::{device::Gpu, error::RenderError};

    /// A device that does not answer for so long counts as lost: software adapters have no watchdog.
    const PATIENCE: Duration = Duration::from_secs(60);

    /// Returns when the queue is idle.
    ///
    /// # Errors
    /// When the device is lost.
    pub async fn idle(gpu: &Gpu) -> Result<(), RenderError> {
        match gpu.device.poll(wgpu::PollType::Wait { submission_index: None, timeout: Some(PATIENCE) }) {
            Ok(_) if !gpu.is_lost() => Ok(()),
            _ => Err(RenderError::Lost),
        }
    }

    /// Returns when `staging` can be read.
    ///
    /// # Errors
    /// When the device is lost.
    pub async fn mapped(gpu: &Gpu, staging: &wgpu::Buffer) -> Result<(), RenderError> {
        staging.map_async(wgpu::MapMode::Read, .., |_| {});
        idle(gpu).await
    }
}

#[cfg(target_arch = "wasm32")]
mod page {
    use std::{
        pin::Pin,
        sync::{Arc, Mutex, PoisonError},
        task::{Context, Poll, Waker},
    };

    use crate::{device::Gpu, error::RenderError};

    /// Returns when the queue is idle.
    ///
    /// # Errors
    /// When the device is lost.
    pub async fn idle(gpu: &Gpu) -> Result<(), RenderError> {
        let done = Callback::default();
        let called = done.clone();
        gpu.queue.on_submitted_work_done(move || called.call());
        done.await;
        if gpu.is_lost() { Err(RenderError::Lost) } else { Ok(()) }
    }

    /// Returns when `staging` can be read.
    ///
    /// # Errors
    /// When the device is lost.
    pub async fn mapped(gpu: &Gpu, staging: &wgpu::Buffer) -> Result<(), RenderError> {
        let done = Callback::default();
        let called = done.clone();
        staging.map_async(wgpu::MapMode::Read, .., move |_| called.call());
        done.await;
        if gpu.is_lost() { Err(RenderError::Lost) } else { Ok(()) }
    }

    /// A callback of the browser as a future.
    #[derive(Clone, Default)]
    struct Callback(Arc<Mutex<State>>);

    #[derive(Default)]
    struct State {
        is_called: bool,
        waker: Option<Waker>,
    }

    impl Callback {
        fn call(&self) {
            let mut state = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            state.is_called = true;
            state.waker.take().into_iter().for_each(Waker::wake);
        }
    }

    impl Future for Callback {
        type Output = ();

        fn poll(self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<()> {
            let mut state = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            if state.is_called {
                return Poll::Ready(());
            }
            state.waker = Some(context.waker().clone());
            Poll::Pending
        }
    }
}
