//! Wrong tokens, by the address they come from. Each further one waits longer for its refusal.
//!
//! A right token is never slowed: behind one address are many people, and nobody may lock out the software stop of the others.
//! Tokens are long enough (`lab::tokens`) that trying does not find one at any pace.

use std::collections::HashMap;
use std::net::{IpAddr, Ipv6Addr};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;
use tokio::sync::Semaphore;
use tokio::time::{Instant, sleep};

const FIRST_DELAY: Duration = Duration::from_millis(100);
const LONGEST_DELAY: Duration = Duration::from_secs(5);
/// An address that has sent no wrong token for so long begins anew.
const FORGOTTEN: Duration = Duration::from_secs(900);
/// The address that was quiet for longest is forgotten first.
const MOST_ADDRESSES: usize = 1024;
/// So many refusals wait at the same time; a further one is answered at once and counted.
const MOST_WAITING: usize = 16;

#[derive(Debug)]
pub struct Tries {
    known: Mutex<HashMap<IpAddr, Tried>>,
    waiting: Semaphore,
}

#[derive(Debug, Clone, Copy)]
struct Tried {
    wrong: u32,
    last: Instant,
}

/// How a wrong token is answered.
#[derive(Debug, PartialEq, Eq)]
pub enum Slowed {
    /// Its time is up: refuse it.
    Waited,
    /// Too many wait already: say that.
    TooMany,
}

impl Default for Tries {
    fn default() -> Self {
        Self { known: Mutex::default(), waiting: Semaphore::new(MOST_WAITING) }
    }
}

impl Tries {
    /// Counts a wrong token, tells of it in the log, and returns when it may be refused.
    pub async fn slow(&self, source: IpAddr) -> Slowed {
        let wrong = self.count(source);
        let Ok(_turn) = self.waiting.try_acquire() else { return Slowed::TooMany };
        let delay = delay(wrong);
        tracing::warn!(%source, wrong, delay_ms = delay.as_millis() as u64, "wrong token");
        sleep(delay).await;
        Slowed::Waited
    }

    fn count(&self, source: IpAddr) -> u32 {
        let now = Instant::now();
        let source = network(source);
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if known.len() >= MOST_ADDRESSES && !known.contains_key(&source) {
            let quietest = known.iter().min_by_key(|(_, tried)| tried.last).map(|(source, _)| *source);
            quietest.and_then(|quietest| known.remove(&quietest));
        }
        let tried = known.entry(source).or_insert(Tried { wrong: 0, last: now });
        if now.duration_since(tried.last) > FORGOTTEN {
            tried.wrong = 0;
        }
        *tried = Tried { wrong: tried.wrong.saturating_add(1), last: now };
        tried.wrong
    }
}

fn delay(wrong: u32) -> Duration {
    let doubled = 2_u32.saturating_pow(wrong.saturating_sub(1));
    FIRST_DELAY.saturating_mul(doubled).min(LONGEST_DELAY)
}

/// Whoever has one address of version 6 has the 2⁶⁴ beside it, too.
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
        let tries = Tries::default();
        let address = |n: u32| IpAddr::from(std::net::Ipv4Addr::from_bits(n));
        assert_eq!((tries.count(address(0)), tries.count(address(0)), tries.count(address(1))), (1, 2, 1));
        (2..3000).for_each(|n| assert!(tries.count(address(n)) > 0));
        assert_eq!(tries.known.lock().unwrap().len(), MOST_ADDRESSES);
        assert_eq!(tries.count(address(0)), 1, "the quietest was forgotten");
        let six = |text: &str| text.parse::<IpAddr>().unwrap();
        assert_eq!((tries.count(six("2001:db8::1")), tries.count(six("2001:db8::2"))), (1, 2));
        assert_eq!(network(six("::ffff:10.0.0.7")), six("10.0.0.7"));
    }

    #[tokio::test(start_paused = true)]
    async fn only_so_many_wait() {
        let tries = std::sync::Arc::new(Tries::default());
        let source = IpAddr::from([10, 0, 0, 7]);
        assert_eq!(tries.slow(source).await, Slowed::Waited);
        let all: Vec<_> = (0..2 * MOST_WAITING)
            .map(|_| {
                let tries = tries.clone();
                tokio::spawn(async move { tries.slow(source).await })
            })
            .collect();
        let mut refused = 0;
        for one in all {
            refused += usize::from(one.await.unwrap() == Slowed::TooMany);
        }
        assert_eq!(refused, MOST_WAITING);
    }
}
