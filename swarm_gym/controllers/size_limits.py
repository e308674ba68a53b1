"""Population sizes that an environment allows."""

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

    def clip(self, size: int) -> int:
        """Return the nearest allowed size."""
        return min(max(size, self.smallest), self.largest)
