//! Cancelling, resuming and repeating a reproduction.

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

/// Cancels as soon as so many parts are kept, and notes what was planned.
struct Until<'a> {
    out: &'a Path,
    parts: usize,
    planned: Mutex<Vec<Planned>>,
}

impl<'a> Until<'a> {
    fn of(out: &'a Path, parts: usize) -> Self {
        let planned = Mutex::default();
        Self {
            out,
            parts,
            planned,
        }
    }

    /// Units that were kept when the reproduction began.
    fn kept(&self) -> usize {
        let planned = self.planned.lock().unwrap();
        planned.iter().map(|one| one.kept).sum()
    }
}

impl Watch for Until<'_> {
    fn planned(&self, each: &[Planned]) {
        self.planned.lock().unwrap().extend(each);
    }

    fn progress(&self, done: usize, _: &str) -> ControlFlow<()> {
        let planned = self.planned.lock().unwrap();
        assert!(done <= planned.iter().map(|one| one.units).sum());
        if parts(self.out).len() >= self.parts {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }
}

#[test]
fn a_cancelled_run_keeps_its_parts_and_the_next_one_makes_only_the_rest() {
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
    let units = OF.units(&settings);
    let planned = |out: Option<&Path>| plan(&[OF], &settings, out)[0];
    assert_eq!(planned(None).kept, 0);
    assert_eq!(planned(Some(&folder.path().join("nowhere"))).kept, 0);
    let rest = planned(Some(&broken));
    assert_eq!((rest.units, rest.kept), (units, 2));
    assert!(rest.seconds > 0.0);

    let never = Until::of(&broken, usize::MAX);
    let later = reproduce(&[OF], &options(&broken), &never).unwrap();
    let all = parts(&broken);
    assert!(kept.iter().all(|(path, bytes)| all[path] == *bytes));
    assert_eq!(all.len(), units);
    assert_eq!(later.finished[0].claims, at_once.finished[0].claims);
    assert_eq!(later.finished[0].tables, at_once.finished[0].tables);
    // Nothing is left to do, and that is said.
    assert_eq!(planned(Some(&broken)).kept, units);
    let again = Until::of(&broken, usize::MAX);
    let same = reproduce(&[OF], &options(&broken), &again).unwrap();
    assert_eq!(same.finished, later.finished);
    assert_eq!(again.kept(), units);
    // With `fresh`, all units are planned again; it is stopped before it makes the first.
    let fresh = Options {
        fresh: true,
        ..options(&broken)
    };
    let anew = Until::of(&broken, 0);
    let stopped = reproduce(&[OF], &fresh, &anew);
    assert!(matches!(stopped, Err(ReproduceError::Cancelled)));
    let planned = anew.planned.into_inner().unwrap();
    assert_eq!((planned[0].units, planned[0].kept), (units, 0));
}
