"""item3d from Python: differentiable rendering on the CPU, and item3d.nvdiffrast for programs written for that.

    import item3d
    raster = item3d.rasterize(positions, triangles, (512, 512))
    image = item3d.antialias(item3d.interpolate(colors, raster, triangles), raster, positions, triangles)

docs/python.md has examples. Needs PyTorch 2.10 or newer.
"""
from .operations import Raster, antialias, interpolate, mipmaps, rasterize, texture, topology

__version__ = '0.1.0'
__all__ = ['Raster', 'antialias', 'interpolate', 'mipmaps', 'rasterize', 'texture', 'topology']
