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

/// An access token of the daemon. Its secret is returned once, at its creation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Token {
    /// `null` for a token of the command line, which cannot be revoked here.
    pub id: Option<i64>,
    /// Actions are logged under this name.
    pub name: String,
    /// `full` or `read`.
    pub access: Access,
    #[schema(format = DateTime)]
    pub made_at: Option<String>,
    pub made_by: Option<String>,
    /// To the minute; for a token of the command line since the start of the daemon.
    #[schema(format = DateTime)]
    pub used_at: Option<String>,
    /// It is the token of the request.
    pub yours: bool,
}

#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct NewToken {
    /// User or script, 1 to 40 characters, unique.
    pub name: String,
    /// `full` or `read`.
    pub access: Access,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MadeToken {
    #[serde(flatten)]
    pub token: Token,
    /// Returned only once and not stored.
    pub secret: String,
}
