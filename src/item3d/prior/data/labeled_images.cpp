#include "item3d/prior/data/labeled_images.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/parse_json.h"
#include "item3d/core/progress.h"
#include "item3d/tensors/safetensors.h"
#include "item3d/tensors/workers.h"

#include <atomic>
#include <mutex>

namespace item3d {
namespace {

namespace fs = std::filesystem;

fs::path images_file(const fs::path& folder, const std::string& name) {
    return folder / (name + ".safetensors");
}

fs::path facts_file(const fs::path& folder, const std::string& name) {
    return folder / (name + ".json");
}

}  // namespace

at::Tensor LabeledImages::pixel_values(const std::vector<std::int64_t>& rows) const {
    return images.index_select(0, at::tensor(rows))
        .permute({0, 3, 1, 2})
        .to(at::kFloat)
        .div(127.5)
        .sub(1);
}

LabeledImages draw_labeled(const ExampleSource& source, std::int64_t count, int threads) {
    LabeledImages result;
    result.images = at::empty({count, prior_image_size, prior_image_size, 3}, at::kByte);
    result.labels.resize(static_cast<std::size_t>(count));
    Progress progress("images", count);
    std::atomic<std::int64_t> done = 0;
    std::mutex mutex;
    run_workers(count, threads, [&](std::int64_t i) {
        Example example = source.draw(i);
        result.images[i].copy_((example.image * 255).round());
        result.labels[static_cast<std::size_t>(i)] = std::move(example.labels);
        const std::lock_guard lock(mutex);
        progress.update(++done);
    });
    return result;
}

void save_labeled(const fs::path& folder, const std::string& name, const LabeledImages& images) {
    fs::remove(facts_file(folder, name));
    save_safetensors(images_file(folder, name), {{"images", images.images}});
    write_atomically(facts_file(folder, name), nlohmann::json(images.labels).dump() + "\n");
}

bool has_labeled(const fs::path& folder, const std::string& name) {
    return fs::exists(facts_file(folder, name));
}

LabeledImages load_labeled(const fs::path& folder, const std::string& name) {
    LabeledImages result;
    result.images = SafeTensors::open(images_file(folder, name)).tensor("images");
    const fs::path file = facts_file(folder, name);
    try {
        parse_json_or_throw(read_text(file)).get_to(result.labels);
    } catch (const nlohmann::json::exception& error) {
        throw InputError(file.string(), error.what(), "train without --resume");
    }
    if (static_cast<std::int64_t>(result.labels.size()) != result.count())
        throw InputError(file.string(), "does not belong to the images next to it",
                         "train without --resume");
    return result;
}

}  // namespace item3d
