-- A checksum (CRC-32) beside what it covers: server/src/store/seal.rs says of which columns. Rows of an older release have
-- none until the background check of the daemon gives them one; that is the only change which these tables allow.

ALTER TABLE events ADD COLUMN checksum INTEGER;
DROP TRIGGER events_stand;
CREATE TRIGGER events_stand BEFORE UPDATE OF id, run, sequence, at_s, kind, data ON events BEGIN
    SELECT RAISE(ABORT, 'the journal is only appended to');
END;
CREATE TRIGGER events_sealed_once BEFORE UPDATE OF checksum ON events WHEN OLD.checksum IS NOT NULL BEGIN
    SELECT RAISE(ABORT, 'the journal is only appended to');
END;

ALTER TABLE channels ADD COLUMN checksum INTEGER;
DROP TRIGGER channels_stand;
CREATE TRIGGER channels_stand BEFORE UPDATE OF run, place, name, resolution ON channels BEGIN
    SELECT RAISE(ABORT, 'channels never change');
END;
CREATE TRIGGER channels_sealed_once BEFORE UPDATE OF checksum ON channels WHEN OLD.checksum IS NOT NULL BEGIN
    SELECT RAISE(ABORT, 'channels never change');
END;

ALTER TABLE blocks ADD COLUMN checksum INTEGER;
DROP TRIGGER blocks_stand;
CREATE TRIGGER blocks_stand BEFORE UPDATE OF id, run, channel, first_row, rows, data ON blocks BEGIN
    SELECT RAISE(ABORT, 'samples never change');
END;
CREATE TRIGGER blocks_sealed_once BEFORE UPDATE OF checksum ON blocks WHEN OLD.checksum IS NOT NULL BEGIN
    SELECT RAISE(ABORT, 'samples never change');
END;

ALTER TABLE tail ADD COLUMN checksum INTEGER;
DROP TRIGGER tail_stands;
CREATE TRIGGER tail_stands BEFORE UPDATE OF id, run, first_row, rows, from_s, to_s, data ON tail BEGIN
    SELECT RAISE(ABORT, 'samples never change');
END;
CREATE TRIGGER tail_sealed_once BEFORE UPDATE OF checksum ON tail WHEN OLD.checksum IS NOT NULL BEGIN
    SELECT RAISE(ABORT, 'samples never change');
END;

ALTER TABLE models ADD COLUMN checksum INTEGER;
DROP TRIGGER models_stand;
CREATE TRIGGER models_stand BEFORE UPDATE OF id, run, parent, kind, effects, added, removed, fit, residual, rms, validation_rms, noise_floor_rms, options, created_at,
    more_runs, excluded, who, made_to_try ON models BEGIN
    SELECT RAISE(ABORT, 'model versions never change');
END;
CREATE TRIGGER models_sealed_once BEFORE UPDATE OF checksum ON models WHEN OLD.checksum IS NOT NULL BEGIN
    SELECT RAISE(ABORT, 'model versions never change');
END;

ALTER TABLE diagnoses ADD COLUMN checksum INTEGER;
DROP TRIGGER diagnoses_stand;
CREATE TRIGGER diagnoses_stand BEFORE UPDATE OF id, model, diagnosis, created_at ON diagnoses BEGIN
    SELECT RAISE(ABORT, 'diagnoses never change');
END;
CREATE TRIGGER diagnoses_sealed_once BEFORE UPDATE OF checksum ON diagnoses WHEN OLD.checksum IS NOT NULL BEGIN
    SELECT RAISE(ABORT, 'diagnoses never change');
END;

ALTER TABLE bench_safety ADD COLUMN checksum INTEGER;
DROP TRIGGER bench_safety_stands;
CREATE TRIGGER bench_safety_stands BEFORE UPDATE OF id, bench, blocked, reason, run, at, stopped, who ON bench_safety BEGIN
    SELECT RAISE(ABORT, 'the safety record is only appended to');
END;
CREATE TRIGGER bench_safety_sealed_once BEFORE UPDATE OF checksum ON bench_safety WHEN OLD.checksum IS NOT NULL BEGIN
    SELECT RAISE(ABORT, 'the safety record is only appended to');
END;

ALTER TABLE notes ADD COLUMN checksum INTEGER;
DROP TRIGGER notes_stand;
CREATE TRIGGER notes_stand BEFORE UPDATE OF id, run, at_s, text, created_at ON notes BEGIN
    SELECT RAISE(ABORT, 'notes are only appended to');
END;
CREATE TRIGGER notes_sealed_once BEFORE UPDATE OF checksum ON notes WHEN OLD.checksum IS NOT NULL BEGIN
    SELECT RAISE(ABORT, 'notes are only appended to');
END;

ALTER TABLE calibrations ADD COLUMN checksum INTEGER;
DROP TRIGGER calibrations_stand;
CREATE TRIGGER calibrations_stand BEFORE UPDATE OF id, bench, procedure, run, who, at ON calibrations BEGIN
    SELECT RAISE(ABORT, 'the record of calibrations is only appended to');
END;
CREATE TRIGGER calibrations_sealed_once BEFORE UPDATE OF checksum ON calibrations WHEN OLD.checksum IS NOT NULL BEGIN
    SELECT RAISE(ABORT, 'the record of calibrations is only appended to');
END;

ALTER TABLE instrument_faults ADD COLUMN checksum INTEGER;
DROP TRIGGER instrument_faults_stand;
CREATE TRIGGER instrument_faults_stand BEFORE UPDATE OF id, bench, instrument, text, at ON instrument_faults BEGIN
    SELECT RAISE(ABORT, 'the record of faults is only appended to');
END;
CREATE TRIGGER instrument_faults_sealed_once BEFORE UPDATE OF checksum ON instrument_faults WHEN OLD.checksum IS NOT NULL BEGIN
    SELECT RAISE(ABORT, 'the record of faults is only appended to');
END;

ALTER TABLE own_effects ADD COLUMN checksum INTEGER;
DROP TRIGGER own_effects_stand;
CREATE TRIGGER own_effects_stand BEFORE UPDATE OF id, kind, effect, version, definition, created_at ON own_effects BEGIN
    SELECT RAISE(ABORT, 'a definition never changes: the next version is another row');
END;
CREATE TRIGGER own_effects_sealed_once BEFORE UPDATE OF checksum ON own_effects WHEN OLD.checksum IS NOT NULL BEGIN
    SELECT RAISE(ABORT, 'a definition never changes: the next version is another row');
END;

ALTER TABLE autopilot_steps ADD COLUMN checksum INTEGER;
DROP TRIGGER autopilot_steps_stand;
CREATE TRIGGER autopilot_steps_stand BEFORE UPDATE OF autopilot, sequence, step ON autopilot_steps BEGIN
    SELECT RAISE(ABORT, 'steps of an autopilot never change');
END;
CREATE TRIGGER autopilot_steps_sealed_once BEFORE UPDATE OF checksum ON autopilot_steps WHEN OLD.checksum IS NOT NULL BEGIN
    SELECT RAISE(ABORT, 'steps of an autopilot never change');
END;

-- A picture reads the ends, the coarse or the fine values: each has a checksum of its own.
ALTER TABLE spans ADD COLUMN checksum INTEGER;
ALTER TABLE spans ADD COLUMN coarse_checksum INTEGER;
ALTER TABLE spans ADD COLUMN fine_checksum INTEGER;
DROP TRIGGER spans_stand;
CREATE TRIGGER spans_stand BEFORE UPDATE OF id, run, first_row, rows, from_s, to_s, coarse, fine ON spans BEGIN
    SELECT RAISE(ABORT, 'samples never change');
END;
CREATE TRIGGER spans_sealed_once BEFORE UPDATE OF checksum, coarse_checksum, fine_checksum ON spans
WHEN (OLD.checksum IS NOT NULL AND NEW.checksum IS NOT OLD.checksum)
    OR (OLD.coarse_checksum IS NOT NULL AND NEW.coarse_checksum IS NOT OLD.coarse_checksum)
    OR (OLD.fine_checksum IS NOT NULL AND NEW.fine_checksum IS NOT OLD.fine_checksum) BEGIN
    SELECT RAISE(ABORT, 'samples never change');
END;

-- A run has two: what it was started with never changes, its state does until it is over.
ALTER TABLE runs ADD COLUMN checksum INTEGER;
ALTER TABLE runs ADD COLUMN state_checksum INTEGER;
CREATE TRIGGER runs_sealed_once BEFORE UPDATE OF checksum ON runs WHEN OLD.checksum IS NOT NULL BEGIN
    SELECT RAISE(ABORT, 'what a run was started with never changes');
END;

-- May be worked out anew at any time.
ALTER TABLE kept ADD COLUMN checksum INTEGER;
