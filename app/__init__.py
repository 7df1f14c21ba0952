"""The faces of NavBudget: command line, dashboard and reports. Holds no formula."""
