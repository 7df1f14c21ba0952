"""What the commands share: arguments, files, output, progress."""
