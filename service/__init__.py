"""Serve maps: identity, time, storage and HTTP around the `semtopo` library, and nothing more."""
