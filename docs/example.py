#!/usr/bin/env python3
"""Writes p.ply, 20,000 photons at random on the unit square, and q.ply, five query points."""
import random


def write(path, properties, rows):
    with open(path, "w") as ply:
        ply.write("ply\nformat ascii 1.0\nelement vertex %d\n" % len(rows))
        for name in properties.split():
            ply.write("property float %s\n" % name)
        ply.write("end_header\n")
        for row in rows:
            ply.write(" ".join("%.7g" % value for value in row) + "\n")


random.seed(3)
write("p.ply", "x y z dx dy dz r g b",
      [(random.random(), random.random(), 0, 0, 0, -1, 1e-4, 5e-5, 2e-5) for _ in range(20000)])
write("q.ply", "x y z nx ny nz",
      [(x, y, 0, 0, 0, 1) for x, y in ((0.5, 0.5), (0.25, 0.75), (0.0, 0.5), (0.0, 0.0), (3.0, 3.0))])
