-- What a procedure makes of a complete run never changes either: kept is what was worked out of a model version or of a run.
-- What the former table held is worked out anew.

DROP TABLE kept;
CREATE TABLE kept (
    subject  TEXT    NOT NULL CHECK (subject IN ('model', 'run')),
    id       INTEGER NOT NULL,
    what     TEXT    NOT NULL,
    software TEXT    NOT NULL,
    packed   BLOB    NOT NULL,
    PRIMARY KEY (subject, id, what)
) STRICT;
