//! Promise: inside a room no file imports a file that imports it back, directly or through others.
//!
//! An import is a `use` or a path in the code that leads to something another file of the same room defines. Paths are
//! followed through `self`, `super`, `crate::room` and re-exports to the file that defines the name, so
//! `use super::Scene` in `scene/draw.rs` means `scene/mod.rs` only if `mod.rs` itself defines `Scene`. `mod name;` alone is no
//! import, and unit tests (`#[cfg(test)] mod …`) are not looked at: they may name everything that they test.
//!
//! A failure shows one circle as a path of files, each arrow with the name it is there for:
//! `src/scene/draw.rs -[Bounds]-> src/scene/mod.rs -[draws]-> src/scene/draw.rs`. Cut the arrow that points upwards: move what
//! both files need into a file below both (usually a type, out of `mod.rs`), and let `mod.rs` declare and re-export only.
//!
//! `cargo test --release --test house circle` runs these tests alone. A room that has no circle any more must leave [`ROOMS_WITH_CIRCLES`];
//! the list only shrinks.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::Path,
};

/// Rooms whose files still import each other in circles.
const ROOMS_WITH_CIRCLES: &[&str] = &[];

/// Names of modules from the crate's root to a file: `["scene", "draw"]`.
type ModulePath = Vec<String>;

/// One source file.
#[derive(Default)]
struct Module {
    /// `src/scene/draw.rs`.
    file: String,
    /// Modules that are files of their own, one level down.
    children: BTreeSet<String>,
    /// Functions, types, constants and macros that the file defines, and its inline modules.
    items: BTreeSet<String>,
    uses: Vec<Use>,
    /// Paths of at least two names in the code, each with the number of inline modules round it.
    paths: Vec<(Vec<String>, usize)>,
}

/// One name that a `use` brings in.
struct Use {
    path: Vec<String>,
    /// What the file calls it; `*` for everything in a module.
    name: String,
    /// Number of inline modules round it.
    depth: usize,
}

/// What a path leads to.
#[derive(Clone, Debug, PartialEq)]
enum Target {
    Module(ModulePath),
    /// Something that the file of this module defines.
    Item(ModulePath),
}

/// All modules of the crate by path; the root has the empty one.
struct Modules(BTreeMap<ModulePath, Module>);

// ---------------------------------------------------------------- reading

/// Identifiers, `::` and single characters of Rust text, without comments, literals and unit tests.
fn tokens(text: &str) -> Vec<String> {
    let chars: Vec<char> = text.chars().collect();
    let mut tokens: Vec<String> = Vec::new();
    let mut at = 0;
    while at < chars.len() {
        let rest = &chars[at..];
        at += match rest {
            ['/', '/', ..] => rest.iter().take_while(|c| **c != '\n').count(),
            ['/', '*', ..] => rest.windows(2).position(|pair| pair == ['*', '/']).map_or(rest.len(), |end| end + 2),
            ['r', '"' | '#', ..] if raw_string(rest).is_some() => raw_string(rest).expect("just seen"),
            ['"', ..] => quoted(rest),
            // A character, not a lifetime.
            ['\'', '\\', ..] => 2 + rest[2..].iter().skip(1).position(|c| *c == '\'').map_or(rest.len() - 2, |end| end + 2),
            ['\'', _, '\'', ..] => 3,
            [':', ':', ..] => {
                tokens.push("::".into());
                2
            }
            [c, ..] if c.is_alphanumeric() || *c == '_' => {
                let word: String = rest.iter().take_while(|c| c.is_alphanumeric() || **c == '_').collect();
                let length = word.chars().count();
                tokens.push(word);
                length
            }
            [c, ..] => {
                if !c.is_whitespace() {
                    tokens.push(c.to_string());
                }
                1
            }
            [] => 1,
        };
    }
    without_tests(tokens)
}

/// Length of the raw string that begins here.
fn raw_string(chars: &[char]) -> Option<usize> {
    let fences = chars[1..].iter().take_while(|c| **c == '#').count();
    let close: Vec<char> = std::iter::once('"').chain(std::iter::repeat_n('#', fences)).collect();
    if chars.get(1 + fences) != Some(&'"') {
        return None;
    }
    let body = &chars[2 + fences..];
    body.windows(fences + 1).position(|end| end == close).map(|end| 3 + 2 * fences + end)
}

/// Length of the string that begins here.
fn quoted(chars: &[char]) -> usize {
    let mut at = 1;
    while at < chars.len() && chars[at] != '"' {
        at += if chars[at] == '\\' { 2 } else { 1 };
    }
    at + 1
}

/// Drops `#[cfg(test)] mod name { … }`.
fn without_tests(tokens: Vec<String>) -> Vec<String> {
    let opening = ["#", "[", "cfg", "(", "test", ")", "]", "mod"];
    let mut kept = Vec::new();
    let mut at = 0;
    while at < tokens.len() {
        if tokens[at..].len() > opening.len() + 1 && tokens[at..].iter().zip(opening).all(|(token, opening)| token == opening) {
            at = closing(&tokens, at + opening.len() + 1) + 1;
        } else {
            kept.push(tokens[at].clone());
            at += 1;
        }
    }
    kept
}

/// Where the bracket that opens at `at` closes again.
fn closing(tokens: &[String], at: usize) -> usize {
    let mut depth = 0usize;
    for (offset, token) in tokens[at..].iter().enumerate() {
        match token.as_str() {
            "{" => depth += 1,
            "}" if depth == 1 => return at + offset,
            "}" => depth -= 1,
            _ => {}
        }
    }
    tokens.len()
}

fn is_name(token: &str) -> bool {
    token.starts_with(|c: char| c.is_alphabetic() || c == '_')
}

impl Module {
    fn read(file: String, text: &str) -> Self {
        let tokens = tokens(text);
        let mut module = Self { file, ..Self::default() };
        // Bracket depths at which inline modules close.
        let (mut inline, mut depth) = (Vec::new(), 0usize);
        let mut at = 0;
        while at < tokens.len() {
            let next = tokens.get(at + 1).map_or("", String::as_str);
            match tokens[at].as_str() {
                "{" => depth += 1,
                "}" => {
                    depth = depth.saturating_sub(1);
                    inline.pop_if(|closes| *closes == depth);
                }
                "pub" if next == "(" => at += tokens[at..].iter().position(|token| token == ")").unwrap_or(1),
                "use" => {
                    let end = at + tokens[at..].iter().position(|token| token == ";").unwrap_or(1);
                    module.read_use(&tokens[at + 1..end], &[], inline.len());
                    at = end;
                }
                "mod" if tokens.get(at + 2).is_some_and(|token| token == "{") => {
                    module.items.insert(next.into());
                    inline.push(depth);
                }
                "struct" | "enum" | "union" | "trait" | "fn" | "const" | "static" | "type" if is_name(next) => {
                    module.items.insert(next.into());
                }
                "macro_rules" => _ = module.items.insert(tokens.get(at + 2).cloned().unwrap_or_default()),
                // What is handed to a macro outside of all brackets may be modules: `effects![boxes, points];`.
                "!" if depth == 0 && next == "[" => {
                    let given = tokens[at..].iter().take_while(|token| *token != "]").filter(|token| is_name(token));
                    module.paths.extend(given.map(|name| (vec!["self".into(), name.clone()], inline.len())));
                }
                name if is_name(name) && next == "::" && (at == 0 || tokens[at - 1] != "::") => {
                    let mut path = vec![name.to_owned()];
                    while tokens.get(at + 1).is_some_and(|token| token == "::") && tokens.get(at + 2).is_some_and(|token| is_name(token)) {
                        path.push(tokens[at + 2].clone());
                        at += 2;
                    }
                    if path.len() > 1 && !(at > 0 && path[0] == "crate" && tokens[at - 1] == "$") {
                        module.paths.push((path, inline.len()));
                    }
                }
                _ => {}
            }
            at += 1;
        }
        module
    }

    /// Reads one tree of a `use`, whose branches all begin with `prefix`.
    fn read_use(&mut self, tree: &[String], prefix: &[String], depth: usize) {
        let mut path = prefix.to_vec();
        for (at, token) in tree.iter().enumerate() {
            match token.as_str() {
                "{" => {
                    let end = at + closing(&tree[at..], 0);
                    branches(&tree[at + 1..end.min(tree.len())]).into_iter().for_each(|branch| self.read_use(branch, &path, depth));
                    return;
                }
                "as" => {
                    let name = tree.get(at + 1).cloned().unwrap_or_default();
                    return self.uses.push(Use { path, name, depth });
                }
                "*" => return self.uses.push(Use { path, name: "*".into(), depth }),
                // `use room::{self}` brings in the room.
                "self" if !path.is_empty() => {}
                name if is_name(name) => path.push(name.to_owned()),
                _ => {}
            }
        }
        if let Some(name) = path.last().cloned() {
            self.uses.push(Use { path, name, depth });
        }
    }
}

/// The branches of `{a, b::{c, d}}`, whose outer brackets are gone.
fn branches(tree: &[String]) -> Vec<&[String]> {
    let (mut depth, mut from, mut found) = (0, 0, Vec::new());
    for (at, token) in tree.iter().enumerate() {
        match token.as_str() {
            "{" => depth += 1,
            "}" => depth -= 1,
            "," if depth == 0 => {
                found.push(&tree[from..at]);
                from = at + 1;
            }
            _ => {}
        }
    }
    found.push(&tree[from..]);
    found.into_iter().filter(|branch| !branch.is_empty()).collect()
}

// ---------------------------------------------------------------- following paths

impl Modules {
    fn of_crate() -> Self {
        let mut modules = BTreeMap::new();
        read_folder(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), &[], "src", &mut modules);
        Self::linked(modules)
    }

    /// Tells every module which files stand below it.
    fn linked(mut modules: BTreeMap<ModulePath, Module>) -> Self {
        for path in modules.keys().cloned().collect::<Vec<_>>() {
            if let Some((name, parent)) = path.split_last() {
                modules.get_mut(parent).expect("a folder has a mod.rs").children.insert(name.clone());
            }
        }
        Self(modules)
    }

    /// What a path means in the file of `from`, inside of `depth` inline modules; none where it leads out of the crate.
    fn resolve(&self, from: &ModulePath, path: &[String], depth: usize, steps: usize) -> Option<Target> {
        if steps == 0 {
            return None;
        }
        let (first, mut rest) = path.split_first()?;
        let mut start = match first.as_str() {
            "crate" => Vec::new(),
            "self" | "super" => {
                let mut supers = usize::from(first == "super");
                while rest.first().is_some_and(|name| name == "super") {
                    (supers, rest) = (supers + 1, &rest[1..]);
                }
                // An inline module's parent is the file itself.
                from[..from.len().checked_sub(supers.saturating_sub(depth))?].to_vec()
            }
            _ => {
                rest = path;
                from.clone()
            }
        };
        let is_relative = rest.len() == path.len();
        for (at, name) in rest.iter().enumerate() {
            let module = self.0.get(&start)?;
            if module.children.contains(name) {
                start.push(name.clone());
                continue;
            }
            if let Some(found) = module.uses.iter().find(|found| found.name == *name && found.path != path) {
                match self.resolve(&start, &found.path, found.depth, steps - 1) {
                    Some(Target::Module(module)) => {
                        start = module;
                        continue;
                    }
                    found => return found,
                }
            }
            if module.items.contains(name) {
                return Some(Target::Item(start));
            }
            for glob in module.uses.iter().filter(|found| found.name == "*") {
                let Some(Target::Module(inside)) = self.resolve(&start, &glob.path, glob.depth, steps - 1) else { continue };
                if self.0.get(&inside).is_some_and(|module| module.items.contains(name)) {
                    return Some(Target::Item(inside));
                }
            }
            // A name of another crate, or of the language.
            return if is_relative && at == 0 { None } else { Some(Target::Item(start)) };
        }
        Some(Target::Module(start))
    }

    /// The files of a room that each of its files imports, with a name that it imports.
    fn imports(&self, room: &str) -> BTreeMap<&str, BTreeMap<&str, String>> {
        let mut imports = BTreeMap::new();
        for (path, module) in self.0.iter().filter(|(path, _)| path.first().is_some_and(|first| first == room)) {
            let mut files: BTreeMap<&str, String> = BTreeMap::new();
            let mut add = |name: &[String], target: Option<Target>| {
                let to = match target {
                    Some(Target::Item(to)) => to,
                    // A module handed to a macro; other modules count where something in them is named.
                    Some(Target::Module(to)) if name.len() == 2 && name[0] == "self" => to,
                    _ => return,
                };
                if to != *path && to.first().is_some_and(|first| first == room) {
                    files.entry(&self.0[&to].file).or_insert_with(|| name.last().cloned().unwrap_or_default());
                }
            };
            for found in &module.uses {
                let target = self.resolve(path, &found.path, found.depth, 16);
                let whole = if found.name == "*" { target.map(|(Target::Module(m) | Target::Item(m))| Target::Item(m)) } else { target };
                add(&found.path, whole);
            }
            for (name, depth) in &module.paths {
                add(name, self.resolve(path, name, *depth, 16));
            }
            imports.insert(module.file.as_str(), files);
        }
        imports
    }

    /// A circle of imports in a room, as a path of files from one back to itself; none where there is none.
    fn circle(&self, room: &str) -> Option<String> {
        let imports = self.imports(room);
        // The shortest way back to each file, and of those the shortest.
        let mut circles: Vec<Vec<&str>> = imports.keys().filter_map(|file| way_back(&imports, file)).collect();
        circles.sort_by_key(Vec::len);
        let shortest = circles.first()?;
        let arrows = shortest.windows(2).map(|pair| format!("{} -[{}]-> ", pair[0], imports[pair[0]][pair[1]]));
        Some(arrows.collect::<String>() + shortest[0])
    }

    fn rooms(&self) -> &BTreeSet<String> {
        &self.0[&Vec::new()].children
    }
}

/// The shortest way from a file along its imports back to itself.
fn way_back<'a>(imports: &BTreeMap<&'a str, BTreeMap<&'a str, String>>, start: &'a str) -> Option<Vec<&'a str>> {
    let mut came_from: BTreeMap<&str, &str> = BTreeMap::new();
    let mut waiting = std::collections::VecDeque::from([start]);
    while let Some(file) = waiting.pop_front() {
        for &next in imports.get(file)?.keys() {
            if next == start {
                let mut way = vec![start, file];
                while let Some(before) = way.last().filter(|file| **file != start).and_then(|file| came_from.get(file)) {
                    way.push(before);
                }
                way.reverse();
                return Some(if file == start { vec![start, start] } else { way });
            }
            if next != start && !came_from.contains_key(next) {
                came_from.insert(next, file);
                waiting.push_back(next);
            }
        }
    }
    None
}

/// Reads the sources below a folder that is the module `path`.
fn read_folder(folder: &Path, path: &[String], name: &str, modules: &mut BTreeMap<ModulePath, Module>) {
    for entry in fs::read_dir(folder).expect("a source folder can be read") {
        let entry = entry.expect("a source folder can be read").path();
        let stem = entry.file_stem().expect("a file has a name").to_string_lossy().into_owned();
        let below = |stem: String| path.iter().cloned().chain([stem]).collect::<ModulePath>();
        let file = format!("{name}/{}", entry.file_name().expect("a file has a name").to_string_lossy());
        if entry.is_dir() {
            read_folder(&entry, &below(stem), &file, modules);
        } else if entry.extension().is_some_and(|extension| extension == "rs") && stem != "main" {
            let text = fs::read_to_string(&entry).expect("a source file is text");
            let module = if stem == "mod" || stem == "lib" { path.to_vec() } else { below(stem) };
            modules.insert(module, Module::read(file, &text));
        }
    }
}

// ---------------------------------------------------------------- tests

#[test]
fn no_room_has_a_circle_of_imports() {
    let modules = Modules::of_crate();
    let mut faults = Vec::new();
    for room in modules.rooms() {
        match (modules.circle(room), ROOMS_WITH_CIRCLES.contains(&room.as_str())) {
            (Some(circle), false) => faults.push(format!("a circle of imports in the room {room}: {circle}")),
            (None, true) => faults.push(format!("the room {room} has no circle any more: take it off ROOMS_WITH_CIRCLES")),
            _ => {}
        }
    }
    let unknown: Vec<_> = ROOMS_WITH_CIRCLES.iter().filter(|room| !modules.rooms().contains(**room)).collect();
    assert!(unknown.is_empty(), "ROOMS_WITH_CIRCLES has rooms that do not exist: {unknown:?}");
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// Modules of the oracle: each may import those of its own line and of the lines before it.
const ORACLE: &[&[&str]] = &[&["arithmetic", "perturbation", "shot", "work"], &["budget"], &["render"], &["bounds"], &["judge"]];

#[test]
fn the_oracle_imports_in_one_direction() {
    let modules = Modules::of_crate();
    let level = |file: &str| {
        let name = file.strip_prefix("src/oracle/").and_then(|path| path.split(['/', '.']).next()).expect("a file of the oracle");
        ORACLE.iter().position(|line| line.contains(&name)).or((name == "mod").then_some(ORACLE.len()))
    };
    let mut faults = Vec::new();
    for (file, imports) in modules.imports("oracle") {
        assert!(level(file).is_some(), "{file} is not in ORACLE");
        let upwards = imports.into_iter().filter(|(other, _)| level(other) > level(file));
        faults.extend(upwards.map(|(other, name)| format!("{file} imports {name} of {other}")));
    }
    assert_eq!(faults, Vec::<String>::new());
}

/// A crate of these files, each by its path of modules.
fn written(files: &[(&str, &str)]) -> Modules {
    let read = |(path, text): &(&str, &str)| {
        let path: ModulePath = path.split_terminator("::").map(str::to_owned).collect();
        (path.clone(), Module::read(path.join("/"), text))
    };
    Modules::linked(files.iter().map(read).collect())
}

#[test]
fn the_reader_of_circles_follows_reexports_and_paths_in_the_code() {
    let root = ("", "pub mod room;");
    let types = ("room::types", "pub struct Type; // use super::work::work;\nconst TEXT: &str = \"super::work::work\";");
    let work =
        ("room::work", "use super::Type; pub fn work(_: Type) {} #[cfg(test)] mod tests { use super::*; use crate::room::top::top; }");
    let top = ("room::top", "pub fn top() { super::work(super::Type); crate::room::work::work(Type) }");
    let facade = "mod top; mod types; mod work; pub use top::top; pub use self::{types::Type, work::work};";
    let clean = written(&[root, ("room", facade), types, work, top]);
    assert_eq!(clean.circle("room"), None, "a type that mod.rs re-exports is not in mod.rs");
    let imports = clean.imports("room");
    assert_eq!(imports["room/top"].keys().collect::<Vec<_>>(), [&"room/types", &"room/work"]);
    assert_eq!(imports["room/types"].len(), 0, "comments and text in quotes import nothing");

    let in_facade = facade.to_owned() + "pub struct Here;";
    let to_facade = ("room::types", "use super::Here; pub struct Type(Here);");
    let circle = written(&[root, ("room", &in_facade), to_facade, work, top]).circle("room");
    assert_eq!(circle.as_deref(), Some("room -[Type]-> room/types -[Here]-> room"), "mod.rs defines what its file imports");
}

#[test]
fn the_reader_of_circles_finds_the_shortest_circle() {
    let files = [
        ("", "mod room;"),
        ("room", "mod a; mod b; mod c;"),
        ("room::a", "pub fn a() { super::b::b() }"),
        ("room::b", "use super::c; pub fn b() { c::c::<u32>() }"),
        ("room::c", "use crate::room::a::*; pub fn c<T>() { a() }"),
    ];
    assert_eq!(written(&files).circle("room").as_deref(), Some("room/a -[b]-> room/b -[c]-> room/c -[a]-> room/a"));
    let listed = [("", "mod room;"), ("room", "list![a]; pub struct Shared;"), ("room::a", "use super::Shared;")];
    assert_eq!(written(&listed).circle("room").as_deref(), Some("room -[a]-> room/a -[Shared]-> room"));
}
