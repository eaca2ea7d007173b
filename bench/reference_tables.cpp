// Comparison of the BSDF table, a white furnace, irradiance and the gradient of a texture with
// references.
#include "bench/reference_report.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/io/load.h"
#include "item3d/lighting/environment.h"
#include "item3d/render/interpolate.h"
#include "item3d/render/prefilter/bsdf_table.h"
#include "item3d/render/scatter.h"
#include "item3d/render/shade.h"
#include "item3d/render/texture.h"

#include <fstream>

namespace item3d::reference {
namespace {

/// Returns surface points with the given normals and directions to the viewer.
Surface surface_of(const at::Tensor& normals, const at::Tensor& view) {
    Surface surface;
    surface.pixel = at::arange(normals.size(0));
    surface.normal = normals.contiguous();
    surface.view = view.contiguous();
    surface.tangent = at::zeros({normals.size(0), 4});
    return surface;
}

MaterialSample white(std::int64_t count, float roughness, float metallic) {
    MaterialSample sample;
    sample.base_color = at::ones({count, 3});
    sample.orm = at::tensor({1.0f, roughness, metallic}).repeat({count, 1});
    return sample;
}

}  // namespace

Section furnace_section() {
    Section section;
    section.title = "White furnace";
    section.text =
        "A white metal that is lit from everywhere by radiance 1 must be invisible. The table has "
        "the darkest and the brightest radiance over all angles of view, without and with the "
        "energy that bounces between microfacets. The ideal is 1.";
    section.columns = {"roughness", "single scattering, darkest",
                       "with multiple scattering, darkest", "brightest"};
    const EnvironmentLight light = prefilter(at::ones({6, 32, 32, 3}));
    const at::Tensor cosine = at::linspace(0.05f, 1, 96);
    const at::Tensor view =
        at::stack({(1 - cosine.square()).sqrt(), at::zeros_like(cosine), cosine}, 1);
    const at::Tensor normals = at::tensor({0.0f, 0.0f, 1.0f}).repeat({96, 1});
    for (const float roughness : {0.1f, 0.25f, 0.5f, 0.75f, 1.0f}) {
        const Surface surface = surface_of(normals, view);
        const MaterialSample metal = white(96, roughness, 1);
        ShadeOptions options;
        options.multiple_scattering = false;
        const at::Tensor single = shade(surface, metal, light, options);
        options.multiple_scattering = true;
        const at::Tensor multiple = shade(surface, metal, light, options);
        section.rows.push_back({fmt::format("{:.2f}", roughness),
                                fmt::format("{:.4f}", single.min().item<double>()),
                                fmt::format("{:.4f}", multiple.min().item<double>()),
                                fmt::format("{:.4f}", multiple.max().item<double>())});
        section.numbers[fmt::format("{:.2f}", roughness)] = {
            {"single_darkest", single.min().item<double>()},
            {"darkest", multiple.min().item<double>()},
            {"brightest", multiple.max().item<double>()}};
    }
    return section;
}

Section bsdf_section(const Folders& folders) {
    at::Tensor reference = at::empty({256, 256, 2});
    std::ifstream(folders.data / "dfg" / "dfg_correlated.bin", std::ios::binary)
        .read(reinterpret_cast<char*>(reference.data_ptr<float>()),
              reference.numel() * static_cast<std::int64_t>(sizeof(float)));
    const at::Tensor error = (bsdf_table() - reference).abs();
    Section section;
    section.title = "BSDF table";
    section.text =
        "The build computes a table of scale $A$ and bias $B$ with 256 x 256 entries. It is "
        "compared with a table by midpoint quadrature with 128 x 128 half vectors, and at nine "
        "points with a quadrature of 2048 x 1024. The last row compares the 128 x 128 table itself "
        "with the finer quadrature.";
    section.columns = {"where", "A, largest", "B, largest", "A, mean", "B, mean"};
    const auto add = [&](const std::string& name, const at::Tensor& part) {
        const at::Tensor flat = part.reshape({-1, 2});
        std::vector<std::string> row{name};
        for (const int c : {0, 1})
            row.push_back(fmt::format("{:.1e}", flat.select(1, c).max().item<double>()));
        for (const int c : {0, 1})
            row.push_back(fmt::format("{:.1e}", flat.select(1, c).mean().item<double>()));
        section.rows.push_back(row);
        section.numbers[name] = {{"largest", flat.max().item<double>()},
                                 {"mean", flat.mean().item<double>()}};
    };
    add("the whole table", error);
    add("roughness above 0.1", error.slice(0, 26));
    add("roughness above 0.2", error.slice(0, 52));
    add("roughness above 0.1, n.v above 0.1", error.slice(0, 26).slice(1, 26));

    const auto fine = nlohmann::json::parse(
        read_text(folders.data / "dfg" / "dfg.json"))["correlated"]["samples"];
    at::Tensor differences = at::zeros({static_cast<std::int64_t>(fine.size()), 2});
    at::Tensor of_table = at::zeros_like(differences);
    const auto bilinear = [](const at::Tensor& table, double n_dot_v, double roughness) {
        const double x = n_dot_v * 256 - 0.5, y = roughness * 256 - 0.5;
        const auto x0 = static_cast<std::int64_t>(x);
        const auto y0 = std::min<std::int64_t>(static_cast<std::int64_t>(y), 254);
        const double fx = x - static_cast<double>(x0), fy = y - static_cast<double>(y0);
        return (1 - fy) * ((1 - fx) * table[y0][x0] + fx * table[y0][x0 + 1]) +
               fy * ((1 - fx) * table[y0 + 1][x0] + fx * table[y0 + 1][x0 + 1]);
    };
    std::int64_t i = 0;
    for (const auto& [name, value] : fine.items()) {
        const double n_dot_v = std::stod(name.substr(2)), roughness = std::stod(name.substr(7));
        const at::Tensor exact = at::tensor({value[0].get<float>(), value[1].get<float>()});
        differences[i] = (bilinear(bsdf_table(), n_dot_v, roughness) - exact).abs();
        of_table[i] = (bilinear(reference, n_dot_v, roughness) - exact).abs();
        ++i;
    }
    add("nine points, 2048 x 1024", differences);
    add("the same, of the 128 x 128 table itself", of_table);
    return section;
}

Section irradiance_section(const Folders& folders) {
    Section section;
    section.title = "Irradiance";
    section.text = "$E(n)$ at 256 x 128 normals, compared with a sum over all texels of the map.";
    section.columns = {"light", "mean difference over the mean", "largest, relative"};
    for (const std::string name : {"sky_noon", "studio"}) {
        const EnvironmentLight light =
            prefilter(load_image(folders.data / "env" / (name + ".hdr")));
        const at::Tensor reference =
            load_reference(folders.data / "env" / (name + "_irradiance.exr")).narrow(2, 0, 3);
        const std::int64_t height = reference.size(0), width = reference.size(1);
        at::Tensor normals = at::empty({height * width, 3});
        for (std::int64_t i = 0; i < height * width; ++i) {
            const Vec3 d = equirectangular_direction(
                (static_cast<float>(i % width) + 0.5f) / static_cast<float>(width),
                (static_cast<float>(i / width) + 0.5f) / static_cast<float>(height));
            for (int c = 0; c < 3; ++c)
                normals[i][c] = d[c];
        }
        EnvironmentLight diffuse_only = light;
        for (at::Tensor& level : diffuse_only.specular)
            level = at::zeros_like(level);
        const at::Tensor found =
            shade(surface_of(normals, normals), white(height * width, 1, 0), diffuse_only)
                .reshape_as(reference);
        const at::Tensor error = (found - reference).abs();
        const double mean = (error.mean() / reference.mean()).item<double>();
        const double largest = (error / reference).max().item<double>();
        section.rows.push_back(
            {name, fmt::format("{:.3f} %", 100 * mean), fmt::format("{:.2f} %", 100 * largest)});
        section.numbers[name] = {{"mean", mean}, {"largest", largest}};
    }
    return section;
}

Section gradient_section(const Folders& folders) {
    const auto folder = folders.data / "gradcheck";
    const auto scene = nlohmann::json::parse(read_text(folder / "scene.json"));
    Model model = load_model(folders.data / "meshes" / "spot" / "spot.obj");
    for (Primitive& primitive : model.primitives)
        compute_smooth_normals(primitive);  // the references do not use the file's normals
    const Geometry geometry = Geometry::from_model(model);
    Camera camera;
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column)
            camera.camera_to_world[column][row] =
                scene["camera_to_world_opengl"][static_cast<std::size_t>(row)]
                     [static_cast<std::size_t>(column)];
    camera.field_of_view_x = scene["fov_x_deg"].get<float>() * pi / 180;
    constexpr int size = 128, grid = 8;
    const Raster raster = rasterize(geometry, {camera}, size * grid, size * grid);
    const Surface surface = interpolate_surface(geometry, raster, {camera});
    EnvironmentLight light = prefilter(load_image(folders.data / "env" / "sky_noon.hdr"));
    for (at::Tensor& level : light.specular)
        level = at::zeros_like(level);
    const auto load = [&](const std::string& name) {
        return load_reference(folder / (name + ".exr")).narrow(2, 0, 3).contiguous();
    };
    at::Tensor texture = load("texture_now").set_requires_grad(true);
    MaterialSample material;
    material.base_color = sample_texture(texture, surface.uv);
    material.orm = at::tensor({1.0f, 1.0f, 0.0f}).expand({surface.count(), 3});
    const at::Tensor rendered =
        scatter(shade(surface, material, light), surface, raster, at::zeros({3}))[0]
            .reshape({size, grid, size, grid, 3})
            .mean({1, 3});
    (rendered - load("ibl_target")).square().mean().backward();

    Section section;
    section.title = "Gradient of a texture";
    section.text =
        "The gradient of the mean squared difference to a target, with respect to a 64 x 64 base "
        "colour texture on spot. *ibl* is a reference without shadows, which ours must match. "
        "*path* is path traced with shadows. The last column is the difference of the rendered "
        "image.";
    section.columns = {"reference", "cosine", "relative difference", "image"};
    for (const std::string kind : {"ibl", "path"}) {
        const at::Tensor expected = load(kind + "_gradient"), found = texture.grad();
        const double cosine =
            ((found * expected).sum() / found.norm() / expected.norm()).item<double>();
        const double relative = ((found - expected).norm() / expected.norm()).item<double>();
        const Difference image = difference(rendered.detach(), load(kind + "_image"));
        section.rows.push_back({kind, fmt::format("{:.5f}", cosine),
                                fmt::format("{:.2f} %", 100 * relative),
                                fmt::format("{:.2f} %", 100 * image.mean)});
        section.numbers[kind] = {{"cosine", cosine}, {"relative", relative}, {"image", image.mean}};
    }
    return section;
}

}  // namespace item3d::reference
