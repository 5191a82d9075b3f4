//! Links that are broken, of a newer version, too large or malicious.

use serde_json::json;
use tilescope_core::{MAXIMAL_DENSITY, Parameters};
use tilescope_session::layers::Layer;
use tilescope_tests::cases;
use tilescope_workbench::command::Which;
use tilescope_workbench::link::{
    LinkContent, MAX_CHARACTERS, MAX_PATTERN_SIDE, MAX_SAMPLES, MAX_SCENES, MAX_STOPS, MAX_TEXT,
    read, write,
};
use tilescope_workbench::{Command, State};

use super::support::{Draws, notice_text, opened, settle, state};

fn check_parameters(p: &Parameters) {
    let domain = p.validate_sequential().expect("parameters to sample");
    let samples = domain.area_radii() * MAXIMAL_DENSITY;
    assert!(samples <= MAX_SAMPLES, "{samples} samples");
    assert!(p.pattern.side <= MAX_PATTERN_SIDE);
}

/// Checks that the content of any text is within the limits, and that it is read again as written.
fn check(text: &str) -> LinkContent {
    let (content, warnings) = read(text);
    check_parameters(&content.parameters);
    if let Some(second) = &content.view.second {
        check_parameters(second);
    }
    if let Some(layout) = &content.combination {
        assert!(layout.placed().expect("a layout").expected <= MAX_SAMPLES);
    }
    assert!(content.breakpoints.len() <= MAX_STOPS && content.watches.len() <= MAX_STOPS);
    assert!(content.scenes.len() <= MAX_SCENES);
    let notes = content.scenes.iter().map(|mark| &mark.caption);
    let texts = content.watches.iter().chain(notes);
    assert!(
        texts
            .into_iter()
            .all(|text| text.chars().count() <= MAX_TEXT)
    );
    assert!(content.view.layout.is_whole());
    assert!(warnings.text().len() < 4_000, "the notice is short");
    let link = write(&content);
    assert!(link.fragment.len() <= MAX_CHARACTERS);
    let (again, unsaid) = read(&link.fragment);
    assert_eq!(unsaid.text(), "", "{}", link.fragment);
    assert_eq!(write(&again).fragment, link.fragment);
    content
}

/// Whether the run takes little time; one with two million samples, or such a pattern, does not.
fn is_quick(content: &LinkContent) -> bool {
    let second = content.view.second;
    [content.parameters].into_iter().chain(second).all(|p| {
        let domain = p.validate().expect("parameters");
        domain.area_radii() < 50_000.0 && p.pattern.side <= 200.0
    })
}

#[test]
fn links_as_mail_and_course_systems_mangle_them_are_read() {
    let (plain, _) = read("radius=0.02&seed=9");
    assert_eq!((plain.parameters.radius, plain.parameters.seed), (0.02, 9));
    for mangled in [
        "#radius%3D0.02%26seed%3D9",
        "radius%3d0.02&seed%3d9",
        "radius=0.02%26seed=9",
        "radius=0.02%26seed%3D9",
        "radius=0.02 &seed=9.",
        "radius=0.02+&seed=9)",
        "radius=%200.02&seed=9%3E",
        "radius=0.02&seed=9.%22 ",
        "radius=0.02&amp;seed=9%E2%80%9D,",
    ] {
        let (content, warnings) = read(mangled);
        assert_eq!(
            (&content, warnings.text().as_str()),
            (&plain, ""),
            "{mangled}"
        );
    }
    let (plain, _) = read("lesson=survivors&step=chain&language=de");
    assert_eq!(plain.language.as_deref(), Some("de"));
    for mangled in [
        "lesson%3Dsurvivors%26step%3Dchain%26language%3Dde",
        "lesson=survivors%26step%3Dchain%26language%3DDE",
        "lesson=survivors&step=chain.&language=de)",
    ] {
        let (content, warnings) = read(mangled);
        assert_eq!(
            (&content, warnings.text().as_str()),
            (&plain, ""),
            "{mangled}"
        );
    }

    // What people wrote is kept, with every mark and blank.
    let (content, warnings) = read("v=1&watch=a%26seed%3D2.&mark=5:so.%20");
    assert_eq!(content.watches, ["a&seed=2."]);
    assert_eq!(content.scenes[0].caption, "so. ");
    assert!(warnings.is_empty() && content.parameters.seed == 1);

    // A scene that is left out takes its view with it; the views of the others stay with theirs.
    let (content, warnings) =
        read("v=1&mark=5:a;x:b;7:c&mark-view=look:dark;look:print;look:light");
    let views = content.scenes.iter();
    let views: Vec<_> = views
        .map(|scene| (scene.event, scene.view["look"].clone()))
        .collect();
    assert_eq!(views, [(5, json!("dark")), (7, json!("light"))]);
    assert!(
        warnings.text().contains("scene \"x:b\" is invalid"),
        "{}",
        warnings.text()
    );
    // What is still wrong is named.
    let (_, warnings) = read("seed=9.5&language=fr");
    assert!(warnings.text().contains("seed 9.5; 1 is used"));
    assert!(warnings.text().contains("language \"fr\" is invalid"));
}

#[test]
fn an_unknown_lesson_shows_the_list_and_a_run() {
    let unknown = |state: &mut State| {
        state.open_link("lesson=no-such&step=chain&language=de");
        settle(state);
        assert!(state.lessons().shows_list && state.lessons().open.is_none());
        assert!(state.runs().first.session.is_some());
        assert!(notice_text(state).contains("no lesson \"no-such\""));
        assert_eq!(state.lessons().language, "de");
    };
    // At the start, when the first run is not made yet.
    unknown(&mut State::new(std::sync::Arc::new(|| {})));
    let mut state = state();
    unknown(&mut state);

    // Lessons that could not be loaded leave a run, too.
    let mut state = State::new(std::sync::Arc::new(|| {}));
    state.take_lessons(Ok(r#"{"lessons":[],"tables":[]}"#));
    state.open_link("lesson=survivors");
    state.take_lessons(Err("no network"));
    settle(&mut state);
    assert!(state.runs().first.session.is_some());

    // Capitals do not count.
    let state = opened("lesson=SURVIVORS&step=Chain");
    let learner = &state.lessons().open.as_ref().expect("the lesson").learner;
    assert_eq!(learner.step().name, "chain");
}

#[test]
fn invalid_parts_are_named_and_the_rest_is_read() {
    let marks = "9;".repeat(1_000_000);
    let bytes = "x".repeat(10_000_000);
    let mut state = state();
    for (text, part) in [
        ("v=1&radius=NaN", "radius NaN; 0.00836 is used instead."),
        ("radius=1e-308", "radius 1e-308, which makes more than"),
        ("radius=-0", "radius -0; 0.00836"),
        ("radius=1e308", "radius 1e308, which is too large"),
        ("width=inf", "width inf; 1 is used"),
        ("seed=-1", "seed -1; 1 is used"),
        (
            "seed=1&seed=2",
            "\"seed\" is there twice; the first one counts.",
        ),
        ("pattern=10000", "a pattern of 10000 r"),
        (
            "b=&b.radius=1e-9",
            "radius of run B 0.000000001, which makes more",
        ),
        ("b=&b.pattern=1e9", "a pattern of run B of 1000000000 r"),
        (
            "method=exact&order=index",
            "has no order: index is left out",
        ),
        ("method=reference", "steps of the reference sampler"),
        ("method=best", "method best; kdrt is used instead: there is"),
        ("b=love", "cannot be linked by \"love\""),
        ("b.seed=3", "but not the run (\"b\")"),
        ("v=999", "version 999, and this program knows version 2"),
        ("v=", "its version is \"\""),
        ("v=-1", "its version is \"-1\""),
        ("fireworks=on", "\"fireworks\" is unknown in links"),
        ("<script>=1", "\"<script>\" is unknown"),
        ("at=-5", "at \"-5\" is invalid"),
        ("at=99999999999999999999", "is invalid"),
        ("at=4000000000", "event 4000000000 of a run of"),
        ("stage=%zz", "no stage \"%zz\""),
        ("stage=dessert", "no stage \"dessert\""),
        ("camera=1,2", "camera \"1,2\" is invalid"),
        ("camera=NaN,0,1", "camera"),
        ("camera=1e300,0,1", "camera"),
        ("camera=0,0,-1", "camera"),
        ("layers=samples,fireworks", "no layer \"fireworks\""),
        ("colouring=plaid", "colouring \"plaid\""),
        ("look=", "look \"\" is invalid"),
        ("select=sample:4000000000", "selection does not fit"),
        ("select=sample:-1", "select"),
        ("select=place:1e9,0", "select"),
        ("select=place:150000,3", "selection does not fit"),
        ("clock=pass", "clock \"pass\""),
        ("speed=1e9", "speed \"1e9\""),
        ("speed=NaN", "speed"),
        ("loop=9-3", "loop \"9-3\""),
        ("loop=1-4000000000", "range does not fit"),
        ("break=eliminate.999", "breakpoint \"eliminate.999\""),
        ("break=%zz", "breakpoint \"%zz\""),
        (&format!("watch=p;{}", "%20".repeat(300)), "watch \""),
        ("mark=x", "scene \"x\""),
        ("mark=4000000000", "1 scene after the run's last event"),
        (
            &format!("mark={marks}"),
            "bytes; everything after the first 65,536 was left out",
        ),
        (&format!("seed=1&x={bytes}"), "10,000,009 bytes"),
        ("layout={\"root\":7}", "layout \"{\"root\":7}\" is invalid"),
        ("layout=HHHHH", "layout"),
        ("layout=Hc1-c", "layout"),
        ("combine=AAA", "combination was left out"),
        ("combine=A", "it is not base64"),
        ("combine=%25", "it is not base64"),
        (&format!("combine={}", "A".repeat(5_000)), "at most 4,000"),
    ] {
        let content = check(text);
        state.open_link(text);
        if is_quick(&content) {
            settle(&mut state);
        }
        assert!(
            notice_text(&state).contains(part),
            "{text:.60}: {}",
            notice_text(&state)
        );
        assert!(state.runs().first.session.is_some());
    }
    // Valid parts cause no warnings.
    assert_eq!(
        notice_text(&opened("v=1&seed=3&at=5&look=light&break=eliminate.5")),
        ""
    );
}

#[test]
fn parts_are_read_independently() {
    let state = opened("v=7&seed=3&radius=NaN&at=12&camera=&layers=disks&novel=1");
    let text = notice_text(&state);
    assert_eq!(
        text,
        "\"novel\" is unknown in links and was left out. The link is of version 7, and this program knows version 2; \
         what it knows was read. The link asked for radius NaN; 0.00836 is used instead. The link's camera \"\" is \
         invalid and was left out."
    );
    assert_eq!(state.link().fragment, "v=1&seed=3&at=12&layers=disks");
}

#[test]
fn nothing_larger_than_the_limit_is_started() {
    for text in [
        "radius=1e-9",
        "width=1e6&height=1e6",
        "width=1e30&height=1e30&radius=1e-30",
        "radius=1e-9&variant=as-printed",
        "radius=1e-9&b=clocks&b.radius=1e-10",
        "width=1e30&height=1e-30",
    ] {
        let mut state = state();
        state.open_link(text);
        check_parameters(&state.form().draft.parameters);
        assert!(!notice_text(&state).is_empty(), "{text}");
        // Do not wait for it: two million samples take long.
        state.apply(Command::Cancel(Which::First));
    }
    // A layout whose pieces clip from many large patterns.
    let piece = |k: usize| {
        format!(
            r#"{{"parameters":{{"radius":0.01,"pattern":{{"side":1400,"boundary":"periodic","seed":{k}}}}}}}"#
        )
    };
    let layout = format!(
        r#"{{"version":1,"radius":0.01,"columns":[0.5,0.5],"rows":[1],"pieces":[{},{}]}}"#,
        piece(1),
        piece(2)
    );
    let content = check(&format!("combine={}", base64(layout.as_bytes())));
    assert!(content.combination.is_none());
    let file = r#"{"version":1,"radius":0.01,"columns":[1],"rows":[1],"pieces":[{"file":"/etc/hostname"}]}"#;
    let state = opened(&format!("combine={}", base64(file.as_bytes())));
    assert!(
        notice_text(&state).contains("from files"),
        "{}",
        notice_text(&state)
    );
}

/// Base64 for addresses, written down again.
fn base64(bytes: &[u8]) -> String {
    let digits = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
    let bits: Vec<u8> = bytes
        .iter()
        .flat_map(|b| (0..8).rev().map(move |k| b >> k & 1))
        .collect();
    let six = |bits: &[u8]| (0..6).fold(0, |n, k| 2 * n + usize::from(*bits.get(k).unwrap_or(&0)));
    bits.chunks(6)
        .map(|bits| char::from(digits[six(bits)]))
        .collect()
}

const KEYS: [&str; 36] = [
    "v",
    "seed",
    "width",
    "height",
    "radius",
    "boundary",
    "leaf",
    "pattern",
    "pattern-boundary",
    "pattern-seed",
    "dihedral",
    "order",
    "insertion",
    "search",
    "variant",
    "combine",
    "at",
    "stage",
    "camera",
    "layers",
    "colouring",
    "look",
    "select",
    "clock",
    "speed",
    "loop",
    "b",
    "b.radius",
    "b.seed",
    "b.leaf",
    "break",
    "watch",
    "mark",
    "layout",
    "b.width",
    "unknown",
];

const VALUES: [&str; 40] = [
    "",
    "0",
    "1",
    "-1",
    "NaN",
    "inf",
    "-inf",
    "1e308",
    "-1e308",
    "1e-308",
    "1e30",
    "1e-30",
    "0.1",
    "7",
    "18446744073709551615",
    "4294967296",
    "periodic",
    "bounded",
    "random",
    "uniform",
    "as-printed",
    "two-radii",
    "yes",
    "disks,gaps",
    "age",
    "light",
    "event",
    "sample:3",
    "place:1,2",
    "3-9",
    "eliminate.5:p<1;!tile.1",
    "%",
    "%00",
    "%F0%9F%98%80",
    "nine",
    "VT_cg-5000t5000-",
    "{\"root\":{}}",
    "cameras,clocks",
    "1,2,3",
    "12:note;13",
];

#[test]
fn a_link_with_only_unknown_layers_shows_the_default_ones() {
    let layers = |text: &str| read(text).0.view.appearance.layers(None);
    assert_eq!(
        layers("v=1&layers=fireworks,tinsel"),
        LinkContent::default().view.appearance.layers(None)
    );
    assert!(!layers("v=1&layers=").has(Layer::Samples));
    let known = layers("v=1&layers=fireworks,disks");
    assert!(known.has(Layer::Disks) && !known.has(Layer::Samples));
}

#[test]
fn random_links_are_harmless() {
    let mut draws = Draws(0x5eed_0f11_2233);
    let mut opened_runs = 0;
    let links = cases(20_000);
    for _ in 0..links {
        let pairs: Vec<String> = (0..draws.below(9))
            .map(|_| format!("{}={}", draws.of(&KEYS), draws.of(&VALUES)))
            .collect();
        let content = check(&pairs.join("&"));
        opened_runs += usize::from(content != LinkContent::default());
    }
    assert!(
        opened_runs > 7 * links as usize / 20,
        "many say something: {opened_runs}"
    );
    for _ in 0..cases(5_000) {
        let bytes: Vec<u8> = (0..draws.below(80)).map(|_| draws.next() as u8).collect();
        check(&String::from_utf8_lossy(&bytes));
        let ascii: String = bytes.iter().map(|b| char::from(32 + b % 95)).collect();
        check(&ascii);
        let key = draws.of(&KEYS);
        check(&format!("{key}={ascii}"));
    }
}

#[test]
fn links_with_small_changes_are_harmless() {
    let whole = "v=1&seed=7&radius=0.02&leaf=30&at=18204&camera=12.5,33.1,8&layers=disks,gaps&select=sample:412&b=cameras&\
                 b.seed=8&break=eliminate.5:distance%20%3C%201&mark=5:here&layout=VHT_peba-1950T_cg-6050VT_lsx-4400T_viwk-5600-2000-8740t1260-";
    let (content, warnings) = read(whole);
    assert_eq!(warnings.text(), "");
    assert!(content.view.second.is_some() && content.scenes.len() == 1);
    let mut draws = Draws(77);
    let (links, mut damaged) = (cases(5_000), 0);
    for _ in 0..links {
        let mut bytes = whole.as_bytes().to_vec();
        let at = draws.below(bytes.len());
        match draws.below(3) {
            0 => bytes[at] = 33 + (draws.next() % 90) as u8,
            1 => bytes.truncate(at),
            _ => drop(bytes.remove(at)),
        }
        let changed = check(&String::from_utf8(bytes).unwrap());
        damaged += u32::from(changed != content);
    }
    assert!(damaged > links / 2, "{damaged} of {links}");
}

#[test]
fn a_link_from_outside_leaves_a_working_window() {
    let mut state: State = opened("v=3&layout=HHH&at=1e9&watch=((((((&break=eliminate.5:)(");
    for _ in 0..4 {
        state.apply(tilescope_workbench::Command::Time(
            tilescope_workbench::command::TimeCommand::StepBack,
        ));
    }
    settle(&mut state);
    state.open_link("");
    settle(&mut state);
    assert_eq!(state.link().fragment, "v=1");
}
