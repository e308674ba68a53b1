"""Numbers printed by Brand and Yu, for comparison with ours.

Source: Brand and Yu, "Autonomous robot path optimization using firefly algorithm", ICMLC 2013, table 1: a
grid of 500 x 500 with one obstacle. Where start, goal and obstacle are is in figures only; how many runs is
not stated. Figures 8 and 9, length and time against the size of the grid, have no numbers in the text.
"""

from typing import NamedTuple


class PublishedLength(NamedTuple):
    """A row of table 1 of Brand and Yu: length of the path in cells, and running time in seconds."""

    length: float
    seconds: float


# Table 1 by number of fireflies, of which one begins at the start and the others in a square.
TABLE_1 = {
    10: PublishedLength(449.0, 14.2),
    26: PublishedLength(430.0, 14.3),
    65: PublishedLength(435.0, 18.0),
    122: PublishedLength(447.0, 49.8),
    626: PublishedLength(443.0, 1088.3),
}
# The obstacle of the dynamic example appears after this iteration.
APPEARS = 70
