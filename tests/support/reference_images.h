// Images and tables that other software made, and the pixels of ours to compare with them.
#pragma once

#include "item3d/core/files.h"
#include "item3d/io/load.h"
#include "item3d/render/image_tensor.h"
#include "item3d/tensors/tensor.h"
#include "tests/support/reference_folders.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstring>
#include <string>

namespace item3d::reference_data {

/// Folder of references. Its crops.json, if it has one, names the files that are a part of a whole
/// image: every `step`-th pixel from (`x`, `y`), `width` x `height` of them.
class ReferenceSet {
  public:
    explicit ReferenceSet(std::filesystem::path folder) : folder_(std::move(folder)) {
        const std::filesystem::path path = folder_ / "crops.json";
        if (std::filesystem::exists(path)) crops_ = nlohmann::json::parse(read_text(path));
    }
    const std::filesystem::path& folder() const { return folder_; }
    const char* name() const { return crops_.empty() ? "whole" : "crop"; }

    /// Returns an image without its coverage, [height, width, 1 or 3].
    at::Tensor image(const std::string& file) const {
        const at::Tensor pixels = to_tensor(load_image(folder_ / file));
        return pixels.narrow(2, 0, std::min<std::int64_t>(3, pixels.size(2)));
    }

    /// Returns the float32 numbers of a file, [N].
    at::Tensor numbers(const std::string& file) const {
        const Bytes bytes = read_bytes(folder_ / file);
        at::Tensor values = at::empty({static_cast<std::int64_t>(bytes.size() / sizeof(float))});
        std::memcpy(values.data_ptr<float>(), bytes.data(), values.nbytes());
        return values;
    }

    /// Returns the pixels of a whole image [H, W, ...] that `file` has.
    at::Tensor crop(const std::string& file, const at::Tensor& whole) const {
        if (!crops_.contains(file)) return whole;
        const nlohmann::json& crop = crops_[file];
        EXPECT_EQ(whole.sizes().slice(0, 2).vec(), crop["of"].get<std::vector<std::int64_t>>())
            << file;
        const auto part = [&](const at::Tensor& tensor, int dimension, const char* start,
                              const char* count) {
            const std::int64_t first = crop[start], step = crop["step"];
            return tensor.slice(dimension, first,
                                first + (crop[count].get<std::int64_t>() - 1) * step + 1, step);
        };
        return part(part(whole, 0, "y", "height"), 1, "x", "width");
    }

  private:
    std::filesystem::path folder_;
    nlohmann::json crops_ = nlohmann::json::object();
};

/// Returns the set of each of folders().
inline std::vector<ReferenceSet> reference_sets() {
    std::vector<ReferenceSet> sets;
    for (const std::filesystem::path& folder : folders())
        sets.emplace_back(folder);
    return sets;
}

}  // namespace item3d::reference_data
