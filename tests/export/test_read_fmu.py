"""An FMU as the nominal model: values by the catalogue's names, in the units that the FMU states."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest

from eha_core.api import given_model
from eha_core.errors import ParameterError
from eha_core.export.model import ExportedModel
from eha_core.export.model_description import describe
from eha_core.export.read_fmu import read_fmu
from eha_core.nominal import nominal_of
from eha_core.plant import PAPER, compose

UNITS = """<UnitDefinitions>
  <Unit name="bar"><BaseUnit kg="1" m="-1" s="-2" factor="1e5"/></Unit>
  <Unit name="degC"><BaseUnit K="1" offset="273.15"/></Unit>
  <Unit name="cm2"><BaseUnit m="2" factor="1e-4"/></Unit>
  <Unit name="slug"/>
  <Unit name="oz"><BaseUnit kg="1" factor="little"/></Unit>
</UnitDefinitions>"""


def packed(path: Path, document: str) -> Path:
    with zipfile.ZipFile(path, "w") as unit:
        unit.writestr("modelDescription.xml", document)
    return path


def of_another_tool(folder: Path, variables: str, version: str = "2.0", types: str = "") -> Path:
    """An FMU of a tool that has names of its own, too."""
    document = (
        f'<fmiModelDescription fmiVersion="{version}" modelName="press">{UNITS}{types}'
        f"<ModelVariables>{variables}</ModelVariables></fmiModelDescription>"
    )
    return packed(folder / "press.fmu", document)


def real(name: str, start: str, said: str = "", causality: str = "parameter") -> str:
    return f'<ScalarVariable name="{name}" causality="{causality}"><Real start="{start}" {said}/></ScalarVariable>'


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("composition", [PAPER, compose(cylinder="single_rod")], ids=str)
def test_what_was_exported_is_read_back(tmp_path, version, composition):
    values = {**composition.nominal_values(), "moving_mass": 31.7, "coulomb_friction.force": 250.0}
    document, _ = describe(ExportedModel(composition, values), "press", "press", version)
    model = read_fmu(packed(tmp_path / "press.fmu", document))
    assert model == nominal_of(values, composition=composition)
    assert model.values["coulomb_friction.force"] == 250.0


def test_values_of_another_tool_are_taken_in_si_units(tmp_path):
    variables = [
        real("supply_pressure", "105", 'unit="bar"'),
        real("piston_area", "7.5", 'declaredType="Area"'),
        real("moving_mass", "12"),
        real("oil.temperature", "40", 'unit="degC"'),
        real("spring_stiffness", "5", causality="output"),
    ]
    types = '<TypeDefinitions><SimpleType name="Area"><Real unit="cm2"/></SimpleType></TypeDefinitions>'
    model = given_model(of_another_tool(tmp_path, "".join(variables), types=types))
    expected = {"supply_pressure": 105e5, "piston_area": 7.5e-4, "moving_mass": 12.0}
    assert {name: model.values[name] for name in expected} == pytest.approx(expected, rel=1e-12)
    rest = nominal_of(expected).values
    assert {name: value for name, value in model.values.items() if name not in expected} == {
        name: value for name, value in rest.items() if name not in expected
    }


def test_of_fmi_3_too(tmp_path):
    types = '<TypeDefinitions><Float64Type name="Pressure" unit="bar"/></TypeDefinitions>'
    variables = (
        '<Float64 name="supply_pressure" causality="parameter" declaredType="Pressure" start="90"/>'
        '<Float64 name="moving_mass" causality="parameter" start="8"/>'
    )
    model = read_fmu(of_another_tool(tmp_path, variables, "3.0", types))
    assert model.values["supply_pressure"] == pytest.approx(9e6) and model.values["moving_mass"] == 8.0


@pytest.mark.parametrize(
    ("variables", "said"),
    [
        (real("cylinder.mass", "12"), "no parameter of this FMU has a name of the catalogue"),
        (real("moving_mass", "1", 'unit="slug"'), "moving_mass = 1 slug: the FMU does not state this unit as"),
        (real("moving_mass", "1", 'unit="bar"'), "moving_mass = 1 bar: the FMU does not state this unit as"),
        (real("moving_mass", "1", 'unit="oz"'), "moving_mass = 1 oz: the FMU does not state this unit as"),
        (real("moving_mass", "heavy"), "moving_mass = heavy"),
        (real("moving_mass", "-3"), "moving_mass"),
    ],
    ids=["no name", "no base unit", "another quantity", "no factor", "no number", "no mass"],
)  # fmt: skip
def test_what_cannot_be_taken_is_said(tmp_path, variables, said):
    with pytest.raises(ParameterError, match=said) as error:
        read_fmu(of_another_tool(tmp_path, variables))
    assert str(error.value).startswith(f"{tmp_path / 'press.fmu'}: ") and "\n" not in str(error.value)


def test_what_is_no_fmu_is_said(tmp_path):
    (tmp_path / "text.fmu").write_text("no archive")
    empty = tmp_path / "empty.fmu"
    with zipfile.ZipFile(empty, "w") as unit:
        unit.writestr("readme.txt", "")
    broken = packed(tmp_path / "broken.fmu", "<fmiModelDescription")
    old = packed(tmp_path / "old.fmu", '<fmiModelDescription fmiVersion="1.0"/>')
    for path in (tmp_path / "text.fmu", empty, broken, old):
        with pytest.raises(ParameterError, match="is no FMU"):
            read_fmu(path)
    with pytest.raises(ParameterError, match="cannot be read"):
        read_fmu(tmp_path / "absent.fmu")
