//! Links to a window with its panels.

use egui::{Key, Modifiers, OutputCommand};

use tilescope_workbench::Command;
use tilescope_workbench::command::LinkCommand;
use tilescope_workbench::state::not_copied;

use crate::support::{opened, settle};

#[test]
fn a_window_copies_its_link() {
    let mut harness = opened();
    // Panels shown return to their default places.
    assert_eq!(harness.state().state.link().fragment, "v=1");
    harness.key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::L);
    harness.run();
    let notice = harness
        .state()
        .state
        .messages()
        .notice
        .clone()
        .expect("a notice");
    assert!(notice.text.starts_with("The link is copied"), "{notice:?}");
    harness
        .state_mut()
        .state
        .apply(Command::Link(LinkCommand::Copy));
    harness.step();
    let commands = &harness.output().platform_output.commands;
    let copied = |command: &OutputCommand| *command == OutputCommand::CopyText("#v=1".to_owned());
    assert!(commands.iter().any(copied), "{commands:?}");
    harness.step();
    let commands = &harness.output().platform_output.commands;
    assert!(!commands.iter().any(copied), "it is copied once");
    // With another copier, egui does not copy, and failures are reported.
    harness.state_mut().copy_with(|text| text == "#v=1");
    harness
        .state_mut()
        .state
        .apply(Command::Link(LinkCommand::Copy));
    harness.step();
    let commands = &harness.output().platform_output.commands;
    assert!(!commands.iter().any(copied), "{commands:?}");
    harness.state_mut().state.report(not_copied(false));
    let notice = harness
        .state()
        .state
        .messages()
        .notice
        .clone()
        .expect("a notice");
    assert!(
        notice.is_error && notice.text.contains("address bar"),
        "{notice:?}"
    );
    harness
        .state_mut()
        .state
        .open_link("v=1&layout=VT_cg-5000t5000-&look=light");
    settle(&mut harness);
    let link = harness.state().state.link().fragment;
    assert!(link.starts_with("v=1&look=light&layout=VT_cgpil"), "{link}");
}
