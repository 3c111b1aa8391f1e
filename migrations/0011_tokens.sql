-- Tokens that were made while the daemon ran, beside those that it was started with. Of a secret only its hash is kept. A token
-- that was revoked stays: what was done with it names it.

CREATE TABLE tokens (
    id         INTEGER PRIMARY KEY AUTOINCREMENT,
    name       TEXT NOT NULL COLLATE NOCASE CHECK (length(name) > 0),
    access     TEXT NOT NULL CHECK (access IN ('full', 'read')),
    hash       BLOB NOT NULL UNIQUE CHECK (length(hash) = 32),
    made_at    TEXT NOT NULL,
    made_by    TEXT NOT NULL,
    used_at    TEXT,
    revoked_at TEXT,
    revoked_by TEXT
) STRICT;

CREATE UNIQUE INDEX tokens_by_name ON tokens (name) WHERE revoked_at IS NULL;
CREATE TRIGGER tokens_stay BEFORE DELETE ON tokens BEGIN SELECT RAISE(ABORT, 'a token is revoked, never deleted'); END;
CREATE TRIGGER tokens_stand BEFORE UPDATE OF id, name, access, hash, made_at, made_by ON tokens BEGIN
    SELECT RAISE(ABORT, 'a token never changes');
END;
CREATE TRIGGER tokens_are_revoked_once BEFORE UPDATE ON tokens WHEN OLD.revoked_at IS NOT NULL BEGIN
    SELECT RAISE(ABORT, 'a token that was revoked opens nothing any more');
END;
