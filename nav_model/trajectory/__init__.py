"""The covariance along a flight: what the simulator would give with infinitely many runs, by source, smoothed too.

    specification.py  what is asked: CovarianceSpec, the simulator's study with aperture, aiding and their errors
    states.py         the states and sources of the simulator's errors, the same for every flight
    errors.py         their linear model along a flight: nodes, transition, noise of each source, fixes
    covariance.py     covariance(spec): filter, smoother and the share of every source -> TrajectoryResult
    aperture.py       the weights of the image figures, of the errors at the nodes of a flight
    place.py          the place of the image, by the budget's model of it
    result.py         TrajectoryResult and its parts; to_json
    lines.py          the lines of a flight against their limits
    line_length.py    how long a line of a plan may be
    manoeuvre.py      what would close the lines of a plan: manoeuvres, aids and IMUs
    residual.py       what residual biases make of a flight
    plan.py           a flight from waypoints and lines, with coordinated turns
    files             flights from files: plans, recordings

Import from the modules; this one imports nothing.
"""
