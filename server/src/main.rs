//! The command `jointbench`.

fn main() -> std::process::ExitCode {
    jointbench::cli::main()
}
