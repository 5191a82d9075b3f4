//! A module as it is read, to be cut into two modules: its sections, and who refers to which function. Where the first
//! module calls a function of the later one, a *stub* of the same type stands in its place.

use std::collections::BTreeMap;

use anyhow::{Context, Result, bail, ensure};
use wasmparser::{
    CompositeInnerType, DataSectionReader, ElementItems, ElementKind, ElementSectionReader,
    ExportSectionReader, ExternalKind, FuncType, FunctionBody, GlobalSectionReader,
    ImportSectionReader, KnownCustom, MemorySectionReader, Name, Operator, Parser, Payload,
    TableSectionReader, TypeRef, TypeSectionReader,
};

/// A function of the module.
pub struct Function<'a> {
    /// The index of its type.
    pub kind: u32,
    /// Its code.
    pub body: FunctionBody<'a>,
    /// The name by which its source is known, or nothing.
    pub name: String,
    /// The indices of the functions that it names, each once for each time.
    pub calls: Vec<u32>,
}

/// A place of a table that holds a function.
pub struct Entry {
    /// The index of the table.
    pub table: u32,
    /// The place in it.
    pub place: u32,
    /// The index of the function.
    pub function: u32,
}

/// A module. Functions are counted as WebAssembly does: imported ones first.
#[derive(Default)]
pub struct Program<'a> {
    /// The types of functions.
    pub types: Vec<FuncType>,
    /// The types of the imported functions.
    pub imported: Vec<u32>,
    /// The functions that have code.
    pub functions: Vec<Function<'a>>,
    /// What tables hold when the module is instantiated.
    pub entries: Vec<Entry>,
    /// The exported functions.
    pub exported: BTreeMap<&'a str, u32>,
    /// All names of exports.
    pub export_names: Vec<&'a str>,
    /// The function that runs first.
    pub start: Option<u32>,
    /// The number of segments of data, where the module says it.
    pub data_count: Option<u32>,
    /// The sections that are written again.
    pub sections: Sections<'a>,
}

/// Sections of a module; those that it lacks are missing.
#[derive(Default)]
pub struct Sections<'a> {
    pub types: Option<TypeSectionReader<'a>>,
    pub imports: Option<ImportSectionReader<'a>>,
    pub tables: Option<TableSectionReader<'a>>,
    pub memories: Option<MemorySectionReader<'a>>,
    pub globals: Option<GlobalSectionReader<'a>>,
    pub exports: Option<ExportSectionReader<'a>>,
    pub elements: Option<ElementSectionReader<'a>>,
    pub data: Option<DataSectionReader<'a>>,
}

impl<'a> Program<'a> {
    /// Reads a module.
    pub fn read(module: &'a [u8]) -> Result<Self> {
        let mut program = Self::default();
        // Types come before code, and names after it.
        let mut kinds = Vec::new();
        let mut names = BTreeMap::new();
        for payload in Parser::new(0).parse_all(module) {
            match payload? {
                Payload::TypeSection(section) => program.take_types(section)?,
                Payload::ImportSection(section) => program.take_imports(section)?,
                Payload::FunctionSection(section) => {
                    kinds = section.into_iter().collect::<Result<Vec<u32>, _>>()?;
                }
                Payload::TableSection(section) => program.sections.tables = Some(section),
                Payload::MemorySection(section) => program.sections.memories = Some(section),
                Payload::GlobalSection(section) => program.sections.globals = Some(section),
                Payload::ExportSection(section) => program.take_exports(section)?,
                Payload::StartSection { func, .. } => program.start = Some(func),
                Payload::ElementSection(section) => program.take_elements(section)?,
                Payload::DataCountSection { count, .. } => program.data_count = Some(count),
                Payload::DataSection(section) => program.sections.data = Some(section),
                Payload::CodeSectionEntry(body) => {
                    // Types and bodies of functions are in two sections, in the same order.
                    let kind = *kinds
                        .get(program.functions.len())
                        .context("a function has code and no type")?;
                    program.take_code(kind, body)?;
                }
                // Of custom sections only the names are read. None is written again, as no code depends on them.
                Payload::CustomSection(section) => {
                    if let KnownCustom::Name(section) = section.as_known() {
                        names = function_names(section)?;
                    }
                }
                Payload::Version { .. } | Payload::CodeSectionStart { .. } | Payload::End(_) => {}
                // A section that is not known here would be in neither of the two modules that are written.
                other => bail!("the module has a section that cannot be cut: {other:?}"),
            }
        }

        // Names count functions from the imported ones on, and the linker leaves some without a name.
        let imported = program.imported.len();
        for (index, function) in program.functions.iter_mut().enumerate() {
            function.name = names
                .remove(&((imported + index) as u32))
                .unwrap_or_default();
        }
        Ok(program)
    }

    /// Returns the function of an index, unless it is imported.
    pub fn function(&self, index: u32) -> Option<&Function<'a>> {
        let own = (index as usize).checked_sub(self.imported.len())?;
        self.functions.get(own)
    }

    /// Returns the indices of the functions that have code.
    pub fn own(&self) -> std::ops::Range<u32> {
        let first = self.imported.len() as u32;
        first..first + self.functions.len() as u32
    }

    /// Returns the index of the type of a function.
    pub fn kind(&self, index: u32) -> u32 {
        self.function(index)
            .map_or_else(|| self.imported[index as usize], |function| function.kind)
    }

    /// Returns how many tables, memories and globals the module has.
    pub fn counts(&self) -> [u32; 3] {
        let sections = &self.sections;
        [
            sections
                .tables
                .as_ref()
                .map_or(0, wasmparser::SectionLimited::count),
            sections
                .memories
                .as_ref()
                .map_or(0, wasmparser::SectionLimited::count),
            sections
                .globals
                .as_ref()
                .map_or(0, wasmparser::SectionLimited::count),
        ]
    }

    fn take_types(&mut self, section: TypeSectionReader<'a>) -> Result<()> {
        for group in section.clone() {
            for kind in group?.into_types() {
                // Rust makes no types of the garbage-collected kind, for which no stub could be written.
                let CompositeInnerType::Func(function) = kind.composite_type.inner else {
                    bail!("the module has a type that is not a function's");
                };
                self.types.push(function);
            }
        }
        self.sections.types = Some(section);
        Ok(())
    }

    /// Reads the imports, of which all must be functions.
    fn take_imports(&mut self, section: ImportSectionReader<'a>) -> Result<()> {
        for import in section.clone().into_imports() {
            let import = import?;
            // Imported tables, memories and globals would come before the own ones and shift their indices.
            let TypeRef::Func(kind) = import.ty else {
                bail!(
                    "the module imports {}, which is not a function",
                    import.name
                );
            };
            self.imported.push(kind);
        }
        self.sections.imports = Some(section);
        Ok(())
    }

    fn take_exports(&mut self, section: ExportSectionReader<'a>) -> Result<()> {
        for export in section.clone() {
            let export = export?;
            self.export_names.push(export.name);
            if export.kind == ExternalKind::Func {
                self.exported.insert(export.name, export.index);
            }
        }
        self.sections.exports = Some(section);
        Ok(())
    }

    /// Reads which functions stand at which places of the tables.
    fn take_elements(&mut self, section: ElementSectionReader<'a>) -> Result<()> {
        for element in section.clone() {
            let element = element?;
            // The linker lets the module put all functions into tables when it begins, at places that are plain
            // numbers. If functions were put there later, or at computed places, their places would not be known here.
            let ElementKind::Active {
                table_index,
                offset_expr,
            } = element.kind
            else {
                bail!("the module has elements that are not put into a table at once");
            };
            let mut operators = offset_expr.get_operators_reader();
            let Operator::I32Const { value: first } = operators.read()? else {
                bail!("elements begin at a place that is no number");
            };
            let ElementItems::Functions(functions) = element.items else {
                bail!("a table has elements that are no functions");
            };

            // Places have no sign, and are written as numbers that have one. Elements that name no table are those of
            // the first.
            for (place, function) in (first as u32..).zip(functions) {
                self.entries.push(Entry {
                    table: table_index.unwrap_or(0),
                    place,
                    function: function?,
                });
            }
        }
        self.sections.elements = Some(section);
        Ok(())
    }

    /// Reads a function of this type, and which functions it names.
    fn take_code(&mut self, kind: u32, body: FunctionBody<'a>) -> Result<()> {
        let mut calls = Vec::new();
        for operator in body.get_operators_reader()? {
            match operator? {
                Operator::Call { function_index }
                | Operator::ReturnCall { function_index }
                | Operator::RefFunc { function_index } => calls.push(function_index),
                // No other operator of today names a function. One that did would fail when it is written again, if its
                // function is in the other module.
                _ => {}
            }
        }
        // Types are indexed without a check later.
        ensure!((kind as usize) < self.types.len(), "type {kind} is missing");
        self.functions.push(Function {
            kind,
            body,
            name: String::new(),
            calls,
        });
        Ok(())
    }
}

fn function_names(section: wasmparser::NameSectionReader<'_>) -> Result<BTreeMap<u32, String>> {
    let mut names = BTreeMap::new();
    for subsection in section {
        // Names of locals and the like choose nothing.
        if let Name::Function(map) = subsection? {
            for naming in map {
                let naming = naming?;
                names.insert(naming.index, without_hashes(naming.name));
            }
        }
    }
    Ok(names)
}

/// Returns a name without the hashes of crates: `core[2e0298893db3e084]::fmt` becomes `core::fmt`. They change with
/// every compiler, and names without them lie next to each other.
fn without_hashes(name: &str) -> String {
    let mut bare = String::with_capacity(name.len());
    let mut rest = name;
    while let Some((before, after)) = rest.split_once('[') {
        bare.push_str(before);
        rest = after;
        let is_of_word = before.ends_with(|sign: char| sign.is_alphanumeric() || sign == '_');
        match after.split_once(']') {
            // Slices and arrays have no word before their bracket.
            Some((hash, behind))
                if is_of_word && hash.bytes().all(|byte| byte.is_ascii_hexdigit()) =>
            {
                rest = behind;
            }
            _ => bare.push('['),
        }
    }
    bare.push_str(rest);
    bare
}

#[cfg(test)]
mod tests {
    use super::without_hashes;

    #[test]
    fn names_lose_hashes_and_keep_arrays() {
        let name = "<core[2e02]::Slice<[f32]> as a[1b]::B<[u8; 4]>>::c::{closure#0}";
        assert_eq!(
            without_hashes(name),
            "<core::Slice<[f32]> as a::B<[u8; 4]>>::c::{closure#0}"
        );
        assert_eq!(without_hashes("a[zz]::b[12"), "a[zz]::b[12");
    }
}
