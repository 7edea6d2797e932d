# The background of a feature plane: a grid of features, and at each the image that the model decodes from it.
# SPDX-License-Identifier: BSD-3-Clause
from matplotlib.ticker import MaxNLocator
import numpy as np

GRID = 9  # images along each axis, as in the paper
DARKEST, BRIGHTEST = 0.0, 0.75  # grey of an image's 0 and 1: features drawn in light and in full colours stand out
LEVELS = 32  # of grey: the eye sees no more in images as small as these, and the file is half as large


class FeatureGrid:
    """GRID x GRID features, evenly spaced over [low_1, high_1] x [low_2, high_2], ends included.

    Each image is drawn around its feature, so that the picture reaches half a step beyond the ends.
    """

    def __init__(self, low, high):
        self.z_1 = np.linspace(low[0], high[0], GRID)
        self.z_2 = np.linspace(low[1], high[1], GRID)

    @property
    def features(self):
        """All (z_1, z_2), row by row from the top left as one reads."""
        return [(z_1, z_2) for z_2 in self.z_2[::-1] for z_1 in self.z_1]

    @property
    def extent(self):
        """(left, right, bottom, top) of the picture."""
        half_1 = (self.z_1[1] - self.z_1[0]) / 2.0
        half_2 = (self.z_2[1] - self.z_2[0]) / 2.0
        return self.z_1[0] - half_1, self.z_1[-1] + half_1, self.z_2[0] - half_2, self.z_2[-1] + half_2

    def draw(self, axes, images):
        """Draws the images of the features. The scales of the axes differ if the ranges do: the images stay square."""
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
        axes.set_xlabel("feature $z_1$ [-]")
        axes.set_ylabel("feature $z_2$ [-]")
