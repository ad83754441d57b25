//! Promise: every effect declares exactly the members of the surface that its WGSL reads. Needs no
//! adapter.

use std::{collections::BTreeSet, sync::Arc};

use naga::{Expression, Function, Handle, Module, Statement, Type};
use rasterlab::{
    accuracy::Visibility,
    effects::{EFFECTS, Effect, SurfaceInput},
    shader::{
        Fetch, KernelKey, Pass, glue,
        library::Library,
        link::{self, Linked},
        reflect,
    },
};

/// The effect's file with all that it uses, and the constants of its choices.
fn module_of(effect: &Arc<Effect>) -> Module {
    let key = KernelKey::complete(Fetch::Indexed, Visibility::Split32, vec![effect.clone()]);
    let root = format!("effects/{}", effect.name);
    let linked = link::link(
        &Library::Embedded,
        &root,
        &key,
        &key.variants(Pass::Resolve),
    )
    .expect("every file is there");
    let text = linked.text + &glue::effects(&key);
    let reflected = reflect::reflect(
        &Linked {
            text,
            parts: linked.parts,
        },
        false,
    );
    reflected
        .unwrap_or_else(|error| panic!("{}: {error}", effect.name))
        .module
}

/// Members of the struct `Surface` that a function reads.
fn members_read(module: &Module, function: &Function) -> BTreeSet<String> {
    let Some((surface, ty)) = module
        .types
        .iter()
        .find(|(_, ty)| ty.name.as_deref() == Some("Surface"))
    else {
        return BTreeSet::new();
    };
    let naga::TypeInner::Struct { members, .. } = &ty.inner else {
        panic!("Surface is a struct")
    };
    let member = |index: u32| {
        members[index as usize]
            .name
            .clone()
            .expect("members have names")
    };
    let mut read = BTreeSet::new();
    for (_, expression) in function.expressions.iter() {
        match *expression {
            // A member of a surface that is passed by value.
            Expression::AccessIndex { base, index }
                if is_surface_value(module, function, base, surface) =>
            {
                read.insert(member(index));
            }
            // A member, or a part of one, loaded from a local variable.
            Expression::Load { pointer } => {
                read.extend(member_pointed_to(function, pointer, surface).map(member))
            }
            _ => {}
        }
    }
    read
}

fn is_surface_value(
    module: &Module,
    function: &Function,
    value: Handle<Expression>,
    surface: Handle<Type>,
) -> bool {
    match function.expressions[value] {
        Expression::FunctionArgument(index) => function.arguments[index as usize].ty == surface,
        Expression::CallResult(called) => module.functions[called]
            .result
            .as_ref()
            .is_some_and(|result| result.ty == surface),
        Expression::Load { pointer } => {
            matches!(function.expressions[pointer], Expression::LocalVariable(local) if function.local_variables[local].ty == surface)
        }
        _ => false,
    }
}

/// Index of the member of a local surface that a pointer leads into, if it leads into one.
fn member_pointed_to(
    function: &Function,
    mut pointer: Handle<Expression>,
    surface: Handle<Type>,
) -> Option<u32> {
    let mut last_index = None;
    loop {
        match function.expressions[pointer] {
            Expression::AccessIndex { base, index } => (pointer, last_index) = (base, Some(index)),
            Expression::Access { base, .. } => (pointer, last_index) = (base, None),
            Expression::LocalVariable(local) => {
                return last_index.filter(|_| function.local_variables[local].ty == surface);
            }
            _ => return None,
        }
    }
}

fn read_by(effect: &Arc<Effect>) -> BTreeSet<String> {
    let module = module_of(effect);
    module
        .functions
        .iter()
        .flat_map(|(_, function)| members_read(&module, function))
        .collect()
}

fn declared_by(effect: &Arc<Effect>) -> BTreeSet<String> {
    effect
        .hooks
        .surface_inputs
        .iter()
        .map(|input| input.member().to_owned())
        .collect()
}

#[test]
fn effects_declare_the_members_of_the_surface_that_they_read() {
    for effect in EFFECTS.iter() {
        assert_eq!(
            read_by(effect),
            declared_by(effect),
            "{}: WGSL on the left, Rust on the right",
            effect.name
        );
        let declared = &effect.hooks.surface_inputs;
        assert_eq!(
            declared_by(effect).len(),
            declared.len(),
            "{}: an input is declared twice",
            effect.name
        );
    }
}

/// What the test above must tell apart: a read from a write, a member from a longer name, an
/// argument from a variable.
#[test]
fn reads_are_told_from_writes() {
    let text = "struct Surface { color: vec4f, center: vec3f, center_screen: vec2f, normal: vec3f }\n\
                fn by_value(s: Surface) -> f32 { return s.center_screen.x; }\n\
                fn through_a_variable(surface: Surface) -> Surface {\n\
                    var s = surface;\n\
                    s.normal = vec3f(1.0);\n\
                    s.color.a += by_value(s);\n\
                    return s;\n\
                }\n";
    let module = naga::front::wgsl::parse_str(text).expect("valid");
    let read: BTreeSet<String> = module
        .functions
        .iter()
        .flat_map(|(_, function)| members_read(&module, function))
        .collect();
    assert_eq!(
        read.into_iter().collect::<Vec<_>>(),
        ["center_screen", "color"]
    );
    let stores = |function: &Function| {
        function
            .body
            .iter()
            .filter(|statement| matches!(statement, Statement::Store { .. }))
            .count()
    };
    assert!(
        module
            .functions
            .iter()
            .any(|(_, function)| stores(function) >= 2),
        "the sample writes members"
    );
    assert_eq!(SurfaceInput::CenterScreen.member(), "center_screen");
}
