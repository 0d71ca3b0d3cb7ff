"""A nominal model from an FMU: the start values of those of its parameters that have a name of the catalogue."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element
from zipfile import BadZipFile, ZipFile

from eha_core.errors import ParameterError
from eha_core.export.units import base_unit
from eha_core.nominal import NominalModel, nominal_of
from eha_core.plant import composition_of

LARGEST = 2**26
"""Bytes of a `modelDescription.xml` that is read; that of a model with 100,000 variables has half of it (assumed)."""


def read_fmu(path: str | Path) -> NominalModel:
    """The nominal model that an FMU of FMI 2.0 or 3.0 states; what it does not state is the catalogue's.

    Its parameters count where their names are the catalogue's, in the unit that it states for them. The plant's parts
    are those of its annotation, which `write_fmu` makes, or else the paper's.

    Raises:
        ParameterError: naming the file, where it is no FMU, has no parameter of such a name, states another unit than
            can be converted, or a value that does not fit.
    """
    root = _description(path)
    units = {unit.get("name", ""): _Unit.of(unit) for unit in root.iterfind("UnitDefinitions/Unit")}
    composition, known = composition_of(_parts(root)), {}
    for name, start, unit in _parameters(root):
        row = composition.rows.get(name)
        if row is None:
            continue
        try:
            known[name] = _in_si(float(start), unit, row.unit, units)
        except ValueError as error:
            raise ParameterError(f"{path}: {name} = {start} {unit}: {error}") from None
    if not known:
        raise ParameterError(
            f"{path}: no parameter of this FMU has a name of the catalogue, as `eha effects` and `eha init-rig` list"
            " them; write its values into a parameters file"
        )
    try:
        return nominal_of(known, composition=composition)
    except ParameterError as error:
        raise ParameterError(f"{path}: {error}") from error


def _description(path: str | Path) -> Element:
    """The root of an FMU's `modelDescription.xml`."""
    try:
        with ZipFile(path) as unit:
            entry = unit.getinfo("modelDescription.xml")
            if entry.file_size > LARGEST:
                raise ParameterError(
                    f"{path}: its modelDescription.xml has more than {LARGEST} bytes; give another FMU"
                )
            root = ElementTree.fromstring(unit.read(entry))
    except OSError as error:
        raise ParameterError(f"{path}: cannot be read ({error.strerror}); check the path") from error
    except (
        BadZipFile,
        KeyError,
        ElementTree.ParseError,
        RuntimeError,
    ) as error:  # the last: encrypted, or packed oddly
        raise ParameterError(f"{path}: is no FMU that can be read; give one of FMI 2.0 or 3.0") from error
    if root.tag != "fmiModelDescription" or root.get("fmiVersion", "")[:1] not in ("2", "3"):
        raise ParameterError(f"{path}: is no FMU of FMI 2.0 or 3.0; give one, or a parameters file")
    return root


def _parts(root: Element) -> Mapping[str, str]:
    """The plant's parts by kind, as `model_description` annotates them; none in an FMU of another tool."""
    for place in ("VendorAnnotations/Tool[@name='eha']/Plant", "Annotations/Annotation[@type='eha']/Plant"):
        annotation = root.find(place)
        if annotation is not None:
            return annotation.attrib
    return {}


def _parameters(root: Element) -> Iterator[tuple[str, str, str]]:
    """Name, start value and unit of each parameter that is a real number."""
    types = {
        kind.get("name", ""): kind.find("Real") if kind.tag == "SimpleType" else kind
        for kind in root.iterfind("TypeDefinitions/*")
    }
    for variable in root.iterfind("ModelVariables/*"):
        value = variable.find("Real") if variable.tag == "ScalarVariable" else variable
        if variable.get("causality") != "parameter" or value is None or value.get("start") is None:
            continue
        declared = types.get(value.get("declaredType", ""))
        unit = value.get("unit") or (declared.get("unit") if declared is not None else None) or ""
        yield variable.get("name", ""), value.get("start", ""), unit


@dataclass(frozen=True)
class _Unit:
    """A unit of an FMU: SI's value is `factor` times its own, plus `offset`; the powers of SI's base units."""

    powers: Mapping[str, int]
    factor: float
    offset: float

    @classmethod
    def of(cls, unit: Element) -> _Unit | None:
        """The unit of an element; None of one whose base units are not stated as numbers."""
        base = unit.find("BaseUnit")
        if base is None:
            return None
        said = dict(base.attrib)
        try:
            factor, offset = (float(said.pop(name, default)) for name, default in (("factor", 1.0), ("offset", 0.0)))
            return cls({name: int(power) for name, power in said.items() if int(power)}, factor, offset)
        except ValueError:
            return None


def _in_si(value: float, unit: str, wanted: str, units: Mapping[str, _Unit | None]) -> float:
    """A value in the catalogue's unit. Raises ValueError where its own cannot be converted to that."""
    if unit in ("", wanted):
        return value
    stated = units.get(unit)
    if stated is None or stated.powers != base_unit(wanted):
        raise ValueError(f"the FMU does not state this unit as one of {wanted}; write the value into a parameters file")
    return value * stated.factor + stated.offset
