-- Effects that users write. A definition never changes: the same id again is its next version. Models hold the
-- definitions that they were fitted with.

CREATE TABLE own_effects (
    id         INTEGER PRIMARY KEY AUTOINCREMENT,
    kind       TEXT    NOT NULL,
    effect     TEXT    NOT NULL,
    version    INTEGER NOT NULL,
    definition TEXT    NOT NULL CHECK (json_valid(definition)),
    created_at TEXT    NOT NULL,
    UNIQUE (kind, effect, version)
) STRICT;

CREATE TRIGGER own_effects_stand BEFORE UPDATE ON own_effects BEGIN
    SELECT RAISE(ABORT, 'a definition never changes: the next version is another row');
END;
CREATE TRIGGER own_effects_stay_while_used BEFORE DELETE ON own_effects
WHEN EXISTS (
    SELECT 1 FROM models, json_each(models.fit, '$.own') AS own
    WHERE models.kind = OLD.kind AND json_extract(own.value, '$.id') = OLD.effect
) BEGIN
    SELECT RAISE(ABORT, 'a model uses this effect');
END;
