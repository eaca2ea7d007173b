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
        {{"item3d", "this project's own, led by --guidance (the default)", "see --guidance help"},
         nlohmann::json::object()},
        {{"sds", "score distillation (DreamFusion) without anything of ours", "2 a picture"},
         {{"guidance", "sds"},
          {"adjust", "off"},
          {"evenness", 0},
          {"settle", 0},
          {"detail", "off"}}},
        painter<Controlnet2d>(
            {"controlnet-2d",
             "each view drawn alone from its depth, and no 3D: how much views differ", "40 a view"},
            9.0f),
        painter<TexturePainter>(
            {"texture", "TEXTure: view after view, by a trimap of keep, refine and generate",
             "102 a view"},
            7.5f),
        painter<Text2Tex>(
            {"text2tex", "Text2Tex: ten views generated and updated, then views where most is left",
             "100 a view, 30 more where it updates"},
            10.0f),
        painter<SyncMvd>(
            {"syncmvd", "SyncMVD: all views denoised at once, agreeing in a latent texture",
             "60 a view"},
            15.5f),
        {{"in2n", "Instruct-NeRF2NeRF: InstructPix2Pix edits views, the texture follows them",
          "6 an iteration"},
         {{"adjust", "off"},
          {"evenness", 0},
          {"settle", 0},
          {"detail", "off"},
          {"cfg", 7.5},
          {"iterations", 1000},  // four edits of each of 24 views
          {"timesteps", {0.02, 0.98}},
          {"light_augment", "off"},
          {"background", "white"}}},
        {{"clip", "CLIP's similarity to the target (CLIP-NeRF), or its direction; no diffusion",
          "0"},
         {{"adjust", "off"}, {"evenness", 0}, {"settle", 0}, {"detail", "off"}}},
    };
    return all;
}

const Method& method_named(const std::string& name) {
    for (const Method& each : all_methods())
        if (each.method.name == name) return each;
    ITEM3D_CHECK(false, "there is no method " + name);
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
