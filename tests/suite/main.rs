//! One integration binary: each folder is one subject, as a user or a reader of the code meets it.

mod browser;
mod daemon;
mod demo;
mod house;
mod offline;
mod program;
mod shared;
