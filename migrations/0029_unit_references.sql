-- Reference units, which are measured to check the bench: the statistics over units exclude them. The last row of a serial number
-- applies; no row: no reference.

CREATE TABLE unit_references (
    id           INTEGER PRIMARY KEY AUTOINCREMENT,
    serial       TEXT    NOT NULL,
    is_reference INTEGER NOT NULL CHECK (is_reference IN (0, 1)),
    who          TEXT    NOT NULL,
    at           TEXT    NOT NULL,
    checksum     INTEGER
) STRICT;
CREATE INDEX unit_references_of_unit ON unit_references (serial, id);

CREATE TRIGGER unit_references_stand BEFORE UPDATE OF id, serial, is_reference, who, at ON unit_references BEGIN
    SELECT RAISE(ABORT, 'the record of reference units is only appended to');
END;
CREATE TRIGGER unit_references_sealed_once BEFORE UPDATE OF checksum ON unit_references WHEN OLD.checksum IS NOT NULL BEGIN
    SELECT RAISE(ABORT, 'the record of reference units is only appended to');
END;
CREATE TRIGGER unit_references_stay BEFORE DELETE ON unit_references BEGIN
    SELECT RAISE(ABORT, 'the record of reference units is only appended to');
END;

CREATE TRIGGER unit_references_counted AFTER INSERT ON unit_references BEGIN UPDATE store_log SET changes = changes + 1; END;
