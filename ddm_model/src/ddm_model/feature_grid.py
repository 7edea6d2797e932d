# Draws the background of a feature plane: a grid of features with the image that the model decodes from each feature.
# SPDX-License-Identifier: BSD-3-Clause
from matplotlib.ticker import MaxNLocator
import numpy as np

GRID = 9  # images along each axis, as in the paper
# Greys that stand for 0 and 1 in an image. Features drawn in light or saturated colours stand out against this range.
DARKEST, BRIGHTEST = 0.0, 0.75
# Number of grey levels. More levels are not visible in such small images, and the file is half as large.
LEVELS = 32


class FeatureGrid:
    """GRID x GRID features, evenly spaced over [low_1, high_1] x [low_2, high_2], including the ends.

    Each decoded image has its feature in the middle, so the whole drawing extends half a step beyond the ends.
    """

    def __init__(self, low, high):
        self.z_1 = np.linspace(low[0], high[0], GRID)
        self.z_2 = np.linspace(low[1], high[1], GRID)

    @property
    def features(self):
        """All features (z_1, z_2), row by row from the top left  [GRID^2]."""
        return [(z_1, z_2) for z_2 in self.z_2[::-1] for z_1 in self.z_1]

    @property
    def extent(self):
        """Limits of the drawing: (left, right, bottom, top)."""
        half_1 = (self.z_1[1] - self.z_1[0]) / 2.0
        half_2 = (self.z_2[1] - self.z_2[0]) / 2.0
        return self.z_1[0] - half_1, self.z_1[-1] + half_1, self.z_2[0] - half_2, self.z_2[-1] + half_2

    def draw(self, axes, images):
        """Draws the decoded images of the features. The images stay square even if the ranges of the two axes
        differ."""
        images = [np.asarray(image) for image in images]
        rows = [np.hstack(images[GRID * row:GRID * (row + 1)]) for row in range(GRID)]
        levels = np.vstack(rows) // (256 // LEVELS) / (LEVELS - 1.0)
        mosaic = DARKEST + (BRIGHTEST - DARKEST) * levels
        left, right, bottom, top = self.extent
        axes.imshow(mosaic, cmap="gray", vmin=0.0, vmax=1.0, extent=self.extent, aspect=(right - left) / (top - bottom),
                    interpolation="nearest", zorder=0)
        style = {"colors": "white", "linewidth": 0.3, "alpha": 0.4, "zorder": 0.5}
        axes.vlines(np.linspace(left, right, GRID + 1)[1:-1], bottom, top, **style)
        axes.hlines(np.linspace(bottom, top, GRID + 1)[1:-1], left, right, **style)
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_major_locator(MaxNLocator(nbins=7, steps=[1, 2, 5, 10]))
        axes.set_xlabel("feature $z_1$")
        axes.set_ylabel("feature $z_2$")
