-- A version is idle where it has added effects to its parent and takes less than half a percent off the error held out, on
-- the same data: nobody's model until a person chooses it.

CREATE VIEW models_told AS
SELECT models.*, EXISTS (
    SELECT 1 FROM models AS before
    WHERE before.id = models.parent AND models.added <> '[]' AND before.more_runs = models.more_runs
        AND before.excluded = models.excluded AND models.validation_rms >= 0.995 * before.validation_rms
) AS idle
FROM models;
