"""How much light a smooth or rough dielectric reflects, by quadrature: what the approximation of plastics needs."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import numpy.typing as npt

_Array = npt.NDArray[np.float64]
_NODES = 64  # midpoints in each variable


def dielectric(cos: _Array, eta: float) -> _Array:
    """Unpolarised reflectance 0..1 at the cosine of incidence 0..1; `eta` >= 1 is the index inside over the index outside."""
    inside = np.sqrt(1.0 - (1.0 - cos * cos) / (eta * eta))
    across = (cos - eta * inside) / (cos + eta * inside)
    along = (eta * cos - inside) / (eta * cos + inside)
    return np.asarray((across * across + along * along) / 2)


@lru_cache(maxsize=256)
def mean_reflectance(eta: float) -> float:
    """Reflectance of diffuse light that arrives from outside, 0..1; from inside it is 1 - (1 - that) / eta^2."""
    cos = (np.arange(2000) + 0.5) / 2000
    return float(np.mean(2 * cos * dielectric(cos, eta)))


@lru_cache(maxsize=256)
def largest_albedo(alpha: float, eta: float) -> float:
    """The largest directional albedo over all angles, 0..1, of a GGX lobe with this roughness and the Fresnel reflectance of `eta`.

    The mean of F G1 over visible normals; the sum over angles is dense at grazing incidence, where the maximum is.
    """
    cosines = np.array([0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.4, 0.7, 1.0])
    return max(_albedo(float(cos), alpha, eta) for cos in cosines)


def _albedo(cos: float, alpha: float, eta: float) -> float:
    """Directional albedo for an eye at `cos` to the normal."""
    u = (np.arange(_NODES) + 0.5) / _NODES
    radius, angle = np.meshgrid(np.sqrt(u), 2 * np.pi * u)
    sin = np.sqrt(1 - cos * cos)
    # Visible normals (Heitz 2018): a disk across the stretched eye direction, lifted to the hemisphere, and stretched back.
    stretched = np.array([alpha * sin, cos]) / np.hypot(alpha * sin, cos)
    x, y = radius * np.cos(angle), radius * np.sin(angle)
    share = (1 + stretched[1]) / 2
    x = (1 - share) * np.sqrt(1 - y * y) + share * x
    z = np.sqrt(np.maximum(0, 1 - x * x - y * y))
    normal = np.stack([alpha * (stretched[0] * z - stretched[1] * x), alpha * y, np.maximum(0, stretched[1] * z + stretched[0] * x)])
    normal /= np.linalg.norm(normal, axis=0)
    cos_half = np.clip(normal[0] * sin + normal[2] * cos, 0, 1)
    cos_out = 2 * cos_half * normal[2] - cos
    lit = np.maximum(cos_out, 0)
    seen = 2 * lit / (lit + np.sqrt(alpha**2 + (1 - alpha**2) * lit * lit))
    return float(np.mean(dielectric(cos_half, eta) * seen))
