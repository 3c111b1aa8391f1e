//! Motion of a hexapod platform: straight from pose to pose, all axes arriving together.

/// Travel of each axis with the others at zero: mm and degrees (H-820 class).
const TRAVEL: [f64; 6] = [22.5, 22.5, 12.5, 7.5, 7.5, 12.5];
/// Rotations are as slow as the rim of the platform: mm of travel per degree (assumed).
const MM_PER_DEGREE: f64 = 1.0;
const REFERENCE_S: f64 = 8.0;
/// Time between arrival and "on target".
const SETTLING_S: f64 = 0.1;

pub struct Motion {
    pub target: [f64; 6],
    pub velocity_mm_s: f64,
    referenced: bool,
    reference_until_s: Option<f64>,
    from: [f64; 6],
    start_s: f64,
    duration_s: f64,
}

impl Motion {
    pub fn new() -> Self {
        Self {
            target: [0.0; 6],
            velocity_mm_s: 2.0,
            referenced: false,
            reference_until_s: None,
            from: [0.0; 6],
            start_s: f64::NEG_INFINITY,
            duration_s: 0.0,
        }
    }

    /// The reachable poses are an ellipsoid (assumed): travel along one axis reduces the travel of the others.
    pub fn holds(pose: [f64; 6]) -> bool {
        pose.iter().zip(TRAVEL).map(|(value, travel)| (value / travel).powi(2)).sum::<f64>() <= 1.0
    }

    /// Travel of each axis while the others keep their position.
    pub fn reach(&self) -> [f64; 6] {
        let share = |axis: usize| (self.target[axis] / TRAVEL[axis]).powi(2);
        let all: f64 = (0..6).map(share).sum();
        std::array::from_fn(|axis| TRAVEL[axis] * (1.0 - all + share(axis)).max(0.0).sqrt())
    }

    pub fn is_referenced(&self) -> bool {
        self.referenced
    }

    pub fn is_busy(&self, now_s: f64) -> bool {
        self.reference_until_s.is_some_and(|until_s| now_s < until_s)
    }

    pub fn is_moving(&self, now_s: f64) -> bool {
        self.is_busy(now_s) || now_s < self.start_s + self.duration_s
    }

    pub fn is_settled(&self, now_s: f64) -> bool {
        self.referenced && !self.is_busy(now_s) && now_s >= self.start_s + self.duration_s + SETTLING_S
    }

    pub fn reference(&mut self, now_s: f64) {
        self.referenced = false;
        self.reference_until_s = Some(now_s + REFERENCE_S);
    }

    pub fn finish_reference(&mut self, now_s: f64) {
        if self.reference_until_s.take_if(|until_s| now_s >= *until_s).is_some() {
            *self = Self { referenced: true, velocity_mm_s: self.velocity_mm_s, ..Self::new() };
        }
    }

    pub fn start(&mut self, target: [f64; 6], now_s: f64) {
        self.from = self.position(now_s);
        let way = |axis: usize| (target[axis] - self.from[axis]).abs() * if axis < 3 { 1.0 } else { MM_PER_DEGREE };
        self.duration_s = (0..6).map(way).fold(0.0, f64::max) / self.velocity_mm_s;
        (self.target, self.start_s) = (target, now_s);
    }

    /// Stops at the present pose. During a reference move that pose is unknown.
    pub fn stop(&mut self, now_s: f64) {
        self.reference_until_s = None;
        self.start(self.position(now_s), now_s);
    }

    pub fn position(&self, now_s: f64) -> [f64; 6] {
        let part = if self.duration_s > 0.0 { ((now_s - self.start_s) / self.duration_s).clamp(0.0, 1.0) } else { 1.0 };
        std::array::from_fn(|axis| self.from[axis] + part * (self.target[axis] - self.from[axis]))
    }
}
