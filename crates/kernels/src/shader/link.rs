//! The linker: concatenates the files that a pass uses, each once. Module scope in WGSL has no order, so a variant is
//! which files are taken; there is no preprocessor.
//!
//! | directive | takes |
//! |---|---|
//! | `//@ use lib/frame` | a file of `lib` or `effects` |
//! | `//@ use variants/depth` | the file of that folder that the kernel key chooses, visible through the folder's interface |
//! | `//@ use steps/sample_test` | a function that calls every chosen file of that folder, in order |
//! | `//@ use glue/surface` | the effects of the stack on that hook, with their call chain |
//! | `//@ use glue/draws` | a buffer that the key declares in one of several ways, with the functions that depend on it |
//!
//! A file may name only what it declares itself, and what the files that it uses directly declare. Anything else is an
//! error, so that each file can be read alone. No file can use a stage.

use std::{
    collections::{BTreeMap, BTreeSet, HashMap},
    fmt::Write,
    sync::{Arc, LazyLock},
};

use super::{
    glue::{self, Chain},
    key::{Fetch, KernelKey},
    library::Library,
    pass::Pass,
    source::{Directive, Signature, Source},
};
use crate::{accuracy::Visibility, effects::Effect};

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

    /// The files below `shaders` that are part of the module; generated text is not.
    pub fn sources(&self) -> impl Iterator<Item = &str> {
        self.files.iter().map(|(name, _)| name.as_str()).filter(|name| !name.ends_with(GENERATED))
    }
}

/// End of the names of generated parts of a module.
const GENERATED: &str = "(generated)";

/// Why a module could not be put together. Lines count from 1.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
pub enum LinkError {
    #[error("{user} uses {name}, but there is no shaders/{name}.wgsl")]
    Missing { user: String, name: String },
    #[error("{user} uses variants/{folder}, but this kernel chooses no file of it")]
    NoVariant { user: String, folder: String },
    #[error("shaders/{user}.wgsl:{line}: uses {name}, and a stage cannot be used")]
    UsesStage { user: String, line: u32, name: String },
    #[error("shaders/{user}.wgsl:{line}: unknown {name} in //@ use")]
    UnknownUse { user: String, line: u32, name: String },
    #[error("shaders/{file}.wgsl:{line}: names {name}, which {declared_in} declares; add //@ use for it")]
    Undeclared { file: String, line: u32, name: String, declared_in: String },
    #[error("shaders/{file}.wgsl does not define {signature}, which {interface} declares")]
    Incomplete { file: String, signature: String, interface: String },
}

/// A file of the library: its text, and what it declares and refers to.
struct File {
    text: String,
    source: Source,
}

impl File {
    fn new(text: String) -> Self {
        Self { source: Source::parse(&text), text }
    }
}

/// The embedded files, read once.
static EMBEDDED: LazyLock<HashMap<String, Arc<File>>> = LazyLock::new(|| {
    let texts = Library::embedded();
    texts.map(|(name, text)| (name, Arc::new(File::new(text.to_owned())))).collect()
});

fn file(library: &Library, name: &str) -> Option<Arc<File>> {
    match library {
        Library::Embedded => EMBEDDED.get(name).cloned(),
        Library::Folder(_) => library.text(name).map(|text| Arc::new(File::new(text.into_owned()))),
    }
}

/// Puts together the module of `shaders/<root>.wgsl` for `key`. `variants` gives the stem of the file that the key chooses in
/// each folder of `shaders/variants`; a folder of steps has as many entries as there are steps.
///
/// # Errors
/// When a file is missing, names what no file that it uses declares, or does not define what its interface declares.
pub fn link(library: &Library, root: &str, key: &KernelKey, variants: &[(&str, &str)]) -> Result<Linked, LinkError> {
    let linked = Linked { text: String::new(), files: Vec::new() };
    let mut linker = Linker { library, key, variants, linked, files: BTreeMap::new(), generated: BTreeMap::new(), has_effects: false };
    linker.take(root, "the program")?;
    linker.declare_bindings(root);
    linker.append_effects()?;
    linker.check()?;
    Ok(linker.linked)
}

/// Puts together the module of one effect alone: its functions and what they use.
///
/// # Errors
/// As [`link`].
pub fn link_effect(library: &Library, effect: &'static Effect) -> Result<Linked, LinkError> {
    let key = KernelKey::complete(Fetch::Indexed, Visibility::Split32, vec![effect]);
    let variants = key.variants(Pass::Resolve);
    let linked = Linked { text: String::new(), files: Vec::new() };
    let mut linker =
        Linker { library, key: &key, variants: &variants, linked, files: BTreeMap::new(), generated: BTreeMap::new(), has_effects: true };
    let root = format!("effects/{}", effect.file_stem());
    linker.take(&root, "the program")?;
    linker.declare_bindings(&root);
    linker.append_effects()?;
    linker.check()?;
    Ok(linker.linked)
}

struct Linker<'a> {
    library: &'a Library,
    key: &'a KernelKey,
    variants: &'a [(&'a str, &'a str)],
    linked: Linked,
    files: BTreeMap<String, Arc<File>>,
    /// Names that generated text declares, each with the directive that brings it.
    generated: BTreeMap<String, String>,
    /// Some file uses the parameters of effects.
    has_effects: bool,
}

impl Linker<'_> {
    fn load(&self, name: &str, user: &str) -> Result<Arc<File>, LinkError> {
        let custom = name.strip_prefix("effects/").and_then(|stem| {
            let sources = self.key.effects.list.iter().filter_map(|effect| effect.source);
            sources.into_iter().find(|source| source.stem == stem)
        });
        if let Some(source) = custom {
            return Ok(Arc::new(File::new(source.linked.clone())));
        }
        file(self.library, name).ok_or_else(|| LinkError::Missing { user: user.into(), name: name.into() })
    }

    /// Takes a file and all that it uses.
    fn take(&mut self, name: &str, user: &str) -> Result<(), LinkError> {
        if self.files.contains_key(name) {
            return Ok(());
        }
        let file = self.load(name, user)?;
        self.append(name, &file.text);
        self.files.insert(name.to_owned(), file.clone());
        for (used, line) in file.source.uses() {
            let (kind, rest) = used.split_once('/').unwrap_or(("", used));
            match kind {
                "stages" => return Err(LinkError::UsesStage { user: name.into(), line, name: used.into() }),
                "variants" => self.take_variant(rest, name)?,
                "steps" => self.take_steps(rest, name)?,
                "glue" => self.take_glue(rest).ok_or_else(|| LinkError::UnknownUse { user: name.into(), line, name: used.into() })??,
                _ => self.take(used, name)?,
            }
        }
        Ok(())
    }

    /// Takes the file that the key chooses in a folder, and checks it against the folder's interface.
    fn take_variant(&mut self, folder: &str, user: &str) -> Result<(), LinkError> {
        let chosen = self.variants.iter().find(|(name, _)| *name == folder).map(|(_, stem)| *stem);
        let stem = chosen.ok_or_else(|| LinkError::NoVariant { user: user.into(), folder: folder.into() })?;
        let name = format!("variants/{folder}/{stem}");
        let interface = interface_of(folder);
        let declared = self.load(&interface, user)?;
        self.take(&name, user)?;
        for (directive, _) in &declared.source.directives {
            if let Directive::Declare(signature) = directive
                && !self.files[&name].source.defines(signature)
            {
                return Err(LinkError::Incomplete { file: name, signature: signature.text.clone(), interface });
            }
        }
        Ok(())
    }

    /// Takes every chosen file of a folder of steps, and generates the function that calls them in order.
    fn take_steps(&mut self, folder: &str, user: &str) -> Result<(), LinkError> {
        let interface = interface_of(folder);
        let part = format!("steps of {folder} {GENERATED}");
        if self.linked.files.iter().any(|(taken, _)| *taken == part) {
            return Ok(());
        }
        let declared = self.load(&interface, user)?;
        let steps = declared.source.directives.iter().find_map(|(directive, _)| match directive {
            Directive::Steps(signature) => Some(signature.clone()),
            _ => None,
        });
        let signature = steps.ok_or_else(|| LinkError::Missing { user: user.into(), name: format!("steps/{folder}") })?;
        let stems: Vec<&str> = self.variants.iter().filter(|(name, _)| *name == folder).map(|(_, stem)| *stem).collect();
        self.append(&part, &steps_text(&signature, &stems));
        self.generated.insert(signature.name.clone(), format!("steps/{folder}"));
        for stem in stems {
            let name = format!("variants/{folder}/{stem}");
            self.take(&name, &interface)?;
            let wanted = signature.renamed(&format!("{}_{stem}", signature.name));
            if !self.files[&name].source.functions.iter().any(|function| same_types(function, &wanted)) {
                return Err(LinkError::Incomplete { file: name, signature: wanted, interface });
            }
        }
        Ok(())
    }

    /// Takes generated text; none where there is no such glue.
    fn take_glue(&mut self, name: &str) -> Option<Result<(), LinkError>> {
        if let Some(declaration) = glue::binding(name, self.key) {
            self.generated.insert(name.to_owned(), format!("glue/{name}"));
            // Where the stage declares the buffer with another access, its declaration counts.
            let is_declared = self.files.values().any(|file| file.source.declared.contains(name));
            let part = format!("glue of {name} {GENERATED}");
            if !self.linked.files.iter().any(|(taken, _)| *taken == part) {
                let mut text = if is_declared { String::new() } else { declaration };
                if name == "draws" {
                    glue::DRAW_FUNCTIONS.iter().for_each(|function| drop(self.generated.insert((*function).into(), "glue/draws".into())));
                    text.push_str(&glue::draw_functions(self.key));
                }
                self.append(&part, &text);
            }
            // The record that the buffer holds.
            return Some(if name == "draws" { self.take("lib/triangle", "glue/draws") } else { Ok(()) });
        }
        if name == "effects" {
            self.has_effects = true;
            return Some(Ok(()));
        }
        let chain = Chain::ALL.into_iter().find(|chain| chain.name() == name)?;
        let part = format!("glue of {name} {GENERATED}");
        if !self.linked.files.iter().any(|(taken, _)| *taken == part) {
            self.has_effects = true;
            self.append(&part, &chain.text(&self.key.effects));
            self.generated.insert(format!("glue_{name}"), format!("glue/{name}"));
            for effect in chain.effects(&self.key.effects.list) {
                if let Err(error) = self.take(&format!("effects/{}", effect.file_stem()), &format!("glue/{name}")) {
                    return Some(Err(error));
                }
            }
        }
        Some(Ok(()))
    }

    /// Declares the buffers of `//@ binding` lines that the stage does not declare with another access.
    fn declare_bindings(&mut self, root: &str) {
        let of_stage = self.files[root].source.declared.clone();
        let mut bindings: BTreeMap<String, String> = BTreeMap::new();
        for (directive, _) in self.files.values().flat_map(|file| &file.source.directives) {
            if let Directive::Binding { name, declaration } = directive
                && !of_stage.contains(name)
            {
                bindings.insert(name.clone(), declaration.clone());
            }
        }
        let text: String = bindings.values().map(|declaration| format!("{declaration}\n")).collect();
        if !text.is_empty() {
            self.append(&format!("bindings {GENERATED}"), &text);
        }
    }

    /// The parameters of all effects of the stack, for a module that uses some of them. Of an effect whose functions no part of
    /// the module uses, only the struct of its parameters is taken.
    fn append_effects(&mut self) -> Result<(), LinkError> {
        if !self.has_effects || self.key.effects.list.is_empty() {
            return Ok(());
        }
        self.generated.insert("effects".into(), "glue/effects".into());
        let mut text = glue::effects(self.key);
        let mut declared: BTreeSet<&str> = BTreeSet::new();
        for effect in &self.key.effects.list {
            let name = format!("effects/{}", effect.file_stem());
            if !self.files.contains_key(&name) && declared.insert(effect.file_stem()) {
                match effect.source {
                    Some(_) => text.push_str(&glue::struct_of(effect)),
                    None => text.push_str(glue::struct_text(&self.load(&name, "the stack")?.text, effect.wgsl_struct)),
                }
            }
        }
        // The structs of parameters that several effects share, where their files are not part of the module.
        let groups: BTreeSet<&str> =
            self.key.effects.list.iter().flat_map(|effect| effect.fields).filter_map(|field| Some(field.group?.wgsl_struct)).collect();
        for group in groups {
            let name = format!("lib/{}", group.to_lowercase());
            if !self.files.contains_key(&name) {
                text.push_str(glue::struct_text(&self.load(&name, "the stack")?.text, group));
            }
        }
        self.append(&format!("glue {GENERATED}"), &text);
        Ok(())
    }

    /// Refuses names that a file neither declares itself nor finds in a file that it uses directly.
    fn check(&self) -> Result<(), LinkError> {
        let mut declared_in: BTreeMap<&str, String> = BTreeMap::new();
        for (file_name, file) in &self.files {
            let where_used = match file_name.split('/').collect::<Vec<_>>()[..] {
                ["variants", folder, _] => format!("variants/{folder}"),
                _ => file_name.clone(),
            };
            let names = file.source.declared.iter().map(String::as_str).chain(binding_names(&file.source));
            names.for_each(|name| drop(declared_in.insert(name, where_used.clone())));
        }
        self.generated.iter().for_each(|(name, part)| drop(declared_in.insert(name, part.clone())));
        for (file_name, file) in &self.files {
            let visible = self.visible(file_name, &file.source)?;
            for (name, line) in &file.source.references {
                if let Some(place) = declared_in.get(name.as_str())
                    && !visible.contains(name.as_str())
                {
                    let (file, declared_in) = (file_name.clone(), place.clone());
                    return Err(LinkError::Undeclared { file, line: *line, name: name.clone(), declared_in });
                }
            }
        }
        Ok(())
    }

    /// Names that a file may refer to.
    fn visible(&self, file_name: &str, source: &Source) -> Result<BTreeSet<String>, LinkError> {
        let mut visible = source.declared.clone();
        visible.extend(binding_names(source).map(str::to_owned));
        for (used, _) in source.uses() {
            let (kind, rest) = used.split_once('/').unwrap_or(("", used));
            match kind {
                "variants" => {
                    let interface = self.load(&interface_of(rest), file_name)?;
                    visible.extend(interface.source.directives.iter().filter_map(|(directive, _)| match directive {
                        Directive::Declare(signature) | Directive::MayDeclare(signature) => Some(signature.name.clone()),
                        _ => None,
                    }));
                    visible.extend(binding_names(&interface.source).map(str::to_owned));
                }
                "steps" | "glue" => {
                    visible.extend(self.generated.iter().filter(|(_, part)| *part == used).map(|(name, _)| name.clone()));
                }
                _ => {
                    if let Some(file) = self.files.get(used) {
                        visible.extend(file.source.declared.iter().cloned());
                        visible.extend(binding_names(&file.source).map(str::to_owned));
                    }
                }
            }
        }
        Ok(visible)
    }

    fn append(&mut self, name: &str, text: &str) {
        let line = self.linked.text.lines().count();
        self.linked.files.push((name.to_owned(), line));
        self.linked.text.push_str(text);
        if !text.is_empty() && !text.ends_with('\n') {
            self.linked.text.push('\n');
        }
    }
}

/// The file that says what the variants of a folder define.
fn interface_of(folder: &str) -> String {
    format!("variants/{folder}/interface")
}

/// Buffers that a file declares by directive: its bindings, and those that the glue declares for it.
fn binding_names(source: &Source) -> impl Iterator<Item = &str> {
    source.directives.iter().filter_map(|(directive, _)| match directive {
        Directive::Binding { name, .. } => Some(name.as_str()),
        Directive::Use(used) => used.strip_prefix("glue/").filter(|name| glue::BINDINGS.contains(name)),
        _ => None,
    })
}

/// Do two functions have the same name, parameter types and result? Parameters may have other names.
fn same_types(function: &str, wanted: &str) -> bool {
    let types = |text: &str| {
        let (head, rest) = text.split_once('(').unwrap_or((text, ""));
        let (parameters, result) = rest.split_once(')').unwrap_or((rest, ""));
        let kinds: Vec<String> = parameters.split(", ").map(|one| one.split_once(": ").map_or("", |(_, kind)| kind).to_owned()).collect();
        (head.to_owned(), kinds, result.to_owned())
    };
    types(function) == types(wanted)
}

/// The function that calls every step: all must return true; or the first parameter passes through all; or each is called.
fn steps_text(signature: &Signature, stems: &[&str]) -> String {
    let parameters = signature.parameters();
    let first = parameters.first().map_or("", |(name, _)| *name);
    let names: Vec<&str> = parameters.iter().map(|(name, _)| *name).collect();
    let mut text = format!("{} {{\n", signature.text);
    let call = |stem: &str, arguments: &[&str]| format!("{}_{stem}({})", signature.name, arguments.join(", "));
    match signature.result() {
        Some("bool") => {
            for stem in stems {
                writeln!(text, "    if !{} {{ return false; }}", call(stem, &names)).expect("writing to a string");
            }
            text.push_str("    return true;\n");
        }
        Some(_) => {
            writeln!(text, "    var value = {first};").expect("writing to a string");
            let mut arguments = names.clone();
            arguments[0] = "value";
            for stem in stems {
                writeln!(text, "    value = {};", call(stem, &arguments)).expect("writing to a string");
            }
            text.push_str("    return value;\n");
        }
        None => {
            for stem in stems {
                writeln!(text, "    {};", call(stem, &names)).expect("writing to a string");
            }
        }
    }
    text.push_str("}\n");
    text
}
