//! The first module: what the start needs, and a stub for each function of the later module that it refers to. A stub
//! calls the *check*, which loads the later module if it is not there, and then the function in its *slot*, a place of
//! a table that the later module fills.

use std::collections::BTreeSet;

use anyhow::{Result, anyhow, bail};
use wasm_encoder::reencode::{self, Reencode};
use wasm_encoder::{
    CodeSection, DataCountSection, DataSection, ElementSection, ExportKind, ExportSection,
    Function, FunctionSection, GlobalSection, ImportSection, MemorySection, Module, RefType,
    Section, StartSection, TableSection, TableType, TypeSection,
};

use super::encode::{self, Indices, Missing};
use super::program::Program;
use super::reach::{Plan, name};

/// Returns the first module.
pub fn encode(program: &Program<'_>, plan: &Plan) -> Result<Vec<u8>> {
    // Imported functions keep their indices, as the format has them first. Stubs come behind the functions that are
    // kept, as `functions` writes them, and behind the stubs comes the check, for which the program has no index.
    let imported = 0..program.imported.len() as u32;
    let kept = by_name(program, |index| !plan.later.contains(&index));
    let stubs = plan.slots.keys().copied();
    let order = imported.chain(kept.iter().copied()).chain(stubs);
    let mut indices = Indices::of(program, order);
    let (kinds, code) = functions(program, plan, &kept, &mut indices)?;

    // The order of sections is fixed by the format.
    let mut module = Module::new();
    let sections = &program.sections;
    written(
        &mut module,
        sections.types.as_ref(),
        |types: &mut TypeSection, section| indices.parse_type_section(types, section),
    )?;
    written(
        &mut module,
        sections.imports.as_ref(),
        |imports: &mut ImportSection, section| indices.parse_import_section(imports, section),
    )?;
    module.section(&kinds);
    module.section(&tables(program, plan, &mut indices)?);
    written(
        &mut module,
        sections.memories.as_ref(),
        |memories: &mut MemorySection, section| indices.parse_memory_section(memories, section),
    )?;
    written(
        &mut module,
        sections.globals.as_ref(),
        |globals: &mut GlobalSection, section| indices.parse_global_section(globals, section),
    )?;
    module.section(&exports(program, plan, &mut indices)?);
    if let Some(start) = program.start {
        let function_index = indices.get(start)?;
        module.section(&StartSection { function_index });
    }
    written(
        &mut module,
        sections.elements.as_ref(),
        |elements: &mut ElementSection, section| indices.parse_element_section(elements, section),
    )?;
    if let Some(count) = program.data_count {
        module.section(&DataCountSection { count });
    }
    module.section(&code);
    written(
        &mut module,
        sections.data.as_ref(),
        |data: &mut DataSection, section| indices.parse_data_section(data, section),
    )?;
    Ok(module.finish())
}

/// Writes a section again, if the program has it.
fn written<R: Clone, S: Section + Default>(
    module: &mut Module,
    section: Option<&R>,
    parse: impl FnOnce(&mut S, R) -> Result<(), reencode::Error<Missing>>,
) -> Result<()> {
    if let Some(section) = section.cloned() {
        let mut made = S::default();
        parse(&mut made, section)
            .map_err(|error| anyhow!("a section cannot be written again: {error}"))?;
        module.section(&made);
    }
    Ok(())
}

/// Returns the types and the code of the functions that are kept, of the stubs, and of the function that each stub
/// calls first, which stands behind all others.
fn functions(
    program: &Program<'_>,
    plan: &Plan,
    kept: &[u32],
    indices: &mut Indices,
) -> Result<(FunctionSection, CodeSection)> {
    let (mut kinds, mut code) = (FunctionSection::new(), CodeSection::new());
    let functions = kept.iter().filter_map(|index| program.function(*index));
    encode::code(functions, indices, &mut kinds, &mut code)?;

    // Stubs need the index of the check before it is written: it comes behind the functions and the stubs.
    let check = (program.imported.len() + kept.len() + plan.slots.len()) as u32;
    // The table of slots is behind the program's own, so that their number is its index.
    let [slots_table, ..] = program.counts();
    for (index, slot) in &plan.slots {
        kinds.function(program.kind(*index));
        code.function(&stub(program, *index, check, slots_table, *slot));
    }
    // Like the loader that it calls, the check takes and returns nothing, so that it has the loader's type.
    kinds.function(program.kind(plan.loader));
    code.function(&checking(slots_table, indices.get(plan.loader)?));
    Ok((kinds, code))
}

/// Returns the program's tables, and the table of slots as the last.
fn tables(program: &Program<'_>, plan: &Plan, indices: &mut Indices) -> Result<TableSection> {
    let mut tables = TableSection::new();
    if let Some(section) = program.sections.tables.clone() {
        indices
            .parse_table_section(&mut tables, section)
            .map_err(|error| anyhow!("tables: {error}"))?;
    }
    tables.table(slots_type(plan));
    Ok(tables)
}

/// Returns the type of the table of slots. It has one slot at least, as the check looks at the first.
pub fn slots_type(plan: &Plan) -> TableType {
    let slots = plan.slots.len().max(1) as u64;
    TableType {
        element_type: RefType::FUNCREF,
        table64: false,
        minimum: slots,
        maximum: Some(slots),
        shared: false,
    }
}

/// Returns the functions for which a condition holds, those of similar names together: neighbours that are alike
/// compress well. By name the code needs 1.3% fewer bytes than by size, which is the order of the tool that binds it.
pub fn by_name(program: &Program<'_>, holds: impl Fn(u32) -> bool) -> Vec<u32> {
    let mut indices: Vec<u32> = program.own().filter(|index| holds(*index)).collect();
    indices.sort_by_key(|index| program.function(*index).map(|function| &function.name));
    indices
}

/// Returns what the first module exports: what the program exports, and what the later module imports.
fn exports(program: &Program<'_>, plan: &Plan, indices: &mut Indices) -> Result<ExportSection> {
    let mut exports = ExportSection::new();
    if let Some(section) = program.sections.exports.clone() {
        indices
            .parse_export_section(&mut exports, section)
            .map_err(|error| anyhow!("exports: {error}"))?;
    }

    // The later module finds them by their names, in whatever order they are.
    for (name, kind, index) in shared_places(program, plan) {
        exports.export(&name, kind, index);
    }
    for (index, name) in &plan.shared {
        exports.export(name, ExportKind::Func, indices.get(*index)?);
    }

    // A module with two exports of one name is invalid.
    let ours = shared_names(program, plan);
    let clash = program
        .export_names
        .iter()
        .find(|name| ours.contains(**name));
    if let Some(name) = clash {
        bail!("the export {name} has a name that the later module needs");
    }
    Ok(exports)
}

fn shared_names(program: &Program<'_>, plan: &Plan) -> BTreeSet<String> {
    let places = shared_places(program, plan)
        .into_iter()
        .map(|(name, ..)| name);
    places.chain(plan.shared.values().cloned()).collect()
}

/// Returns the tables, memories and globals, with the slots' table as the last of the tables, and the names by which
/// they are exported.
pub fn shared_places(program: &Program<'_>, plan: &Plan) -> Vec<(String, ExportKind, u32)> {
    let [tables, memories, globals] = program.counts();
    let tables = (0..=tables).map(|index| (ExportKind::Table, index));
    let memories = (0..memories).map(|index| (ExportKind::Memory, index));
    let globals = (0..globals).map(|index| (ExportKind::Global, index));
    // Functions have the names before.
    (plan.shared.len() as u32..)
        .zip(tables.chain(memories).chain(globals))
        .map(|(number, (kind, index))| (name(number), kind, index))
        .collect()
}

/// Returns a function that calls the function of a slot, once the later module is there.
fn stub(program: &Program<'_>, index: u32, check: u32, table_index: u32, slot: u32) -> Function {
    let type_index = program.kind(index);
    let parameters = program.types[type_index as usize].params().len() as u32;
    let mut stub = Function::new([]);
    let mut code = stub.instructions();
    code.call(check);
    for parameter in 0..parameters {
        code.local_get(parameter);
    }
    code.i32_const(slot as i32)
        .call_indirect(table_index, type_index)
        .end();
    stub
}

/// Returns the function that loads the later module if it is not there: its first slot is empty then.
fn checking(slots_table: u32, loader: u32) -> Function {
    let mut check = Function::new([]);
    let mut code = check.instructions();
    code.i32_const(0).table_get(slots_table).ref_is_null();
    code.if_(wasm_encoder::BlockType::Empty)
        .call(loader)
        .end()
        .end();
    check
}
