"""Table 3 for people and for programs."""

from __future__ import annotations

from collections.abc import Sequence

from eha_core.paper.level import Level


def as_json(levels: Sequence[Level]) -> dict[str, list[dict[str, float]]]:
    """Return the table as table.json and rmse.json hold it; lengths in m, leakage in m^3/(s Pa)."""
    return {
        "levels": [
            {
                "internal_leakage": level.internal_leakage,
                "rmse": level.rmse,
                "printed": level.printed,
                "ratio": level.ratio,
                "closed_form": level.closed_form,
            }
            for level in levels
        ]
    }


def as_markdown(levels: Sequence[Level]) -> str:
    """Return the table in Markdown, lengths in mm."""
    lines = [
        "| level | K_Lin [m^3/(s Pa)] | RMSE [mm] | printed [mm] | computed / printed | closed form [mm] |",
        "|---|---|---|---|---|---|",
    ]
    lines += [
        f"| {number} | {level.internal_leakage:.0e} | {level.rmse * 1e3:.4f} | {level.printed * 1e3:.4f} "
        f"| {level.ratio:.3f} | {level.closed_form * 1e3:.4f} |"
        for number, level in enumerate(levels, 1)
    ]
    return "\n".join(lines)
