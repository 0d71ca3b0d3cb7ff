"""Check namespaces."""

from rclpy.exceptions import InvalidNamespaceException
from rclpy.validate_names import namespace_problem


def validate_namespace(namespace: str) -> bool:
    """Return True for a valid namespace.

    Raises:
        InvalidNamespaceException: it is none.
    """
    if problem := namespace_problem(namespace):
        raise InvalidNamespaceException(namespace, *problem)
    return True
