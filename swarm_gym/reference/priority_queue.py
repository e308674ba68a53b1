"""An indexed binary heap for the searches on grids, in kernels: one entry per node, cheaper ones rise.

Nodes are numbers from 0. The least cost comes first; among equal costs the longer path behind it, which is
nearer to the goal, and then the smaller number. So the order is the same everywhere.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel


class PriorityQueue(NamedTuple):
    """Arrays of the queue; the caller keeps how many entries it has.

    `cost` and `length`, (n,), are the caller's too: it sets them before it enters or raises a node.
    """

    entries: NDArray[np.int64]
    "Nodes in heap order, (n,)."
    places: NDArray[np.int64]
    "Place of a node among the entries, (n,); -1: it is not there."
    cost: NDArray[np.float64]
    "Length so far and estimate of the rest (f), of every node, (n,)."
    length: NDArray[np.float64]
    "Length so far (g), of every node, (n,); infinite: not reached yet."


def make_queue(num_nodes: int) -> PriorityQueue:
    """Allocate an empty queue for nodes 0 to `num_nodes` - 1."""
    return PriorityQueue(
        np.zeros(num_nodes, np.int64),
        np.full(num_nodes, -1, np.int64),
        np.full(num_nodes, np.inf),
        np.full(num_nodes, np.inf),
    )


@kernel
def comes_before(queue: PriorityQueue, a: int, b: int) -> bool:
    """Return whether node a leaves the queue before node b."""
    if queue.cost[a] != queue.cost[b]:
        return queue.cost[a] < queue.cost[b]
    if queue.length[a] != queue.length[b]:
        return queue.length[a] > queue.length[b]
    return a < b


@kernel
def enter(queue: PriorityQueue, size: int, node: int) -> int:
    """Enter a node, or let it rise after it became cheaper; return the new size."""
    place = queue.places[node]
    if place < 0:
        place = size
        size += 1
    while place > 0:
        above = (place - 1) // 2
        other = queue.entries[above]
        if not comes_before(queue, node, other):
            break
        queue.entries[place] = other
        queue.places[other] = place
        place = above
    queue.entries[place] = node
    queue.places[node] = place
    return size


@kernel
def take_first(queue: PriorityQueue, size: int) -> int:
    """Take the first of `size` > 0 nodes out of the queue, and return it."""
    first, last, size = queue.entries[0], queue.entries[size - 1], size - 1
    place = 0
    while 2 * place + 1 < size:
        below = 2 * place + 1
        if below + 1 < size and comes_before(queue, queue.entries[below + 1], queue.entries[below]):
            below += 1
        other = queue.entries[below]
        if comes_before(queue, last, other):
            break
        queue.entries[place] = other
        queue.places[other] = place
        place = below
    queue.entries[place] = last
    queue.places[last] = place
    queue.places[first] = -1
    return first
