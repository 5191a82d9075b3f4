//! Workers that carry out errands, so that the page never waits. One that does not stop when nobody waits for it any more,
//! or that breaks, is replaced.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;
use std::sync::Arc;

use js_sys::{Array, Object, Reflect, Uint8Array};
use tilescope_session::errand::{Answer, Carrier, End, Parcel, session_bytes};
use tilescope_session::jobs::Monitor;
use wasm_bindgen::prelude::Closure;
use wasm_bindgen::{JsCast, JsValue};
use web_sys::{Event, MessageEvent, Worker, WorkerOptions, WorkerType};

/// An errand that nobody waits for may come to its end by itself within so many milliseconds: what its worker knows is
/// then not lost.
const GRACE_MS: i32 = 200;

/// So many workers that break one after the other before they have done anything are replaced.
const MAX_BROKEN: u32 = 3;

/// What workers are made of.
pub struct Program {
    /// The address of their script.
    pub worker: String,
    /// The address of the bindings.
    pub bindings: String,
    /// The compiled program.
    pub module: JsValue,
    /// The most workers.
    pub workers: usize,
}

/// The workers, and the errands that wait for one.
#[derive(Clone)]
pub struct Pool(Rc<RefCell<Inner>>);

struct Inner {
    program: Program,
    slots: Vec<Slot>,
    waiting: VecDeque<Parcel>,
    next_id: u32,
    /// Whether errands are given out; before that they wait.
    is_open: bool,
    /// Workers that broke before they did anything, since one did its work.
    broken: u32,
}

struct Slot {
    worker: Worker,
    /// The generations of the sessions that it knows.
    known: Vec<u64>,
    busy: Option<Busy>,
    /// Whether it has ever come to an end of an errand.
    has_worked: bool,
    /// Kept for as long as the worker may call them.
    _on_message: Closure<dyn FnMut(MessageEvent)>,
    _on_error: Closure<dyn FnMut(Event)>,
}

struct Busy {
    id: u32,
    parcel: Parcel,
    /// Whether it is to end by itself soon.
    given_grace: bool,
    /// Whether the sessions that it lacks were sent.
    was_taught: bool,
}

impl Pool {
    /// Returns workers of a program; the first one starts now.
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

    /// Gives errands out from now on. What was cancelled before that is not begun: the session that every window begins with
    /// where a link asks for another.
    pub fn open(&self) {
        self.0.borrow_mut().is_open = true;
        self.tick();
        self.go_on();
    }

    /// Ends all workers; what they were at is given up.
    pub fn close(&self) {
        let (slots, waiting) = {
            let mut inner = self.0.borrow_mut();
            inner.program.workers = 0;
            (
                std::mem::take(&mut inner.slots),
                std::mem::take(&mut inner.waiting),
            )
        };
        for slot in slots {
            slot.worker.terminate();
            if let Some(busy) = slot.busy {
                (busy.parcel.answer)(End::GivenUp);
            }
        }
        for parcel in waiting {
            (parcel.answer)(End::GivenUp);
        }
    }

    /// Sees to errands that nobody waits for. Called with every frame.
    pub fn tick(&self) {
        self.drop_cancelled();
        let mut graced = Vec::new();
        {
            let mut inner = self.0.borrow_mut();
            for busy in inner.slots.iter_mut().filter_map(|slot| slot.busy.as_mut()) {
                if busy.parcel.monitor.is_cancelled() && !busy.given_grace {
                    busy.given_grace = true;
                    graced.push(busy.id);
                }
            }
        }
        for id in graced {
            let pool = self.clone();
            let end = Closure::once_into_js(move || pool.give_up(id));
            if let Some(window) = web_sys::window() {
                let end = end.unchecked_ref();
                let _ = window.set_timeout_with_callback_and_timeout_and_arguments_0(end, GRACE_MS);
            }
        }
    }

    /// Gives up the errands that wait though nobody waits for them any more.
    fn drop_cancelled(&self) {
        let dropped: VecDeque<Parcel> = {
            let mut inner = self.0.borrow_mut();
            let waiting = std::mem::take(&mut inner.waiting);
            let (gone, kept) = waiting
                .into_iter()
                .partition(|parcel| parcel.monitor.is_cancelled());
            inner.waiting = kept;
            gone
        };
        for parcel in dropped {
            (parcel.answer)(End::GivenUp);
        }
    }

    /// Ends the worker that is at an errand nobody waits for, if it still is.
    fn give_up(&self, id: u32) {
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
            (busy.parcel.answer)(End::GivenUp);
        }
        self.add();
        self.go_on();
    }

    /// Adds a worker if there may be one more.
    fn add(&self) {
        let mut inner = self.0.borrow_mut();
        if inner.slots.len() >= inner.program.workers {
            return;
        }
        match self.started(&inner.program) {
            Ok(slot) => inner.slots.push(slot),
            Err(error) => {
                inner.program.workers = inner.slots.len();
                let waiting = std::mem::take(&mut inner.waiting);
                drop(inner);
                for parcel in waiting {
                    (parcel.answer)(End::Fault(no_worker(&error)));
                }
            }
        }
    }

    fn started(&self, program: &Program) -> Result<Slot, JsValue> {
        let options = WorkerOptions::new();
        options.set_type(WorkerType::Module);
        let worker = Worker::new_with_options(&program.worker, &options)?;
        let (pool, from) = (self.clone(), worker.clone());
        let on_message = Closure::<dyn FnMut(MessageEvent)>::new(move |event: MessageEvent| {
            pool.hear(&from, &event.data());
        });
        worker.set_onmessage(Some(on_message.as_ref().unchecked_ref()));
        let (pool, from) = (self.clone(), worker.clone());
        // Where the script cannot be had the event has no message, whatever its type promises.
        let on_error = Closure::<dyn FnMut(Event)>::new(move |event: Event| {
            let message = Reflect::get(&event, &"message".into());
            let message = message.ok().and_then(|message| message.as_string());
            let why = message.unwrap_or_else(|| "its script cannot be loaded".to_owned());
            pool.break_down(&from, &why);
        });
        worker.set_onerror(Some(on_error.as_ref().unchecked_ref()));
        worker.set_onmessageerror(Some(on_error.as_ref().unchecked_ref()));
        let first = object(&[
            ("bindings", program.bindings.as_str().into()),
            ("module", program.module.clone()),
        ]);
        worker.post_message(&first)?;
        Ok(Slot {
            worker,
            known: Vec::new(),
            busy: None,
            has_worked: false,
            _on_message: on_message,
            _on_error: on_error,
        })
    }

    /// A worker cannot go on: the errand that it was at fails, and it is replaced with the next errand.
    fn break_down(&self, worker: &Worker, why: &str) {
        let slot = {
            let mut inner = self.0.borrow_mut();
            let place = inner.slots.iter().position(|slot| slot.worker == *worker);
            place.map(|place| inner.slots.remove(place))
        };
        let Some(slot) = slot else {
            return;
        };
        let is_hopeless = self.0.borrow_mut().note_broken(&slot);
        slot.worker.terminate();
        if let Some(busy) = slot.busy {
            let text = format!("a background job failed ({why}); this is a fault of the program");
            (busy.parcel.answer)(End::Fault(text));
        }
        if is_hopeless {
            let waiting = std::mem::take(&mut self.0.borrow_mut().waiting);
            for parcel in waiting {
                (parcel.answer)(End::Fault(no_worker(&why.into())));
            }
        }
        self.go_on();
    }

    fn hear(&self, worker: &Worker, message: &JsValue) {
        let get = |name: &str| {
            let value = Reflect::get(message, &name.into()).unwrap_or(JsValue::UNDEFINED);
            (!value.is_undefined()).then_some(value)
        };
        if let Some(why) = get("broken").or_else(|| get("fault")) {
            self.break_down(worker, &why.as_string().unwrap_or_default());
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
                self.break_down(worker, &why);
            }
        } else if let Some(outcome) = get("outcome") {
            let bytes = Uint8Array::new(&outcome).to_vec();
            self.finish(worker, bytes, get("known").map(|known| generations(&known)));
        }
    }

    fn monitor_of(&self, worker: &Worker) -> Option<Arc<Monitor>> {
        let inner = self.0.borrow();
        let slot = inner.slots.iter().find(|slot| slot.worker == *worker)?;
        Some(Arc::clone(&slot.busy.as_ref()?.parcel.monitor))
    }

    fn finish(&self, worker: &Worker, bytes: Vec<u8>, known: Option<Vec<u64>>) {
        let busy = {
            let mut inner = self.0.borrow_mut();
            inner.broken = 0;
            let slot = inner.slots.iter_mut().find(|slot| slot.worker == *worker);
            slot.and_then(|slot| {
                slot.has_worked = true;
                slot.known = known.unwrap_or_default();
                slot.busy.take()
            })
        };
        self.go_on();
        if let Some(busy) = busy {
            (busy.parcel.answer)(End::Outcome(bytes));
        }
    }

    /// Sends the sessions that a worker lacks, and its errand again.
    fn send_sessions(&self, worker: &Worker, unknown: &[u64]) -> Result<(), String> {
        let mut inner = self.0.borrow_mut();
        let slot = inner.slots.iter_mut().find(|slot| slot.worker == *worker);
        let Some(busy) = slot.and_then(|slot| slot.busy.as_mut()) else {
            return Ok(());
        };
        if std::mem::replace(&mut busy.was_taught, true) {
            return Err(format!("sessions {unknown:?} are not understood"));
        }
        let sessions = busy.parcel.sessions.iter();
        let lacking: Vec<_> = sessions
            .filter(|session| unknown.contains(&session.generation))
            .collect();
        if lacking.is_empty() {
            return Err(format!("sessions {unknown:?} are nowhere"));
        }
        for session in lacking {
            let bytes = session_bytes(session)?;
            let bytes = Uint8Array::from(&bytes[..]).buffer();
            let message = object(&[("session", bytes.clone().into())]);
            post(worker, &message, &bytes)?;
        }
        send(worker, busy.id, &busy.parcel)
    }

    /// Gives waiting errands to idle workers. A page that is not shown has no frames that would see to what was cancelled.
    fn go_on(&self) {
        self.drop_cancelled();
        loop {
            let mut inner = self.0.borrow_mut();
            if inner.waiting.is_empty() || !inner.is_open {
                return;
            }
            let idle = inner.idle();
            let failed = idle.and_then(|place| inner.give(place));
            let may_grow = inner.slots.len() < inner.program.workers;
            drop(inner);
            match (idle, failed) {
                (_, Some((answer, why))) => answer(End::Fault(why)),
                (Some(_), None) => {}
                (None, None) if may_grow => self.add(),
                (None, None) => return,
            }
        }
    }
}

impl Inner {
    /// Takes note of a worker that broke; returns whether no more are tried. An errand may break one that has worked before.
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

    /// Returns the idle worker that knows most of what the next errand is about.
    fn idle(&self) -> Option<usize> {
        let next = self.waiting.front()?;
        let idle = self
            .slots
            .iter()
            .enumerate()
            .filter(|(_, slot)| slot.busy.is_none());
        let knows = |slot: &Slot| {
            let sessions = next.sessions.iter();
            sessions
                .filter(|session| slot.known.contains(&session.generation))
                .count()
        };
        let best = idle.max_by_key(|(place, slot)| (knows(slot), std::cmp::Reverse(*place)))?;
        Some(best.0)
    }

    /// Gives the next errand to a worker; returns it with the reason if it cannot be sent.
    fn give(&mut self, place: usize) -> Option<(Answer, String)> {
        let parcel = self.waiting.pop_front()?;
        let id = self.next_id;
        self.next_id = self.next_id.wrapping_add(1);
        let slot = &mut self.slots[place];
        match send(&slot.worker, id, &parcel) {
            Ok(()) => {
                slot.busy = Some(Busy {
                    id,
                    parcel,
                    given_grace: false,
                    was_taught: false,
                });
                None
            }
            Err(why) => Some((parcel.answer, why)),
        }
    }
}

impl Carrier for Pool {
    fn carry(&self, parcel: Parcel) {
        let none = {
            let mut inner = self.0.borrow_mut();
            inner.waiting.push_back(parcel);
            inner.slots.is_empty() && inner.program.workers == 0
        };
        if none {
            let parcel = self.0.borrow_mut().waiting.pop_back();
            if let Some(parcel) = parcel {
                (parcel.answer)(End::Fault(no_worker(&JsValue::NULL)));
            }
            return;
        }
        self.go_on();
    }
}

fn no_worker(error: &JsValue) -> String {
    let why = error.as_string().unwrap_or_default();
    format!("the browser gives no worker to compute in the background {why}")
        .trim_end()
        .to_owned()
}

fn send(worker: &Worker, id: u32, parcel: &Parcel) -> Result<(), String> {
    let input = Uint8Array::from(&parcel.input[..]).buffer();
    let message = object(&[
        ("id", id.into()),
        ("name", parcel.name.into()),
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
