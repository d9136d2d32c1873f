"""Materials from BSDFs. Values of BSDFs were computed by Mitsuba 3.9.1."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from lumel.readers.fresnel import largest_albedo
from lumel.scene import Material
from reading import Reader

DIFFUSE = '<bsdf type="diffuse"><rgb name="reflectance" value="0.2 0.5 0.7"/></bsdf>'


def rough(alpha: float = 0.3, more: str = "") -> str:
    """A roughconductor."""
    return f'<bsdf type="roughconductor"><string name="distribution" value="ggx"/><float name="alpha" value="{alpha}"/>{more}</bsdf>'


def blend(weight: float, first: str, second: str) -> str:
    """A blendbsdf."""
    return f'<bsdf type="blendbsdf"><float name="weight" value="{weight}"/>{first}{second}</bsdf>'


@pytest.fixture
def reader(tmp_path: Path) -> Reader:
    return Reader(tmp_path)


def f_cos(material: Material, wi: npt.NDArray[np.float64], wo: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """The BRDF times the cosine of wo, by the formula that a Material stands for."""
    half = (wi + wo) / np.linalg.norm(wi + wo)
    a2 = material.alpha**2
    density = a2 / (np.pi * (half[2] ** 2 * (a2 - 1) + 1) ** 2)
    shadow = np.prod([2 * w[2] / (w[2] + np.sqrt(a2 + (1 - a2) * w[2] ** 2)) for w in (wi, wo)])
    fresnel = np.ones(3)
    if material.eta is not None:
        cos, index = half @ wi, np.array(material.eta) + 1j * np.array(material.k)
        beyond = np.sqrt(1 - (1 - cos**2) / index**2)
        across, along = (cos - index * beyond) / (cos + index * beyond), (index * cos - beyond) / (index * cos + beyond)
        fresnel = (np.abs(across) ** 2 + np.abs(along) ** 2) / 2
    lobe = np.array(material.specular) * fresnel * density * shadow / (4 * wi[2] * wo[2])
    return np.asarray((np.array(material.diffuse) / np.pi + lobe) * wo[2])


METAL = '<rgb name="eta" value="0.2 0.92 1.1"/><rgb name="k" value="3.91 2.45 2.14"/>'
GOLD = '<rgb name="specular_reflectance" value="0.9 0.4 0.1"/>'
WI, WO = np.array([0.48, -0.36, 0.8]), np.array([-0.6, 0.0, 0.8])


@pytest.mark.parametrize(
    ("bsdf", "expected"),
    [
        (DIFFUSE, [0.05093, 0.127324, 0.178254]),
        (rough(), [0.455506, 0.455506, 0.455506]),
        (rough(0.15, GOLD), [0.360099, 0.160044, 0.040011]),
        (rough(0.3, METAL), [0.433423, 0.28235, 0.233084]),
        (rough(0.3, '<rgb name="eta" value="0.2 0.92 1.1"/>'), [0.31353, 0.103305, 0.089242]),
        (rough(0.3, '<rgb name="k" value="3"/>'), [0.455506, 0.455506, 0.455506]),
        (blend(0.3, DIFFUSE, rough()), [0.172303, 0.225779, 0.261429]),
        (blend(0.3, rough(0.3, GOLD), DIFFUSE), [0.302248, 0.165739, 0.085361]),
        (blend(0.4, blend(0.8, DIFFUSE, rough()), rough(0.3, GOLD)), [0.388737, 0.306803, 0.258254]),
    ],
)
def test_values_are_mitsubas(reader: Reader, bsdf: str, expected: list[float]) -> None:
    np.testing.assert_allclose(f_cos(reader.material(bsdf), WI, WO), expected, atol=2e-6)


def test_shared_vectors_use_the_same_formula(shared: Path) -> None:
    rows = np.genfromtxt(shared / "vectors" / "ggx_eval.csv", delimiter=",", names=True)
    for row in rows[::20]:
        material = Material("m", specular=(1, 1, 1), alpha=float(row["alpha"]))
        wi, wo = (np.array([row[f"{name}{axis}"] for axis in "xyz"]) for name in ("wi", "wo"))
        # f_cos there has the cosine of wi, here that of wo.
        np.testing.assert_allclose(f_cos(material, wo, wi)[0], row["f_cos"], rtol=2e-4, atol=1e-6)


def test_defaults_are_mitsubas(reader: Reader) -> None:
    assert reader.material("") == Material("default", diffuse=(0.5, 0.5, 0.5), two_sided=False)
    plain = reader.material('<bsdf type="diffuse" id="d"/>')
    assert plain == Material("d", diffuse=(0.5, 0.5, 0.5), two_sided=False)
    mirror = reader.material('<bsdf type="conductor" id="c"/>')
    assert mirror == Material("c", mirror=(1, 1, 1), two_sided=False)
    lobe = reader.material('<bsdf type="roughconductor" id="r"><string name="distribution" value="GGX"/></bsdf>')
    assert lobe == Material("r", specular=(1, 1, 1), alpha=0.1, two_sided=False)
    half = reader.material(f'<bsdf type="blendbsdf" id="b">{DIFFUSE}{DIFFUSE.replace("0.2 0.5 0.7", "0.4 0.1 0.1")}</bsdf>')
    np.testing.assert_allclose(half.diffuse, [0.3, 0.3, 0.4])


def test_mirrors_and_sides(reader: Reader) -> None:
    mixed = reader.material(
        f'<bsdf type="twosided" id="t">{blend(0.25, DIFFUSE, f"""<bsdf type="conductor">{METAL}{GOLD}</bsdf>""")}</bsdf>'
    )
    np.testing.assert_allclose(mixed.mirror, [0.225, 0.1, 0.025])
    assert (mixed.eta, mixed.k, mixed.two_sided) == ((0.2, 0.92, 1.1), (3.91, 2.45, 2.14), True)
    both = reader.material(blend(0.5, rough(0.2), '<bsdf type="conductor"/>'))
    assert (both.specular, both.mirror, both.alpha, both.two_sided) == ((0.5,) * 3, (0.5,) * 3, 0.2, False)
    inner = f'<bsdf type="twosided">{DIFFUSE}</bsdf>'
    assert reader.material(blend(0.5, inner, inner)).two_sided


def test_references(reader: Reader) -> None:
    scene = reader.scene(
        '<shape type="cube"><ref id="mix"/></shape><shape type="cube"><ref id="mix"/></shape>'
        f'<bsdf type="blendbsdf" id="mix"><ref id="one"/><ref id="two"/></bsdf>'
        f'{DIFFUSE.replace("<bsdf", """<bsdf id="one" """)}{rough().replace("<bsdf", """<bsdf id="two" """)}'
    )
    assert list(scene.materials) == ["mix"]
    np.testing.assert_allclose(scene.materials["mix"].diffuse, [0.1, 0.25, 0.35])


def test_colours_may_be_grey_numbers_or_hex(reader: Reader) -> None:
    for value, expected in [
        ('<float name="reflectance" value="0.25"/>', (0.25,) * 3),
        ('<spectrum name="reflectance" value="0.25"/>', (0.25,) * 3),
        ('<rgb name="reflectance" value="0.25"/>', (0.25,) * 3),
        ('<integer name="reflectance" value="1"/>', (1, 1, 1)),
        ('<rgb name="reflectance" value="#808080"/>', (0.21586050,) * 3),
    ]:
        np.testing.assert_allclose(reader.material(f'<bsdf type="diffuse">{value}</bsdf>').diffuse, expected, rtol=1e-6)


DENSE = (
    'type="roughplastic"><string name="distribution" value="ggx"/><float name="alpha" value="0.4"/>'
    '<rgb name="diffuse_reflectance" value="0.3"/><float name="int_ior" value="1.8"/>'
)


# Albedo of the diffuse part for diffuse light, by Monte Carlo over Mitsuba's BSDF, with a relative standard error of 0.3 %.
@pytest.mark.parametrize(
    ("bsdf", "albedo"),
    [
        ('type="plastic">', 0.4554),
        ('type="plastic"><rgb name="diffuse_reflectance" value="0.9"/>', 0.8200),
        ('type="plastic"><rgb name="diffuse_reflectance" value="0.9"/><boolean name="nonlinear" value="true"/>', 0.7172),
        ('type="plastic"><string name="int_ior" value="diamond"/><string name="ext_ior" value="water"/>', 0.4308),
        ('type="roughplastic"><string name="distribution" value="ggx"/>', 0.4152),
        (DENSE, 0.1289),
    ],
)
def test_plastics_have_mitsubas_mean_albedo(reader: Reader, bsdf: str, albedo: float) -> None:
    material = reader.material(f"<bsdf {bsdf}</bsdf>")
    np.testing.assert_allclose(material.diffuse, [albedo] * 3, rtol=0.02)
    assert material.eta is not None
    assert not any(material.k)
    most = largest_albedo(material.alpha, material.eta[0])
    assert max(material.diffuse) + max(material.specular) * most < 1


def test_a_white_coat_is_dimmed_and_says_so(reader: Reader) -> None:
    white = '<rgb name="diffuse_reflectance" value="1"/>'
    scene = reader.scene(f'<shape type="cube"><bsdf type="plastic" id="white">{white}</bsdf></shape><sensor type="perspective"/>')
    assert 0 < scene.materials["white"].specular[0] < 0.3
    (note,) = scene.notes
    assert "'white'" in note
    assert "dimmed" in note


def test_the_dielectric_lobe_at_normal_incidence() -> None:
    # A smooth surface reflects ((n - 1)/(n + 1))^2 there and everything at grazing incidence.
    from lumel.readers.fresnel import _albedos

    assert _albedos(1.0, 1e-3, 1.5)[0] == pytest.approx(0.04, rel=1e-3)
    assert _albedos(1.0, 1e-3, 1.5)[1] == pytest.approx(0.96, rel=1e-3)
    assert _albedos(0.5, 0.0, 1 / 1.5)[0] == pytest.approx(1)  # total reflection
    assert _albedos(0.02, 0.0, 1.5)[0] > 0.85


@pytest.mark.parametrize(
    ("bsdf", "message"),
    [
        (
            '<bsdf type="diffuse" id="bright"><rgb name="reflectance" value="1.2 0 0"/></bsdf>',
            "material 'bright': 'reflectance' is 1.2 0 0",
        ),
        ('<bsdf type="diffuse" id="dark"><rgb name="reflectance" value="-0.1"/></bsdf>', "material 'dark': 'reflectance' is -0.1"),
        (
            '<bsdf type="twosided" id="outer">' + rough(0.3, '<rgb name="specular_reflectance" value="2"/>') + "</bsdf>",
            "material 'outer': 'specular_reflectance' is 2",
        ),
        (rough(0.0), "0.001 to 1"),
        (rough(1.5), "0.001 to 1"),
        (blend(1.5, DIFFUSE, DIFFUSE), "'weight' is 1.5"),
        (blend(0.5, DIFFUSE, ""), "needs 2 nested bsdfs, not 1"),
        (blend(0.5, DIFFUSE, DIFFUSE + DIFFUSE), "needs 2 nested bsdfs, not 3"),
        (blend(0.5, rough(0.1), rough(0.2)), "GGX alpha 0.1 and GGX alpha 0.2"),
        (blend(0.5, rough(0.1, METAL), '<bsdf type="conductor"/>'), "different specular lobes"),
        (blend(0.5, f'<bsdf type="twosided">{DIFFUSE}</bsdf>', DIFFUSE), "one-sided and a twosided"),
        ('<bsdf type="twosided"/>', "needs 1 nested bsdf, not 0"),
        (f'<bsdf type="twosided">{DIFFUSE}{DIFFUSE}</bsdf>', "needs 1 nested bsdf, not 2"),
        ('<bsdf type="roughconductor"/>', "means 'beckmann', which is not supported; allowed: ggx"),
        ('<bsdf type="roughconductor"><string name="distribution" value="beckmann"/></bsdf>', "distribution 'beckmann' is not supported"),
        (rough(0.1, '<string name="material" value="Au"/>'), "the metal 'Au' is not supported"),
        (rough(0.1).replace('name="alpha"', 'name="alpha_u"').replace("</bsdf>", '<float name="alpha_v" value="0.2"/></bsdf>'), "differ"),
        ('<bsdf type="plastic"><float name="int_ior" value="1.2"/><float name="ext_ior" value="1.5"/></bsdf>', "'int_ior' 1.2 is below"),
        ('<bsdf type="plastic"><string name="int_ior" value="watr"/></bsdf>', "did you mean 'water'"),
        ('<bsdf type="diffuse"><texture type="bitmap" name="reflectance"/></bsdf>', "texture 'bitmap' in 'reflectance'"),
        ('<bsdf type="diffuse"><float name="reflectence" value="0.1"/></bsdf>', "did you mean 'reflectance'"),
        ('<bsdf type="dielectric"/>', "bsdf 'dielectric' is not supported"),
        (DIFFUSE + DIFFUSE, "more than one bsdf"),
    ],
)
def test_wrong_bsdfs(reader: Reader, bsdf: str, message: str) -> None:
    assert message in reader.problem(f'<shape type="cube">{bsdf}</shape><sensor type="perspective"/>')


def test_circles_and_chains(reader: Reader) -> None:
    cube = '<shape type="cube"><ref id="b0"/></shape>'
    circle = '<bsdf type="twosided" id="b0"><ref id="b1"/></bsdf><bsdf type="twosided" id="b1"><ref id="b0"/></bsdf>'
    assert "contains itself" in reader.problem(cube + circle)
    chain = "".join(f'<bsdf type="blendbsdf" id="b{i}"><ref id="b{i + 1}"/><ref id="b{i + 1}"/></bsdf>' for i in range(25))
    assert reader.scene(cube + chain + '<bsdf type="diffuse" id="b25"/>').materials["b0"].diffuse == (0.5, 0.5, 0.5)
    long = "".join(f'<bsdf type="twosided" id="b{i}"><ref id="b{i + 1}"/></bsdf>' for i in range(3000))
    assert all("within each other" in message for _, message in reader.problems(cube + long + '<bsdf type="diffuse" id="b3000"/>')[:-1])


def test_lenient_takes_what_is_nearest(reader: Reader) -> None:
    glass = reader.material('<bsdf type="dielectric" id="g"/>', lenient=True)
    assert glass.diffuse == (0.5, 0.5, 0.5)
    assert reader.material('<bsdf type="roughconductor" id="r"/>', lenient=True).specular == (1, 1, 1)
    assert reader.material(blend(0.5, rough(0.1), rough(0.2)), lenient=True).alpha == 0.1
