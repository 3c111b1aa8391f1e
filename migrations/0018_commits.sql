-- How many commits of the worker a run holds: a commit that comes twice is stored once.

ALTER TABLE runs ADD COLUMN commits INTEGER NOT NULL DEFAULT 0;
