"""The user interfaces of NavBudget: command line, dashboard and reports. No formulas here."""
