#include "item3d/reconstruct/dataset/llff.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/scene/pose.h"

#include <cmath>
#include <cstring>
#include <regex>

namespace item3d {

namespace {

constexpr std::size_t columns = 17;  // a 3 x 5 matrix, near and far

/// Reads the rows of a NumPy array file (format version 1 to 3) of little-endian float64 [N, 17] in
/// C order.
std::vector<std::array<double, columns>> read_rows(const std::filesystem::path& file) {
    const Bytes bytes = read_bytes(file);
    const auto wrong = [&](const std::string& problem) {
        return InputError(file.string(), problem, "LLFF's poses_bounds.npy is [N, 17] float64");
    };
    if (bytes.size() < 12 || std::memcmp(bytes.data(), "\x93NUMPY", 6) != 0) {
        throw wrong("is not a NumPy file");
    }
    const bool is_long = bytes[6] >= 2;
    const std::size_t start = is_long ? 12 : 10;
    std::size_t length = bytes[8] | (static_cast<std::size_t>(bytes[9]) << 8);
    if (is_long)
        length |= (static_cast<std::size_t>(bytes[10]) << 16) |
                  (static_cast<std::size_t>(bytes[11]) << 24);
    if (length > bytes.size() - start) throw wrong("the file ends too early");
    const std::string header(bytes.begin() + static_cast<std::ptrdiff_t>(start),
                             bytes.begin() + static_cast<std::ptrdiff_t>(start + length));
    std::smatch shape;
    if (header.find("'<f8'") == std::string::npos ||
        header.find("'fortran_order': False") == std::string::npos ||
        !std::regex_search(header, shape, std::regex(R"(\((\d{1,9}), ?17\))"))) {
        throw wrong("found " + header.substr(0, header.find_last_not_of(" \n") + 1));
    }
    const std::size_t count = std::stoul(shape[1]);
    if (count > (bytes.size() - start - length) / (columns * sizeof(double))) {
        throw wrong("the file ends too early");
    }
    std::vector<std::array<double, columns>> rows(count);
    if (count > 0)
        std::memcpy(rows.data(), bytes.data() + start + length, count * columns * sizeof(double));
    return rows;
}

}  // namespace

SourceDataset read_llff(const std::filesystem::path& file, const std::filesystem::path& images) {
    const auto rows = read_rows(file);
    const auto files = list_images(images);
    if (files.size() != rows.size()) {
        throw InputError(images.string(),
                         fmt::format("{} images for the {} poses of {}", files.size(), rows.size(),
                                     file.string()),
                         "remove images without a pose, or make the poses again");
    }
    SourceDataset dataset;
    dataset.kind = DatasetKind::llff;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const std::string subject = fmt::format("{}: row {}", file.string(), i);
        for (const double value : rows[i])
            if (!std::isfinite(value))
                throw InputError(subject, "a value is not finite", "make the poses again");
        const auto column = [&](std::size_t c) {
            return Vec3(rows[i][c], rows[i][5 + c], rows[i][10 + c]);
        };
        SourceView view;
        view.name = files[i].stem().string();
        view.image = files[i];
        // LLFF's camera axes are down, right, backwards.
        view.camera_to_world[0] = Vec4(column(1), 0);
        view.camera_to_world[1] = Vec4(-column(0), 0);
        view.camera_to_world[2] = Vec4(column(2), 0);
        view.camera_to_world[3] = Vec4(column(3), 1);
        view.camera_to_world = checked_pose(view.camera_to_world, subject);
        const Vec3 size = column(4);  // components: height, width, focal length
        if (!(size.x >= 1 && size.y >= 1 && size.z > 0 && size.x < 65536 && size.y < 65536)) {
            throw InputError(subject, "height, width or focal length is not above 0",
                             "make the poses again");
        }
        view.lens.height = static_cast<int>(std::lround(size.x));
        view.lens.width = static_cast<int>(std::lround(size.y));
        view.lens.focal_x = view.lens.focal_y = size.z;
        view.lens.centre_x = 0.5 * view.lens.width;
        view.lens.centre_y = 0.5 * view.lens.height;
        dataset.views.push_back(std::move(view));
    }
    return dataset;
}

}  // namespace item3d
