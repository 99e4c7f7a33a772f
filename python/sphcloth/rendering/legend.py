"""A scale of colors, and its drawing in the corner of a picture."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib import colormaps
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

COLOR_MAP = "viridis"
# of the picture's height: bar, its distance from the corner, and text
BAR_WIDTH, BAR_HEIGHT, MARGIN, TEXT = 0.22, 0.018, 0.04, 0.026


@dataclass(frozen=True)
class Scale:
    """The values at the two ends of the colors.

    Attributes:
        name: what is shown.
        low: the value of the first color.
        high: that of the last one.
    """

    name: str
    low: float
    high: float

    def shades(self, values: NDArray) -> NDArray[np.float64]:
        """Return the sRGB colors of values, shape (N, 4)."""
        return colormaps[COLOR_MAP]((values - self.low) / (self.high - self.low))


def add_scale(picture: NDArray[np.uint8], scale: Scale) -> NDArray[np.uint8]:
    """Return a picture, shape (height, width, 3), with a bar of the colors and their values."""
    image = Image.fromarray(picture)
    height = image.height
    left, bottom = int(MARGIN * height), int((1 - MARGIN) * height)
    width, thick = max(int(BAR_WIDTH * height), 8), max(int(BAR_HEIGHT * height), 2)
    shades = scale.shades(np.linspace(scale.low, scale.high, width))[:, :3]
    bar = np.broadcast_to(np.round(255 * shades).astype(np.uint8), (thick, width, 3))
    image.paste(Image.fromarray(np.ascontiguousarray(bar)), (left, bottom - thick))
    pen, font = ImageDraw.Draw(image), ImageFont.load_default(max(int(TEXT * height), 8))
    ink, above = (40, 44, 52), bottom - thick - 0.3 * TEXT * height
    pen.text((left, above), f"{scale.low:.3g}", ink, font, anchor="ls")
    pen.text((left + width, above), f"{scale.high:.3g}", ink, font, anchor="rs")
    pen.text((left + width + thick, bottom), scale.name, ink, font, anchor="ls")
    return np.asarray(image)
