//! Writes the folder to be served beside its place and then renames it, so that an incomplete folder is never served.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, ensure};

use crate::compress::Packed;

/// Checks that `out` may be replaced: it does not exist, is empty, or was written by an earlier run.
pub fn may_replace(out: &Path) -> Result<()> {
    let Ok(mut entries) = fs::read_dir(out) else {
        ensure!(!out.exists(), "{} is not a folder", out.display());
        return Ok(());
    };
    // An earlier run has left these two files.
    let ours = ["index.html", "sw.js"]
        .iter()
        .all(|name| out.join(name).is_file());
    ensure!(
        ours || entries.next().is_none(),
        "{} holds other files than an earlier build's; they would be lost",
        out.display()
    );
    Ok(())
}

/// Writes all files to `out`, replacing its content.
pub fn write(out: &Path, files: &[Packed]) -> Result<()> {
    may_replace(out)?;
    let parent = match out.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    fs::create_dir_all(parent).with_context(|| parent.display().to_string())?;

    // The new and the old files stand in a temporary folder, which is removed also after an error.
    let beside = tempfile::Builder::new()
        .prefix(".dist-")
        .suffix(".tmp")
        .tempdir_in(parent)
        .with_context(|| format!("cannot write to {}", parent.display()))?;
    let (new, old) = (beside.path().join("new"), beside.path().join("old"));
    fs::create_dir(&new)?;

    for packed in files {
        let path = new.join(&packed.file.path);
        let copies = [
            ("", Some(&packed.file.bytes)),
            (".gz", packed.gzip.as_ref()),
            (".br", packed.brotli.as_ref()),
        ];
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder)?;
        }
        for (ending, bytes) in copies {
            let Some(bytes) = bytes else { continue };
            let path = new.join(format!("{}{ending}", packed.file.path));
            fs::write(&path, bytes).with_context(|| path.display().to_string())?;
        }
    }

    // The old folder is moved away and not yet removed, so that it can be put back.
    if out.exists() {
        fs::rename(out, &old).with_context(|| format!("cannot move {}", out.display()))?;
    }
    if let Err(error) = fs::rename(&new, out) {
        // The old folder is better than none.
        let _ = fs::rename(&old, out);
        return Err(error).with_context(|| out.display().to_string());
    }

    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::page::File;

    fn packed(path: &str, text: &str) -> Packed {
        Packed {
            file: File {
                path: path.to_owned(),
                bytes: text.into(),
                to_start: true,
                hashed: true,
            },
            gzip: Some(b"gz".to_vec()),
            brotli: None,
        }
    }

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let mut names: Vec<String> = entries
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn a_second_run_leaves_nothing_of_the_first() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("dist");
        let page = [
            packed("index.html", "1"),
            packed("sw.js", "1"),
            packed("a-1.js", "1"),
        ];
        write(&out, &page).unwrap();
        let page = [
            packed("index.html", "2"),
            packed("sw.js", "2"),
            packed("example/b.js", "2"),
        ];
        write(&out, &page).unwrap();
        assert_eq!(names(folder.path()), ["dist"]);
        assert_eq!(
            names(&out),
            [
                "example",
                "index.html",
                "index.html.gz",
                "sw.js",
                "sw.js.gz"
            ]
        );
        assert_eq!(names(&out.join("example")), ["b.js", "b.js.gz"]);
        assert_eq!(fs::read_to_string(out.join("index.html")).unwrap(), "2");
    }

    #[test]
    fn a_folder_of_something_else_is_left_alone() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("thesis.tex"), "all of it").unwrap();
        let error = write(folder.path(), &[packed("index.html", "1")]).unwrap_err();
        assert!(error.to_string().contains("would be lost"), "{error}");
        assert_eq!(names(folder.path()), ["thesis.tex"]);
        let file = folder.path().join("thesis.tex");
        assert!(
            may_replace(&file)
                .unwrap_err()
                .to_string()
                .contains("not a folder")
        );
        assert!(may_replace(&folder.path().join("dist")).is_ok());
    }
}
