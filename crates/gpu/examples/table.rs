//! Prints the tables of `PERFORMANCE.md` from a file that `crates/gpu/time-it` wrote: the rates, and the passes of the largest run.
//! Usage: `cargo run -p tilescope-gpu --example table -- FILE`.

use std::collections::BTreeMap;
use std::fmt::Write;

use serde_json::Value;

fn main() {
    let path = std::env::args().nth(1).expect("the path of a file");
    let text = std::fs::read_to_string(&path).expect("a file that can be read");
    let times: Value = serde_json::from_str(&text).expect("JSON");
    let runs = times["runs"].as_array().expect("runs");
    print!("{}", rates(runs));
    if let Some(largest) = runs.iter().max_by_key(|run| run["timed_samples"].as_u64()) {
        print!("{}", passes(largest));
    }
    for name in times["left_out"].as_array().into_iter().flatten() {
        println!("Left out: {name}");
    }
}

/// The row for a leaf size and a number of samples.
#[derive(Default)]
struct Row {
    threads: Option<f64>,
    trusted: Option<f64>,
    checked: Option<f64>,
    is_good: bool,
}

fn rates(runs: &[Value]) -> String {
    let mut rows: BTreeMap<[u64; 2], Row> = BTreeMap::new();
    for run in runs {
        let measured = &run["rows"][0];
        let number = |name: &str| measured[name].as_f64();
        let count = measured["counts"][0].as_u64().unwrap_or_default();
        let leaf = number("leaf").unwrap_or_default() as u64;
        // Sets of about the same size: with two digits.
        let digits = 10_u64.pow(count.max(1).ilog10().saturating_sub(1));
        let row = rows.entry([leaf, count / digits * digits]).or_insert(Row {
            is_good: true,
            ..Row::default()
        });
        let rate = number("gpu_samples_per_second");
        if run["checked_shaders"] == true {
            row.checked = rate;
        } else {
            row.trusted = rate;
            row.threads = number("parallel_samples_per_second");
        }
        row.is_good &= measured["equal"] == true && measured["valid"] == true;
    }
    let mut out = String::from(
        "| leaf | samples | all threads, M/s | GPU, M/s | with checked shaders | equal and valid |\n|---|---|---|---|---|---|\n",
    );
    let rate = |value: Option<f64>| value.map_or("-".to_owned(), |v| format!("{:.1}", v / 1e6));
    for ([leaf, count], row) in rows {
        let good = if row.is_good { "yes" } else { "NO" };
        let _ = writeln!(
            out,
            "| {leaf} r | {count} | {} | {} | {} | {good} |",
            rate(row.threads),
            rate(row.trusted),
            rate(row.checked)
        );
    }
    out
}

fn passes(run: &Value) -> String {
    let mut out = format!(
        "\n{} samples on {}:\n\n| stage | pass | times | ms |\n|---|---|---|---|\n",
        run["timed_samples"], run["adapter"]
    );
    for pass in run["passes"].as_array().into_iter().flatten() {
        let word = |name: &str| pass[name].as_str().unwrap_or("-").to_owned();
        let seconds = pass["seconds"].as_f64();
        let milliseconds = seconds.map_or("-".to_owned(), |s| format!("{:.3}", s * 1e3));
        let _ = writeln!(
            out,
            "| {} | {} | {} | {milliseconds} |",
            word("stage"),
            word("pass"),
            pass["times"]
        );
    }
    out
}
