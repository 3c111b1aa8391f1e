-- Which bench must not move. The newest entry of a bench holds; the older ones tell its story.

CREATE TABLE bench_safety (
    id      INTEGER PRIMARY KEY AUTOINCREMENT,
    bench   TEXT    NOT NULL,
    blocked INTEGER NOT NULL CHECK (blocked IN (0, 1)),
    reason  TEXT    NOT NULL,
    run     INTEGER REFERENCES runs (id),
    at      TEXT    NOT NULL
) STRICT;

CREATE INDEX bench_safety_of_bench ON bench_safety (bench, id);
CREATE TRIGGER bench_safety_stands BEFORE UPDATE ON bench_safety BEGIN
    SELECT RAISE(ABORT, 'the safety record is only appended to');
END;
CREATE TRIGGER bench_safety_stays BEFORE DELETE ON bench_safety BEGIN
    SELECT RAISE(ABORT, 'the safety record is only appended to');
END;
