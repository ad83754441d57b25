//! Declarations: what an effect file declares at module scope, which of its functions are hooks, and what it may not contain.

use std::collections::BTreeSet;

use super::{
    error::{EffectError, Text},
    parameters::{self, Parameters},
    tokens::{Token, closing, tokens},
};
use crate::effects::HookFunctions;

/// Files of `shaders/lib` that an effect file may use: pure functions and the types of hooks.
pub const LIBRARY: [&str; 10] = ["angle", "color", "front", "geometry", "hash", "image", "lattice", "sample", "surface", "vertex"];

/// The hooks: type of the first parameter, type of the result, and the library file that declares the former.
const HOOKS: [(&str, &str, &str); 4] =
    [("Vertex", "Vertex", "vertex"), ("Sample", "bool", "sample"), ("Surface", "Surface", "surface"), ("Pixel", "Pixel", "image")];

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
    /// Names declared at module scope.
    pub declared: BTreeSet<&'a str>,
    /// Files that it uses, as `lib/surface`; those of its hooks' types are among them.
    pub uses: Vec<String>,
}

/// A function as its head declares it.
struct Function<'a> {
    name: Token<'a>,
    /// Types of the parameters.
    parameters: Vec<String>,
    result: String,
}

/// Reads an effect file.
///
/// # Errors
/// A declaration that an effect cannot have, no hook, two functions on one hook, or as [`parameters::read`].
pub fn read<'a>(text: &Text<'a>) -> Result<Declaration<'a>, EffectError> {
    let tokens = tokens(text.text);
    refuse_names(text, &tokens)?;
    let uses = uses(text)?;
    let (mut structs, mut functions, mut declared) = (Vec::new(), Vec::new(), BTreeSet::new());
    let mut at = 0;
    while at < tokens.len() {
        let token = tokens[at];
        let refuse = |message: &str| Err(text.error(token.offset, token.text.len(), message));
        let name = tokens.get(at + 1).copied().filter(Token::is_name);
        match (token.text, name) {
            (";", _) => at += 1,
            ("struct", Some(name)) => {
                declared.insert(name.text);
                structs.push((name, at + 2));
                at = closing(&tokens, at + 2) + 1;
            }
            ("fn", Some(name)) => {
                declared.insert(name.text);
                let (function, body) = function(text, &tokens, at, name);
                functions.push(function);
                at = closing(&tokens, body) + 1;
            }
            ("const" | "alias", Some(name)) => {
                declared.insert(name.text);
                at = (at..tokens.len()).find(|&index| tokens[index].text == ";").unwrap_or(tokens.len());
            }
            ("const_assert", _) => at = (at..tokens.len()).find(|&index| tokens[index].text == ";").unwrap_or(tokens.len()),
            ("var", _) => return refuse("an effect declares no variable at module scope; its parameters are the members of its struct"),
            ("override", _) => return refuse("an effect declares no override; use const, or a parameter"),
            ("enable" | "requires" | "diagnostic", _) => return refuse("an effect file has no directives of WGSL"),
            ("@", _) => return refuse("attributes belong to the parameters of an effect; an effect has no entry point and no binding"),
            _ => return refuse("expected a struct, a function or a constant"),
        }
    }
    let (hooks, struct_name) = hooks(text, &functions)?;
    let Some((_, open)) = structs.iter().find(|(name, _)| name.text == struct_name) else {
        return Err(
            text.whole(format!("the hook takes {struct_name}, which this file does not declare; write struct {struct_name} {{ … }}"))
        );
    };
    let parameters = parameters::read(text, &tokens, *open)?;
    let mut uses = uses;
    for (kind, _, file) in HOOKS {
        let is_named = tokens.iter().any(|token| token.text == kind);
        let path = format!("lib/{file}");
        if is_named && !uses.contains(&path) {
            uses.push(path);
        }
        if declared.contains(kind) {
            return Err(text.whole(format!("{kind} is the type of a hook, so an effect cannot declare it; choose another name")));
        }
    }
    let about = about(text.text);
    Ok(Declaration { about, tokens, struct_name, parameters, hooks, declared, uses })
}

/// The head of the function whose `fn` is at `at`; also returns the index of the brace that opens its body.
fn function<'a>(text: &Text<'a>, tokens: &[Token<'a>], at: usize, name: Token<'a>) -> (Function<'a>, usize) {
    let close = closing(tokens, at + 2);
    let body = (close..tokens.len()).find(|&index| tokens[index].text == "{").unwrap_or(tokens.len() - 1);
    let between = |from: usize, to: usize| -> String {
        let range = tokens.get(from..to).filter(|range| !range.is_empty());
        range.map_or(String::new(), |range| text.text[range[0].offset..range[range.len() - 1].end()].split_whitespace().collect())
    };
    let colons: Vec<usize> = (at + 3..close).filter(|&index| tokens[index].text == ":").collect();
    let end_of = |colon: usize| {
        let mut depth = 0_i32;
        (colon + 1..close)
            .find(|&index| {
                depth += i32::from(tokens[index].text == "<") - i32::from(tokens[index].text == ">");
                depth == 0 && tokens[index].text == ","
            })
            .unwrap_or(close)
    };
    let parameters = colons.iter().map(|&colon| between(colon + 1, end_of(colon))).collect();
    // The result follows `->`, which is two marks.
    let result = between(close + 3, body);
    (Function { name, parameters, result }, body)
}

/// Which function is on which hook, and the struct of parameters that all of them take.
fn hooks<'a>(text: &Text<'a>, functions: &[Function<'a>]) -> Result<(HookFunctions, &'a str), EffectError> {
    let mut found: [Option<&Function<'a>>; 4] = [None; 4];
    for function in functions {
        let [first, second] = &function.parameters[..] else { continue };
        let is_struct = second.starts_with(|c: char| c.is_ascii_uppercase()) && !HOOKS.iter().any(|(kind, ..)| kind == second);
        let Some(hook) = HOOKS.iter().position(|(kind, result, _)| kind == first && *result == function.result) else {
            continue;
        };
        if !is_struct {
            continue;
        }
        if let Some(other) = found[hook] {
            let message = format!(
                "{} and {} both have the signature of the hook {}; change one of them",
                other.name.text, function.name.text, HOOKS[hook].0
            );
            return Err(text.error(function.name.offset, function.name.text.len(), message));
        }
        found[hook] = Some(function);
    }
    let Some(first) = found.iter().flatten().next() else {
        let message = "no function has the signature of a hook: fn name(surface: Surface, p: Parameters) -> Surface, or the same with Vertex, \
                       with Pixel, or fn name(sample: Sample, p: Parameters) -> bool";
        return Err(text.whole(message));
    };
    if let Some(other) = found.iter().flatten().find(|function| function.parameters[1] != first.parameters[1]) {
        let message = format!(
            "{} takes {} and {} takes {}; all hooks of an effect take the same struct",
            first.name.text, first.parameters[1], other.name.text, other.parameters[1]
        );
        return Err(text.error(other.name.offset, other.name.text.len(), message));
    }
    let name = |hook: usize| found[hook].map(|function| function.name.text.to_owned());
    let hooks = HookFunctions { vertex: name(0), sample: name(1), sample_setup: None, surface: name(2), image: name(3) };
    let at = text.text.find(&first.parameters[1]).unwrap_or(0);
    Ok((hooks, &text.text[at..at + first.parameters[1].len()]))
}

/// The lines `//@ use lib/NAME`.
fn uses(text: &Text<'_>) -> Result<Vec<String>, EffectError> {
    let mut found = Vec::new();
    let mut offset = 0;
    for line in text.text.split_inclusive('\n') {
        if let Some(directive) = line.trim().strip_prefix("//@") {
            let used = directive.trim().strip_prefix("use ").map(str::trim);
            let is_known = used.and_then(|used| used.strip_prefix("lib/")).is_some_and(|name| LIBRARY.contains(&name));
            match used.filter(|_| is_known) {
                Some(used) => found.push(used.to_owned()),
                None => {
                    let files = LIBRARY.map(|name| format!("lib/{name}")).join(", ");
                    let begin = offset + line.len() - line.trim_start().len();
                    return Err(text.error(begin, line.trim().len(), format!("an effect may use {files}")));
                }
            }
        }
        offset += line.len();
    }
    Ok(found)
}

/// Refuses what only kernels may do.
fn refuse_names(text: &Text<'_>, tokens: &[Token<'_>]) -> Result<(), EffectError> {
    const WORDS: [(&str, &str); 9] = [
        ("workgroupBarrier", "barriers"),
        ("storageBarrier", "barriers"),
        ("textureBarrier", "barriers"),
        ("workgroupUniformLoad", "workgroup memory"),
        ("workgroup", "workgroup memory"),
        ("storage", "bindings"),
        ("uniform", "bindings"),
        ("arrayLength", "bindings"),
        ("private", "variables outside functions"),
    ];
    const BEGINNINGS: [(&str, &str); 8] = [
        ("atomic", "atomics"),
        ("texture", "textures"),
        ("sampler", "textures"),
        ("dpdx", "derivatives"),
        ("dpdy", "derivatives"),
        ("fwidth", "derivatives"),
        ("subgroup", "subgroup operations"),
        ("quad", "subgroup operations"),
    ];
    for (index, token) in tokens.iter().enumerate() {
        let is_member = index > 0 && tokens[index - 1].text == ".";
        // A word of the language stands before a parenthesis or inside angle brackets; anything else is a name of the author's.
        let next = tokens.get(index + 1).map_or("", |token| token.text);
        let before = if index > 0 { tokens[index - 1].text } else { "" };
        let is_used = next == "(" || next == "<" || before == "<" || before == ":";
        if is_member || !is_used || before == "fn" {
            continue;
        }
        let word = WORDS.iter().find(|(word, _)| *word == token.text);
        let begun = BEGINNINGS.iter().find(|(begin, _)| {
            token
                .text
                .strip_prefix(begin)
                .is_some_and(|rest| rest.is_empty() || rest.starts_with(|c: char| c.is_ascii_uppercase() || c == '_' || c.is_ascii_digit()))
        });
        if let Some((_, what)) = word.or(begun) {
            return Err(text.error(
                token.offset,
                token.text.len(),
                format!("{}: an effect has no {what}; it is a pure function of its arguments", token.text),
            ));
        }
    }
    Ok(())
}

/// The first sentence of the comment at the top of the file, without a leading `Name:`.
fn about(text: &str) -> String {
    let lines = text.lines().map(str::trim).skip_while(|line| line.is_empty());
    let comment = lines.map_while(|line| line.strip_prefix("//").filter(|line| !line.starts_with('@')));
    let joined = comment.map(|line| line.trim_start_matches(['/', '!']).trim()).collect::<Vec<_>>().join(" ");
    let sentence = joined.split_inclusive(". ").next().unwrap_or_default().trim().trim_end_matches('.');
    let about = sentence.split_once(": ").filter(|(head, _)| !head.contains(' ')).map_or(sentence, |(_, rest)| rest);
    about.chars().take(160).collect()
}
