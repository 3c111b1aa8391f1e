-- Stretches of the runs that a model version was not fitted to, each with the reason that a person gave.

ALTER TABLE models ADD COLUMN excluded TEXT NOT NULL DEFAULT '[]' CHECK (json_valid(excluded));
