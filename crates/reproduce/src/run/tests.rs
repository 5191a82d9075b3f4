use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::sync::Mutex;

use super::*;

const OF: Experiment = Experiment::Eq4;

fn options(out: &Path) -> Options {
    Options {
        settings: Settings::default(),
        out: out.to_owned(),
        fresh: false,
    }
}

/// Files of the experiment's parts, and what is in them.
fn parts(out: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let entries = fs::read_dir(folder(out, OF))
        .into_iter()
        .flatten()
        .flatten();
    entries
        .map(|entry| (entry.path(), fs::read(entry.path()).unwrap()))
        .collect()
}

/// Cancels as soon as so many parts are kept, and notes what was expected.
struct Until<'a> {
    out: &'a Path,
    parts: usize,
    expected: Mutex<Vec<f64>>,
}

impl<'a> Until<'a> {
    fn of(out: &'a Path, parts: usize) -> Self {
        let expected = Mutex::default();
        Self {
            out,
            parts,
            expected,
        }
    }
}

impl Watch for Until<'_> {
    fn expected(&self, seconds: f64, _: &[(Experiment, f64)]) {
        self.expected.lock().unwrap().push(seconds);
    }

    fn progress(&self, seconds: f64, _: &str) -> ControlFlow<()> {
        let expected = self.expected.lock().unwrap();
        assert!(seconds <= expected[expected.len() - 1] + 1e-6);
        if parts(self.out).len() >= self.parts {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }
}

#[test]
fn a_cancelled_run_keeps_its_parts_and_the_next_one_expects_and_makes_only_the_rest() {
    let folder = tempfile::tempdir().unwrap();
    let [whole, broken] = ["whole", "broken"].map(|name| folder.path().join(name));
    let never = Until::of(&whole, usize::MAX);
    let at_once = reproduce(&[OF], &options(&whole), &never).unwrap();
    let cancelled = reproduce(&[OF], &options(&broken), &Until::of(&broken, 2));
    assert!(matches!(cancelled, Err(ReproduceError::Cancelled)));
    let kept = parts(&broken);
    assert_eq!(kept.len(), 2);
    assert!(!broken.join("report.html").exists());

    let settings = Settings::default();
    let made_by = made_by(&Machine::this());
    let of = |out: Option<&Path>| left(OF, &settings, out, &made_by);
    let samples = |work: Work| work.sequential + work.verified;
    assert_eq!(of(None), OF.work(&settings));
    assert_eq!(of(Some(&folder.path().join("nowhere"))), OF.work(&settings));
    assert!(samples(of(Some(&broken))) < samples(OF.work(&settings)));
    assert!(samples(of(Some(&broken))) > 0.0);
    let rest = of(Some(&broken));

    let never = Until::of(&broken, usize::MAX);
    let later = reproduce(&[OF], &options(&broken), &never).unwrap();
    let all = parts(&broken);
    assert!(kept.iter().all(|(path, bytes)| all[path] == *bytes));
    assert!(all.len() > kept.len() && samples(rest) > 0.0);
    assert_eq!(later.finished[0].claims, at_once.finished[0].claims);
    assert_eq!(later.finished[0].tables, at_once.finished[0].tables);
    // Nothing is left to do, and that is said.
    assert!(samples(of(Some(&broken))) < 1e-3);
    let again = Until::of(&broken, usize::MAX);
    let same = reproduce(&[OF], &options(&broken), &again).unwrap();
    assert_eq!(same.finished, later.finished);
    assert!(again.expected.lock().unwrap()[0] < 1e-6);
    // What is forgotten is expected again.
    let fresh = Options {
        fresh: true,
        ..options(&broken)
    };
    let anew = Until::of(&broken, usize::MAX);
    reproduce(&[OF], &fresh, &anew).unwrap();
    assert!(anew.expected.lock().unwrap()[0] > 1e-3);
}

/// On two cores of a shared server, a busy one at that: samples a second.
const SLOW: Rates = Rates {
    tiled: 6e6,
    sequential: 1e6,
    reference: 0.2e6,
    verified: 0.8e6,
    transformed: 0.6e6,
};

#[test]
fn everything_in_its_quick_form_takes_less_than_two_minutes() {
    let settings = Settings::default();
    assert!(settings.quick);
    let each = Experiment::ALL.map(|one| SLOW.seconds(&one.work(&settings)));
    let all: f64 = each.iter().sum();
    assert!(all < 120.0, "{all} s: {each:?}");
}
