//! STUB: the lead is writing this; signatures hold.
pub mod bench;
pub mod device;
use std::sync::Arc;
pub use device::Gpu;
use crate::{effects::Stack, frame::{Counters, Frame, Geometry}, scene::{Scene, camera::View}, session::Accuracy};
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    #[error("{0}")]
    Unsupported(String),
    #[error("the device was lost")]
    Lost,
    #[error(transparent)]
    Draw(#[from] crate::scene::draw::DrawError),
}
impl RenderError {
    pub fn is_unsupported(&self) -> bool { matches!(self, Self::Unsupported(_)) }
    pub fn is_lost(&self) -> bool { matches!(self, Self::Lost) }
}
#[derive(Clone, Debug, Default)]
pub struct Report { pub gpu_ms: Option<f64>, pub passes: Vec<(String, f64)>, pub counters: Counters, pub redraw: bool }
#[derive(Clone, Debug)]
pub struct Capture { pub frame: Frame, pub geometry: Geometry, pub layers: Option<Vec<u32>> }
#[derive(Clone, Debug, serde::Serialize)]
pub struct Note { pub name: String, pub why: String }
#[derive(Clone, Debug, serde::Serialize)]
pub struct BufferNote { pub name: String, pub bytes: u64, pub why: String }
#[derive(Clone, Debug, serde::Serialize)]
pub struct Explanation { pub key: String, pub passes: Vec<Note>, pub buffers: Vec<BufferNote>, pub omitted: Vec<Note> }
pub struct Renderer { _gpu: Arc<Gpu> }
impl Renderer {
    pub fn new(gpu: Arc<Gpu>) -> Self { Self { _gpu: gpu } }
    pub fn set_scene(&mut self, _scene: &Arc<Scene>) -> Result<(), RenderError> { Err(RenderError::Unsupported("stub".into())) }
    pub fn draw(&mut self, _view: &View, _stack: &Stack, _accuracy: &Accuracy) -> Result<(), RenderError> { Err(RenderError::Unsupported("stub".into())) }
    pub fn texture_view(&self) -> Option<&wgpu::TextureView> { None }
    pub fn report(&mut self) -> Option<Report> { None }
    pub fn capture(&mut self, _view: &View, _stack: &Stack, _accuracy: &Accuracy) -> Result<Capture, RenderError> { Err(RenderError::Unsupported("stub".into())) }
    pub fn explain(&self) -> Explanation { Explanation { key: String::new(), passes: vec![], buffers: vec![], omitted: vec![] } }
}
