//! The roof.

pub mod api;
pub mod lab;
pub mod live;
pub mod view;
