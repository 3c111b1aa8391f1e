//! The Python package against the real program. Skipped with a message if its libraries are missing, unless
//! `JOINTBENCH_REQUIRE_PYTHON=1`.

use crate::house::root;
use crate::program::jointbench;
use std::process::Command;

/// The interpreter: `JOINTBENCH_PYTHON`, otherwise the `python3` on the path.
fn python() -> Command {
    Command::new(std::env::var("JOINTBENCH_PYTHON").unwrap_or_else(|_| "python3".into()))
}

fn is_installed() -> bool {
    let imports = ["-c", "import httpx, pydantic, pytest"];
    python().args(imports).output().is_ok_and(|output| output.status.success())
}

#[test]
fn the_python_package_passes_its_tests() {
    if !is_installed() {
        let what = "python3 lacks libraries: pip install -r python/tests/requirements.txt";
        assert!(std::env::var("JOINTBENCH_REQUIRE_PYTHON").as_deref() != Ok("1"), "{what}");
        eprintln!("SKIPPED: {what}. The tests of the Python package did NOT run.");
        return;
    }
    let output = python()
        .args(["-m", "pytest", "-p", "no:cacheprovider", "python"])
        .current_dir(root())
        .env("JOINTBENCH_PROGRAM", jointbench().get_program())
        .output()
        .expect("python3 runs");
    let text = [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
    // The skipped tests are named there.
    eprintln!("{}", text[0]);
    assert!(output.status.success(), "{}", text[1]);
}
