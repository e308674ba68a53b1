"""Pictures of ROS maps in every form that is read, made pixel by pixel, with what each pixel stands for."""

import io
import struct
import zlib
from typing import NamedTuple

import numpy as np

# Grey values around thresholds, those that map_saver writes, and the ends of the values that mode raw knows.
GREYS = (0, 1, 19, 20, 100, 101, 127, 128, 204, 205, 206, 254, 255)
HEIGHT, WIDTH = 9, 11
# Colours of a palette, among them two whose mean is no whole number.
COLOURS = ((254, 254, 254), (0, 0, 0), (205, 205, 205), (255, 254, 254), (10, 20, 31), (205, 206, 205))


class Made(NamedTuple):
    """A picture: the content of its file, and its pixels as (red, green, blue, opacity), each up to 255."""

    content: bytes
    ending: str
    pixels: list[list[tuple[float, float, float, float]]]


def pictures():
    """Return pictures by name."""
    from PIL import Image

    def saved(image, ending, **options):
        content = io.BytesIO()
        image.save(content, {"bmp": "BMP", "png": "PNG", "ppm": "PPM", "pgm": "PPM"}[ending], **options)
        return content.getvalue()

    rng = np.random.default_rng(0)
    grey = rng.choice(GREYS, (HEIGHT, WIDTH)).astype(np.uint8)
    colours = rng.choice(GREYS, (HEIGHT, WIDTH, 3)).astype(np.uint8)
    opacity = rng.choice((0, 128, 254, 255, 255, 255), (HEIGHT, WIDTH)).astype(np.uint8)
    entries = rng.integers(0, len(COLOURS), (HEIGHT, WIDTH)).astype(np.uint8)
    deep = rng.integers(0, 2**16, (HEIGHT, WIDTH)).astype(">u2")
    deep_colours = rng.integers(0, 2**16, (HEIGHT, WIDTH, 3)).astype(">u2")
    bits = rng.integers(0, 2, (HEIGHT, WIDTH)).astype(np.uint8)
    pairs = rng.integers(0, 4, (HEIGHT, WIDTH)).astype(np.uint8)
    head = f"{WIDTH} {HEIGHT}"

    palette = Image.frombytes("P", (WIDTH, HEIGHT), entries.tobytes())
    palette.putpalette([value for colour in COLOURS for value in colour])
    as_colours = np.array(COLOURS)[entries]
    found = {}
    for ending in ("pgm", "png", "bmp"):
        found[f"grey {ending}"] = Made(saved(Image.fromarray(grey), ending), ending, _grey(grey))
    for ending in ("ppm", "png", "bmp"):
        content = saved(Image.fromarray(colours), ending)
        found[f"colours {ending}"] = Made(content, ending, _coloured(colours))
    for ending in ("png", "bmp"):
        found[f"palette {ending}"] = Made(saved(palette, ending), ending, _coloured(as_colours))
    ascii_rows = "\n".join(" ".join(map(str, row)) for row in grey.tolist())
    found["grey in ascii"] = Made(f"P2\n{head}\n255\n{ascii_rows}\n".encode(), "pgm", _grey(grey))
    both = Image.frombytes("LA", (WIDTH, HEIGHT), np.dstack([grey, opacity]).tobytes())
    found["grey with alpha"] = Made(saved(both, "png"), "png", _grey(grey, opacity))
    both = np.dstack([colours, opacity])
    found["colours with alpha"] = Made(
        saved(Image.fromarray(both), "png"), "png", _coloured(colours, opacity)
    )
    alphas = bytes([255, 255, 254, 255, 0, 255])
    found["palette with alpha"] = Made(
        saved(palette, "png", transparency=alphas),
        "png",
        _coloured(as_colours, np.frombuffer(alphas, np.uint8)[entries]),
    )
    found["palette with one transparent colour"] = Made(
        saved(palette, "png", transparency=0), "png", _coloured(as_colours, 255 * (entries != 0))
    )
    found["one grey transparent"] = Made(
        saved(Image.fromarray(grey), "png", transparency=254), "png", _grey(grey, 255 * (grey != 254))
    )
    key = tuple(colours[2, 3].tolist())
    same = (colours == key).all(axis=2)
    found["one colour transparent"] = Made(
        saved(Image.fromarray(colours), "png", transparency=key), "png", _coloured(colours, 255 * ~same)
    )
    found["16 bits png"] = Made(
        saved(Image.fromarray(deep.astype(np.uint16)), "png"), "png", _grey(deep / 257)
    )
    found["16 bits pgm"] = Made(f"P5\n{head}\n65535\n".encode() + deep.tobytes(), "pgm", _grey(deep / 257))
    found["colours of 16 bits"] = Made(
        _png(deep_colours.reshape(HEIGHT, -1), WIDTH, 16, 2), "png", _coloured(deep_colours >> 8)
    )
    found["colours of 16 bits with alpha"] = Made(
        _png(
            np.dstack([deep_colours, opacity.astype(np.uint16) * 257]).astype(">u2").reshape(HEIGHT, -1),
            WIDTH,
            16,
            6,
        ),
        "png",
        _coloured(deep_colours >> 8, opacity),
    )
    packed = np.packbits(bits, axis=1)
    found["1 bit png"] = Made(_png(packed, WIDTH, 1, 0), "png", _grey(255 * bits))
    found["1 bit pbm"] = Made(f"P4\n{head}\n".encode() + packed.tobytes(), "pbm", _grey(255 * (1 - bits)))
    found["1 bit, white transparent"] = Made(
        _png(packed, WIDTH, 1, 0, key=1), "png", _grey(255 * bits, 255 * (bits == 0))
    )
    quads = np.pad(pairs, ((0, 0), (0, -WIDTH % 4))).reshape(HEIGHT, -1, 4) @ np.array([64, 16, 4, 1])
    found["2 bits, white transparent"] = Made(
        _png(quads.astype(np.uint8), WIDTH, 2, 0, key=3), "png", _grey(85 * pairs, 255 * (pairs != 3))
    )
    return found


def _coloured(colours, opacity=None):
    opacity = np.full(colours.shape[:2], 255) if opacity is None else opacity
    return [[(*map(float, colours[y, x]), float(opacity[y, x])) for x in range(WIDTH)] for y in range(HEIGHT)]


def _grey(grey, opacity=None):
    return _coloured(np.dstack([grey] * 3), opacity)


def _png(rows, width, bits, colours, key=None):
    """Return a PNG; `rows` has the bytes, or numbers of 16 bits, of each row."""

    def chunk(kind, content):
        whole = kind + content
        return struct.pack(">I", len(content)) + whole + struct.pack(">I", zlib.crc32(whole))

    head = struct.pack(">IIBBBBB", width, len(rows), bits, colours, 0, 0, 0)
    declared = b"" if key is None else chunk(b"tRNS", struct.pack(">H", key))
    content = zlib.compress(b"".join(b"\0" + row.tobytes() for row in rows))
    return (
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + declared + chunk(b"IDAT", content) + chunk(b"IEND", b"")
    )
