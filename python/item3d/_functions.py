"""Operators with their gradients. Not public: the callers check the arguments.

Each operator with a gradient is a torch.autograd.Function. At each call this costs a fifth of the time of
torch.library.register_autograd. If no argument requires gradients, the operator is called directly, at no extra cost.
Second derivatives and forward-mode derivatives are errors.
"""
from __future__ import annotations

import functools

import torch
from torch.autograd import forward_ad

from ._library import ops


def _tracked(*tensors) -> bool:
    if forward_ad._current_level >= 0:
        raise NotImplementedError('item3d has no forward-mode derivatives (jvp, jacfwd, dual tensors); use backward()')
    return torch.is_grad_enabled() and any(t is not None and t.requires_grad for t in tensors)


def _first_order(backward):
    """Makes a second derivative an error. PyTorch's once_differentiable lets some of them be zero instead."""
    @functools.wraps(backward)
    def checked(ctx, *gradients):
        if not torch.is_grad_enabled():
            return backward(ctx, *gradients)
        with torch.no_grad():
            results = backward(ctx, *gradients)
        several = results if isinstance(results, tuple) else (results,)
        error = torch._C._functions.DelayedError(
            b'item3d has no second derivatives (create_graph=True)', len(several))
        return error(*[None if one is None else one.detach().requires_grad_() for one in several])

    return checked


class _Rasterize(torch.autograd.Function):
    @staticmethod
    def forward(ctx, positions, triangles, ranges, behind, height, width, by_w, bottom_up, slopes,
                finite):
        raster, by_pixel = ops.rasterize(positions, triangles, ranges, behind, height, width, by_w,
                                         bottom_up, slopes, finite)
        ctx.save_for_backward(positions, triangles, raster)
        ctx.bottom_up, ctx.slopes = bottom_up, slopes
        return raster, by_pixel

    @staticmethod
    @_first_order
    def backward(ctx, by_raster, by_slopes):
        positions, triangles, raster = ctx.saved_tensors
        by_positions = ops.rasterize_backward(positions, triangles, raster, by_raster,
                                              by_slopes if ctx.slopes else None, ctx.bottom_up)
        return by_positions, None, None, None, None, None, None, None, None, None


def rasterize(positions, triangles, ranges, behind, height, width, by_w, bottom_up, slopes, finite):
    run = _Rasterize.apply if _tracked(positions) else ops.rasterize
    return run(positions, triangles, ranges, behind, height, width, by_w, bottom_up, slopes, finite)


class _Interpolate(torch.autograd.Function):
    @staticmethod
    def forward(ctx, attributes, raster, triangles, slopes, sloped):
        ctx.save_for_backward(attributes, raster, triangles, slopes)
        ctx.sloped = sloped
        return ops.interpolate(attributes, raster, triangles, slopes, sloped)

    @staticmethod
    @_first_order
    def backward(ctx, by_values, by_value_slopes):
        attributes, raster, triangles, slopes = ctx.saved_tensors
        wanted = ctx.needs_input_grad[0]
        by_attributes, by_raster, by_slopes = ops.interpolate_backward(
            attributes, raster, triangles, slopes, ctx.sloped, by_values, by_value_slopes, wanted)
        return (by_attributes if wanted else None, by_raster, None,
                None if slopes is None else by_slopes, None)


def interpolate(attributes, raster, triangles, slopes, sloped):
    run = _Interpolate.apply if _tracked(attributes, raster, slopes) else ops.interpolate
    return run(attributes, raster, triangles, slopes, sloped)


class _Texture(torch.autograd.Function):
    @staticmethod
    def forward(ctx, texture, uv, slopes, bias, filter, boundary, own_mips, *mips):
        ctx.save_for_backward(texture, uv, slopes, bias, *mips)
        ctx.filter, ctx.boundary, ctx.own_mips = filter, boundary, own_mips
        return ops.texture(texture, mips, uv, slopes, bias, filter, boundary)

    @staticmethod
    @_first_order
    def backward(ctx, gradient):
        texture, uv, slopes, bias, *mips = ctx.saved_tensors
        needs = ctx.needs_input_grad
        texels_wanted = needs[0] or any(needs[7:])
        others_wanted = needs[1] or needs[2] or needs[3]
        by_texels, by_uv, by_slopes, by_bias = ops.texture_backward(
            texture, mips, uv, slopes, bias, ctx.filter, ctx.boundary, gradient, texels_wanted,
            others_wanted)
        by_levels, first = [], 0
        for level in [texture, *mips]:
            count = level.numel()
            by_levels.append(by_texels[first:first + count].view(level.shape)
                             if texels_wanted else None)
            first += count
        if ctx.own_mips and texels_wanted:
            by_levels = [_sum_of_levels(by_levels), *[None] * len(mips)]
        return (by_levels[0], by_uv if needs[1] else None, by_slopes if needs[2] else None,
                by_bias if needs[3] else None, None, None, None, *by_levels[1:])


def texture(texture, mips, uv, slopes, bias, filter, boundary, own_mips=False):
    """own_mips: mipmaps() made `mips` of this texture without gradients; the texture then gets their gradients."""
    if _tracked(texture, uv, slopes, bias, *mips):
        return _Texture.apply(texture, uv, slopes, bias, filter, boundary, own_mips, *mips)
    return ops.texture(texture, mips, uv, slopes, bias, filter, boundary)


def _sum_of_levels(by_levels):
    """Returns the gradient of a texture from the gradients of all levels, where mipmaps() made levels 1, 2, ... of it.

    Overwrites the gradients of the levels.
    """
    levels = [level.flatten(0, -4) for level in by_levels]
    for coarse, finer in reversed(list(zip(levels[1:], levels))):
        if finer.shape[1] % 2 == 0 and finer.shape[2] % 2 == 0:
            ops.add_halve_backward(coarse, finer)
        else:
            planes = torch.ops.aten._adaptive_avg_pool2d_backward(coarse.permute(0, 3, 1, 2), finer.permute(0, 3, 1, 2))
            finer += planes.permute(0, 2, 3, 1)
    return by_levels[0]


class _Halve(torch.autograd.Function):
    @staticmethod
    def forward(ctx, texture):
        return ops.halve(texture)

    @staticmethod
    @_first_order
    def backward(ctx, gradient):
        return ops.halve_backward(gradient)


def halve(texture):
    return _Halve.apply(texture) if _tracked(texture) else ops.halve(texture)


def _elementwise(value, backward):
    """Returns a function with gradients. `value` and `backward` are its operators."""
    class Elementwise(torch.autograd.Function):
        @staticmethod
        def forward(ctx, values):
            ctx.save_for_backward(values)
            return value(values)

        @staticmethod
        @_first_order
        def backward(ctx, gradient):
            return backward(*ctx.saved_tensors, gradient)

    return lambda values: (Elementwise.apply if _tracked(values) else value)(values)


srgb_to_linear = _elementwise(ops.srgb_to_linear, ops.srgb_to_linear_backward)
linear_to_srgb = _elementwise(ops.linear_to_srgb, ops.linear_to_srgb_backward)


class _Antialias(torch.autograd.Function):
    @staticmethod
    def forward(ctx, image, raster, positions, triangles, neighbours, max_steps, bottom_up):
        ctx.save_for_backward(image, raster, positions, triangles, neighbours)
        ctx.max_steps, ctx.bottom_up = max_steps, bottom_up
        return ops.antialias(image, raster, positions, triangles, neighbours, max_steps, bottom_up)

    @staticmethod
    @_first_order
    def backward(ctx, gradient):
        image, raster, positions, triangles, neighbours = ctx.saved_tensors
        wanted = ctx.needs_input_grad[2]
        by_image, by_positions = ops.antialias_backward(
            image, raster, positions, triangles, neighbours, gradient, ctx.max_steps,
            ctx.bottom_up, wanted)
        return by_image, None, by_positions if wanted else None, None, None, None, None


def antialias(image, raster, positions, triangles, neighbours, max_steps, bottom_up):
    run = _Antialias.apply if _tracked(image, positions) else ops.antialias
    return run(image, raster, positions, triangles, neighbours, max_steps, bottom_up)


class _Equirectangular(torch.autograd.Function):
    @staticmethod
    def forward(ctx, map, size):
        ctx.height, ctx.width = map.shape[:2]
        return ops.equirectangular(map, size)

    @staticmethod
    @_first_order
    def backward(ctx, gradient):
        return ops.equirectangular_backward(gradient, ctx.height, ctx.width), None


def equirectangular(map, size):
    return (_Equirectangular.apply if _tracked(map) else ops.equirectangular)(map, size)


class _Prefilter(torch.autograd.Function):
    @staticmethod
    def forward(ctx, cube):
        maps, weights, roughness, bright = ops.prefilter(cube)
        ctx.save_for_backward(bright, *weights)
        ctx.size = cube.shape[1]
        ctx.mark_non_differentiable(roughness)
        return (roughness, *maps)

    @staticmethod
    @_first_order
    def backward(ctx, _, *gradients):
        bright, *weights = ctx.saved_tensors
        return ops.prefilter_backward(gradients, weights, bright, ctx.size)


def prefilter(cube):
    """Returns the roughness of each specular level, the irradiance map, and then the specular levels."""
    if _tracked(cube):
        return _Prefilter.apply(cube)
    maps, _, roughness, _ = ops.prefilter(cube)
    return (roughness, *maps)


class _Shade(torch.autograd.Function):
    @staticmethod
    def forward(ctx, base_color, orm, normal_map, normal, tangent, view, roughness, multiple_scattering,
                diffuse, *specular):
        ctx.save_for_backward(base_color, orm, normal_map, normal, tangent, view, roughness, diffuse,
                              *specular)
        ctx.multiple_scattering = multiple_scattering
        return ops.shade(base_color, orm, normal_map, normal, tangent, view, diffuse, specular, roughness,
                         multiple_scattering)

    @staticmethod
    @_first_order
    def backward(ctx, gradient):
        (base_color, orm, normal_map, normal, tangent, view, roughness, diffuse,
         *specular) = ctx.saved_tensors
        needs = ctx.needs_input_grad
        points_wanted, light_wanted = any(needs[:4]), any(needs[8:])
        *by_points, by_light = ops.shade_backward(
            base_color, orm, normal_map, normal, tangent, view, diffuse, specular, roughness,
            ctx.multiple_scattering, gradient, points_wanted, light_wanted)
        by_points = [by if wanted else None for by, wanted in zip(by_points, needs)]
        by_maps, first = [], 0
        for level in [diffuse, *specular]:
            count = level.numel()
            by_maps.append(by_light[first:first + count].view(level.shape) if light_wanted else None)
            first += count
        return (*by_points, None, None, None, None, *by_maps)


def shade(base_color, orm, normal_map, normal, tangent, view, light, multiple_scattering):
    if _tracked(base_color, orm, normal_map, normal, light.diffuse, *light.specular):
        return _Shade.apply(base_color, orm, normal_map, normal, tangent, view, light.roughness,
                            multiple_scattering, light.diffuse, *light.specular)
    return ops.shade(base_color, orm, normal_map, normal, tangent, view, light.diffuse, light.specular,
                     light.roughness, multiple_scattering)
