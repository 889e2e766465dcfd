"""The least squares of `recto::prepare::stereo` as one writes it in NumPy, for comparison.

    python benches/prepare/numpy_stereo.py WIDTH HEIGHT LAMPS

solves once for each line on its standard input, and prints how long that took in s: normals and albedo in
float32 from photographs in memory, no response, no robustness.
"""
import sys
import time

import numpy as np

width, height, lamps = (int(v) for v in sys.argv[1:4])
azimuth = np.arange(lamps) * 2 * np.pi / lamps
elevation = np.pi / 4
l = np.stack([np.cos(azimuth) * np.cos(elevation), np.sin(azimuth) * np.cos(elevation),
              np.full(lamps, np.sin(elevation))], 1).astype(np.float32)
random = np.random.default_rng(1)
photographs = random.random((lamps, 3, height * width), dtype=np.float32) * 0.1 + 0.5


def solve():
    grey = np.tensordot(np.float32([0.25, 0.5, 0.25]), photographs, axes=(0, 1))
    a = l / l[:, 2:]
    g = np.linalg.pinv(a) @ grey
    normal = g / np.maximum(np.linalg.norm(g, axis=0), 1e-10)
    shading = np.maximum(a @ normal, 0)
    square = np.maximum((shading * shading).sum(0), 1e-12)
    albedo = np.stack([(photographs[:, c] * shading).sum(0) / square for c in range(3)])
    return normal, albedo


for _ in sys.stdin:
    start = time.perf_counter()
    solve()
    print(f"{time.perf_counter() - start:.3f}", flush=True)
