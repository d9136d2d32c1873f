"""Mitsuba's BSDFs as lumel materials.

`diffuse`, `roughconductor` (GGX), `conductor`, `twosided` and `blendbsdf` are exact. `plastic` and `roughplastic` are approximated:
the diffuse light that is scattered below the coat becomes Lambert with the same mean albedo, the coat a GGX lobe with the Fresnel
reflectance of its index (roughness 0.05 where it is smooth). Where both together would reflect more than all the light at some angle,
the coat is dimmed.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from ..scene import BLACK, Material, Rgb
from .findings import Findings
from .fresnel import base_albedo, largest_albedo
from .plugins import Plugin, is_supported
from .references import References
from .tree import Node

WHITE: Rgb = (1.0, 1.0, 1.0)
GREY: Rgb = (0.5, 0.5, 0.5)
SMOOTH_PLASTIC = 0.05  # roughness that stands for none
_DEEPEST = 32  # BSDFs within BSDFs

# Indices of refraction that files give by name.
INDICES = {
    "vacuum": 1.0, "helium": 1.000036, "hydrogen": 1.000132, "air": 1.000277, "carbon dioxide": 1.00045, "water": 1.333,
    "acetone": 1.36, "ethanol": 1.361, "carbon tetrachloride": 1.461, "glycerol": 1.4729, "benzene": 1.501,
    "silicone oil": 1.52045, "bromine": 1.661, "water ice": 1.31, "fused quartz": 1.458, "pyrex": 1.47, "acrylic glass": 1.49,
    "polypropylene": 1.49, "bk7": 1.5046, "sodium chloride": 1.544, "amber": 1.55, "pet": 1.575, "diamond": 2.419,
}  # fmt: skip


@dataclass(frozen=True)
class Lobe:
    """One specular part: a perfect mirror (`alpha` 0) or a GGX lobe; `tint` is its share. `eta` None: Fresnel 1."""

    tint: Rgb
    alpha: float
    eta: Rgb | None
    k: Rgb


@dataclass(frozen=True)
class Reflection:
    """What one BSDF reflects."""

    diffuse: Rgb = BLACK
    lobes: tuple[Lobe, ...] = ()
    two_sided: bool = False


DEFAULT = Reflection(diffuse=GREY)  # what a shape without BSDF is made of


class BsdfReader:
    """Reads BSDFs, each once."""

    def __init__(self, references: References, findings: Findings) -> None:
        self._references = references
        self._findings = findings
        self._done: dict[int, Reflection] = {}
        self._open: list[int] = []

    def read(self, node: Node, label: str) -> Reflection:
        """The reflection of a `<bsdf>`; after a problem, which is reported, that of a shape without BSDF."""
        if id(node) in self._done:
            return self._done[id(node)]
        if id(node) in self._open:
            self._findings.wrong(f"{label}: '{node.id}' contains itself", node)
            return DEFAULT
        if len(self._open) >= _DEEPEST:
            self._findings.wrong(f"{label}: more than {_DEEPEST} BSDFs within each other", node)
            return DEFAULT
        self._open.append(id(node))
        self._done[id(node)] = self._read(node, f"material '{node.id}'" if node.id else label)
        self._open.pop()
        return self._done[id(node)]

    def _read(self, node: Node, label: str) -> Reflection:
        if not is_supported(node, _BSDFS, self._findings, label):
            return DEFAULT
        plugin = Plugin(node, self._findings, label)
        reflection = _BSDFS[node.type](self, plugin)
        plugin.done()
        return reflection

    def nested(self, plugin: Plugin, count: int) -> list[Reflection]:
        """The BSDFs inside another; exactly `count`, else reported and filled up or cut."""
        nodes = plugin.children("bsdf", "ref")
        if len(nodes) != count:
            message = f"{plugin.label}: {plugin.node.type} needs {count} nested bsdf{'s' * (count > 1)}, not {len(nodes)}"
            report = self._findings.unsupported if len(nodes) > count else self._findings.wrong
            report(message, plugin.node)
        found = [self._references.resolve(node, "bsdf") for node in nodes[:count]]
        read = [self.read(node, plugin.label) if node else DEFAULT for node in found]
        return read + [DEFAULT] * (count - len(read))


def _diffuse(_: BsdfReader, plugin: Plugin) -> Reflection:
    return Reflection(diffuse=plugin.colour("reflectance", GREY, 0, 1))


def _twosided(reader: BsdfReader, plugin: Plugin) -> Reflection:
    return replace(reader.nested(plugin, 1)[0], two_sided=True)


def _blend(reader: BsdfReader, plugin: Plugin) -> Reflection:
    weight = plugin.colour("weight", GREY, 0, 1)
    share = sum(weight) / 3
    first, second = reader.nested(plugin, 2)
    if first.two_sided != second.two_sided:
        plugin.findings.unsupported(f"{plugin.label}: a blend of a one-sided and a twosided bsdf is not supported", plugin.node)
    lobes: dict[tuple[float, Rgb | None, Rgb], Rgb] = {}
    for part, amount in ((first, 1 - share), (second, share)):
        for lobe in part.lobes:
            key = (lobe.alpha, lobe.eta, lobe.k)
            lobes[key] = _add(lobes.get(key, BLACK), lobe.tint, amount)
    diffuse = _add(_add(BLACK, first.diffuse, 1 - share), second.diffuse, share)
    merged = tuple(Lobe(tint, *key) for key, tint in lobes.items() if any(tint))
    return Reflection(diffuse, _fitting(merged, plugin), first.two_sided)


def _fitting(lobes: tuple[Lobe, ...], plugin: Plugin) -> tuple[Lobe, ...]:
    """The lobes that one material can hold: one rough, one mirror, of one index."""
    kept: list[Lobe] = []
    for lobe in lobes:
        if all(bool(lobe.alpha) != bool(other.alpha) and (lobe.eta, lobe.k) == (other.eta, other.k) for other in kept):
            kept.append(lobe)
        else:
            lobes_named = f"{_describe(kept[0])} and {_describe(lobe)}"
            plugin.findings.unsupported(f"{plugin.label}: a blend of different specular lobes is not supported: {lobes_named}", plugin.node)
    return tuple(kept)


def _describe(lobe: Lobe) -> str:
    kind = f"GGX alpha {lobe.alpha:g}" if lobe.alpha else "mirror"
    return kind if lobe.eta is None else f"{kind} eta {lobe.eta} k {lobe.k}"


def _add(base: Rgb, other: Rgb, amount: float) -> Rgb:
    red, green, blue = (min(a + amount * b, 1.0) for a, b in zip(base, other, strict=True))
    return red, green, blue


def _roughconductor(_: BsdfReader, plugin: Plugin) -> Reflection:
    if not plugin.has("distribution"):
        plugin.findings.unsupported(
            f"{plugin.label}: roughconductor without 'distribution' means 'beckmann', which is not supported; allowed: ggx", plugin.node
        )
    _distribution(plugin)
    return _conductor_lobe(plugin, _alpha(plugin))


def _conductor(_: BsdfReader, plugin: Plugin) -> Reflection:
    return _conductor_lobe(plugin, 0.0)


def _distribution(plugin: Plugin) -> None:
    found = plugin.text("distribution", "ggx")
    if found.strip().lower() != "ggx":
        plugin.findings.unsupported(f"{plugin.label}: distribution '{found}' is not supported; allowed: ggx", plugin.node)
    plugin.skip("sample_visible")


def _alpha(plugin: Plugin) -> float:
    """The roughness; `alpha_u` and `alpha_v` are read where they are equal."""
    alpha = plugin.number("alpha", 0.1, 0.001, 1)
    if not (plugin.has("alpha_u") or plugin.has("alpha_v")):
        return alpha
    if plugin.has("alpha"):
        plugin.findings.wrong(f"{plugin.label}: give either 'alpha' or 'alpha_u' and 'alpha_v'", plugin.node)
    u, v = (plugin.number(name, 0.1, 0.001, 1) for name in ("alpha_u", "alpha_v"))
    if u != v:
        message = f"{plugin.label}: 'alpha_u' {u:g} and 'alpha_v' {v:g} differ, which is not supported"
        plugin.findings.unsupported(message, plugin.node)
    return float((u * v) ** 0.5) if u != v else u


def _conductor_lobe(plugin: Plugin, alpha: float) -> Reflection:
    tint = plugin.colour("specular_reflectance", WHITE, 0, 1)
    material = plugin.text("material", "none")
    if material.strip().lower() != "none":
        message = f"{plugin.label}: the metal '{material}' is not supported; allowed: none, or 'eta' and 'k' as rgb"
        plugin.findings.unsupported(message, plugin.node)
    eta = plugin.colour("eta", BLACK, 0, 1000)
    k = plugin.colour("k", WHITE, 0, 1000)
    # An index without real part reflects everything, at all angles.
    return Reflection(lobes=(Lobe(tint, alpha, eta, k) if any(eta) else Lobe(tint, alpha, None, BLACK),))


def _plastic(_: BsdfReader, plugin: Plugin) -> Reflection:
    return _coated(plugin, 0.0)


def _roughplastic(_: BsdfReader, plugin: Plugin) -> Reflection:
    found = plugin.choice("distribution", "beckmann", ("beckmann", "ggx"))
    if found != "ggx":
        plugin.findings.note(f"{plugin.label}: GGX stands for the distribution 'beckmann'", plugin.node)
    plugin.skip("sample_visible")
    return _coated(plugin, _alpha(plugin))


def _coated(plugin: Plugin, alpha: float) -> Reflection:
    """A diffuse base below a dielectric coat of roughness `alpha`, 0 for smooth."""
    base = plugin.colour("diffuse_reflectance", GREY, 0, 1)
    tint = plugin.colour("specular_reflectance", WHITE, 0, 1)
    nonlinear = plugin.flag("nonlinear", False)
    inside, outside = _index(plugin, "int_ior", "acrylic glass"), _index(plugin, "ext_ior", "air")
    if inside < outside:
        plugin.findings.wrong(f"{plugin.label}: 'int_ior' {inside:g} is below 'ext_ior' {outside:g}", plugin.node)
        inside = outside
    eta = inside / outside
    passed, kept = base_albedo(alpha, eta)
    diffuse = _map(base, lambda rho: rho * passed / (1 - kept * (rho if nonlinear else 1.0)))
    alpha = alpha or SMOOTH_PLASTIC
    most = largest_albedo(alpha, eta)
    free = [0.995 * (1 - albedo) / (share * most) for albedo, share in zip(diffuse, tint, strict=True) if share * most > 0]
    dimmed = min([1.0, *free])
    if dimmed < 1:
        message = f"{plugin.label}: the coat is dimmed to {dimmed:.2f}, so that no angle reflects more than all light"
        plugin.findings.note(message, plugin.node)
    lobe = Lobe(_map(tint, lambda share: share * dimmed), alpha, (eta, eta, eta), BLACK)
    return Reflection(diffuse, (lobe,))


def _map(colour: Rgb, change: Callable[[float], float]) -> Rgb:
    red, green, blue = (change(part) for part in colour)
    return red, green, blue


def _index(plugin: Plugin, name: str, default: str) -> float:
    """An index of refraction, as a number or by the name of a substance."""
    if plugin.is_text(name):
        return INDICES[plugin.choice(name, default, INDICES)]
    return plugin.number(name, INDICES[default], 1, 10)


_BSDFS: dict[str, Callable[[BsdfReader, Plugin], Reflection]] = {
    "diffuse": _diffuse,
    "twosided": _twosided,
    "blendbsdf": _blend,
    "roughconductor": _roughconductor,
    "conductor": _conductor,
    "plastic": _plastic,
    "roughplastic": _roughplastic,
}


def to_material(name: str, reflection: Reflection) -> Material:
    """The material of that name."""
    rough = next((lobe for lobe in reflection.lobes if lobe.alpha), None)
    mirror = next((lobe for lobe in reflection.lobes if not lobe.alpha), None)
    coat = rough or mirror
    return Material(
        name,
        diffuse=reflection.diffuse,
        specular=rough.tint if rough else BLACK,
        alpha=rough.alpha if rough else 0.1,
        mirror=mirror.tint if mirror else BLACK,
        eta=coat.eta if coat else None,
        k=coat.k if coat else BLACK,
        two_sided=reflection.two_sided,
    )
