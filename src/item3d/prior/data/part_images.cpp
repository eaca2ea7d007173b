#include "item3d/prior/data/part_images.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/parse_json.h"
#include "item3d/core/progress.h"
#include "item3d/tensors/safetensors.h"
#include "item3d/tensors/workers.h"

#include <array>
#include <atomic>
#include <mutex>

namespace item3d {
namespace {

std::filesystem::path tensors_file(const std::filesystem::path& folder, const std::string& name) {
    return folder / (name + ".safetensors");
}

std::filesystem::path json_file(const std::filesystem::path& folder, const std::string& name) {
    return folder / (name + ".json");
}

}  // namespace

at::Tensor PartImages::pixel_values(const std::vector<std::int64_t>& rows) const {
    return images.index_select(0, at::tensor(rows))
        .permute({0, 3, 1, 2})
        .to(at::kFloat)
        .div(127.5)
        .sub(1);
}

at::Tensor PartImages::mask(std::int64_t row, std::uint32_t set) const {
    std::array<float, 256> value{};
    for (std::size_t i = 0; i < max_parts; ++i)
        value[i + 1] = (set >> i & 1u) != 0 ? 1.0f : 0.0f;
    const at::Tensor map = parts[row];
    at::Tensor result = at::empty(map.sizes(), at::kFloat);
    const auto* part = map.const_data_ptr<std::uint8_t>();
    auto* out = result.mutable_data_ptr<float>();
    for (std::int64_t i = 0; i < map.numel(); ++i)
        out[i] = value[part[i]];
    return result;
}

PartImages draw_part_images(const ExampleSource& source, std::int64_t count, int threads) {
    PartImages result;
    const std::int64_t size = source.views().front().size / view_samples;
    result.images = at::empty({count, size, size, 3}, at::kByte);
    result.parts = at::empty({count, size, size}, at::kByte);
    result.labels.resize(static_cast<std::size_t>(count));
    Progress progress("images", count);
    std::atomic<std::int64_t> done = 0;
    std::mutex mutex;
    run_workers(count, threads, [&](std::int64_t i) {
        const Example example = source.draw(i);
        result.images[i].copy_((example.image * 255).round());
        result.parts[i].copy_(part_map_of(example));
        result.labels[static_cast<std::size_t>(i)] = part_labels_of(example);
        const std::lock_guard lock(mutex);
        progress.update(++done);
    });
    return result;
}

void save_part_images(const std::filesystem::path& folder, const std::string& name,
                      const PartImages& images) {
    std::filesystem::remove(json_file(folder, name));
    save_safetensors(tensors_file(folder, name),
                     {{"images", images.images}, {"parts", images.parts}});
    write_atomically(json_file(folder, name), nlohmann::json(images.labels).dump() + "\n");
}

bool has_part_images(const std::filesystem::path& folder, const std::string& name) {
    return std::filesystem::exists(json_file(folder, name));
}

PartImages load_part_images(const std::filesystem::path& folder, const std::string& name) {
    PartImages result;
    const SafeTensors file = SafeTensors::open(tensors_file(folder, name));
    result.images = file.tensor("images");
    result.parts = file.tensor("parts");
    const std::filesystem::path labels = json_file(folder, name);
    try {
        parse_json_or_throw(read_text(labels)).get_to(result.labels);
    } catch (const nlohmann::json::exception& error) {
        throw InputError(labels.string(), error.what(), "train without --resume");
    }
    if (static_cast<std::int64_t>(result.labels.size()) != result.count() ||
        result.parts.size(0) != result.count())
        throw InputError(labels.string(), "does not belong to the images next to it",
                         "train without --resume");
    return result;
}

}  // namespace item3d
