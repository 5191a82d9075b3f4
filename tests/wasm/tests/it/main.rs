//! Checks that the engines as WebAssembly give the same points as natively, bit for bit: built for wasm32
//! with its vector instructions, in slow tests also without them, and run in an interpreter.

mod module;
// Only a part of the shared module is used here.
#[allow(dead_code)]
#[path = "../../../tests/it/support/mod.rs"]
mod support;

use std::sync::LazyLock;

use module::build;
use support::pinned::{PINNED, cases};
use support::{difference, digest, run, shown};
use tilescope_core::{
    Boundary, Insertion, Order, Parameters, PatternSpec, Point, Unobserved, Variant,
    reference_sample,
};
use tilescope_formats::bytes_digest;
use tilescope_tests_wasm::Task;
use wasmi::{Engine, Instance, Memory, Module, Store, WasmParams, WasmResults};

/// The builds: the name of their instruction set, and the module. Built once for all tests.
static BUILDS: LazyLock<Vec<(&str, Vec<u8>)>> = LazyLock::new(|| {
    let mut builds = vec![("simd128", build("-Ctarget-feature=+simd128"))];
    // The page has vectors; without them only other programs use the engines.
    if std::env::var_os("TILESCOPE_SLOW").is_some_and(|value| value == "1") {
        builds.push(("scalar", build("")));
    }
    builds
});

/// A running module.
struct Wasm {
    store: Store<()>,
    instance: Instance,
    memory: Memory,
}

impl Wasm {
    /// Starts a module, which must not import anything.
    fn start(module: &[u8]) -> Self {
        let engine = Engine::default();
        let module = Module::new(&engine, module).expect("a valid module");
        let mut store = Store::new(&engine, ());
        let instance = Instance::new(&mut store, &module, &[]).expect("no imports");
        let memory = instance.get_memory(&store, "memory").expect("a memory");
        Self {
            store,
            instance,
            memory,
        }
    }

    fn call<P: WasmParams, R: WasmResults>(&mut self, name: &str, arguments: P) -> R {
        let function = self.instance.get_typed_func::<P, R>(&self.store, name);
        let function = function.expect(name);
        function.call(&mut self.store, arguments).expect(name)
    }

    fn read(&mut self, length: usize) -> Vec<u8> {
        let at: u32 = self.call("answer", ());
        self.memory.data(&self.store)[at as usize..][..length].to_vec()
    }

    fn instructions(&mut self) -> String {
        let length: u32 = self.call("instructions", ());
        String::from_utf8(self.read(length as usize)).expect("a name")
    }

    /// Runs a task given as bytes. Returns x and y of each point, or the error message.
    fn carry_out(&mut self, task: &[u8]) -> Result<Vec<u8>, String> {
        let at: u32 = self.call("resize", task.len() as u32);
        self.memory.data_mut(&mut self.store)[at as usize..][..task.len()].copy_from_slice(task);
        let length: i64 = self.call("run", ());
        let answer = self.read(length.unsigned_abs() as usize);
        if length < 0 {
            return Err(String::from_utf8(answer).expect("a message"));
        }
        Ok(answer)
    }

    fn bytes(&mut self, task: &Task) -> Result<Vec<u8>, String> {
        self.carry_out(&serde_json::to_vec(task).expect("plain data"))
    }

    fn points(&mut self, task: &Task) -> Vec<Point> {
        let bytes = self.bytes(task).expect("points");
        let (words, rest) = bytes.as_chunks::<4>();
        assert!(rest.is_empty() && words.len().is_multiple_of(2));
        let words: Vec<i32> = words.iter().map(|w| i32::from_le_bytes(*w)).collect();
        words.chunks(2).map(|w| Point::new(w[0], w[1])).collect()
    }
}

/// Runs a test for each build.
fn for_each_build(test: impl Fn(&str, &mut Wasm)) {
    for (name, module) in BUILDS.iter() {
        let mut wasm = Wasm::start(module);
        assert_eq!(wasm.instructions(), *name);
        test(name, &mut wasm);
    }
}

/// Small runs that have all options in many combinations, and windows of them.
fn small_runs() -> Vec<(Parameters, [f64; 2], [f64; 2])> {
    let orders = [
        Order::Index,
        Order::Random,
        Order::OwnBlockFirst,
        Order::PhaseGroup,
    ];
    let of = |k: u32| {
        let has = |bit: u32| k >> bit & 1 == 1;
        let boundary = |bounded| [Boundary::Periodic, Boundary::Bounded][usize::from(bounded)];
        let step = f64::from(k);
        let parameters = Parameters {
            width: 23.0 + 1.9 * step,
            height: 61.0 - 2.3 * step,
            radius: 1.0,
            boundary: boundary(has(2)),
            seed: 0x0123_4567_89ab_cdef_u64.wrapping_mul(u64::from(k) + 1),
            leaf: 6.0 + step,
            pattern: PatternSpec {
                side: 46.0 + step,
                boundary: boundary(has(0) && has(1)),
                seed: u64::from(k),
            },
            dihedral: has(1) != has(2),
            order: orders[k as usize % 4],
            insertion: [Insertion::Circumcentre, Insertion::Uniform][usize::from(has(3))],
            ..Parameters::default()
        };
        // Across the seams of a periodic domain.
        let low = [parameters.width * 0.7, parameters.height * 0.6];
        let high = [low[0] + 9.5, low[1] + 0.8 * parameters.height];
        (parameters, low, high)
    };
    // The bits of a number choose the options: in this order the first four have each option with both values.
    (0..tilescope_tests::cases(16))
        .map(|k| of(5 * k % 16))
        .collect()
}

#[test]
fn the_pinned_digests_hold_in_wasm() {
    for_each_build(|name, wasm| {
        for ((case, parameters), (pinned, wanted)) in cases().iter().zip(PINNED) {
            assert_eq!(*case, pinned);
            let mut tasks = vec![Task::Sequential(*parameters)];
            if parameters.variant == Variant::Staged {
                tasks.push(Task::Sweep(*parameters, *case == "dihedral"));
            }
            for task in tasks {
                let bytes = wasm.bytes(&task).expect("points");
                assert_eq!(bytes_digest(&bytes), wanted, "{name}: {task:?}");
            }
        }
        let reference = wasm.points(&Task::Reference(Parameters::default()));
        assert_eq!(("reference", digest(&reference).as_str()), PINNED[8]);
    });
}

#[test]
fn all_engines_give_the_same_points_in_wasm_as_here() {
    for_each_build(|name, wasm| {
        for (parameters, low, high) in small_runs() {
            let here = run(&parameters);
            let domain = here.domain;
            let here = here.points();
            let mut check = |task: Task, wanted: &[Point]| {
                let wrong = difference(&wasm.points(&task), wanted);
                assert_eq!(wrong, None, "{name}: {task:?}");
            };
            check(Task::Sequential(parameters), &here);
            check(Task::Sweep(parameters, false), &here);
            check(Task::Sweep(parameters, true), &here);
            let window = domain.window(low, high).expect("a window");
            let wanted = shown(&domain, &window, &here);
            assert!(!wanted.is_empty());
            check(Task::Window(parameters, low, high), &wanted);
            let wanted = reference_sample(domain, parameters.seed, &mut Unobserved);
            check(Task::Reference(parameters), &wanted.expect("a set"));
        }
    });
}

/// The control: what is equal above differs from the points of another seed.
#[test]
fn another_seed_gives_other_points_and_nonsense_is_refused() {
    for_each_build(|name, wasm| {
        let (parameters, low, high) = small_runs()[0];
        let seed = parameters.seed + 1;
        let other = Parameters { seed, ..parameters };
        let tasks = |p| {
            [
                Task::Sequential(p),
                Task::Sweep(p, false),
                Task::Window(p, low, high),
                Task::Reference(p),
            ]
        };
        for (task, other) in tasks(parameters).iter().zip(tasks(other)) {
            let points = task.points().expect("points");
            let differs = difference(&wasm.points(&other), &points).is_some();
            assert!(differs, "{name}: {task:?}");
        }
        let variant = Variant::AsPrinted;
        let refused = Task::Sweep(
            Parameters {
                variant,
                ..parameters
            },
            false,
        );
        let here = refused.points().unwrap_err().to_string();
        assert_eq!(wasm.bytes(&refused), Err(here), "{name}");
        assert!(wasm.carry_out(b"no task").is_err(), "{name}");
    });
}
