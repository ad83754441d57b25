//! What lies where in buffers, in numbers alone: records, resources, queues, and the layout of a frame.

mod gpu_record;
pub mod records;

mod resource_id;

pub mod glass;
pub mod queues;

pub mod frame_layout;

pub mod dispatch;

pub use gpu_record::{RecordLayout, RecordMember};
pub use resource_id::{BufferId, ClearedBy, ResourceId, TextureId};
