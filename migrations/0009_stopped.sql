-- Whether the software stop blocked a bench, which is known to be safe then.

ALTER TABLE bench_safety ADD COLUMN stopped INTEGER NOT NULL DEFAULT 0 CHECK (stopped IN (0, 1));
