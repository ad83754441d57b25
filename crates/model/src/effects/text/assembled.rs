//! Assembly: what the functions of a built-in effect reach, in its file and in the library, as one
//! text. What the evaluator answers itself has no body there.

use std::collections::{BTreeMap, BTreeSet};

use super::{
    built_in::without_attributes,
    tokens::{Token, closing, tokens},
    twin::EXTERNALS,
};
use crate::shaders::{Library, sections};

/// Declarations by name.
type Declared = BTreeMap<String, String>;

/// The declarations in the file `stem` of effects, and in all that it uses, that the functions
/// `roots` reach. `constants` are those of its choices; with a picture of what surrounds the scene,
/// sections called `picture` are taken.
pub fn assembled(stem: &str, roots: &[&str], constants: &str, has_picture: bool) -> String {
    let mut declared = Declared::new();
    declare(constants, &mut declared);
    declare_file(
        &format!("effects/{stem}"),
        has_picture,
        &mut BTreeSet::new(),
        &mut declared,
    );
    let mut text = String::new();
    let mut open: Vec<String> = roots.iter().map(|&root| root.to_owned()).collect();
    while let Some(name) = open.pop() {
        if let Some(declaration) = declared.remove(&name) {
            let names = tokens(&declaration).into_iter().filter(Token::is_name);
            open.extend(names.map(|token| token.text.to_owned()));
            text += &declaration;
        }
    }
    text
}

/// Adds what a file declares, and what those that it uses do. Of a file with variants the first one
/// counts, or that of pictures.
fn declare_file(
    name: &str,
    has_picture: bool,
    known: &mut BTreeSet<String>,
    declared: &mut Declared,
) {
    let found = Library::Embedded.text(name);
    let Some(file) = found.filter(|_| known.insert(name.to_owned())) else {
        return;
    };
    let parts = sections(&file);
    let variant = match name.starts_with("variants/") {
        true => parts
            .iter()
            .find(|(name, _)| has_picture && *name == "picture")
            .or(parts.get(1)),
        false => None,
    };
    for (_, range) in parts.first().into_iter().chain(variant) {
        let text = &file[range.clone()];
        declare(&without_attributes(text), declared);
        let used = text
            .lines()
            .filter_map(|line| line.strip_prefix("//@ use "));
        used.for_each(|used| declare_file(used.trim(), has_picture, known, declared));
    }
    if name == "lib/surface" {
        // The evaluator gives every surface its finish, as kernels do whose effects read it.
        declare_file("lib/finish", has_picture, known, declared);
        if let Some(surface) = declared.get_mut("Surface") {
            *surface = surface.replace("\n}", "\n    finish: Finish,\n}");
        }
    }
}

/// Adds what a text declares; what has been declared stays.
fn declare(text: &str, declared: &mut Declared) {
    let tokens = tokens(text);
    let mut at = 0;
    while at < tokens.len() {
        let ends = |index: &usize| ["{", ";"].contains(&tokens[*index].text);
        let Some(end) = (at..tokens.len()).find(ends) else {
            return;
        };
        let end = match tokens[end].text {
            "{" => closing(&tokens, end),
            _ => end,
        };
        let words = ["fn", "struct", "const", "override", "alias", "var"];
        let is_word = |index: &usize| words.contains(&tokens[*index].text);
        if let Some(head) = (at..end).find(is_word) {
            // `var<private> name`
            let name = (head + 1..end).find(|&index| match tokens[head].text {
                "var" => tokens[index - 1].text == ">",
                _ => tokens[index].is_name(),
            });
            if let Some(name) = name.map(|index| tokens[index].text) {
                let whole = &text[tokens[head].offset..tokens[end].end()];
                let declaration = match EXTERNALS.contains(&name) {
                    true => without_body(whole),
                    false => format!("{whole}\n"),
                };
                declared.entry(name.to_owned()).or_insert(declaration);
            }
        }
        at = end + 1;
    }
}

/// A function that returns zero.
fn without_body(function: &str) -> String {
    let head = function.split('{').next().unwrap_or_default();
    let result = head.rsplit("->").next().unwrap_or_default().trim();
    format!("{head} {{ return {result}(); }}\n")
}
