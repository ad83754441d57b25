//! Sources: what the head or a section of a WGSL file declares, what it refers to, and its `//@`
//! directives. A scan of tokens, not a compiler: it needs no more of the language than
//! declarations, local names and member access.

use std::collections::BTreeSet;

/// Directive lines of a shader file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Directive {
    /// `//@ use NAME`
    Use(String),
    /// `//@ binding DECLARATION`: declared here, unless the stage declares the same name with
    /// another access.
    Binding { name: String, declaration: String },
    /// `//@ declare SIGNATURE` in the head of variants: what each of them must define.
    Declare(Signature),
    /// `//@ may declare SIGNATURE` in the head of variants: what one of them may define besides.
    MayDeclare(Signature),
    /// `//@ steps SIGNATURE`: the function that calls all chosen steps among the sections of this
    /// file.
    Steps(Signature),
}

/// `fn name(parameters) -> type`, `struct name` or `var name`, as an interface writes it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Signature {
    pub name: String,
    /// The whole signature with single spaces; `fn name` alone where types differ from variant to
    /// variant.
    pub text: String,
}

impl Signature {
    fn parse(text: &str) -> Option<Self> {
        let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
        let (_, rest) = text.split_once(' ')?;
        let name = rest
            .split(|c: char| !is_word(c))
            .next()
            .filter(|name| !name.is_empty())?
            .to_owned();
        Some(Self { name, text })
    }

    /// Name and type of each parameter.
    pub fn parameters(&self) -> Vec<(&str, &str)> {
        let inner = self
            .text
            .split_once('(')
            .and_then(|(_, rest)| rest.split_once(')'))
            .map_or("", |(inner, _)| inner);
        inner
            .split(',')
            .filter_map(|parameter| parameter.split_once(':'))
            .map(|(name, kind)| (name.trim(), kind.trim()))
            .collect()
    }

    /// The type that the function returns.
    pub fn result(&self) -> Option<&str> {
        self.text.split_once("->").map(|(_, kind)| kind.trim())
    }

    /// The same signature under another name.
    pub fn renamed(&self, name: &str) -> String {
        self.text.replacen(&self.name, name, 1)
    }
}

/// What a head or a section declares and refers to.
#[derive(Clone, Debug, Default)]
pub struct Source {
    /// Directives with their lines, from 1.
    pub directives: Vec<(Directive, u32)>,
    /// Names that its own text declares at module scope.
    pub declared: BTreeSet<String>,
    /// Names that the text refers to and no scope inside it declares, each with the first line
    /// that does.
    pub references: Vec<(String, u32)>,
    /// Every function's signature with single spaces, without attributes.
    pub functions: Vec<String>,
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

struct Token<'a> {
    text: &'a str,
    line: u32,
}

impl Token<'_> {
    fn is_name(&self) -> bool {
        self.text
            .starts_with(|c: char| c.is_alphabetic() || c == '_')
    }
}

/// Words, numbers and single marks; comments are left out.
fn tokens(text: &str) -> Vec<Token<'_>> {
    let mut tokens = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let code = line.split("//").next().unwrap_or_default();
        let mut rest = code;
        while let Some(first) = rest.chars().next() {
            let length = if is_word(first) {
                // A point belongs to a number, not to a name.
                let is_number = first.is_ascii_digit();
                rest.find(|c: char| !(is_word(c) || (is_number && c == '.')))
                    .unwrap_or(rest.len())
            } else {
                first.len_utf8()
            };
            if !first.is_whitespace() {
                tokens.push(Token {
                    text: &rest[..length],
                    line: index as u32 + 1,
                });
            }
            rest = &rest[length..];
        }
    }
    tokens
}

fn directive(line: &str) -> Option<Directive> {
    let line = line.trim_start().strip_prefix("//@ ")?.trim();
    let (word, rest) = line.split_once(' ')?;
    match word {
        "use" => Some(Directive::Use(rest.trim().to_owned())),
        "declare" => Signature::parse(rest).map(Directive::Declare),
        "may" => rest
            .strip_prefix("declare ")
            .and_then(Signature::parse)
            .map(Directive::MayDeclare),
        "steps" => Signature::parse(rest).map(Directive::Steps),
        "binding" => {
            let name = rest
                .split_once('>')
                .map_or(rest, |(_, after)| after)
                .split(':')
                .next()?
                .trim()
                .to_owned();
            Some(Directive::Binding {
                name,
                declaration: rest.to_owned(),
            })
        }
        _ => None,
    }
}

impl Source {
    pub fn parse(text: &str) -> Self {
        let mut source = Self::default();
        let numbered = text.lines().enumerate();
        source.directives = numbered
            .filter_map(|(index, line)| directive(line).map(|found| (found, index as u32 + 1)))
            .collect();
        let tokens = tokens(text);
        let mut at = 0;
        while at < tokens.len() {
            at = source.item(&tokens, at);
        }
        let declared = source.declared.clone();
        source
            .references
            .retain(|(name, _)| !declared.contains(name));
        source
    }

    /// Reads one module-scope declaration that begins at `at`; returns where the next one begins.
    fn item(&mut self, tokens: &[Token<'_>], mut at: usize) -> usize {
        at = self.attributes(tokens, at);
        let Some(token) = tokens.get(at) else {
            return tokens.len();
        };
        let keyword = token.text;
        if !matches!(
            keyword,
            "fn" | "struct" | "const" | "override" | "alias" | "var"
        ) {
            return at + 1;
        }
        let mut name_at = at + 1;
        if keyword == "var" && tokens.get(name_at).is_some_and(|token| token.text == "<") {
            name_at += tokens[name_at..]
                .iter()
                .position(|token| token.text == ">")
                .unwrap_or_default()
                + 1;
        }
        let Some(name) = tokens.get(name_at) else {
            return tokens.len();
        };
        self.declared.insert(name.text.to_owned());
        let end = match keyword {
            "fn" | "struct" => end_of_block(tokens, name_at),
            _ => tokens[name_at..]
                .iter()
                .position(|token| token.text == ";")
                .map_or(tokens.len(), |offset| name_at + offset + 1),
        };
        let body = &tokens[name_at + 1..end];
        if keyword == "fn" {
            self.functions.push(signature_of(&tokens[at..end]));
        }
        self.refer(body, keyword == "struct");
        end
    }

    /// Skips attributes; what they name in parentheses counts as referred to, but for words of the
    /// language.
    fn attributes(&mut self, tokens: &[Token<'_>], mut at: usize) -> usize {
        while tokens.get(at).is_some_and(|token| token.text == "@") {
            let end = end_of_attribute(tokens, at);
            self.refer_attribute(&tokens[at..end]);
            at = end;
        }
        at
    }

    fn refer_attribute(&mut self, tokens: &[Token<'_>]) {
        if tokens
            .get(1)
            .is_some_and(|token| token.text == "workgroup_size")
        {
            tokens[2..]
                .iter()
                .filter(|token| token.is_name())
                .for_each(|token| self.reference(token));
        }
    }

    fn reference(&mut self, token: &Token<'_>) {
        if self.references.iter().all(|(name, _)| name != token.text) {
            self.references.push((token.text.to_owned(), token.line));
        }
    }

    /// Names in a declaration that it does not declare itself.
    fn refer(&mut self, tokens: &[Token<'_>], is_struct: bool) {
        let mut locals: BTreeSet<&str> = BTreeSet::new();
        for pair in tokens.windows(2) {
            if matches!(pair[0].text, "let" | "var" | "const") && pair[1].is_name() {
                locals.insert(pair[1].text);
            }
        }
        let mut at = 0;
        // Parameters, and members of a struct, stand before a colon.
        let is_before_colon = |at: usize| tokens.get(at + 1).is_some_and(|token| token.text == ":");
        let opening = tokens
            .iter()
            .position(|token| token.text == "{")
            .unwrap_or(tokens.len());
        for (index, token) in tokens.iter().enumerate() {
            if token.is_name() && is_before_colon(index) && !is_struct && index < opening {
                locals.insert(token.text);
            }
        }
        while at < tokens.len() {
            let token = &tokens[at];
            if token.text == "@" {
                let end = end_of_attribute(tokens, at);
                self.refer_attribute(&tokens[at..end]);
                at = end;
                continue;
            }
            let is_member = at > 0 && tokens[at - 1].text == ".";
            let is_declaration = is_struct && is_before_colon(at);
            if token.is_name() && !is_member && !is_declaration && !locals.contains(token.text) {
                self.reference(token);
            }
            at += 1;
        }
    }

    /// Does a function with this signature stand in the text? Where the signature has no
    /// parameters, any function of its name.
    pub fn defines(&self, signature: &Signature) -> bool {
        match signature.text.contains('(') {
            true => self.functions.contains(&signature.text),
            false => self.declared.contains(&signature.name),
        }
    }

    /// Names of files, variants, steps and glue that it uses.
    pub fn uses(&self) -> impl Iterator<Item = &str> {
        self.directives
            .iter()
            .filter_map(|(directive, _)| match directive {
                Directive::Use(name) => Some(name.as_str()),
                _ => None,
            })
    }

    /// Functions that call steps among the sections of its file.
    pub fn steps(&self) -> impl Iterator<Item = &Signature> {
        self.directives
            .iter()
            .filter_map(|(directive, _)| match directive {
                Directive::Steps(signature) => Some(signature),
                _ => None,
            })
    }
}

fn end_of_block(tokens: &[Token<'_>], from: usize) -> usize {
    let mut depth = 0;
    for (index, token) in tokens.iter().enumerate().skip(from) {
        match token.text {
            "{" => depth += 1,
            "}" => {
                depth -= 1;
                if depth == 0 {
                    return index + 1;
                }
            }
            _ => {}
        }
    }
    tokens.len()
}

fn end_of_attribute(tokens: &[Token<'_>], at: usize) -> usize {
    if tokens.get(at + 2).is_none_or(|token| token.text != "(") {
        return at + 2;
    }
    tokens[at..]
        .iter()
        .position(|token| token.text == ")")
        .map_or(tokens.len(), |offset| at + offset + 1)
}

/// A function's head with single spaces, as interfaces write it.
fn signature_of(tokens: &[Token<'_>]) -> String {
    let mut text = String::new();
    let mut previous = "";
    for token in tokens.iter().take_while(|token| token.text != "{") {
        let is_tight = matches!(token.text, "," | ":" | "(" | ")" | "<" | ">")
            || matches!(previous, "" | "(" | "<");
        if !is_tight {
            text.push(' ');
        }
        text.push_str(token.text);
        previous = token.text;
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signatures_read_as_interfaces_write_them() {
        let source = Source::parse(
            "fn depth_plane(depths: vec3u, area: Wide) -> DepthPlane {\n return a;\n}\nfn f(a: array<vec4f, 3>) {}",
        );
        assert_eq!(
            source.functions,
            [
                "fn depth_plane(depths: vec3u, area: Wide) -> DepthPlane",
                "fn f(a: array<vec4f, 3>)"
            ]
        );
    }

    #[test]
    fn locals_members_and_comments_are_no_references() {
        let text = "// uses nothing\nstruct S { frame: u32 }\nfn f(a: S) -> u32 {\n    let b = a.frame; // frame\n    return b + 1.0f + g(b) + C;\n}\n";
        let source = Source::parse(text);
        assert_eq!(source.declared.iter().collect::<Vec<_>>(), ["S", "f"]);
        let names: Vec<(&str, u32)> = source
            .references
            .iter()
            .map(|(name, line)| (name.as_str(), *line))
            .collect();
        assert_eq!(
            names,
            [("u32", 2), ("let", 4), ("return", 5), ("g", 5), ("C", 5)]
        );
    }
}
