"""Colors of a picture, and how they become what is written: a tone curve, then sRGB."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sphcloth.rendering.camera import Camera

# samples along a side of a pixel
SAMPLES = 2
# what a thread works on at a time, and threads
PART, THREADS = 8192, 2
EXPOSURE = 0.72


def in_parts(work: Callable[[slice], None], total: int) -> None:
    """Do work on parts of a range, small enough for their arrays to stay in the cache."""
    parts = [slice(start, min(start + PART, total)) for start in range(0, total, PART)]
    with ThreadPoolExecutor(THREADS) as pool:
        list(pool.map(work, parts))


def sampled(values: NDArray, camera: Camera) -> NDArray:
    """Repeat the values of pixels, shape (P,), for all their samples, by rows of these."""
    return values.reshape(camera.shape).repeat(SAMPLES, 0).repeat(SAMPLES, 1).ravel()


@dataclass(frozen=True)
class Canvas:
    """Linear colors: of pixels, and of all samples of those pixels in which something is drawn.

    Attributes:
        camera: of the picture.
        ground: what is behind all, shape (P, 3).
        place: where the samples of a pixel begin, -1 for a pixel without, shape (P,).
        samples: shape (S, 3).
    """

    camera: Camera
    ground: NDArray[np.float32]
    place: NDArray[np.int32]
    samples: NDArray[np.float32]

    @classmethod
    def of(
        cls, camera: Camera, ground: NDArray[np.float32], drawn: Sequence[NDArray[np.int32]]
    ) -> Canvas:
        """Prepare to draw in some samples, numbered by their rows in the whole picture."""
        touched = np.zeros(len(ground), bool)
        for samples in drawn:
            touched[_pixels(samples, camera)[0]] = True
        pixels = np.flatnonzero(touched)
        place = np.full(len(ground), -1, np.int32)
        place[pixels] = SAMPLES**2 * np.arange(len(pixels))
        return cls(camera, ground, place, ground[pixels].repeat(SAMPLES**2, axis=0))

    def paint(self, samples: NDArray[np.int32], colors: NDArray) -> None:
        """Give samples, shape (N,), colors, shape (N, 3)."""
        pixel, number = _pixels(samples, self.camera)
        self.samples[self.place[pixel] + number] = colors

    def at(self, samples: NDArray[np.int32]) -> NDArray[np.float32]:
        """Return the colors of samples, shape (N, 3)."""
        pixel, number = _pixels(samples, self.camera)
        place = self.place[pixel]
        colors = self.ground[pixel]
        drawn = np.flatnonzero(place >= 0)
        colors[drawn] = self.samples[place[drawn] + number[drawn]]
        return colors

    def developed(self) -> NDArray[np.uint8]:
        """Return the picture, shape (height, width, 3)."""
        pixels = np.flatnonzero(self.place >= 0)
        mean = np.empty((len(pixels), 3), np.float32)

        def tone(part: slice) -> None:
            first, last = part.start * SAMPLES**2, part.stop * SAMPLES**2
            tones = _toned(self.samples[first:last])
            mean[part] = tones.reshape(-1, SAMPLES**2, 3).mean(axis=1)

        in_parts(tone, len(pixels))
        # a grain of less than a step of the 256 hides the steps in the sky
        grain = np.random.default_rng(0).random((len(self.ground), 1), np.float32) - 0.5
        picture = np.empty((len(self.ground), 3), np.uint8)

        def develop(part: slice) -> None:
            x = _toned(self.ground[part])
            first, last = np.searchsorted(pixels, [part.start, part.stop])
            x[pixels[first:last] - part.start] = mean[first:last]
            x = np.where(x < 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)
            picture[part] = np.clip(np.round(255 * x + grain[part]), 0, 255)

        in_parts(develop, len(picture))
        return picture.reshape(*self.camera.shape, 3)


def _pixels(samples: NDArray[np.int32], camera: Camera) -> tuple[NDArray, NDArray]:
    """Return the pixels of samples, shape (N,), and the numbers of the samples within them."""
    width = SAMPLES * camera.size[0]
    row = samples // width
    column = samples - width * row
    across, down = column // SAMPLES, row // SAMPLES
    number = SAMPLES * (row - SAMPLES * down) + column - SAMPLES * across
    return camera.size[0] * down + across, number


def _toned(color: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return colors after a tone curve that keeps highlights, from 0 to 1."""
    x = np.maximum(color, 0) * EXPOSURE
    # the curve of Narkowicz (2015) for the film response of the Academy
    return np.clip(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0, 1)
