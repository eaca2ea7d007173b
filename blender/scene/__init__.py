"""Work on Blender's data without operators and panels, which is possible in background mode too."""
