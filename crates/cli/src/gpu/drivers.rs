//! Finds out why there is no GPU adapter: whether the Vulkan loader is installed, which drivers announce themselves to
//! it, and which variable names another one. It reads files only, and loads no library.

use std::collections::BTreeSet;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

use serde::Serialize;
use serde_json::Value;

use crate::paths::extension;

/// The library through which programs find Vulkan drivers.
const LOADER: &str = "libvulkan.so.1";

/// Either lists driver files, and then the loader reads no directories; the second is the older name.
const VARIABLES: [&str; 2] = ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"];

/// Directories of libraries, besides those of `LD_LIBRARY_PATH` and of the system's cache.
const LIBRARIES: [&str; 6] = [
    "/lib/x86_64-linux-gnu",
    "/usr/lib/x86_64-linux-gnu",
    "/usr/lib/aarch64-linux-gnu",
    "/usr/lib64",
    "/usr/lib",
    "/usr/local/lib",
];

/// The part of a system that makes GPUs available to programs.
#[derive(Debug, Serialize)]
pub struct Drivers {
    loader: Option<PathBuf>,
    /// The variable that lists driver files, if one is set.
    variable: Option<Variable>,
    /// The directories that the loader reads if no variable is set.
    looked_in: Vec<PathBuf>,
    #[serde(rename = "drivers")]
    files: Vec<DriverFile>,
}

/// A variable of the environment.
#[derive(Debug, Serialize)]
struct Variable {
    name: &'static str,
    value: String,
}

/// A file that announces a driver.
#[derive(Debug, Serialize)]
struct DriverFile {
    path: PathBuf,
    /// Its library as the file names it, if the file is usable.
    library: Option<String>,
    /// Why it is not usable.
    fault: Option<String>,
    /// Whether the library is installed.
    #[serde(rename = "found")]
    is_found: bool,
}

/// The files of a system and its environment.
struct System<'a> {
    root: &'a Path,
    variable: &'a dyn Fn(&str) -> Option<OsString>,
}

impl Drivers {
    /// Returns the drivers of this system; `None` on Windows and macOS, where files do not announce drivers.
    pub fn find() -> Option<Self> {
        let system = System {
            root: Path::new("/"),
            variable: &|name| std::env::var_os(name).filter(|value| !value.is_empty()),
        };
        cfg!(target_os = "linux").then(|| system.drivers())
    }

    /// Returns a line for each finding, and advice if no driver is installed.
    pub fn text(&self) -> String {
        let mut lines = vec![match &self.loader {
            Some(path) => format!("The Vulkan loader is {}.", path.display()),
            None => format!(
                "The Vulkan loader {LOADER} is not installed (Debian, Ubuntu: libvulkan1; Fedora: vulkan-loader)."
            ),
        }];

        if let Some(Variable { name, value }) = &self.variable {
            let others = "other drivers are not looked for";
            lines.push(format!("{name} is {value}: {others}."));
        }
        lines.extend(self.files.iter().map(DriverFile::text));

        // If a variable names the drivers, no directory was looked into.
        if self.files.is_empty() && self.variable.is_none() {
            let paths: Vec<String> = (self.looked_in.iter())
                .map(|path| path.display().to_string())
                .collect();
            let directories = paths.join(", ");
            lines.push(format!("No driver announces itself in {directories}."));
        }

        if !self.files.iter().any(|file| file.is_found) {
            lines.push(format!(
                "Install the GPU's driver with Vulkan (Mesa's, software included: mesa-vulkan-drivers), \
                 or set {} to the .json file of one that is elsewhere.",
                VARIABLES[0]
            ));
        }
        lines.join("\n")
    }
}

impl DriverFile {
    fn text(&self) -> String {
        let path = self.path.display();
        if let Some(fault) = &self.fault {
            return format!("{path} announces no driver: {fault}.");
        }
        let library = self.library.as_deref().unwrap_or_default();
        let missing = if self.is_found {
            ""
        } else {
            ", which is not there"
        };
        format!("{path} announces the driver {library}{missing}.")
    }
}

impl System<'_> {
    /// Returns the drivers that Vulkan's loader would find, as it looks for them.
    fn drivers(&self) -> Drivers {
        let with_value = |name: &'static str| Some((name, (self.variable)(name)?));
        // The loader does not read the older name where the newer one is set.
        let variable = VARIABLES.into_iter().find_map(with_value);
        let mut looked_in = Vec::new();
        // A variable may list a file or a directory twice. A set has each file once.
        let paths: BTreeSet<PathBuf> = if let Some((_, value)) = &variable {
            std::env::split_paths(value).collect()
        } else {
            looked_in = self.directories();
            let files = looked_in.iter().flat_map(|path| self.json_files(path));
            files.collect()
        };
        Drivers {
            loader: self.library(LOADER),
            variable: variable.map(|(name, value)| Variable {
                name,
                value: value.to_string_lossy().into_owned(),
            }),
            looked_in,
            files: paths.into_iter().map(|path| self.driver(path)).collect(),
        }
    }

    /// The directories that the loader searches for drivers, in its order (Khronos, "Driver interface to the Vulkan loader"):
    /// the XDG base directories with their defaults, and two of its own.
    fn directories(&self) -> Vec<PathBuf> {
        let home = (self.variable)("HOME").map(PathBuf::from);
        let under_home = |name: &str, default: &str| {
            let given = (self.variable)(name).map(PathBuf::from);
            given.or_else(|| Some(home.as_ref()?.join(default)))
        };
        let listed = |name: &str, default: &str| {
            let value = (self.variable)(name).unwrap_or_else(|| default.into());
            std::env::split_paths(&value).collect::<Vec<_>>()
        };

        // Settings of the user come before those of the system, and all settings before installed data. The loader's
        // own two stand between settings and data: it is usually built with these.
        let mut bases = Vec::from_iter(under_home("XDG_CONFIG_HOME", ".config"));
        bases.extend(listed("XDG_CONFIG_DIRS", "/etc/xdg"));
        bases.extend(["/usr/local/etc", "/etc"].map(PathBuf::from));
        bases.extend(under_home("XDG_DATA_HOME", ".local/share"));
        bases.extend(listed("XDG_DATA_DIRS", "/usr/local/share:/usr/share"));
        bases.iter().map(|base| base.join("vulkan/icd.d")).collect()
    }

    fn json_files(&self, directory: &Path) -> Vec<PathBuf> {
        let entries = std::fs::read_dir(self.real(directory)).into_iter();
        let names = entries.flatten().flatten().map(|entry| entry.file_name());
        let paths = names.map(|name| directory.join(name));
        paths.filter(|path| extension(path) == "json").collect()
    }

    /// Returns the driver of a file, with the fault if the file cannot be used.
    fn driver(&self, path: PathBuf) -> DriverFile {
        let library = self.library_of(&path);
        // As the loader does it: a name with a slash is a path, absolute or from the file's directory; any other is
        // searched for like a library.
        let is_found = library.as_ref().is_ok_and(|name| {
            if name.contains('/') {
                self.real(&path.with_file_name(name)).exists()
            } else {
                self.library(name).is_some()
            }
        });
        DriverFile {
            path,
            fault: library.as_ref().err().cloned(),
            library: library.ok(),
            is_found,
        }
    }

    fn library_of(&self, path: &Path) -> Result<String, String> {
        let text = std::fs::read_to_string(self.real(path)).map_err(|error| error.to_string())?;
        let value: Value = serde_json::from_str(&text).map_err(|error| error.to_string())?;
        let library = value["ICD"]["library_path"].as_str().map(str::to_owned);
        library.ok_or_else(|| "it has no ICD.library_path".to_owned())
    }

    /// The path under which a program would find a library.
    fn library(&self, name: &str) -> Option<PathBuf> {
        let given = (self.variable)("LD_LIBRARY_PATH").unwrap_or_default();
        let directories = std::env::split_paths(&given).chain(LIBRARIES.map(PathBuf::from));
        let mut paths =
            (directories.map(|directory| directory.join(name))).chain(self.cached(name));
        paths.find(|path| self.real(path).exists())
    }

    /// The paths of a library in the system's cache of libraries, which has them as strings that end in a zero.
    fn cached(&self, name: &str) -> Vec<PathBuf> {
        let cache = std::fs::read(self.real(Path::new("/etc/ld.so.cache"))).unwrap_or_default();
        let strings = cache.split(|&byte| byte == 0);
        let paths = strings.filter_map(|bytes| str::from_utf8(bytes).ok().map(PathBuf::from));
        let is_library = |path: &PathBuf| path.is_absolute() && path.ends_with(name);
        paths.filter(is_library).collect()
    }

    fn real(&self, path: &Path) -> PathBuf {
        self.root.join(path.strip_prefix("/").unwrap_or(path))
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    fn found(files: &[(&str, &str)], variables: &[(&str, &str)]) -> String {
        let root = tempfile::tempdir().expect("a directory");
        for (path, text) in files {
            let path = root.path().join(path);
            fs::create_dir_all(path.parent().expect("a parent")).expect("directories");
            fs::write(path, text).expect("a file");
        }
        let variable = |name: &str| {
            let mut found = variables.iter().filter(|(known, _)| *known == name);
            found.next().map(|(_, value)| value.into())
        };
        let system = System {
            root: root.path(),
            variable: &variable,
        };
        system.drivers().text()
    }

    const LOADER_FILE: (&str, &str) = ("usr/lib/x86_64-linux-gnu/libvulkan.so.1", "");
    const ANNOUNCED: (&str, &str) = (
        "etc/vulkan/icd.d/nvidia_icd.json",
        r#"{ "ICD": { "library_path": "libGLX_nvidia.so.0" } }"#,
    );

    #[test]
    fn a_missing_loader_is_named_with_its_package() {
        let text = found(&[], &[]);
        for part in [
            "libvulkan.so.1 is not installed",
            "libvulkan1",
            "/etc/vulkan/icd.d",
            "set VK_DRIVER_FILES",
        ] {
            assert!(text.contains(part), "{text}");
        }
    }

    #[test]
    fn a_driver_whose_library_is_missing_is_named() {
        let text = found(&[LOADER_FILE, ANNOUNCED], &[]);
        for part in [
            "loader is /usr/lib/x86_64-linux-gnu/libvulkan.so.1",
            "nvidia_icd.json announces the driver libGLX_nvidia.so.0, which is not there",
            "Install",
        ] {
            assert!(text.contains(part), "{text}");
        }
        let library = ("opt/nvidia/libGLX_nvidia.so.0", "");
        let cache = (
            "etc/ld.so.cache",
            "header\0/opt/nvidia/libGLX_nvidia.so.0\0",
        );
        let text = found(&[LOADER_FILE, ANNOUNCED, library, cache], &[]);
        assert!(text.contains("libGLX_nvidia.so.0."), "{text}");
        assert!(
            !text.contains("not there") && !text.contains("Install"),
            "{text}"
        );
    }

    #[test]
    fn a_variable_replaces_the_directories() {
        let files = [LOADER_FILE, ANNOUNCED, ("opt/other.json", "{")];
        let text = found(&files, &[("VK_ICD_FILENAMES", "/opt/other.json")]);
        assert!(
            text.contains("VK_ICD_FILENAMES is /opt/other.json"),
            "{text}"
        );
        assert!(
            text.contains("/opt/other.json announces no driver: EOF"),
            "{text}"
        );
        assert!(!text.contains("nvidia"), "{text}");
    }
}
