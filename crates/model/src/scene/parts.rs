//! Parts: the materials, nodes and meshes of a scene by name, and the patterns by which an effect
//! is limited to some of them.
//!
//! Every instance is drawn with one material, so each kind of part is a set of instances and one
//! bit per draw answers whether a [`Scope`] contains it.

use std::{collections::BTreeMap, fmt, str::FromStr, sync::Arc};

use super::{
    model::{Instance, NamedNode, Primitive, Scene},
    up::UpAxis,
};

/// Longest name of a part and longest pattern, in characters.
pub const MAX_NAME_CHARS: usize = 120;
/// Most patterns in a scope.
pub const MAX_PATTERNS: usize = 32;
/// Most effects of a stack with a scope: each has one bit of a draw.
pub const MAX_SCOPES: usize = 32;

/// What a part is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum PartKind {
    Material,
    /// A node and its descendants.
    Node,
    Mesh,
}

impl PartKind {
    pub const ALL: [Self; 3] = [Self::Material, Self::Node, Self::Mesh];

    /// The word before the colon of a pattern.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Material => "material",
            Self::Node => "node",
            Self::Mesh => "mesh",
        }
    }

    /// The word for several of them.
    pub const fn plural(self) -> &'static str {
        match self {
            Self::Material => "materials",
            Self::Node => "nodes",
            Self::Mesh => "meshes",
        }
    }
}

/// A pattern for names of one kind of part: `material:Lens*`. `*` stands for any characters and `?`
/// for one; letters match in their own case alone.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PartPattern {
    pub kind: PartKind,
    glob: String,
}

/// What is wrong with a pattern; completes a sentence that begins with what holds it.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "has the pattern {pattern:?}, {reason}; a pattern is material:NAME, node:NAME or mesh:NAME, where * is any text and ? any character"
)]
pub struct PatternError {
    pub pattern: String,
    pub reason: String,
}

impl FromStr for PartPattern {
    type Err = PatternError;

    fn from_str(text: &str) -> Result<Self, PatternError> {
        let shown = || text.chars().take(MAX_NAME_CHARS).collect();
        let wrong = |reason: String| {
            Err(PatternError {
                pattern: shown(),
                reason,
            })
        };
        let Some((kind, glob)) = text.split_once(':') else {
            return wrong("which has no kind before a colon".into());
        };
        let Some(kind) = PartKind::ALL.into_iter().find(|known| known.name() == kind) else {
            return wrong(format!(
                "where {:?} is no kind of part",
                kind.chars().take(MAX_NAME_CHARS).collect::<String>()
            ));
        };
        match glob {
            "" => wrong("which has no name after the colon".into()),
            glob if glob.chars().count() > MAX_NAME_CHARS => wrong(format!(
                "whose name is longer than {MAX_NAME_CHARS} characters"
            )),
            glob if glob.chars().any(char::is_control) => {
                wrong("which has a control character".into())
            }
            glob => Ok(Self {
                kind,
                glob: glob.into(),
            }),
        }
    }
}

impl fmt::Display for PartPattern {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.kind.name(), self.glob)
    }
}

impl PartPattern {
    /// The narrowest pattern that matches parts of this name: `?` stands for a character with a
    /// meaning of its own.
    pub fn of_name(kind: PartKind, name: &str) -> Self {
        let plain = |c: char| if c == '*' || c.is_control() { '?' } else { c };
        let mut glob: String = name.chars().map(plain).take(MAX_NAME_CHARS).collect();
        if name.chars().count() > MAX_NAME_CHARS {
            glob.pop();
            glob.push('*');
        }
        Self { kind, glob }
    }

    /// What it matches names with.
    pub fn glob(&self) -> &str {
        &self.glob
    }

    /// Does the pattern match a name of its kind?
    pub fn matches(&self, name: &str) -> bool {
        let (mut glob, mut name) = (self.glob.chars(), name.chars());
        // After a `*`: the rest of the glob, and the characters that the `*` may yet take.
        let mut retry: Option<(std::str::Chars<'_>, std::str::Chars<'_>)> = None;
        loop {
            match (glob.clone().next(), name.clone().next()) {
                (Some('*'), _) => {
                    glob.next();
                    retry = Some((glob.clone(), name.clone()));
                }
                (Some(wanted), Some(found)) if wanted == '?' || wanted == found => {
                    glob.next();
                    name.next();
                }
                (None, None) => return true,
                _ => match retry
                    .as_mut()
                    .and_then(|(after, taken)| taken.next().map(|_| (after.clone(), taken.clone())))
                {
                    Some(rest) => (glob, name) = rest,
                    None => return false,
                },
            }
        }
    }
}

/// The parts of a scene to which an effect is limited. Without patterns: the whole scene. Clones
/// share the patterns.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Scope(Option<Arc<[PartPattern]>>);

impl Scope {
    /// The scope of these patterns, each once, at most [`MAX_PATTERNS`] of them.
    pub fn new(patterns: impl IntoIterator<Item = PartPattern>) -> Self {
        let mut kept: Vec<PartPattern> = Vec::new();
        for pattern in patterns {
            if kept.len() < MAX_PATTERNS && !kept.contains(&pattern) {
                kept.push(pattern);
            }
        }
        Self((!kept.is_empty()).then(|| kept.into()))
    }

    /// The scope of these texts, each a pattern such as `mesh:Lens*`.
    /// Errors: the first faulty pattern, in words that complete a sentence beginning with a key.
    pub fn of_texts(texts: &[String]) -> Result<Self, String> {
        let patterns = texts.iter().map(|text| text.parse());
        let patterns: Result<Vec<PartPattern>, PatternError> = patterns.collect();
        Ok(Self::new(patterns.map_err(|error| error.to_string())?))
    }

    /// The texts that [`Self::of_texts`] takes back to the same scope.
    pub fn texts(&self) -> Vec<String> {
        self.patterns().iter().map(PartPattern::to_string).collect()
    }

    pub fn is_whole_scene(&self) -> bool {
        self.0.is_none()
    }

    /// None for the whole scene.
    pub fn patterns(&self) -> &[PartPattern] {
        self.0.as_deref().unwrap_or_default()
    }

    /// The scope with a pattern, or without it.
    #[must_use]
    pub fn with(&self, pattern: &PartPattern, is_inside: bool) -> Self {
        let others = self
            .patterns()
            .iter()
            .filter(|other| *other != pattern)
            .cloned();
        Self::new(others.chain(is_inside.then(|| pattern.clone())))
    }

    /// The patterns of `scene` that match no part of it.
    pub fn unmatched(&self, scene: &Scene) -> Vec<&PartPattern> {
        let is_used = |pattern: &PartPattern| {
            used_names(scene, pattern.kind).any(|name| pattern.matches(name))
        };
        self.patterns()
            .iter()
            .filter(|pattern| !is_used(pattern))
            .collect()
    }
}

impl fmt::Display for Scope {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_whole_scene() {
            return f.write_str("whole scene");
        }
        let patterns: Vec<String> = self.patterns().iter().map(PartPattern::to_string).collect();
        f.write_str(&patterns.join(", "))
    }
}

/// Which parts of a scene are shown, by default all, in which of their materials, and which way up.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ShownParts {
    /// The axis of the file that is up.
    pub up: UpAxis,
    /// Name of the variant of materials with which the scene is loaded; empty: those of the file.
    pub variant: String,
    /// Nothing else is shown.
    pub only: Scope,
    /// Parts that are not shown; none where it is the whole scene.
    pub hidden: Scope,
}

impl Scene {
    /// The scene with the instances of these parts alone.
    #[must_use]
    pub fn showing(mut self, parts: &ShownParts) -> Self {
        if parts.only.is_whole_scene() && parts.hidden.is_whole_scene() {
            return self;
        }
        let masks = scope_masks(&self, &[parts.only.clone(), parts.hidden.clone()]);
        let hides = !parts.hidden.is_whole_scene();
        let mut mask = masks.into_iter();
        self.instances.retain(|_| {
            let mask = mask.next().expect("every instance has a mask");
            mask & 1 != 0 && !(hides && mask & 2 != 0)
        });
        self
    }
}

/// For every instance of `scene` a mask: bit k is set if scope k contains it. There are at most
/// [`MAX_SCOPES`] scopes.
pub fn scope_masks(scene: &Scene, scopes: &[Scope]) -> Vec<u32> {
    let mut masks = vec![0; scene.instances.len()];
    for (scope, bit) in scopes.iter().zip((0..MAX_SCOPES).map(|k| 1u32 << k)) {
        let matches = |kind: PartKind, name: &str| {
            scope
                .patterns()
                .iter()
                .any(|pattern| pattern.kind == kind && pattern.matches(name))
        };
        let materials: Vec<bool> = scene
            .materials
            .iter()
            .map(|material| matches(PartKind::Material, &material.name))
            .collect();
        let primitives: Vec<bool> = scene
            .primitives
            .iter()
            .map(|primitive| {
                materials[primitive.material] || matches(PartKind::Mesh, &primitive.mesh)
            })
            .collect();
        let mut nodes: Vec<bool> = Vec::with_capacity(scene.named_nodes.len());
        for node in &scene.named_nodes {
            nodes.push(
                node.parent.is_some_and(|parent| nodes[parent])
                    || matches(PartKind::Node, &node.name),
            );
        }
        for (mask, instance) in masks.iter_mut().zip(&scene.instances) {
            let is_inside = scope.is_whole_scene()
                || primitives[instance.primitive]
                || instance.named_node.is_some_and(|node| nodes[node]);
            *mask |= if is_inside { bit } else { 0 };
        }
    }
    masks
}

/// A part of a scene that is drawn: everything of one kind and name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    pub kind: PartKind,
    pub name: String,
    /// Number of ancestors of the first node of this name; 0 for other kinds.
    pub depth: usize,
    /// Number of instances that it contains.
    pub instances: usize,
    /// Number of triangles of these instances.
    pub triangles: u64,
}

impl Part {
    /// The narrowest pattern that matches it.
    pub fn pattern(&self) -> PartPattern {
        PartPattern::of_name(self.kind, &self.name)
    }
}

/// The parts of a scene that are drawn: materials and meshes in the order of their first instance,
/// nodes with parents before children.
pub fn parts(scene: &Scene) -> Vec<Part> {
    let mut parts: Vec<Part> = Vec::new();
    for kind in PartKind::ALL {
        let first = parts.len();
        let mut known: BTreeMap<&str, usize> = BTreeMap::new();
        if kind == PartKind::Node {
            // Ancestors come first, also where only their descendants are drawn.
            let (mut is_shown, mut depths) = (vec![false; scene.named_nodes.len()], Vec::new());
            for instance in &scene.instances {
                ancestors(scene, instance).for_each(|node| is_shown[node] = true);
            }
            for (node, is_shown) in scene.named_nodes.iter().zip(is_shown) {
                let depth = node.parent.map_or(0, |parent: usize| depths[parent] + 1);
                depths.push(depth);
                if is_shown && !known.contains_key(node.name.as_str()) {
                    known.insert(&node.name, parts.len());
                    parts.push(Part {
                        kind,
                        name: node.name.clone(),
                        depth,
                        instances: 0,
                        triangles: 0,
                    });
                }
            }
        }
        for instance in &scene.instances {
            let primitive = &scene.primitives[instance.primitive];
            let mut names = names_of(scene, instance, kind);
            // An instance counts once for a name that several of its nodes have.
            names.sort_unstable();
            names.dedup();
            for name in names {
                let index = *known.entry(name).or_insert_with(|| {
                    parts.push(Part {
                        kind,
                        name: name.into(),
                        depth: 0,
                        instances: 0,
                        triangles: 0,
                    });
                    parts.len() - 1
                });
                debug_assert!(index >= first);
                parts[index].instances += 1;
                parts[index].triangles += u64::from(primitive.triangle_count());
            }
        }
    }
    parts
}

/// The names of an instance of one kind; its node comes first, then the node's ancestors.
pub fn names_of<'a>(scene: &'a Scene, instance: &Instance, kind: PartKind) -> Vec<&'a str> {
    let primitive: &Primitive = &scene.primitives[instance.primitive];
    match kind {
        PartKind::Material => vec![&scene.materials[primitive.material].name],
        PartKind::Mesh => vec![&primitive.mesh],
        PartKind::Node => ancestors(scene, instance)
            .map(|node| scene.named_nodes[node].name.as_str())
            .collect(),
    }
}

/// Names of one kind that some instance has; a name may come several times.
fn used_names(scene: &Scene, kind: PartKind) -> impl Iterator<Item = &str> {
    scene
        .instances
        .iter()
        .flat_map(move |instance| names_of(scene, instance, kind))
}

/// The node of an instance and its ancestors, from the node up.
fn ancestors<'a>(scene: &'a Scene, instance: &Instance) -> impl Iterator<Item = usize> + 'a {
    std::iter::successors(instance.named_node, |&node| scene.named_nodes[node].parent)
}

impl Scene {
    /// Adds a node without a parent and returns its index in `named_nodes`.
    pub(super) fn add_named_node(&mut self, name: impl Into<String>) -> usize {
        self.named_nodes.push(NamedNode {
            name: name.into(),
            parent: None,
        });
        self.named_nodes.len() - 1
    }

    /// Names the nodes of a scene that came without names: after the nodes of its rig, or after its
    /// meshes and their number.
    pub(super) fn name_nodes(&mut self) {
        if !self.rig.is_empty() {
            self.named_nodes = self
                .rig
                .nodes
                .iter()
                .map(|node| NamedNode {
                    name: node.name.clone(),
                    parent: node.parent,
                })
                .collect();
            self.instances
                .iter_mut()
                .for_each(|instance| instance.named_node = instance.node);
            return;
        }
        let mut counts: BTreeMap<String, usize> = BTreeMap::new();
        let is_single = |scene: &Self, mesh: &str| {
            scene
                .instances
                .iter()
                .filter(|i| scene.primitives[i.primitive].mesh == mesh)
                .count()
                == 1
        };
        for index in 0..self.instances.len() {
            let mesh = self.primitives[self.instances[index].primitive]
                .mesh
                .clone();
            let count = counts.entry(mesh.clone()).or_default();
            let name = if *count == 0 && is_single(self, &mesh) {
                mesh.clone()
            } else {
                format!("{mesh} {count}")
            };
            *count += 1;
            self.instances[index].named_node = Some(self.add_named_node(name));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pattern(text: &str) -> PartPattern {
        text.parse().unwrap_or_else(|error| panic!("{error}"))
    }

    #[test]
    fn a_pattern_matches_as_a_glob_does() {
        for (text, name, expected) in [
            ("mesh:Lens", "Lens", true),
            ("mesh:Lens", "lens", false),
            ("mesh:Lens", "Lens 2", false),
            ("mesh:Lens*", "Lens", true),
            ("mesh:Lens*", "Lens 2", true),
            ("mesh:*ens", "Lens", true),
            ("mesh:*ens", "Lens 2", false),
            ("mesh:L?ns", "Lens", true),
            ("mesh:L?ns", "Lns", false),
            ("mesh:?", "é", true),
            ("mesh:*", "", true),
            ("mesh:a*b*c", "a-b-b-c", true),
            ("mesh:a*b*c", "a-c-b", false),
            ("mesh:*a*a*a*b", "aaaaaaaaaaaaaaaaaaaaaaaaaaaa", false),
            ("mesh:**", "x", true),
            ("mesh:a:b", "a:b", true),
        ] {
            assert_eq!(pattern(text).matches(name), expected, "{text} on {name:?}");
        }
    }

    #[test]
    fn a_pattern_of_a_name_matches_it_and_reads_back() {
        let long = "n".repeat(3 * MAX_NAME_CHARS);
        for name in ["Body", "a*b", "tab\there", "é?ü", "a:b", " spaced ", &long] {
            let pattern = PartPattern::of_name(PartKind::Node, name);
            assert!(pattern.matches(name), "{name:?}");
            assert_eq!(pattern.to_string().parse(), Ok(pattern), "{name:?}");
        }
    }

    #[test]
    fn a_faulty_pattern_says_what_a_pattern_is() {
        for text in ["Lens", "", "materiel:x", "node:", "Node:x", "mesh:a\nb"] {
            let error = text.parse::<PartPattern>().expect_err(text).to_string();
            assert!(
                error.contains(&format!("{text:?}"))
                    && error.contains("material:NAME, node:NAME or mesh:NAME"),
                "{error}"
            );
        }
        assert!(
            format!("mesh:{}", "x".repeat(121))
                .parse::<PartPattern>()
                .is_err()
        );
    }

    #[test]
    fn builtin_scenes_have_parts_and_a_node_takes_in_its_descendants() {
        let scene = super::super::builtin::build("walker?tess=1&instances=3")
            .expect("a scene")
            .in_room(1.0);
        let names = |kind: PartKind| -> Vec<String> {
            parts(&scene)
                .into_iter()
                .filter(|p| p.kind == kind)
                .map(|p| p.name)
                .collect()
        };
        assert_eq!(names(PartKind::Material), ["hide", "plaster"]);
        assert_eq!(names(PartKind::Mesh), ["walker", "room"]);
        assert_eq!(
            names(PartKind::Node),
            ["walker 0", "walker 1", "walker 2", "room"]
        );
        let masks = |text: &str| scope_masks(&scene, &[Scope::new([pattern(text)])]);
        assert_eq!(masks("node:walker 1"), [0, 1, 0, 0]);
        assert_eq!(masks("node:walker ?"), [1, 1, 1, 0]);
        assert_eq!(masks("material:plaster"), [0, 0, 0, 1]);
        assert_eq!(masks("mesh:*"), [1; 4]);
        let mut nested = scene.clone();
        nested.named_nodes.insert(
            0,
            NamedNode {
                name: "herd".into(),
                parent: None,
            },
        );
        for node in &mut nested.named_nodes[1..] {
            node.parent = Some(node.parent.map_or(0, |parent| parent + 1));
        }
        nested
            .instances
            .iter_mut()
            .for_each(|instance| instance.named_node = instance.named_node.map(|node| node + 1));
        assert_eq!(
            scope_masks(
                &nested,
                &[
                    Scope::new([pattern("node:herd")]),
                    Scope::new([pattern("node:walker 2")])
                ]
            ),
            [1, 1, 3, 1]
        );
        assert_eq!(
            Scope::new([pattern("node:herd"), pattern("mesh:cube")])
                .unmatched(&scene)
                .len(),
            2
        );
    }
}
