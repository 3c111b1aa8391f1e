//! Class of a request, which a connection must know before the router.

use hyper::Method;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Demand {
    /// Also answered on the reserved connections: health of the daemon and software stop.
    Vital,
    /// A file, which may take longer than other bodies.
    Upload,
    Ordinary,
}

impl Demand {
    pub fn of(method: &Method, path: &str) -> Self {
        let Some(path) = path.strip_prefix("/api/v1/") else { return Demand::Ordinary };
        let parts: Vec<&str> = path.splitn(4, '/').collect();
        match (method, parts.as_slice()) {
            (&Method::GET, ["health"]) | (&Method::POST, ["bench", _, "stop"]) => Demand::Vital,
            (&Method::POST, ["runs", "import"]) => Demand::Upload,
            _ => Demand::Ordinary,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_health_and_the_software_stop_are_vital() {
        for (method, path, demand) in [
            (Method::GET, "/api/v1/health", Demand::Vital),
            (Method::POST, "/api/v1/bench/joint-a/stop", Demand::Vital),
            (Method::GET, "/api/v1/bench/joint-a/stop", Demand::Ordinary),
            (Method::POST, "/api/v1/bench/joint-a/x/stop", Demand::Ordinary),
            (Method::POST, "/api/v1/runs/3/stop", Demand::Ordinary),
            (Method::POST, "/api/v1/runs/import", Demand::Upload),
            (Method::POST, "/api/v1/runs", Demand::Ordinary),
            (Method::GET, "/", Demand::Ordinary),
        ] {
            assert_eq!(Demand::of(&method, path), demand, "{method} {path}");
        }
    }
}
