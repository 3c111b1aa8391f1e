//! Identifications of procedures: from simulated tables, and on the mock bench.

mod compensation;
mod diagnosed;
mod load;
mod mock;
mod next;
mod pauses;
mod tables;
