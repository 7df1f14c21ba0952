"""The subjects a person comes for, a room each: page, charts, tables, command, report section."""
