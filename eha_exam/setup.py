"""Installs the exam, by pip and by colcon alike; all that there is to say is in setup.cfg."""

from setuptools import setup

setup()
