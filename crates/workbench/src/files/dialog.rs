//! Whether the system has a file dialog. On Linux it is one of the desktop, which answers over the session's bus, or that of
//! the program zenity; without both the library that opens dialogs answers as if the user had cancelled. Native only.

use std::ffi::OsString;
use std::path::PathBuf;

/// Why Browse opens nothing.
const NO_DIALOG: &str = "This system has no file dialog: neither a desktop portal nor zenity. Type the file's path instead.";
/// The file by which the session's bus starts the desktop's dialogs, in a folder of shared data.
const PORTAL: &str = "dbus-1/services/org.freedesktop.portal.Desktop.service";

/// Returns why no file dialog can open, as a sentence; `None` if one can, as far as that is known without opening it.
#[must_use]
pub(crate) fn refusal() -> Option<String> {
    // Windows and macOS always have a dialog.
    let is_linux = cfg!(all(unix, not(target_os = "macos")));
    let has_dialog =
        !is_linux || Desktop::of_environment(|name| std::env::var_os(name)).has_dialog();
    (!has_dialog).then(|| NO_DIALOG.to_owned())
}

/// The parts of a desktop that dialogs need.
struct Desktop {
    /// Where programs are looked for.
    programs: Vec<PathBuf>,
    /// Where shared data are looked for.
    data: Vec<PathBuf>,
    /// Whether the session may have a bus.
    has_bus: bool,
}

impl Desktop {
    /// Returns what environment variables say of a desktop.
    fn of_environment(variable: impl Fn(&str) -> Option<OsString>) -> Self {
        let given = |name: &str| variable(name).filter(|value| !value.is_empty());
        let folders = |value: OsString| std::env::split_paths(&value).collect::<Vec<_>>();
        // Both defaults are those of the XDG Base Directory Specification.
        let shared = given("XDG_DATA_DIRS").unwrap_or_else(|| "/usr/local/share:/usr/share".into());
        let own = given("XDG_DATA_HOME")
            .map(PathBuf::from)
            .or_else(|| Some(PathBuf::from(given("HOME")?).join(".local/share")));

        // Without an address, the bus is a socket in the folder of the session.
        let socket = given("XDG_RUNTIME_DIR").map(|folder| PathBuf::from(folder).join("bus"));

        Self {
            programs: given("PATH").map(folders).unwrap_or_default(),
            data: own.into_iter().chain(folders(shared)).collect(),
            has_bus: given("DBUS_SESSION_BUS_ADDRESS").is_some()
                || socket.is_some_and(|socket| socket.exists()),
        }
    }

    fn has_dialog(&self) -> bool {
        let has_zenity = self
            .programs
            .iter()
            .any(|folder| folder.join("zenity").is_file());
        let has_portal = self.data.iter().any(|folder| folder.join(PORTAL).is_file());
        has_zenity || (self.has_bus && has_portal)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dialog_needs_zenity_or_a_portal_on_a_bus() {
        let folder = tempfile::tempdir().unwrap();
        let [programs, data, session] =
            ["bin", "share", "run"].map(|name| folder.path().join(name));
        let service = data.join(PORTAL);
        for folder in [&programs, &session, &service.parent().unwrap().to_owned()] {
            std::fs::create_dir_all(folder).unwrap();
        }
        let has_dialog = || {
            let variable = |name: &str| match name {
                "PATH" => Some(programs.clone().into()),
                "XDG_DATA_DIRS" => Some(data.clone().into()),
                "XDG_RUNTIME_DIR" => Some(session.clone().into()),
                _ => None,
            };
            Desktop::of_environment(variable).has_dialog()
        };
        assert!(!has_dialog());

        // A portal that no bus can start, and then one that a bus can.
        std::fs::write(&service, "").unwrap();
        assert!(!has_dialog());
        std::fs::write(session.join("bus"), "").unwrap();
        assert!(has_dialog());

        std::fs::remove_file(&service).unwrap();
        assert!(!has_dialog());
        std::fs::write(programs.join("zenity"), "").unwrap();
        assert!(has_dialog());
    }
}
