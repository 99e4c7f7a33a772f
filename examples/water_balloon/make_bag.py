"""Write bag.obj: a ball of rubber with a round mouth on top.  Lengths in m."""

import sys

import numpy as np
import trimesh

RADIUS, MOUTH = 0.06, 0.025


def bag(subdivisions: int) -> trimesh.Trimesh:
    """Return the bag; its edges are about 0.07 / 2^subdivisions long."""
    ball = trimesh.creation.icosphere(subdivisions, RADIUS)
    top = np.sqrt(RADIUS**2 - MOUTH**2)
    ball.update_faces(np.all(ball.vertices[ball.faces, 2] < top, axis=1))
    ball.remove_unreferenced_vertices()
    # what borders on the mouth goes to its rim
    alone = trimesh.grouping.group_rows(ball.edges_sorted, require_count=1)
    rim = np.unique(ball.edges_sorted[alone])
    angle = np.arctan2(ball.vertices[rim, 1], ball.vertices[rim, 0])
    ball.vertices[rim] = np.stack(
        [MOUTH * np.cos(angle), MOUTH * np.sin(angle), np.full(len(rim), top)], axis=1
    )
    return ball


bag(int(sys.argv[1])).export("bag.obj", digits=6)
