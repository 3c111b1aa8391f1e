//! Identifications of procedures: from simulated tables, and on the mock bench.

mod brakes;
mod compensation;
mod cut;
mod diagnosed;
mod load;
mod mock;
mod next;
mod pauses;
mod tables;
