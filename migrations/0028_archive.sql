-- The archive: which tables of a run are owed to it, and where they are. A trigger writes what is owed in the transaction that
-- ends the run, so that no crash loses it; a task of the daemon writes the files.

-- The tables that the bench description archives, set at each start.
CREATE TABLE archive_contents (
    content TEXT PRIMARY KEY CHECK (content IN ('means', 'samples'))
) STRICT, WITHOUT ROWID;

CREATE TABLE archive (
    run         INTEGER NOT NULL REFERENCES runs (id),
    content     TEXT    NOT NULL,
    -- `empty`: the run has no such table, `reason` says why.
    state       TEXT    NOT NULL DEFAULT 'owed' CHECK (state IN ('owed', 'archived', 'empty', 'failed')),
    owed_at     TEXT    NOT NULL DEFAULT (strftime('%Y-%m-%dT%H:%M:%fZ', 'now')),
    due_at      TEXT    NOT NULL DEFAULT (strftime('%Y-%m-%dT%H:%M:%fZ', 'now')),
    attempts    INTEGER NOT NULL DEFAULT 0,
    -- Error of the last attempt, or why there is no table.
    reason      TEXT,
    -- The file: folder of the archive, and path inside it.
    folder      TEXT,
    path        TEXT,
    bytes       INTEGER,
    sha256      TEXT,
    archived_at TEXT,
    -- The samples in the store are removed from here on.
    dropped_at  TEXT,
    -- The result at that moment as JSON, packed: it cannot be computed again.
    result      BLOB,
    PRIMARY KEY (run, content),
    CHECK (state <> 'archived' OR (folder IS NOT NULL AND path IS NOT NULL AND bytes IS NOT NULL AND sha256 IS NOT NULL
        AND archived_at IS NOT NULL)),
    CHECK (dropped_at IS NULL OR (content = 'samples' AND state = 'archived'))
) STRICT, WITHOUT ROWID;
CREATE INDEX archive_owed ON archive (due_at) WHERE state = 'owed';

-- Imported runs are files already.
CREATE TRIGGER archive_end_of_run AFTER UPDATE OF finished_at ON runs
WHEN OLD.finished_at IS NULL AND NEW.finished_at IS NOT NULL AND NEW.procedure <> 'import' BEGIN
    INSERT INTO archive (run, content) SELECT NEW.id, content FROM archive_contents;
END;

CREATE TRIGGER archive_stands BEFORE UPDATE OF run, content, state, folder, path, bytes, sha256, archived_at ON archive
WHEN OLD.state = 'archived' BEGIN
    SELECT RAISE(ABORT, 'an archived table never changes');
END;
CREATE TRIGGER archive_dropped_once BEFORE UPDATE OF dropped_at, result ON archive WHEN OLD.dropped_at IS NOT NULL BEGIN
    SELECT RAISE(ABORT, 'samples are dropped once');
END;
CREATE TRIGGER archive_stays BEFORE DELETE ON archive WHEN OLD.state = 'archived' BEGIN
    SELECT RAISE(ABORT, 'an archived table never changes');
END;

-- Samples may be removed only after they are archived, and marked as dropped.
DROP TRIGGER blocks_stay;
CREATE TRIGGER blocks_stay BEFORE DELETE ON blocks
WHEN NOT EXISTS (SELECT 1 FROM archive WHERE run = OLD.run AND content = 'samples' AND dropped_at IS NOT NULL) BEGIN
    SELECT RAISE(ABORT, 'samples never change');
END;

CREATE TRIGGER archive_owed_counted AFTER INSERT ON archive BEGIN UPDATE store_log SET changes = changes + 1; END;
CREATE TRIGGER archive_counted AFTER UPDATE OF state, dropped_at ON archive BEGIN
    UPDATE store_log SET changes = changes + 1;
END;
