"""The covariance along a flight: what the simulator would give with infinitely many runs, by source, smoothed too.

    specification.py  what is asked: CovarianceSpec, the simulator's study with aperture, aiding and their errors
    states.py         the states and sources of the simulator's errors, the same for every flight
    errors.py         their linear model along a flight: nodes, transition, noise of each source, fixes
    covariance.py     covariance(spec): figures and the share of every source -> TrajectoryResult
    passes.py         its passes along the flight: filter, smoother back, every source forward
    start.py          the covariance of a settled filter, with which a flight begins
    trust.py          sensors whose errors stay longer than the filter assumes
    aperture.py       the weights of the image figures, of the errors at the nodes of a flight
    place.py          the place of the image, by the budget's model of it
    result.py         TrajectoryResult and its parts; to_json
    lines.py          the lines of a flight against their limits
    verdict.py        with_flight(budget): the checks of the flight in the budget's verdict
    line_length.py    the longest line of a plan that holds
    manoeuvre.py      manoeuvres, aids and IMUs that would close the lines of a plan
    residual.py       residual biases along a flight
    plan.py           a flight from waypoints and lines, with coordinated turns
    files             flights from files: plans, recordings

Import from the modules; this one imports nothing.
"""
