"""Saved designs and their reviews, in an embedded SQLite file or a PostgreSQL database.

- `texts`: user texts (names, notes, tags), checked and cleaned for storage.
- `schema`: the tables, as numbered migration steps.
- `engine`: the database under it.
- `store`: designs and their revisions; `reviews`: frozen sets of revisions, comments, decisions, sign-off.
- `exchange`: a library as files, and back.
- `place`: which library this process uses.
"""
