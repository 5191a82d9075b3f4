//! Files in a browser: chosen in its dialog or dropped on the page, and read into memory. Files that are too
//! long are refused before they are read.

use js_sys::{Promise, Uint8Array};
use tilescope_session::incoming::refusals;
use tilescope_session::jobs::{Job, Wake};
use wasm_bindgen::{JsCast, JsValue};
use wasm_bindgen_futures::JsFuture;
use web_sys::{File, HtmlInputElement, Response};

use super::NamedBytes;

/// The files read, and messages about those that were not.
#[derive(Default)]
pub struct ReadFiles {
    /// The files that were read whole.
    pub files: Vec<NamedBytes>,
    /// Messages about files that were not read.
    pub refused: Vec<String>,
}

/// Opens the browser's dialog, which browsers allow only right after a button or key was pressed; the job ends
/// with the chosen files.
#[must_use]
pub fn choose(wake: &Wake) -> Job<ReadFiles> {
    // The dialog opens here and not in the job, as browsers allow it only while they handle the press.
    let opened = open_dialog();

    Job::start_future(wake, move |_| async move {
        let chosen = match opened {
            Ok((input, answered)) => answer(&input, answered).await,
            Err(error) => Err(error),
        };
        match chosen {
            Ok(files) => read_all(files).await,
            Err(error) => ReadFiles {
                refused: vec![format!("the browser shows no dialog: {}", message(&error))],
                ..ReadFiles::default()
            },
        }
    })
}

/// Opens the browser's dialog for files. The promise is resolved when the user has chosen some, or none.
fn open_dialog() -> Result<(HtmlInputElement, Promise), JsValue> {
    let missing = || JsValue::from_str("there is no page");
    let window = web_sys::window().ok_or_else(missing)?;
    let document = window.document().ok_or_else(missing)?;

    let input: HtmlInputElement = document.create_element("input")?.unchecked_into();
    input.set_type("file");
    // A set is chosen with its certificate, a session with its pattern.
    input.set_multiple(true);
    input.set_hidden(true);
    document.body().ok_or_else(missing)?.append_child(&input)?;

    let mut listens = Ok(());
    // The browser answers by one of two events: `cancel` comes when the user closes the dialog.
    let answered = Promise::new(&mut |resolve, _| {
        let change = input.add_event_listener_with_callback("change", &resolve);
        let cancel = input.add_event_listener_with_callback("cancel", &resolve);
        listens = change.and(cancel);
    });

    listens?;
    input.click();
    Ok((input, answered))
}

async fn answer(input: &HtmlInputElement, answered: Promise) -> Result<Vec<File>, JsValue> {
    let answered = JsFuture::from(answered).await;
    let files = input.files();
    input.remove();
    answered?;
    let files = files.into_iter();
    Ok(files
        .flat_map(|list| (0..list.length()).filter_map(move |k| list.get(k)))
        .collect())
}

/// Fetches a file of the page by its name; fails with a reason.
pub(super) async fn fetched(name: &str) -> Result<Vec<u8>, String> {
    let window = web_sys::window().ok_or("there is no page")?;
    // Servers answer for the page by the name of its folder, and some redirect `index.html` to that.
    let address = match name {
        "index.html" => "./".to_owned(),
        name => format!("./{name}"),
    };
    let answered = JsFuture::from(window.fetch_with_str(&address)).await;
    let response: Response = answered.map_err(|error| message(&error))?.unchecked_into();
    if !response.ok() {
        return Err(format!("the server answered {}", response.status()));
    }

    let buffer = response.array_buffer().map_err(|error| message(&error))?;
    let buffer = JsFuture::from(buffer).await;
    Ok(Uint8Array::new(&buffer.map_err(|error| message(&error))?).to_vec())
}

/// Reads files that were dropped on the page.
#[must_use]
pub fn take(files: Vec<File>, wake: &Wake) -> Job<ReadFiles> {
    Job::start_future(wake, move |_| read_all(files))
}

/// Reads files one after another; one that fails does not stop the others.
async fn read_all(files: Vec<File>) -> ReadFiles {
    let names: Vec<String> = files.iter().map(File::name).collect();
    let lengths = files.iter().map(|file| file.size() as u64);
    let stated: Vec<(&str, u64)> = names.iter().map(String::as_str).zip(lengths).collect();

    let mut found = ReadFiles::default();
    for ((file, name), refusal) in files.iter().zip(&names).zip(refusals(&stated)) {
        // A file is read into memory whole, so that one that is too long is refused before it is read.
        if let Some(why) = refusal {
            found.refused.push(why);
            continue;
        }

        match JsFuture::from(file.array_buffer()).await {
            Ok(buffer) => {
                let bytes = Uint8Array::new(&buffer).to_vec();
                found.files.push(NamedBytes::new(name.clone(), bytes));
            }
            Err(error) => {
                let why = message(&error);
                found.refused.push(format!("{name} cannot be read: {why}"));
            }
        }
    }
    found
}

fn message(error: &JsValue) -> String {
    let error: Option<&js_sys::Error> = error.dyn_ref();
    error.map_or_else(
        || "it gives no reason".to_owned(),
        |error| String::from(error.message()),
    )
}
