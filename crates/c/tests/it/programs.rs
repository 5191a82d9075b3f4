//! Programs in C and C++ that use the header and the library.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use gdextension_api::version_4_2;
use tilescope_c::exports::TilescopeSettings;

use crate::support::{CPlane, buffer, sorted_bits, square};

/// Returns whether a compiler is there, and says so past the capture of the tests' output if it is not.
fn has(compiler: &str) -> bool {
    let found = Command::new(compiler).arg("--version").output().is_ok();
    if !found {
        let _ = writeln!(
            std::io::stderr(),
            "SKIPPED: {compiler} is not installed, so that no program of it is compiled"
        );
    }
    found
}

fn folder() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Runs a command, and returns what it wrote. Fails with its errors if it did.
fn run(command: &mut Command) -> String {
    let Output {
        status,
        stdout,
        stderr,
    } = command.output().expect("a command");
    let errors = String::from_utf8_lossy(&stderr);
    assert!(status.success(), "{command:?}: {errors}");
    String::from_utf8(stdout).expect("UTF-8")
}

/// Returns the folder of the libraries for C, which lie beside this test.
fn libraries() -> PathBuf {
    let test = std::env::current_exe().expect("this test");
    test.parent().expect("a folder").to_path_buf()
}

/// Compiles a file of C without making a program of it, by the strictest rules.
fn compile(compiler: &str, standard: &str, source: &str) -> Output {
    let folder_of_source = tempfile::tempdir().expect("a folder");
    let name = if compiler == "cc" { "it.c" } else { "it.cpp" };
    let path = folder_of_source.path().join(name);
    std::fs::write(&path, source).expect("a source");
    compile_in(folder_of_source.path(), compiler, standard, name)
}

/// Compiles a file as [`compile`] does, which may include other files of its folder.
fn compile_in(folder_of_source: &Path, compiler: &str, standard: &str, name: &str) -> Output {
    Command::new(compiler)
        .args([
            standard,
            "-Wall",
            "-Wextra",
            "-pedantic",
            "-Werror",
            "-fsyntax-only",
            "-I",
        ])
        .arg(folder())
        .arg(folder_of_source.join(name))
        .output()
        .expect("a compiler")
}

#[test]
fn the_header_is_c99_and_cpp17() {
    let source =
        "#include \"tilescope.h\"\nint main(void) { return tilescope_settings().method; }\n";
    for (compiler, standard) in [("cc", "-std=c99"), ("c++", "-std=c++17")] {
        if !has(compiler) {
            continue;
        }
        let compiled = compile(compiler, standard, source);
        let errors = String::from_utf8_lossy(&compiled.stderr);
        assert!(compiled.status.success(), "{errors}");
        // The control: a function that is not in the header.
        let other = source.replace("tilescope_settings()", "tilescope_setting()");
        assert!(!compile(compiler, standard, &other).status.success());
    }
}

/// The sizes and places in the header's structs are those in Rust, by the compiler of C.
#[test]
fn structs_are_laid_out_alike() {
    if !has("cc") {
        return;
    }
    let facts = [
        ("sizeof(TilescopeSettings)", size_of::<TilescopeSettings>()),
        (
            "offsetof(TilescopeSettings, method)",
            std::mem::offset_of!(TilescopeSettings, method),
        ),
        (
            "offsetof(TilescopeSettings, leaf)",
            std::mem::offset_of!(TilescopeSettings, leaf),
        ),
        ("sizeof(TilescopeWindow)", 32),
        ("sizeof(TilescopePoint)", 16),
        ("sizeof(TilescopeStatus)", 4),
    ];
    for (text, size) in facts {
        // An array with a negative length does not compile.
        let source = |size: usize| {
            format!("#include \"tilescope.h\"\nextern char fact[{text} == {size} ? 1 : -1];\n")
        };
        assert!(
            compile("cc", "-std=c99", &source(size)).status.success(),
            "{text}"
        );
        assert!(
            !compile("cc", "-std=c99", &source(size + 1))
                .status
                .success()
        );
    }
}

/// Returns the samples of the last window of `examples/walk.c`, as the bits of x and y, by the library itself.
fn last_window() -> Vec<[u64; 2]> {
    let settings = TilescopeSettings {
        seed: 7,
        radius: 1.5,
        ..TilescopeSettings::default()
    };
    let plane = CPlane::new(&settings).unwrap();
    // 150 steps of 3 to the right and 100 of them downwards, as the program computes them.
    let window = square(-150.0 + 3.0 * 150.0, 75.0 - 3.0 * 100.0, 180.0);
    let mut points = buffer(plane.capacity(&window).unwrap());
    let count = plane.fill(&window, &mut points).unwrap();
    sorted_bits(&points[..count])
}

#[test]
fn a_program_in_c_walks_over_the_plane_and_has_the_same_points() {
    if !has("cc") {
        return;
    }
    let made = tempfile::tempdir().expect("a folder");
    let program = made.path().join("walk");
    let libraries = libraries();
    run(Command::new("cc")
        .args(["-std=c99", "-Wall", "-Wextra", "-pedantic", "-Werror", "-I"])
        .arg(folder())
        .arg(folder().join("examples/walk.c"))
        .arg("-L")
        .arg(&libraries)
        .args(["-ltilescope_c", "-o"])
        .arg(&program));

    let mut walk = Command::new(&program);
    walk.env("LD_LIBRARY_PATH", &libraries)
        .env("DYLD_LIBRARY_PATH", &libraries);
    let said = run(&mut walk);
    assert!(said.contains("samples in view after 150 steps"), "{said}");

    let printed = run(walk.arg("points"));
    let bits = |word: &str| u64::from_str_radix(word, 16).expect("bits");
    let points = printed.lines().map(|line| {
        let (x, y) = line.split_once(' ').expect("two numbers");
        [bits(x), bits(y)]
    });
    let mut points: Vec<[u64; 2]> = points.collect();
    points.sort_unstable();
    assert!(points.len() > 9_000);
    assert_eq!(points, last_window());
}

#[test]
fn the_extension_of_godot_compiles_against_the_header_of_godot() {
    if !has("cc") {
        return;
    }
    let here = tempfile::tempdir().expect("a folder");
    let header = here.path().join("gdextension_interface.h");
    std::fs::write(header, &*version_4_2::load_gdextension_header_h()).expect("a header");
    let source = folder().join("examples/godot/tilescope_godot.c");
    let source = std::fs::read_to_string(source).expect("a source");
    let compiles = |source: &str| {
        std::fs::write(here.path().join("it.c"), source).expect("a source");
        let compiled = compile_in(here.path(), "cc", "-std=c99", "it.c");
        let errors = String::from_utf8_lossy(&compiled.stderr).into_owned();
        (compiled.status.success(), errors)
    };
    let (is_right, errors) = compiles(&source);
    assert!(is_right, "{errors}");
    // The control: the arguments of a method in another type than Godot's.
    let wrong = source.replace(
        "info.arguments_info = arguments",
        "info.arguments_info = kinds",
    );
    assert_ne!(wrong, source);
    assert!(!compiles(&wrong).0);

    // The number of `resize` must be the one that Godot lists for its signature.
    let api = version_4_2::load_gdextension_json();
    // A class begins with its name, and one with an index goes on with what is at it.
    let class = "\"name\": \"PackedVector2Array\",\n\t\t\t\"indexing_return_type\"";
    let (_, array) = api.split_once(class).expect("the class");
    let (_, resize) = array.split_once(r#""name": "resize""#).expect("the method");
    let (_, hash) = resize.split_once(r#""hash": "#).expect("its number");
    let hash: String = hash.chars().take_while(char::is_ascii_digit).collect();
    assert!(
        source.contains(&format!("#define RESIZE_HASH {hash}\n")),
        "{hash}"
    );
}
