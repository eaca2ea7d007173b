"""Everything that needs no Blender: the program, its command lines, its processes, its files."""
