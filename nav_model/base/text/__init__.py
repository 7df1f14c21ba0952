"""Readers of text and files that others wrote, with sizes limited before anything is parsed.

`toml_text`, `csv_text` (the one writer), `number_table` (columns of numbers), `npz_arrays`; `file_kind` tells a file
by its first bytes, `column_names` and `unit_text` read the names of columns and units.
"""
