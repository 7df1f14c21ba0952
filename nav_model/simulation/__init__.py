"""The simulator: a strapdown INS with a closed-loop Kalman filter, flown many times.

It confirms the closed forms of `nav_model.analytic` as the source paper does, and covers effects that they omit.
Import from the modules; this one imports nothing, so that the commands start fast.

    specification.py    what a study is: SimulationSpec and its parts, in SI, checked
    trajectory.py       the flights, laid on the Earth as one spline
    truth.py            what perfect instruments on a trajectory measure
    sensors.py          what real ones report
    strapdown.py        the mechanisation: increments -> position, velocity, attitude
    kalman.py           the error-state filter: transition, propagation, update, NEES
    fixes.py            one GNSS fix: receiver noise, update, correction of the INS
    schedule.py         when fixes come and results are kept, the same for every run of a study
    single_run.py       fly(spec, run): one flight; fly_without_errors(spec): covariance along the true path
    statistics.py       sums over runs, in memory that does not grow with them
    monte_carlo.py      simulate(spec, ...): all the runs, here, in a pool or on a cluster (cluster.py)
    result.py           SimulationResult: rms, sigmas, percentiles, consistency; to_json, to_arrays, to_csv
    design_study.py     Design -> SimulationSpec, and a study beside the closed forms of its design
    departures.py       where closed form and simulation differ, and why
    conditions.py       how the simulated world differs from that of the closed forms

Reading order for a newcomer: specification, single_run, then whichever part is in question. Everything is
north-east-down; errors are estimate minus truth.
"""
