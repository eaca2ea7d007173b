"""What is done to Blender's data, without operators or panels: works in background too."""
