// The plan of an edit: its settings, and the decisions that follow from them.
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

/// The settings with what follows from them. Other settings make another plan: what has been
/// decided does not follow a member that is changed.
struct EditPlan : EditSettings {
    EditPlan() : EditPlan(EditSettings()) {}
    explicit EditPlan(EditSettings settings);

    bool edits_texture = false;
    bool edits_light = false;
    bool paints_views = false;       ///< by a method that is a ViewPainter
    bool asks_captioner = false;     ///< a captioner adjusts the direction
    bool regularizes_color = false;  ///< see ColorRegularizer
    bool paints_detail = false;      ///< the detail stage runs
    /// And views of the detail stage; steps of a ViewPainter, which has no iterations.
    std::int64_t total_iterations = 0;
    /// All but `keep`, and metallic only as its own setting allows.
    ChannelMask channels;
    LightKind light_kind = LightKind::texels;          ///< of a light that is optimised
    LightAugment light_variation = LightAugment::off;  ///< a light that is optimised stays as it is
    int light_cube_size = 256;                         ///< texels of the edge of prefiltered lights
    int supersampling = 1;                             ///< of the pictures that the prior sees

    GuidanceOptions guidance_options() const;
    PainterOptions painter_options() const;
    DatasetUpdateOptions dataset_update_options() const;
};

/// "defaults" of PRIOR/prior.json; an empty object where it has none. Throws InputError.
nlohmann::json prior_defaults(const std::filesystem::path& prior);

/// Built-in defaults <- "defaults" of PRIOR/prior.json (if there) <- what relighting needs, where
/// the overrides say to optimise the light alone <- what a method was published with, where the
/// overrides name it <- overrides; then `iterations` <- `iterations_before_detail`, where that is
/// meant and the overrides have no iterations. Throws InputError when a value is of the wrong type
/// or out of range.
EditPlan resolve_plan(const std::filesystem::path& prior, const nlohmann::json& overrides);

/// Whether a word of the prompt names a metal ("golden", "chrome", ...; English, any case). In one
/// picture, brown metal and brown wood differ by little, and a small prior lets metallic drift
/// where nobody asked for metal; so it is left alone unless a prompt names one.
bool names_metal(const std::string& prompt);

}  // namespace item3d
