"""Panels, operators and what keeps them up to date; the work is done in core and scene."""
