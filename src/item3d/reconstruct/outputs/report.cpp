#include "item3d/reconstruct/outputs/report.h"

#include "item3d/core/format.h"
#include "item3d/core/version.h"
#include "item3d/lighting/environment.h"
#include "item3d/reconstruct/outputs/camera_plot.h"
#include "item3d/render/image_tensor.h"
#include "item3d/render/srgb.h"
#include "item3d/report/animation.h"
#include "item3d/report/display_image.h"
#include "item3d/report/html.h"
#include "item3d/report/html_chart.h"
#include "item3d/report/model_images.h"

#include <algorithm>
#include <cmath>

namespace item3d {

namespace {

constexpr int model_image_size = 320;

/// Returns a map of differences, in which differences of 32 / 255 and more are white.
Image error_map(const ScoredView& view) {
    Image map(view.truth.width, view.truth.height, 3);
    for (std::size_t i = 0; i < map.pixels.size(); i += 3) {
        float largest = 0;
        for (std::size_t c = 0; c < 3; ++c)
            largest =
                std::max(largest, std::abs(view.truth.pixels[i + c] - view.image.pixels[i + c]));
        // Colour ramp from black over red and yellow to white.
        for (std::size_t c = 0; c < 3; ++c)
            map.pixels[i + c] =
                std::clamp(largest * 255 / 32 * 3 - static_cast<float>(c), 0.0f, 1.0f);
    }
    return map;
}

std::string view_figures(const std::vector<ScoredView>& views) {
    std::vector<std::string> figures;
    for (std::size_t i = 0; i < std::min(imaged_views, views.size()); ++i) {
        const ScoredView& view = views[i];
        figures.push_back(html_comparison({"photograph", encode_webp(view.truth)},
                                          {"render", encode_webp(view.image)},
                                          fmt::format("{}: {:.2f} dB, SSIM {:.3f}", view.score.name,
                                                      view.score.psnr, view.score.ssim)));
        figures.push_back(
            html_figure({"difference (white: 32 of 255)", encode_webp(error_map(view))}));
    }
    return html_gallery(figures, 230);
}

std::string material_figures(const MaterialTruth& truth) {
    std::vector<std::string> figures;
    for (std::size_t i = 0; i < std::min(imaged_views / 2, truth.views.size()); ++i) {
        const MaterialMaps& maps = truth.views[i];
        figures.push_back(html_comparison({"true", encode_webp(maps.true_base_color)},
                                          {"found", encode_webp(maps.base_color)},
                                          maps.name + ": base colour"));
        if (maps.material.empty()) continue;
        figures.push_back(html_comparison({"true", encode_webp(maps.true_material)},
                                          {"found", encode_webp(maps.material)},
                                          maps.name + ": roughness green, metallic blue"));
    }
    return html_gallery(figures, 230);
}

Image light_display(const Image& light) {
    Image image(light.width, light.height, 3);
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
        image.pixels[i] = linear_to_srgb(light.pixels[i] / (1 + light.pixels[i]));
    return resize(image, 512, 256);
}

std::string model_figures(const Reconstruction& result) {
    std::vector<std::string> figures;
    const EnvironmentLight studio = prefilter(make_light_preset("studio"), 128);
    const at::Tensor images =
        draw_images(result.model, studio, image_cameras(result.model, 4), model_image_size);
    for (const at::Tensor& image : images.unbind(0))
        figures.push_back(html_figure({"", encode_webp(to_display(to_image(image), Vec3(0.78f)))}));
    for (const Texture& texture : result.model.textures)
        figures.push_back(html_figure({texture.name, encode_webp(thumbnail(texture.image, 512))}));
    figures.push_back(
        html_figure({"light.hdr, tone mapped", encode_webp(light_display(result.light))}));
    return html_gallery(figures, 240);
}

std::string scores_table(const Reconstruction& result) {
    TableRows rows;
    const auto add = [&](const std::string& name, const std::vector<ScoredView>& views) {
        if (views.empty()) return;
        const ViewScore mean = mean_score(views);
        rows.emplace_back(fmt::format("{} ({} views)", name, views.size()),
                          fmt::format("{:.2f} dB, SSIM {:.3f}, masks {:.4f}", mean.psnr, mean.ssim,
                                      mean.mask_overlap));
    };
    add("Held-out views", result.test);
    if (result.request.refine.shadows)
        add("Held-out views, without traced shadows", result.test_without_shadows);
    add("Held-out views, one gain per view and channel", result.test_scaled);
    add("Held-out views, with gains and refined cameras", result.test_aligned);
    add("Training views", result.train);
    for (std::size_t i = 0; i < result.relit.size(); ++i) {
        const std::string light = result.request.relit[i].light;
        add("In another light, " + light, result.relit[i].as_it_is);
        add("In another light, " + light + ", one gain per channel", result.relit[i].scaled);
    }
    if (result.materials)
        rows.emplace_back(
            "Materials",
            fmt::format("base colour {:.2f} dB (one gain per channel), metallic correct on {:.1f} "
                        "%, mean roughness error {:.3f}",
                        result.materials->base_color_psnr, 100 * result.materials->metallic_right,
                        result.materials->roughness_error));
    if (result.chamfer)
        rows.emplace_back("Chamfer distance",
                          fmt::format("{:.3f} % of the diagonal", 100 * *result.chamfer));
    rows.emplace_back("Model", fmt::format("{} triangles", result.model.triangle_count()));
    return html_table(rows);
}

std::string dataset_table(const Reconstruction& result) {
    const Dataset& dataset = result.dataset;
    const Image& first = dataset.train.front().image;
    const nlohmann::json& corrections = result.corrections;
    return html_table(
        {{"Layout", dataset_kind_name(dataset.kind)},
         {"Views",
          fmt::format("{} for training, {} held out", dataset.train.size(), dataset.test.size())},
         {"Size", fmt::format("{} x {}", first.width, first.height)},
         {"Masks", dataset.masks},
         {"Poses", fmt::format("moved by at most {:.2f} degrees and {:.2f} % of the radius",
                               corrections["largest_turn_degrees"].get<double>(),
                               100 * corrections["largest_shift"].get<double>())},
         {"Exposure",
          fmt::format("gains of {:.2f} to {:.2f}", corrections["least_gain"].get<double>(),
                      corrections["greatest_gain"].get<double>())}});
}

std::string charts(const Reconstruction& result) {
    std::string html;
    const auto add = [&](const std::string& title, const RefineCurves& curves) {
        Chart chart{title, "iteration", {{"difference, log-sRGB", curves.image, 1, 1}}, true};
        html += html_chart(chart);
        html +=
            html_chart({title + ": outline", "iteration", {{"coverage", curves.mask, 1, 1}}, true});
    };
    if (result.shape) {
        add("Shape", result.shape->curves);
        html += html_chart({"Shape: triangles",
                            "iteration",
                            {{"triangles", result.shape->triangles, 1, 1}},
                            false});
    }
    add("Materials and light", result.refine);
    return "<div class=\"charts\">\n" + html + "</div>\n";
}

}  // namespace

std::string report_html(const Reconstruction& result) {
    std::string warnings;
    for (const std::string& warning : result.warnings)
        warnings += "<li>" + html_escape(warning) + "</li>";
    if (!warnings.empty()) warnings = "<ul class=\"warnings\">" + warnings + "</ul>\n";
    std::string body =
        html_header("item3d reconstruct", result.request.dataset.filename().string(), warnings);
    body += html_section("Scores", scores_table(result));
    body += html_section("Held-out views", view_figures(result.test));
    body += html_section("Training views", view_figures(result.train));
    for (std::size_t i = 0; i < result.relit.size(); ++i)
        body += html_section("In another light: " + result.request.relit[i].light,
                             view_figures(result.relit[i].as_it_is));
    if (result.materials)
        body +=
            html_section("Materials compared with the truth", material_figures(*result.materials));
    body += html_section("Model and light", model_figures(result));
    body +=
        html_section("Photographs and cameras",
                     dataset_table(result) + camera_plot(result.dataset, result.model.bounds()));
    body += html_section("Progress", charts(result));
    body += html_section("Time per stage", html_timings(result.times.stages()));
    body += "<footer><p><code>" + html_escape(result.request.command) + "</code></p><p>item3d " +
            html_escape(version()) + "</p></footer>\n";
    return html_page("item3d reconstruct", body);
}

}  // namespace item3d
