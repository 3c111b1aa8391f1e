-- Outcome of the limits of a run, beside the verdict of its procedure. It is computed with the verdict.

ALTER TABLE verdicts ADD COLUMN limits TEXT CHECK (limits IN ('pass', 'marginal', 'fail', 'inconclusive'));
