"""Documents of diagnoses as small as a budget takes them."""

from __future__ import annotations

from typing import Any

FRICTION, LEAKAGE, MASS = "coulomb_friction.force", "internal_leakage", "moving_mass"


def document(**changes: Any) -> dict[str, Any]:
    """Friction of 250 N, a leakage that grew a hundredfold, and 2 kg more mass; friction and mass are correlated."""
    made = {
        "schema": "eha.diagnosis/1",
        "plant": {"source": "servo_valve", "cylinder": "double_rod", "load": "sprung_mass"},
        "fitted_values": {FRICTION: 250.0, LEAKAGE: 1e-10, MASS: 11.0},
        "parameters": [
            {"name": MASS, "nominal": 9.0, "std": 0.5, "changed": True},
            {"name": LEAKAGE, "nominal": 1e-12, "std": 1e-12, "changed": True},
        ],
        "effects": [
            {"id": "coulomb_friction", "statement": "the seals rub", "active": None,
             "parameters": {"force": {"value": 250.0, "std": 2.0, "unit": "N"}}},
        ],
        "alternatives": [],
        "correlation": {"names": [MASS, LEAKAGE, FRICTION],
                        "matrix": [[1.0, 0.0, 0.5], [0.0, 1.0, 0.0], [0.5, 0.0, 1.0]]},
    }  # fmt: skip
    return made | changes
