-- Notifications: which target wants which events, and one message for each event and target. The triggers write a message in
-- the transaction of its cause, so that no crash loses it; a task of the daemon delivers it.

-- The targets of the bench description, set at each start.
CREATE TABLE notify_targets (
    target TEXT NOT NULL,
    event  TEXT NOT NULL CHECK (event IN ('finished', 'failed', 'unsafe', 'needs_hand')),
    PRIMARY KEY (target, event)
) STRICT, WITHOUT ROWID;

CREATE TABLE notifications (
    id         INTEGER PRIMARY KEY AUTOINCREMENT,
    -- Receivers drop a second delivery by this name. It is random: a restored store may use an id again.
    key        TEXT    NOT NULL UNIQUE DEFAULT (lower(hex(randomblob(16)))),
    target     TEXT    NOT NULL,
    event      TEXT    NOT NULL,
    bench      TEXT    NOT NULL,
    run        INTEGER REFERENCES runs (id),
    reason     TEXT,
    created_at TEXT    NOT NULL DEFAULT (strftime('%Y-%m-%dT%H:%M:%fZ', 'now')),
    due_at     TEXT    NOT NULL DEFAULT (strftime('%Y-%m-%dT%H:%M:%fZ', 'now')),
    -- The same text in every attempt.
    body       TEXT,
    attempts   INTEGER NOT NULL DEFAULT 0,
    state      TEXT    NOT NULL DEFAULT 'pending' CHECK (state IN ('pending', 'delivered', 'failed')),
    error      TEXT,
    ended_at   TEXT
) STRICT;
CREATE INDEX notifications_pending ON notifications (target, id) WHERE state = 'pending';
CREATE INDEX notifications_ended ON notifications (target, state, ended_at);

-- A message about a finished run waits for the verdict, at most two minutes. Imported runs have no message.
CREATE TRIGGER notify_end_of_run AFTER UPDATE OF finished_at ON runs
WHEN OLD.finished_at IS NULL AND NEW.finished_at IS NOT NULL AND NEW.procedure <> 'import' BEGIN
    INSERT INTO notifications (target, event, bench, run, due_at)
    SELECT target, event, NEW.bench, NEW.id,
        strftime('%Y-%m-%dT%H:%M:%fZ', 'now', iif(event = 'finished', '+120 seconds', '+0 seconds'))
    FROM notify_targets WHERE event = iif(NEW.state IN ('failed', 'interrupted'), 'failed', 'finished');
END;

-- The store and the bench both enter an unconfirmed safe state: the first entry has a message. A stopped bench waits for a
-- person, and so does one whose stop has another reason than before.
CREATE TRIGGER notify_block AFTER INSERT ON bench_safety
WHEN NEW.blocked AND NOT EXISTS (
    SELECT 1 FROM bench_safety AS before
    WHERE before.id = (SELECT MAX(id) FROM bench_safety WHERE bench = NEW.bench AND id < NEW.id) AND before.blocked
        AND (NOT before.stopped OR (NEW.stopped AND before.reason = NEW.reason))
) BEGIN
    INSERT INTO notifications (target, event, bench, run, reason)
    SELECT target, event, NEW.bench, NEW.run, NEW.reason
    FROM notify_targets WHERE event = iif(NEW.stopped, 'needs_hand', 'unsafe');
END;

-- A queue that a person paused needs no message.
CREATE TRIGGER notify_paused_queue AFTER INSERT ON queue_pauses WHEN NEW.reason NOT LIKE 'requested by %' BEGIN
    INSERT INTO notifications (target, event, bench, reason)
    SELECT target, event, NEW.bench, 'queue paused: ' || NEW.reason FROM notify_targets WHERE event = 'needs_hand';
END;

-- A run that pauses without a request waits for a person. The last note says what to do.
CREATE TRIGGER notify_waiting_run AFTER INSERT ON events
WHEN NEW.kind = 'state' AND NEW.data ->> '$.state' = 'paused' AND COALESCE((
    SELECT data ->> '$.control' FROM events WHERE run = NEW.run AND kind = 'control' ORDER BY sequence DESC LIMIT 1
), '') <> 'pause' BEGIN
    INSERT INTO notifications (target, event, bench, run, reason)
    SELECT target, event, (SELECT bench FROM runs WHERE id = NEW.run), NEW.run,
        (SELECT data ->> '$.text' FROM events WHERE run = NEW.run AND kind = 'note' ORDER BY sequence DESC LIMIT 1)
    FROM notify_targets WHERE event = 'needs_hand';
END;

CREATE TRIGGER notifications_counted AFTER INSERT ON notifications BEGIN UPDATE store_log SET changes = changes + 1; END;
