"""From photographs to maps as one writes it in NumPy, for comparison with `recto prepare`.

    python benches/prepare/numpy_chain.py FOLDER

does it once for each line on its standard input, and prints how long that took in s, and how much of it went
into reading, solving, relief and writing. FOLDER holds photograph-0.tif … and grey-0.tif …, 16-bit RGB TIFF without compression, in
one piece, little-endian, their pixels from byte 8 on; and lamps.txt with a line "azimuth elevation" in
degrees for each lamp, before it "width height mm_per_px split_mm grey_card".

Files are read by NumPy itself, which is the fastest way, and written as 16-bit PNG by zlib at level 1 after
the Up filter. The steps are those of `recto prepare`, without its doubts: division by the grey card, least squares of a
perfect diffuser, normals split by a Gaussian, heights by Frankot & Chellappa, each of float32 where
it does no harm. Fourier transforms are NumPy's.
"""
import struct
import sys
import time
import zlib
from pathlib import Path

import numpy as np

folder = Path(sys.argv[1])
lines = (folder / "lamps.txt").read_text().split("\n")
width, height, mm_per_px, split_mm, card = (float(v) for v in lines[0].split())
width, height = int(width), int(height)
lamps = np.radians([[float(v) for v in line.split()] for line in lines[1:] if line])
l = np.stack([np.cos(lamps[:, 0]) * np.cos(lamps[:, 1]), np.sin(lamps[:, 0]) * np.cos(lamps[:, 1]),
              np.sin(lamps[:, 1])], 1).astype(np.float32)
steps = {}


def step(name, start):
    now = time.perf_counter()
    steps[name] = steps.get(name, 0) + now - start
    return now


def read(name):
    values = np.fromfile(folder / name, "<u2", count=width * height * 3, offset=8)
    return values.reshape(height, width, 3) * np.float32(1 / 65535)


def write(name, values):
    """16-bit PNG of integers."""
    values = values.astype(">u2").reshape(height, -1)
    rows = values.view(np.uint8).reshape(height, -1)
    filtered = np.empty((height, rows.shape[1] + 1), np.uint8)
    filtered[:, 0] = 2
    filtered[0, 1:] = rows[0]
    np.subtract(rows[1:], rows[:-1], out=filtered[1:, 1:])
    colour = 2 if values.shape[1] == 3 * width else 0

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", width, height, 16, colour, 0, 0, 0)
    with open(folder / name, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head))
        file.write(chunk(b"IDAT", zlib.compress(filtered, 1)) + chunk(b"IEND", b""))


def integrated(normal):
    """Heights in mm of unit normals, as 16-bit integers."""
    z = np.maximum(normal[2], 1e-6)
    p, q = -normal[0] / z, normal[1] / z
    u = 2j * np.pi * np.fft.rfftfreq(width)[None, :]
    v = 2j * np.pi * np.fft.fftfreq(height)[:, None]
    square = np.abs(u) ** 2 + np.abs(v) ** 2
    square[0, 0] = 1
    spectrum = -(u * np.fft.rfft2(p) + v * np.fft.rfft2(q)) / square
    spectrum[0, 0] = 0
    h = np.fft.irfft2(spectrum, (height, width)) * mm_per_px
    low, high = h.min(), h.max()
    return ((h - low) / max(high - low, 1e-9) * 65535).round()


def chain():
    now = time.perf_counter()
    gain = 1 / l[:, 2]
    a = l * gain[:, None]
    photographs = []
    for i in range(len(l)):
        photograph, grey = read(f"photograph-{i}.tif"), read(f"grey-{i}.tif")
        now = step("reading", now)
        photograph *= np.float32(card) / np.maximum(grey, 1e-6)
        photographs.append(np.moveaxis(photograph, 2, 0).reshape(3, -1))
        now = step("solving", now)
    photographs = np.stack(photographs)
    grey = np.tensordot(np.float32([0.25, 0.5, 0.25]), photographs, axes=(0, 1))
    g = np.linalg.pinv(a) @ grey
    normal = g / np.maximum(np.linalg.norm(g, axis=0), 1e-10)
    shading = np.maximum(a @ normal, 0)
    square = np.maximum((shading * shading).sum(0), 1e-12)
    albedo = np.stack([(photographs[:, c] * shading).sum(0) / square for c in range(3)])
    now = step("solving", now)
    albedo = np.clip(albedo, 0, 1)
    encoded = np.where(albedo <= 0.0031308, albedo * 12.92, 1.055 * albedo ** np.float32(1 / 2.4) - 0.055)
    encoded = (np.moveaxis(encoded, 0, 1) * 65535).round()
    now = step("solving", now)
    write("albedo.png", encoded)
    now = step("writing", now)
    normal = normal.reshape(3, height, width)
    sigma = split_mm / mm_per_px
    u, v = np.fft.rfftfreq(width)[None, :], np.fft.fftfreq(height)[:, None]
    transfer = np.exp(-2 * (np.pi * sigma) ** 2 * (u * u + v * v))
    large = np.stack([np.fft.irfft2(np.fft.rfft2(n) * transfer, (height, width)) for n in normal])
    small = normal - (large - np.array([0, 0, 1])[:, None, None])
    large /= np.linalg.norm(large, axis=0)
    small /= np.linalg.norm(small, axis=0)
    shape, grain = integrated(large), integrated(small)
    now = step("relief", now)
    coded = (np.moveaxis(small, 0, 2) * 0.5 + 0.5) * 65535
    write("normal.png", coded.round())
    write("shape.png", shape)
    write("height.png", grain)
    step("writing", now)


for _ in sys.stdin:
    steps.clear()
    start = time.perf_counter()
    chain()
    whole = time.perf_counter() - start
    print(f"{whole:.3f}", " ".join(f"{name} {seconds:.2f}" for name, seconds in steps.items()), flush=True)
