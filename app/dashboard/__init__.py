"""The frame around every page: sidebar, tools, tabs."""
