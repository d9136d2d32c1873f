"""The sculpture of the demo: the bust of a woman with her hair drawn back into a knot, after no living model.

It is modelled in centimetres of a living head: x to her left, y up, z forward; the eyes are at y = 0, the chin at y = -11.
"""

from __future__ import annotations

import numpy as np

from ..readers.surface import Surface
from .implicit import Points, Values, Vec, arc, ball, common, cut, ellipsoid, fade, join, limb, ring, rotation
from .surface_nets import fisheye, polygonise

KNOT = np.array((0.0, 6.2, -11.2))  # where the strands of the hair run to
BASE = -45.0  # the height of the foot
FOOT_Z = -2.5  # and its middle


def mirrored(p: Points) -> Points:
    """Fold the right half onto the left, rounded at the middle so that no crease runs down the face."""
    x = p[:, 0]
    return np.column_stack([np.sqrt(x * x + 0.04) - 0.02, p[:, 1], p[:, 2]])


def skull(p: Points, m: Points) -> Values:
    """The head without its features: cranium, face, jaw, cheeks and chin."""
    d = ellipsoid(p, (0, 2.6, -1.6), (6.9, 8.4, 8.9))
    d = join(d, ellipsoid(p, (0, -2.2, 2.4), (5.7, 8.2, 6.0)), 3.0)
    d = join(d, limb(m, (4.5, -4.4, -0.8), (1.0, -9.3, 5.2), 1.3, 1.1), 2.6)
    d = join(d, ball(p, (0, -9.5, 6.3), 1.2), 2.4)
    return join(d, ellipsoid(m, (4.0, -2.5, 5.0), (1.9, 1.5, 1.9)), 2.4)


def eyes(d: Values, m: Points) -> Values:
    """Sockets under a fine brow, eyeballs, and lids lowered over them."""
    d = join(d, arc(m, ((1.0, 1.2, 8.1), (2.3, 2.35, 7.7), (3.9, 2.65, 6.75), (5.4, 1.7, 5.2)), (0.4, 0.42, 0.38, 0.3)), 1.4)
    d = cut(d, ellipsoid(m, (3.1, 0.0, 9.0), (2.3, 1.3, 1.4), rotation((0, 1, 0), 18)), 1.4)
    d = join(d, ball(m, (3.1, -0.25, 6.2), 1.62), 0.8)
    ridge = ((1.75, -0.5, 7.2), (2.4, 0.2, 7.75), (3.3, 0.42, 7.78), (4.3, 0.05, 7.25), (5.0, -0.6, 6.3))
    upper = arc(m, ridge, (0.2, 0.32, 0.36, 0.32, 0.2))
    lower = arc(m, ((1.6, -0.95, 7.1), (2.4, -1.5, 7.3), (3.4, -1.65, 7.25), (4.5, -1.2, 6.7)), (0.15, 0.25, 0.25, 0.18))
    lashes = arc(m, ((1.95, -0.85, 7.75), (2.4, -1.08, 7.95), (3.4, -1.15, 7.95), (4.5, -0.75, 7.2)), (0.16, 0.24, 0.24, 0.14))
    return cut(join(join(d, upper, 1.1), lower, 0.5), lashes, 0.4)


def nose(d: Values, p: Points, m: Points) -> Values:
    """A straight nose that runs on from the forehead."""
    d = join(d, arc(p, ((0, 1.8, 7.6), (0, -0.6, 8.2), (0, -3.2, 9.55)), (0.7, 0.55, 0.68)), 1.0)
    d = join(d, limb(m, (1.7, 0.6, 6.75), (1.6, -0.8, 6.95), 0.95, 0.85), 1.1)  # from the bridge to the corners of the eyes
    return join(d, ball(m, (0.8, -3.6, 8.55), 0.62), 0.8)


def mouth(d: Values, p: Points, m: Points) -> Values:
    """Lips that just close, with the hint of a smile."""
    d = join(d, ellipsoid(p, (0, -6.5, 6.7), (2.5, 1.9, 1.3)), 1.4)
    d = join(d, arc(m, ((0.25, -6.0, 8.1), (0.8, -6.02, 8.08), (2.2, -6.4, 7.2)), (0.36, 0.42, 0.15)), 0.5)
    d = join(d, arc(m, ((0.0, -7.22, 7.9), (0.8, -7.18, 7.8), (2.0, -6.6, 7.2)), (0.54, 0.48, 0.15)), 0.5)
    d = cut(d, arc(m, ((0.0, -6.62, 8.65), (1.0, -6.55, 8.45), (2.3, -6.3, 7.5)), (0.12, 0.12, 0.1)), 0.45)
    return cut(d, limb(p, (0, -4.8, 9.0), (0, -5.4, 8.9), 0.3, 0.34), 0.7)


def ears(d: Values, m: Points) -> Values:
    """Ears, free of the hair."""
    tilt = rotation((1, 0, 0), -12)
    shell = ellipsoid(m, (6.6, -1.6, -0.7), (0.95, 2.9, 1.75), tilt)
    shell = cut(shell, ellipsoid(m, (7.6, -1.1, -0.2), (0.9, 1.7, 1.1), tilt), 1.0)
    return join(d, join(shell, ball(m, (6.3, -4.0, 0.1), 0.65), 1.0), 0.9)


def hair(p: Points, m: Points) -> Values:
    """Melon hair: strands from the hairline to a coiled knot, held by a band."""
    middle = np.array((0.0, 2.6, -1.6))
    axis = np.array(KNOT) - middle
    axis /= np.linalg.norm(axis)
    q = p - middle
    along = q @ axis
    angle = np.arctan2(q @ np.cross(axis, (1.0, 0.0, 0.0)), q[:, 0])
    away = np.sqrt(np.maximum(np.einsum("ij,ij->i", q, q) - along**2, 1e-9))
    hoop = (p[:, 2] + 3.4 - 0.5 * p[:, 1]) / 1.118
    strands = 0.27 * np.cos(18 * angle) * fade(away, 3.0, 6.5) * fade(np.abs(hoop), 0.7, 1.8)
    cap = ellipsoid(p, (0, 3.0, -1.9), (7.8, 9.3, 9.7))
    line = (p[:, 2] - 0.9 - 0.95 * (p[:, 1] + 1.2) - 0.02 * p[:, 0] ** 2) / 1.38
    band = common(np.abs(hoop) - 1.0, cap - 0.5, 1.0)
    cap = join(cap + strands, band, 0.8)
    cap = common(cap, line, 1.6)
    cap = cut(cap, ellipsoid(m, (8.0, -2.2, 0.0), (3.2, 3.6, 2.6)), 1.5)
    coil = join(ring(p, _vec(KNOT), _vec(axis), 2.5, 1.6), ring(p, _vec(KNOT + 1.7 * axis), _vec(axis), 1.0, 1.35), 1.0)
    return join(cap, join(coil, ball(p, _vec(KNOT + 0.6 * axis), 2.0), 1.0), 1.4)


def _vec(v: Points) -> Vec:
    return float(v[0]), float(v[1]), float(v[2])


def body(p: Points, m: Points) -> Values:
    """Neck, shoulders and breast, cut to a bust on a turned foot."""
    neck = limb(p, (0, -7, -2.4), (0, -22, -4.4), 4.2, 4.9)
    neck = join(neck, limb(m, (4.6, -5.0, -3.0), (1.2, -22.4, 1.2), 1.1, 0.75), 2.4)
    torso = join(ellipsoid(p, (0, -31, -4.5), (16, 11, 7.6)), limb(m, (2, -17.5, -5.5), (14.5, -25, -4.5), 2.3, 4.2), 4.0)
    torso = join(torso, limb(m, (14.5, -25.5, -4.5), (16, -38, -4.0), 4.2, 3.8), 2.0)
    torso = join(torso, ellipsoid(m, (6.0, -34.5, 0.3), (5.0, 5.0, 4.2)), 4.0)
    torso = join(torso, arc(m, ((1.5, -23.3, 1.1), (6.0, -22.8, 0.2), (13.0, -22.2, -3.8)), (0.6, 0.55, 0.6)), 1.8)
    # The gown hangs in folds from shoulder to shoulder, below a round neckline.
    hang = p[:, 1] - 0.8 * np.hypot(p[:, 0], 5.0)
    front = fade(p[:, 2], -7.0, -2.0)
    folds = 0.6 + 0.36 * np.cos(2 * np.pi * (hang + 33.4) / 5.0) * fade(hang, -56.0, -38.0) * front * fade(np.abs(p[:, 0]), 14.0, 8.0)
    torso = torso - folds * fade(hang, -30.0, -33.6)
    d = join(neck, torso, 4.0)
    # The cut: a bowl from shoulder to shoulder, as sculptors end a bust.
    d = common(d, ellipsoid(p, (0, -20, -3.0), (17.8, 20.0, 16.0)), 2.6)
    q = np.hypot(p[:, 0], p[:, 2] - FOOT_Z)
    h = p[:, 1] - BASE
    waist = (q - (3.2 + 4.0 * np.exp(-((h / 3.0) ** 2)) + 2.5 * fade(h, 5.0, 10.0))) / 1.3
    return join(d, common(waist, np.abs(h - 4.5) - 4.5, 3.0), 1.5)


def figure(p: Points) -> Values:
    """The whole bust, before she turns her head."""
    d = body(p, mirrored(p))
    high = p[:, 1] > -15.0  # further down the head is too far off to matter
    p = p[high]
    m = mirrored(p)
    head = mouth(nose(eyes(skull(p, m), m), p, m), p, m)
    d[high] = join(join(ears(head, m), d[high], 1.6), hair(p, m), 0.9)
    return d


def bust(foot: Vec, height: float, turn: float, glance: float = 22.0) -> Surface:
    """The bust with the middle of its foot at `foot`, `height` metres high, turned by `turn` degrees about y, the head by `glance` more."""
    # Cells of half a centimetre in the face, wider away from it.
    nodes = fisheye((-19.0, BASE - 1.5, -19.0), (19.0, 16.0, 13.0), (0.0, -2.0, 7.5), 0.47, 9.0)
    points, triangles, normals = polygonise(figure, nodes)
    points, normals = _twist(points, normals, glance)
    # Stand it on its foot and bring it to size.
    lowest, highest = points[:, 1].min(), points[:, 1].max()
    stand = rotation((0, 1, 0), turn).T
    points = (points - np.array((0.0, lowest, FOOT_Z))) @ stand * (height / (highest - lowest)) + np.asarray(foot)
    return Surface(points, triangles, normals @ stand)


def _twist(p: Points, n: Points, degrees: float) -> tuple[Points, Points]:
    """Turn the head about the neck, the neck by degrees: an angle that grows with height. Also the normals of what comes out."""
    lo, hi, axis = -21.0, -8.0, np.array((0.0, 0.0, -3.0))
    h = np.clip((p[:, 1] - lo) / (hi - lo), 0.0, 1.0)
    angle, slope = np.radians(degrees) * h * h * (3 - 2 * h), np.radians(degrees) * 6 * h * (1 - h) / (hi - lo)
    q = p - axis
    # The Jacobian is R (1 + w y^T) with w = slope y x q; normals go by its inverse transpose, R (1 - y w^T).
    lean = slope * (q[:, 2] * n[:, 0] - q[:, 0] * n[:, 2])
    n = n - lean[:, None] * np.array((0.0, 1.0, 0.0))
    cos, sin = np.cos(angle), np.sin(angle)

    def turned(v: Points) -> Points:
        return np.column_stack([cos * v[:, 0] + sin * v[:, 2], v[:, 1], cos * v[:, 2] - sin * v[:, 0]])

    return turned(q) + axis, turned(n) / np.linalg.norm(n, axis=1, keepdims=True)
