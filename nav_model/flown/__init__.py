"""A flight that was flown, held against the budget."""
