"""States at rows of a recording from its readings alone: local cubics through positions and rates."""

import math

import numpy as np

# Rows on either side of a row that a cubic may pass through.
WIDTHS = (4, 6, 9, 13, 19)


def noise(values):
    """The standard deviation of the noise of a smooth signal, from its third differences."""
    third = np.diff(values, 3)
    third = third[np.isfinite(third)]
    return math.sqrt(np.mean(third**2) / 20) if len(third) else math.nan


class Smoothed:
    """A joint's readings, and its position and rate at a row."""

    def __init__(self, times, position, position_noise, rate=None, rate_noise=None):
        self.times, self.position, self.rate = times, position, rate
        self.position_noise = position_noise or noise(position)
        self.rate_noise = rate_noise or (noise(rate) if rate is not None else None)
        errors = {width: self.misfit(width) for width in WIDTHS}
        least = min(errors.values())
        self.width = max(width for width in WIDTHS if errors[width] <= 1.1 * least)

    def fit(self, row, width):
        """Coefficients of a cubic about a row, and the sum of squares that it leaves in its degrees of freedom."""
        near = slice(max(row - width, 0), row + width + 1)
        after = self.times[near] - self.times[row]
        powers = after[:, None] ** np.arange(4)
        rows, values = [powers / self.position_noise], [self.position[near] / self.position_noise]
        if self.rate is not None:
            slopes = np.column_stack([np.zeros_like(after), np.ones_like(after), 2 * after, 3 * after**2])
            rows.append(slopes / self.rate_noise)
            values.append(self.rate[near] / self.rate_noise)
        matrix, right = np.vstack(rows), np.concatenate(values)
        known = np.isfinite(right)
        matrix, right = matrix[known], right[known]
        found = np.linalg.lstsq(matrix, right, rcond=None)[0]
        return found, np.sum((matrix @ found - right) ** 2) / max(len(right) - 4, 1)

    def misfit(self, width):
        """The mean square of what cubics of a width leave, over rows across the recording."""
        rows = np.linspace(width, len(self.times) - width - 1, 60).astype(int)
        return float(np.mean([self.fit(row, width)[1] for row in rows]))

    def at(self, row):
        """Position and rate at a row."""
        found, _ = self.fit(row, self.width)
        return found[0], found[1]


def smoothed(case, table):
    """Joint -> its smoothed readings in a run."""
    times = np.array(table["t"])
    rates = case.measured(".velocity")
    found = {}
    for joint, (column, factor, spread) in case.measured().items():
        position = factor * np.array(table[column])
        rate = rate_noise = None
        if joint in rates:
            column, factor, rate_noise = rates[joint]
            rate = factor * np.array(table[column])
        found[joint] = Smoothed(times, position, spread, rate, rate_noise)
    return found
