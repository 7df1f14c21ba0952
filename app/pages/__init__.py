"""One file per page. A page is built once for a session, then shown budgets while it is the one in view."""
