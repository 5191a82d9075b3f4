//! WGSL put together: small files that name what they import, the constants that Rust emits, and
//! the bindings of a pass. Nothing here needs a device.

use std::fmt::Write as _;

use crate::constants::constants;
use crate::layout::{Binding, declarations, structures};

/// Every shader file by its name: a library of functions, or a pass with the entry point `main`.
pub const FILES: &[(&str, &str)] = &[
    ("attribute", include_str!("../shaders/attribute.wgsl")),
    ("blocks", include_str!("../shaders/blocks.wgsl")),
    ("candidates", include_str!("../shaders/candidates.wgsl")),
    ("choose", include_str!("../shaders/choose.wgsl")),
    ("circumcentre", include_str!("../shaders/circumcentre.wgsl")),
    ("clip", include_str!("../shaders/clip.wgsl")),
    ("count", include_str!("../shaders/count.wgsl")),
    ("cover_cell", include_str!("../shaders/cover_cell.wgsl")),
    ("coverage", include_str!("../shaders/coverage.wgsl")),
    ("detectors", include_str!("../shaders/detectors.wgsl")),
    ("eliminate", include_str!("../shaders/eliminate.wgsl")),
    ("frame", include_str!("../shaders/frame.wgsl")),
    ("gap_cells", include_str!("../shaders/gap_cells.wgsl")),
    ("gather", include_str!("../shaders/gather.wgsl")),
    ("grid", include_str!("../shaders/grid.wgsl")),
    ("grid_shared", include_str!("../shaders/grid_shared.wgsl")),
    ("lattice", include_str!("../shaders/lattice.wgsl")),
    ("link", include_str!("../shaders/link.wgsl")),
    ("open", include_str!("../shaders/open.wgsl")),
    ("place", include_str!("../shaders/place.wgsl")),
    ("prepare", include_str!("../shaders/prepare.wgsl")),
    ("proposal", include_str!("../shaders/proposal.wgsl")),
    ("propose", include_str!("../shaders/propose.wgsl")),
    ("random", include_str!("../shaders/random.wgsl")),
    ("reopen", include_str!("../shaders/reopen.wgsl")),
    ("scan", include_str!("../shaders/scan.wgsl")),
    ("scan_add", include_str!("../shaders/scan_add.wgsl")),
    ("scan_sums", include_str!("../shaders/scan_sums.wgsl")),
    ("settle", include_str!("../shaders/settle.wgsl")),
    ("sites", include_str!("../shaders/sites.wgsl")),
    ("sort_blocks", include_str!("../shaders/sort_blocks.wgsl")),
    ("sources", include_str!("../shaders/sources.wgsl")),
    ("split", include_str!("../shaders/split.wgsl")),
    ("spread", include_str!("../shaders/spread.wgsl")),
    ("survive", include_str!("../shaders/survive.wgsl")),
    ("tally", include_str!("../shaders/tally.wgsl")),
    ("throw", include_str!("../shaders/throw.wgsl")),
    ("tile", include_str!("../shaders/tile.wgsl")),
    ("turn", include_str!("../shaders/turn.wgsl")),
    ("unlink", include_str!("../shaders/unlink.wgsl")),
    ("unsure", include_str!("../shaders/unsure.wgsl")),
    ("wide", include_str!("../shaders/wide.wgsl")),
];

/// Returns the whole WGSL source of a pass: constants, structures, bindings, imported files, the
/// file itself.
///
/// # Panics
///
/// When a file imports one that does not exist: a fault of the program, found by a test.
#[must_use]
pub fn compose(file: &str, bindings: &[Binding]) -> String {
    let mut source = constants();
    source.push_str(&structures());
    source.push_str(&declarations(bindings));
    let mut done = Vec::new();
    append(file, &mut done, &mut source);
    if source.contains("fn run(index: u32)") {
        source.push_str(ENTRY);
    }
    source
}

/// What most passes begin with: one invocation an element, in as many rows of workgroups as it takes.
const ENTRY: &str = "
@compute @workgroup_size(WORKGROUP)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    run((group.y * groups.x + group.x) * WORKGROUP + local);
}
";

fn append(file: &str, done: &mut Vec<String>, source: &mut String) {
    if done.iter().any(|name| name == file) {
        return;
    }
    done.push(file.to_owned());
    let text = FILES.iter().find(|(name, _)| *name == file).map_or_else(
        || panic!("there is no shader file {file}"),
        |(_, text)| text,
    );
    for import in imports(text) {
        append(import, done, source);
    }
    let _ = writeln!(source, "// {file}.wgsl\n{text}");
}

/// Returns the files that a file imports: those named in its lines `// import: NAME`.
pub fn imports(text: &str) -> impl Iterator<Item = &str> {
    text.lines()
        .filter_map(|line| line.strip_prefix("// import: "))
        .map(str::trim)
}
