"""Questions put the other way round: what would close the design."""
