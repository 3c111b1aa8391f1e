-- How many changes the store holds. The number of the last durable one is written to a file beside the database as well
-- (server/src/store/keeper.rs): a database that holds fewer has lost its write-ahead file, or a part of it.

CREATE TABLE store_log (
    id      INTEGER PRIMARY KEY CHECK (id = 1),
    -- Tells this store from any other.
    store   TEXT    NOT NULL,
    changes INTEGER NOT NULL,
    -- Runs that have ended: a checkpoint follows.
    ended   INTEGER NOT NULL
) STRICT;
INSERT INTO store_log (id, store, changes, ended) VALUES (1, lower(hex(randomblob(8))), 0, 0);

-- Changes that were found missing when the store was opened.
CREATE TABLE store_losses (
    id         INTEGER PRIMARY KEY AUTOINCREMENT,
    first      INTEGER NOT NULL,
    last       INTEGER NOT NULL,
    noticed_at TEXT    NOT NULL
) STRICT;

CREATE TRIGGER runs_begin_counted AFTER INSERT ON runs BEGIN UPDATE store_log SET changes = changes + 1; END;
CREATE TRIGGER runs_go_on_counted AFTER UPDATE OF state, rows, safe, reason ON runs BEGIN
    UPDATE store_log SET changes = changes + 1,
        ended = ended + (OLD.finished_at IS NULL AND NEW.finished_at IS NOT NULL);
END;
CREATE TRIGGER models_counted AFTER INSERT ON models BEGIN UPDATE store_log SET changes = changes + 1; END;
CREATE TRIGGER models_kept_counted AFTER INSERT ON models_kept BEGIN UPDATE store_log SET changes = changes + 1; END;
CREATE TRIGGER diagnoses_counted AFTER INSERT ON diagnoses BEGIN UPDATE store_log SET changes = changes + 1; END;
CREATE TRIGGER bench_safety_counted AFTER INSERT ON bench_safety BEGIN UPDATE store_log SET changes = changes + 1; END;
CREATE TRIGGER notes_counted AFTER INSERT ON notes BEGIN UPDATE store_log SET changes = changes + 1; END;
CREATE TRIGGER calibrations_counted AFTER INSERT ON calibrations BEGIN UPDATE store_log SET changes = changes + 1; END;
CREATE TRIGGER instrument_faults_counted AFTER INSERT ON instrument_faults BEGIN UPDATE store_log SET changes = changes + 1; END;
CREATE TRIGGER own_effects_counted AFTER INSERT ON own_effects BEGIN UPDATE store_log SET changes = changes + 1; END;
CREATE TRIGGER autopilot_steps_counted AFTER INSERT ON autopilot_steps BEGIN UPDATE store_log SET changes = changes + 1; END;
CREATE TRIGGER autopilots_counted AFTER INSERT ON autopilots BEGIN UPDATE store_log SET changes = changes + 1; END;
CREATE TRIGGER tokens_counted AFTER INSERT ON tokens BEGIN UPDATE store_log SET changes = changes + 1; END;
CREATE TRIGGER tags_set_counted AFTER INSERT ON tags BEGIN UPDATE store_log SET changes = changes + 1; END;
CREATE TRIGGER tags_gone_counted AFTER DELETE ON tags BEGIN UPDATE store_log SET changes = changes + 1; END;
CREATE TRIGGER own_effects_gone_counted AFTER DELETE ON own_effects BEGIN UPDATE store_log SET changes = changes + 1; END;
CREATE TRIGGER autopilots_end_counted AFTER UPDATE ON autopilots BEGIN UPDATE store_log SET changes = changes + 1; END;
CREATE TRIGGER tokens_revoked_counted AFTER UPDATE OF revoked_at ON tokens BEGIN UPDATE store_log SET changes = changes + 1; END;
