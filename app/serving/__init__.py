"""Serving a team: who may enter, how much a visitor may use, and what the operator sees."""
