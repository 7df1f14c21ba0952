"""As flown: the solution of a real flight against the budget of the design."""
