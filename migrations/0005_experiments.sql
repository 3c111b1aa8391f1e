-- A model version may look at further runs of the same joint beside its own, in order.

ALTER TABLE models ADD COLUMN more_runs TEXT NOT NULL DEFAULT '[]' CHECK (json_valid(more_runs));

-- Chains of measuring, diagnosing and adding, each with what was asked for. Every step stays as it was told.
CREATE TABLE autopilots (
    id          INTEGER PRIMARY KEY AUTOINCREMENT,
    bench       TEXT NOT NULL,
    request     TEXT NOT NULL CHECK (json_valid(request)),
    state       TEXT NOT NULL,
    reason      TEXT,
    created_at  TEXT NOT NULL,
    finished_at TEXT
) STRICT;

CREATE TRIGGER autopilots_stay BEFORE DELETE ON autopilots BEGIN
    SELECT RAISE(ABORT, 'an autopilot is never deleted');
END;
CREATE TRIGGER autopilots_keep_their_request BEFORE UPDATE OF id, bench, request, created_at ON autopilots BEGIN
    SELECT RAISE(ABORT, 'what an autopilot was asked for never changes');
END;
CREATE TRIGGER autopilots_end_once BEFORE UPDATE ON autopilots WHEN OLD.finished_at IS NOT NULL BEGIN
    SELECT RAISE(ABORT, 'an autopilot that is over does not go on');
END;

CREATE TABLE autopilot_steps (
    autopilot INTEGER NOT NULL REFERENCES autopilots (id),
    sequence  INTEGER NOT NULL,
    step      TEXT    NOT NULL CHECK (json_valid(step)),
    PRIMARY KEY (autopilot, sequence)
) STRICT, WITHOUT ROWID;

CREATE TRIGGER autopilot_steps_stand BEFORE UPDATE ON autopilot_steps BEGIN
    SELECT RAISE(ABORT, 'steps of an autopilot never change');
END;
CREATE TRIGGER autopilot_steps_stay BEFORE DELETE ON autopilot_steps BEGIN
    SELECT RAISE(ABORT, 'steps of an autopilot never change');
END;
