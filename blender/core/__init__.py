"""Code that needs no Blender: finding the program, its command lines, processes and files."""
