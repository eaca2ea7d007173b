"""Python package of item3d: differentiable rendering on the CPU and on CUDA devices, and the program's commands.

    import item3d
    raster = item3d.rasterize(positions, triangles, (512, 512))
    image = item3d.antialias(item3d.interpolate(colors, raster, triangles), raster, positions, triangles)
    result = item3d.edit('mug.glb', 'a red mug', 'a golden mug', output='golden')

The module item3d.nvdiffrast has the functions of nvdiffrast.torch. docs/python.md has examples. The package needs
PyTorch 2.10 or newer.
"""
from . import _library  # must be first: it reports a PyTorch that is too old in one line
from .cameras import Camera, camera, look_at, perspective
from .guidance import Guidance
from .light_files import load_light
from .model import Material, Model, Primitive, load
from .operations import Raster, antialias, interpolate, mipmaps, rasterize, texture, topology
from .program import (Error, InputError, InternalError, Interrupted, Job, ProgramMissing, Progress,
                      ResourceError, UsageError, caption, edit, find_program, layers, reconstruct, region,
                      relight, score, start_edit, start_reconstruct, start_relight)
from .renderer import render
from .settings import (CaptionSettings, EditSettings, GuidanceSettings, LayersSettings, ReconstructSettings,
                       RegionSettings, RelightSettings, ScoreSettings)
from .shading import Light, linear_to_srgb, prefilter, shade, srgb_to_linear

__version__ = '0.2.0'
__all__ = ['Camera', 'CaptionSettings', 'EditSettings', 'Error', 'Guidance', 'GuidanceSettings', 'InputError',
           'InternalError', 'Interrupted', 'Job', 'LayersSettings', 'Light', 'Material', 'Model', 'Primitive',
           'ProgramMissing', 'Progress', 'Raster', 'ReconstructSettings', 'RegionSettings', 'RelightSettings',
           'ResourceError', 'ScoreSettings', 'UsageError', 'antialias', 'camera', 'caption', 'edit', 'find_program',
           'interpolate', 'layers', 'linear_to_srgb', 'load', 'load_light', 'look_at', 'mipmaps', 'perspective',
           'prefilter', 'rasterize', 'reconstruct', 'region', 'relight', 'render', 'score', 'shade', 'srgb_to_linear',
           'start_edit', 'start_reconstruct', 'start_relight', 'texture', 'topology']
