// Command item3d render: renders images of a model, which are shaded or show a material channel.
#include "item3d/render/render.h"

#include "apps/item3d/command.h"
#include "apps/item3d/edit/commands.h"
#include "apps/item3d/edit/image_options.h"
#include "apps/item3d/edit/light_options.h"
#include "apps/item3d/edit/model_options.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/io/load.h"
#include "item3d/io/load_light.h"
#include "item3d/io/save.h"
#include "item3d/lighting/environment.h"
#include "item3d/metrics/color.h"
#include "item3d/render/image_tensor.h"
#include "item3d/render/occlusion/indirect_light.h"
#include "item3d/render/occlusion/occlusion.h"
#include "item3d/render/scatter.h"
#include "item3d/render/srgb.h"
#include "item3d/render/textured_materials.h"
#include "item3d/report/display_image.h"
#include "item3d/scene/camera.h"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace item3d {

namespace {

namespace fs = std::filesystem;

struct RenderCommand : CommonOptions {
    std::string model;
    std::string variant;
    std::string output;
    int views = 0;  ///< 0: one image from the default camera
    std::string cameras;
    std::vector<fs::path> texture_folders;
    std::string format = "png";
    std::string light = "studio";
    float light_rotation = 0;
    float exposure = 0;
    std::string size = "512x512";
    std::string channel = "shaded";
    std::string background = "none";
    std::string occlusion = "none";
    bool indirect = false;
    int samples = 0;  ///< along each side of a pixel; 0: 2, or 1 for images that would be too large
};

/// Output of the images. It is one file, or a folder with a file for each camera.
struct Destination {
    fs::path path;
    bool folder = false;
    std::string extension;

    fs::path file(const Camera& camera) const {
        return folder ? path / (camera.name + extension) : path;
    }
};

Destination choose_destination(const RenderCommand& options, std::size_t images) {
    Destination destination;
    destination.path = options.output;
    const std::string extension = lower_extension(destination.path);
    destination.folder = extension != ".png" && extension != ".exr";
    destination.extension = destination.folder ? "." + options.format : extension;
    if (destination.folder && is_file_name(extension))
        throw UsageError(
            fmt::format("-o {}: images are written as .png or .exr; expected a file name with one "
                        "of these, or a folder",
                        options.output));
    if (!destination.folder && images > 1) {
        throw UsageError(
            fmt::format("-o {}: {} images need a folder, not one file", options.output, images));
    }
    if (destination.folder) {
        make_output_folder(destination.path);
    } else if (fs::is_directory(destination.path)) {
        throw InputError(options.output, "is a folder; expected a file name for the image",
                         "add a file name, such as image.png");
    } else {
        make_folder_of(destination.path);
    }
    return destination;
}

std::vector<Camera> choose_cameras(const RenderCommand& options, const Model& model,
                                   ImageSize size) {
    const float aspect = static_cast<float>(size.width) / static_cast<float>(size.height);
    const std::array<Vec3, 2> bounds = model.bounds();
    std::vector<Camera> cameras;
    if (!options.cameras.empty()) {
        cameras = load_cameras(options.cameras, model.origin);
        for (Camera& camera : cameras)
            fit_depth_range(camera, bounds);
    } else if (options.views > 0) {
        cameras = turntable(bounds, options.views, default_elevation, default_field_of_view);
        for (Camera& camera : cameras) {
            camera.field_of_view_x = horizontal_field_of_view(default_field_of_view, aspect);
        }
    } else {
        cameras = {default_view(model, aspect)};
        cameras.front().name = "view_000";
    }
    return cameras;
}

int choose_samples(const RenderCommand& options, ImageSize size) {
    const int maximum = largest_side / std::max(size.width, size.height);
    if (options.samples == 0) return std::min(2, maximum);
    if (options.samples > maximum) {
        throw UsageError(
            fmt::format("--samples {}: at most {} with this --size", options.samples, maximum));
    }
    return options.samples;
}

/// Warns of extensions of the shown materials that this renderer does not support.
void warn_of_what_is_not_shown(const std::string& file, const Model& model) {
    std::set<std::string> names;
    for (const Primitive& primitive : model.primitives) {
        for (const std::string& name :
             model.materials[static_cast<std::size_t>(primitive.material)].other_extensions) {
            if (name.starts_with("KHR_materials_")) names.insert(name);
        }
    }
    if (!names.empty()) warn(fmt::format("{}: not shown: {}", file, fmt::join(names, ", ")));
}

/// Returns the world-space normal with the material's normal map applied, [P, 3].
at::Tensor shading_normal(const Surface& surface, const MaterialSample& sample) {
    if (!sample.normal.defined()) return surface.normal;
    const auto unit = [](const at::Tensor& v) {
        return v / v.norm(2, {-1}, /*keepdim=*/true).clamp_min(1e-12);
    };
    const at::Tensor& n = surface.normal;
    const at::Tensor along = surface.tangent.narrow(-1, 0, 3);
    const at::Tensor tangent = unit(along - n * (n * along).sum(-1, true));
    const at::Tensor bitangent = at::linalg_cross(n, tangent) * surface.tangent.narrow(-1, 3, 1);
    const at::Tensor mapped = tangent * sample.normal.narrow(-1, 0, 1) +
                              bitangent * sample.normal.narrow(-1, 1, 1) +
                              n * sample.normal.narrow(-1, 2, 1);
    // Without UVs the tangent is zero and the surface's own normal is used.
    return at::where(along.square().sum(-1, true) > 0, unit(mapped), n);
}

/// Renderer of the requested channel. Its values are linear, as in OpenEXR.
class Painter {
  public:
    Painter(const RenderCommand& options, const Model& model, at::Device device)
        : channel_(options.channel),
          size_(parse_size(options.size)),
          samples_(choose_samples(options, size_)),
          geometry_(Geometry::from_model(model, device)),
          materials_(model, device) {
        if (options.background != "none") {
            const Vec3 color = parse_color(options.background);
            background_ = Vec3(item3d::srgb_to_linear(color.x), item3d::srgb_to_linear(color.y),
                               item3d::srgb_to_linear(color.z));
        }
        if (channel_ == "shaded") {
            const Image light =
                adjust_light(load_light(options.light), options.light_rotation, options.exposure);
            light_ = prefilter(light, 256, device);
            if (options.occlusion != "none") {
                OcclusionOptions occlusion;
                if (options.occlusion == "light") occlusion.light = light;
                occlusion_ = std::make_shared<Occlusion>(geometry_, &model, occlusion);
            }
            if (options.indirect)
                indirect_ = trace_indirect_light(geometry_, model, materials_, light_, *occlusion_);
        }
    }

    /// Returns an image in premultiplied RGBA, or with one channel for depth and mask.
    Image linear(const Camera& camera) const {
        const at::NoGradGuard no_gradients;
        if (channel_ != "shaded") return values(camera);
        RenderOptions options;
        options.width = size_.width;
        options.height = size_.height;
        options.supersampling = samples_;
        options.background = background_;
        options.occlusion = occlusion_;
        options.indirect = indirect_;
        return to_image(render(geometry_, materials_, light_, {camera}, options)[0].cpu());
    }

    /// True if any pixel of the image shows the model.
    bool sees_model(const Camera& camera) const {
        const at::NoGradGuard no_gradients;
        Raster raster = rasterize(geometry_, {camera}, size_.width, size_.height);
        for (int layer = 0; layer < max_layers; ++layer) {
            const at::Tensor covered = raster.triangle >= 0;
            if (!covered.any().item<bool>()) return false;
            if (!materials_.has_alpha()) return true;
            const Surface surface = interpolate_surface(geometry_, raster, {camera});
            if ((materials_.sample(surface).alpha > 0).any().item<bool>()) return true;
            raster = rasterize(geometry_, {camera}, size_.width, size_.height, raster.depth);
        }
        return false;
    }

    /// Converts linear() to PNG values.
    Image display(const Image& linear, const Camera& camera) const {
        if (channel_ == "mask") return linear;
        if (channel_ == "depth") return depth_display(linear, camera);
        if (channel_ == "shaded" || channel_ == "base_color") {
            return to_display(linear, channel_ == "shaded" ? background_ : std::nullopt);
        }
        Image shown = linear;
        if (channel_ == "normal") {
            for (int i = 0; i < shown.width * shown.height; ++i) {
                float* pixel = &shown.pixels[static_cast<std::size_t>(i) * 4];
                for (int c = 0; c < 3; ++c)
                    pixel[c] = pixel[3] * (0.5f + 0.5f * pixel[c]);
            }
        }
        return shown;
    }

  private:
    /// Returns material channels, sampled at pixel centres, because means over an edge would not be
    /// values of any material.
    Image values(const Camera& camera) const {
        const Raster raster = visible(camera);
        if (channel_ == "depth") return to_image(raster.depth[0].unsqueeze(-1).cpu());
        const at::Tensor mask = (raster.triangle[0] >= 0).to(at::kFloat).unsqueeze(-1);
        if (channel_ == "mask") return to_image(mask.cpu());

        const Surface surface = interpolate_surface(geometry_, raster, {camera});
        const MaterialSample sample = materials_.sample(surface);
        at::Tensor chosen = sample.base_color;
        if (channel_ == "orm") chosen = sample.orm;
        if (channel_ == "normal") chosen = shading_normal(surface, sample);
        const at::Tensor image = scatter(chosen, surface, raster, at::zeros({3}, chosen.options()));
        return to_image(at::cat({image[0], mask}, -1).cpu());
    }

    /// Returns the nearest surface that is at least half opaque.
    Raster visible(const Camera& camera) const {
        Raster raster = rasterize(geometry_, {camera}, size_.width, size_.height);
        for (int layer = 1; materials_.has_alpha() && layer < max_layers; ++layer) {
            const Surface surface = interpolate_surface(geometry_, raster, {camera});
            const at::Tensor alpha = materials_.sample(surface).alpha.unsqueeze(-1);
            const at::Tensor open =
                scatter(alpha, surface, raster, at::ones({1}, alpha.options())).squeeze(-1) < 0.5f;
            if (!open.any().item<bool>()) break;
            // No surface is behind the farthest depth, so the pixels that are already found stay as
            // they are.
            const Raster next =
                rasterize(geometry_, {camera}, size_.width, size_.height,
                          at::where(open, raster.depth, at::full_like(raster.depth, 1e30f)));
            raster.triangle = at::where(open, next.triangle, raster.triangle);
            raster.depth = at::where(open, next.depth, raster.depth);
            raster.barycentrics =
                at::where(open.unsqueeze(-1), next.barycentrics, raster.barycentrics);
        }
        return raster;
    }

    /// Returns the depth for display. It falls from 1 at the near end of the model's box to 0.1 at
    /// the far end, and is 0 on background.
    static Image depth_display(const Image& depth, const Camera& camera) {
        Image shown = depth;
        const float span =
            std::max(camera.far_plane - camera.near_plane, std::numeric_limits<float>::min());
        for (float& value : shown.pixels) {
            if (value > 0) {
                value = 1 - 0.9f * std::clamp((value - camera.near_plane) / span, 0.0f, 1.0f);
            }
        }
        return shown;
    }

    static constexpr int max_layers = 8;

    std::string channel_;
    ImageSize size_;
    int samples_;
    std::optional<Vec3> background_;
    Geometry geometry_;
    TexturedMaterials materials_;
    EnvironmentLight light_;
    std::shared_ptr<const Occlusion> occlusion_;
    std::shared_ptr<const IndirectLight> indirect_;
};

void run_render(RenderCommand options, at::Device device) {
    if (options.indirect) {
        if (device.is_cuda())
            throw ResourceError("--indirect is computed on the CPU; use --device cpu");
        if (options.occlusion == "none") options.occlusion = "light";
    }
    if (!options.cameras.empty() && options.views > 0) {
        throw UsageError("--views and --cameras cannot be combined; leave out one of them");
    }
    if (options.occlusion != "none" && options.channel != "shaded") {
        throw UsageError("--occlusion and --indirect require --channel shaded");
    }
    const ImageSize size = parse_size(options.size);
    const Model model = load_model(
        options.model, {.texture_folders = options.texture_folders, .variant = options.variant});
    warn_of_what_is_not_shown(options.model, model);
    const std::vector<Camera> cameras = choose_cameras(options, model, size);
    const Destination destination = choose_destination(options, cameras.size());
    const Painter painter(options, model, device);

    nlohmann::json files = nlohmann::json::array();
    bool model_is_seen = false;
    Progress progress("render", static_cast<std::int64_t>(cameras.size()));
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        if (interrupted()) {
            throw Interrupted(fmt::format("{} of {} images were written", i, cameras.size()));
        }
        const fs::path path = destination.file(cameras[i]);
        const Image linear = painter.linear(cameras[i]);
        model_is_seen = model_is_seen || painter.sees_model(cameras[i]);
        if (destination.extension == ".exr") {
            save_image(path, linear, 32);
        } else {
            const Image image = painter.display(linear, cameras[i]);
            save_image(path, image, options.channel == "depth" ? 16 : 8);
        }
        files.push_back(path.string());
        progress.update(static_cast<std::int64_t>(i + 1));
    }
    progress.finish();
    if (!model_is_seen) {
        warn(options.model + ": the model is not visible in the " +
             (cameras.size() == 1 ? "image" : "images") +
             (options.cameras.empty() ? "" : "; check that the cameras look at it"));
    }
    if (options.json) {
        print_json({{"files", files},
                    {"width", size.width},
                    {"height", size.height},
                    {"channel", options.channel}});
    } else {
        fmt::print("{}\n", destination.path.string());
    }
}

}  // namespace

void add_render_command(CLI::App& app) {
    auto options = std::make_shared<RenderCommand>();
    CLI::App* command = add_command(app, "render", *options);
    command->add_option("MODEL", options->model, "A " + model_extensions_text() + " file")
        ->required();
    command
        ->add_option("-o,--output", options->output,
                     "Image file (.png, .exr), or a folder for several images")
        ->type_name("FILE|FOLDER")
        ->required();
    command
        ->add_option("--variant", options->variant,
                     "Variant to render, by name, of a glTF with several")
        ->type_name("NAME");
    command->add_option("--views", options->views, "Number of views around the model")
        ->check(CLI::Range(1, 10000));
    command
        ->add_option("--cameras", options->cameras,
                     "Cameras, one image each: a NeRF-synthetic transforms.json in the coordinates "
                     "of the model")
        ->type_name("FILE");
    add_texture_folders(*command, options->texture_folders);
    command->add_option("--format", options->format, "Format of the images in a folder")
        ->check(CLI::IsMember({"png", "exr"}))
        ->capture_default_str();
    command
        ->add_option("--light", options->light,
                     "Light: " + light_presets_text() + ", or an equirectangular .hdr or .exr file")
        ->type_name("LIGHT")
        ->capture_default_str();
    command
        ->add_option("--light-rotation", options->light_rotation,
                     "Rotation of the light about +Y, from -Z towards +X")
        ->type_name("DEGREES")
        ->check(number_between(-36000, 36000))
        ->capture_default_str();
    command
        ->add_option("--exposure", options->exposure,
                     "Exposure: the light is multiplied by 2^STOPS")
        ->type_name("STOPS")
        ->check(number_between(-30, 30))
        ->capture_default_str();
    command->add_option("--size", options->size, "Size of an image, in pixels")
        ->type_name("WxH")
        ->capture_default_str();
    command
        ->add_option("--channel", options->channel,
                     "Quantity to draw: shaded, or at pixel centres base_color, orm, normal (world "
                     "space), depth (along the view axis), mask")
        ->check(CLI::IsMember({"shaded", "base_color", "orm", "normal", "depth", "mask"}))
        ->capture_default_str();
    command
        ->add_flag("--occlusion{ambient}", options->occlusion,
                   "Ambient occlusion. =light: shadows of this light and its sun. Multiplied with "
                   "an occlusion texture, if any")
        ->check(CLI::IsMember({"none", "ambient", "light"}));
    command->add_flag("--indirect", options->indirect,
                      "Indirect light: light and reflections between surfaces. Implies "
                      "--occlusion=light if --occlusion is not given");
    command
        ->add_option("--samples", options->samples,
                     "Samples along each side of a pixel. Default: 2, or 1 for images that are too "
                     "large for 2")
        ->check(CLI::Range(1, 16));
    command
        ->add_option("--background", options->background,
                     "Background: a colour by name, #rrggbb, or none for a transparent one")
        ->type_name("COLOUR")
        ->capture_default_str();
    command->callback([options] { run_render(*options, start_command(*options)); });
}

}  // namespace item3d
