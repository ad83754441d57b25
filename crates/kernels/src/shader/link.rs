//! The linker: concatenates the files, and sections of files, that a pass uses, each once. Module
//! scope in WGSL has no order, so a variant is which sections are taken; there is no preprocessor.
//!
//! | directive | takes |
//! |---|---|
//! | `//@ use lib/frame` | a file of `lib` or `effects` |
//! | `//@ use variants/depth` | the section of that file that the kernel key chooses, visible through the interface in its head |
//! | `//@ use steps/sample_test` | a function that calls every chosen section of that file of `variants`, in order |
//! | `//@ steps fn setup_step(…)` | such a function of steps that are sections of this file |
//! | `//@ use glue/surface` | the effects of the stack on that hook, with their call chain; of those that lights of the scene shine on, the section `lights` too |
//! | `//@ use glue/draws` | a buffer that the key declares in one of several ways, with the functions that depend on it |
//!
//! The text of a file is its head; sections, begun by `//@ variant NAME` and `//@ step NAME`, are
//! taken when they are chosen. A head or a section may name only what it declares itself, and what
//! it uses directly declares. Anything else is an error, so that each can be read alone. No file
//! can use a stage.

use std::{
    borrow::Cow,
    collections::{BTreeMap, BTreeSet, HashMap},
    fmt::Write,
    ops::Range,
    sync::{Arc, LazyLock},
};

use super::{
    glue::{self, Chain},
    image_passes::glue_text,
    key::{Fetch, KernelKey},
    library::{Library, sections},
    pass::Pass,
    source::{Directive, Signature, Source},
    specialize::with_constants,
};
use crate::{
    accuracy::Visibility,
    effects::{Effect, text::for_kernels},
};

/// A linked module with the way back to its files.
#[derive(Clone, Debug)]
pub struct Linked {
    pub text: String,
    pub parts: Vec<Part>,
}

/// A part of a linked module: the head of a file, a section, or generated text. Lines count from 0.
#[derive(Clone, Debug)]
pub struct Part {
    /// `lib/fixed` for the head of that file, `variants/coverage/float` for a section; for
    /// generated text what it is.
    pub name: String,
    /// The file below `shaders`, without `.wgsl`, and its line at which the part begins; none for
    /// generated text.
    pub origin: Option<(String, usize)>,
    /// The line at which it begins in the linked text.
    pub line: usize,
}

impl Linked {
    /// `shaders/<file>.wgsl:<line>` of a line (from 1) of the linked text.
    pub fn origin(&self, line: u32) -> String {
        let line = line as usize - 1;
        match self.parts.iter().rev().find(|part| part.line <= line) {
            Some(Part {
                origin: Some((file, first)),
                line: begin,
                ..
            }) => place(file, first + line - begin),
            Some(part) => format!("{}:{}", part.name, line - part.line + 1),
            None => format!("linked text:{}", line + 1),
        }
    }

    /// The files below `shaders`, without `.wgsl`, that the module takes heads or sections of.
    pub fn files(&self) -> BTreeSet<&str> {
        self.parts
            .iter()
            .filter_map(|part| part.origin.as_ref())
            .map(|(file, _)| file.as_str())
            .collect()
    }
}

/// A line (from 0) of a file as errors name it.
fn place(file: &str, line: usize) -> String {
    format!("shaders/{file}.wgsl:{}", line + 1)
}

/// Why a module could not be put together. Lines count from 1.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
pub enum LinkError {
    #[error("{user} uses {name}, but there is no shaders/{name}.wgsl")]
    Missing { user: String, name: String },
    #[error("{user} uses variants/{file}, but this kernel chooses no variant of it")]
    NoVariant { user: String, file: String },
    #[error("shaders/{file}.wgsl has no section {section}, which this kernel chooses")]
    NoSection { file: String, section: String },
    #[error("shaders/{user}.wgsl:{line}: uses {name}, and a stage cannot be used")]
    UsesStage {
        user: String,
        line: u32,
        name: String,
    },
    #[error("shaders/{user}.wgsl:{line}: unknown {name} in //@ use")]
    UnknownUse {
        user: String,
        line: u32,
        name: String,
    },
    #[error(
        "shaders/{file}.wgsl:{line}: names {name}, which {declared_in} declares; add //@ use for it"
    )]
    Undeclared {
        file: String,
        line: u32,
        name: String,
        declared_in: String,
    },
    #[error(
        "section {section} of shaders/{file}.wgsl does not define {signature}, which the file declares"
    )]
    Incomplete {
        section: String,
        file: String,
        signature: String,
    },
}

/// The head or a section of a file: its text, and what it declares and refers to.
struct Section {
    /// The line (from 0) of the file at which it begins.
    first_line: usize,
    text: String,
    source: Source,
}

impl Section {
    fn new(first_line: usize, text: &str) -> Arc<Self> {
        Arc::new(Self {
            first_line,
            source: Source::parse(text),
            text: text.to_owned(),
        })
    }
}

/// A file of the library: its sections by name; the name of its head is empty.
type File = HashMap<String, Arc<Section>>;

fn file_of(name: &str, text: &str) -> Arc<File> {
    // What effects say of their parameters is no WGSL.
    let text = match name.starts_with("effects/") {
        true => &for_kernels(text),
        false => text,
    };
    let section = |(name, range): (&str, Range<usize>)| {
        let first_line = text[..range.start].matches('\n').count();
        (name.to_owned(), Section::new(first_line, &text[range]))
    };
    Arc::new(sections(text).into_iter().map(section).collect())
}

/// The embedded files, read once.
static EMBEDDED: LazyLock<HashMap<String, Arc<File>>> = LazyLock::new(|| {
    Library::embedded()
        .map(|(name, text)| {
            let file = file_of(&name, text);
            (name, file)
        })
        .collect()
});

fn file(library: &Library, name: &str) -> Option<Arc<File>> {
    match library {
        Library::Embedded => EMBEDDED.get(name).cloned(),
        Library::Outside(_) => library.text(name).map(|text| file_of(name, &text)),
    }
}

/// Puts together the module of `shaders/<root>.wgsl` for `key`. `variants` gives the section that
/// the key chooses in each file of `shaders/variants`; steps have as many entries as are chosen.
pub fn link(
    library: &Library,
    root: &str,
    key: &KernelKey,
    variants: &[(&str, &str)],
) -> Result<Linked, LinkError> {
    Linker::new(library, key, variants, false).link(root)
}

/// Puts together the module of one effect alone: its functions and what they use, with constants in
/// place of overrides.
pub fn link_effect(library: &Library, effect: &Arc<Effect>) -> Result<Linked, LinkError> {
    let key = KernelKey::complete(Fetch::Indexed, Visibility::Split32, vec![effect.clone()]);
    let variants = key.variants(Pass::Resolve);
    let root = format!("effects/{}", effect.file_stem());
    let linked = Linker::new(library, &key, &variants, true).link(&root)?;
    let text = with_constants(&linked.text, &[]).0;
    Ok(Linked { text, ..linked })
}

struct Linker<'a> {
    library: &'a Library,
    key: &'a KernelKey,
    variants: &'a [(&'a str, &'a str)],
    linked: Linked,
    /// What was read.
    files: HashMap<String, Arc<File>>,
    /// What was taken, by the names of parts, each with its file.
    taken: BTreeMap<String, (String, Arc<Section>)>,
    /// Names that generated text declares, each with the directive that brings it.
    generated: BTreeMap<String, String>,
    /// Some file uses the parameters of effects.
    has_effects: bool,
}

impl<'a> Linker<'a> {
    fn new(
        library: &'a Library,
        key: &'a KernelKey,
        variants: &'a [(&'a str, &'a str)],
        has_effects: bool,
    ) -> Self {
        let linked = Linked {
            text: String::new(),
            parts: Vec::new(),
        };
        let (files, taken, generated) = (HashMap::new(), BTreeMap::new(), BTreeMap::new());
        Self {
            library,
            key,
            variants,
            linked,
            files,
            taken,
            generated,
            has_effects,
        }
    }

    fn link(mut self, root: &str) -> Result<Linked, LinkError> {
        self.take_head(root, "the program")?;
        self.declare_bindings(root);
        self.append_effects()?;
        self.check()?;
        self.library.record(self.taken.keys().map(String::as_str));
        Ok(self.linked)
    }

    fn load(&mut self, name: &str, user: &str) -> Result<Arc<File>, LinkError> {
        if let Some(file) = self.files.get(name) {
            return Ok(file.clone());
        }
        let custom = name.strip_prefix("effects/").and_then(|stem| {
            let sources = self
                .key
                .effects
                .list
                .iter()
                .filter_map(|effect| effect.source.as_ref());
            sources.into_iter().find(|source| source.stem == stem)
        });
        let file = match custom {
            Some(source) => Arc::new(File::from([(
                String::new(),
                Section::new(0, &source.linked),
            )])),
            None => file(self.library, name).ok_or_else(|| LinkError::Missing {
                user: user.into(),
                name: name.into(),
            })?,
        };
        self.files.insert(name.to_owned(), file.clone());
        Ok(file)
    }

    fn load_head(&mut self, name: &str, user: &str) -> Result<Arc<Section>, LinkError> {
        Ok(self.load(name, user)?[""].clone())
    }

    /// Takes a file without its sections, and all that it uses.
    fn take_head(&mut self, name: &str, user: &str) -> Result<(), LinkError> {
        let head = self.load_head(name, user)?;
        self.take(name, name, &head)
    }

    /// Takes a section of a file and all that it uses.
    fn take_section(&mut self, file: &str, section: &str) -> Result<Arc<Section>, LinkError> {
        let none = || LinkError::NoSection {
            file: file.into(),
            section: section.into(),
        };
        let found = self
            .load(file, "the program")?
            .get(section)
            .cloned()
            .ok_or_else(none)?;
        self.take(&format!("{file}/{section}"), file, &found)?;
        Ok(found)
    }

    fn take(&mut self, part: &str, file: &str, section: &Arc<Section>) -> Result<(), LinkError> {
        if self.taken.contains_key(part) {
            return Ok(());
        }
        let has_finish = file == "lib/surface" && self.key.surface.has_finish;
        let text = if has_finish {
            glue::with_finish(&section.text, self.key.surface.has_transmission)
        } else {
            Cow::Borrowed(&*section.text)
        };
        self.append(part, Some((file.to_owned(), section.first_line)), &text);
        self.taken
            .insert(part.to_owned(), (file.to_owned(), section.clone()));
        if has_finish {
            self.take_head("lib/finish", file)?;
        }
        for (directive, line) in &section.source.directives {
            let line = section.first_line as u32 + line;
            let user = place(file, line as usize - 1);
            let used = match directive {
                Directive::Use(used) => used,
                Directive::Steps(signature) => {
                    self.take_steps(file, signature)?;
                    continue;
                }
                _ => continue,
            };
            let (kind, rest) = used.split_once('/').unwrap_or(("", used));
            match kind {
                "stages" => {
                    return Err(LinkError::UsesStage {
                        user: file.into(),
                        line,
                        name: used.into(),
                    });
                }
                "variants" => self.take_variant(rest, &user)?,
                "steps" => {
                    let interface = format!("variants/{rest}");
                    let head = self.load_head(&interface, &user)?;
                    let steps = head
                        .source
                        .steps()
                        .next()
                        .ok_or_else(|| LinkError::Missing {
                            user,
                            name: used.into(),
                        })?;
                    self.take_steps(&interface, steps)?;
                }
                "glue" => self.take_glue(rest).ok_or_else(|| LinkError::UnknownUse {
                    user: file.into(),
                    line,
                    name: used.into(),
                })??,
                _ => self.take_head(used, &user)?,
            }
        }
        Ok(())
    }

    /// Takes the section that the key chooses in a file of variants, and checks it against the
    /// interface in the file's head.
    fn take_variant(&mut self, variants: &str, user: &str) -> Result<(), LinkError> {
        let chosen = self
            .variants
            .iter()
            .find(|(name, _)| *name == variants)
            .map(|(_, section)| *section);
        let section = chosen.ok_or_else(|| LinkError::NoVariant {
            user: user.into(),
            file: variants.into(),
        })?;
        let file = format!("variants/{variants}");
        let interface = self.load_head(&file, user)?;
        let taken = self.take_section(&file, section)?;
        let source = &taken.source;
        for (directive, _) in &interface.source.directives {
            if let Directive::Declare(signature) = directive
                && !source.defines(signature)
                && !binding_names(source).any(|name| name == signature.name)
            {
                return Err(LinkError::Incomplete {
                    section: section.into(),
                    file,
                    signature: signature.text.clone(),
                });
            }
        }
        Ok(())
    }

    /// Takes every chosen step among the sections of a file, and generates the function that calls
    /// them in order.
    fn take_steps(&mut self, file: &str, signature: &Signature) -> Result<(), LinkError> {
        let steps: Vec<&str> = self
            .variants
            .iter()
            .filter(|(name, _)| *name == signature.name)
            .map(|(_, step)| *step)
            .collect();
        if !self.generate(&format!("steps of {}", signature.name), || {
            steps_text(signature, &steps)
        }) {
            return Ok(());
        }
        self.generated
            .insert(signature.name.clone(), format!("steps/{}", signature.name));
        for step in steps {
            let wanted = signature.renamed(&format!("{}_{step}", signature.name));
            let section = self.take_section(file, step)?;
            if !section
                .source
                .functions
                .iter()
                .any(|function| same_types(function, &wanted))
            {
                return Err(LinkError::Incomplete {
                    section: step.into(),
                    file: file.into(),
                    signature: wanted,
                });
            }
        }
        Ok(())
    }

    /// Takes generated text; none where there is no such glue.
    fn take_glue(&mut self, name: &str) -> Option<Result<(), LinkError>> {
        if let Some(declaration) = glue::binding(name, self.key) {
            self.generated
                .insert(name.to_owned(), format!("glue/{name}"));
            // Where the stage declares the buffer with another access, its declaration counts.
            let is_declared = self
                .taken
                .values()
                .any(|(_, section)| section.source.declared.contains(name));
            let key = self.key;
            self.generate(&format!("glue of {name}"), || {
                let functions = if name == "draws" {
                    glue::draw_functions(key)
                } else {
                    String::new()
                };
                if is_declared {
                    functions
                } else {
                    declaration + &functions
                }
            });
            if name != "draws" {
                return Some(Ok(()));
            }
            glue::DRAW_FUNCTIONS.iter().for_each(|function| {
                drop(
                    self.generated
                        .insert((*function).into(), "glue/draws".into()),
                )
            });
            // The record that the buffer holds.
            return Some(self.take_head("lib/triangle", "glue/draws"));
        }
        if name == "effects" {
            self.has_effects = true;
            return Some(Ok(()));
        }
        if name == "image_pass" {
            return Some(self.take_image_pass());
        }
        let chain = Chain::ALL.into_iter().find(|chain| chain.name() == name)?;
        let key = self.key;
        if self.generate(&format!("glue of {name}"), || chain.text(key)) {
            self.has_effects = true;
            self.generated
                .insert(format!("glue_{name}"), format!("glue/{name}"));
            if chain == Chain::Glass && key.surface.has_transmission {
                let taken = self.take_head("lib/transmission", "glue/glass");
                if taken.is_err() {
                    return Some(taken);
                }
            }
            for effect in chain.effects(&self.key.effects.list) {
                let file = format!("effects/{}", effect.file_stem());
                let mut taken = self.take_head(&file, &format!("glue/{name}"));
                if chain == Chain::Surface && glue::is_lit(effect, key) {
                    taken = taken.and_then(|()| self.take_section(&file, "lights").map(drop));
                }
                if taken.is_err() {
                    return Some(taken);
                }
            }
        }
        Some(Ok(()))
    }

    /// Takes the effect of the image pass whose number stands among the variants.
    fn take_image_pass(&mut self) -> Result<(), LinkError> {
        let none = || LinkError::NoVariant {
            user: "glue/image_pass".into(),
            file: "image_pass".into(),
        };
        let chosen = self.variants.iter().find(|(name, _)| *name == "image_pass");
        let number: usize = chosen
            .and_then(|(_, number)| number.parse().ok())
            .ok_or_else(none)?;
        let step = *self.key.image_steps().get(number).ok_or_else(none)?;
        let effect = self.key.effects.list[step.effect].clone();
        if self.generate("glue of image_pass", || glue_text(&effect, step.pass)) {
            self.has_effects = true;
            self.generated
                .insert("glue_image_pass".into(), "glue/image_pass".into());
            self.take_head(
                &format!("effects/{}", effect.file_stem()),
                "glue/image_pass",
            )?;
        }
        Ok(())
    }

    /// Declares the buffers of `//@ binding` lines that the stage does not declare with another
    /// access.
    fn declare_bindings(&mut self, root: &str) {
        let of_stage = self.taken[root].1.source.declared.clone();
        let mut bindings: BTreeMap<String, String> = BTreeMap::new();
        for (directive, _) in self
            .taken
            .values()
            .flat_map(|(_, section)| &section.source.directives)
        {
            if let Directive::Binding { name, declaration } = directive
                && !of_stage.contains(name)
            {
                bindings.insert(name.clone(), declaration.clone());
            }
        }
        let text: String = bindings
            .values()
            .map(|declaration| format!("{declaration}\n"))
            .collect();
        if !text.is_empty() {
            self.append("bindings", None, &text);
        }
    }

    /// The parameters of all effects of the stack, for a module that uses some of them. Of an
    /// effect whose functions no part of the module uses, only the struct of its parameters is
    /// taken.
    fn append_effects(&mut self) -> Result<(), LinkError> {
        if !self.has_effects || self.key.effects.list.is_empty() {
            return Ok(());
        }
        self.generated
            .insert("effects".into(), "glue/effects".into());
        let mut text = glue::effects(self.key);
        let mut declared: BTreeSet<&str> = BTreeSet::new();
        for effect in &self.key.effects.list {
            let name = format!("effects/{}", effect.file_stem());
            if !self.taken.contains_key(&name) && declared.insert(effect.file_stem()) {
                match effect.source {
                    Some(_) => text.push_str(&glue::struct_of(effect)),
                    None => text.push_str(glue::struct_text(
                        &self.load_head(&name, "the stack")?.text,
                        &effect.wgsl_struct,
                    )),
                }
            }
        }
        self.append("glue", None, &text);
        Ok(())
    }

    /// Refuses names that a head or a section neither declares itself nor finds in what it uses
    /// directly.
    fn check(&self) -> Result<(), LinkError> {
        let mut declared_in: BTreeMap<&str, String> = BTreeMap::new();
        for (file, section) in self.taken.values() {
            let names = section
                .source
                .declared
                .iter()
                .map(String::as_str)
                .chain(binding_names(&section.source));
            names.for_each(|name| drop(declared_in.insert(name, file.clone())));
        }
        self.generated
            .iter()
            .for_each(|(name, part)| drop(declared_in.insert(name, part.clone())));
        for (file, section) in self.taken.values() {
            let visible = self.visible(&section.source);
            for (name, line) in &section.source.references {
                if let Some(declared_in) = declared_in.get(name.as_str())
                    && !visible.contains(name.as_str())
                {
                    let (line, declared_in) =
                        (section.first_line as u32 + line, declared_in.clone());
                    return Err(LinkError::Undeclared {
                        file: file.clone(),
                        line,
                        name: name.clone(),
                        declared_in,
                    });
                }
            }
        }
        Ok(())
    }

    /// Names that a head or a section may refer to.
    fn visible(&self, source: &Source) -> BTreeSet<String> {
        let mut visible = source.declared.clone();
        visible.extend(
            binding_names(source)
                .chain(source.steps().map(|steps| steps.name.as_str()))
                .map(str::to_owned),
        );
        for used in source.uses() {
            match used.split_once('/').map_or("", |(kind, _)| kind) {
                "variants" => {
                    let interface = &self.files[used][""];
                    visible.extend(interface.source.directives.iter().filter_map(
                        |(directive, _)| match directive {
                            Directive::Declare(signature) | Directive::MayDeclare(signature) => {
                                Some(signature.name.clone())
                            }
                            _ => None,
                        },
                    ));
                }
                "steps" | "glue" => {
                    visible.extend(
                        self.generated
                            .iter()
                            .filter(|(_, part)| *part == used)
                            .map(|(name, _)| name.clone()),
                    );
                }
                _ => {
                    if let Some((_, section)) = self.taken.get(used) {
                        visible.extend(section.source.declared.iter().cloned());
                        visible.extend(binding_names(&section.source).map(str::to_owned));
                    }
                }
            }
        }
        visible
    }

    /// Appends generated text, unless the module has this part already.
    fn generate(&mut self, part: &str, text: impl FnOnce() -> String) -> bool {
        let is_new = self
            .linked
            .parts
            .iter()
            .all(|taken| taken.origin.is_some() || taken.name != part);
        if is_new {
            self.append(part, None, &text());
        }
        is_new
    }

    fn append(&mut self, name: &str, origin: Option<(String, usize)>, text: &str) {
        let line = self.linked.text.lines().count();
        self.linked.parts.push(Part {
            name: name.to_owned(),
            origin,
            line,
        });
        self.linked.text.push_str(text);
        if !text.is_empty() && !text.ends_with('\n') {
            self.linked.text.push('\n');
        }
    }
}

/// Buffers that a head or a section declares by directive: its bindings, and those that the glue
/// declares for it.
fn binding_names(source: &Source) -> impl Iterator<Item = &str> {
    source
        .directives
        .iter()
        .filter_map(|(directive, _)| match directive {
            Directive::Binding { name, .. } => Some(name.as_str()),
            Directive::Use(used) => used
                .strip_prefix("glue/")
                .filter(|name| glue::BINDINGS.contains(name)),
            _ => None,
        })
}

/// Do two functions have the same name, parameter types and result? Parameters may have other
/// names.
fn same_types(function: &str, wanted: &str) -> bool {
    let types = |text: &str| {
        let (head, rest) = text.split_once('(').unwrap_or((text, ""));
        let (parameters, result) = rest.split_once(')').unwrap_or((rest, ""));
        let kinds: Vec<String> = parameters
            .split(", ")
            .map(|one| one.split_once(": ").map_or("", |(_, kind)| kind).to_owned())
            .collect();
        (head.to_owned(), kinds, result.to_owned())
    };
    types(function) == types(wanted)
}

/// The function that calls every step: all must return true; or the first parameter passes through
/// all; or each is called.
fn steps_text(signature: &Signature, stems: &[&str]) -> String {
    let parameters = signature.parameters();
    let first = parameters.first().map_or("", |(name, _)| *name);
    let names: Vec<&str> = parameters.iter().map(|(name, _)| *name).collect();
    let mut text = format!("{} {{\n", signature.text);
    let call = |stem: &str, arguments: &[&str]| {
        format!("{}_{stem}({})", signature.name, arguments.join(", "))
    };
    match signature.result() {
        Some("bool") => {
            for stem in stems {
                writeln!(text, "    if !{} {{ return false; }}", call(stem, &names))
                    .expect("writing to a string");
            }
            text.push_str("    return true;\n");
        }
        Some(_) => {
            writeln!(text, "    var value = {first};").expect("writing to a string");
            let mut arguments = names.clone();
            arguments[0] = "value";
            for stem in stems {
                writeln!(text, "    value = {};", call(stem, &arguments))
                    .expect("writing to a string");
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
