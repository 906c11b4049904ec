"""Shapes that several programs write, as points of a y-up world and faces."""
import math

# Normal of a constant normal map, and texture coordinates of a square that are sheared by half a repeat.
BUMP = (0.5, 0.25, 0.829156)
SHEARED = [(0, 0), (1, 0), (1.5, 1), (0.5, 1)]


def letter():
    """A concave L of one face, whose first corner does not see the others."""
    points = [(1.5, -0.5), (1.5, -1.5), (-1.5, -1.5), (-1.5, 1.5), (-0.5, 1.5), (-0.5, -0.5)]
    return [(x, y, 0) for x, y in points], [(0, 5, 4, 3, 2, 1)]


def letter_triangles():
    """The same L as two boxes of two triangles."""
    return box_triangles(-1.5, -1.5, -0.5, 1.5) + box_triangles(-0.5, -1.5, 1.5, -0.5)


def box_triangles(left, bottom, right, top, z=0.0):
    a, b, c, d = (left, bottom, z), (right, bottom, z), (right, top, z), (left, top, z)
    return [[a, b, c], [a, c, d]]


def square(centre, half):
    x, y, z = centre
    return [(x - half, y - half, z), (x + half, y - half, z), (x + half, y + half, z), (x - half, y + half, z)], [(0, 1, 2, 3)]


def tube(sides=12, radius=1.0, height=1.6):
    """A closed prism around y: sides of four corners, caps of `sides` corners."""
    ring = [(radius * math.cos(2 * math.pi * k / sides), radius * math.sin(2 * math.pi * k / sides)) for k in range(sides)]
    low, high = [(x, -height / 2, -z) for x, z in ring], [(x, height / 2, -z) for x, z in ring]
    walls = [(k, (k + 1) % sides, sides + (k + 1) % sides, sides + k) for k in range(sides)]
    return low + high, walls + [tuple(range(sides, 2 * sides)), tuple(reversed(range(sides)))]


def tube_triangles(sides=12):
    """Triangles of the tube and the normals of their corners: radial on the sides, flat on the caps."""
    vertices, faces = tube(sides)
    triangles, normals = [], []
    for face in faces:
        for k in range(1, len(face) - 1):
            corners = [vertices[face[i]] for i in (0, k, k + 1)]
            triangles.append(corners)
            if len(face) == 4:
                normals.append([(x, 0, z) for x, _, z in corners])
            else:
                normals.append([(0, math.copysign(1, corners[0][1]), 0)] * 3)
    return triangles, normals
