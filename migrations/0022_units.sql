-- The unit under test of a run, and the operator who started the run. Both are set when the run is created and never change.

CREATE TABLE run_units (
    id            INTEGER PRIMARY KEY REFERENCES runs (id),
    serial        TEXT,
    part          TEXT,
    revision      TEXT,
    batch         TEXT,
    operator      TEXT,
    unit_checksum INTEGER,
    CHECK (serial IS NOT NULL OR (part IS NULL AND revision IS NULL AND batch IS NULL))
) STRICT;

CREATE TRIGGER run_units_start BEFORE INSERT ON run_units
WHEN (SELECT started_at FROM runs WHERE id = NEW.id) IS NOT NULL BEGIN
    SELECT RAISE(ABORT, 'the unit of a run is set when the run is created');
END;
CREATE TRIGGER run_units_stand BEFORE UPDATE OF id, serial, part, revision, batch, operator ON run_units BEGIN
    SELECT RAISE(ABORT, 'the unit of a run never changes');
END;
CREATE TRIGGER run_units_sealed_once BEFORE UPDATE OF unit_checksum ON run_units WHEN OLD.unit_checksum IS NOT NULL BEGIN
    SELECT RAISE(ABORT, 'the unit of a run never changes');
END;
CREATE TRIGGER run_units_stay BEFORE DELETE ON run_units BEGIN
    SELECT RAISE(ABORT, 'the unit of a run never changes');
END;

-- The view of 0001 with the unit.
DROP VIEW runs_told;
CREATE VIEW runs_told AS
SELECT runs.*,
    run_units.serial, run_units.part, run_units.revision, run_units.batch, run_units.operator, run_units.unit_checksum,
    (SELECT MAX(to_s) - MIN(from_s) FROM (
        SELECT from_s, to_s FROM spans WHERE run = runs.id UNION ALL SELECT from_s, to_s FROM tail WHERE run = runs.id
    )) AS duration_s,
    lower(bench || ' ' || procedure || ' ' || kind || ' ' || state || ' ' || COALESCE(reason, '') || ' ' || COALESCE(serial, '') || ' '
        || COALESCE(part, '') || ' ' || COALESCE(batch, '') || ' ' || COALESCE(operator, '')) AS words
FROM runs LEFT JOIN run_units ON run_units.id = runs.id;
