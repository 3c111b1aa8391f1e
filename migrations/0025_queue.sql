-- Runs that wait for their bench, and what became of them. The order is priority, then age.

CREATE TABLE queue (
    id         INTEGER PRIMARY KEY AUTOINCREMENT,
    bench      TEXT    NOT NULL,
    -- The first entry of the plan of this entry.
    plan       INTEGER REFERENCES queue (id),
    proceed_if TEXT    NOT NULL,
    request    TEXT    NOT NULL,
    who        TEXT    NOT NULL,
    priority   INTEGER NOT NULL,
    planned_s  REAL    NOT NULL,
    -- Idempotency-Key of the request.
    key        TEXT    UNIQUE,
    state      TEXT    NOT NULL CHECK (state IN ('waiting', 'started', 'failed', 'removed')),
    run        INTEGER REFERENCES runs (id),
    reason     TEXT,
    created_at TEXT    NOT NULL,
    ended_at   TEXT
) STRICT;
CREATE INDEX queue_waiting ON queue (bench, priority DESC, id) WHERE state = 'waiting';
CREATE INDEX queue_of_run ON queue (run);

CREATE TRIGGER queue_request_stands BEFORE UPDATE OF id, bench, proceed_if, request, who, planned_s, key, created_at ON queue BEGIN
    SELECT RAISE(ABORT, 'a queued request never changes');
END;
CREATE TRIGGER queue_counted AFTER INSERT ON queue BEGIN UPDATE store_log SET changes = changes + 1; END;

-- Benches whose queue waits for a person or a script.
CREATE TABLE queue_pauses (
    bench  TEXT PRIMARY KEY,
    reason TEXT NOT NULL,
    at     TEXT NOT NULL
) STRICT;
