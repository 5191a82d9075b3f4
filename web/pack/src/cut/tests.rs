//! Small programs are cut, and both modules run in an interpreter.

use wasm_encoder::{
    CodeSection, ConstExpr, DataSection, ElementSection, Elements, EntityType, ExportKind,
    ExportSection, Function, FunctionSection, GlobalSection, GlobalType, ImportSection,
    Instruction, MemArg, MemorySection, MemoryType, Module, NameMap, NameSection, RefType,
    TableSection, TableType, TypeSection, ValType,
};
use wasmi::{Caller, Engine, Extern, Func, Instance, Store};

use super::program::Program;
use super::reach::Plan;
use super::{LOADER, first, later};

/// Imported function 0 loads the later module; the others follow.
const NAMES: [&str; 9] = [
    "env::load",
    "web::load_later",
    "web::run",
    "core::shared",
    "core::tiny",
    "late::double",
    "late::square",
    "core::helper",
    "late::unused",
];

fn is_later(name: &str, _bytes: usize) -> bool {
    name.starts_with("late::")
}

/// Returns a program: `run(x)` is `double(x)`, called directly, plus `square(x)`, called by way of a table, plus
/// `shared(x)`. The first two are late. They need a global, the memory, two functions of the first module and one that
/// no other needs. `loader` calls this function.
fn program(loader: u32) -> Vec<u8> {
    use Instruction::{
        Call, CallIndirect, End, GlobalGet, I32Add, I32Const, I32Load8U, I32Mul, LocalGet,
    };
    let byte = MemArg {
        offset: 0,
        align: 0,
        memory_index: 0,
    };
    let x = LocalGet(0);
    let square = CallIndirect {
        type_index: 1,
        table_index: 0,
    };
    let bodies: [Vec<Instruction<'_>>; 8] = [
        match loader {
            0 => vec![Call(0), End],
            late => vec![I32Const(1), Call(late), Instruction::Drop, End],
        },
        vec![
            x.clone(),
            Call(5),
            x.clone(),
            I32Const(1),
            square,
            I32Add,
            x.clone(),
            Call(3),
            I32Add,
            End,
        ],
        vec![x.clone(), Call(4), GlobalGet(0), I32Add, End],
        vec![x.clone(), I32Const(1), I32Add, End],
        vec![x.clone(), Call(3), Call(7), I32Const(2), I32Mul, End],
        vec![x.clone(), Call(4), x.clone(), Call(4), I32Mul, End],
        vec![x.clone(), I32Const(0), I32Load8U(byte), I32Add, End],
        vec![x, End],
    ];

    let (mut functions, mut code) = (FunctionSection::new(), CodeSection::new());
    for (index, body) in bodies.iter().enumerate() {
        functions.function(u32::from(index > 0));
        let mut function = Function::new([]);
        for instruction in body {
            function.instruction(instruction);
        }
        code.function(&function);
    }
    wrapped(&functions, &code)
}

/// Returns the module of these functions, with all that they refer to.
fn wrapped(functions: &FunctionSection, code: &CodeSection) -> Vec<u8> {
    let mut types = TypeSection::new();
    types.ty().function([], []);
    types.ty().function([ValType::I32], [ValType::I32]);
    let mut imports = ImportSection::new();
    imports.import("env", "load", EntityType::Function(0));
    let mut tables = TableSection::new();
    let table = TableType {
        element_type: RefType::FUNCREF,
        table64: false,
        minimum: 2,
        maximum: None,
        shared: false,
    };
    tables.table(table);
    let mut memories = MemorySection::new();
    memories.memory(MemoryType {
        minimum: 1,
        maximum: None,
        memory64: false,
        shared: false,
        page_size_log2: None,
    });
    let mut globals = GlobalSection::new();
    let global = GlobalType {
        val_type: ValType::I32,
        mutable: true,
        shared: false,
    };
    globals.global(global, &ConstExpr::i32_const(10));
    let mut exports = ExportSection::new();
    exports.export("memory", ExportKind::Memory, 0);
    exports.export(LOADER, ExportKind::Func, 1);
    exports.export("run", ExportKind::Func, 2);
    let mut elements = ElementSection::new();
    elements.active(
        None,
        &ConstExpr::i32_const(0),
        Elements::Functions([2, 6][..].into()),
    );
    let mut data = DataSection::new();
    data.active(0, &ConstExpr::i32_const(0), [5]);
    let mut map = NameMap::new();
    for (index, name) in (0..).zip(NAMES) {
        map.append(index, name);
    }
    let mut names = NameSection::new();
    names.functions(&map);

    let mut module = Module::new();
    module
        .section(&types)
        .section(&imports)
        .section(functions)
        .section(&tables)
        .section(&memories)
        .section(&globals);
    module
        .section(&exports)
        .section(&elements)
        .section(code)
        .section(&data)
        .section(&names);
    module.finish()
}

/// What the imported function does.
#[derive(Default)]
struct Page {
    first: Option<Instance>,
    later: Vec<u8>,
    loads: u32,
}

/// Runs `run(3)` twice, and returns both results and how often the later module was loaded.
fn run(first: &[u8], later: &[u8]) -> Result<([i32; 2], u32), wasmi::Error> {
    let engine = Engine::default();
    let page = Page {
        later: later.to_vec(),
        ..Page::default()
    };
    let mut store = Store::new(&engine, page);
    let load = Func::wrap(
        &mut store,
        |mut caller: Caller<'_, Page>| -> Result<(), wasmi::Error> {
            caller.data_mut().loads += 1;
            let (Some(first), false) = (caller.data().first, caller.data().later.is_empty()) else {
                return Ok(());
            };
            let module = wasmi::Module::new(caller.engine(), &caller.data().later)?;
            let imports: Vec<Extern> = module
                .imports()
                .map(|import| first.get_export(&caller, import.name()))
                .collect::<Option<_>>()
                .ok_or_else(|| wasmi::Error::new("the first module lacks an export"))?;
            Instance::new(&mut caller, &module, &imports)?;
            Ok(())
        },
    );

    let module = wasmi::Module::new(&engine, first)?;
    let instance = Instance::new(&mut store, &module, &[load.into()])?;
    store.data_mut().first = Some(instance);
    let run = instance.get_typed_func::<i32, i32>(&store, "run")?;
    let results = [run.call(&mut store, 3)?, run.call(&mut store, 3)?];
    Ok((results, store.data().loads))
}

/// What `run(3)` is: (3 + 1 + 10 + 5) * 2 + (3 + 1)² + (3 + 1 + 10).
const RESULT: i32 = 68;

#[test]
fn both_modules_do_what_the_program_did_and_the_later_one_is_loaded_once() {
    let whole = program(0);
    assert_eq!(run(&whole, &[]).unwrap(), ([RESULT; 2], 0));

    let halves = super::cut(&whole, is_later).unwrap();
    assert_eq!(run(&halves.first, &halves.later).unwrap(), ([RESULT; 2], 1));
    let again = super::cut(&whole, is_later).unwrap();
    assert_eq!((halves.first, halves.later), (again.first, again.later));
}

#[test]
fn without_its_later_module_the_program_stops() {
    let halves = super::cut(&program(0), is_later).unwrap();
    assert!(run(&halves.first, &[]).is_err());
}

#[test]
fn what_only_later_functions_call_goes_with_them_and_small_ones_are_copied() {
    let module = program(0);
    let program = Program::read(&module).unwrap();
    let plan = Plan::of(&program, is_later).unwrap();
    let names = |indices: &mut dyn Iterator<Item = &u32>| -> Vec<&str> {
        indices.map(|index| NAMES[*index as usize]).collect()
    };
    assert_eq!(
        names(&mut plan.later.iter()),
        [
            "late::double",
            "late::square",
            "core::helper",
            "late::unused"
        ]
    );
    assert_eq!(
        names(&mut plan.slots.keys()),
        ["late::double", "late::square"]
    );
    assert_eq!(names(&mut plan.shared.keys()), ["core::shared"]);
    assert_eq!(names(&mut plan.copied.iter()), ["core::tiny"]);
}

#[test]
fn a_wrong_slot_and_a_missing_export_are_noticed() {
    let module = program(0);
    let program = Program::read(&module).unwrap();
    let mut plan = Plan::of(&program, is_later).unwrap();
    let right = first::encode(&program, &plan).unwrap();

    // Both late functions have the same type, so that only the result shows that their slots are exchanged.
    let mut exchanged = Plan::of(&program, is_later).unwrap();
    exchanged.slots = plan.slots.keys().copied().zip([1, 0]).collect();
    let wrong = first::encode(&program, &exchanged).unwrap();
    let later_module = later::encode(&program, &plan).unwrap();
    assert_eq!(run(&right, &later_module).unwrap().0, [RESULT; 2]);
    assert_ne!(run(&wrong, &later_module).unwrap().0, [RESULT; 2]);

    plan.shared.clear();
    let error = format!("{:#}", later::encode(&program, &plan).err().unwrap());
    assert!(
        error.contains("late::double") && error.contains("function 3"),
        "{error}"
    );
    let without = first::encode(&program, &plan).unwrap();
    assert!(run(&without, &later_module).is_err());
}

#[test]
fn a_loader_that_needs_what_it_loads_is_refused() {
    let error = format!("{:#}", super::cut(&program(6), is_later).err().unwrap());
    assert!(error.contains("late::square"), "{error}");
    let error = format!("{:#}", super::cut(&program(0), |_, _| true).err().unwrap());
    assert!(error.contains("web::load_later"), "{error}");
}

#[test]
fn the_table_adds_up_what_each_crate_has_in_both_modules() {
    let halves = super::cut(&program(0), is_later).unwrap();
    let table = halves.weights.to_string();
    let all = table.lines().last().unwrap();
    // Behind the two numbers of bytes stands the compressed share.
    let numbers: Vec<usize> = all
        .split_whitespace()
        .skip(1)
        .take(2)
        .map(|number| number.parse().unwrap())
        .collect();
    let module = program(0);
    let program = Program::read(&module).unwrap();
    let whole: usize = program
        .functions
        .iter()
        .map(|function| function.body.as_bytes().len())
        .sum();
    assert_eq!(numbers.iter().sum::<usize>(), whole);
    assert!(numbers.iter().all(|number| *number > 0), "{table}");
}
