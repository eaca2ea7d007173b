#include "item3d/tensors/safetensors.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/parse_json.h"

#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <optional>

namespace item3d {
namespace {

// Maximum product of the nonzero extents. Far larger products overflow LibTorch's strides.
constexpr double max_elements_of_shape = 1e15;
constexpr std::uint64_t max_header_length = 100'000'000;  // the reference implementation's limit

struct NamedDtype {
    const char* name;
    at::ScalarType dtype;
};
constexpr NamedDtype dtypes[] = {
    {"F64", at::kDouble},
    {"F32", at::kFloat},
    {"F16", at::kHalf},
    {"BF16", at::kBFloat16},
    {"I64", at::kLong},
    {"I32", at::kInt},
    {"I16", at::kShort},
    {"I8", at::kChar},
    {"U8", at::kByte},
    {"BOOL", at::kBool},
    {"F8_E4M3", at::kFloat8_e4m3fn},
    {"F8_E5M2", at::kFloat8_e5m2},
};

std::optional<at::ScalarType> dtype_of_name(const std::string& name) {
    for (const NamedDtype& entry : dtypes)
        if (name == entry.name) return entry.dtype;
    return std::nullopt;
}

const char* name_of_dtype(at::ScalarType dtype) {
    for (const NamedDtype& entry : dtypes)
        if (dtype == entry.dtype) return entry.name;
    return nullptr;
}

class File {
  public:
    explicit File(const std::filesystem::path& path)
        : descriptor_(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {}
    ~File() {
        if (descriptor_ >= 0) ::close(descriptor_);
    }
    File(const File&) = delete;
    File& operator=(const File&) = delete;
    int descriptor() const { return descriptor_; }

  private:
    int descriptor_;
};

}  // namespace

/// Memory-mapped bytes of a file. They are unmapped with the last tensor that uses them.
struct SafeTensors::Map {
    std::uint8_t* bytes = nullptr;
    std::size_t size = 0;

    Map(void* address, std::size_t length)
        : bytes(static_cast<std::uint8_t*>(address)), size(length) {}
    ~Map() { ::munmap(bytes, size); }
    Map(const Map&) = delete;
    Map& operator=(const Map&) = delete;
};

SafeTensors SafeTensors::open(const std::filesystem::path& path) {
    const File file(path);
    if (file.descriptor() < 0)
        throw InputError(path.string(), fmt::format("cannot be read ({})", std::strerror(errno)),
                         "check its permissions");
    struct stat status {};
    if (::fstat(file.descriptor(), &status) != 0 || !S_ISREG(status.st_mode))
        throw InputError(path.string(), "is not a regular file, expected a safetensors file",
                         "give the name of a file");
    const auto size = static_cast<std::uint64_t>(status.st_size);
    if (size < 8)
        throw InputError(path.string(),
                         fmt::format("a safetensors file has at least 8 bytes, found {}", size),
                         "download or write the file again");

    void* address =
        ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE, file.descriptor(), 0);
    if (address == MAP_FAILED)
        throw ResourceError(fmt::format("{}: cannot be mapped into memory ({})", path.string(),
                                        std::strerror(errno)));
    SafeTensors result;
    result.path_ = path;
    result.map_ = std::make_shared<Map>(address, size);

    check_no_lfs_pointer(path, {result.map_->bytes, static_cast<std::size_t>(size)});
    std::uint64_t header_length = 0;
    for (int i = 7; i >= 0; --i)
        header_length = header_length << 8 | result.map_->bytes[i];
    if (header_length > max_header_length || header_length > size - 8)
        throw InputError(path.string(),
                         fmt::format("its header should have {} bytes, but the file has {}",
                                     header_length, size),
                         "the file is damaged or not a safetensors file; get it again");
    result.data_start_ = 8 + header_length;
    const auto* text = reinterpret_cast<const char*>(result.map_->bytes + 8);
    result.read_header(std::string(text, header_length), size - result.data_start_);
    return result;
}

void SafeTensors::read_header(const std::string& header, std::uint64_t data_size) {
    const std::string file = path_.string();
    const auto fail = [&](const std::string& name, const std::string& problem) {
        throw InputError(file, fmt::format("tensor '{}': {}", name, problem),
                         "the file is damaged; get it again");
    };
    const nlohmann::json root = parse_json(header);
    if (!root.is_object())
        throw InputError(file, "its header is not a JSON object",
                         "download or write the file again");

    for (const auto& [name, value] : root.items()) {
        if (name == "__metadata__") {
            if (!value.is_object())
                throw InputError(file, "__metadata__ is not a JSON object",
                                 "download or write the file again");
            for (const auto& [key, text] : value.items()) {
                if (!text.is_string())
                    throw InputError(file, "__metadata__ must contain only strings",
                                     "download or write the file again");
                metadata_[key] = text.get<std::string>();
            }
            continue;
        }
        if (!value.is_object() || !value.contains("dtype") || !value["dtype"].is_string() ||
            !value.contains("shape") || !value["shape"].is_array() ||
            !value.contains("data_offsets") || !value["data_offsets"].is_array() ||
            value["data_offsets"].size() != 2)
            fail(name, "expected dtype, shape and data_offsets");
        const auto dtype = dtype_of_name(value["dtype"].get<std::string>());
        if (!dtype)
            throw InputError(file,
                             fmt::format("tensor '{}' is of type {}, which is not supported", name,
                                         value["dtype"].get<std::string>()),
                             "use a copy of it in F16, BF16 or F32");

        Entry entry{*dtype, {}, 0, 0};
        double extents = 1;  // product of the nonzero extents; an extent of 0 makes `bytes` 0
        std::uint64_t bytes = at::elementSize(*dtype);
        for (const auto& extent : value["shape"]) {
            if (!extent.is_number_unsigned()) fail(name, "its shape must consist of sizes >= 0");
            const auto count = extent.get<std::uint64_t>();
            if (count > 0 && bytes > data_size / count) fail(name, "its shape exceeds the file");
            bytes *= count;
            extents *= static_cast<double>(std::max<std::uint64_t>(count, 1));
            if (extents > max_elements_of_shape) fail(name, "its shape has too many elements");
            entry.shape.push_back(static_cast<std::int64_t>(count));
        }
        const auto& offsets = value["data_offsets"];
        if (!offsets[0].is_number_unsigned() || !offsets[1].is_number_unsigned())
            fail(name, "its data_offsets must be numbers >= 0");
        entry.begin = offsets[0].get<std::uint64_t>();
        entry.end = offsets[1].get<std::uint64_t>();
        if (entry.begin > entry.end || entry.end > data_size)
            fail(name, fmt::format("its bytes {}..{} are not in the file's {} bytes of data",
                                   entry.begin, entry.end, data_size));
        if (entry.end - entry.begin != bytes)
            fail(name, fmt::format("shape [{}] of {} takes {} bytes, found {}",
                                   fmt::join(entry.shape, ", "), value["dtype"].get<std::string>(),
                                   bytes, entry.end - entry.begin));
        names_.push_back(name);
        entries_.emplace(name, std::move(entry));
    }

    std::stable_sort(names_.begin(), names_.end(), [&](const auto& a, const auto& b) {
        const Entry& left = entries_.at(a);
        const Entry& right = entries_.at(b);
        return std::pair(left.begin, left.end) < std::pair(right.begin, right.end);
    });
    std::uint64_t position = 0;
    for (const std::string& name : names_) {
        const Entry& entry = entries_.at(name);
        if (entry.begin < position) fail(name, "its bytes overlap another tensor's");
        if (entry.begin > position) fail(name, "there is a gap in the data before it");
        position = entry.end;
    }
    if (position != data_size)
        throw InputError(
            file, fmt::format("{} bytes after the last tensor are unused", data_size - position),
            "the file is damaged; get it again");
}

std::int64_t SafeTensors::total_elements() const {
    std::int64_t total = 0;
    for (const auto& [name, entry] : entries_)
        total +=
            static_cast<std::int64_t>((entry.end - entry.begin) / at::elementSize(entry.dtype));
    return total;
}

const SafeTensors::Entry& SafeTensors::entry(const std::string& name) const {
    const auto found = entries_.find(name);
    if (found == entries_.end())
        throw InputError(path_.string(), fmt::format("tensor '{}' is missing", name),
                         "choose a file that contains it");
    return found->second;
}

TensorInfo SafeTensors::info(const std::string& name) const {
    const Entry& found = entry(name);
    return {found.dtype, found.shape};
}

at::Tensor SafeTensors::tensor(const std::string& name) const {
    const Entry& found = entry(name);
    std::uint8_t* bytes = map_->bytes + data_start_ + found.begin;
    const auto options = at::TensorOptions().dtype(found.dtype);
    if (found.begin == found.end) return at::empty(found.shape, options);
    if (reinterpret_cast<std::uintptr_t>(bytes) % at::elementSize(found.dtype) != 0) {
        // The format does not guarantee alignment, but kernels require it.
        at::Tensor copy = at::empty(found.shape, options);
        std::memcpy(copy.data_ptr(), bytes, found.end - found.begin);
        return copy;
    }
    return at::from_blob(
        bytes, found.shape, [map = map_](void*) {}, options);
}

void SafeTensors::release_pages(const std::string& name) const {
    const Entry& found = entry(name);
    const auto page = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
    const auto start = reinterpret_cast<std::uintptr_t>(map_->bytes) + data_start_;
    // Only whole pages are released, because partial pages contain bytes of other tensors.
    const std::uintptr_t first = (start + found.begin + page - 1) / page * page;
    const std::uintptr_t last = (start + found.end) / page * page;
    if (last > first) ::madvise(reinterpret_cast<void*>(first), last - first, MADV_DONTNEED);
}

NamedTensors SafeTensors::tensors() const {
    NamedTensors result;
    for (const std::string& name : names_)
        result.emplace_back(name, tensor(name));
    return result;
}

void save_safetensors(const std::filesystem::path& path, const NamedTensors& tensors,
                      const std::map<std::string, std::string>& metadata) {
    // Puts wide types first, so that every tensor is aligned to its own size.
    NamedTensors sorted;
    for (const auto& [name, tensor] : tensors) {
        ITEM3D_CHECK(tensor.defined() && name_of_dtype(tensor.scalar_type()),
                     "safetensors cannot hold the tensor " + name);
        sorted.emplace_back(name, tensor.detach().to(at::kCPU).contiguous());
    }
    std::stable_sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) {
        const auto left = a.second.element_size();
        const auto right = b.second.element_size();
        return left != right ? left > right : a.first < b.first;
    });

    nlohmann::ordered_json header = nlohmann::ordered_json::object();
    if (!metadata.empty()) header["__metadata__"] = metadata;
    std::uint64_t offset = 0;
    for (const auto& [name, tensor] : sorted) {
        ITEM3D_CHECK(!header.contains(name), "two tensors have the name " + name);
        const std::uint64_t end = offset + tensor.nbytes();
        header[name] = {{"dtype", name_of_dtype(tensor.scalar_type())},
                        {"shape", tensor.sizes().vec()},
                        {"data_offsets", {offset, end}}};
        offset = end;
    }
    std::string text = header.dump();
    text.resize((text.size() + 7) / 8 * 8, ' ');

    // Writes through one buffer, because write_atomically() then syncs it and distinguishes a full
    // disk from an unwritable folder. The files that item3d writes are small.
    Bytes bytes(8 + text.size() + offset);
    for (int i = 0; i < 8; ++i)
        bytes[i] = static_cast<std::uint8_t>(text.size() >> (8 * i));
    std::memcpy(bytes.data() + 8, text.data(), text.size());
    std::uint8_t* position = bytes.data() + 8 + text.size();
    for (const auto& [name, tensor] : sorted) {
        if (tensor.nbytes() > 0) std::memcpy(position, tensor.data_ptr(), tensor.nbytes());
        position += tensor.nbytes();
    }
    write_atomically(path, bytes);
}

}  // namespace item3d
