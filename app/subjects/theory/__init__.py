"""The equations and the record of validation."""
