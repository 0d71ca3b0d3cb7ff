"""The version of the actuator's packages, of which this is one."""

__version__ = "0.2.0"
