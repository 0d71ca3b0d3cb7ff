"""The service through which other nodes learn what a type looks like."""

from __future__ import annotations

import weakref
from typing import Any

from rcl_interfaces.msg import ParameterDescriptor
from type_description_interfaces.msg import Field, FieldType, IndividualTypeDescription, TypeSource
from type_description_interfaces.srv import GetTypeDescription

from rclpy.parameter import Parameter
from rclpy.qos import qos_profile_services_default
from rclpy_dds.interfaces import store
from rclpy_dds.interfaces.definition import DefinitionError
from rclpy_dds.interfaces.text import message_text
from rclpy_dds.wire.hashes import description, type_hash

START_TYPE_DESCRIPTION_SERVICE_PARAM = "start_type_description_service"


class TypeDescriptionService:
    """Offers ~/get_type_description unless the parameter says no."""

    def __init__(self, node: Any) -> None:
        self._node_weak_ref = weakref.ref(node)
        name = START_TYPE_DESCRIPTION_SERVICE_PARAM
        if not node.has_parameter(name):
            text = "If enabled, start the ~/get_type_description service."
            node.declare_parameter(name, True, ParameterDescriptor(description=text, read_only=True))
        parameter = node.get_parameter(name)
        self.enabled = parameter.type_ is Parameter.Type.BOOL and parameter.value
        if parameter.type_ is not Parameter.Type.BOOL:
            node.get_logger().error(f"Invalid type for parameter '{name}' {parameter.type_!r} should be bool")
        self.service_name = f"{node.get_name()}/get_type_description"
        if self.enabled:
            node.create_service(
                GetTypeDescription, self.service_name, self._callback, qos_profile=qos_profile_services_default
            )

    @staticmethod
    def _callback(request: Any, response: Any) -> Any:
        try:
            known = type_hash(request.type_name)
        except (LookupError, ValueError, DefinitionError):
            response.failure_reason = f"type {request.type_name!r} is not known here"
            return response
        if request.type_hash != known:
            response.failure_reason = f"type {request.type_name!r} has the hash {known} here, not {request.type_hash!r}"
            return response
        content = description(request.type_name)
        response.type_description.type_description = _individual(content["type_description"])
        inner = [_individual(entry) for entry in content["referenced_type_descriptions"]]
        response.type_description.referenced_type_descriptions = inner
        if request.include_type_sources:
            names = [content["type_description"]["type_name"], *(entry.type_name for entry in inner)]
            response.type_sources = [_source(name) for name in names]
        response.successful = True
        return response


def _individual(entry: dict[str, Any]) -> Any:
    fields = [Field(name=field["name"], type=FieldType(**field["type"])) for field in entry["fields"]]
    return IndividualTypeDescription(type_name=entry["type_name"], fields=fields)


def _source(name: str) -> Any:
    is_service = name.split("/")[1] == "srv" and not name.endswith(("_Request", "_Response", "_Event"))
    if is_service:
        text = "---\n".join(message_text(part) for part in store.service(name))
    else:
        text = message_text(store.message(name))
    return TypeSource(type_name=name, encoding="srv" if is_service else "msg", raw_file_contents=text)
