// The safetensors format (https://github.com/huggingface/safetensors#format), read by memory map
// and written atomically. A file consists of a u64 header length, a JSON header {name: {dtype,
// shape, data_offsets}}, and the tensors' bytes without gaps.
#pragma once

#include "item3d/tensors/tensor.h"

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace item3d {

/// Entry of a tensor in a file's header.
struct TensorInfo {
    at::ScalarType dtype;
    std::vector<std::int64_t> shape;
};

using NamedTensors = std::vector<std::pair<std::string, at::Tensor>>;

/// One open file. Its tensors share the memory map and keep it alive; writing to one changes
/// private memory, never the file.
class SafeTensors {
  public:
    /// Reads and checks the whole header (length, JSON, types, shapes, offsets, overlap, gaps)
    /// before any tensor is accessed. Throws InputError that names the file.
    static SafeTensors open(const std::filesystem::path& path);

    const std::filesystem::path& path() const { return path_; }
    /// Returns names in the order of their data.
    const std::vector<std::string>& names() const { return names_; }
    bool contains(const std::string& name) const { return entries_.count(name) > 0; }
    /// Returns the sum of all tensors' element counts.
    std::int64_t total_elements() const;
    /// Returns the header's "__metadata__" strings.
    const std::map<std::string, std::string>& metadata() const { return metadata_; }

    /// Returns type and shape of one tensor without reading its bytes. Throws InputError if there
    /// is no such tensor.
    TensorInfo info(const std::string& name) const;
    /// Returns a view of the file's bytes, in the file's own type. Throws InputError if there is no
    /// such tensor.
    at::Tensor tensor(const std::string& name) const;
    /// Releases the pages of a tensor that has been copied; a later access reads them from the file
    /// again.
    void release_pages(const std::string& name) const;
    /// Returns all tensors, in the order of names().
    NamedTensors tensors() const;

  private:
    struct Entry {
        at::ScalarType dtype;
        std::vector<std::int64_t> shape;
        std::uint64_t begin;  ///< offset from the start of the data
        std::uint64_t end;
    };
    struct Map;

    void read_header(const std::string& header, std::uint64_t data_size);
    const Entry& entry(const std::string& name) const;

    std::filesystem::path path_;
    std::shared_ptr<Map> map_;
    std::uint64_t data_start_ = 0;
    std::map<std::string, Entry> entries_;
    std::vector<std::string> names_;
    std::map<std::string, std::string> metadata_;
};

/// Writes float32, float16, bfloat16, float64, int64, int32, int16, int8, uint8 or bool tensors of
/// any device, atomically. Names must be unique. Throws ResourceError on a full disk.
void save_safetensors(const std::filesystem::path& path, const NamedTensors& tensors,
                      const std::map<std::string, std::string>& metadata = {});

}  // namespace item3d
