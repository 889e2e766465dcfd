"""Paths per second of Mitsuba 3's volpath through OPTICS' slab of paper, for benches/walk.rs.

    pip install mitsuba && python3 benches/walk.py

Prints one line, "variant threads paths seconds radiance". A parallel sensor looks straight down on
a cube, wide against its thickness, of a smooth dielectric that holds a homogeneous medium, under a
white sky on all sides: what it sees is R + T. The film has many pixels, as blocks of them are what
Mitsuba's scalar variants share out among threads.

VARIANT=llvm_ad_rgb where LLVM works (see tests/fixtures/slab.py); SAMPLES paths a pixel.
"""

import os
import time

import mitsuba as mi

variant = os.environ.get("VARIANT", "scalar_rgb")
mi.set_variant(variant)

EDGE = 128
SAMPLES = int(os.environ.get("SAMPLES", "8"))
THICKNESS = 0.262
SIGMA_S, SIGMA_A, G, N = 81.38, 0.05, 1 / 3, 1.5

scene = mi.load_dict(
    {
        "type": "scene",
        "integrator": {"type": "volpath", "max_depth": -1, "rr_depth": 100000},
        "sensor": {
            "type": "orthographic",
            "to_world": mi.ScalarTransform4f().look_at([0, 0, 10], [0, 0, 0], [0, 1, 0]),
            "film": {
                "type": "hdrfilm",
                "width": EDGE,
                "height": EDGE,
                "rfilter": {"type": "box"},
                "pixel_format": "luminance",
                "component_format": "float32",
            },
            "sampler": {"type": "independent", "sample_count": SAMPLES},
        },
        "sheet": {
            "type": "cube",
            "to_world": mi.ScalarTransform4f().scale([20, 20, THICKNESS / 2]),
            "bsdf": {"type": "dielectric", "int_ior": N, "ext_ior": 1.0},
            "interior": {
                "type": "homogeneous",
                "albedo": SIGMA_S / (SIGMA_S + SIGMA_A),
                "sigma_t": SIGMA_S + SIGMA_A,
                "phase": {"type": "hg", "g": G},
            },
        },
        "sky": {"type": "constant", "radiance": 1.0},
    }
)
# Compiles what there is to compile.
mi.render(scene, spp=1, seed=1)
start = time.perf_counter()
image = mi.render(scene, seed=2)
values = [float(v) for v in image.array]
took = time.perf_counter() - start
# In single precision a path is NaN now and then.
finite = [v for v in values if v == v]
print(
    variant,
    os.cpu_count(),
    EDGE * EDGE * SAMPLES,
    f"{took:.3f}",
    f"{sum(finite) / len(finite):.4f}",
)
