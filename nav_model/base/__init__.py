"""What every room uses: units, errors, constants, arrays, files as text, compiled kernels, worker processes."""
