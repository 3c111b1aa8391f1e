//! Tokens, and what they open.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// What a caller may do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Access {
    /// Everything: the daemon answers this computer only, and asks for no token.
    Open,
    /// Everything.
    Full,
    /// Look, and stop.
    Read,
}

/// A token that opens the door of the daemon. Its secret is told once, when it is made.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Token {
    /// `null` for one that the daemon was started with: it is not revoked here.
    pub id: Option<i64>,
    /// What is done with it is kept under this name.
    pub name: String,
    /// `full` or `read`.
    pub access: Access,
    #[schema(format = DateTime)]
    pub made_at: Option<String>,
    pub made_by: Option<String>,
    /// To the minute; of one that the daemon was started with, since then.
    #[schema(format = DateTime)]
    pub used_at: Option<String>,
    /// The question came with it.
    pub yours: bool,
}

#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct NewToken {
    /// Who or what will use it: 1 to 40 characters, and no other token's.
    pub name: String,
    /// `full` or `read`.
    pub access: Access,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MadeToken {
    #[serde(flatten)]
    pub token: Token,
    /// Told this once, and kept nowhere.
    pub secret: String,
}
