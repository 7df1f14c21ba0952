"""Our own widgets and styles."""
