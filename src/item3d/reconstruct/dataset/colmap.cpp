#include "item3d/reconstruct/dataset/colmap.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/scene/pose.h"

#include <glm/gtc/quaternion.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <map>
#include <sstream>

namespace item3d {

namespace {

namespace fs = std::filesystem;

struct CameraModel {
    const char* name;
    int parameters;
};

/// Camera models. The index of a model is COLMAP's number for it.
constexpr CameraModel camera_models[] = {{"SIMPLE_PINHOLE", 3},
                                         {"PINHOLE", 4},
                                         {"SIMPLE_RADIAL", 4},
                                         {"RADIAL", 5},
                                         {"OPENCV", 8},
                                         {"OPENCV_FISHEYE", 8},
                                         {"FULL_OPENCV", 12},
                                         {"FOV", 5},
                                         {"SIMPLE_RADIAL_FISHEYE", 4},
                                         {"RADIAL_FISHEYE", 5},
                                         {"THIN_PRISM_FISHEYE", 12}};

Lens make_lens(const std::string& model, int width, int height, const std::vector<double>& p,
               const std::string& subject) {
    const auto known = std::find_if(std::begin(camera_models), std::end(camera_models),
                                    [&](const CameraModel& m) { return model == m.name; });
    if (known == std::end(camera_models) || model == "FOV" || model == "THIN_PRISM_FISHEYE") {
        throw InputError(subject, "camera model '" + model + "' is not supported",
                         "run COLMAP's image_undistorter first");
    }
    if (p.size() != static_cast<std::size_t>(known->parameters)) {
        throw InputError(
            subject,
            fmt::format("{} has {} parameters, found {}", model, known->parameters, p.size()),
            "export the model from COLMAP again");
    }
    if (width < 1 || height < 1 || width > 65536 || height > 65536) {
        throw InputError(subject, fmt::format("invalid image size {} x {}", width, height),
                         "export the model from COLMAP again");
    }
    for (const double value : p)
        if (!std::isfinite(value))
            throw InputError(subject, "a parameter is not a finite number",
                             "export the model from COLMAP again");

    Lens lens;
    lens.width = width;
    lens.height = height;
    const bool one_focal = model.starts_with("SIMPLE_") || model.starts_with("RADIAL");
    std::size_t next = 0;
    lens.focal_x = p[next++];
    lens.focal_y = one_focal ? lens.focal_x : p[next++];
    lens.centre_x = p[next++];
    lens.centre_y = p[next++];
    lens.fisheye = model.ends_with("_FISHEYE");
    if (model == "OPENCV" || model == "FULL_OPENCV") {
        lens.radial = {p[4], p[5]};
        lens.tangential = {p[6], p[7]};
        for (std::size_t i = 8; i < p.size(); ++i)
            lens.radial[i - 6] = p[i];
    } else {
        for (std::size_t i = next; i < p.size(); ++i)
            lens.radial[i - next] = p[i];
    }
    if (!(lens.focal_x > 0 && lens.focal_y > 0)) {
        throw InputError(subject, "the focal length is not above 0",
                         "export the model from COLMAP again");
    }
    return lens;
}

/// Converts COLMAP's pose, which maps the world to a camera with x right, y down and z forward.
Mat4 to_camera_to_world(glm::dquat rotation, glm::dvec3 translation, const std::string& subject) {
    const double length = glm::length(rotation);
    if (!(std::abs(length - 1) < 0.01)) {
        throw InputError(
            subject,
            "its quaternion is not a rotation (length " + fmt::format("{:.3g}", length) + ")",
            "export the model from COLMAP again");
    }
    const glm::dmat3 to_world = glm::transpose(glm::mat3_cast(rotation / length));
    Mat4 pose(1.0f);
    pose[0] = Vec4(Vec3(to_world[0]), 0);
    pose[1] = Vec4(-Vec3(to_world[1]), 0);
    pose[2] = Vec4(-Vec3(to_world[2]), 0);
    pose[3] = Vec4(Vec3(-(to_world * translation)), 1);
    for (int i = 0; i < 3; ++i)
        if (!std::isfinite(pose[3][i]))
            throw InputError(subject, "its position is not finite",
                             "export the model from COLMAP again");
    return checked_pose(pose, subject);
}

struct ColmapReader {
    fs::path images;
    std::map<long, Lens> lenses;
    SourceDataset dataset;

    void add_view(const std::string& name, glm::dquat rotation, glm::dvec3 translation, long lens,
                  const std::string& subject) {
        const std::string where = subject + ": image '" + name + "'";
        if (lenses.count(lens) == 0) {
            throw InputError(where, fmt::format("unknown camera {}", lens),
                             "use files of cameras and images of the same model");
        }
        SourceView view;
        view.image = inside(images, name, where);
        view.name = without_image_extension(name);
        view.camera_to_world = to_camera_to_world(rotation, translation, where);
        view.lens = lenses.at(lens);
        dataset.views.push_back(std::move(view));
    }
};

void read_text_cameras(const fs::path& file, ColmapReader& reader) {
    std::istringstream lines(read_text(file));
    int number = 0;
    for (std::string line; std::getline(lines, line);) {
        ++number;
        if (line.empty() || line[0] == '#' || line == "\r") continue;
        const std::string subject = fmt::format("{}:{}", file.string(), number);
        std::istringstream words(line);
        long id = 0;
        std::string model;
        int width = 0, height = 0;
        if (!(words >> id >> model >> width >> height)) {
            throw InputError(subject, "expected CAMERA_ID MODEL WIDTH HEIGHT PARAMS...",
                             "export the model from COLMAP again");
        }
        std::vector<double> parameters;
        for (double value = 0; words >> value;)
            parameters.push_back(value);
        if (!words.eof())
            throw InputError(subject, "a parameter is not a finite number",
                             "export the model from COLMAP again");
        reader.lenses[id] = make_lens(model, width, height, parameters, subject);
    }
}

void read_text_images(const fs::path& file, ColmapReader& reader) {
    std::istringstream lines(read_text(file));
    int number = 0;
    std::size_t announced = 0;
    for (std::string line; std::getline(lines, line);) {
        ++number;
        std::sscanf(line.c_str(), "# Number of images: %zu", &announced);
        if (line.empty() || line[0] == '#' || line == "\r") continue;
        const std::string subject = fmt::format("{}:{}", file.string(), number);
        std::istringstream words(line);
        long id = 0, lens = 0;
        glm::dquat q(1, 0, 0, 0);
        glm::dvec3 t(0);
        std::string name;
        if (!(words >> id >> q.w >> q.x >> q.y >> q.z >> t.x >> t.y >> t.z >> lens) ||
            !std::getline(words >> std::ws, name)) {
            throw InputError(subject, "expected IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME",
                             "export the model from COLMAP again");
        }
        if (name.ends_with('\r')) name.pop_back();
        reader.add_view(name, q, t, lens, file.string());
        // The next line lists the visible points, and may be empty.
        std::getline(lines, line);
        ++number;
    }
    if (announced > reader.dataset.views.size())
        warn(fmt::format(
            "{}: its header announces {} images, but it contains {}; check that it is complete",
            file.string(), announced, reader.dataset.views.size()));
}

/// Reader of consecutive little-endian values.
class BinaryFile {
  public:
    explicit BinaryFile(const fs::path& file) : name_(file.string()), bytes_(read_bytes(file)) {}

    template <typename T>
    T next() {
        T value;
        need(sizeof(T));
        std::memcpy(&value, bytes_.data() + at_, sizeof(T));
        at_ += sizeof(T);
        return value;
    }
    std::string next_string() {
        const auto end =
            std::find(bytes_.begin() + static_cast<std::ptrdiff_t>(at_), bytes_.end(), 0);
        if (end == bytes_.end()) need(bytes_.size() + 1);
        const std::string text(bytes_.begin() + static_cast<std::ptrdiff_t>(at_), end);
        at_ += text.size() + 1;
        return text;
    }
    void skip(std::uint64_t items, std::uint64_t item_size) {
        if (items > bytes_.size()) need(bytes_.size() + 1);
        need(items * item_size);
        at_ += items * item_size;
    }
    const std::string& name() const { return name_; }

  private:
    void need(std::uint64_t count) const {
        if (count > bytes_.size() - at_) {
            throw InputError(name_, "the file ends too early", "export it again");
        }
    }

    std::string name_;
    Bytes bytes_;
    std::size_t at_ = 0;
};

void read_binary_cameras(const fs::path& path, ColmapReader& reader) {
    BinaryFile file(path);
    const auto count = file.next<std::uint64_t>();
    for (std::uint64_t i = 0; i < count; ++i) {
        const auto id = file.next<std::uint32_t>();
        const auto model = file.next<std::int32_t>();
        const auto width = file.next<std::uint64_t>(), height = file.next<std::uint64_t>();
        const std::string subject = fmt::format("{}: camera {}", file.name(), id);
        if (model < 0 || model >= static_cast<int>(std::size(camera_models)) || width > 65536 ||
            height > 65536) {
            throw InputError(subject, fmt::format("model {} of {} x {}", model, width, height),
                             "only COLMAP's own camera models are known");
        }
        std::vector<double> parameters(static_cast<std::size_t>(camera_models[model].parameters));
        for (double& value : parameters)
            value = file.next<double>();
        reader.lenses[id] = make_lens(camera_models[model].name, static_cast<int>(width),
                                      static_cast<int>(height), parameters, subject);
    }
}

void read_binary_images(const fs::path& path, ColmapReader& reader) {
    BinaryFile file(path);
    const auto count = file.next<std::uint64_t>();
    for (std::uint64_t i = 0; i < count; ++i) {
        file.next<std::uint32_t>();
        double values[7];
        for (double& value : values)
            value = file.next<double>();
        const auto lens = file.next<std::uint32_t>();
        const std::string name = file.next_string();
        file.skip(file.next<std::uint64_t>(), 24);
        reader.add_view(name, glm::dquat(values[0], values[1], values[2], values[3]),
                        {values[4], values[5], values[6]}, lens, file.name());
    }
}

}  // namespace

bool is_colmap_model(const fs::path& folder) {
    return (fs::exists(folder / "cameras.txt") && fs::exists(folder / "images.txt")) ||
           (fs::exists(folder / "cameras.bin") && fs::exists(folder / "images.bin"));
}

std::size_t count_colmap_images(const fs::path& model) {
    if (fs::exists(model / "cameras.bin") && fs::exists(model / "images.bin"))
        return BinaryFile(model / "images.bin").next<std::uint64_t>();
    std::istringstream lines(read_text(model / "images.txt"));
    std::size_t count = 0;
    for (std::string line; std::getline(lines, line);) {
        if (line.empty() || line[0] == '#' || line == "\r") continue;
        ++count;
        std::getline(lines, line);  // the visible points
    }
    return count;
}

SourceDataset read_colmap(const fs::path& model, const fs::path& images) {
    ColmapReader reader;
    reader.images = images;
    reader.dataset.kind = DatasetKind::colmap;
    if (fs::exists(model / "cameras.bin") && fs::exists(model / "images.bin")) {
        read_binary_cameras(model / "cameras.bin", reader);
        read_binary_images(model / "images.bin", reader);
    } else {
        read_text_cameras(model / "cameras.txt", reader);
        read_text_images(model / "images.txt", reader);
    }
    // COLMAP numbers images in the order of their registration.
    std::sort(reader.dataset.views.begin(), reader.dataset.views.end(),
              [](const SourceView& a, const SourceView& b) { return a.name < b.name; });
    return std::move(reader.dataset);
}

}  // namespace item3d
