"""Settings of the panel, which are stored in the scene."""
from __future__ import annotations

import bpy

from ..core.command import EditSettings, RelightSettings
from ..core.words import complete
from ..scene.region import Region
from . import session

REGIONS = [
    ("ALL", "Everything", "The whole surface; for a change from one colour to another, only the parts with the old colour"),
    ("FACES", "Selected Faces", "Faces that are selected in edit mode"),
    ("GROUP", "Vertex Group", "A vertex group, with its weights"),
    ("PAINT", "Painted Attribute", "A colour attribute: where it is white"),
    ("IMAGE", "Painted Image", "An image in the first UV map: where it is white"),
    ("MATERIAL", "Material", "All faces with a material"),
    ("WORDS", "Words", "A part by its name, as the prior's segmenter sees it"),
    ("COLOR", "Colour", "Where the surface has one of eleven basic colours"),
    ("TEXT", "Selector", "Any selector of item3d edit --region"),
]
COLORS = ["black", "white", "gray", "red", "green", "blue", "yellow", "orange", "purple", "pink", "brown"]
LIGHTS = ["studio", "noon", "sunset", "overcast", "night"]
RELIGHTS = [
    ("preset", "Preset", "One of item3d's lights"),
    ("sky", "Sky", "A clear sky at an hour"),
    ("lit", "Direction", "The studio light, from a direction in words"),
    ("words", "Sentence", "A light found by the prior for the two sentences above"),
]


def _complete(self: Item3dSettings, context: bpy.types.Context, text: str) -> list[str]:
    return complete(text, session.words(context, self.prior))


def _names(names: list[str]) -> list[tuple[str, str, str]]:
    return [(name, name.capitalize(), "") for name in names]


class Item3dSettings(bpy.types.PropertyGroup):
    """Settings of a scene. Blender turns the annotations into properties when the class is registered."""

    source: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="From", description='Description of the object as it is, as in "a red mug"', search=_complete, search_options={"SUGGESTION"}
    )
    target: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="To", description='Description of the object as it should be, as in "a golden mug"', search=_complete, search_options={"SUGGESTION"}
    )
    prior: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Prior", subtype="DIR_PATH",
        description="A diffusion model in the diffusers layout, or a name of `item3d prior list`; empty: the embedded prior",
    )
    region: bpy.props.EnumProperty(name="Where", items=REGIONS)  # type: ignore[valid-type]
    group: bpy.props.StringProperty(name="Vertex Group")  # type: ignore[valid-type]
    paint: bpy.props.StringProperty(name="Attribute")  # type: ignore[valid-type]
    image: bpy.props.PointerProperty(name="Image", type=bpy.types.Image)  # type: ignore[valid-type]
    material: bpy.props.StringProperty(name="Material")  # type: ignore[valid-type]
    words: bpy.props.StringProperty(name="Words", description='As in "the handle"')  # type: ignore[valid-type]
    color: bpy.props.EnumProperty(name="Colour", items=_names(COLORS))  # type: ignore[valid-type]
    selector: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Selector", description="As in sphere=0,0.5,0,0.3, in glTF's coordinates"
    )
    feather: bpy.props.FloatProperty(  # type: ignore[valid-type]
        name="Soft Border", min=0, max=50, subtype="PERCENTAGE", description="Width of the border inside the region, in percent of the objects' size"
    )
    iterations: bpy.props.IntProperty(  # type: ignore[valid-type]
        name="Iterations", min=0, max=100000, description="0: the prior's own number"
    )
    seed: bpy.props.IntProperty(name="Seed", min=0, description="Seed of all random numbers")  # type: ignore[valid-type]
    texture_size: bpy.props.IntProperty(  # type: ignore[valid-type]
        name="Texture Size", min=0, max=8192, description="Edge length of the new textures, in pixels; 0: as the old ones"
    )
    detail: bpy.props.EnumProperty(  # type: ignore[valid-type]
        name="Detail", description="Paint patterns such as spots, bricks or veins after the edit",
        items=[("auto", "Automatic", "If the target names a pattern"), ("off", "Off", ""), ("always", "Always", "")],
    )
    metallic: bpy.props.EnumProperty(  # type: ignore[valid-type]
        name="Metallic", items=[("auto", "Automatic", "If a sentence names a metal"), ("always", "Always", "")]
    )
    more: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Options", description="Additional options of item3d edit, as on a command line"
    )
    live: bpy.props.BoolProperty(  # type: ignore[valid-type]
        name="Live", default=True, description="Show the edit on the objects while it runs"
    )
    apply_when_done: bpy.props.BoolProperty(  # type: ignore[valid-type]
        name="Apply When Done", default=True, description="If off, the result is only shown after Apply"
    )
    relight: bpy.props.EnumProperty(name="Light", items=RELIGHTS)  # type: ignore[valid-type]
    preset: bpy.props.EnumProperty(name="Preset", items=_names(LIGHTS), default="sunset")  # type: ignore[valid-type]
    hour: bpy.props.FloatProperty(name="Hour", min=0, max=24, default=18)  # type: ignore[valid-type]
    lit: bpy.props.StringProperty(name="From", description='As in "low in the west"')  # type: ignore[valid-type]

    def edit_settings(self) -> EditSettings:
        return EditSettings(
            source=self.source, target=self.target, prior=self._prior(), iterations=self.iterations, seed=self.seed,
            detail=self.detail, metallic=self.metallic, texture_size=self.texture_size, more=self.more,
        )  # fmt: skip

    def relight_settings(self) -> RelightSettings:
        return RelightSettings(
            kind=self.relight, preset=self.preset, hour=self.hour, lit=self.lit, source=self.source, target=self.target,
            prior=self._prior(),
        )  # fmt: skip

    def chosen_region(self) -> Region:
        names = {
            "GROUP": self.group, "PAINT": self.paint, "IMAGE": self.image.name if self.image else "",
            "MATERIAL": self.material, "WORDS": self.words, "COLOR": self.color, "TEXT": self.selector,
        }  # fmt: skip
        return Region(kind=self.region, name=names.get(self.region, ""), feather=self.feather)

    def _prior(self) -> str:
        return bpy.path.abspath(self.prior) if self.prior.startswith("//") else self.prior
