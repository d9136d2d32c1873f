"""What `lumel.render` says of settings that are no numbers, or out of their range."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from lumel.settings import Settings


def messages(**values: Any) -> list[str]:
    """What is wrong with the defaults, changed to `values`."""
    return [problem.message for problem in replace(Settings(), **values).problems()]


@pytest.mark.parametrize(
    ("values", "name"),
    [
        ({"rays": "5"}, "rays"),
        ({"rays": 1e6}, "rays"),
        ({"directions": 1.5}, "directions"),
        ({"window": "wide"}, "window"),
        ({"seed": None}, "seed"),
        ({"seed": 1.5}, "seed"),
        ({"threads": None}, "threads"),
        ({"patches": "many"}, "patches"),
        ({"time": "3"}, "time"),
        ({"error": [0.1]}, "error"),
        ({"gather": 1j}, "gather"),
        ({"defensive": ""}, "defensive"),
        ({"size": (16, 16, 3)}, "size"),
        ({"size": (16.5, 16)}, "size"),
        ({"size": "16x16"}, "size"),
    ],
)
def test_what_is_no_number_is_named_with_what_is_allowed(values: dict[str, object], name: str) -> None:
    (message,) = messages(**values)
    assert message.startswith(f"{name} is {next(iter(values.values()))!r}; allowed: ")


def test_numbers_of_numpy_are_numbers() -> None:
    assert messages(rays=np.int64(1000), seed=np.uint8(3), size=(np.int32(16), np.int32(9)), gather=np.float32(2)) == []
    assert messages(time=np.float64(2.5), patches=np.int16(100), defensive=np.float32(0.5)) == []


@pytest.mark.parametrize("name", ["time", "error", "defensive", "gather"])
@pytest.mark.parametrize("value", [float("nan"), float("inf"), -1.0])
def test_each_number_out_of_its_range_is_named_once(name: str, value: float) -> None:
    (message,) = messages(**{name: value})
    assert message.startswith(f"{name} is {value:g}; allowed: ")


def test_all_problems_are_named_at_once() -> None:
    named = [message.split()[0] for message in messages(estimator="wieghted", rays=-5, seed=-1, size=(0, 0), gather=-2, threads=-1)]
    assert sorted(named) == ["gather", "rays", "seed", "size", "threads", "unknown"]


def test_what_a_transport_does_not_have_is_named_with_those_that_do() -> None:
    assert messages(transport="bundles", rays=1000, defensive=0.1) == [
        "rays is 1000, which the transport bundles does not have; allowed: with rays and walk",
        "defensive is 0.1, which the transport bundles does not have; allowed: with rays and walk",
    ]
    assert messages(directions=10, window=64, iteration="plain") == [
        "directions is 10, which the transport rays does not have; allowed: with bundles",
        "window is 64, which the transport rays does not have; allowed: with bundles",
        "iteration is plain, which the transport rays does not have; allowed: with bundles",
    ]
    assert messages(transport="bundles", directions=10, window=8) == ["window is 8; allowed: 16 to 4096 pixels"]
    assert messages(transport="bundles", directions=0) == ["directions is 0; allowed: 1 to 10^9"]
