"""Monte Carlo of the design, compared with its closed forms."""
