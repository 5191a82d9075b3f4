//! The first module: what the start needs, and a stub for each function of the later module that it refers to.

use std::collections::BTreeSet;

use anyhow::{Result, anyhow, ensure};
use wasm_encoder::reencode::Reencode;
use wasm_encoder::{
    CodeSection, DataCountSection, DataSection, ElementSection, ExportKind, ExportSection,
    Function, FunctionSection, GlobalSection, ImportSection, Module, RefType, StartSection,
    TableSection, TableType, TypeSection,
};

use super::encode::{self, Indices};
use super::program::Program;
use super::reach::{Plan, name};

/// Returns the first module.
pub fn encode(program: &Program<'_>, plan: &Plan) -> Result<Vec<u8>> {
    let imported = 0..program.imported.len() as u32;
    let kept: Vec<u32> = by_name(program, |index| !plan.later.contains(&index));
    let stubs: Vec<u32> = plan.slots.keys().copied().collect();
    let order = imported
        .chain(kept.iter().copied())
        .chain(stubs.iter().copied());
    let mut indices = Indices::of(program, order);

    // The function that each stub calls first stands behind all others.
    let check = program.imported.len() as u32 + (kept.len() + stubs.len()) as u32;
    let check_kind = program.kind(plan.loader);

    let mut module = Module::new();
    let failed = |error| anyhow!("a section cannot be written again: {error}");
    let sections = &program.sections;
    if let Some(section) = sections.types.clone() {
        let mut types = TypeSection::new();
        indices
            .parse_type_section(&mut types, section)
            .map_err(failed)?;
        module.section(&types);
    }
    if let Some(section) = sections.imports.clone() {
        let mut imports = ImportSection::new();
        indices
            .parse_import_section(&mut imports, section)
            .map_err(failed)?;
        module.section(&imports);
    }

    let (mut kinds, mut code) = (FunctionSection::new(), CodeSection::new());
    let functions = kept.iter().filter_map(|index| program.function(*index));
    encode::code(functions, &mut indices, &mut kinds, &mut code)?;
    let [slots_table, ..] = program.counts();
    for (index, slot) in &plan.slots {
        kinds.function(program.kind(*index));
        code.function(&stub(program, *index, check, slots_table, *slot));
    }
    kinds.function(check_kind);
    code.function(&checking(slots_table, indices.get(plan.loader)?));
    module.section(&kinds);

    let mut tables = TableSection::new();
    if let Some(section) = sections.tables.clone() {
        indices
            .parse_table_section(&mut tables, section)
            .map_err(failed)?;
    }
    // A slot more than there are stubs: the check looks at the first, which must be there.
    let slots = plan.slots.len().max(1) as u64;
    tables.table(TableType {
        element_type: RefType::FUNCREF,
        table64: false,
        minimum: slots,
        maximum: Some(slots),
        shared: false,
    });
    module.section(&tables);

    if let Some(section) = sections.memories.clone() {
        let mut memories = wasm_encoder::MemorySection::new();
        indices
            .parse_memory_section(&mut memories, section)
            .map_err(failed)?;
        module.section(&memories);
    }
    if let Some(section) = sections.globals.clone() {
        let mut globals = GlobalSection::new();
        indices
            .parse_global_section(&mut globals, section)
            .map_err(failed)?;
        module.section(&globals);
    }
    module.section(&exports(program, plan, &mut indices)?);
    if let Some(start) = program.start {
        let function_index = indices.get(start)?;
        module.section(&StartSection { function_index });
    }
    if let Some(section) = sections.elements.clone() {
        let mut elements = ElementSection::new();
        indices
            .parse_element_section(&mut elements, section)
            .map_err(failed)?;
        module.section(&elements);
    }
    if let Some(count) = program.data_count {
        module.section(&DataCountSection { count });
    }
    module.section(&code);
    if let Some(section) = sections.data.clone() {
        let mut data = DataSection::new();
        indices
            .parse_data_section(&mut data, section)
            .map_err(failed)?;
        module.section(&data);
    }
    Ok(module.finish())
}

/// Returns the functions for which a condition holds, those of similar names together: neighbours that are alike compress well. By
/// name the code needs 1.3% fewer bytes than by size, which is the order of the tool that binds it.
pub fn by_name(program: &Program<'_>, holds: impl Fn(u32) -> bool) -> Vec<u32> {
    let mut indices: Vec<u32> = program.own().filter(|index| holds(*index)).collect();
    indices.sort_by_key(|index| program.function(*index).map(|function| &function.name));
    indices
}

/// Returns what the module exports: what it did before, and what the later module imports.
fn exports(program: &Program<'_>, plan: &Plan, indices: &mut Indices) -> Result<ExportSection> {
    let mut exports = ExportSection::new();
    if let Some(section) = program.sections.exports.clone() {
        indices
            .parse_export_section(&mut exports, section)
            .map_err(|error| anyhow!("exports: {error}"))?;
    }

    for (name, kind, index) in shared_places(program, plan) {
        exports.export(&name, kind, index);
    }
    for (index, name) in &plan.shared {
        exports.export(name, ExportKind::Func, indices.get(*index)?);
    }

    // A name that is there twice makes the module invalid.
    let ours = shared_names(program, plan);
    let clash = program
        .export_names
        .iter()
        .find(|name| ours.contains(**name));
    ensure!(
        clash.is_none(),
        "the export {clash:?} has a name that the later module needs"
    );
    Ok(exports)
}

fn shared_names(program: &Program<'_>, plan: &Plan) -> BTreeSet<String> {
    let places = shared_places(program, plan)
        .into_iter()
        .map(|(name, ..)| name);
    places.chain(plan.shared.values().cloned()).collect()
}

/// Returns the tables, memories and globals, with the slots' table as the last of the tables, and the names by which they are
/// exported.
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
