"""Occupancy grids: drawn by hand, and of any kind for Hypothesis."""

import numpy as np
from hypothesis import strategies as st


def frozen(blocked):
    """Make an array read-only, as the cells of maps are: kernels are compiled again for one that is not."""
    blocked.flags.writeable = False
    return blocked


def grid(*rows):
    """Blocked cells, of rows of characters: # is blocked."""
    return frozen(np.array([[character == "#" for character in row] for row in rows]))


@st.composite
def grids(draw, most=7):
    """Small grids, each cell of which is blocked or free."""
    width, height = draw(st.integers(1, most)), draw(st.integers(1, most))
    cells = draw(st.lists(st.booleans(), min_size=width * height, max_size=width * height))
    return frozen(np.array(cells).reshape(height, width))
