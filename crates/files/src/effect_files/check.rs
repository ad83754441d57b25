//! Checking: an effect file is linked alone, validated, and translated for every graphics interface,
//! so that every fault is reported at its line before any kernel is compiled.

use std::sync::Arc;

use naga::{
    Arena, Block, Expression, Function, Module, ScalarKind, Statement, TypeInner,
    valid::{
        ExpressionError, FunctionError, ModuleInfo, ValidationError, ValidationFlags, Validator,
    },
};

use super::{
    declaration::Declaration,
    error::{EffectError, Text},
    rewrite::{Rewritten, in_names_of_author},
    tokens::Token,
    words,
};
use crate::{
    effects::Effect,
    shader::{
        backends::{Untranslatable, caught, translate},
        library::Library,
        link::{self, LinkError, Linked},
        reflect::capabilities,
    },
};

/// Most bytes of a function's local variables.
const MAX_LOCAL_BYTES: u32 = 4096;
/// Most bytes of any type.
const MAX_TYPE_BYTES: u32 = 1 << 16;

/// The module of an effect alone.
pub struct Checked {
    pub module: Module,
    /// The text that was read.
    pub linked: Linked,
}

/// An effect file with what was read of it and made of it.
#[derive(Clone, Copy)]
pub struct Parts<'a> {
    pub text: &'a Text<'a>,
    pub stem: &'a str,
    pub declaration: &'a Declaration<'a>,
    pub rewritten: &'a Rewritten,
}

/// Links and validates the effect.
///
/// # Errors
/// What the linker or naga refuses, at its line of the file.
pub fn check(parts: Parts<'_>, effect: &Arc<Effect>) -> Result<Checked, EffectError> {
    let linked = link::link_effect(&Library::of_process(), effect)
        .map_err(|error| of_link(parts, &error))?;
    let (module, info) = caught(|| valid(parts, &linked)).unwrap_or_else(|_| {
        let message = "the reader of WGSL fails at this text, which is a fault of rasterlab; write the file in another way";
        Err(parts.text.whole(message))
    })?;
    check_types(parts, &linked, &module)?;
    check_pointers(parts, &linked, &module)?;
    translate(&module, &info).map_err(|error| of_translation(parts, &linked, &module, &error))?;
    Ok(Checked { module, linked })
}

/// What naga reads and validates.
fn valid(parts: Parts<'_>, linked: &Linked) -> Result<(Module, ModuleInfo), EffectError> {
    let module = naga::front::wgsl::parse_str(&linked.text).map_err(|error| {
        let spans: Vec<naga::Span> = error.labels().map(|(span, _)| span).collect();
        let label = error.labels().next().map_or("", |(_, label)| label);
        let adds_nothing = ["", "definition of", "unknown", "expected"]
            .iter()
            .any(|start| label.starts_with(start) && (!start.is_empty() || label.is_empty()));
        let is_told = adds_nothing || error.message().contains(label.trim_matches('`'));
        let detail = if is_told {
            String::new()
        } else {
            format!(" ({label})")
        };
        error_at(
            parts,
            linked,
            &spans,
            &of_reader(error.message()).map_or_else(
                || format!("{}{detail}{}", error.message(), hint(error.message())),
                str::to_owned,
            ),
        )
    })?;
    let info = validator().validate(&module).map_err(|error| {
        // The shortest is the expression at fault; others are the function and what it calls.
        let mut spans: Vec<naga::Span> = error.spans().map(|(span, _)| *span).collect();
        spans.sort_by_key(|span| span.to_range().map_or(usize::MAX, |range| range.len()));
        if let ValidationError::Function { handle, source, .. } = error.as_inner() {
            let span = module.functions.get_span(*handle);
            let message = of_operands(&linked.text, &module.functions[*handle], source);
            if let Some(message) = message {
                return error_at(parts, linked, &spans, &message);
            }
            if let (FunctionError::InvalidReturnType { expression: None, .. }, Some(range)) =
                (source, span.to_range())
            {
                // Naga points to nothing; the path goes to the end of the function.
                let end = naga::Span::new(range.end as u32 - 1, range.end as u32);
                return error_at(
                    parts,
                    linked,
                    &[end],
                    "a path ends without return, or with one that gives nothing; return the function's result on every path",
                );
            }
        }
        let mut causes = vec![error.as_inner().to_string()];
        let mut cause = std::error::Error::source(error.as_inner());
        while let Some(inner) = cause {
            causes.push(inner.to_string());
            cause = inner.source();
        }
        error_at(parts, linked, &spans, &told(&causes))
    })?;
    Ok((module, info))
}

fn validator() -> Validator {
    Validator::new(ValidationFlags::all(), capabilities())
}

/// What cannot be translated, at the first function that cannot.
fn of_translation(
    parts: Parts<'_>,
    linked: &Linked,
    module: &Module,
    error: &Untranslatable,
) -> EffectError {
    // A function names only functions before it.
    let is_at_fault = |count: usize| {
        let mut first = module.clone();
        first.functions = Arena::new();
        for (handle, function) in module.functions.iter().take(count) {
            let span = module.functions.get_span(handle);
            first.functions.append(function.clone(), span);
        }
        let valid = caught(|| validator().validate(&first).ok());
        valid.is_ok_and(|info| info.is_some_and(|info| translate(&first, &info).is_err()))
    };
    let fault = (1..=module.functions.len())
        .find(|&count| is_at_fault(count))
        .and_then(|count| module.functions.iter().nth(count - 1));
    let (name, spans) = match fault {
        Some((handle, function)) => (
            function.name.as_deref().unwrap_or("a function"),
            vec![module.functions.get_span(handle)],
        ),
        None => ("the effect", Vec::new()),
    };
    let message = format!(
        "{name} cannot be translated for {}, whatever the device: {}; write it in another way",
        error.interface,
        without_indices(&error.reason)
    );
    error_at(parts, linked, &spans, &message)
}

/// The causes of a refusal in one sentence: those that name no index of naga's own.
fn told(causes: &[String]) -> String {
    let is_clear = |cause: &&String| !cause.contains('[') && !cause.contains("is invalid");
    let clear: Vec<&str> = causes.iter().filter(is_clear).map(String::as_str).collect();
    let last = causes.last().map_or("", String::as_str);
    if let Some(plain) = in_plain_words(last) {
        return plain;
    }
    match &clear[..] {
        [] => causes.last().map_or_else(String::new, |last| {
            without_indices(last.split(" (of type ").next().unwrap_or(last))
        }),
        all => all.join(": "),
    }
}

/// Numbers of two kinds beside an operator: which is which, and how one becomes the other.
fn of_operands(text: &str, function: &Function, error: &FunctionError) -> Option<String> {
    let FunctionError::Expression {
        source:
            ExpressionError::InvalidBinaryOperandTypes {
                lhs_expr,
                lhs_type,
                rhs_expr,
                rhs_type,
                ..
            },
        ..
    } = error
    else {
        return None;
    };
    let operand = |handle: naga::Handle<Expression>, inner: &TypeInner| {
        let range = function.expressions.get_span(handle).to_range()?;
        let name = match inner.scalar()?.kind {
            ScalarKind::Float => "f32",
            ScalarKind::Sint => "i32",
            ScalarKind::Uint => "u32",
            _ => return None,
        };
        let size = match *inner {
            TypeInner::Scalar(_) => None,
            TypeInner::Vector { size, .. } => Some(size as u8),
            _ => return None,
        };
        Some((text.get(range)?.trim(), name, size))
    };
    let [left, right] = [(*lhs_expr, lhs_type), (*rhs_expr, rhs_type)]
        .map(|(handle, inner)| operand(handle, inner));
    let (left, right) = (left?, right?);
    if left.1 == right.1 {
        return None;
    }
    // Whole numbers become floats; of two kinds of whole numbers the right one becomes the other.
    let (kept, changed) = match right.1 {
        "f32" => (right, left),
        _ => (left, right),
    };
    let call = changed.2.map_or_else(
        || kept.1.to_owned(),
        |size| format!("vec{size}<{}>", kept.1),
    );
    Some(format!(
        "{} is {} and {} is {}: write {call}({})",
        left.0, left.1, right.0, right.1, changed.0
    ))
}

/// Refuses pointers to members, which naga's translators do not know.
fn check_pointers(parts: Parts<'_>, linked: &Linked, module: &Module) -> Result<(), EffectError> {
    fn find(module: &Module, function: &Function, block: &Block) -> Option<naga::Span> {
        block.iter().find_map(|statement| match statement {
            Statement::Block(inner) => find(module, function, inner),
            Statement::If { accept, reject, .. } => {
                find(module, function, accept).or_else(|| find(module, function, reject))
            }
            Statement::Switch { cases, .. } => cases
                .iter()
                .find_map(|case| find(module, function, &case.body)),
            Statement::Loop {
                body, continuing, ..
            } => find(module, function, body).or_else(|| find(module, function, continuing)),
            Statement::Call {
                function: called,
                arguments,
                ..
            } => {
                let taken = module.functions[*called].arguments.iter().zip(arguments);
                let is_member = |argument: &naga::Handle<Expression>| {
                    matches!(
                        function.expressions[*argument],
                        Expression::Access { .. } | Expression::AccessIndex { .. }
                    )
                };
                taken
                    .filter(|(taken, argument)| {
                        module.types[taken.ty].inner.pointer_space().is_some()
                            && is_member(argument)
                    })
                    .map(|(_, argument)| function.expressions.get_span(*argument))
                    .next()
            }
            _ => None,
        })
    }
    let mut functions = module.functions.iter();
    match functions.find_map(|(_, function)| find(module, function, &function.body)) {
        Some(span) => Err(error_at(
            parts,
            linked,
            &[span],
            "a pointer leads to a whole variable, not to a member of one: copy the member into a var, pass a pointer to that, and store it back",
        )),
        None => Ok(()),
    }
}

/// Refusals of naga's own making, which WGSL does not know.
fn of_reader(message: &str) -> Option<&'static str> {
    if message.starts_with("Not implemented as constant expression") {
        Some(
            "this function of constants is not computed beforehand; write let in a function in place of const, or the number itself",
        )
    } else if message.starts_with("failed to convert expression to a concrete type")
        || message.starts_with("Abstract types may only appear in constant expressions")
    {
        Some("plain numbers have no type here; give one of them its type, as in 0.5f, 3i or 3u")
    } else {
        None
    }
}

/// Refusals that naga tells by the indices of its expressions.
fn in_plain_words(cause: &str) -> Option<String> {
    let number = |text: &str| {
        text.split(|c: char| !c.is_ascii_digit())
            .find(|digits| !digits.is_empty())
            .and_then(|digits| digits.parse::<u32>().ok())
    };
    if let Some(rest) = cause.strip_prefix("Operation ") {
        let operator = rest.split_whitespace().next().unwrap_or_default();
        return Some(format!(
            "the operator {operator} does not take values of these types; convert one of them"
        ));
    }
    if cause.starts_with("The type of ") {
        return Some(
            "the value has another type than the variable that it is stored in; convert it".into(),
        );
    }
    if let Some(rest) = cause.strip_prefix("Requires ") {
        let (takes, given) = rest.split_once("but")?;
        return Some(format!(
            "wrong number of arguments: the function takes {}, and {} are given",
            number(takes)?,
            number(given)?
        ));
    }
    if cause.starts_with("Argument ") && cause.contains("doesn't match") {
        return Some(format!(
            "argument {} has another type than the function's parameter; convert it",
            number(cause)? + 1
        ));
    }
    cause
        .starts_with("The `return` ")
        .then(|| "what is returned has another type than the function's result; convert it".into())
}

/// Where an effect finds a name that it does not declare.
fn hint(message: &str) -> String {
    let name = message
        .strip_prefix("no definition in scope for identifier: `")
        .and_then(|rest| rest.strip_suffix('`'));
    if name == Some("time") {
        return "; declare @given(seconds) time_s: f32 among the parameters, and read p.time_s"
            .into();
    }
    let declares = |name: &str, file: &&str| {
        let text = Library::Embedded.text(&format!("lib/{file}"));
        text.is_some_and(|text| {
            [
                format!("\nfn {name}("),
                format!("\nconst {name} "),
                format!("\nstruct {name} "),
            ]
            .iter()
            .any(|head| text.contains(head))
        })
    };
    let file = name.and_then(|name| words::LIBRARY.into_iter().find(|file| declares(name, file)));
    file.map_or(String::new(), |file| {
        format!("; lib/{file} declares it: add the line //@ use lib/{file}")
    })
}

/// A message without `[12]`, the numbers by which naga calls expressions and types.
fn without_indices(message: &str) -> String {
    let mut rest = message;
    let mut told = String::new();
    while let Some((before, after)) = rest.split_once('[') {
        let number = after
            .find(']')
            .filter(|&end| after[..end].chars().all(|c| c.is_ascii_digit()));
        told.push_str(if number.is_some() {
            before.trim_end()
        } else {
            before
        });
        rest = match number {
            Some(end) => &after[end + 1..],
            None => {
                told.push('[');
                after
            }
        };
    }
    told + rest
}

/// Refuses types and local variables that take more memory than an invocation should have.
fn check_types(parts: Parts<'_>, linked: &Linked, module: &Module) -> Result<(), EffectError> {
    let mut layouter = naga::proc::Layouter::default();
    if layouter.update(module.to_ctx()).is_err() {
        return Err(parts.text.whole("a type is too large"));
    }
    for (handle, ty) in module.types.iter() {
        let bytes = layouter[handle].size;
        if bytes > MAX_TYPE_BYTES {
            let name = ty.name.as_deref().unwrap_or("a type");
            let message = format!(
                "{name} takes {bytes} bytes; a type of an effect takes at most {MAX_TYPE_BYTES}"
            );
            return Err(error_at(
                parts,
                linked,
                &[module.types.get_span(handle)],
                &message,
            ));
        }
    }
    for (_, function) in module.functions.iter() {
        for (handle, local) in function.local_variables.iter() {
            let bytes = layouter[local.ty].size;
            if bytes > MAX_LOCAL_BYTES {
                let name = local.name.as_deref().unwrap_or("a variable");
                let message = format!(
                    "{name} takes {bytes} bytes; a variable of an effect takes at most {MAX_LOCAL_BYTES}"
                );
                return Err(error_at(
                    parts,
                    linked,
                    &[function.local_variables.get_span(handle)],
                    &message,
                ));
            }
        }
    }
    Ok(())
}

/// An error at the first of these ranges of the linked text that comes from the file.
pub fn error_at(
    parts: Parts<'_>,
    linked: &Linked,
    spans: &[naga::Span],
    message: &str,
) -> EffectError {
    let Parts {
        text,
        stem,
        declaration,
        rewritten,
    } = parts;
    let message = in_names_of_author(stem, declaration, message);
    let message = message
        .replace("`{AbstractFloat}`", "a number with a point")
        .replace("`{AbstractInt}`", "a whole number");
    let name = format!("effects/{stem}");
    let first_line = linked
        .parts
        .iter()
        .find(|part| part.name == name)
        .map_or(0, |part| part.line);
    let begin: usize = linked
        .text
        .split_inclusive('\n')
        .take(first_line)
        .map(str::len)
        .sum();
    let place = spans
        .iter()
        .filter_map(|span| span.to_range())
        .find_map(|range| {
            let offset = rewritten.origin(range.start.checked_sub(begin)?)?;
            let end = rewritten
                .origin(range.end.checked_sub(begin)?)
                .unwrap_or(offset);
            Some((offset, end.saturating_sub(offset).max(1)))
        });
    match place {
        // What is missing at the end is missing behind the last token.
        Some((offset, _))
            if declaration
                .tokens
                .last()
                .is_some_and(|last| offset >= last.end()) =>
        {
            let last = declaration.tokens.last().map_or(0, Token::end);
            text.error(last.saturating_sub(1), 1, message)
        }
        Some((offset, length)) => text.error(offset, length, message),
        None => text.whole(message),
    }
}

fn of_link(parts: Parts<'_>, error: &LinkError) -> EffectError {
    let Parts {
        text,
        stem,
        declaration,
        ..
    } = parts;
    match error {
        LinkError::Undeclared {
            file,
            line,
            name,
            declared_in,
        } if *file == format!("effects/{stem}") => {
            let is_open = declared_in
                .strip_prefix("lib/")
                .is_some_and(|file| words::LIBRARY.contains(&file));
            let message = match is_open {
                true => format!(
                    "{name} is declared in {declared_in}; add the line //@ use {declared_in}"
                ),
                false => format!(
                    "{name} belongs to the kernels, and an effect cannot use it; choose another name"
                ),
            };
            let begin: usize = text
                .text
                .split_inclusive('\n')
                .take(*line as usize - 1)
                .map(str::len)
                .sum();
            let token = declaration
                .tokens
                .iter()
                .find(|token| token.offset >= begin && token.text == *name);
            text.at_any(token, message)
        }
        other => text.whole(in_names_of_author(stem, declaration, &other.to_string())),
    }
}
