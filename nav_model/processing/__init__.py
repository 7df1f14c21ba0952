"""Post-processing: the smoothed error, sources as spectra, and image location errors.

The smoothed error of an aperture, in this order: `flight` has the settled filter before a moment and the information
of later fixes; `stretch` joins stretches between fixes, each with the Legendre coefficients of its position error;
`smoother` reads the figures of the aperture from these, a row for each design.

Fast sources: `fast_motion` integrates lines and spectra through `aperture_filter` (the aperture as a filter) and
`compensation` (what an IMU's delay and bandwidth leave); `paired_echo` has their echoes and scattered energy.
The image: `geolocation` turns errors of position and slope into shifts, CE90 and LE90.

Derivations: docs/processing.md. The oracles, batch least squares and spectra, are in the tests.
"""
