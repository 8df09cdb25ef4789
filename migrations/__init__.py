"""The history of the database schema; applied by `semtopo serve` when it starts."""
