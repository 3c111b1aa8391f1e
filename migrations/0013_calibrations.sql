-- Whose result the next runs of a bench use. The newest entry of a procedure holds; the older ones tell its story. Going back is an
-- entry more: to the run of an earlier one, or to none, which leaves it to the last complete run.

CREATE TABLE calibrations (
    id        INTEGER PRIMARY KEY AUTOINCREMENT,
    bench     TEXT    NOT NULL,
    procedure TEXT    NOT NULL,
    run       INTEGER REFERENCES runs (id),
    who       TEXT    NOT NULL,
    at        TEXT    NOT NULL
) STRICT;

CREATE INDEX calibrations_of_bench ON calibrations (bench, id);
CREATE TRIGGER calibrations_stand BEFORE UPDATE ON calibrations BEGIN
    SELECT RAISE(ABORT, 'the record of calibrations is only appended to');
END;
CREATE TRIGGER calibrations_stay BEFORE DELETE ON calibrations BEGIN
    SELECT RAISE(ABORT, 'the record of calibrations is only appended to');
END;
