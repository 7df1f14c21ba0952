"""Inverse questions to the closed forms: which sensors are needed, and what to improve.

- `levers`: the changes of a design that engineers have, declared once.
- `closing`: the smallest sets of levers with which a design closes.
- `plan_changes`, `manoeuvre`: turns, aids and units, and which of them would close the lines of a flight.
- `margins`: how far designs are from their requirements, over arrays.
- `solve`: the largest noise, interval or time that still meets each requirement.
- `rank`: exact sensitivities of a figure to every input.
- `trade_map`: two inputs against a figure.
- `search`: catalogue sensors and receiver classes against a radar and its requirements.
- `uncertainty`: the verdict as a probability when inputs are ranges.
- `sweep_plan`, `sweep_flight`, `sweep`: parameter files, in closed form or flown, in parallel, resumed after a crash.
"""
