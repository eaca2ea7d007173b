// Comparison of the renderer with path-traced references.
//
//   reference_report --data DIR -o OUT
//
// Writes the tables of docs/renderer.md ("Comparison with path tracing") as report.md, the same
// numbers as report.json, and the images.
#include "bench/reference_report.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/io/load.h"
#include "item3d/io/save.h"
#include "item3d/render/image_tensor.h"
#include "item3d/render/srgb.h"
#include "item3d/tensors/process.h"

#include <CLI/CLI.hpp>

#include <functional>

namespace item3d::reference {

Difference difference(const at::Tensor& found, const at::Tensor& expected) {
    const at::Tensor error = (found - expected).abs();
    return {(error.mean() / expected.mean()).item<double>(),
            (error / expected.abs().clamp_min(1e-4f)).median().item<double>(),
            (found.sum() / expected.sum()).item<double>()};
}

at::Tensor load_reference(const std::filesystem::path& path) {
    return to_tensor(load_image(path));
}

void save_tiles(const std::filesystem::path& path,
                const std::vector<std::vector<at::Tensor>>& tiles) {
    std::vector<at::Tensor> rows;
    for (const auto& row : tiles)
        rows.push_back(at::cat(row, 1));
    save_image(path, to_image(linear_to_srgb(at::cat(rows, 0).clamp(0, 1))));
}

namespace {

std::string markdown(const Section& section) {
    std::string out = "## " + section.title + "\n\n" + section.text + "\n\n";
    const auto line = [](const std::vector<std::string>& cells) {
        return fmt::format("| {} |\n", fmt::join(cells, " | "));
    };
    out += line(section.columns);
    out += line(std::vector<std::string>(section.columns.size(), "---"));
    for (const auto& row : section.rows)
        out += line(row);
    for (const std::string& image : section.images)
        out += "\n![" + section.title + "](" + image + ")\n";
    return out + "\n";
}

int run(int argc, char** argv) {
    CLI::App app("Compares the renderer with path-traced references.");
    Folders folders;
    app.add_option("--data", folders.data, "Folder of the references")->required();
    app.add_option("-o,--output", folders.output,
                   "Folder for report.md, report.json and the images")
        ->required();
    std::string only;
    app.add_option("--only", only,
                   "Only the sections whose name begins with this: furnace, bsdf, irradiance, "
                   "spheres, sky, geometry, views, gradient");
    CLI11_PARSE(app, argc, argv);
    make_output_folder(folders.output);

    const std::vector<std::pair<std::string, std::function<Section()>>> all = {
        {"furnace", [] { return furnace_section(); }},
        {"bsdf", [&] { return bsdf_section(folders); }},
        {"irradiance", [&] { return irradiance_section(folders); }},
        {"spheres", [&] { return sphere_section(folders, "studio"); }},
        {"sky", [&] { return sphere_section(folders, "sky_noon"); }},
        {"geometry", [&] { return geometry_section(folders); }},
        {"views", [&] { return view_section(folders); }},
        {"gradient", [&] { return gradient_section(folders); }}};
    std::vector<std::function<Section()>> sections;
    for (const auto& [name, section] : all)
        if (name.starts_with(only)) sections.push_back(section);
    Progress progress("reference", static_cast<std::int64_t>(sections.size()));
    std::string page;
    nlohmann::json numbers = nlohmann::json::object();
    for (std::size_t i = 0; i < sections.size(); ++i) {
        const Section section = sections[i]();
        page += markdown(section);
        numbers[section.title] = section.numbers;
        progress.update(static_cast<std::int64_t>(i) + 1);
    }
    progress.finish();
    write_atomically(folders.output / "report.md", page);
    write_atomically(folders.output / "report.json", numbers.dump(2) + "\n");
    fmt::print("{}\n", (folders.output / "report.md").string());
    return 0;
}

}  // namespace
}  // namespace item3d::reference

int main(int argc, char** argv) {
    item3d::prepare_process();
    try {
        return item3d::reference::run(argc, argv);
    } catch (const std::exception& error) {
        fmt::print(stderr, "reference_report: error: {}\n", error.what());
        return 3;
    }
}
