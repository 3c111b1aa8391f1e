-- A version that somebody made to see what an effect would do is nobody's model either until a person keeps it; what a person
-- keeps is not idle any more.

ALTER TABLE models ADD COLUMN made_to_try INTEGER NOT NULL DEFAULT 0 CHECK (made_to_try IN (0, 1));

CREATE TABLE models_kept (
    model      INTEGER PRIMARY KEY REFERENCES models (id),
    who        TEXT NOT NULL,
    created_at TEXT NOT NULL
) STRICT;

DROP VIEW models_told;
CREATE VIEW models_told AS
SELECT models.*, models_kept.model IS NULL AND made_to_try AS tried, models_kept.model IS NULL AND EXISTS (
    SELECT 1 FROM models AS before
    WHERE before.id = models.parent AND models.added <> '[]' AND before.more_runs = models.more_runs
        AND before.excluded = models.excluded AND models.validation_rms >= 0.995 * before.validation_rms
) AS idle
FROM models LEFT JOIN models_kept ON models_kept.model = models.id;
