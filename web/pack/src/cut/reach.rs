//! Which function goes to which module. Where the first module refers to a later function, it has a *stub*, which calls
//! that function by its *slot*: a place of a table that the later module fills.

use std::collections::{BTreeMap, BTreeSet};

use anyhow::{Context, Result, ensure};

use super::program::Program;
use super::{LOADER, SETTER};

/// Functions with at most so many bytes of code that call no others are in both modules, where the later one needs
/// them: a copy costs the start nothing, and an export would.
const MAX_COPIED: usize = 160;

/// Where each function goes. All indices are the program's.
pub struct Plan {
    /// The functions of the later module.
    pub later: BTreeSet<u32>,
    /// Functions of the first module of which the later one has a copy.
    pub copied: BTreeSet<u32>,
    /// The slots of the later functions that the first module refers to.
    pub slots: BTreeMap<u32, u32>,
    /// The functions of the first module that the later one calls, with the names by which they are exported.
    pub shared: BTreeMap<u32, String>,
    /// The function that loads the later module.
    pub loader: u32,
}

impl Plan {
    /// Chooses where each function goes. `is_later` gets the name of a function and how many bytes its code has. If it
    /// is true, the function goes to the later module, and so do functions that are called only by way of such
    /// functions.
    pub fn of(program: &Program<'_>, is_later: impl Fn(&str, usize) -> bool) -> Result<Self> {
        let chosen: BTreeSet<u32> = program
            .own()
            .zip(&program.functions)
            .filter(|(_, function)| is_later(&function.name, function.body.as_bytes().len()))
            .map(|(index, _)| index)
            .collect();

        // Outside code can call each export, and the program each entry of the table. Functions that calls reach from
        // there without passing a chosen function are needed early, and no others.
        let exported = program.exported.values().copied();
        let in_table = program.entries.iter().map(|entry| entry.function);
        let roots: Vec<u32> = exported.chain(in_table).chain(program.start).collect();
        let first = reached(program, &roots, &chosen);
        let later: BTreeSet<u32> = program
            .own()
            .filter(|index| !first.contains(index))
            .collect();

        let loader = *program
            .exported
            .get(LOADER)
            .with_context(|| format!("the program does not export {LOADER}"))?;
        // The setter gives the loader the way to load, and a program may lack it. Both run before the later module is
        // there.
        for name in [LOADER, SETTER] {
            if let Some(function) = program.exported.get(name) {
                check_loader(program, name, *function, &later)?;
            }
        }

        // Stubs stand for later functions that outside code, a table or the first module's own code refer to.
        let first_functions = first.iter().filter_map(|index| program.function(*index));
        let called = first_functions.flat_map(|function| function.calls.iter().copied());
        let referred: BTreeSet<u32> = called
            .chain(roots)
            .filter(|index| later.contains(index))
            .collect();

        let (copied, shared) = needed_by(program, &later);
        Ok(Self {
            slots: referred.into_iter().zip(0..).collect(),
            shared: shared.into_iter().zip(NAMES.map(name)).collect(),
            later,
            copied,
            loader,
        })
    }
}

/// The names of exports are numbered from here on: those of functions first, then those of tables, memories and globals.
const NAMES: std::ops::RangeFrom<u32> = 0..;

/// Returns the functions that roots reach by calls, which do not go on through `chosen` functions.
fn reached(program: &Program<'_>, roots: &[u32], chosen: &BTreeSet<u32>) -> BTreeSet<u32> {
    let mut found = BTreeSet::new();
    let mut waiting = roots.to_vec();
    while let Some(index) = waiting.pop() {
        if chosen.contains(&index) || !found.insert(index) {
            continue;
        }
        if let Some(function) = program.function(index) {
            waiting.extend(&function.calls);
        }
    }
    found
}

/// Fails if the loader, or the setter, would call a stub. Each stub calls the loader. So the loader would call itself
/// without end, and the setter would call the loader before the loader can work. `export` is the name of the loader or
/// of the setter, and `root` its index.
fn check_loader(
    program: &Program<'_>,
    export: &str,
    root: u32,
    later: &BTreeSet<u32>,
) -> Result<()> {
    // All that it calls counts, by way of later functions as well: no function stops the search.
    let none_chosen = BTreeSet::new();
    let needed = reached(program, &[root], &none_chosen);
    let needed_later = needed.iter().find(|index| later.contains(index));
    let name = needed_later
        .and_then(|index| program.function(*index))
        .map(|function| &function.name);
    ensure!(
        name.is_none(),
        "{export} calls {}, which is in the module that it loads",
        name.map_or("", String::as_str)
    );
    Ok(())
}

/// Returns the functions of the first module that later ones call: those that are copied, and those that are exported.
fn needed_by(program: &Program<'_>, later: &BTreeSet<u32>) -> (BTreeSet<u32>, BTreeSet<u32>) {
    let functions = later.iter().filter_map(|index| program.function(*index));
    let called = functions.flat_map(|function| function.calls.iter().copied());
    let needed: BTreeSet<u32> = called.filter(|index| !later.contains(index)).collect();

    needed.into_iter().partition(|index| {
        program.function(*index).is_some_and(|function| {
            function.calls.is_empty() && function.body.as_bytes().len() <= MAX_COPIED
        })
    })
}

/// Returns a short name for a number, a different one for each.
pub fn name(mut number: u32) -> String {
    const DIGITS: &[u8; 62] = b"0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ";
    let mut name = String::new();
    loop {
        name.push(char::from(DIGITS[number as usize % DIGITS.len()]));
        number /= DIGITS.len() as u32;
        if number == 0 {
            return name;
        }
    }
}
