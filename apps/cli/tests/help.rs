//! The help: one line a command, short after `-h`, in full after `--help`.

use crate::support::Folder;

#[test]
fn the_help_lists_one_line_for_each_command() {
    let help = Folder::new().done(&["--help"]).stdout;
    insta::assert_snapshot!("help", help);
}

#[test]
fn the_short_help_of_a_command_has_one_line_for_each_flag() {
    let folder = Folder::new();
    let short = folder.done(&["check", "-h"]).stdout;
    insta::assert_snapshot!("check_short_help", short);
    let long = folder.done(&["check", "--help"]).stdout;
    assert!(long.contains("An audit of the equations warns"), "{long}");
}
