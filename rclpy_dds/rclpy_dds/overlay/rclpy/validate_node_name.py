"""Check names of nodes."""

from rclpy.exceptions import InvalidNodeNameException
from rclpy.validate_names import node_name_problem


def validate_node_name(node_name: str) -> bool:
    """Return True for a valid name.

    Raises:
        InvalidNodeNameException: it is none.
    """
    if problem := node_name_problem(node_name):
        raise InvalidNodeNameException(node_name, *problem)
    return True
