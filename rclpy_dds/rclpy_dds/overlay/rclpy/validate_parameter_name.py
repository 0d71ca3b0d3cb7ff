"""Check names of parameters."""

from rclpy.exceptions import InvalidParameterException


def validate_parameter_name(name: str) -> bool:
    """Return True for a valid name.

    Raises:
        InvalidParameterException: it is none.
    """
    if not isinstance(name, str) or not name:
        raise InvalidParameterException(name)
    return True
