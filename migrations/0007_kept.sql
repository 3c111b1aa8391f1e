-- What was worked out of a model version and its runs, which never change: kept because that takes long. It may be thrown
-- away at any time; another release of the software works it out anew.

CREATE TABLE kept (
    model    INTEGER NOT NULL REFERENCES models (id),
    what     TEXT    NOT NULL,
    software TEXT    NOT NULL,
    packed   BLOB    NOT NULL,
    PRIMARY KEY (model, what)
) STRICT;
