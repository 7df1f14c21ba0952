"""What a page or a report is made of, as plain data, and its renderers."""
