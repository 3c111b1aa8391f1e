-- Values of the quantities that a procedure identified, by which the list of runs can be sorted. They are computed with
-- the verdict, and once more for runs whose verdict is older than this table.

CREATE TABLE run_quantities (
    run   INTEGER NOT NULL REFERENCES runs (id),
    name  TEXT NOT NULL,
    value REAL NOT NULL,
    PRIMARY KEY (run, name)
) STRICT, WITHOUT ROWID;

ALTER TABLE verdicts ADD COLUMN with_quantities INTEGER NOT NULL DEFAULT 0 CHECK (with_quantities IN (0, 1));
