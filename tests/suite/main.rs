//! One integration binary: each folder is one subject, as a user or a reader of the code meets it.

mod browser;
mod daemon;
mod demo;
mod faults;
mod house;
mod offline;
mod shared;

use jointbench_tests::program;
