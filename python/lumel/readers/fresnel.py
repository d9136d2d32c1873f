"""What rough dielectrics reflect and let through, by quadrature over their visible normals: the approximation of plastics needs it."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from .surface import Points

_NODES = 64  # midpoints in each variable


@lru_cache(maxsize=256)
def base_albedo(alpha: float, eta: float) -> tuple[float, float]:
    """Light below a coat of GGX roughness `alpha` (0: smooth) and relative index `eta` >= 1: (passed, kept), both 0..1.

    A diffuse base of albedo rho under it sends out rho * passed / (1 - kept) of all diffuse light that arrives, kept times rho where
    the light that bounces below the coat takes on the base's colour at each bounce. Light is lost at rough coats, as in Mitsuba.
    """
    cosines = (np.arange(_NODES) + 0.5) / _NODES
    through = float(np.mean([2 * cos * _albedos(float(cos), alpha, eta)[1] for cos in cosines]))
    kept = float(np.mean([2 * cos * _albedos(float(cos), alpha, 1 / eta)[0] for cos in cosines]))
    return through * through / eta**2, kept


@lru_cache(maxsize=256)
def largest_albedo(alpha: float, eta: float) -> float:
    """The largest directional albedo, 0..1, over all angles of a GGX lobe with this roughness and the Fresnel reflectance of `eta` >= 1."""
    # The maximum is at grazing incidence.
    cosines = (0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.4, 0.7, 1.0)
    return max(_albedos(cos, alpha, eta)[0] for cos in cosines)


def _albedos(cos: float, alpha: float, eta: float) -> tuple[float, float]:
    """The shares reflected and let through, for one direction at `cos` to the normal: means of F G1 and (1 - F) G1."""
    x, z = _visible_normals(cos, alpha)
    cos_half = np.clip(x * np.sqrt(1 - cos * cos) + z * cos, 0, 1)
    # The cosine beyond the surface is imaginary in total reflection: |amplitude| is 1 then.
    beyond = np.sqrt((1 - (1 - cos_half**2) / eta**2).astype(np.complex128))
    across = (cos_half - eta * beyond) / (cos_half + eta * beyond)
    along = (eta * cos_half - beyond) / (eta * cos_half + beyond)
    reflected = (np.abs(across) ** 2 + np.abs(along) ** 2) / 2
    cos_reflected = 2 * cos_half * z - cos
    cos_refracted = beyond.real * z - (cos_half * z - cos) / eta
    shares = (reflected * _unshadowed(cos_reflected, alpha), (1 - reflected) * _unshadowed(cos_refracted, alpha))
    return float(np.mean(shares[0])), float(np.mean(shares[1]))


def _unshadowed(cos: Points, alpha: float) -> Points:
    """Smith's G1; 0 for directions that end on the wrong side."""
    right = np.maximum(cos, 1e-12)
    return np.where(cos > 0, 2 * right / (right + np.sqrt(alpha**2 + (1 - alpha**2) * right * right)), 0)


def _visible_normals(cos: float, alpha: float) -> tuple[Points, Points]:
    """x and z of the GGX normals seen from (sin, 0, cos), evenly spread over what is visible (Heitz 2018)."""
    u = (np.arange(_NODES) + 0.5) / _NODES
    radius, angle = np.meshgrid(np.sqrt(u), 2 * np.pi * u)
    sin = float(np.sqrt(1 - cos * cos))
    # A disk across the stretched eye direction, lifted to the hemisphere, and stretched back.
    eye_x, eye_z = np.array([alpha * sin, cos]) / np.hypot(alpha * sin, cos)
    x, y = radius * np.cos(angle), radius * np.sin(angle)
    share = (1 + eye_z) / 2
    x = (1 - share) * np.sqrt(1 - y * y) + share * x
    lift = np.sqrt(np.maximum(0, 1 - x * x - y * y))
    normal_x, normal_y, normal_z = alpha * (eye_x * lift - eye_z * x), alpha * y, np.maximum(1e-12, eye_z * lift + eye_x * x)
    length = np.sqrt(normal_x**2 + normal_y**2 + normal_z**2)
    return normal_x / length, normal_z / length
