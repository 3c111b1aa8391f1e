//! One integration binary: each folder or file is one subject, as a user or a reader of the code meets it.

mod house;
