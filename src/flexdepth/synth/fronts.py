"""The measures that what is on a facade has in common."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Front:
    """The measures of a facade.

    Attributes:
        width: Metres.
        storey: Height of one floor, metres.
        storeys: How many.
        bays: Windows in a row.
        lit: Share of windows with light behind them.
    """

    width: float
    storey: float
    storeys: int
    bays: int
    lit: float

    @property
    def height(self) -> float:
        """Metres up to the roof."""
        return self.storey * self.storeys

    def middle(self, bay: int) -> float:
        """Return x in the middle of a bay."""
        return (bay + 0.5) * self.width / self.bays - self.width / 2
