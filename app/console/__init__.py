"""Shared parts of the commands: arguments, files, output, progress."""
