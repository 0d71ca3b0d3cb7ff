"""The nodes of the virtual actuator: simulator, reference generator and monitor."""
