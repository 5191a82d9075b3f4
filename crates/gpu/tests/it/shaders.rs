//! Parses and validates every composed shader as the WGSL of WebGPU, without extensions, and checks that structures
//! shared with Rust have the same layout on both sides. Needs no device.

use naga::valid::{Capabilities, ValidationFlags, Validator};
use naga::{Module, ScalarKind, TypeInner};
use tilescope_gpu::layout::{
    Dart, Frame, Ground, Image, Job, LaidPiece, PieceCell, Proposal, STRUCTURES,
};
use tilescope_gpu::passes::ALL as PASSES;
use tilescope_gpu::shader::{FILES, compose, imports};

/// The lengths of the shared structures in Rust.
const LENGTHS: &[(&str, usize)] = &[
    ("Frame", size_of::<Frame>()),
    ("Job", size_of::<Job>()),
    ("Image", size_of::<Image>()),
    ("Proposal", size_of::<Proposal>()),
    ("Ground", size_of::<Ground>()),
    ("Dart", size_of::<Dart>()),
    ("LaidPiece", size_of::<LaidPiece>()),
    ("PieceCell", size_of::<PieceCell>()),
];

/// A structure's fields with their offsets in bytes and their types.
type Fields<'a> = &'a [(&'a str, usize, &'a str)];

/// Returns whether a file is a pass and not a library.
fn is_pass(text: &str) -> bool {
    text.contains("fn main(") || text.contains("fn run(index: u32)")
}

/// Returns the parsed module of a source that uses only WebGPU's WGSL, or an error text.
fn module(source: &str) -> Result<Module, String> {
    let module =
        naga::front::wgsl::parse_str(source).map_err(|error| error.emit_to_string(source))?;
    Validator::new(ValidationFlags::all(), Capabilities::empty())
        .validate(&module)
        .map_err(|error| error.emit_to_string(source))?;
    Ok(module)
}

/// Fails where a structure of the module differs from the one in Rust.
fn compare(module: &Module, name: &str, fields: Fields<'_>, length: usize) -> Result<(), String> {
    let found = module
        .types
        .iter()
        .find(|(_, kind)| kind.name.as_deref() == Some(name));
    let Some((_, kind)) = found else {
        return Err(format!("the shader has no {name}"));
    };
    let TypeInner::Struct { members, span } = &kind.inner else {
        return Err(format!("{name} is no structure"));
    };
    if *span as usize != length || members.len() != fields.len() {
        return Err(format!(
            "{name} has {} fields in {span} bytes, in Rust {} in {length}",
            members.len(),
            fields.len()
        ));
    }
    for (member, (field, offset, kind)) in members.iter().zip(fields) {
        let found = (
            member.name.as_deref().unwrap_or(""),
            member.offset as usize,
            scalar(&module.types[member.ty].inner),
        );
        if found != (*field, *offset, *kind) {
            return Err(format!(
                "{name} has {found:?}, in Rust {:?}",
                (field, offset, kind)
            ));
        }
    }
    Ok(())
}

/// Returns the name of a 32-bit scalar type, as Rust and WGSL spell it.
fn scalar(inner: &TypeInner) -> &'static str {
    match inner {
        TypeInner::Scalar(scalar) if scalar.width == 4 => match scalar.kind {
            ScalarKind::Sint => "i32",
            ScalarKind::Uint => "u32",
            ScalarKind::Float => "f32",
            _ => "another scalar",
        },
        _ => "not a scalar of 32 bits",
    }
}

#[test]
fn every_library_is_valid_alone_or_used_by_a_pass() {
    for (name, _) in FILES.iter().filter(|(_, text)| !is_pass(text)) {
        let used = FILES
            .iter()
            .any(|(_, text)| imports(text).any(|import| import == *name));
        let alone = module(&compose(name, &[]));
        assert!(used || alone.is_ok(), "{name}: {alone:?}");
    }
}

#[test]
fn every_pass_is_valid_with_its_bindings() {
    for pass in PASSES {
        let source = compose(pass.shader, pass.bindings);
        let module = module(&source).unwrap_or_else(|error| panic!("{}: {error}", pass.name));
        let [entry] = &module.entry_points[..] else {
            panic!("{} has not exactly one entry point", pass.name);
        };
        assert_eq!(entry.name, "main", "{}", pass.name);
        assert_eq!(
            module
                .global_variables
                .iter()
                .filter(|(_, v)| v.binding.is_some())
                .count(),
            pass.bindings.len()
        );
    }
}

#[test]
fn every_file_with_an_entry_point_belongs_to_a_pass() {
    for (name, text) in FILES {
        let belongs = PASSES.iter().any(|pass| pass.shader == *name);
        assert_eq!(is_pass(text), belongs, "{name}");
    }
}

#[test]
fn shared_structures_lie_alike_in_rust_and_in_shaders() {
    let module = module(&compose("wide", &[])).unwrap();
    assert_eq!(STRUCTURES.len(), LENGTHS.len());
    for (name, fields) in STRUCTURES {
        let length = LENGTHS.iter().find(|(other, _)| other == name);
        let (_, length) = length.unwrap_or_else(|| panic!("{name} has no length"));
        compare(&module, name, fields, *length).unwrap();
    }
}

#[test]
fn a_structure_that_differs_is_caught() {
    let (name, fields) = Job::FIELDS;
    let caught = |wgsl: &str| {
        let module = module(&format!("struct Job {{ {wgsl} }}")).unwrap();
        compare(&module, name, fields, size_of::<Job>())
    };
    assert_eq!(caught("a: u32, b: u32, c: u32, d: u32"), Ok(()));
    let different = [
        "a: u32, @align(8) b: u32, c: u32, d: u32",
        "a: u32, @align(8) b: u32, c: u32",
        "b: u32, a: u32, c: u32, d: u32",
        "a: u32, b: u32, c: u32, d: i32",
        "a: u32, b: u32, c: u32",
        "a: u32, b: u32, c: u32, d: u32, e: u32",
    ];
    for wgsl in different {
        assert!(caught(wgsl).is_err(), "{wgsl}");
    }
    let mut shifted = fields.to_vec();
    shifted[1].1 += 4;
    let module = module(&compose("wide", &[])).unwrap();
    let error = compare(&module, name, &shifted, size_of::<Job>()).unwrap_err();
    assert!(error.contains('b'), "{error}");
    assert!(compare(&module, "Nonesuch", fields, 16).is_err());
}

#[test]
fn an_invalid_shader_is_refused() {
    let refused = [
        // It does not parse, names what does not exist, mixes types.
        "fn f() -> { }",
        "fn f() -> u32 { return nonesuch; }",
        "fn f() -> u32 { return 1u + 1i; }",
        // It parses, but a workgroup has no invocations.
        "@compute @workgroup_size(0) fn main() {}",
        // Native extensions, which browsers lack.
        "fn f() -> i64 { return 1li; }",
        "fn f(a: f64) -> f64 { return a; }",
    ];
    for source in refused {
        assert!(module(source).is_err(), "{source}");
    }
    assert!(
        module(&format!(
            "{} fn g() -> bool {{ return 1u; }}",
            compose("wide", &[])
        ))
        .is_err()
    );
}
