"""Write chair.obj: a chair of boxes, whose faces are cut into triangles.  Lengths in m."""

import sys

import trimesh

# seat, back and legs: sides, and the center of each box
BOXES = [
    ((0.44, 0.44, 0.04), (0.0, 0.0, 0.45)),
    ((0.44, 0.04, 0.45), (0.0, 0.2, 0.68)),
    *(((0.04, 0.04, 0.44), (x, y, 0.22)) for x in (-0.2, 0.2) for y in (-0.2, 0.2)),
]


def chair(mesh: float) -> trimesh.Trimesh:
    """Return the chair; no edge is longer than a length."""
    boxes = []
    for sides, center in BOXES:
        box = trimesh.creation.box(sides)
        box.apply_translation(center)
        boxes.append(box.subdivide_to_size(mesh))
    return trimesh.util.concatenate(boxes)


chair(float(sys.argv[1])).export("chair.obj", digits=5)
