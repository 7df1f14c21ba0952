"""The content of pages and reports as plain data, and its renderers."""
