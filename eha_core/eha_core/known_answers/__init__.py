"""Questions to the diagnosis whose answers are known: measured rigs, and the recordings shipped with the project."""
