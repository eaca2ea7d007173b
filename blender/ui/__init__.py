"""Panels, operators and the timer that updates them. `core` and `scene` do the work."""
