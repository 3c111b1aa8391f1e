-- Which users' effects the diagnosis of a run may suggest. The last row of a run and an effect applies; no row: not used.

CREATE TABLE effect_uses (
    id       INTEGER PRIMARY KEY AUTOINCREMENT,
    run      INTEGER NOT NULL REFERENCES runs (id),
    kind     TEXT    NOT NULL,
    effect   TEXT    NOT NULL,
    used     INTEGER NOT NULL CHECK (used IN (0, 1)),
    who      TEXT    NOT NULL,
    at       TEXT    NOT NULL,
    checksum INTEGER
) STRICT;
CREATE INDEX effect_uses_of_run ON effect_uses (run, effect, id);

CREATE TRIGGER effect_uses_stand BEFORE UPDATE OF id, run, kind, effect, used, who, at ON effect_uses BEGIN
    SELECT RAISE(ABORT, 'the record of used effects is only appended to');
END;
CREATE TRIGGER effect_uses_sealed_once BEFORE UPDATE OF checksum ON effect_uses WHEN OLD.checksum IS NOT NULL BEGIN
    SELECT RAISE(ABORT, 'the record of used effects is only appended to');
END;
-- A deleted effect takes its uses along: a new effect with the same id is another one.
CREATE TRIGGER effect_uses_stay BEFORE DELETE ON effect_uses
WHEN EXISTS (SELECT 1 FROM own_effects WHERE kind = OLD.kind AND effect = OLD.effect) BEGIN
    SELECT RAISE(ABORT, 'the record of used effects is only appended to');
END;

CREATE TRIGGER effect_uses_counted AFTER INSERT ON effect_uses BEGIN UPDATE store_log SET changes = changes + 1; END;
