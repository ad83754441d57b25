//! STUB: helper "oracle" is writing this; signatures hold.
use crate::{effects::Stack, frame::{Frame, Geometry}, measure::Accuracy, scene::{Scene, camera::View, draw::{Draw, DrawError}}};
pub struct Verdict { pub accuracy: Accuracy, pub expected: Frame }
pub fn project(_scene: &Scene, _draws: &[Draw], _view: &View) -> Geometry { unimplemented!() }
pub fn render(_scene: &Scene, _view: &View, _stack: &Stack) -> Result<Frame, DrawError> { unimplemented!() }
pub fn judge(_scene: &Scene, _view: &View, _stack: &Stack, _frame: &Frame, _geometry: &Geometry, _layers: Option<&[u32]>) -> Result<Verdict, DrawError> { unimplemented!() }
