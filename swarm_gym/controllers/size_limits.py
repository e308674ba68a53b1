"""Population sizes that an environment allows."""

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class SizeLimits:
    """Population sizes that an environment allows; the defaults are the environments' defaults."""

    smallest: int = 2
    largest: int = 200

    def __post_init__(self) -> None:
        if not 1 <= self.smallest <= self.largest:
            raise ValueError(
                f"population sizes must satisfy 1 <= smallest <= largest, got {self.smallest} and "
                f"{self.largest}"
            )

    def identity(self) -> tuple[int, int]:
        """Return both sizes, as a part of the identity of a controller."""
        return int(self.smallest), int(self.largest)

    def widened(self, *sizes: float) -> "SizeLimits":
        """Return the least limits that allow these sizes, too."""
        smallest, largest = math.floor(min(sizes)), math.ceil(max(sizes))
        return SizeLimits(max(min(self.smallest, smallest), 1), max(self.largest, largest))

    def clip(self, size: int) -> int:
        """Return the nearest allowed size."""
        return min(max(size, self.smallest), self.largest)
