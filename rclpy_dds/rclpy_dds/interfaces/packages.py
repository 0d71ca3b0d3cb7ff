"""Python packages made from definitions: `std_msgs`, `std_msgs.msg`, `std_msgs.msg._float64`, `std_srvs.srv`."""

from __future__ import annotations

import importlib.abc
import importlib.machinery
from types import ModuleType
from typing import Any

from rclpy_dds.interfaces import store
from rclpy_dds.interfaces.folders import interface_folders
from rclpy_dds.interfaces.message import message_class, module_name, service_class

KINDS = ("msg", "srv")


class _Loader(importlib.abc.Loader):
    """Makes an empty module; classes appear in it when first asked for."""

    def create_module(self, spec: importlib.machinery.ModuleSpec) -> ModuleType | None:
        return _InterfaceModule(spec.name)

    def exec_module(self, module: ModuleType) -> None:
        module.__path__ = []
        module.__rclpy_dds__ = True  # type: ignore[attr-defined]


class _InterfaceModule(ModuleType):
    """A package, its msg or srv module, or one type's own module."""

    def __getattr__(self, name: str) -> Any:
        parts = self.__name__.split(".")
        if name.startswith("__") or len(parts) == 1:
            raise AttributeError(f"module {self.__name__!r} has no attribute {name!r}")
        base, _, part = name.rpartition("_")
        names = store.interface_names(parts[0], parts[1])
        if name in names:
            made = (
                message_class(f"{parts[0]}/msg/{name}")
                if parts[1] == "msg"
                else service_class("/".join((*parts[:2], name)))
            )
        elif parts[1] == "srv" and base in names and part in ("Request", "Response"):
            made = message_class(f"{parts[0]}/srv/{name}")
        else:
            raise AttributeError(f"module {self.__name__!r} has no attribute {name!r}")
        setattr(self, name, made)
        return made

    def __dir__(self) -> list[str]:
        parts = self.__name__.split(".")
        return store.interface_names(parts[0], parts[1]) if len(parts) == 2 else sorted(self.__dict__)

    @property
    def __all__(self) -> list[str]:
        return self.__dir__()


def package_spec(package: str) -> importlib.machinery.ModuleSpec | None:
    """Return the spec of an interface package, located where its definitions are; None when nothing defines one."""
    if package not in store.package_names():
        return None
    spec = importlib.machinery.ModuleSpec(package, _Loader(), origin="rclpy_dds", is_package=True)
    spec.submodule_search_locations = interface_folders(package)
    return spec


def submodule_spec(fullname: str) -> importlib.machinery.ModuleSpec | None:
    """Return the spec of `package.msg`, `package.srv` or a type's module below one, None when there is no such."""
    package, kind, *rest = fullname.split(".")
    names = store.interface_names(package, kind) if kind in KINDS else []
    if not names or len(rest) > 1 or (rest and rest[0] not in map(module_name, names)):
        return None
    return importlib.machinery.ModuleSpec(fullname, _Loader(), origin="rclpy_dds", is_package=True)
