"""Pictures of ROS maps: which files a YAML file may name, and the brightness of their pixels.

Which files: a YAML file may come from a stranger, so it must not choose which files are opened.

* It names a file in or below its own folder, or a picture in or below the parent folder of that, such as
  `../images/floor.png`. Absolute names, which ROS writes, obey the same rule.
* A link is followed to a picture anywhere, since users and build tools put links to where they keep files.
* Outside the folder of the YAML file a picture is a regular file with an ending of `PICTURES`. It is decoded
  as a picture and nothing else, so the worst that a hostile archive brings about is a wrong map.
* A map in the data folder, which holds downloads, has its picture in the data folder, also behind links.

Brightness:

* Colours are averaged, (red + green + blue) / 3, as map_server documents it. Pixels of a palette have the
  colour of their entry.
* The grey value of a picture with 16 bits counts in 65535ths. Of colours with 16 bits the upper eight count.
* An array `.npy`, int8 or uint8, holds the data of a message: its row 0 is the lowest, and -1 counts as 255.
* A pixel that is not opaque is unknown. Map_server documents this for mode `scale`; in mode `trinary` most of
  its versions average the opacity with the colours, by which an opaque grey 205 would be free.
"""

import io
import os
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.errors import MissingExtraError, ScenarioError, shown
from swarm_gym.scenarios.formats.data_files import data_folder, open_file
from swarm_gym.scenarios.grid_map import MAX_SIDE

if TYPE_CHECKING:
    from PIL.Image import Image

ARRAYS = ".npy"
PICTURES = (".pgm", ".png", ".bmp", ".jpg", ".jpeg", ".ppm", ".pbm", ".pnm")
FORMATS = ("PPM", "PNG", "BMP", "JPEG")  # of Pillow; PGM and PBM are among PPM

MAX_IMAGE = 2**26  # bytes, enough for all pixels as decimal numbers
MAX_SCANS = 100  # of a progressive JPEG; programs write about ten, and each one takes as long as a picture

# Factors from the number that a PNG declares transparent to the brightness that Pillow gives it, by raw mode.
_SAMPLES = {"1": 255, "L;2": 85, "L;4": 17, "L": 1, "I;16B": 1, "RGB": 1}


class Picture(NamedTuple):
    """The brightness of a picture's pixels, first row on top.

    Attributes:
        levels: unsigned integers, shape (height, width), from 0 (black) to `white`.
        white: level of white, 255, 765 or 65535.
        opaque: bool, shape (height, width): which pixels are opaque; None if all are.
    """

    levels: NDArray[np.unsignedinteger]
    white: int
    opaque: NDArray[np.bool_] | None


def locate_picture(described: Path, given: str) -> Path:
    """Return the path of the picture that a YAML file names; the file need not exist.

    Args:
        described: path of the YAML file.
        given: the name of the picture in it.

    Raises:
        ScenarioError: if the YAML file may not name this file.
    """
    name = Path(given)
    if not given.isprintable() or not name.name or (not name.is_absolute() and (name.drive or name.root)):
        raise _refused(described, "a file name", given)
    picture = described.parent / name
    real = Path(os.path.realpath(picture))
    # The YAML file may be a link itself: build tools link each file of a folder into another one.
    homes = [Path(os.path.realpath(described.parent)), Path(os.path.realpath(described)).parent]
    if any(real.is_relative_to(home) for home in homes):
        return picture
    data = Path(os.path.realpath(data_folder()))
    if any(home.is_relative_to(data) for home in homes) and not real.is_relative_to(data):
        raise _refused(described, "in the data folder, as the YAML file is", given, real)
    if real.suffix.lower() not in PICTURES:
        expected = f"in the folder of the YAML file, or a picture ({', '.join(PICTURES)})"
        raise _refused(described, expected, given, real)
    if not any(Path(os.path.abspath(picture)).is_relative_to(root) for root in _roots(described, homes)):
        beside = (described.parent / name.name).is_file()
        instead = f"write image: {name.name}" if beside else "move it, or put a link to it there"
        expected = f"in the folder of the YAML file or below its parent folder ({instead})"
        raise _refused(described, expected, given, real)
    return picture


def read_picture(path: Path) -> Picture:
    """Return the brightness of the pixels of an image, or the values of a NumPy array as such.

    Raises:
        ScenarioError: if the file cannot be read, or its pixels have no grey value.
        MissingExtraError: if Pillow is missing.
    """
    if path.suffix.lower() == ARRAYS:
        return _read_array(path)
    try:
        from PIL import Image
    except ImportError as error:
        raise MissingExtraError(f"image {path}", "Pillow", "maps") from error
    try:
        with open_file(path) as file:
            size = os.fstat(file.fileno()).st_size
            if size > MAX_IMAGE:
                raise ScenarioError(f"{path}: expected at most {MAX_IMAGE} bytes, got {size}")
            # Decoding from memory, since a decoder asks a file for as many bytes as its header claims.
            content = file.read()
        with warnings.catch_warnings():
            # The check below is stricter than Pillow's warning.
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)
            image = Image.open(io.BytesIO(content), formats=FORMATS)
            width, height = image.size
            # Checked before any pixel is decoded.
            if not (0 < width <= MAX_SIDE and 0 < height <= MAX_SIDE):
                raise ScenarioError(
                    f"{path}: expected at most {MAX_SIDE} cells along a side, got {width} x {height}"
                )
            if image.format in ("JPEG", "MPO") and content.count(b"\xff\xda") > MAX_SCANS:
                raise ScenarioError(
                    f"{path}: expected a JPEG of at most {MAX_SCANS} scans; save the picture as PNG"
                )
            return _levels_of(path, image)
    except ScenarioError:
        raise
    except Exception as error:  # a decoder may raise anything on malformed bytes
        raise ScenarioError(f"{path}: cannot be read as a PGM, PNG, BMP or JPEG image: {error}") from error


def _read_array(path: Path) -> Picture:
    """Return the values of an array of 8 bits, whose row 0 is the lowest; -1 becomes 255."""
    try:
        with open_file(path) as file, warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of headers that Python 2 wrote
            version = np.lib.format.read_magic(file)
            reader = np.lib.format.read_array_header_1_0 if version == (1, 0) else None
            if reader is None:
                raise ScenarioError(f"{path}: expected an array as numpy.save writes it, version 1.0")
            shape, _, dtype = reader(file)
            if len(shape) != 2 or dtype not in (np.dtype(np.int8), np.dtype(np.uint8)):
                raise ScenarioError(
                    f"{path}: expected int8 or uint8 of shape (height, width), got {dtype} of shape {shape}; "
                    "save the values of the cells as they are in the message"
                )
            if not (min(shape) > 0 and max(shape) <= MAX_SIDE):
                raise ScenarioError(f"{path}: expected 1 to {MAX_SIDE} cells along a side, got shape {shape}")
            file.seek(0)
            values = np.load(file, allow_pickle=False)
    except ScenarioError:
        raise
    except Exception as error:  # malformed headers raise errors of many kinds
        raise ScenarioError(f"{path}: cannot be read as an array of NumPy: {error!s:.400}") from error
    return Picture(values.view(np.uint8)[::-1].astype(np.uint16), 255, None)


def _refused(described: Path, expected: str, given: str, real: Path | None = None) -> ScenarioError:
    led = "" if real is None or str(real) == given else f", which is {real}"
    return ScenarioError(f"{described}: image must be {expected}, got {shown(given)}{led}")


def _roots(described: Path, homes: list[Path]) -> list[Path]:
    """Return the folders below which a picture may be named: the parents, but not the whole file system."""
    folders = [Path(os.path.abspath(described.parent)), *homes]
    return [folder if folder.parent == folder.parent.parent else folder.parent for folder in folders]


def _levels_of(path: Path, image: "Image") -> Picture:
    tiles = getattr(image, "tile", None)
    sample = str(tiles[0][3]) if tiles else ""  # how a PNG stores a pixel; decoding forgets it
    key = image.info.get("transparency")  # colour that a PNG declares transparent
    if image.mode == "P":
        image, key = image.convert("RGB" if key is None else "RGBA"), None
    if image.mode in ("1", "L", "LA"):
        levels, white = np.array(image.convert("LA" if image.mode == "LA" else "L").getchannel(0)), 255
    elif image.mode in ("I", "I;16", "I;16B"):
        levels, white = np.array(image).astype(np.uint16), 65535
    elif image.mode in ("RGB", "RGBA"):
        levels, white = np.zeros((image.height, image.width), np.uint16), 765
        for channel in range(3):
            levels += np.asarray(image.getchannel(channel))
    else:
        raise ScenarioError(
            f"{path}: expected a grey or coloured image, or one with a palette, got Pillow's mode "
            f"{image.mode!r}; save it as a grey PNG of 8 bits"
        )
    opaque = None
    if image.mode in ("LA", "RGBA"):
        opaque = np.asarray(image.getchannel("A")) == 255
    elif key is not None:
        opaque = ~_transparent(path, image, levels, key, sample)
    return Picture(levels, white, None if opaque is None or opaque.all() else opaque)


def _transparent(
    path: Path, image: "Image", levels: NDArray[np.unsignedinteger], key: Any, sample: str
) -> NDArray[np.bool_]:
    """Return the pixels of the one colour that a PNG declares transparent."""
    if sample not in _SAMPLES:
        raise ScenarioError(
            f"{path}: a colour of 16 bits is declared transparent, which eight bits do not tell from others; "
            "save the picture with an alpha channel, or with 8 bits"
        )
    if image.mode == "RGB":
        same = [np.asarray(image.getchannel(k)) == key[k] for k in range(3)]
        return same[0] & same[1] & same[2]
    return levels == key * _SAMPLES[sample]
