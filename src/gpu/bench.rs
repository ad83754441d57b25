//! STUB: the lead is writing this; signatures hold.
use std::sync::Arc;
use super::{Gpu, RenderError};
use crate::{measure, scene::Scene, session::Session};
pub struct BenchOptions { pub size: [u32; 2], pub samples: usize }
#[derive(Clone, Debug, serde::Serialize)]
pub struct PassTime { pub name: String, pub ms_p50: f64, pub ms_p95: f64 }
#[derive(Clone, Debug, serde::Serialize)]
pub struct BenchRow { pub scene: String, pub triangles: u64, pub rung: String, pub adapter: String, pub ms_p50: Option<f64>, pub ms_p95: Option<f64>, pub samples: usize, pub passes: Vec<PassTime>, pub error: measure::Accuracy, pub note: Option<String> }
pub fn bench(_gpu: &Arc<Gpu>, _session: &Session, _scene: &Arc<Scene>, _scene_name: &str, _options: &BenchOptions, _progress: &mut dyn FnMut(&str, usize, usize), _judge: &dyn Fn(&crate::frame::Frame, &crate::frame::Geometry, Option<&[u32]>) -> measure::Accuracy) -> Result<Vec<BenchRow>, RenderError> { Ok(vec![]) }
