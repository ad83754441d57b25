//! The compiled pipelines of a device, by their text.

use std::{
    collections::HashMap,
    sync::{
        Arc, Mutex, MutexGuard,
        atomic::{AtomicU64, Ordering},
    },
};

use super::error::RenderError;
use crate::{
    layout::ResourceId,
    shader::{
        link::Linked,
        reflect::{self, Binding},
    },
};

/// A compute pipeline that knows what its kernel binds.
pub struct Pipeline {
    pub label: String,
    pub pipeline: wgpu::ComputePipeline,
    pub layout: wgpu::BindGroupLayout,
    /// Binding numbers with what is bound there.
    pub bindings: Vec<(u32, ResourceId)>,
    /// When it was asked for last, by the store's own count.
    pub used: AtomicU64,
}

/// Interfaces that are kept, with a text of some 30 KB each.
const MOST_INTERFACES: usize = 512;

/// What tells one pipeline from another: its text, in which constants have their values.
#[derive(Clone, PartialEq, Eq, Hash)]
pub struct Identity {
    pub text: String,
    pub entry: String,
    /// Compiled without the checks that the compiler adds.
    pub is_trusted: bool,
}

/// What a pipeline needs to know of its text: the names of its overrides, and what its entry point
/// binds.
pub struct Interface {
    pub overrides: Vec<String>,
    pub bindings: Vec<Binding>,
}

/// The compiled pipelines of a device. All renderers on it share them, so that one with other
/// shaders compiles only what differs.
#[derive(Default)]
pub struct PipelineStore {
    state: Mutex<StoreState>,
    /// Counts what was asked for.
    clock: AtomicU64,
}

#[derive(Default)]
struct StoreState {
    built: HashMap<Identity, Arc<Pipeline>>,
    /// By text and entry point.
    interfaces: HashMap<(String, String), Arc<Interface>>,
}

impl PipelineStore {
    fn state(&self) -> MutexGuard<'_, StoreState> {
        self.state
            .lock()
            .unwrap_or_else(|poisoned| poisoned.into_inner())
    }

    pub fn find(&self, identity: &Identity) -> Option<Arc<Pipeline>> {
        self.state().built.get(identity).cloned()
    }

    /// Stores a compiled pipeline, or returns the one that another renderer stored in the meantime.
    /// Above `most` pipelines, the half that was not asked for longest is dropped.
    pub fn keep(&self, identity: Identity, pipeline: Pipeline, most: usize) -> Arc<Pipeline> {
        let mut state = self.state();
        if state.built.len() >= most {
            let used = |pipeline: &Arc<Pipeline>| pipeline.used.load(Ordering::Relaxed);
            let mut times: Vec<u64> = state.built.values().map(used).collect();
            let (_, &mut median, _) = times.select_nth_unstable(most / 2);
            state.built.retain(|_, pipeline| used(pipeline) >= median);
        }
        state
            .built
            .entry(identity)
            .or_insert_with(|| Arc::new(pipeline))
            .clone()
    }

    /// The interface of an entry point.
    pub fn interface(
        &self,
        linked: &Linked,
        entry: &str,
        has_int64: bool,
    ) -> Result<Arc<Interface>, RenderError> {
        let name = (linked.text.clone(), entry.to_owned());
        if let Some(interface) = self.state().interfaces.get(&name) {
            return Ok(interface.clone());
        }
        let reflected = reflect::reflect(linked, has_int64)?;
        let interface = Arc::new(Interface {
            overrides: reflected.overrides(),
            bindings: reflected.bindings(entry),
        });
        let mut state = self.state();
        if state.interfaces.len() >= MOST_INTERFACES {
            state.interfaces.clear();
        }
        Ok(state.interfaces.entry(name).or_insert(interface).clone())
    }

    /// Notes that a pipeline is in use, so that others are dropped before it.
    pub fn mark(&self, pipeline: &Pipeline) {
        pipeline.used.store(
            self.clock.fetch_add(1, Ordering::Relaxed) + 1,
            Ordering::Relaxed,
        );
    }
}
