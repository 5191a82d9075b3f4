//! The later module: it imports what it needs of the first, and fills the slots. A slot is a place in a table of the
//! first module; through it a stub, which stands in the first module for a function of the later one, calls that
//! function.

use anyhow::{Result, anyhow};
use wasm_encoder::reencode::Reencode;
use wasm_encoder::{
    CodeSection, ElementSection, EntityType, FunctionSection, ImportSection, Module, TypeSection,
};

use super::encode::{self, Indices};
use super::first::{by_name, shared_places, slots_type};
use super::program::Program;
use super::reach::Plan;

/// The name of the module from which everything is imported: the shortest.
const FROM: &str = "";

/// Returns the later module.
pub fn encode(program: &Program<'_>, plan: &Plan) -> Result<Vec<u8>> {
    // Its own functions, and copies of small ones of the first module, which cost less than imports. By name, similar
    // ones follow each other and compress well.
    let own = by_name(program, |index| {
        plan.later.contains(&index) || plan.copied.contains(&index)
    });
    let order = plan.shared.keys().copied().chain(own.iter().copied());
    let mut indices = Indices::of(program, order);

    let mut module = Module::new();
    // All types, also those that nothing here needs: they are few, and their indices stay.
    if let Some(section) = program.sections.types.clone() {
        let mut types = TypeSection::new();
        indices
            .parse_type_section(&mut types, section)
            .map_err(|error| anyhow!("types: {error}"))?;
        module.section(&types);
    }
    module.section(&imports(program, plan, &mut indices)?);

    let (mut kinds, mut code) = (FunctionSection::new(), CodeSection::new());
    let functions = own.iter().filter_map(|index| program.function(*index));
    encode::code(functions, &mut indices, &mut kinds, &mut code)?;
    module.section(&kinds);
    module.section(&elements(program, plan, &indices)?);
    module.section(&code);
    Ok(module.finish())
}

/// Imports the functions that are called, and all tables, memories and globals in the first module's order, so that
/// their indices stay.
fn imports(program: &Program<'_>, plan: &Plan, indices: &mut Indices) -> Result<ImportSection> {
    let mut imports = ImportSection::new();
    for (index, name) in &plan.shared {
        imports.import(FROM, name, EntityType::Function(program.kind(*index)));
    }

    // Tables, memories and globals need the same types as in the first module, or the browser refuses to join the two.
    // The types stand here in the order of `shared_places`: tables, the table of slots, memories, globals.
    let failed = |error| anyhow!("imports: {error}");
    let sections = &program.sections;
    let mut kinds = Vec::new();
    for table in sections.tables.iter().flat_map(Clone::clone) {
        kinds.push(EntityType::Table(
            indices.table_type(table?.ty).map_err(failed)?,
        ));
    }
    kinds.push(EntityType::Table(slots_type(plan)));
    for memory in sections.memories.iter().flat_map(Clone::clone) {
        kinds.push(EntityType::Memory(
            indices.memory_type(memory?).map_err(failed)?,
        ));
    }
    for global in sections.globals.iter().flat_map(Clone::clone) {
        kinds.push(EntityType::Global(
            indices.global_type(global?.ty).map_err(failed)?,
        ));
    }

    for ((name, ..), kind) in shared_places(program, plan).iter().zip(kinds) {
        imports.import(FROM, name, kind);
    }
    Ok(imports)
}

/// Fills the slots. Later functions in the program's own tables replace their stubs there, so that calls by way of a
/// table need no slot any more.
fn elements(program: &Program<'_>, plan: &Plan, indices: &Indices) -> Result<ElementSection> {
    let mut elements = ElementSection::new();
    // The table of slots is behind the program's own, so that their number is its index.
    let [slots_table, ..] = program.counts();
    let in_slots = plan.slots.keys().map(|index| indices.get(*index));
    let in_slots: Vec<u32> = in_slots.collect::<Result<_>>()?;
    // All slots are filled at once, when the later module is instantiated: to find out whether it is there, the first
    // module looks at slot 0 alone.
    encode::fill(&mut elements, slots_table, 0, &in_slots);

    // Places that follow each other become one segment.
    let replaced = program
        .entries
        .iter()
        .filter(|entry| plan.later.contains(&entry.function));
    let replaced: Vec<_> = replaced.collect();
    for run in replaced.chunk_by(|a, b| a.table == b.table && a.place + 1 == b.place) {
        let functions = run.iter().map(|entry| indices.get(entry.function));
        let functions: Vec<u32> = functions.collect::<Result<_>>()?;
        encode::fill(&mut elements, run[0].table, run[0].place, &functions);
    }
    Ok(elements)
}
