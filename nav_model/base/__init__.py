"""Foundations of every room, without a word about navigation.

Quantities: `units` (text <-> SI), `dimensions` (kinds of quantity, their units and statements of accuracy),
`constants`.
Arrays: `arrays`, `sampling` (time stamps), `traced` (numbers that remember their formula), `frozen` (mappings).
Running: `compiled` and `numba_typing` (kernels), `processes` (workers). Bad input: `errors`.
The readers of text and files are in `text`.
"""
