#include "item3d/baselines/methods.h"

#include "item3d/baselines/controlnet_2d.h"
#include "item3d/baselines/sync_mvd.h"
#include "item3d/baselines/text2tex.h"
#include "item3d/baselines/texture_painter.h"
#include "item3d/core/error.h"

#include <algorithm>

namespace item3d {
namespace {

struct Method {
    EditMethod method;
    nlohmann::json settings;
    std::int64_t (*steps)(const PainterOptions&) = nullptr;  ///< null: paints no views
    std::unique_ptr<ViewPainter> (*make)(const PaintingScene&, const PainterOptions&) = nullptr;
};

template <typename Painter>
std::unique_ptr<ViewPainter> make(const PaintingScene& scene, const PainterOptions& options) {
    return std::make_unique<Painter>(scene, options);
}

template <typename Painter>
Method painter(EditMethod method, float cfg) {
    return {std::move(method), {{"cfg", cfg}}, &Painter::step_count, &make<Painter>};
}

const std::vector<Method>& all_methods() {
    static const std::vector<Method> all = {
        {{"item3d", "the method of this project, with --guidance (the default)",
          "see --guidance help"},
         nlohmann::json::object()},
        {{"sds", "plain score distillation (DreamFusion)", "2 per image"},
         {{"guidance", "sds"},
          {"adjust", "off"},
          {"evenness", 0},
          {"settle", 0},
          {"detail", "off"}}},
        painter<Controlnet2d>(
            {"controlnet-2d",
             "each view generated independently from its depth, without 3D consistency",
             "40 per view"},
            9.0f),
        painter<TexturePainter>(
            {"texture", "TEXTure: one view after another, with a trimap of keep, refine, generate",
             "102 per view"},
            7.5f),
        painter<Text2Tex>(
            {"text2tex", "Text2Tex: ten fixed views, then the views with the most left to update",
             "100 per view, 30 more for an update"},
            10.0f),
        painter<SyncMvd>(
            {"syncmvd", "SyncMVD: all views denoised together, synchronized by a latent texture",
             "60 per view"},
            15.5f),
        {{"in2n", "Instruct-NeRF2NeRF: InstructPix2Pix edits views, the texture follows",
          "6 per iteration"},
         {{"adjust", "off"},
          {"evenness", 0},
          {"settle", 0},
          {"detail", "off"},
          {"cfg", 7.5},
          {"iterations", 1000},  // four edits of each of 24 views
          {"timesteps", {0.02, 0.98}},
          {"light_augment", "off"},
          {"background", "white"}}},
        {{"clip", "CLIP similarity to the target (CLIP-NeRF) or its direction; no diffusion", "0"},
         {{"adjust", "off"}, {"evenness", 0}, {"settle", 0}, {"detail", "off"}}},
    };
    return all;
}

const Method& method_named(const std::string& name) {
    for (const Method& each : all_methods())
        if (each.method.name == name) return each;
    ITEM3D_CHECK(false, "unknown method " + name);
}

}  // namespace

const std::vector<EditMethod>& edit_methods() {
    static const std::vector<EditMethod> methods = [] {
        std::vector<EditMethod> kinds;
        for (const Method& each : all_methods())
            kinds.push_back(each.method);
        return kinds;
    }();
    return methods;
}

const std::vector<std::string>& edit_method_names() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> all;
        for (const EditMethod& method : edit_methods())
            all.push_back(method.name);
        return all;
    }();
    return names;
}

nlohmann::json method_settings(const std::string& method) {
    return method_named(method).settings;
}

bool paints_views(const std::string& method) {
    return method_named(method).make != nullptr;
}

std::int64_t painter_steps(const std::string& method, const PainterOptions& options) {
    return method_named(method).steps(options);
}

std::unique_ptr<ViewPainter> make_painter(const std::string& method, const PaintingScene& scene,
                                          const PainterOptions& options) {
    return method_named(method).make(scene, options);
}

}  // namespace item3d
