-- Model versions are a tree that only grows; diagnoses hang on its nodes.

CREATE TABLE models (
    id              INTEGER PRIMARY KEY AUTOINCREMENT,
    run             INTEGER NOT NULL REFERENCES runs (id),
    parent          INTEGER REFERENCES models (id),
    kind            TEXT    NOT NULL,
    effects         TEXT    NOT NULL CHECK (json_valid(effects)),
    added           TEXT    NOT NULL CHECK (json_valid(added)),
    removed         TEXT    NOT NULL CHECK (json_valid(removed)),
    fit             TEXT    NOT NULL CHECK (json_valid(fit)),
    residual        TEXT    NOT NULL,
    rms             REAL    NOT NULL,
    validation_rms  REAL    NOT NULL,
    noise_floor_rms REAL,
    options         TEXT    NOT NULL CHECK (json_valid(options)),
    created_at      TEXT    NOT NULL
) STRICT;

CREATE INDEX models_of_run ON models (run);
CREATE TRIGGER models_stay_in_their_run BEFORE INSERT ON models
WHEN NEW.parent IS NOT NULL AND NOT EXISTS (SELECT 1 FROM models WHERE id = NEW.parent AND run = NEW.run) BEGIN
    SELECT RAISE(ABORT, 'a model version and its parent belong to the same run');
END;
CREATE TRIGGER models_stand BEFORE UPDATE ON models BEGIN SELECT RAISE(ABORT, 'model versions never change'); END;
CREATE TRIGGER models_stay BEFORE DELETE ON models BEGIN SELECT RAISE(ABORT, 'model versions never change'); END;

CREATE TABLE diagnoses (
    id         INTEGER PRIMARY KEY AUTOINCREMENT,
    model      INTEGER NOT NULL REFERENCES models (id),
    diagnosis  TEXT    NOT NULL CHECK (json_valid(diagnosis)),
    created_at TEXT    NOT NULL
) STRICT;

CREATE INDEX diagnoses_of_model ON diagnoses (model);
CREATE TRIGGER diagnoses_stand BEFORE UPDATE ON diagnoses BEGIN SELECT RAISE(ABORT, 'diagnoses never change'); END;
CREATE TRIGGER diagnoses_stay BEFORE DELETE ON diagnoses BEGIN SELECT RAISE(ABORT, 'diagnoses never change'); END;
