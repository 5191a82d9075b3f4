//! Small pages put together.

use super::*;

fn sources(files: &[(&str, &str)]) -> BTreeMap<String, Source> {
    let files = files.iter().map(|(name, text)| {
        let source = Source::of_page(name, text.as_bytes().to_vec());
        ((*name).to_owned(), source)
    });
    files.collect()
}

fn small() -> Vec<(&'static str, &'static str)> {
    vec![
        (
            "index.html",
            "<script src={{asset:main.js}}> {{asset:still.png}}",
        ),
        ("main.js", "import '{{asset:part.js}}' // {{size:part.js}}"),
        ("part.js", "part"),
        ("still.png", "{{ not text }}"),
        ("sw.js", "const all = {{precache}}, version = '{{version}}'"),
    ]
}

fn by_start<'a>(files: &'a [File], start: &str) -> &'a File {
    let found = files.iter().find(|file| file.path.starts_with(start));
    found.unwrap_or_else(|| panic!("{start}"))
}

fn text(file: &File) -> &str {
    std::str::from_utf8(&file.bytes).unwrap()
}

#[test]
fn references_lead_to_final_names() {
    let files = assemble(&sources(&small()), "").unwrap();
    let part = by_start(&files, "part-");
    let main = by_start(&files, "main-");
    let index = by_start(&files, "index.html");
    assert_eq!(text(main), format!("import '{}' // 5\n", part.path));
    assert!(text(index).contains(&main.path));
    assert!(main.to_start && part.to_start && main.hashed && !index.hashed);
    assert!(!by_start(&files, "still-").to_start);
}

#[test]
fn a_change_deep_down_changes_every_name_above_it_and_the_version() {
    let before = assemble(&sources(&small()), "").unwrap();
    let mut changed = small();
    changed[2].1 = "another part";
    let after = assemble(&sources(&changed), "").unwrap();
    for start in ["part-", "main-"] {
        assert_ne!(by_start(&before, start).path, by_start(&after, start).path);
    }
    let same = |start| by_start(&before, start).path == by_start(&after, start).path;
    assert!(same("still-"));
    let version = |files: &[File]| {
        text(by_start(files, "sw.js"))
            .rsplit_once('=')
            .unwrap()
            .1
            .to_owned()
    };
    assert_ne!(version(&before), version(&after));
    let again = assemble(&sources(&small()), "").unwrap();
    assert_eq!(before, again);
}

#[test]
fn the_service_worker_lists_all_but_itself() {
    let files = assemble(&sources(&small()), "").unwrap();
    let worker = text(by_start(&files, "sw.js"));
    assert!(worker.contains("\"./\"") && !worker.contains("index.html"));
    for start in ["main-", "part-", "still-"] {
        assert!(worker.contains(&by_start(&files, start).path), "{worker}");
    }
    assert!(!worker.contains("sw.js") && !worker.contains("{{"));
}

#[test]
fn pages_apart_are_served_and_not_stored_but_what_they_share_is() {
    let mut all = sources(&small());
    let page = b"{{asset:still.png}} {{asset:own.png}} {{asset:part.js}}".to_vec();
    let name = "lesson/gaps/index.html";
    all.insert(name.to_owned(), Source::apart(name, page));
    all.insert("own.png".to_owned(), Source::made(vec![1]).set_apart());
    let files = assemble(&all, "").unwrap();

    let page = by_start(&files, name);
    assert!(page.path == name && !page.to_start && !page.hashed);
    let own = by_start(&files, "own-");
    assert!(own.hashed && text(page).contains(&own.path));
    let worker = text(by_start(&files, "sw.js"));
    assert!(!worker.contains("lesson/") && !worker.contains(&own.path));
    assert!(worker.contains(&by_start(&files, "still-").path));
}

#[test]
fn what_does_not_fit_together_is_refused() {
    let refused = |change: fn(&mut Vec<(&str, &str)>)| {
        let mut files = small();
        change(&mut files);
        format!("{:#}", assemble(&sources(&files), "").unwrap_err())
    };
    let missing = refused(|files| {
        files.remove(2);
    });
    assert!(
        missing.contains("main.js") && missing.contains("no file part.js"),
        "{missing}"
    );
    let circle = refused(|files| files[2].1 = "{{asset:main.js}}");
    assert!(circle.contains("main.js, part.js and main.js"), "{circle}");
    let unknown = refused(|files| files[1].1 = "{{assets:part.js}}");
    assert!(unknown.contains("{{assets:part.js}}"), "{unknown}");
    let list = refused(|files| files[1].1 = "{{precache}}");
    assert!(list.contains("only sw.js"), "{list}");
    let worker = refused(|files| files[1].1 = "{{asset:sw.js}}");
    assert!(worker.contains("stable name"), "{worker}");
    let none = refused(|files| {
        files.remove(0);
    });
    assert!(none.contains("no file index.html"), "{none}");
}

#[test]
fn what_tools_made_is_left_as_it_is() {
    let mut all = sources(&small());
    let made = "const wasm = {{...imports}};";
    all.insert("part.js".to_owned(), Source::made(made.as_bytes().to_vec()));
    let files = assemble(&all, "").unwrap();
    assert_eq!(text(by_start(&files, "part-")), format!("{made}\n"));
}

#[test]
fn pictures_for_those_who_link_to_the_page_have_whole_addresses() {
    let page = [("index.html", "{{address}}{{asset:a.png}}"), ("a.png", "")];
    let files = assemble(&sources(&page), "https://a.example/t/").unwrap();
    let picture = &by_start(&files, "a-").path;
    let index = by_start(&files, "index.html");
    assert_eq!(text(index), format!("https://a.example/t/{picture}"));
}

#[test]
fn the_policy_names_a_record_store_once() {
    let policy = "<meta content=\"connect-src 'self'; base-uri 'none'\">";
    let mut all = sources(&[("index.html", policy)]);
    allow_store(&mut all, "https://store.example").unwrap();
    let text = String::from_utf8(all["index.html"].bytes.clone()).unwrap();
    assert_eq!(
        text,
        "<meta content=\"connect-src 'self' https://store.example; base-uri 'none'\">"
    );
    // Without one policy it would not be known which one the browser follows.
    for wrong in ["", &policy.repeat(2)] {
        let mut all = sources(&[("index.html", wrong)]);
        assert!(allow_store(&mut all, "https://store.example").is_err());
    }
}
