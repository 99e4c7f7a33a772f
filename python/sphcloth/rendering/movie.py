"""Pictures to files: numbered PNGs, a GIF, or an MP4."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from sphcloth.errors import UserError
from sphcloth.results import make_folder, pictures_in

FORMATS = ("png", "gif", "mp4")
FRAMES_PER_SECOND = 20
# 0 is lossless, 10 the coarsest
MP4_QUALITY = 8
# of PNGs: a third of the time of the default, 6, for files 7 % larger
COMPRESSION = 4

Pictures = Iterable[NDArray[np.uint8]]


def check_format(form: str, size: tuple[int, int]) -> None:
    """Raise UserError for a format that cannot be written, before anything is drawn."""
    if form not in FORMATS:
        raise UserError(f"--format {form}: use {', '.join(FORMATS)}")
    if form == "mp4":
        _encoder()
        if size[0] % 2 or size[1] % 2:
            raise UserError(f"--size {size[0]}x{size[1]}: MP4 takes even numbers of pixels")


def write_pictures(pictures: Pictures, form: str, out: Path, name: str) -> Iterator[Path]:
    """Write pictures of one size as they come; yield the path of each file after it is written.

    Args:
        pictures: each of shape (height, width, 3).
        form: ``png``, ``gif`` or ``mp4``.
        out: folder, made if need be; those of an earlier call go when the first is drawn.
        name: of the GIF or MP4; PNGs are ``frame_0000.png``, ...

    Raises:
        UserError: a folder that cannot be made, or no encoder.
    """
    make_folder(out)
    pictures = iter(pictures)
    first = next(pictures)
    files = pictures_in(out)
    files.remove()
    pictures = itertools.chain([first], pictures)
    match form:
        case "png":
            for number, picture in enumerate(pictures):
                path = files.path(number)
                Image.fromarray(picture).save(path, compress_level=COMPRESSION)
                yield path
        case "gif":
            yield _write_gif(pictures, out / f"{name}.gif")
        case _:
            yield _write_mp4(pictures, out / f"{name}.mp4")


def _write_gif(pictures: Pictures, path: Path) -> Path:
    """Write a GIF that runs for ever; its pictures have 256 colors, each its own."""
    images = (Image.fromarray(picture).quantize(256) for picture in pictures)
    first = next(images)
    first.save(
        path, save_all=True, append_images=images, duration=1000 // FRAMES_PER_SECOND, loop=0
    )
    return path


def _write_mp4(pictures: Pictures, path: Path) -> Path:
    write_frames = _encoder()
    pictures = iter(pictures)
    first = next(pictures)
    size = first.shape[1], first.shape[0]
    stream = write_frames(
        str(path), size, fps=FRAMES_PER_SECOND, quality=MP4_QUALITY, macro_block_size=2
    )
    stream.send(None)
    stream.send(np.ascontiguousarray(first))
    for picture in pictures:
        stream.send(np.ascontiguousarray(picture))
    stream.close()
    return path


def _encoder():
    """Return what writes MP4s; UserError if it is not installed."""
    try:
        from imageio_ffmpeg import write_frames
    except ImportError:
        raise UserError(
            "--format mp4 needs an encoder: pip install imageio-ffmpeg, or use --format gif"
        ) from None
    return write_frames
