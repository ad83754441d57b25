//! Functions of the kind that people bring along.

use std::sync::LazyLock;

use super::writer::Kind;

/// A function of an effect, with all that it needs.
pub struct Helper {
    pub name: &'static str,
    pub parameters: Vec<Kind>,
    pub result: Kind,
    /// Largest magnitude of its result.
    pub bound: f64,
    pub text: &'static str,
}

/// Every helper.
pub static HELPERS: LazyLock<Vec<Helper>> = LazyLock::new(|| {
    let parts = include_str!("helpers.wgsl").split("//@ ").skip(1);
    parts.map(Helper::of).collect()
});

impl Helper {
    /// Name and magnitude in the first line, then its text with a function of the name.
    fn of(part: &'static str) -> Self {
        let (head, text) = part.split_once('\n').expect("a head");
        let (name, bound) = head.split_once(' ').expect("name and magnitude");
        let (_, behind) = text
            .split_once(&format!("fn {name}("))
            .expect("its function");
        let (parameters, behind) = behind.split_once(") -> ").expect("parameters");
        let kind = |parameter: &str| {
            let (_, kind) = parameter.split_once(": ").expect("a type");
            Kind::of_name(kind)
        };
        Self {
            name,
            parameters: parameters.split(", ").map(kind).collect(),
            result: Kind::of_name(behind.split_once(' ').expect("a result").0),
            bound: bound.parse().expect("a number"),
            text: text.trim_end(),
        }
    }
}
