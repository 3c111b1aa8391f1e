//! What procedures identify: from tables that are written down here, and on the mock bench.

mod diagnosed;
mod mock;
mod next;
mod pauses;
mod tables;
