"""Clusters of logical nodes on this machine, by Ray's own utility."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from agents.backends.ray_backend import RayBackend
from swarm_gym.errors import MissingExtraError


@contextmanager
def logical_cluster(nodes: int, processors: int) -> Iterator[tuple[RayBackend, Any]]:
    """Nodes of so many processors each, whatever this machine has, beside a head node without any.

    Yields:
        A backend that uses them, and the cluster, `ray.cluster_utils.Cluster`.

    Raises:
        MissingExtraError: if Ray is missing.
    """
    try:
        from ray.cluster_utils import Cluster
    except ImportError as error:
        raise MissingExtraError("a logical cluster", "Ray", "ray") from error
    cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": 0, "include_dashboard": False})
    backend = RayBackend(cluster.address, 0)
    try:
        for _ in range(nodes):
            cluster.add_node(num_cpus=processors)
        yield backend, cluster
    finally:
        backend.close()
        cluster.shutdown()
