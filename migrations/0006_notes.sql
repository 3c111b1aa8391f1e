-- What people say about a run. Notes are only appended to; tags come and go.

CREATE TABLE notes (
    id         INTEGER PRIMARY KEY AUTOINCREMENT,
    run        INTEGER NOT NULL REFERENCES runs (id),
    at_s       REAL,
    text       TEXT    NOT NULL CHECK (length(text) > 0),
    created_at TEXT    NOT NULL
) STRICT;

CREATE INDEX notes_of_a_run ON notes (run);
CREATE TRIGGER notes_stand BEFORE UPDATE ON notes BEGIN SELECT RAISE(ABORT, 'notes are only appended to'); END;
CREATE TRIGGER notes_stay BEFORE DELETE ON notes BEGIN SELECT RAISE(ABORT, 'notes are only appended to'); END;

CREATE TABLE tags (
    run INTEGER NOT NULL REFERENCES runs (id),
    tag TEXT    NOT NULL CHECK (length(tag) > 0),
    PRIMARY KEY (run, tag)
) STRICT, WITHOUT ROWID;

CREATE INDEX runs_of_a_tag ON tags (tag);
