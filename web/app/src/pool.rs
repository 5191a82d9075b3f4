//! The page's web workers, which run tasks so that the page stays responsive. A worker that breaks, or that does not stop
//! soon after its task was cancelled, is replaced.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;
use std::sync::Arc;

use js_sys::{Array, Object, Reflect, Uint8Array};
use tilescope_session::jobs::Monitor;
use tilescope_session::task::{Answer, PendingTask, TaskEnd, TaskPool, session_bytes};
use wasm_bindgen::prelude::Closure;
use wasm_bindgen::{JsCast, JsValue};
use web_sys::{Event, MessageEvent, Worker, WorkerOptions, WorkerType};

/// A cancelled task may end by itself within so many milliseconds, so that its worker keeps the sessions it has.
const GRACE_MS: i32 = 200;

/// No more workers are started once more than so many in a row have broken before finishing a task.
const MAX_BROKEN: u32 = 3;

/// The data from which workers start.
pub struct Program {
    /// The address of their script.
    pub worker: String,
    /// The address of the bindings.
    pub bindings: String,
    /// The compiled program, which workers need not compile again.
    pub module: JsValue,
    /// The compiled later part of the program, once the page has it.
    pub later: Option<JsValue>,
    /// The largest number of workers.
    pub workers: usize,
}

/// The workers, and the tasks that wait for an idle one.
#[derive(Clone)]
pub struct Pool(Rc<RefCell<Inner>>);

struct Inner {
    program: Program,
    slots: Vec<Slot>,
    waiting: VecDeque<PendingTask>,
    next_id: u32,
    /// Whether tasks are sent to workers; until then they wait.
    is_open: bool,
    /// Workers that broke before finishing a task, since a task was last finished.
    broken: u32,
}

struct Slot {
    worker: Worker,
    /// The sessions that it keeps, each by its number, which is called its generation. Tasks name the sessions that they
    /// need by it, since whole sessions are too large to send with each task.
    kept: Vec<u64>,
    busy: Option<Busy>,
    /// Whether it has finished a task.
    has_worked: bool,
    /// The worker calls these for as long as it lives.
    _on_message: Closure<dyn FnMut(MessageEvent)>,
    _on_error: Closure<dyn FnMut(Event)>,
}

/// Why a worker is of no more use.
enum Break {
    /// A fault of the program or the browser.
    Fault(String),
    /// The later part of the program could not be loaded: a sentence.
    Lacking(String),
}

struct Busy {
    id: u32,
    task: PendingTask,
    /// Whether it was cancelled and [`GRACE_MS`] have begun.
    in_grace: bool,
    /// Whether the sessions that the worker lacked were sent.
    sessions_sent: bool,
}

impl Pool {
    /// A pool of workers; the first starts now.
    pub fn new(program: Program) -> Self {
        let pool = Self(Rc::new(RefCell::new(Inner {
            program,
            slots: Vec::new(),
            waiting: VecDeque::new(),
            next_id: 0,
            is_open: false,
            broken: 0,
        })));
        pool.add();
        pool
    }

    /// Sends tasks to workers from now on. Tasks cancelled before that never start: a link may replace the session that
    /// every window begins with.
    pub fn open(&self) {
        self.0.borrow_mut().is_open = true;
        self.tick();
        self.send_waiting();
    }

    /// Sends the later part of the program to all workers, and to those that start from now on.
    pub fn take_later(&self, later: JsValue) {
        let mut inner = self.0.borrow_mut();
        let message = object(&[("later", later.clone())]);
        for slot in &inner.slots {
            // A worker that does not get it loads it by itself.
            let _ = slot.worker.post_message(&message);
        }
        inner.program.later = Some(later);
    }

    /// Ends all workers, and cancels their tasks and those that wait.
    pub fn close(&self) {
        let (slots, waiting) = {
            let mut inner = self.0.borrow_mut();
            // From here on no worker is started.
            inner.program.workers = 0;
            (
                std::mem::take(&mut inner.slots),
                std::mem::take(&mut inner.waiting),
            )
        };
        // Receivers of answers use the pool, so that it is not borrowed while they are called.
        for slot in slots {
            slot.worker.terminate();
            if let Some(busy) = slot.busy {
                (busy.task.answer)(TaskEnd::Cancelled);
            }
        }
        for task in waiting {
            (task.answer)(TaskEnd::Cancelled);
        }
    }

    /// Ends cancelled tasks: those that wait at once, and those at work after `GRACE_MS`. Called with every frame.
    pub fn tick(&self) {
        self.drop_cancelled();
        let mut graced = Vec::new();
        {
            let mut inner = self.0.borrow_mut();
            for busy in inner.slots.iter_mut().filter_map(|slot| slot.busy.as_mut()) {
                if busy.task.monitor.is_cancelled() && !busy.in_grace {
                    busy.in_grace = true;
                    graced.push(busy.id);
                }
            }
        }
        // The timer gives each task time to end by itself. Its worker then keeps the sessions that it has. If no timer
        // can be set, the task goes on to its end.
        for id in graced {
            let pool = self.clone();
            let end = Closure::once_into_js(move || pool.abandon(id));
            if let Some(window) = web_sys::window() {
                let end = end.unchecked_ref();
                let _ = window.set_timeout_with_callback_and_timeout_and_arguments_0(end, GRACE_MS);
            }
        }
    }

    /// Drops waiting tasks that were cancelled.
    fn drop_cancelled(&self) {
        let dropped: VecDeque<PendingTask> = {
            let mut inner = self.0.borrow_mut();
            let waiting = std::mem::take(&mut inner.waiting);
            let (gone, kept) = waiting
                .into_iter()
                .partition(|task| task.monitor.is_cancelled());
            inner.waiting = kept;
            gone
        };
        for task in dropped {
            (task.answer)(TaskEnd::Cancelled);
        }
    }

    /// Replaces the worker that runs a task, if it still does.
    fn abandon(&self, id: u32) {
        let slot = {
            let mut inner = self.0.borrow_mut();
            let at = |slot: &Slot| slot.busy.as_ref().is_some_and(|busy| busy.id == id);
            let place = inner.slots.iter().position(at);
            place.map(|place| inner.slots.remove(place))
        };
        let Some(slot) = slot else {
            return;
        };
        slot.worker.terminate();
        if let Some(busy) = slot.busy {
            (busy.task.answer)(TaskEnd::Cancelled);
        }
        self.add();
        self.send_waiting();
    }

    /// Adds a worker if there are fewer than there may be. If the browser refuses it and there is no other, what waits
    /// fails.
    fn add(&self) {
        let mut inner = self.0.borrow_mut();
        if inner.slots.len() >= inner.program.workers {
            return;
        }
        match self.started(&inner.program) {
            Ok(slot) => inner.slots.push(slot),
            Err(error) => {
                // Where the browser refuses another worker, no more are tried.
                inner.program.workers = inner.slots.len();
                // The workers that are there take what waits, if there are any.
                if !inner.slots.is_empty() {
                    return;
                }
                let waiting = std::mem::take(&mut inner.waiting);
                drop(inner);
                for task in waiting {
                    (task.answer)(TaskEnd::Failed(no_worker(&error)));
                }
            }
        }
    }

    /// Starts a worker and sends it the program; returns it as an idle one.
    fn started(&self, program: &Program) -> Result<Slot, JsValue> {
        let options = WorkerOptions::new();
        options.set_type(WorkerType::Module);
        let worker = Worker::new_with_options(&program.worker, &options)?;

        let (pool, from) = (self.clone(), worker.clone());
        let on_message = Closure::<dyn FnMut(MessageEvent)>::new(move |event: MessageEvent| {
            pool.receive(&from, &event.data());
        });
        worker.set_onmessage(Some(on_message.as_ref().unchecked_ref()));

        let (pool, from) = (self.clone(), worker.clone());
        // An error in the script is an event with a message. A script that cannot be loaded, and data that cannot be read, are
        // events without a message, which their names tell apart. All have the same type here, so that the message is
        // looked up by its name.
        let on_error = Closure::<dyn FnMut(Event)>::new(move |event: Event| {
            let message = (Reflect::get(&event, &"message".into()).ok())
                .and_then(|message| message.as_string());
            let why = message.unwrap_or_else(|| {
                let why = match event.type_().as_str() {
                    "messageerror" => "its answer cannot be read",
                    _ => "its script cannot be loaded",
                };
                why.to_owned()
            });
            pool.remove_broken(&from, &Break::Fault(why));
        });
        worker.set_onerror(Some(on_error.as_ref().unchecked_ref()));
        worker.set_onmessageerror(Some(on_error.as_ref().unchecked_ref()));

        let first = object(&[
            ("bindings", program.bindings.as_str().into()),
            ("module", program.module.clone()),
            ("later", program.later.clone().unwrap_or(JsValue::UNDEFINED)),
        ]);
        worker.post_message(&first)?;
        Ok(Slot {
            worker,
            kept: Vec::new(),
            busy: None,
            has_worked: false,
            _on_message: on_message,
            _on_error: on_error,
        })
    }

    /// Removes a broken worker: its task fails; the next task starts a new worker.
    fn remove_broken(&self, worker: &Worker, cause: &Break) {
        let slot = {
            let mut inner = self.0.borrow_mut();
            let place = inner.slots.iter().position(|slot| slot.worker == *worker);
            place.map(|place| inner.slots.remove(place))
        };
        let Some(slot) = slot else {
            return;
        };

        let (text, is_hopeless) = match cause {
            Break::Fault(why) => (
                format!("a background job failed ({why}); this is a fault of the program"),
                self.0.borrow_mut().note_broken(&slot),
            ),
            // Once there is a network, workers work again.
            Break::Lacking(why) => (why.clone(), false),
        };

        slot.worker.terminate();
        if let Some(busy) = slot.busy {
            (busy.task.answer)(TaskEnd::Failed(text));
        }
        // No worker is started any more, so that the tasks that wait fail, too. Only a fault is hopeless, but the
        // pattern must name both causes.
        if is_hopeless {
            let (Break::Fault(why) | Break::Lacking(why)) = cause;
            let waiting = std::mem::take(&mut self.0.borrow_mut().waiting);
            for task in waiting {
                (task.answer)(TaskEnd::Failed(no_worker(&why.as_str().into())));
            }
        }
        self.send_waiting();
    }

    /// Takes a message of a worker: its fault, its progress, the sessions that it lacks, or the outcome of its task.
    fn receive(&self, worker: &Worker, message: &JsValue) {
        let get = |name: &str| {
            let value = Reflect::get(message, &name.into()).unwrap_or(JsValue::UNDEFINED);
            (!value.is_undefined()).then_some(value)
        };

        // `broken`: the worker could not start the program. `fault`: the program panicked in it. `lacking`: its later
        // part could not be loaded.
        if let Some(why) = get("broken").or_else(|| get("fault")) {
            self.remove_broken(worker, &Break::Fault(why.as_string().unwrap_or_default()));
        } else if let Some(why) = get("lacking") {
            self.remove_broken(worker, &Break::Lacking(why.as_string().unwrap_or_default()));
        } else if let Some(fraction) = get("fraction") {
            let activity = get("activity").and_then(|activity| activity.as_string());
            let monitor = self.monitor_of(worker);
            if let (Some(monitor), Some(fraction)) = (monitor, fraction.as_f64()) {
                monitor.set_activity(&activity.unwrap_or_default());
                monitor.set_fraction(fraction as f32);
            }
        } else if let Some(unknown) = get("unknown") {
            let sent = self.send_sessions(worker, &generations(&unknown));
            if let Err(why) = sent {
                self.remove_broken(worker, &Break::Fault(why));
            }
        } else if let Some(outcome) = get("outcome") {
            let bytes = Uint8Array::new(&outcome).to_vec();
            self.finish(worker, bytes, get("kept").map(|kept| generations(&kept)));
        }
    }

    /// Returns the monitor of a worker's task; `None` if the worker was replaced or has no task.
    fn monitor_of(&self, worker: &Worker) -> Option<Arc<Monitor>> {
        let inner = self.0.borrow();
        let slot = inner.slots.iter().find(|slot| slot.worker == *worker)?;
        Some(Arc::clone(&slot.busy.as_ref()?.task.monitor))
    }

    /// Takes the outcome of a worker's task. `kept` has the sessions that the worker keeps; it keeps none if `kept` is
    /// `None`.
    fn finish(&self, worker: &Worker, bytes: Vec<u8>, kept: Option<Vec<u64>>) {
        let busy = {
            let mut inner = self.0.borrow_mut();
            // A finished task shows that workers can work: earlier breaks no longer count.
            inner.broken = 0;
            let slot = inner.slots.iter_mut().find(|slot| slot.worker == *worker);
            slot.and_then(|slot| {
                slot.has_worked = true;
                slot.kept = kept.unwrap_or_default();
                slot.busy.take()
            })
        };
        // The worker begins the next task before the answer to this one is taken, which may last a while.
        self.send_waiting();
        if let Some(busy) = busy {
            (busy.task.answer)(TaskEnd::Done(bytes));
        }
    }

    /// Sends the sessions that a worker lacks, then its task again.
    fn send_sessions(&self, worker: &Worker, unknown: &[u64]) -> Result<(), String> {
        let mut inner = self.0.borrow_mut();
        let slot = inner.slots.iter_mut().find(|slot| slot.worker == *worker);
        // A worker that was replaced meanwhile has no task any more.
        let Some(busy) = slot.and_then(|slot| slot.busy.as_mut()) else {
            return Ok(());
        };

        // A worker that still lacks sessions after they were sent would ask for them for ever.
        if std::mem::replace(&mut busy.sessions_sent, true) {
            return Err(format!(
                "sessions {unknown:?} were sent and are still missing"
            ));
        }

        let sessions = busy.task.sessions.iter();
        let lacking: Vec<_> = sessions
            .filter(|session| unknown.contains(&session.generation))
            .collect();
        if lacking.is_empty() {
            return Err(format!("sessions {unknown:?} are not there"));
        }

        for session in lacking {
            let bytes = Uint8Array::from(&session_bytes(session)?[..]).buffer();
            let message = object(&[("session", bytes.clone().into())]);
            post(worker, &message, &bytes)?;
        }

        send(worker, busy.id, &busy.task)
    }

    /// Sends waiting tasks to idle workers. Cancelled tasks are dropped here too, since a hidden page draws no frames.
    fn send_waiting(&self) {
        self.drop_cancelled();
        loop {
            let mut inner = self.0.borrow_mut();
            if inner.waiting.is_empty() || !inner.is_open {
                return;
            }
            let idle = inner.idle();
            let failed = idle.and_then(|place| inner.send_next(place));
            let may_grow = inner.slots.len() < inner.program.workers;
            // Answers and new workers borrow the pool themselves.
            drop(inner);
            match (idle, failed) {
                // The next task could not be sent: the one behind it may be.
                (_, Some((answer, why))) => answer(TaskEnd::Failed(why)),
                // It was sent.
                (Some(_), None) => {}
                // All workers are busy. Where there may be no more of them, the first to finish sends the next task.
                (None, None) if may_grow => self.add(),
                (None, None) => return,
            }
        }
    }
}

impl Inner {
    /// Counts a worker that broke before finishing a task; returns whether so many broke that no more are started.
    fn note_broken(&mut self, slot: &Slot) -> bool {
        if !slot.has_worked {
            self.broken += 1;
        }
        let is_hopeless = self.broken > MAX_BROKEN;
        if is_hopeless {
            self.program.workers = 0;
        }
        is_hopeless
    }

    /// The place in `slots` of the idle worker that keeps the most sessions of the next task. `None` if no task waits,
    /// or no worker is idle.
    fn idle(&self) -> Option<usize> {
        let next = self.waiting.front()?;
        let idle = self
            .slots
            .iter()
            .enumerate()
            .filter(|(_, slot)| slot.busy.is_none());
        let kept = |slot: &Slot| {
            let sessions = next.sessions.iter();
            sessions
                .filter(|session| slot.kept.contains(&session.generation))
                .count()
        };
        // Of workers that keep equally many sessions the first one is taken.
        let best = idle.max_by_key(|(place, slot)| (kept(slot), std::cmp::Reverse(*place)))?;
        Some(best.0)
    }

    /// Sends the next task to the worker at a place in `slots`. If that fails, returns the receiver of the task's
    /// result and the reason. Returns `None` if the task was sent, or no task waits.
    fn send_next(&mut self, place: usize) -> Option<(Answer, String)> {
        let task = self.waiting.pop_front()?;
        let id = self.next_id;
        self.next_id = self.next_id.wrapping_add(1);
        let slot = &mut self.slots[place];
        match send(&slot.worker, id, &task) {
            Ok(()) => {
                slot.busy = Some(Busy {
                    id,
                    task,
                    in_grace: false,
                    sessions_sent: false,
                });
                None
            }
            Err(why) => Some((task.answer, why)),
        }
    }
}

impl TaskPool for Pool {
    fn run(&self, task: PendingTask) {
        let has_no_worker = {
            let inner = self.0.borrow();
            inner.slots.is_empty() && inner.program.workers == 0
        };
        // No worker would ever take the task. The browser's error, which said why there is none, is not kept.
        if has_no_worker {
            let no_error = JsValue::NULL;
            (task.answer)(TaskEnd::Failed(no_worker(&no_error)));
            return;
        }

        self.0.borrow_mut().waiting.push_back(task);
        self.send_waiting();
    }
}

fn no_worker(error: &JsValue) -> String {
    let why = error.as_string().unwrap_or_default();
    format!("the browser gives no worker to compute in the background {why}")
        .trim_end()
        .to_owned()
}

fn send(worker: &Worker, id: u32, task: &PendingTask) -> Result<(), String> {
    let input = Uint8Array::from(&task.input[..]).buffer();
    let message = object(&[
        ("id", id.into()),
        ("name", task.name.into()),
        ("input", input.clone().into()),
    ]);
    post(worker, &message, &input)
}

fn post(worker: &Worker, message: &JsValue, bytes: &JsValue) -> Result<(), String> {
    let moved = Array::of1(bytes);
    let posted = worker.post_message_with_transfer(message, &moved);
    posted.map_err(|error| format!("{error:?}"))
}

fn object(entries: &[(&str, JsValue)]) -> JsValue {
    let object = Object::new();
    for (name, value) in entries {
        // A plain object takes every entry.
        let _ = Reflect::set(&object, &(*name).into(), value);
    }
    object.into()
}

fn generations(numbers: &JsValue) -> Vec<u64> {
    let numbers = Array::from(numbers);
    numbers
        .iter()
        .filter_map(|number| number.as_f64())
        .map(|number| number as u64)
        .collect()
}
