"""The faces of the suborbital study: command, and the parts of its page (`app.pages.suborbital`)."""
