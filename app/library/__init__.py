"""Saved designs and their reviews, in an embedded SQLite file or a PostgreSQL database.

- `texts`: what people type (names, notes, tags), made safe to keep.
- `schema`: the tables, as numbered steps from nothing to now.
- `engine`: the database under it.
- `store`: designs and their revisions; `reviews`: frozen sets of revisions, comments, decisions, sign-off.
- `exchange`: a library as files, and back.
- `place`: which library this process uses.
"""
