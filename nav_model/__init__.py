"""Navigation error budgets: the physics, without any screen."""
