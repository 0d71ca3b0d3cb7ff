"""The virtual electro-hydraulic servo actuator: simulator, recordings, and the diagnosis of what a model leaves out."""
