"""Check topic and service names as users write them."""

from rclpy.exceptions import InvalidServiceNameException, InvalidTopicNameException
from rclpy.validate_names import topic_name_problem

TOPIC_SEPARATOR_STRING = "/"


def validate_topic_name(name: str, *, is_service: bool = False) -> bool:
    """Return True for a valid name.

    Raises:
        InvalidTopicNameException: it is none (InvalidServiceNameException with is_service).
    """
    if problem := topic_name_problem(name):
        raise (InvalidServiceNameException if is_service else InvalidTopicNameException)(name, *problem)
    return True
