-- Runs, their journal and their samples. What was measured never changes: triggers refuse it.

CREATE TABLE runs (
    id          INTEGER PRIMARY KEY AUTOINCREMENT,
    bench       TEXT    NOT NULL,
    procedure   TEXT    NOT NULL,
    kind        TEXT    NOT NULL,
    simulated   INTEGER NOT NULL CHECK (simulated IN (0, 1)),
    state       TEXT    NOT NULL,
    safe        TEXT,
    reason      TEXT,
    created_at  TEXT    NOT NULL,
    started_at  TEXT,
    finished_at TEXT,
    rows        INTEGER NOT NULL DEFAULT 0,
    parameters  TEXT    NOT NULL CHECK (json_valid(parameters)),
    provenance  TEXT    NOT NULL CHECK (json_valid(provenance)),
    meta        TEXT    NOT NULL CHECK (json_valid(meta))
) STRICT;

CREATE TRIGGER runs_stay BEFORE DELETE ON runs BEGIN
    SELECT RAISE(ABORT, 'a run is never deleted');
END;
CREATE TRIGGER runs_keep_their_origin
BEFORE UPDATE OF id, bench, procedure, kind, simulated, created_at, parameters, provenance, meta ON runs BEGIN
    SELECT RAISE(ABORT, 'what a run was started with never changes');
END;
CREATE TRIGGER runs_end_once BEFORE UPDATE OF state, rows, finished_at ON runs WHEN OLD.finished_at IS NOT NULL BEGIN
    SELECT RAISE(ABORT, 'a run that is over does not go on');
END;
CREATE TRIGGER runs_explain_themselves_once BEFORE UPDATE OF safe, reason ON runs
WHEN (OLD.safe IS NOT NULL AND NEW.safe IS NOT OLD.safe) OR (OLD.reason IS NOT NULL AND NEW.reason IS NOT OLD.reason) BEGIN
    SELECT RAISE(ABORT, 'how a run ended is written once');
END;

-- The journal. Numbers start at 1 in each run and leave no gap.
CREATE TABLE events (
    id       INTEGER PRIMARY KEY,
    run      INTEGER NOT NULL REFERENCES runs (id),
    sequence INTEGER NOT NULL,
    at_s     REAL    NOT NULL,
    kind     TEXT    NOT NULL,
    data     TEXT    NOT NULL CHECK (json_valid(data)),
    UNIQUE (run, sequence)
) STRICT;

CREATE TRIGGER events_follow BEFORE INSERT ON events
WHEN NEW.sequence <> (SELECT COALESCE(MAX(sequence), 0) + 1 FROM events WHERE run = NEW.run) BEGIN
    SELECT RAISE(ABORT, 'the journal has no gaps');
END;
CREATE TRIGGER events_stand BEFORE UPDATE ON events BEGIN SELECT RAISE(ABORT, 'the journal is only appended to'); END;
CREATE TRIGGER events_stay BEFORE DELETE ON events BEGIN SELECT RAISE(ABORT, 'the journal is only appended to'); END;

CREATE TABLE channels (
    run        INTEGER NOT NULL REFERENCES runs (id),
    place      INTEGER NOT NULL,
    name       TEXT    NOT NULL,
    resolution REAL,
    PRIMARY KEY (run, place),
    UNIQUE (run, name)
) STRICT, WITHOUT ROWID;

CREATE TRIGGER channels_stand BEFORE UPDATE ON channels BEGIN SELECT RAISE(ABORT, 'channels never change'); END;
CREATE TRIGGER channels_stay BEFORE DELETE ON channels BEGIN SELECT RAISE(ABORT, 'channels never change'); END;

-- Samples: one coded column of one channel. `server/src/store/codec` describes `data`.
CREATE TABLE blocks (
    id        INTEGER PRIMARY KEY,
    run       INTEGER NOT NULL REFERENCES runs (id),
    channel   INTEGER NOT NULL,
    first_row INTEGER NOT NULL,
    rows      INTEGER NOT NULL CHECK (rows > 0),
    data      BLOB    NOT NULL,
    UNIQUE (run, channel, first_row)
) STRICT;

CREATE TRIGGER blocks_stand BEFORE UPDATE ON blocks BEGIN SELECT RAISE(ABORT, 'samples never change'); END;
CREATE TRIGGER blocks_stay BEFORE DELETE ON blocks BEGIN SELECT RAISE(ABORT, 'samples never change'); END;

-- The same blocks seen from afar: their time, and smallest and largest values of bins of rows, coarse and fine.
CREATE TABLE spans (
    id        INTEGER PRIMARY KEY,
    run       INTEGER NOT NULL REFERENCES runs (id),
    first_row INTEGER NOT NULL,
    rows      INTEGER NOT NULL CHECK (rows > 0),
    from_s    REAL,
    to_s      REAL,
    coarse    BLOB    NOT NULL,
    fine      BLOB    NOT NULL,
    UNIQUE (run, first_row)
) STRICT;

CREATE TRIGGER spans_stand BEFORE UPDATE ON spans BEGIN SELECT RAISE(ABORT, 'samples never change'); END;
CREATE TRIGGER spans_stay BEFORE DELETE ON spans BEGIN SELECT RAISE(ABORT, 'samples never change'); END;

-- The newest rows of a run, as they were committed, until a block is full. They may only go once blocks hold them.
CREATE TABLE tail (
    id        INTEGER PRIMARY KEY,
    run       INTEGER NOT NULL REFERENCES runs (id),
    first_row INTEGER NOT NULL,
    rows      INTEGER NOT NULL CHECK (rows > 0),
    from_s    REAL,
    to_s      REAL,
    data      BLOB    NOT NULL,
    UNIQUE (run, first_row)
) STRICT;

CREATE TRIGGER tail_stands BEFORE UPDATE ON tail BEGIN SELECT RAISE(ABORT, 'samples never change'); END;
CREATE TRIGGER tail_stays_until_kept BEFORE DELETE ON tail
WHEN OLD.first_row + OLD.rows > (SELECT COALESCE(MAX(first_row + rows), 0) FROM spans WHERE run = OLD.run) BEGIN
    SELECT RAISE(ABORT, 'samples never go before a block holds them');
END;

-- A run as it is told: with the time from its first to its last sample, and everything that a search looks at.
CREATE VIEW runs_told AS
SELECT runs.*,
    (SELECT MAX(to_s) - MIN(from_s) FROM (
        SELECT from_s, to_s FROM spans WHERE run = runs.id UNION ALL SELECT from_s, to_s FROM tail WHERE run = runs.id
    )) AS duration_s,
    lower(bench || ' ' || procedure || ' ' || kind || ' ' || state || ' ' || COALESCE(reason, '')) AS words
FROM runs;
