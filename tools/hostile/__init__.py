"""`make hostile`: what strangers, accidents and mistakes do to the project, done on purpose and counted."""
