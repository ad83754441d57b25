//! Declarations: what an effect file declares at module scope, which of its functions are hooks,
//! and what it may not contain.

use std::{collections::BTreeSet, ops::Range};

use super::{
    attributes, bounds,
    error::{EffectError, Text},
    functions::{OfPass, Reach, image_passes, is_smooth, kept_frames, pass_scale, reach},
    parameters::{self, Parameters},
    tokens::{Token, closing, tokens},
    words::{self, LIBRARY},
};
use crate::effects::{HookFunctions, hooks::ImagePass};

/// The hooks: type of the first parameter, type of the result, and the library file that declares
/// the former.
const HOOKS: [(&str, &str, &str); 5] = [
    ("Vertex", "Vertex", "vertex"),
    ("Sample", "bool", "sample"),
    ("Surface", "Surface", "surface"),
    ("Pixel", "Pixel", "image"),
    ("ImageAt", "vec4f", "image_pass"),
];

/// Index of the one hook that several functions may be on, each a pass.
const PASSES: usize = 4;

/// Functions of `lib/image` that only a pixel effect may call.
const OF_PIXELS: [&str; 2] = ["image_background", "image_previous"];

/// Functions of `lib/image_kept`, which is there where a pass is kept.
const OF_KEPT: [&str; 2] = ["image_kept", "image_kept_at"];

/// Attributes that stand before functions.
pub const OF_FUNCTIONS: [&str; 4] = ["pass", "kept", "smooth", REACH];

/// The attribute of the function that says how far a vertex moves.
pub const REACH: &str = "reach";

/// What an effect file says.
#[derive(Debug)]
pub struct Declaration<'a> {
    /// The first sentence of the comment at the top.
    pub about: String,
    pub tokens: Vec<Token<'a>>,
    /// Name of the struct of parameters.
    pub struct_name: &'a str,
    pub parameters: Parameters,
    pub hooks: HookFunctions,
    /// The passes over the finished picture, in order.
    pub passes: Vec<ImagePass>,
    /// How far the vertex function moves a vertex at most; none: by the sum of the lengths.
    pub reach: Option<Reach>,
    /// Names declared at module scope, and the constants of choices.
    pub declared: BTreeSet<String>,
    /// The color of its surface and pixel functions has no steps.
    pub is_smooth: bool,
    /// Files that it uses, as `lib/surface`; those of its hooks' types are among them.
    pub uses: Vec<String>,
}

/// A function as its head declares it.
pub struct Function<'a> {
    pub name: Token<'a>,
    /// Types of the parameters.
    pub parameters: Vec<String>,
    /// Where the type of the last parameter begins.
    pub last_type: Option<Token<'a>>,
    pub result: String,
    /// What stands before it.
    pub of_pass: OfPass,
    /// `@smooth` stands before it: its color has no steps.
    pub is_smooth: bool,
    /// `@reach` stands before it: it says how far a vertex moves.
    pub is_reach: bool,
}

/// Whose effect a text is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Author {
    /// The lab's: it may use every file of the library.
    Lab,
    /// Anybody's.
    Anybody,
}

/// Reads an effect file; its constants of choices begin with `stem`.
///
/// # Errors
/// A text out of bounds, a declaration that an effect cannot have, no hook, two functions on one
/// hook, or as [`parameters::read`].
pub fn read<'a>(
    text: &Text<'a>,
    stem: &str,
    author: Author,
) -> Result<Declaration<'a>, EffectError> {
    let tokens = tokens(text.text);
    bounds::check(text, &tokens)?;
    let uses = uses(text, author)?;
    let scope = module_scope(text, &tokens)?;
    words::check_declared(text, &scope.names)?;
    words::refuse(text, &tokens, &scope.names)?;
    let (hooks, passes, struct_name) = match (hooks(text, &scope.functions), author) {
        // An effect that replaces a part of the rasterizer may have no hook.
        (Err(error), Author::Lab) => {
            let name = type_name(stem);
            let declared = scope.structs.iter().find(|(token, _)| token.text == name);
            let (token, _) = declared.ok_or(error)?;
            (HookFunctions::default(), Vec::new(), *token)
        }
        (found, _) => found?,
    };
    let is_smooth = is_smooth(text, &scope.functions, &hooks)?;
    let reach = reach(text, &scope.functions, &hooks, struct_name.text, author)?;
    let mut structs = scope.structs.iter();
    let Some((_, open)) = structs.find(|(name, _)| name.text == struct_name.text) else {
        let message = format!(
            "the hook takes {0}, which is no struct of this file; write struct {0} {{ … }} with the parameters",
            struct_name.text
        );
        return Err(text.at(struct_name, message));
    };
    let mut parameters = parameters::read(text, &tokens, *open)?;
    parameters
        .attributes
        .extend(scope.attributes.iter().cloned());
    let constants = parameters::constants(text, stem, &parameters)?;
    let mut declaration = Declaration {
        about: about(text.text, stem),
        tokens,
        struct_name: struct_name.text,
        parameters,
        hooks,
        passes,
        reach,
        is_smooth,
        declared: BTreeSet::new(),
        uses,
    };
    declaration.use_library(text, &scope)?;
    for name in &scope.names {
        if constants.contains(name.text) {
            let message = format!(
                "{} is the constant of a choice of this effect; choose another name",
                name.text
            );
            return Err(text.at(name, message));
        }
    }
    let names = scope.names.iter().map(|name| name.text.to_owned());
    declaration.declared = constants.into_iter().chain(names).collect();
    Ok(declaration)
}

/// The name of the struct of an effect: `my_ink` is `MyInk`.
pub fn type_name(name: &str) -> String {
    let capital = |word: &str| {
        word.chars()
            .take(1)
            .flat_map(char::to_uppercase)
            .chain(word.chars().skip(1))
            .collect::<String>()
    };
    name.split('_').map(capital).collect()
}

/// What stands at module scope.
#[derive(Default)]
struct Scope<'a> {
    /// Everything that is declared.
    names: Vec<Token<'a>>,
    /// Names of structs, with the index of the opening brace.
    structs: Vec<(Token<'a>, usize)>,
    functions: Vec<Function<'a>>,
    /// Byte ranges of the attributes of passes.
    attributes: Vec<Range<usize>>,
}

fn module_scope<'a>(text: &Text<'a>, tokens: &[Token<'a>]) -> Result<Scope<'a>, EffectError> {
    let mut scope = Scope::default();
    let (mut of_pass, mut is_smooth, mut is_reach) = (OfPass::default(), false, false);
    let mut at = 0;
    while at < tokens.len() {
        let token = tokens[at];
        let name = tokens.get(at + 1).copied().filter(Token::is_name);
        let opening = tokens.get(at + 2).map_or("", |token| token.text);
        let refused = match (token.text, name) {
            (";", _) => {
                at += 1;
                continue;
            }
            ("struct", Some(name)) => {
                if opening != "{" {
                    let message = format!(
                        "the struct {0} has no members; write struct {0} {{ … }}",
                        name.text
                    );
                    return Err(text.at(name, message));
                }
                scope.names.push(name);
                scope.structs.push((name, at + 2));
                at = closing(tokens, at + 2) + 1;
                continue;
            }
            ("fn", Some(name)) => {
                let ends = ["{", ";", "fn", "struct"];
                let body = (opening == "(").then(|| {
                    (closing(tokens, at + 2)..tokens.len())
                        .find(|&index| ends.contains(&tokens[index].text))
                });
                let Some(body) = body.flatten().filter(|&body| tokens[body].text == "{") else {
                    let message = format!(
                        "the function {0} is incomplete; write fn {0}(parameters) -> type {{ … }}",
                        name.text
                    );
                    return Err(text.at(name, message));
                };
                scope.names.push(name);
                scope.functions.push(Function {
                    of_pass: std::mem::take(&mut of_pass),
                    is_smooth: std::mem::take(&mut is_smooth),
                    is_reach: std::mem::take(&mut is_reach),
                    ..function(text, tokens, at, name, body)
                });
                at = closing(tokens, body) + 1;
                continue;
            }
            ("const" | "alias", Some(name)) => {
                scope.names.push(name);
                at = end_of_statement(text, tokens, at)?;
                continue;
            }
            ("const_assert", _) => {
                at = end_of_statement(text, tokens, at)?;
                continue;
            }
            ("@", Some(name)) if OF_FUNCTIONS.contains(&name.text) => {
                let (attribute, next) = attributes::read(text, tokens, at)?;
                match attribute.name {
                    "pass" => of_pass.scale = Some(pass_scale(text, &attribute)?),
                    "smooth" => is_smooth = true,
                    REACH => is_reach = true,
                    _ => of_pass.kept = Some(kept_frames(text, &attribute)?),
                }
                let follows = tokens.get(next).map_or("", |token| token.text);
                if !["fn", "@"].contains(&follows) {
                    let message = match attribute.name {
                        "smooth" => "@smooth stands before the fn of a hook".into(),
                        REACH => "@reach stands before the fn that says how far a vertex moves".into(),
                        name => format!("@{name} stands before the fn of a pass"),
                    };
                    return Err(attribute.error(text, message));
                }
                scope.attributes.push(attribute.begin..attribute.end);
                at = next;
                continue;
            }
            ("struct" | "fn" | "const" | "alias", None) => {
                format!("{} needs a name after it", token.text)
            }
            ("var", _) => "an effect declares no variable at module scope; its parameters are the members of its struct".into(),
            ("override", _) => "an effect declares no override; use const, or a parameter".into(),
            ("enable" | "requires" | "diagnostic", _) => {
                "an effect file has no directives of WGSL; remove this one".into()
            }
            ("@", _) => "attributes belong to the parameters of an effect; an effect has no entry point and no binding".into(),
            _ => format!(
                "expected struct, fn, const or alias at the start of a declaration, and found {}",
                token.text
            ),
        };
        return Err(text.at(token, refused));
    }
    Ok(scope)
}

impl<'a> Declaration<'a> {
    fn find(&self, is_it: impl Fn(&str) -> bool) -> Option<Token<'a>> {
        let mut tokens = self.tokens.iter().copied();
        tokens.find(|token| is_it(token.text))
    }

    fn is_used(&self, path: &str) -> bool {
        self.uses.iter().any(|used| used == path)
    }

    fn add_use(&mut self, path: &str) {
        if !self.is_used(path) {
            self.uses.push(path.into());
        }
    }

    /// Adds the files of the library that hooks, passes and pictures need, and refuses those that
    /// this effect cannot have.
    fn use_library(&mut self, text: &Text<'a>, scope: &Scope<'a>) -> Result<(), EffectError> {
        if let Some(image) = self.parameters.images.first() {
            if self.hooks.vertex.is_some() || self.hooks.sample.is_some() {
                let message = format!(
                    "{} is a picture, which vertices and samples cannot read; put their hooks into a file of their own",
                    image.member
                );
                return Err(text.error(image.named.start, image.named.len(), message));
            }
            self.add_use("lib/image_file");
        } else if self.is_used("lib/image_file") {
            let message = "lib/image_file reads pictures, and no parameter is one; declare one, for instance @image(\"paper.png\") paper: u32";
            return Err(text.whole(message));
        }
        for (kind, _, file) in HOOKS {
            if self.find(|word| word == kind).is_some() {
                self.add_use(&format!("lib/{file}"));
            }
            if let Some(name) = scope.names.iter().find(|name| name.text == kind) {
                let message = format!("{kind} is the type of a hook; choose another name");
                return Err(text.at(name, message));
            }
        }
        if !self.passes.is_empty() {
            if let Some(token) = self.find(|word| OF_PIXELS.contains(&word)) {
                let message = format!("{} is there in a pixel effect alone", token.text);
                return Err(text.at(token, message));
            }
            self.add_use("lib/image");
            if self.find(|word| word == "image_normal").is_some() {
                self.uses.push("lib/image_normal".into());
            }
            if let Some(token) = self.find(|word| OF_KEPT.contains(&word)) {
                if self.passes.iter().all(|pass| pass.kept.is_none()) {
                    let message = format!(
                        "{} reads what a kept pass wrote in the previous frame, and no pass of this file is one; write @kept(12, 0.04) before a pass",
                        token.text
                    );
                    return Err(text.at(token, message));
                }
                self.uses.push("lib/image_kept".into());
            }
        }
        // The library's file for pixels reads buffers, which passes with the other hooks do not have.
        let HookFunctions {
            vertex,
            sample,
            surface,
            image,
            ..
        } = &self.hooks;
        let has_others = [vertex, sample, surface].iter().any(|hook| hook.is_some())
            || (image.is_some() && !self.passes.is_empty());
        if has_others && self.is_used("lib/image") {
            let mut names = scope.functions.iter().map(|function| function.name);
            let name = names.find(|name| image.as_deref() == Some(name.text));
            let message = "only an effect with no other hook reads the picture; put the hook of Pixel, or the passes, into a file of their own";
            return Err(text.at_any(name, message));
        }
        Ok(())
    }
}

/// Index behind the semicolon of the declaration at `at`.
fn end_of_statement(
    text: &Text<'_>,
    tokens: &[Token<'_>],
    at: usize,
) -> Result<usize, EffectError> {
    let marks = ["fn", "struct", "const", "alias", "{", ";"];
    let end = (at + 1..tokens.len()).find(|&index| marks.contains(&tokens[index].text));
    let closed = end.filter(|&end| tokens[end].text == ";");
    closed.map(|end| end + 1).ok_or_else(|| {
        let last = &tokens[end.map_or(tokens.len(), |end| end) - 1];
        text.at(last, "a ; is missing after this")
    })
}

/// The head of the function whose `fn` is at `at`, and whose body opens at `body`.
fn function<'a>(
    text: &Text<'a>,
    tokens: &[Token<'a>],
    at: usize,
    name: Token<'a>,
    body: usize,
) -> Function<'a> {
    let close = closing(tokens, at + 2);
    let between = |from: usize, to: usize| -> String {
        let range = tokens.get(from..to).filter(|range| !range.is_empty());
        range.map_or(String::new(), |range| {
            text.text[range[0].offset..range[range.len() - 1].end()]
                .split_whitespace()
                .collect()
        })
    };
    let colons: Vec<usize> = (at + 3..close)
        .filter(|&index| tokens[index].text == ":")
        .collect();
    let end_of = |colon: usize| {
        let mut depth = 0_i32;
        (colon + 1..close)
            .find(|&index| {
                depth +=
                    i32::from(tokens[index].text == "<") - i32::from(tokens[index].text == ">");
                depth == 0 && tokens[index].text == ","
            })
            .unwrap_or(close)
    };
    let parameters = colons
        .iter()
        .map(|&colon| between(colon + 1, end_of(colon)))
        .collect();
    let last_type = colons
        .last()
        .and_then(|&colon| tokens.get(colon + 1))
        .copied()
        .filter(Token::is_name);
    // The result follows `->`, which is two marks.
    let result = between(close + 3, body);
    Function {
        name,
        parameters,
        last_type,
        result,
        of_pass: OfPass::default(),
        is_smooth: false,
        is_reach: false,
    }
}

/// Which function is on which hook, and the struct of parameters that all of them take.
fn hooks<'a>(
    text: &Text<'a>,
    functions: &[Function<'a>],
) -> Result<(HookFunctions, Vec<ImagePass>, Token<'a>), EffectError> {
    let mut found: [Option<&Function<'a>>; 5] = [None; 5];
    let mut passes: Vec<&Function<'a>> = Vec::new();
    for function in functions {
        let [first, second] = &function.parameters[..] else {
            continue;
        };
        let is_name = function.last_type.is_some_and(|name| name.text == second);
        let is_struct = is_name
            && !words::is_predeclared(second)
            && !HOOKS.iter().any(|(kind, ..)| kind == second);
        let Some(hook) = HOOKS
            .iter()
            .position(|(kind, result, _)| kind == first && *result == function.result)
        else {
            continue;
        };
        if !is_struct {
            continue;
        }
        if hook == PASSES {
            passes.push(function);
        } else if let Some(other) = found[hook] {
            let message = format!(
                "{} and {} both have the signature of the hook {}; change one of them",
                other.name.text, function.name.text, HOOKS[hook].0
            );
            return Err(text.at(function.name, message));
        }
        found[hook] = Some(function);
    }
    let Some(first) = found.iter().flatten().chain(&passes).next().copied() else {
        let kind_of = |function: &Function<'_>| {
            HOOKS.iter().find(|(kind, ..)| {
                function
                    .parameters
                    .first()
                    .is_some_and(|first| first == kind)
            })
        };
        if let Some((function, (kind, result, _))) = functions
            .iter()
            .find_map(|function| Some((function, kind_of(function)?)))
        {
            let name = function.name;
            let message = format!(
                "{0} takes a {kind} but is no hook; the signature of the hook is fn {0}(x: {kind}, p: Parameters) -> {result}, where \
                 Parameters is a struct of this file",
                name.text
            );
            return Err(text.at(name, message));
        }
        let message = "no function has the signature of a hook: fn name(surface: Surface, p: Parameters) -> Surface, or the same with Vertex, \
                       with Pixel, fn name(at: ImageAt, p: Parameters) -> vec4f, or fn name(sample: Sample, p: Parameters) -> bool";
        return Err(text.whole(message));
    };
    if let Some(other) = found
        .iter()
        .flatten()
        .chain(&passes)
        .find(|function| function.parameters[1] != first.parameters[1])
    {
        let message = format!(
            "{} takes {} and {} takes {}; all hooks of an effect take the same struct",
            first.name.text, first.parameters[1], other.name.text, other.parameters[1]
        );
        return Err(text.at(other.name, message));
    }
    let name = |hook: usize| found[hook].map(|function| function.name.text.to_owned());
    let hooks = HookFunctions {
        vertex: name(0),
        sample: name(1),
        sample_setup: None,
        surface: name(2),
        image: name(3),
        passes: Vec::new(),
    };
    let passes = image_passes(text, functions, &passes)?;
    let struct_name = first
        .last_type
        .expect("a hook's second parameter is a struct");
    Ok((hooks, passes, struct_name))
}

/// The lines `//@ use lib/NAME`.
fn uses(text: &Text<'_>, author: Author) -> Result<Vec<String>, EffectError> {
    let mut found = Vec::new();
    let mut offset = 0;
    for line in text.text.split_inclusive('\n') {
        if let Some(directive) = line.trim().strip_prefix("//@") {
            let used = directive.trim().strip_prefix("use ").map(str::trim);
            let is_known = author == Author::Lab
                || used
                    .and_then(|used| used.strip_prefix("lib/"))
                    .is_some_and(|name| LIBRARY.contains(&name));
            match used.filter(|_| is_known) {
                Some(used) => found.push(used.to_owned()),
                None => {
                    let files = LIBRARY.map(|name| format!("lib/{name}")).join(", ");
                    let begin = offset + line.len() - line.trim_start().len();
                    return Err(text.error(
                        begin,
                        line.trim().len(),
                        format!("an effect may use {files}"),
                    ));
                }
            }
        }
        offset += line.len();
    }
    Ok(found)
}

/// The first sentence of the comment at the top of the file, without a leading `Name:`.
fn about(text: &str, stem: &str) -> String {
    let lines = text
        .trim_start_matches('\u{feff}')
        .lines()
        .map(str::trim)
        .skip_while(|line| line.is_empty());
    let comment = lines.map_while(|line| {
        line.strip_prefix("//")
            .filter(|line| !line.starts_with('@'))
    });
    let joined = comment
        .map(|line| line.trim_start_matches(['/', '!']).trim())
        .collect::<Vec<_>>()
        .join(" ");
    let sentence = joined
        .split_inclusive(". ")
        .next()
        .unwrap_or_default()
        .trim()
        .trim_end_matches('.');
    let about = sentence
        .split_once(": ")
        .filter(|(head, _)| !head.contains(' ') || head.to_lowercase().replace(' ', "_") == stem)
        .map_or(sentence, |(_, rest)| rest);
    about.chars().take(160).collect()
}
