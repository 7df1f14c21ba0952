"""The commands of `navbudget`, a module each: its arguments, and what it hands to whom.

Nothing heavier than the model is imported before a command needs it.
"""
