//! What a worker has found, on its way to the page: lists as bytes, the rest as TOML, which has words
//! for infinity.

use js_sys::{Array, Uint8Array};
use serde::{Deserialize, Serialize, de::DeserializeOwned};
use wasm_bindgen::{JsCast as _, JsValue};

use super::{
    findings::Findings,
    overlay::Overlay,
    precision::{Error, Measured},
    screen::Inputs,
};
use crate::{
    effect_files::{Crossing, Unsound},
    effects::Stack,
    measure::{ErrorReport, error_map::ErrorMap},
};

#[derive(Serialize, Deserialize)]
struct FindingsInWords {
    accuracy: ErrorReport,
    size: [u32; 2],
    counts: [u64; Overlay::ALL.len()],
    has_reference: bool,
    crossings: Vec<CrossingInWords>,
}

/// A crossing with the names of its effect and its parameter.
#[derive(Serialize, Deserialize)]
struct CrossingInWords {
    pixel: [u32; 2],
    effect: String,
    made: Unsound,
    parameter: Option<String>,
    only_f32: bool,
}

impl CrossingInWords {
    fn of(crossing: &Crossing) -> Self {
        let parameter = crossing.parameter.as_ref();
        Self {
            pixel: crossing.pixel,
            effect: crossing.effect.name.clone(),
            made: crossing.made,
            parameter: parameter.map(|field| field.param.name.to_string()),
            only_f32: crossing.only_f32,
        }
    }

    /// None where the stack has no such effect.
    fn in_stack(self, stack: &Stack) -> Option<Crossing> {
        let effect = stack.get(&self.effect)?.effect.clone();
        let parameter = effect
            .fields
            .iter()
            .find(|field| self.parameter.as_deref() == Some(&*field.param.name))
            .cloned();
        Some(Crossing {
            pixel: self.pixel,
            made: self.made,
            parameter,
            only_f32: self.only_f32,
            effect,
        })
    }
}

#[derive(Serialize, Deserialize)]
struct MeasuredInWords {
    size: [u32; 2],
    effects: Vec<ErrorsInWords>,
}

/// The errors of the effect of this name.
#[derive(Serialize, Deserialize)]
struct ErrorsInWords {
    effect: String,
    errors: Vec<Error>,
}

impl Findings {
    /// The findings for [`Findings::received`].
    ///
    /// # Errors
    /// A count is larger than the integers of TOML.
    pub fn sent(&self) -> Result<JsValue, String> {
        let words = in_words(&FindingsInWords {
            accuracy: self.accuracy.clone(),
            size: self.size,
            counts: self.counts,
            has_reference: self.reference.is_some(),
            crossings: self.crossings.iter().map(CrossingInWords::of).collect(),
        })?;
        let lists: [&[u8]; 6] = [
            bytemuck::cast_slice(&self.triangle_ids),
            bytemuck::cast_slice(&self.color),
            bytemuck::cast_slice(&self.layers),
            self.faults.bits(),
            &self.faults.color_delta,
            bytemuck::cast_slice(self.reference.as_deref().unwrap_or_default()),
        ];
        let lists = lists.map(|list| JsValue::from(Uint8Array::from(list)));
        Ok(Array::from_iter([words.into()].into_iter().chain(lists)).into())
    }

    /// The findings that a worker has sent, on a picture with this stack.
    ///
    /// # Errors
    /// It has sent something else.
    pub fn received(sent: JsValue, stack: &Stack) -> Result<Self, String> {
        let sent: Array = sent.dyn_into().map_err(|_| strange())?;
        let words: FindingsInWords = of_words(&text_of(&sent.get(0))?)?;
        let bytes = |at: u32| Uint8Array::new(&sent.get(at)).to_vec();
        let numbers = |at: u32| bytemuck::pod_collect_to_vec::<u8, u32>(&bytes(at));
        let crossings = words.crossings.into_iter();
        Ok(Self {
            accuracy: words.accuracy,
            size: words.size,
            faults: ErrorMap::of_bits(bytes(4), bytes(5)),
            triangle_ids: numbers(1),
            color: bytemuck::pod_collect_to_vec(&bytes(2)),
            geometry: None,
            reference: words.has_reference.then(|| numbers(6)),
            crossings: crossings
                .filter_map(|crossing| crossing.in_stack(stack))
                .collect(),
            layers: numbers(3),
            counts: words.counts,
        })
    }
}

impl Measured {
    /// The errors for [`Measured::received`].
    ///
    /// # Errors
    /// None that is known.
    pub fn sent(&self) -> Result<JsValue, String> {
        let effects = self.effects.iter().map(|(effect, errors)| ErrorsInWords {
            effect: effect.name.clone(),
            errors: errors.clone(),
        });
        let words = in_words(&MeasuredInWords {
            size: self.size,
            effects: effects.collect(),
        });
        words.map(JsValue::from)
    }

    /// The errors that a worker has sent, in the picture of `inputs`.
    ///
    /// # Errors
    /// It has sent something else.
    pub fn received(sent: JsValue, inputs: &Inputs) -> Result<Self, String> {
        let words: MeasuredInWords = of_words(&text_of(&sent)?)?;
        let effects = words.effects.into_iter().filter_map(|of| {
            let enabled = inputs.stack.get(&of.effect)?;
            Some((enabled.effect.clone(), of.errors))
        });
        Ok(Self {
            of: inputs.clone(),
            size: words.size,
            effects: effects.collect(),
        })
    }
}

/// A value as TOML.
///
/// # Errors
/// An integer is larger than those of TOML.
pub fn in_words(value: &impl Serialize) -> Result<String, String> {
    toml_edit::ser::to_string(value).map_err(|error| error.to_string())
}

/// The value that a worker has sent as TOML.
///
/// # Errors
/// It has sent something else.
pub fn of_words<T: DeserializeOwned>(text: &str) -> Result<T, String> {
    toml_edit::de::from_str(text).map_err(|_| strange())
}

fn text_of(sent: &JsValue) -> Result<String, String> {
    sent.as_string().ok_or_else(strange)
}

fn strange() -> String {
    "a worker of the page has sent something that is no answer".into()
}
