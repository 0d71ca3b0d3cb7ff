"""`modelDescription.xml` of an FMU."""

from __future__ import annotations

import uuid
from collections.abc import Mapping
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

from eha_core.export.model import ExportedModel, Variable
from eha_core.export.units import base_unit
from eha_core.version import __version__

TOKEN = {2: "guid", 3: "instantiationToken"}
ABILITIES = {
    2: {"canHandleVariableCommunicationStepSize": "true", "canGetAndSetFMUstate": "true",
        "canSerializeFMUstate": "true", "canNotUseMemoryManagementFunctions": "true"},
    3: {"canHandleVariableCommunicationStepSize": "true", "canGetAndSetFMUState": "true",
        "canSerializeFMUState": "true"},
}  # fmt: skip


def describe(model: ExportedModel, name: str, identifier: str, version: int) -> tuple[str, str]:
    """The document for FMI 2 or 3, and the token by which a library knows that it belongs to it."""
    acting = ", ".join(model.acting) or "none"
    root = Element("fmiModelDescription", {
        "fmiVersion": f"{version}.0", "modelName": name, TOKEN[version]: "",
        "description": f"Electro-hydraulic servo actuator ({model.composition}); effects that act: {acting}",
        "generationTool": f"eha {__version__}", "variableNamingConvention": "structured",
    })  # fmt: skip
    step = {"fixedInternalStepSize": repr(model.step_size)} if version == 3 else {}
    SubElement(root, "CoSimulation", {"modelIdentifier": identifier, **ABILITIES[version], **step})
    _add_units(SubElement(root, "UnitDefinitions"), model)
    SubElement(SubElement(root, "LogCategories"), "Category", {"name": "logStatusError"})
    SubElement(root, "DefaultExperiment", {"startTime": "0", "stopTime": "10", "stepSize": "0.001"})
    if version == 2:
        _add_parts(SubElement(SubElement(root, "VendorAnnotations"), "Tool", {"name": "eha"}), model)
    variables, structure = SubElement(root, "ModelVariables"), SubElement(root, "ModelStructure")
    for reference, variable in enumerate(model.variables):
        (_add_variable_2 if version == 2 else _add_variable_3)(variables, variable, str(reference))
    _add_structure(structure, model, version)
    if version == 3:
        _add_parts(SubElement(SubElement(root, "Annotations"), "Annotation", {"type": "eha"}), model)
    token = str(uuid.uuid5(uuid.NAMESPACE_URL, ElementTree.tostring(root, "unicode")))
    root.set(TOKEN[version], token)
    ElementTree.indent(root)
    return ElementTree.tostring(root, "unicode", xml_declaration=True) + "\n", token


def _add_parts(parent: Element, model: ExportedModel) -> None:
    """What no variable tells: the plant's parts."""
    SubElement(parent, "Plant", model.composition.names)


def _add_units(parent: Element, model: ExportedModel) -> None:
    for unit in sorted({variable.unit for variable in model.variables if variable.unit != "-"}):
        added = SubElement(parent, "Unit", {"name": unit})
        exponents = base_unit(unit)
        if exponents is not None:
            SubElement(added, "BaseUnit", {base: str(power) for base, power in exponents.items()})


def _values(variable: Variable) -> dict[str, str]:
    """What FMI 2 says of the type and FMI 3 of the variable."""
    known = {"unit": variable.unit} if variable.unit != "-" else {}
    bounds: Mapping[str, float | None] = {"min": variable.lower, "max": variable.upper, "start": variable.start}
    return known | {key: repr(float(value)) for key, value in bounds.items() if value is not None}


def _common(variable: Variable, reference: str) -> dict[str, str]:
    fixed = "tunable" if variable.tunable else "fixed"
    said = {"name": variable.name, "valueReference": reference, "description": variable.meaning}
    said |= {"causality": variable.causality,
             "variability": fixed if variable.causality == "parameter" else "continuous"}  # fmt: skip
    initial = {"parameter": "exact", "output": "calculated"}.get(variable.causality)
    return said | ({"initial": initial} if initial else {})


def _add_variable_2(parent: Element, variable: Variable, reference: str) -> None:
    SubElement(SubElement(parent, "ScalarVariable", _common(variable, reference)), "Real", _values(variable))


def _add_variable_3(parent: Element, variable: Variable, reference: str) -> None:
    SubElement(parent, "Float64", _common(variable, reference) | _values(variable))


def _add_structure(parent: Element, model: ExportedModel, version: int) -> None:
    outputs = [number for number, variable in enumerate(model.variables) if variable.causality == "output"]
    if version == 2:
        for kind in ("Outputs", "InitialUnknowns"):
            listed = SubElement(parent, kind)
            for number in outputs:
                SubElement(listed, "Unknown", {"index": str(number + 1)})
        return
    for kind in ("Output", "InitialUnknown"):
        for number in outputs:
            SubElement(parent, kind, {"valueReference": str(number)})
