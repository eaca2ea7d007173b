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

/// The settings of an edit with the decisions derived from them. The constructor makes the
/// decisions; a later change of a setting does not update them.
struct EditPlan : EditSettings {
    EditPlan() : EditPlan(EditSettings()) {}
    explicit EditPlan(EditSettings settings);

    bool edits_texture = false;
    bool edits_light = false;
    bool paints_views = false;       ///< the method is a ViewPainter
    bool asks_captioner = false;     ///< a captioner adjusts the direction
    bool regularizes_color = false;  ///< see ColorRegularizer
    bool paints_detail = false;      ///< the detail stage runs
    /// Number of iterations plus number of views of the detail stage. For a ViewPainter it is the
    /// number of steps.
    std::int64_t total_iterations = 0;
    /// All channels but those in `keep`; metallic only if the setting `metallic` allows it.
    ChannelMask channels;
    LightKind light_kind = LightKind::texels;          ///< kind of an optimised light
    LightAugment light_variation = LightAugment::off;  ///< off for an optimised light
    int light_cube_size = 256;                         ///< edge of prefiltered lights, texels
    int supersampling = 1;  ///< factor for the images that the prior sees

    GuidanceOptions guidance_options() const;
    PainterOptions painter_options() const;
    DatasetUpdateOptions dataset_update_options() const;
};

/// Returns the value of "defaults" in PRIOR/prior.json; an empty object if there is none. Throws
/// InputError.
nlohmann::json prior_defaults(const std::filesystem::path& prior);

/// Resolves the settings. From lowest to highest priority they come from: the built-in defaults;
/// "defaults" of PRIOR/prior.json; the settings for relighting, if the overrides optimise only the
/// light; the published settings of the method that the overrides name; the overrides. After that,
/// `iterations` becomes `iterations_before_detail` if the detail stage runs and the overrides give
/// no iterations. Throws InputError if a value is of the wrong type or out of range.
EditPlan resolve_plan(const std::filesystem::path& prior, const nlohmann::json& overrides);

/// True if a word of the prompt names a metal in English ("golden", "chrome", ...), in any case. An
/// edit leaves metallic unchanged unless a prompt names a metal, because brown metal and brown wood
/// look alike in one image, and with a small prior metallic would drift.
bool names_metal(const std::string& prompt);

}  // namespace item3d
