//! Access tokens. The tokens at the start of the daemon decide whether a token is required, and cannot be revoked here:
//! a person who can start the daemon has access anyway.

use super::{Answer, Lab, LabError, names};
use crate::store::TokenRecord;
use crate::view::{Access, MadeToken, NewToken, Token, reread, word};
use jiff::{SignedDuration, Timestamp};
use sha2::{Digest, Sha256};
use std::sync::{Arc, PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard};
use tokio::sync::watch;

/// For a token that a person chose. Generated tokens are longer.
const SHORTEST_TOKEN: usize = 16;
const FEWEST_CHARACTERS: usize = 6;
/// Minimum interval between two records of a token's use.
const USED_EVERY: SignedDuration = SignedDuration::from_secs(60);
/// Names of clients without a token, and of the tokens at the start.
pub const LOCAL: &str = "local";
const OPERATOR: &str = "operator";
const OBSERVER: &str = "observer";

/// Sender of a request.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Caller {
    pub access: Access,
    /// The name of the token, or `local`.
    pub name: Arc<str>,
    token: Option<[u8; 32]>,
}

impl Caller {
    /// A client on this computer, which needs no token.
    pub fn local() -> Self {
        Self { access: Access::Open, name: LOCAL.into(), token: None }
    }
}

/// All valid tokens.
#[derive(Debug)]
pub struct Tokens {
    all: RwLock<Vec<Known>>,
    /// Notifies about a revoked token.
    revoked: watch::Sender<()>,
}

#[derive(Debug)]
struct Known {
    /// `None` for a token from the start of the daemon.
    id: Option<i64>,
    caller: Caller,
    made: Option<(String, String)>,
    used: Option<Timestamp>,
}

impl Default for Tokens {
    fn default() -> Self {
        Self { all: RwLock::default(), revoked: watch::Sender::new(()) }
    }
}

impl Tokens {
    /// The tokens from the start of the daemon.
    pub fn given(token: Option<&str>, read_token: Option<&str>) -> Self {
        let full = token.map(|secret| (OPERATOR, Access::Full, secret));
        let read = read_token.map(|secret| (OBSERVER, Access::Read, secret));
        let known = |(name, access, secret): (&str, Access, &str)| Known {
            id: None,
            caller: Caller { access, name: name.into(), token: Some(hash(secret)) },
            made: None,
            used: None,
        };
        Self { all: RwLock::new(full.into_iter().chain(read).map(known).collect()), ..Self::default() }
    }

    /// Whether every client needs a token.
    pub fn are_needed(&self) -> bool {
        self.read().iter().any(|known| known.id.is_none())
    }

    /// The owner of a secret.
    pub fn holder(&self, secret: &str) -> Option<Caller> {
        let token = Some(hash(secret));
        self.read().iter().map(|known| &known.caller).find(|caller| caller.token == token).cloned()
    }

    fn add(&self, record: TokenRecord) -> Answer<()> {
        let token = record.hash.try_into().map_err(|_| LabError::Internal("the hash of a token is damaged".into()))?;
        self.write().push(Known {
            id: Some(record.id),
            caller: Caller { access: reread(&record.access)?, name: record.name.into(), token: Some(token) },
            made: Some((record.made_at, record.made_by)),
            used: record.used_at.and_then(|at| at.parse().ok()),
        });
        Ok(())
    }

    /// The id of the token if its use must be stored.
    fn note_use(&self, caller: &Caller) -> Option<i64> {
        let now = Timestamp::now();
        let lately = |used: Option<Timestamp>| used.is_some_and(|used| now.duration_since(used) < USED_EVERY);
        let is_it = |known: &&Known| caller.token.is_some() && known.caller.token == caller.token;
        if self.read().iter().find(is_it).is_none_or(|known| lately(known.used)) {
            return None;
        }
        let mut all = self.write();
        let known = all.iter_mut().find(|known| is_it(&&**known))?;
        known.used = Some(now);
        known.id
    }

    fn read(&self) -> RwLockReadGuard<'_, Vec<Known>> {
        self.all.read().unwrap_or_else(PoisonError::into_inner)
    }

    fn write(&self) -> RwLockWriteGuard<'_, Vec<Known>> {
        self.all.write().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Known {
    fn view(&self, to: &Caller) -> Token {
        let (made_at, made_by) = self.made.clone().unzip();
        Token {
            id: self.id,
            name: self.caller.name.to_string(),
            access: self.caller.access,
            made_at,
            made_by,
            used_at: self.used.map(|at| format!("{at:.0}")),
            yours: self.caller.token == to.token,
        }
    }
}

impl Lab {
    pub fn tokens(&self) -> &Tokens {
        &self.inner.tokens
    }

    pub(super) async fn open_tokens(&self) -> Answer<()> {
        for record in self.inner.store.tokens().await? {
            self.tokens().add(record)?;
        }
        Ok(())
    }

    /// Stores the use of a token in the background.
    pub fn record_token_use(&self, caller: &Caller) {
        let Some(id) = self.tokens().note_use(caller) else { return };
        let store = self.inner.store.clone();
        tokio::spawn(async move {
            if let Err(fault) = store.token_used(id, &format!("{:.0}", Timestamp::now())).await {
                tracing::warn!(%fault, "that a token was used could not be kept");
            }
        });
    }

    pub fn list_tokens(&self, to: &Caller) -> Vec<Token> {
        self.tokens().read().iter().map(|known| known.view(to)).collect()
    }

    pub async fn make_token(&self, new: &NewToken, by: &Caller) -> Answer<MadeToken> {
        let name = names::checked("name", &new.name, names::LONGEST_TOKEN_NAME)?;
        if new.access == Access::Open {
            return Err(LabError::Invalid("access: choose full or read".into()));
        }
        let alike = |other: &str| other.to_lowercase() == name.to_lowercase();
        let is_taken = [LOCAL, OPERATOR, OBSERVER].into_iter().any(alike)
            || self.tokens().read().iter().any(|known| alike(&known.caller.name));
        if is_taken {
            return Err(LabError::Invalid(format!("name: {name} already exists, choose another name")));
        }
        let secret = format!("jb_{:032x}{:08x}", rand::random::<u128>(), rand::random::<u32>());
        let record = self.inner.store.save_token(name, &word(new.access), &hash(&secret), &by.name).await?;
        let id = record.id;
        self.tokens().add(record)?;
        tracing::warn!(token = name, access = ?new.access, by = &*by.name, "token made");
        let made = self.list_tokens(by).into_iter().find(|token| token.id == Some(id));
        let token = made.ok_or_else(|| LabError::Conflict(format!("token {name} was revoked immediately")))?;
        Ok(MadeToken { token, secret })
    }

    /// Revokes a token; its open connections are closed.
    pub async fn revoke_token(&self, id: i64, by: &Caller) -> Answer<()> {
        let missing = || LabError::NotFound(format!("token {id} does not exist or is already revoked"));
        let token = self.list_tokens(by).into_iter().find(|token| token.id == Some(id)).ok_or_else(missing)?;
        if token.yours {
            let why = "this token is used by the current session: revoke it with another token";
            return Err(LabError::Conflict(why.into()));
        }
        self.inner.store.revoke_token(id, &by.name).await?;
        self.tokens().write().retain(|known| known.id != Some(id));
        self.tokens().revoked.send_replace(());
        tracing::warn!(token = token.name, by = &*by.name, "token revoked");
        Ok(())
    }

    /// Returns when the token of this caller is revoked.
    pub async fn until_revoked(&self, caller: &Caller) {
        let mut revoked = self.tokens().revoked.subscribe();
        let is_known = || self.tokens().read().iter().any(|known| known.caller.token == caller.token);
        while caller.token.is_none() || is_known() {
            // An error means that the daemon ends.
            if revoked.changed().await.is_err() {
                return;
            }
        }
    }
}

/// Why a token is too easy to guess, or `None`.
pub fn weakness(token: &str) -> Option<String> {
    let different = token.chars().collect::<std::collections::BTreeSet<_>>().len();
    let why = match token.chars().count() {
        length if length < SHORTEST_TOKEN => format!("has {length} characters, fewer than {SHORTEST_TOKEN}"),
        _ if different < FEWEST_CHARACTERS => {
            format!("has {different} different characters, fewer than {FEWEST_CHARACTERS}")
        }
        _ if token.chars().any(|c| !(c.is_ascii_graphic() || c == ' ')) => "contains a non-ASCII character".to_owned(),
        _ => return None,
    };
    Some(format!("{why}: generate one with `openssl rand -hex 24`"))
}

/// Generated tokens are long and random: they cannot be guessed, so an unsalted hash is sufficient.
fn hash(secret: &str) -> [u8; 32] {
    Sha256::digest(secret.as_bytes()).into()
}

#[cfg(test)]
mod tests {
    use super::weakness;

    #[test]
    fn a_weak_token_is_refused_with_a_remedy() {
        for (token, expected) in [
            ("hunter2", "7 characters"),
            ("aaaaaaaaaaaaaaaaaaaaaaaa", "1 different"),
            ("0101010101010101", "2 different"),
            ("correct höorse battery", "non-ASCII"),
        ] {
            let why = weakness(token).unwrap();
            assert!(why.contains(expected) && why.contains("openssl rand"), "{token}: {why}");
        }
        assert_eq!(weakness("correct horse battery"), None);
        assert_eq!(weakness("9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822c"), None);
    }
}
