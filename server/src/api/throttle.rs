//! Wrong tokens by address. The refusal of each further wrong token takes longer.
//!
//! A valid token is never delayed: several users can share one address, and none of them can block the software stop of
//! the others. Tokens are too long (`lab::tokens`) to be found by trial.

use std::collections::HashMap;
use std::net::{IpAddr, Ipv6Addr};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;
use tokio::sync::Semaphore;
use tokio::time::{Instant, sleep};

const FIRST_DELAY: Duration = Duration::from_millis(100);
const LONGEST_DELAY: Duration = Duration::from_secs(5);
/// Without a wrong token for this time, the count of an address starts again.
const RESET_AFTER: Duration = Duration::from_secs(900);
/// A further address replaces the address with the oldest wrong token.
const MAX_ADDRESSES: usize = 1024;
/// Delayed refusals at the same time. A further one is sent immediately and counted.
const MAX_WAITING: usize = 16;

#[derive(Debug)]
pub struct Throttle {
    known: Mutex<HashMap<IpAddr, Failures>>,
    waiting: Semaphore,
}

#[derive(Debug, Clone, Copy)]
struct Failures {
    wrong: u32,
    last: Instant,
}

/// Answer to a wrong token.
#[derive(Debug, PartialEq, Eq)]
pub enum Throttled {
    /// The delay is over: refuse the token.
    Waited,
    /// Too many refusals are delayed already.
    TooMany,
}

impl Default for Throttle {
    fn default() -> Self {
        Self { known: Mutex::default(), waiting: Semaphore::new(MAX_WAITING) }
    }
}

impl Throttle {
    /// Counts and logs a wrong token, and returns when it may be refused.
    pub async fn delay_refusal(&self, source: IpAddr) -> Throttled {
        let wrong = self.count(source);
        let Ok(_turn) = self.waiting.try_acquire() else { return Throttled::TooMany };
        let delay = delay(wrong);
        tracing::warn!(%source, wrong, delay_ms = delay.as_millis() as u64, "wrong token");
        sleep(delay).await;
        Throttled::Waited
    }

    fn count(&self, source: IpAddr) -> u32 {
        let now = Instant::now();
        let source = network(source);
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if known.len() >= MAX_ADDRESSES && !known.contains_key(&source) {
            let oldest = known.iter().min_by_key(|(_, failures)| failures.last).map(|(source, _)| *source);
            oldest.and_then(|oldest| known.remove(&oldest));
        }
        let failures = known.entry(source).or_insert(Failures { wrong: 0, last: now });
        if now.duration_since(failures.last) > RESET_AFTER {
            failures.wrong = 0;
        }
        *failures = Failures { wrong: failures.wrong.saturating_add(1), last: now };
        failures.wrong
    }
}

fn delay(wrong: u32) -> Duration {
    let doubled = 2_u32.saturating_pow(wrong.saturating_sub(1));
    FIRST_DELAY.saturating_mul(doubled).min(LONGEST_DELAY)
}

/// One user of IPv6 has 2⁶⁴ addresses of a network.
fn network(source: IpAddr) -> IpAddr {
    match source {
        IpAddr::V4(_) => source,
        IpAddr::V6(v6) => match v6.to_ipv4_mapped() {
            Some(v4) => v4.into(),
            None => Ipv6Addr::from_bits(v6.to_bits() >> 64 << 64).into(),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_further_one_waits_longer_up_to_an_end() {
        let delays: Vec<u128> = [1, 2, 3, 6, 7, 1000].into_iter().map(|wrong| delay(wrong).as_millis()).collect();
        assert_eq!(delays, [100, 200, 400, 3200, 5000, 5000]);
    }

    #[test]
    fn addresses_are_counted_apart_and_the_table_has_an_end() {
        let throttle = Throttle::default();
        let address = |n: u32| IpAddr::from(std::net::Ipv4Addr::from_bits(n));
        assert_eq!((throttle.count(address(0)), throttle.count(address(0)), throttle.count(address(1))), (1, 2, 1));
        (2..3000).for_each(|n| assert!(throttle.count(address(n)) > 0));
        assert_eq!(throttle.known.lock().unwrap().len(), MAX_ADDRESSES);
        assert_eq!(throttle.count(address(0)), 1, "the oldest was forgotten");
        let six = |text: &str| text.parse::<IpAddr>().unwrap();
        assert_eq!((throttle.count(six("2001:db8::1")), throttle.count(six("2001:db8::2"))), (1, 2));
        assert_eq!(network(six("::ffff:10.0.0.7")), six("10.0.0.7"));
    }

    #[tokio::test(start_paused = true)]
    async fn only_so_many_wait() {
        let throttle = std::sync::Arc::new(Throttle::default());
        let source = IpAddr::from([10, 0, 0, 7]);
        assert_eq!(throttle.delay_refusal(source).await, Throttled::Waited);
        let all: Vec<_> = (0..2 * MAX_WAITING)
            .map(|_| {
                let throttle = throttle.clone();
                tokio::spawn(async move { throttle.delay_refusal(source).await })
            })
            .collect();
        let mut refused = 0;
        for one in all {
            refused += usize::from(one.await.unwrap() == Throttled::TooMany);
        }
        assert_eq!(refused, MAX_WAITING);
    }
}
