// The plan of an edit: its settings, and the decisions derived from them.
#pragma once

#include "item3d/baselines/dataset_update.h"
#include "item3d/baselines/view_painter.h"
#include "item3d/edit/settings.h"
#include "item3d/lighting/optimized/light_model.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <filesystem>
#include <string>

namespace item3d {

/// Material channels that an edit may change or keep.
struct ChannelMask {
    bool base_color = true;
    bool occlusion = true;
    bool roughness = true;
    bool metallic = true;
    bool normal = true;
    bool any() const { return base_color || occlusion || roughness || metallic || normal; }
};

/// Settings with the decisions derived from them. Decisions are made by the constructor: changing a
/// setting afterwards does not update them.
struct EditPlan : EditSettings {
    EditPlan() : EditPlan(EditSettings()) {}
    explicit EditPlan(EditSettings settings);

    bool edits_texture = false;
    bool edits_light = false;
    bool paints_views = false;       ///< the method is a ViewPainter
    bool asks_captioner = false;     ///< a captioner adjusts the direction
    bool regularizes_color = false;  ///< see ColorRegularizer
    bool paints_detail = false;      ///< the detail stage runs
    /// Number of iterations plus views of the detail stage; for a ViewPainter, its number of steps.
    std::int64_t total_iterations = 0;
    /// All channels but `keep`; metallic only where its own setting allows it.
    ChannelMask channels;
    LightKind light_kind = LightKind::texels;          ///< kind of an optimised light
    LightAugment light_variation = LightAugment::off;  ///< off for an optimised light
    int light_cube_size = 256;                         ///< edge of prefiltered lights, texels
    int supersampling = 1;                             ///< of the images that the prior sees

    GuidanceOptions guidance_options() const;
    PainterOptions painter_options() const;
    DatasetUpdateOptions dataset_update_options() const;
};

/// Returns "defaults" of PRIOR/prior.json; an empty object where it has none. Throws InputError.
nlohmann::json prior_defaults(const std::filesystem::path& prior);

/// Resolves settings in rising priority: built-in defaults; "defaults" of PRIOR/prior.json, if any;
/// settings for relighting, if the overrides optimise the light alone; published settings of a
/// method that the overrides name; overrides. Then `iterations` becomes `iterations_before_detail`
/// where the detail stage runs and the overrides give no iterations. Throws InputError when a value
/// is of the wrong type or out of range.
EditPlan resolve_plan(const std::filesystem::path& prior, const nlohmann::json& overrides);

/// True if a word of the prompt names a metal ("golden", "chrome", ...; English, any case). Brown
/// metal and brown wood look alike in one image, and a small prior lets metallic drift; so metallic
/// stays unchanged unless a prompt names a metal.
bool names_metal(const std::string& prompt);

}  // namespace item3d
