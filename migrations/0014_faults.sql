-- What was wrong with the instruments of a bench, and when: it stays known when the daemon is started again.

CREATE TABLE instrument_faults (
    id         INTEGER PRIMARY KEY AUTOINCREMENT,
    bench      TEXT NOT NULL,
    instrument TEXT NOT NULL,
    text       TEXT NOT NULL,
    at         TEXT NOT NULL
) STRICT;

CREATE INDEX instrument_faults_of_bench ON instrument_faults (bench, instrument, id);
CREATE TRIGGER instrument_faults_stand BEFORE UPDATE ON instrument_faults BEGIN
    SELECT RAISE(ABORT, 'the record of faults is only appended to');
END;
CREATE TRIGGER instrument_faults_stay BEFORE DELETE ON instrument_faults BEGIN
    SELECT RAISE(ABORT, 'the record of faults is only appended to');
END;
