-- What a procedure makes of a run that is over, in a word, for the list of runs: worked out when the run has ended, and again
-- where a page asks for the whole result.

CREATE TABLE verdicts (
    run     INTEGER PRIMARY KEY REFERENCES runs (id),
    verdict TEXT NOT NULL CHECK (verdict IN ('identified', 'inconclusive', 'failed'))
) STRICT;
