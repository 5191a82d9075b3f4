//! Tests that need a graphics driver: the drawn window, and GPU passes.

mod analysis_panel;
mod buffers;
mod canvas;
mod canvas_menu;
mod closing;
mod compact;
mod compare;
mod debugger;
mod embedded;
mod export_sheet;
mod fit;
mod hints;
mod hostile;
mod instanced;
mod keyboard;
mod lesson;
mod link;
mod marks;
mod menus;
mod names;
mod nested;
mod panels;
mod passes;
mod passes_panel;
mod rest;
mod scenes;
mod sentences;
mod sessions;
mod snapshots;
#[path = "../support/mod.rs"]
mod support;
mod talk;
mod touch;
mod window;
