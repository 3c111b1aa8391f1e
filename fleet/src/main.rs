//! `jointbench-fleet`: questions over thousands of joints.

use std::process::ExitCode;

fn main() -> ExitCode {
    jointbench_fleet::cli::main()
}
