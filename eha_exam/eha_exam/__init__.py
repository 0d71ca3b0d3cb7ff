"""The exam: recordings in which an effect is concealed, made by a plant that shares no code with the model examined."""
