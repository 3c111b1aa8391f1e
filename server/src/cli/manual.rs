//! `jointbench completions` and `jointbench man`: the command line for shells and manuals.

use super::arguments::Arguments;
use super::exit::{Done, Exit};
use clap::CommandFactory;
use clap_complete::{Shell, generate};
use std::io::stdout;
use std::path::Path;

pub fn completions(shell: Shell) -> Done {
    let mut command = Arguments::command();
    let name = command.get_name().to_owned();
    generate(shell, &mut command, name, &mut stdout());
    Ok(())
}

/// Writes `jointbench.1`, `jointbench-run.1` and so on.
pub fn pages(folder: &Path) -> Done {
    let unwritable = |fault: std::io::Error| Exit::bad_input(format!("{}: {fault}", folder.display()));
    std::fs::create_dir_all(folder).map_err(unwritable)?;
    clap_mangen::generate_to(Arguments::command(), folder).map_err(unwritable)?;
    println!("man pages written to {}: read one with `man {}/jointbench.1`", folder.display(), folder.display());
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_visible_command_has_a_page_and_hidden_ones_have_none() {
        let folder = tempfile::tempdir().unwrap();
        pages(folder.path()).unwrap();
        let page = |name: &str| std::fs::read_to_string(folder.path().join(name));
        for command in Arguments::command().get_subcommands() {
            let there = page(&format!("jointbench-{}.1", command.get_name())).is_ok();
            assert_eq!(there, !command.is_hide_set(), "{}", command.get_name());
        }
        assert!(page("jointbench-queue-add.1").unwrap().contains("Test plan"));
    }
}
