//! The linker: concatenates the files that a pass uses, each once. Module scope in WGSL has no order, so a variant is
//! which files are taken; there is no preprocessor.
//!
//! `//@ use common/frame` takes a file, `//@ use slot/coverage` the file that the kernel key chose for that slot, and
//! `//@ use glue/surface` the effects of the stack with their call chain on that hook.

use super::{
    glue::{self, Chain},
    key::KernelKey,
    library::Library,
};

/// A linked module with the way back to its files.
#[derive(Clone, Debug)]
pub struct Linked {
    pub text: String,
    /// Name of each file and the line (from 0) at which it begins in `text`.
    pub files: Vec<(String, usize)>,
}

impl Linked {
    /// `shaders/<file>.wgsl:<line>` of a line (from 1) of the linked text.
    pub fn origin(&self, line: u32) -> String {
        let line = line as usize - 1;
        match self.files.iter().rev().find(|(_, first)| *first <= line) {
            Some((name, first)) => format!("shaders/{name}.wgsl:{}", line - first + 1),
            None => format!("linked text:{}", line + 1),
        }
    }
}

/// Why a module could not be put together.
#[derive(Debug, thiserror::Error)]
pub enum LinkError {
    #[error("{user} uses {name}, but there is no shaders/{name}.wgsl")]
    Missing { user: String, name: String },
    #[error("{user} uses slot/{slot}, which this kernel does not fill")]
    EmptySlot { user: String, slot: String },
}

/// Puts together the module of `shaders/<root>.wgsl` for `key`; `slots` gives the file of each slot.
pub fn link(library: &Library, root: &str, key: &KernelKey, slots: &[(&str, String)]) -> Result<Linked, LinkError> {
    let mut linker = Linker { library, key, slots, linked: Linked { text: String::new(), files: Vec::new() } };
    linker.take(root, "the program")?;
    Ok(linker.linked)
}

struct Linker<'a> {
    library: &'a Library,
    key: &'a KernelKey,
    slots: &'a [(&'a str, String)],
    linked: Linked,
}

impl Linker<'_> {
    fn take(&mut self, name: &str, user: &str) -> Result<(), LinkError> {
        if self.linked.files.iter().any(|(taken, _)| taken == name) {
            return Ok(());
        }
        let text = self.library.text(name).ok_or_else(|| LinkError::Missing { user: user.into(), name: name.into() })?;
        self.append(name, &text);
        for used in text.lines().filter_map(|line| line.strip_prefix("//@ use ")).map(str::trim) {
            match used.strip_prefix("slot/") {
                None => match Chain::ALL.into_iter().find(|chain| used.strip_prefix("glue/") == Some(chain.name())) {
                    Some(chain) => self.take_glue(chain, name)?,
                    None => self.take(used, name)?,
                },
                Some(slot) => {
                    let chosen = self.slots.iter().find(|(name, _)| *name == slot).map(|(_, file)| file.clone());
                    let file = chosen.ok_or_else(|| LinkError::EmptySlot { user: name.into(), slot: slot.into() })?;
                    self.take(&file, name)?;
                }
            }
        }
        Ok(())
    }

    /// The effects of the stack, once, and the chain of one hook.
    fn take_glue(&mut self, chain: Chain, user: &str) -> Result<(), LinkError> {
        const GLUE: &str = "glue (generated)";
        let chain_name = format!("glue of {} (generated)", chain.name());
        if self.linked.files.iter().any(|(taken, _)| *taken == chain_name) {
            return Ok(());
        }
        if !self.linked.files.iter().any(|(taken, _)| taken == GLUE) {
            self.append(GLUE, &glue::glue(&self.key.effects.list, &self.key.effects.baked));
            for effect in &self.key.effects.list {
                self.take(&format!("effects/{}", effect.name), user)?;
            }
        }
        self.append(&chain_name, &chain.text(&self.key.effects.list));
        Ok(())
    }

    fn append(&mut self, name: &str, text: &str) {
        let line = self.linked.text.lines().count();
        self.linked.files.push((name.to_owned(), line));
        self.linked.text.push_str(text);
        if !text.ends_with('\n') {
            self.linked.text.push('\n');
        }
    }
}
