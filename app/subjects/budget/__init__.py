"""The budget of a design: verdict, sigmas, outage, phase by source."""
