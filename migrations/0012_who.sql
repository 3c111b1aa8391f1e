-- Who stopped and reset a bench, and who made a model version: the name of a token, or `local`. What was kept before does not tell.

ALTER TABLE bench_safety ADD COLUMN who TEXT;
ALTER TABLE models ADD COLUMN who TEXT;
