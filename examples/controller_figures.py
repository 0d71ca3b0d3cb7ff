"""The picture of a comparison of controllers: errors over two periods on two rigs, and every RMSE."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np

mpl.use("Agg")
SHOWN = 2.0  # s of error drawn
LINEAR = 10.0  # µm; errors beyond that are drawn on a logarithmic scale


def titled(rig: str) -> str:
    """A rig with the unit of its leakage."""
    return f"{rig} m³/(s Pa)" if rig.startswith("leakage") else rig


def draw(rows: list[dict[str, Any]], path: Path) -> None:
    """Draw the comparison's rows (controller, rig, rmse, errors) to a PNG."""
    rigs = list(dict.fromkeys(row["rig"] for row in rows))
    names = list(dict.fromkeys(row["controller"] for row in rows))
    colours = {name: f"C{number}" for number, name in enumerate(names)}
    figure, (left, middle, right) = plt.subplots(
        1, 3, figsize=(14, 4.2), layout="constrained", width_ratios=(1, 1, 1.3)
    )
    for axes, rig in ((left, rigs[0]), (middle, rigs[-1])):
        for row in (row for row in rows if row["rig"] == rig):
            time, error = np.array(row["errors"]).T
            inside = time <= time[0] + SHOWN
            axes.plot(time[inside], 1e6 * error[inside], color=colours[row["controller"]], lw=1)
        axes.set(title=titled(rig), xlabel="time [s]", ylabel=f"position error [µm], linear within {LINEAR:g}")
        axes.set_yscale("symlog", linthresh=LINEAR)
        axes.grid(alpha=0.3)
    width = 0.8 / len(names)
    for number, name in enumerate(names):
        found = {row["rig"]: 1e6 * row["rmse"] for row in rows if row["controller"] == name}
        places = [rigs.index(rig) + number * width - 0.4 + width / 2 for rig in found]
        right.bar(places, list(found.values()), width, color=colours[name], label=name)
    right.set_xticks(range(len(rigs)), rigs, rotation=20)
    right.set(yscale="log", ylabel="RMSE of the position [µm]", title="every rig, leakage in m³/(s Pa)")
    right.grid(alpha=0.3, axis="y")
    figure.legend(loc="outside lower center", ncols=len(names))
    figure.savefig(path, dpi=110)
    plt.close(figure)
