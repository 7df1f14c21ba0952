"""Random tables for the inputs of a design that are tables."""

from hypothesis import strategies as st

from nav_model.design.rows import MOST_ROWS, Rows


def rows_of(declaration: Rows, most: int = MOST_ROWS) -> st.SearchStrategy[tuple[tuple[float, float, str], ...]]:
    """Strategy: any value of a table, up to this many rows."""
    frequency, amount = st.floats(1e-3, 1e6), st.floats(1e-12, 10.0)
    if not declaration.curve:
        kinds = st.sampled_from(declaration.dimensions)
        return st.lists(st.tuples(frequency, amount | st.just(0.0), kinds), max_size=most).map(tuple)

    def table(kind: str, rows: dict[float, float]) -> tuple[tuple[float, float, str], ...]:
        return tuple((at, rows[at], kind) for at in sorted(rows)) if len(rows) > 1 else ()

    rows = st.dictionaries(frequency, amount, max_size=most)
    return st.builds(table, st.sampled_from(declaration.dimensions), rows)
