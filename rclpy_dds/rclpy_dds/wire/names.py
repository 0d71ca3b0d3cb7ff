"""How ROS 2 names look in DDS."""

from __future__ import annotations

TOPIC, REQUEST, REPLY = "rt", "rq", "rr"
_PREFIXES = (f"{TOPIC}/", f"{REQUEST}/", f"{REPLY}/")


def dds_topic(name: str) -> str:
    """Return the DDS topic of a fully qualified ROS topic."""
    return f"{TOPIC}{name}"


def dds_service(name: str) -> tuple[str, str]:
    """Return the DDS topics of a service's requests and replies."""
    return f"{REQUEST}{name}Request", f"{REPLY}{name}Reply"


def dds_type(name: str) -> str:
    """Return the DDS type of `package/kind/Name`."""
    package, kind, short = name.split("/")
    return f"{package}::{kind}::dds_::{short}_"


def ros_topic(dds_name: str) -> str | None:
    """Return the ROS topic behind a DDS topic, None when it is none."""
    return dds_name[2:] if dds_name.startswith(f"{TOPIC}/") else None


def ros_service(dds_name: str) -> str | None:
    """Return the ROS service behind a DDS topic, None when it is none."""
    if dds_name.startswith(f"{REQUEST}/") and dds_name.endswith("Request"):
        return dds_name[2:-7]
    if dds_name.startswith(f"{REPLY}/") and dds_name.endswith("Reply"):
        return dds_name[2:-5]
    return None


def ros_type(dds_name: str) -> str:
    """Return `package/kind/Name` for a DDS type of ROS, the name itself for any other."""
    if "::dds_::" not in dds_name or not dds_name.endswith("_"):
        return dds_name
    return dds_name.replace("::dds_::", "::")[:-1].replace("::", "/")


def ros_service_type(dds_name: str) -> str:
    """Return `package/srv/Name` for the DDS type of a service's request or reply."""
    name = ros_type(dds_name)
    return name.removesuffix("_Request").removesuffix("_Response")
