//! One integration binary: each folder is one subject, from the view of a user or of a reader of the code.

mod book;
mod browser;
mod daemon;
mod demo;
mod faults;
mod house;
mod offline;
mod package;
mod python;
mod shared;

use jointbench_tests::program;
