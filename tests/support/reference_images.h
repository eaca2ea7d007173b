// Reference images and tables, which other software has made, and crops of our images to compare
// with them.
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

/// Folder of reference data. If it has a crops.json, some files are crops of whole images: of
/// `width` x `height` pixels, every `step`-th pixel from (`x`, `y`) on.
class ReferenceSet {
  public:
    explicit ReferenceSet(std::filesystem::path folder) : folder_(std::move(folder)) {
        const std::filesystem::path path = folder_ / "crops.json";
        if (std::filesystem::exists(path)) crops_ = nlohmann::json::parse(read_text(path));
    }
    const std::filesystem::path& folder() const { return folder_; }
    const char* name() const { return crops_.empty() ? "whole" : "crop"; }

    /// Loads an image without its alpha channel, [height, width, 1 or 3].
    at::Tensor image(const std::string& file) const {
        const at::Tensor pixels = to_tensor(load_image(folder_ / file));
        return pixels.narrow(2, 0, std::min<std::int64_t>(3, pixels.size(2)));
    }

    /// Reads a file of float32 numbers, [N].
    at::Tensor numbers(const std::string& file) const {
        const Bytes bytes = read_bytes(folder_ / file);
        at::Tensor values = at::empty({static_cast<std::int64_t>(bytes.size() / sizeof(float))});
        std::memcpy(values.data_ptr<float>(), bytes.data(), values.nbytes());
        return values;
    }

    /// Crops a whole image [H, W, ...] to the pixels that `file` has.
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

/// Returns a ReferenceSet for each folder of folders().
inline std::vector<ReferenceSet> reference_sets() {
    std::vector<ReferenceSet> sets;
    for (const std::filesystem::path& folder : folders())
        sets.emplace_back(folder);
    return sets;
}

}  // namespace item3d::reference_data
