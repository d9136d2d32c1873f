"""All transports with all estimators at equal time, with maps of their errors."""

from __future__ import annotations

from .. import _core, gloss
from ..result import Result
from ..settings import TRANSPORTS
from . import pictures, plots, references
from .figure import Curve, Figure, Table
from .lab import BUST, Lab
from .references import Reference, mean_time

WORKS = {"reference": 36.0, "transports": 48.0}


def make(lab: Lab) -> Figure:
    """A map of the errors in gloss for each pair, and a table."""
    reference = references.of_bust(lab)
    names = sorted(_core.estimators(), key=list(plots.COLOURS).index)
    pairs = [(transport, name) for transport in TRANSPORTS for name in names]
    each = lab.budget.take("transports") / len(pairs)
    runs: dict[tuple[str, str], Result] = {}
    for transport, name in pairs:
        lab.begin(f"{transport} with {name}")
        runs[transport, name] = lab.render(BUST, transport=transport, estimator=name, time=each)
    error = {pair: reference.error(run) for pair, run in runs.items()}
    best = min(error, key=lambda pair: error[pair])
    return Figure(
        title="All transports with all estimators, at equal time",
        scene=lab.scene(BUST).source,
        shows=f"""Errors of the light in gloss after {mean_time(runs.values()):.1f} s each, with the defaults of `lumel render`:
        `classical` is shooting alone, the others join gathering samples to it, and mix rays of the lobe that start at what the
        eye sees into the picture where that is better, in the same time. Red is too bright, blue too dark, white right; grey has no
        light in gloss. The numbers are relMSE; the noise of the reference, {reference.noise:.2g}, is subtracted.""",
        claim="""Not in the paper. Every transport makes samples for every estimator, and all pairs converge to the same picture.""",
        found=[f"Least error: {best[0]} with `{best[1]}`, relMSE {error[best]:.3g}."],
        pictures=[
            pictures.error_map(
                f"transports.{transport}.{name}",
                run.layer(gloss.LAYER),
                reference.light,
                f"{transport}, {name}: {error[transport, name]:.3g}",
                f"map of the errors of {transport} with {name}",
            )
            for (transport, name), run in runs.items()
        ],
        columns=len(names),
        curves=[Curve("transports", "colours of the errors", _scale())],
        tables=[_table(runs, error, reference)],
    )


def _table(runs: dict[tuple[str, str], Result], error: dict[tuple[str, str], float], reference: Reference) -> Table:
    rows = []
    for (transport, name), run in runs.items():
        work = f"{run.stats['directions']} directions" if transport == "bundles" else f"{int(str(run.stats['rays'])) / 1e6:.2f} M rays"
        whole = reference.error_of_picture(run)
        rows.append((transport, name, float(str(run.stats["time"])), work, error[transport, name], reference.ratio(run), whole))
    head = ("transport", "estimator", "time, s", "work", "relMSE of the gloss", "mean ratio", "relMSE of the picture")
    return Table("transports", "Errors at equal time", head, rows)


def _scale() -> str:
    """A bar of the colours."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    with plots.panels([""]) as (figure, (axes,)):
        figure.set_size_inches(5.0, 0.62)
        full = 100 * pictures.FULL_COLOUR
        bar = figure.colorbar(ScalarMappable(Normalize(-full, full), "RdBu_r"), cax=axes, orientation="horizontal")
        bar.set_label("relative error, %")
        return plots.to_svg(figure, "transports")
