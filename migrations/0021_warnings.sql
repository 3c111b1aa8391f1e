-- A result may be identified with a warning. Verdicts are worked out again where none is kept.

DROP TABLE verdicts;

CREATE TABLE verdicts (
    run     INTEGER PRIMARY KEY REFERENCES runs (id),
    verdict TEXT NOT NULL CHECK (verdict IN ('identified', 'identified_with_warning', 'inconclusive', 'failed'))
) STRICT;
