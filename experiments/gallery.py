"""Draw every optimizer on every kind of map: `python -m experiments.gallery` writes docs/gallery.md.

Rows are the registered optimizers. Columns are one map of each family that needs no files. So additions to
either registry appear by themselves.
"""

from experiments.plots.gallery import write_gallery
from swarm_gym.command import command


def main() -> None:
    """Write the document and its pictures, and delete pictures that are no longer in it."""
    with command(kept="pictures that were drawn are kept"):
        print(write_gallery())


if __name__ == "__main__":
    main()
