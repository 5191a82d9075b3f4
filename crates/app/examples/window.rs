//! Opens the window: `cargo run --release -p tilescope-app --example window [light]`.

fn main() -> Result<(), tilescope_app::AppError> {
    let options = tilescope_app::WindowOptions {
        light: std::env::args().any(|argument| argument == "light"),
        ..Default::default()
    };
    tilescope_app::run_native(&options)
}
