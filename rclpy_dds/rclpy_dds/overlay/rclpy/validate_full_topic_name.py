"""Check fully qualified topic and service names."""

from rclpy.exceptions import InvalidServiceNameException, InvalidTopicNameException
from rclpy.validate_names import full_topic_name_problem


def validate_full_topic_name(name: str, *, is_service: bool = False) -> bool:
    """Return True for a valid name.

    Raises:
        InvalidTopicNameException: it is none (InvalidServiceNameException with is_service).
    """
    if problem := full_topic_name_problem(name):
        raise (InvalidServiceNameException if is_service else InvalidTopicNameException)(name, *problem)
    return True
